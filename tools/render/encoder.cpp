#include "render/encoder.h"

extern "C" {
#include <libavutil/cpu.h>
}

#include <cstdio>

namespace sinew::render {
namespace {

void set_options(Codec codec, int threads, AVCodecContext& context, AVDictionary** options) {
  context.thread_count = threads;
  context.flags |= AV_CODEC_FLAG_BITEXACT;
  if (codec == Codec::kGif) return;
  context.color_range = AVCOL_RANGE_MPEG;
  context.colorspace = AVCOL_SPC_BT709;
  context.color_primaries = AVCOL_PRI_BT709;
  context.color_trc = AVCOL_TRC_BT709;
  if (codec == Codec::kVp9) {
    av_dict_set(options, "crf", "30", 0);
    av_dict_set(options, "b", "0", 0);
    av_dict_set(options, "cpu-used", "5", 0);
    context.thread_count = 1;  // decoded pictures differ with the thread count
    return;
  }
  av_dict_set(options, "preset", "veryfast", 0);
  av_dict_set(options, "crf", "18", 0);
  // x264 0.164 reads memory that it never wrote in its AVX-512 macroblock tree: pictures then depend on what
  // the heap held before (seen at 320x180; never with AVX2 or less, nor with mbtree=0).
  if (av_get_cpu_flags() & AV_CPU_FLAG_AVX512) av_dict_set(options, "x264-params", "asm=AVX2", 0);
}

}  // namespace

Encoder::~Encoder() {
  av_packet_free(&packet_);
  avcodec_free_context(&codec_);
  if (format_) {
    avio_closep(&format_->pb);
    avformat_free_context(format_);
  }
  if (!temporary_.empty()) std::remove(temporary_.c_str());
}

convert::Error Encoder::open(const std::string& path, Codec codec, int width, int height, double fps,
                             int threads) {
  static constexpr const char* kMuxers[] = {"mp4", "webm", "gif"};
  static constexpr const char* kEncoders[] = {"libx264", "libvpx-vp9", "gif"};
  av_log_set_level(AV_LOG_QUIET);
  path_ = path;
  const AVCodec* encoder = avcodec_find_encoder_by_name(kEncoders[static_cast<int>(codec)]);
  if (!encoder) return {path + ": this libavcodec lacks the encoder " + kEncoders[static_cast<int>(codec)]};
  const std::string temporary = path + ".tmp";
  if (avformat_alloc_output_context2(&format_, nullptr, kMuxers[static_cast<int>(codec)], temporary.c_str()) <
      0)
    return unwritable();
  format_->flags |= AVFMT_FLAG_BITEXACT;
  stream_ = avformat_new_stream(format_, nullptr);
  codec_ = avcodec_alloc_context3(encoder);
  packet_ = av_packet_alloc();
  codec_->width = width;
  codec_->height = height;
  codec_->pix_fmt = codec == Codec::kGif ? AV_PIX_FMT_PAL8 : AV_PIX_FMT_YUV420P;
  codec_->framerate = av_d2q(fps, 100000);
  codec_->time_base = av_inv_q(codec_->framerate);
  if (format_->oformat->flags & AVFMT_GLOBALHEADER) codec_->flags |= AV_CODEC_FLAG_GLOBAL_HEADER;
  AVDictionary* options = nullptr;
  set_options(codec, threads, *codec_, &options);
  const bool opened = avcodec_open2(codec_, encoder, &options) >= 0;
  av_dict_free(&options);
  if (!opened || avcodec_parameters_from_context(stream_->codecpar, codec_) < 0)
    return {path + ": the encoder refuses " + std::to_string(width) + "x" + std::to_string(height)};
  stream_->time_base = codec_->time_base;
  stream_->avg_frame_rate = codec_->framerate;
  if (avio_open(&format_->pb, temporary.c_str(), AVIO_FLAG_WRITE) < 0) return unwritable();
  temporary_ = temporary;
  AVDictionary* layout = nullptr;
  if (codec == Codec::kH264) av_dict_set(&layout, "movflags", "+faststart", 0);  // plays while it loads
  const bool begun = avformat_write_header(format_, &layout) >= 0;
  av_dict_free(&layout);
  return begun ? convert::Error{} : unwritable();
}

bool Encoder::drain() {
  for (;;) {
    const int code = avcodec_receive_packet(codec_, packet_);
    if (code == AVERROR(EAGAIN) || code == AVERROR_EOF) return true;
    if (code < 0) return false;
    av_packet_rescale_ts(packet_, codec_->time_base, stream_->time_base);
    packet_->stream_index = stream_->index;
    if (av_interleaved_write_frame(format_, packet_) < 0) return false;
  }
}

convert::Error Encoder::add(AVFrame* frame) {
  frame->pts = count_++;
  frame->pict_type = AV_PICTURE_TYPE_NONE;
  return avcodec_send_frame(codec_, frame) < 0 || !drain() ? unwritable() : convert::Error{};
}

convert::Error Encoder::finish() {
  // A full disk may show only when the last bytes are flushed: avio keeps the error.
  const bool written = avcodec_send_frame(codec_, nullptr) >= 0 && drain() &&
                       av_write_trailer(format_) >= 0 && format_->pb->error >= 0 &&
                       avio_closep(&format_->pb) >= 0;
  if (!written || std::rename(temporary_.c_str(), path_.c_str()) != 0) return unwritable();
  temporary_.clear();
  return {};
}

}  // namespace sinew::render
