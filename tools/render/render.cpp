#include "render/render.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <condition_variable>
#include <cstdio>
#include <cstring>
#include <exception>
#include <filesystem>
#include <mutex>
#include <optional>
#include <thread>

#include "render/camera.h"
#include "render/inside.h"
#include "render/overlay.h"
#include "render/sink.h"
#include "sinew/animation/curve_job.h"
#include "sinew/animation/sampling_job.h"

namespace sinew::render {
namespace {

using convert::Error;

bool one_of(const std::string& value, std::initializer_list<const char*> allowed) {
  return std::find(allowed.begin(), allowed.end(), value) != allowed.end();
}

/// RRGGBB to 0 … 1 each.
std::optional<Vec3<float>> parse_color(const std::string& text) {
  if (text.size() != 6 || text.find_first_not_of("0123456789abcdefABCDEF") != std::string::npos) return {};
  const unsigned long value = std::stoul(text, nullptr, 16);
  return Vec3<float>(float(value >> 16), float(value >> 8 & 255), float(value & 255)) / 255;
}

/// What is wrong, or nothing.
std::string fault(const Options& o, const std::filesystem::path& output) {
  const std::string size = std::to_string(o.width) + "x" + std::to_string(o.height);
  if (o.width < 16 || o.height < 16 || o.width > 8192 || o.height > 8192)
    return "its size is not between 16 and 8192 (" + size + ")";
  if (o.width % 2 || o.height % 2) return "width and height must be even (" + size + ")";
  if (o.samples != 1 && o.samples != 4) return "samples are 1 or 4";
  if (!one_of(o.quality, {"full", "fast"})) return "unknown quality '" + o.quality + "'";
  if (!one_of(o.theme, {"dark", "light"})) return "unknown theme '" + o.theme + "'";
  if (!o.background.empty() && !parse_color(o.background))
    return "background '" + o.background + "' is not a colour RRGGBB";
  if (!one_of(o.mode, {"skin", "xray", "shapes", "both"})) return "unknown mode '" + o.mode + "'";
  if (!one_of(o.pass, {"color", "depth", "normal", "id"})) return "unknown pass '" + o.pass + "'";
  if (o.pass != "color" && !one_of(o.mode, {"skin", "shapes"}))
    return "pass " + o.pass + " is of mode skin or shapes";
  if ((o.transparent || o.pass != "color") && output.extension() != ".png")
    return "passes and transparent pictures are .png";
  if (o.inside && (o.transparent || o.pass != "color"))
    return "what is inside is drawn over pictures that are neither transparent nor passes";
  if (!(o.fps >= 1 && o.fps <= 240)) return "fps is not between 1 and 240";
  if (!(o.start >= 0)) return "start is not a time from 0 s on";
  if (o.frames_per_revolution < 1) return "frames per revolution are not positive";
  if (o.threads < 1 || o.threads > 64) return "encoder threads are not between 1 and 64";
  if (!one_of(output.extension().string(), {".mp4", ".webm", ".gif", ".png"}))
    return "unknown kind of output; .mp4, .webm, .gif or .png";
  std::error_code ignored;
  if (output.has_parent_path() && !std::filesystem::is_directory(output.parent_path(), ignored))
    return "its directory does not exist";
  return {};
}

Error check(const Options& o, const std::string& output) {
  const std::string found = fault(o, output);
  return found.empty() ? Error{} : Error{output + ": " + found};
}

/// Colours that differ from each other and from black, the same for the same number.
std::array<std::uint8_t, 3> id_color(std::size_t number) {
  constexpr double kGolden = 0.6180339887498949;
  const double hue = std::fmod(kGolden * double(number), 1), value = 1 - 0.15 * double(number / 7 % 4);
  std::array<std::uint8_t, 3> bytes{};
  for (std::size_t k = 0; k < 3; ++k) {  // of the wheel red, green, blue
    const double off = std::abs(std::fmod(6 * hue + 4 - 2 * double(k) + 5, 6) - 3);
    bytes[k] =
        static_cast<std::uint8_t>(std::lround(255 * value * (0.2 + 0.8 * std::clamp(off - 1, 0.0, 1.0))));
  }
  return bytes;
}

/// Paints what was appended from a vertex on in the colour of a number, so that no texture changes it.
void paint_id(std::size_t number, std::size_t first, Geometry& out) {
  const std::array<std::uint8_t, 3> color = id_color(number);
  for (std::size_t v = first; v < out.vertices.size(); ++v) {
    for (std::size_t k = 0; k < 3; ++k) {
      const float root = float(color[k]) / 255;  // the surface holds square roots
      out.vertices[v].color[k] = root * root;
    }
    out.vertices[v].glow = 1;
  }
}

void append_frame(const scene::Recording& rec, const scene::Frame& frame, Look look, bool ids,
                  Geometry& out) {
  const Vec3<float> ball(0.50f, 0.17f, 0.07f), wall(0.30f, 0.33f, 0.38f);
  out.clear();
  std::size_t number = 0;
  const auto append = [&](const auto& add) {
    const std::size_t first = out.vertices.size();
    add();
    if (ids) paint_id(number, first, out);
    ++number;
  };
  for (std::size_t c = 0; c < rec.characters.size(); ++c)
    append([&] { append_character(*rec.characters[c], frame.characters[c], look, out); });
  for (std::size_t p = 0; p < rec.props.size(); ++p)
    append([&] {
      if (frame.props[p].world.translation.z() > -100)  // parked below until it is launched
        append_shape(rec.props[p].shape, rec.props[p].size, frame.props[p].world, ball, out,
                     rec.props[p].hull);
    });
  for (const Collider& c : rec.obstacles)
    append([&] { append_shape(c.shape, c.size.cast<float>(), c.local.cast<float>(), wall, out, c.hull); });
}

/// A thin dark line between two pictures.
void draw_seam(Image& image) {
  const std::size_t row = std::size_t(image.width) * 4;
  for (std::size_t y = 0; y < std::size_t(image.height); ++y)
    for (std::size_t k = row / 2 - 4; k < row / 2 + 4; ++k) image.pixels[y * row + k] /= 2;
}

/// One picture per look, side by side.
class Painter {
 public:
  /// `clear`: of two figures each moves towards the middle, clear of the overlay's panels.
  static Error create(const Options& o, bool clear, std::unique_ptr<Painter>& out) {
    out.reset(new Painter);
    if (o.mode == "both") {
      out->looks_ = {Look::kSkin, Look::kXray};
    } else {
      out->looks_ = {o.mode == "xray" ? Look::kXray : (o.mode == "shapes" ? Look::kShapes : Look::kSkin)};
    }
    StageOptions stage{o.width / static_cast<int>(out->looks_.size()),
                       o.height,
                       o.samples,
                       o.theme == "dark",
                       o.quality == "full",
                       parse_color(o.background),
                       o.transparent,
                       o.pass == "depth"    ? Pass::kDepth
                       : o.pass == "normal" ? Pass::kNormal
                       : o.pass == "id"     ? Pass::kId
                                            : Pass::kPicture};
    out->ids_ = stage.pass == Pass::kId;
    out->inside_ = o.inside;
    out->dark_ = stage.dark;
    out->aspect_ = float(stage.width) / float(stage.height);
    if (out->looks_.size() == 2 && clear) out->shift_ = 0.5f;
    out->width_ = o.width;
    std::string why;
    out->stage_ = Stage::create(stage, why);
    return out->stage_ ? Error{} : Error{"renderer: " + why};
  }

