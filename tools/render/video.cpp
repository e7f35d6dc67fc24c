#include "render/video.h"

extern "C" {
#include <libavcodec/avcodec.h>
#include <libavformat/avformat.h>
#include <libavutil/opt.h>
#include <libswscale/swscale.h>
}

#include <cmath>
#include <cstdio>
#include <filesystem>

namespace sinew::render {

struct VideoWriter::Impl {
  std::string path, temporary;
  AVFormatContext* format = nullptr;
  AVCodecContext* codec = nullptr;
  AVStream* stream = nullptr;
  SwsContext* scale = nullptr;
  AVFrame* frame = nullptr;
  AVPacket* packet = nullptr;
  std::int64_t count = 0;
  bool finished = false;

  ~Impl() {
    sws_freeContext(scale);
    av_frame_free(&frame);
    av_packet_free(&packet);
    avcodec_free_context(&codec);
    if (format) {
      avio_closep(&format->pb);
      avformat_free_context(format);
    }
    if (!finished) std::remove(temporary.c_str());
  }
  bool drain() {
    for (;;) {
      const int code = avcodec_receive_packet(codec, packet);
      if (code == AVERROR(EAGAIN) || code == AVERROR_EOF) return true;
      if (code < 0) return false;
      av_packet_rescale_ts(packet, codec->time_base, stream->time_base);
      packet->stream_index = stream->index;
      if (av_interleaved_write_frame(format, packet) < 0) return false;
    }
  }
};

VideoWriter::VideoWriter() : impl_(std::make_unique<Impl>()) {}
VideoWriter::~VideoWriter() = default;

std::unique_ptr<VideoWriter> VideoWriter::create(const std::string& path, int width, int height, double fps,
                                                 int threads, convert::Error& error) {
  av_log_set_level(AV_LOG_QUIET);
  std::unique_ptr<VideoWriter> writer(new VideoWriter);
  Impl& v = *writer->impl_;
  v.path = path;
  const std::string extension = std::filesystem::path(path).extension().string();
  v.temporary = path + ".tmp" + extension;
  const bool gif = extension == ".gif", webm = extension == ".webm";
  const AVCodec* codec = gif ? avcodec_find_encoder(AV_CODEC_ID_GIF)
                             : avcodec_find_encoder_by_name(webm ? "libvpx-vp9" : "libx264");
  error = {path + ": cannot be written"};
  if (!codec) {
    error = {path + ": this libav has no encoder for it"};
    return nullptr;
  }
  if (avformat_alloc_output_context2(&v.format, nullptr, gif ? "gif" : (webm ? "webm" : "mp4"),
                                     v.temporary.c_str()) < 0)
    return nullptr;
  v.format->flags |= AVFMT_FLAG_BITEXACT;
  v.stream = avformat_new_stream(v.format, nullptr);
  v.codec = avcodec_alloc_context3(codec);
  v.codec->width = width;
  v.codec->height = height;
  v.codec->pix_fmt = gif ? AV_PIX_FMT_RGB8 : AV_PIX_FMT_YUV420P;
  v.codec->framerate = av_d2q(fps, 100000);
  v.codec->time_base = av_inv_q(v.codec->framerate);
  v.codec->thread_count = threads;
  v.codec->flags |= AV_CODEC_FLAG_BITEXACT;
  if (!gif) {
    v.codec->color_range = AVCOL_RANGE_MPEG;
    v.codec->colorspace = AVCOL_SPC_BT709;
    v.codec->color_primaries = AVCOL_PRI_BT709;
    v.codec->color_trc = AVCOL_TRC_BT709;
  }
  if (v.format->oformat->flags & AVFMT_GLOBALHEADER) v.codec->flags |= AV_CODEC_FLAG_GLOBAL_HEADER;
  AVDictionary* options = nullptr;
  if (webm) {
    av_dict_set(&options, "crf", "30", 0);
    av_dict_set(&options, "b", "0", 0);
    av_dict_set(&options, "cpu-used", "5", 0);
    v.codec->thread_count = 1;  // decoded pictures differ with the thread count
  } else if (!gif) {
    av_dict_set(&options, "preset", "veryfast", 0);
    av_dict_set(&options, "crf", "20", 0);
  }
  const bool opened = avcodec_open2(v.codec, codec, &options) >= 0;
  av_dict_free(&options);
  if (!opened || avcodec_parameters_from_context(v.stream->codecpar, v.codec) < 0) {
    error = {path + ": the encoder refuses " + std::to_string(width) + "x" + std::to_string(height)};
    return nullptr;
  }
  v.stream->time_base = v.codec->time_base;
  v.stream->avg_frame_rate = v.codec->framerate;
  if (avio_open(&v.format->pb, v.temporary.c_str(), AVIO_FLAG_WRITE) < 0 ||
      avformat_write_header(v.format, nullptr) < 0)
    return nullptr;
  v.frame = av_frame_alloc();
  v.packet = av_packet_alloc();
  v.frame->format = v.codec->pix_fmt;
  v.frame->width = width;
  v.frame->height = height;
  if (av_frame_get_buffer(v.frame, 0) < 0) return nullptr;
  v.scale = sws_getContext(width, height, AV_PIX_FMT_BGR0, width, height, v.codec->pix_fmt,
                           SWS_BICUBIC | SWS_ACCURATE_RND | SWS_BITEXACT | SWS_FULL_CHR_H_INT, nullptr,
                           nullptr, nullptr);
  if (!v.scale) return nullptr;
  const int* bt709 = sws_getCoefficients(SWS_CS_ITU709);
  if (!gif) sws_setColorspaceDetails(v.scale, bt709, 1, bt709, 0, 0, 1 << 16, 1 << 16);
  error = {};
  return writer;
}

convert::Error VideoWriter::add(const Image& image) {
  Impl& v = *impl_;
  const std::uint8_t* rows[] = {image.pixels.data()};
  const int strides[] = {image.width * 4};
  if (av_frame_make_writable(v.frame) < 0) return {v.path + ": out of memory"};
  sws_scale(v.scale, rows, strides, 0, image.height, v.frame->data, v.frame->linesize);
  v.frame->pts = v.count++;
  if (avcodec_send_frame(v.codec, v.frame) < 0 || !v.drain()) return {v.path + ": cannot be written"};
  return {};
}

convert::Error VideoWriter::finish() {
  Impl& v = *impl_;
  const bool ok = avcodec_send_frame(v.codec, nullptr) >= 0 && v.drain() && av_write_trailer(v.format) >= 0 &&
                  avio_closep(&v.format->pb) >= 0;
  if (!ok || std::rename(v.temporary.c_str(), v.path.c_str()) != 0) return {v.path + ": cannot be written"};
  v.finished = true;
  return {};
}

}  // namespace sinew::render
