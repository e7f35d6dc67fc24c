#include "render/render.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>

#include "render/overlay.h"
#include "render/stage.h"
#include "render/video.h"
#include "sinew/animation/sampling_job.h"

namespace sinew::render {
namespace {

using convert::Error;

Error check(const Options& o, const std::string& output) {
  if (o.width < 16 || o.height < 16 || o.width > 8192 || o.height > 8192)
    return {"size is not between 16 and 8192"};
  if (o.width % 2 || o.height % 2)
    return {"width and height must be even (" + std::to_string(o.width) + "x" + std::to_string(o.height) +
            ")"};
  if (o.samples != 1 && o.samples != 4) return {"samples are 1 or 4"};
  if (o.theme != "dark" && o.theme != "light") return {"unknown theme '" + o.theme + "'"};
  if (o.mode != "skin" && o.mode != "xray" && o.mode != "shapes") return {"unknown mode '" + o.mode + "'"};
  if (!(o.fps >= 1 && o.fps <= 240)) return {"fps is not between 1 and 240"};
  const std::string extension = std::filesystem::path(output).extension().string();
  if (extension != ".mp4" && extension != ".webm" && extension != ".gif" && extension != ".png")
    return {output + ": unknown kind of output; .mp4, .webm, .gif or .png"};
  std::error_code ignored;
  const auto parent = std::filesystem::path(output).parent_path();
  if (!parent.empty() && !std::filesystem::is_directory(parent, ignored))
    return {output + ": its directory does not exist"};
  return {};
}

/// Pictures or a video, by the output's name.
class Sink {
 public:
  Error open(const std::string& output, const Options& o) {
    output_ = output;
    if (std::filesystem::path(output).extension() == ".png") return {};
    Error error;
    video_ = VideoWriter::create(output, o.width, o.height, o.fps, o.threads, error);
    return error;
  }
  Error add(const Image& image) {
    if (video_) return video_->add(image);
    char name[1024];
    const bool pattern = output_.find('%') != std::string::npos;
    if (pattern && !numbered()) return {output_ + ": the number in it is not like %04d"};
    if (!pattern) {
      if (count_++ > 0) return {};
      return write_png(image, output_);
    }
    const auto at = output_.find('%'), d = output_.find('d', at);
    const int digits = std::max(1, std::atoi(output_.c_str() + at + 1));
    std::snprintf(name, sizeof name, "%s%0*d%s", output_.substr(0, at).c_str(), digits, count_++,
                  output_.substr(d + 1).c_str());
    return write_png(image, name);
  }
  Error finish() { return video_ ? video_->finish() : Error{}; }
  bool single() const { return !video_ && output_.find('%') == std::string::npos; }