  /// Of the room that the figure has.
  float aspect() const { return aspect_ * (1 - 0.6f * shift_); }

  void paint(const scene::Recording& rec, const scene::Frame& frame, const View& view, float ground,
             Image& out) {
    if (looks_.size() == 1) {
      append_frame(rec, frame, looks_[0], ids_, geometry_);
      stage_->draw(geometry_, view, ground, out);
      if (inside_) draw_inside(frame.inside, view, dark_, out);
      return;
    }
    for (std::size_t part = 0; part < looks_.size(); ++part) {
      append_frame(rec, frame, looks_[part], ids_, geometry_);
      View own = view;
      own.shift = part == 0 ? shift_ : -shift_;
      stage_->draw(geometry_, own, ground, part_);
      if (inside_) draw_inside(frame.inside, own, dark_, part_);
      out.width = width_;
      out.height = part_.height;
      out.channels = part_.channels;
      const std::size_t row = std::size_t(width_) * 4, piece = std::size_t(part_.width) * 4;
      out.pixels.resize(row * std::size_t(out.height));
      for (std::size_t y = 0; y < std::size_t(out.height); ++y)
        std::memcpy(&out.pixels[y * row + part * piece], &part_.pixels[y * piece], piece);
    }
    draw_seam(out);
  }

 private:
  Painter() = default;
  std::vector<Look> looks_;
  bool ids_ = false;  ///< colours say who it is
  bool inside_ = false, dark_ = true;
  std::unique_ptr<Stage> stage_;
  float aspect_ = 1, shift_ = 0;
  int width_ = 0;
  Geometry geometry_;
  Image part_;
};

/// How many frames are drawn at a time: while llvmpipe's threads rasterise one, the next is skinned and
/// sorted into tiles, which takes a single thread. Of large pictures two would take gigabytes.
int painters_for(const Options& o, int frames) {
  constexpr int kLarge = 4096 * 2304;
  return frames < 2 || o.width * o.height > kLarge ? 1 : 2;
}

/// Draws frames in several threads, each with a painter of its own, and hands them to the sink in order: what
/// a picture shows does not depend on who draws it.
class Workshop {
 public:
  using Draw = std::function<void(Painter&, int, Image&)>;
  using Progress = std::function<void(int, int)>;

