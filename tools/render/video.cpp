#include "render/video.h"

#include <filesystem>

#include "render/encoder.h"
#include "render/gif.h"

extern "C" {
#include <libswscale/swscale.h>
}

namespace sinew::render {
namespace {

/// H.264 or VP9: every frame is converted to yuv420p with bt709 coefficients and handed on.
class YuvWriter : public FrameWriter {
 public:
  YuvWriter() = default;
  ~YuvWriter() override {
    sws_freeContext(scale_);
    av_frame_free(&frame_);
  }
  YuvWriter(const YuvWriter&) = delete;
  YuvWriter& operator=(const YuvWriter&) = delete;

  convert::Error open(const std::string& path, Codec codec, int width, int height, double fps, int threads) {
    if (convert::Error error = encoder_.open(path, codec, width, height, fps, threads)) return error;
    frame_ = av_frame_alloc();
    frame_->format = encoder_.pixel_format();
    frame_->width = width;
    frame_->height = height;
    scale_ = sws_getContext(width, height, AV_PIX_FMT_BGR0, width, height, encoder_.pixel_format(),
                            SWS_BICUBIC | SWS_ACCURATE_RND | SWS_BITEXACT | SWS_FULL_CHR_H_INT, nullptr,
                            nullptr, nullptr);
    if (!scale_ || av_frame_get_buffer(frame_, 0) < 0) return {path + ": out of memory"};
    const int* bt709 = sws_getCoefficients(SWS_CS_ITU709);
    sws_setColorspaceDetails(scale_, bt709, 1, bt709, 0, 0, 1 << 16, 1 << 16);
    return {};
  }

  convert::Error add(const Image& image) override {
    const std::uint8_t* rows[] = {image.pixels.data()};
    const int strides[] = {image.width * 4};
    if (av_frame_make_writable(frame_) < 0) return {"video: out of memory"};
    sws_scale(scale_, rows, strides, 0, image.height, frame_->data, frame_->linesize);
    return encoder_.add(frame_);
  }

  convert::Error finish() override { return encoder_.finish(); }

 private:
  Encoder encoder_;
  SwsContext* scale_ = nullptr;
  AVFrame* frame_ = nullptr;
};

}  // namespace

std::unique_ptr<FrameWriter> create_video(const std::string& path, int width, int height, double fps,
                                          int threads, convert::Error& error) {
  const std::string extension = std::filesystem::path(path).extension().string();
  if (extension == ".gif") return create_gif(path, width, height, fps, error);
  auto writer = std::make_unique<YuvWriter>();
  error = writer->open(path, extension == ".webm" ? Codec::kVp9 : Codec::kH264, width, height, fps, threads);
  return error ? nullptr : std::move(writer);
}

}  // namespace sinew::render
