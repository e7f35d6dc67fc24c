// One compressed stream in one file, through libavcodec and libavformat.
#pragma once

#include <cstdint>
#include <string>

#include "convert/convert.h"

extern "C" {
#include <libavcodec/avcodec.h>
#include <libavformat/avformat.h>
}

namespace sinew::render {

enum class Codec { kH264, kVp9, kGif };

/// Writes `path` under a temporary name beside it; finish() renames. Without finish() nothing is left.
/// Bit-exact flags and fixed thread counts: two runs decode to the same pictures.
class Encoder {
 public:
  Encoder() = default;
  ~Encoder();
  Encoder(const Encoder&) = delete;
  Encoder& operator=(const Encoder&) = delete;

  convert::Error open(const std::string& path, Codec codec, int width, int height, double fps, int threads);
  /// Frame of pixel_format(); its time stamp is set here.
  convert::Error add(AVFrame* frame);
  convert::Error finish();
  AVPixelFormat pixel_format() const { return codec_->pix_fmt; }

 private:
  bool drain();
  convert::Error unwritable() const { return {path_ + ": cannot be written"}; }

  std::string path_, temporary_;
  AVFormatContext* format_ = nullptr;
  AVCodecContext* codec_ = nullptr;
  AVStream* stream_ = nullptr;
  AVPacket* packet_ = nullptr;
  std::int64_t count_ = 0;
};

}  // namespace sinew::render