  Workshop(Sink& sink, int frames, Draw draw, const Progress& progress)
      : sink_(sink), frames_(frames), draw_(std::move(draw)), progress_(progress) {}

  /// `first`: of the calling thread, as its context is current here.
  Error run(Painter& first, const Options& o, bool clear) {
    const int count = painters_for(o, frames_);
    std::vector<std::thread> others;
    for (int k = 1; k < count; ++k)
      others.emplace_back([this, k, count, &o, clear] {
        std::unique_ptr<Painter> own;
        if (Error error = Painter::create(o, clear, own))
          stop(error);
        else
          work(*own, k, count);
      });
    work(first, 0, count);
    for (std::thread& thread : others) thread.join();
    return error_;
  }

 private:
  void work(Painter& painter, int first, int step) {
    try {
      Image image;
      for (int n = first; n < frames_ && !stopped(); n += step) {
        draw_(painter, n, image);
        deliver(n, image);
      }
    } catch (const std::exception& unexpected) {  // memory ran out
      stop({unexpected.what()});
    }
  }

  void deliver(int n, Image& image) {
    std::unique_lock lock(mutex_);
    turn_.wait(lock, [&] { return next_ == n || error_; });
    if (error_) return;
    if (error_ = sink_.add(image); !error_ && progress_) progress_(n + 1, frames_);
    ++next_;
    turn_.notify_all();
  }

  void stop(const Error& error) {
    const std::lock_guard lock(mutex_);
    if (!error_) error_ = error;
    turn_.notify_all();
  }

  bool stopped() {
    const std::lock_guard lock(mutex_);
    return static_cast<bool>(error_);
  }

