#include "render/gif.h"

#include <zlib.h>

#include <cstdio>
#include <cstring>

#include "render/encoder.h"

extern "C" {
#include <libavfilter/avfilter.h>
#include <libavfilter/buffersink.h>
#include <libavfilter/buffersrc.h>
}

namespace sinew::render {
namespace {

constexpr int kPaletteSide = 16;  ///< palettegen's picture: 16x16 colours

struct FrameDeleter {
  void operator()(AVFrame* frame) const { av_frame_free(&frame); }
};
using Frame = std::unique_ptr<AVFrame, FrameDeleter>;

/// A chain of filters with named inputs and one output.
class Graph {
 public:
  Graph() : graph_(avfilter_graph_alloc()) { graph_->nb_threads = 1; }
  ~Graph() { avfilter_graph_free(&graph_); }
  Graph(const Graph&) = delete;
  Graph& operator=(const Graph&) = delete;

  AVFilterContext* input(const char* name, int width, int height, AVPixelFormat format) {
    char arguments[128];
    std::snprintf(arguments, sizeof arguments, "width=%d:height=%d:pix_fmt=%d:time_base=1/100", width, height,
                  int(format));
    AVFilterContext* made = nullptr;
    avfilter_graph_create_filter(&made, avfilter_get_by_name("buffer"), name, arguments, nullptr, graph_);
    return made;
  }
  AVFilterContext* filter(const char* kind, const char* arguments) {
    AVFilterContext* made = nullptr;
    avfilter_graph_create_filter(&made, avfilter_get_by_name(kind), kind, arguments, nullptr, graph_);
    return made;
  }
  bool configure() { return avfilter_graph_config(graph_, nullptr) >= 0; }

 private:
  AVFilterGraph* graph_;
};

bool link(AVFilterContext* from, AVFilterContext* to, unsigned pad = 0) {
  return from && to && avfilter_link(from, 0, to, pad) >= 0;
}

Frame pull(AVFilterContext* sink) {
  Frame frame(av_frame_alloc());
  return av_buffersink_get_frame(sink, frame.get()) >= 0 ? std::move(frame) : nullptr;
}

class GifWriter : public FrameWriter {
 public:
  GifWriter(int width, int height) : width_(width), height_(height) {}

  convert::Error open(const std::string& path, double fps) {
    path_ = path;
    if (convert::Error error = encoder_.open(path, Codec::kGif, width_, height_, fps, 1)) return error;
    pixels_ = histogram_.input("in", width_, height_, AV_PIX_FMT_BGR0);
    palette_ = histogram_.filter("buffersink", nullptr);
    // No transparent entry: all 256 colours go to the picture.
    AVFilterContext* generate = histogram_.filter("palettegen", "reserve_transparent=0");
    if (!link(pixels_, generate) || !link(generate, palette_) || !histogram_.configure()) return failed();
    return {};
  }

  convert::Error add(const Image& image) override {
    // cairo leaves the fourth byte open: set, so that equal pictures are equal bytes.
    std::vector<std::uint8_t> bytes = image.pixels;
    for (std::size_t i = 3; i < bytes.size(); i += 4) bytes[i] = 255;
    uLongf size = compressBound(bytes.size());
    std::vector<std::uint8_t> packed(size);
    if (compress2(packed.data(), &size, bytes.data(), bytes.size(), 1) != Z_OK) return failed();
    waiting_.emplace_back(packed.begin(), packed.begin() + static_cast<std::ptrdiff_t>(size));
    return av_buffersrc_add_frame(pixels_, picture(bytes).get()) < 0 ? failed() : convert::Error{};
  }

  convert::Error finish() override {
    if (av_buffersrc_add_frame(pixels_, nullptr) < 0) return failed();
    const Frame palette = pull(palette_);
    if (!palette) return failed();
    Graph graph;
    AVFilterContext* pixels = graph.input("in", width_, height_, AV_PIX_FMT_BGR0);
    AVFilterContext* colors =
        graph.input("palette", kPaletteSide, kPaletteSide, AVPixelFormat(palette->format));
    AVFilterContext* map = graph.filter("paletteuse", "dither=bayer:bayer_scale=4:diff_mode=rectangle");
    AVFilterContext* out = graph.filter("buffersink", nullptr);
    if (!link(pixels, map) || !link(colors, map, 1) || !link(map, out) || !graph.configure() ||
        av_buffersrc_write_frame(colors, palette.get()) < 0 || av_buffersrc_add_frame(colors, nullptr) < 0)
      return failed();
    std::vector<std::uint8_t> bytes(std::size_t(width_) * std::size_t(height_) * 4);
    for (std::size_t n = 0; n <= waiting_.size(); ++n) {
      if (n < waiting_.size()) {
        uLongf size = bytes.size();
        uncompress(bytes.data(), &size, waiting_[n].data(), waiting_[n].size());
        const Frame frame = picture(bytes);
        frame->pts = static_cast<std::int64_t>(n);
        if (av_buffersrc_add_frame(pixels, frame.get()) < 0) return failed();
      } else if (av_buffersrc_add_frame(pixels, nullptr) < 0) {
        return failed();
      }
      while (const Frame done = pull(out))
        if (convert::Error error = encoder_.add(done.get())) return error;
    }
    return encoder_.finish();
  }

 private:
  convert::Error failed() const { return {path_ + ": libavfilter cannot make its palette"}; }

  Frame picture(const std::vector<std::uint8_t>& bytes) const {
    Frame frame(av_frame_alloc());
    frame->format = AV_PIX_FMT_BGR0;
    frame->width = width_;
    frame->height = height_;
    if (av_frame_get_buffer(frame.get(), 0) < 0) return frame;
    const std::size_t row = std::size_t(width_) * 4;
    for (std::size_t y = 0; y < std::size_t(height_); ++y)
      std::memcpy(frame->data[0] + y * std::size_t(frame->linesize[0]), &bytes[y * row], row);
    return frame;
  }

  int width_, height_;
  std::string path_;
  Encoder encoder_;
  Graph histogram_;
  AVFilterContext *pixels_ = nullptr, *palette_ = nullptr;
  std::vector<std::vector<std::uint8_t>> waiting_;
};

}  // namespace

std::unique_ptr<FrameWriter> create_gif(const std::string& path, int width, int height, double fps,
                                        convert::Error& error) {
  auto writer = std::make_unique<GifWriter>(width, height);
  error = writer->open(path, fps);
  return error ? nullptr : std::move(writer);
}

}  // namespace sinew::render
