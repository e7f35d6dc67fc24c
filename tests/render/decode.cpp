#include "render/decode.h"

extern "C" {
#include <libavcodec/avcodec.h>
#include <libavformat/avformat.h>
#include <libavutil/imgutils.h>
#include <libavutil/pixdesc.h>
}

namespace sinew::render::fixtures {

Decoded decode(const std::string& path) {
  Decoded out;
  AVFormatContext* format = nullptr;
  if (avformat_open_input(&format, path.c_str(), nullptr, nullptr) < 0) return out;
  avformat_find_stream_info(format, nullptr);
  const AVStream* stream = format->streams[0];
  const AVCodec* codec = avcodec_find_decoder(stream->codecpar->codec_id);
  AVCodecContext* context = avcodec_alloc_context3(codec);
  avcodec_parameters_to_context(context, stream->codecpar);
  avcodec_open2(context, codec, nullptr);
  out.width = context->width;
  out.height = context->height;
  out.fps = av_q2d(stream->avg_frame_rate);
  out.codec = codec->name;
  out.pixel_format = av_get_pix_fmt_name(context->pix_fmt);
  out.color_space = av_color_space_name(AVColorSpace(stream->codecpar->color_space));
  AVPacket* packet = av_packet_alloc();
  AVFrame* frame = av_frame_alloc();
  for (bool more = true; more;) {
    more = av_read_frame(format, packet) >= 0;
    avcodec_send_packet(context, more ? packet : nullptr);
    av_packet_unref(packet);
    while (avcodec_receive_frame(context, frame) >= 0) {
      const auto kind = AVPixelFormat(frame->format);
      const int size = av_image_get_buffer_size(kind, frame->width, frame->height, 1);
      out.frames.emplace_back(static_cast<std::size_t>(size));
      av_image_copy_to_buffer(out.frames.back().data(), size, frame->data, frame->linesize, kind,
                              frame->width, frame->height, 1);
    }
  }
  av_frame_free(&frame);
  av_packet_free(&packet);
  avcodec_free_context(&context);
  avformat_close_input(&format);
  return out;
}

}  // namespace sinew::render::fixtures