  Sink& sink_;
  int frames_;
  Draw draw_;
  const Progress& progress_;
  std::mutex mutex_;
  std::condition_variable turn_;
  int next_ = 0;  ///< frame that the sink gets next
  Error error_;
};

/// Which recorded frame each picture shows: the nearest in time.
std::vector<std::size_t> pick_frames(const scene::Recording& rec, const Options& o, bool single) {
  const double duration = rec.frames.back().time - rec.frames.front().time - o.start;
  const int total = single ? 1 : std::max(1, static_cast<int>(std::lround(duration * o.fps)));
  std::vector<std::size_t> picked;
  picked.reserve(static_cast<std::size_t>(total));
  for (int n = 0; n < total; ++n)
    picked.push_back(std::min(rec.frames.size() - 1,
                              static_cast<std::size_t>(std::lround((o.start + n / o.fps) * rec.frame_rate))));
  return picked;
}

/// A recording of the asset's clip or rest pose, one frame per picture.
scene::Recording record_asset(const std::shared_ptr<const Asset>& asset, const Clip* clip, const Options& o,
                              int frames) {
  const Skeleton& s = asset->skeleton;
  std::vector<JointJet<float>> jets(s.joints.size());
  for (std::size_t i = 0; i < jets.size(); ++i) {
    jets[i].rotation = s.joints[i].rest.rotation.cast<float>();
    jets[i].translation = s.joints[i].rest.translation.cast<float>();
  }
  std::vector<TimeJet<float>> curves(asset->curve_slots.size());
  scene::Recording rec;
  rec.title = s.name;
  rec.frame_rate = o.fps;
  rec.characters = {asset};
  for (int n = 0; n < frames; ++n) {
    const double time = o.start + n / o.fps;
    if (clip) (void)SamplingJob<float>{clip, time, jets}.Run();
    scene::CharacterFrame pose;
    pose.load.assign(s.joints.size(), 0);
    if (clip && CurveJob<float>{clip, time, asset->curve_slots, curves}.Run())
      for (const TimeJet<float>& curve : curves) pose.curves.push_back(curve.value);
    for (std::size_t i = 0; i < jets.size(); ++i) {
      const Transform<float> local{jets[i].rotation, jets[i].translation};
      const int parent = s.joints[i].parent;
      pose.model.push_back(parent < 0 ? local : pose.model[static_cast<std::size_t>(parent)] * local);
    }
    scene::Frame frame;
    frame.time = time;
    frame.characters = {std::move(pose)};
    rec.frames.push_back(std::move(frame));
  }
  return rec;
}

}  // namespace

std::vector<std::pair<std::string, std::string>> id_colors(const scene::Recording& rec) {
  std::vector<std::pair<std::string, std::string>> all;
  const auto add = [&](std::string name) {
    const auto [red, green, blue] = id_color(all.size());
    char text[8];
    std::snprintf(text, sizeof text, "%02x%02x%02x", red, green, blue);
    all.emplace_back(std::move(name), text);
  };
  for (std::size_t c = 0; c < rec.characters.size(); ++c)
    add(c < rec.names.size() ? rec.names[c] : rec.characters[c]->skeleton.name);
  for (const scene::Prop& prop : rec.props) add(prop.name);
  for (std::size_t o = 0; o < rec.obstacles.size(); ++o) add("obstacle " + std::to_string(o));
  return all;
}

Error render_recording(const scene::Recording& rec, const Options& o, const std::string& output,
                       const std::function<void(int, int)>& progress) {
  if (Error error = check(o, output)) return error;
  if (rec.frames.empty()) return {"the recording has no frames"};
  if (o.start > rec.frames.back().time - rec.frames.front().time)
    return {output + ": start is after the end of the recording"};
  std::unique_ptr<Painter> painter;
  if (Error error = Painter::create(o, o.overlay, painter)) return error;
  Error error;
  const auto sink = Sink::open(output, o, error);
  if (!sink) return error;
  const std::vector<View> views = plan_camera(rec, painter->aspect());
  const std::vector<std::size_t> picked = pick_frames(rec, o, sink->single());
  const float ground = rec.ground ? *rec.ground : lowest_point(rec, rec.frames.size());
  const auto draw = [&](Painter& by, int n, Image& image) {
    const std::size_t at = picked[static_cast<std::size_t>(n)];
    by.paint(rec, rec.frames[at], views[at], ground, image);
    if (o.overlay && o.pass == "color") draw_overlay(rec, at, o.theme == "dark", image);
  };
  error = Workshop(*sink, static_cast<int>(picked.size()), draw, progress).run(*painter, o, o.overlay);
  return error ? error : sink->finish();
}

Error render_asset(const std::shared_ptr<const Asset>& asset, const Options& o, const std::string& output,
                   const std::function<void(int, int)>& progress) {
  if (Error error = check(o, output)) return error;
  const int clip = o.clip.empty() ? -1 : asset->find_clip(o.clip);
  if (!o.clip.empty() && clip < 0) return {asset->skeleton.name + ": no clip '" + o.clip + "'"};
  const Clip* played = clip < 0 ? nullptr : &asset->clips[static_cast<std::size_t>(clip)];
  std::unique_ptr<Painter> painter;
  if (Error error = Painter::create(o, false, painter)) return error;
  Error error;
  const auto sink = Sink::open(output, o, error);
  if (!sink) return error;
  const bool turning = o.turntable || !played;
  const int total = sink->single() ? 1
                    : turning      ? o.frames_per_revolution
                                   : std::max(1, static_cast<int>(std::lround(played->duration * o.fps)));
  const scene::Recording rec = record_asset(asset, played, o, total);
  const std::vector<View> views =
      plan_turntable(rec, painter->aspect(), turning ? o.frames_per_revolution : 0);
  const float ground = lowest_point(rec, 1);
  const auto draw = [&](Painter& by, int n, Image& image) {
    const auto at = static_cast<std::size_t>(n);
    by.paint(rec, rec.frames[at], views[at], ground, image);
    if (o.overlay && o.pass == "color") draw_title(*asset, o.theme == "dark", image);
  };
  error = Workshop(*sink, total, draw, progress).run(*painter, o, false);
  return error ? error : sink->finish();
}

}  // namespace sinew::render