 private:
  bool numbered() const {
    const auto at = output_.find('%'), d = output_.find('d', at);
    if (d == std::string::npos || d - at > 3) return false;
    return std::all_of(output_.begin() + static_cast<std::ptrdiff_t>(at) + 1,
                       output_.begin() + static_cast<std::ptrdiff_t>(d), ::isdigit) &&
           output_.find('%', d) == std::string::npos;
  }
  std::string output_;
  std::unique_ptr<VideoWriter> video_;
  int count_ = 0;
};

Look look_of(const Options& o) {
  return o.mode == "xray" ? Look::kXray : (o.mode == "shapes" ? Look::kShapes : Look::kSkin);
}

struct Bounds {
  Vec3<float> low = Vec3<float>::Constant(1e9f), high = Vec3<float>::Constant(-1e9f);
  void add(const Vec3<float>& p) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
};

/// Box of a character: collider ends, or joints where there are none.
void add_bounds(const Asset& asset, const scene::CharacterFrame& f, Bounds& b) {
  for (std::size_t i = 0; i < static_cast<std::size_t>(asset.skeleton.body_count); ++i)
    b.add(f.model[i].translation);
  for (const Collider& c : asset.skeleton.colliders) {
    const Transform<float> x = f.model[static_cast<std::size_t>(c.joint)] * c.local.cast<float>();
    const float reach = c.shape == Shape::kBox ? float(c.size.maxCoeff()) : float(c.size.x());
    for (const float side : {1.f, -1.f}) {
      const Vec3<float> end =
          x * Vec3<float>(0, 0, side * float(c.shape == Shape::kCapsule ? c.size.z() : 0));
      b.add(end + Vec3<float>::Constant(reach));
      b.add(end - Vec3<float>::Constant(reach));
    }
  }
}

/// Camera for every frame: the recording's, or fitted to the first frame's character and following it
/// smoothly.
std::vector<View> plan_camera(const scene::Recording& rec) {
  std::vector<View> views(rec.frames.size());
  Bounds first;
  for (std::size_t c = 0; c < rec.characters.size(); ++c)
    add_bounds(*rec.characters[c], rec.frames[0].characters[c], first);
  if (rec.characters.empty()) first = {Vec3<float>::Constant(-1), Vec3<float>::Constant(1)};
  const float size = std::max(0.1f, (first.high - first.low).norm());
  const float fov = rec.camera.vertical_fov_deg * 3.14159265f / 180;
  Vec3<float> direction = rec.camera.eye - rec.camera.target;
  Vec3<float> target = rec.camera.target;
  float distance = direction.norm();
  direction /= std::max(1e-6f, distance);
  if (rec.camera.frame_automatically) {
    target = (first.low + first.high) / 2;
    target.z() = first.low.z() + 0.47f * (first.high.z() - first.low.z());
    distance = 0.78f * size / std::tan(fov / 2);
  }
  const int follow = rec.camera.follow_character;
  Vec3<float> start = Vec3<float>::Zero(), smooth = Vec3<float>::Zero();
  const float keep = std::exp(-1.f / (0.45f * float(rec.frame_rate)));
  for (std::size_t i = 0; i < views.size(); ++i) {
    Vec3<float> shift = Vec3<float>::Zero();
    if (follow >= 0 && follow < static_cast<int>(rec.characters.size())) {
      Vec3<float> root = rec.frames[i].characters[static_cast<std::size_t>(follow)].model[0].translation;
      root.z() = 0;
      if (i == 0) start = smooth = root;
      smooth = keep * smooth + (1 - keep) * root;
      shift = smooth - start;
    }
    views[i] = {target + shift + distance * direction, target + shift, fov, 1.6f * size};
  }
  return views;
}

Error unavailable(const std::string& what) {
  return {"renderer: " + what};
}

}  // namespace

Error render_recording(const scene::Recording& rec, const Options& o, const std::string& output,
                       const std::function<void(int, int)>& progress) {
  if (Error error = check(o, output)) return error;
  if (rec.frames.empty()) return {"the recording has no frames"};
  std::string why;
  const auto stage = Stage::create(o.width, o.height, o.samples, o.theme == "dark", why);
  if (!stage) return unavailable(why);
  Sink sink;
  if (Error error = sink.open(output, o)) return error;
  const std::vector<View> views = plan_camera(rec);
  const double duration = rec.frames.back().time - rec.frames.front().time;
  const int total = sink.single() ? 1 : std::max(1, static_cast<int>(std::lround(duration * o.fps)));
  Geometry geometry;
  Image image;
  for (int n = 0; n < total; ++n) {
    const auto index =
        std::min(rec.frames.size() - 1, static_cast<std::size_t>(std::lround(n / o.fps * rec.frame_rate)));
    const scene::Frame& frame = rec.frames[index];
    geometry.clear();
    for (std::size_t c = 0; c < rec.characters.size(); ++c)
      append_character(*rec.characters[c], frame.characters[c], look_of(o), geometry);
    for (std::size_t p = 0; p < rec.props.size(); ++p)
      if (frame.props[p].world.translation.z() > -100)
        append_shape(rec.props[p].shape, rec.props[p].size, frame.props[p].world, {0.55f, 0.22f, 0.10f},
                     geometry);
    for (const Collider& c : rec.obstacles)
      append_shape(c.shape, c.size.cast<float>(), c.local.cast<float>(), {0.30f, 0.33f, 0.38f}, geometry);
    stage->draw(geometry, views[index], 0, image);
    if (o.overlay) draw_overlay(rec, index, o.theme == "dark", image);
    if (Error error = sink.add(image)) return error;
    if (progress) progress(n + 1, total);
  }
  return sink.finish();
}

Error render_asset(std::shared_ptr<const Asset> asset, const Options& o, const std::string& output,
                   const std::function<void(int, int)>& progress) {
  if (Error error = check(o, output)) return error;
  const Skeleton& s = asset->skeleton;
  int clip = -1;
  if (!o.clip.empty() && (clip = asset->find_clip(o.clip)) < 0) return {"unknown clip '" + o.clip + "'"};
  std::string why;
  const auto stage = Stage::create(o.width, o.height, o.samples, o.theme == "dark", why);
  if (!stage) return unavailable(why);
  Sink sink;
  if (Error error = sink.open(output, o)) return error;
  const int total = sink.single() ? 1 : o.frames_per_revolution;
  Geometry geometry;
  Image image;
  std::vector<JointJet<float>> jets(s.joints.size());
  scene::CharacterFrame frame;
  frame.load.assign(s.joints.size(), 0);
  frame.model.resize(s.joints.size());
  View view;
  float ground = 0;
  for (int n = 0; n < total; ++n) {
    if (clip >= 0) {
      SamplingJob<float>{&asset->clips[static_cast<std::size_t>(clip)], n / o.fps, 1, jets}.Run();
    } else {
      for (std::size_t i = 0; i < jets.size(); ++i) {
        jets[i].rotation = s.joints[i].rest.rotation.cast<float>();
        jets[i].translation = s.joints[i].rest.translation.cast<float>();
      }
    }
    for (std::size_t i = 0; i < jets.size(); ++i) {
      const Transform<float> local{jets[i].rotation, jets[i].translation};
      frame.model[i] =
          s.joints[i].parent < 0 ? local : frame.model[static_cast<std::size_t>(s.joints[i].parent)] * local;
    }
    Bounds bounds;
    add_bounds(*asset, frame, bounds);
    if (n == 0 || clip >= 0) {
      const float size = std::max(0.05f, (bounds.high - bounds.low).norm());
      if (n == 0) {
        ground = bounds.low.z();
        view.light_radius = 1.3f * size;
        view.vertical_fov = 0.5f;
      }
      view.target = (bounds.low + bounds.high) / 2;
      view.eye.x() = 0.72f * size / std::tan(view.vertical_fov / 2);
    }
    const float angle =
        -0.6f + (o.turntable ? 2 * 3.14159265f * float(n) / float(o.frames_per_revolution) : 0);
    const float distance =
        0.62f * std::max(0.05f, (bounds.high - bounds.low).norm()) / std::tan(view.vertical_fov / 2);
    view.eye = view.target + distance * Vec3<float>(std::cos(angle) * 0.97f, std::sin(angle) * 0.97f, 0.22f);
    geometry.clear();
    append_character(*asset, frame, look_of(o), geometry);
    stage->draw(geometry, view, ground, image);
    if (Error error = sink.add(image)) return error;
    if (progress) progress(n + 1, total);
  }
  return sink.finish();
}

}  // namespace sinew::render
