#include "render/camera.h"

#include <algorithm>
#include <cmath>

#include "sinew/skeleton/convex_hull.h"

namespace sinew::render {
namespace {

constexpr float kPi = 3.14159265f;
constexpr float kAdult = 1.75f;  ///< m

struct Box {
  Vec3<float> low = Vec3<float>::Constant(1e9f), high = Vec3<float>::Constant(-1e9f);

  void add(const Vec3<float>& p) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  Vec3<float> centre() const { return (low + high) / 2; }
  float diagonal() const { return (high - low).norm(); }
};

/// Shapes' ends, and joints.
void add_character(const Asset& asset, const scene::CharacterFrame& f, Box& box) {
  for (std::size_t i = 0; i < static_cast<std::size_t>(asset.skeleton.body_count); ++i)
    box.add(f.model[i].translation);
  for (const Collider& c : asset.skeleton.colliders) {
    const Transform<float> x = f.model[static_cast<std::size_t>(c.joint)] * c.local.cast<float>();
    if (c.hull) {
      for (const Vec3<double>& corner : c.hull->corners()) box.add(x * corner.cast<float>());
      continue;
    }
    if (c.shape == Shape::kBox) {
      for (int corner = 0; corner < 8; ++corner)
        box.add(x * Vec3<float>((corner & 1 ? 1.f : -1.f) * float(c.size.x()),
                                (corner & 2 ? 1.f : -1.f) * float(c.size.y()),
                                (corner & 4 ? 1.f : -1.f) * float(c.size.z())));
      continue;
    }
    const float half = c.shape == Shape::kCapsule ? float(c.size.z()) : 0;
    for (const float side : {1.f, -1.f}) {
      const Vec3<float> end = x * Vec3<float>(0, 0, side * half);
      box.add(end + Vec3<float>::Constant(float(c.size.x())));
      box.add(end - Vec3<float>::Constant(float(c.size.x())));
    }
  }
}

std::vector<Box> boxes_of(const scene::Recording& rec) {
  std::vector<Box> boxes(rec.frames.size());
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    for (std::size_t c = 0; c < rec.characters.size(); ++c)
      add_character(*rec.characters[c], rec.frames[i].characters[c], boxes[i]);
    if (rec.characters.empty()) boxes[i] = {Vec3<float>::Constant(-1), Vec3<float>::Constant(1)};
  }
  return boxes;
}

/// Gaussian mean over past and coming frames, ends repeated. `sigma` in frames.
template <class T>
std::vector<T> smoothed(const std::vector<T>& values, float sigma) {
  const int reach = static_cast<int>(3 * sigma), last = static_cast<int>(values.size()) - 1;
  std::vector<float> weight;
  for (int k = -reach; k <= reach; ++k) weight.push_back(std::exp(-0.5f * float(k * k) / (sigma * sigma)));
  std::vector<T> out = values;
  for (int i = 0; i <= last; ++i) {
    T sum = values[static_cast<std::size_t>(i)] * 0.f;
    float total = 0;
    int from = i - reach;
    for (const float w : weight) {
      sum += w * values[static_cast<std::size_t>(std::clamp(from++, 0, last))];
      total += w;
    }
    out[static_cast<std::size_t>(i)] = sum / total;
  }
  return out;
}

/// Largest value within `reach` frames on either side.
std::vector<float> dilated(const std::vector<float>& values, int reach) {
  const int last = static_cast<int>(values.size()) - 1;
  std::vector<float> out = values;
  for (int i = 0; i <= last; ++i)
    for (int k = std::max(0, i - reach); k <= std::min(last, i + reach); ++k)
      out[static_cast<std::size_t>(i)] =
          std::max(out[static_cast<std::size_t>(i)], values[static_cast<std::size_t>(k)]);
  return out;
}

/// Distance from which the box fills the picture but for its margins. `direction` leads from target to eye
/// (unit). On a turntable the box's upright cylinder counts, from all sides the same, so that the camera
/// keeps its distance.
float fitting_distance(const Box& box, const Vec3<float>& direction, float fov, float aspect, bool turning) {
  const Vec3<float> half = (box.high - box.low) / 2;
  const Eigen::Vector2f toward = direction.head<2>().normalized();
  const float radius = half.head<2>().norm();
  const float across = turning ? radius : std::abs(toward.y()) * half.x() + std::abs(toward.x()) * half.y();
  const float deep = turning ? radius : std::abs(toward.x()) * half.x() + std::abs(toward.y()) * half.y();
  const float level = direction.head<2>().norm();
  const float tall = half.z() * level + deep * std::abs(direction.z());
  const float up = std::tan(fov / 2);
  return std::max(tall / (0.80f * up), across / (0.72f * up * aspect)) + 0.5f * deep;
}

/// Views along `direction` (from target to eye, unit), one target and distance for each frame.
std::vector<View> follow(const scene::Recording& rec, const std::vector<Box>& boxes,
                         const Vec3<float>& direction, float fov, float aspect, bool turning) {
  std::vector<Vec3<float>> targets;
  std::vector<float> distances;
  for (const Box& box : boxes) {
    targets.push_back(box.centre());
    distances.push_back(fitting_distance(box, direction, fov, aspect, turning));
  }
  const float rate = float(rec.frame_rate);
  targets = smoothed(targets, std::max(0.1f, 0.35f * rate));
  distances = smoothed(dilated(distances, static_cast<int>(0.8f * rate)), std::max(0.1f, 0.5f * rate));
  const float unit = std::max(1e-3f, boxes.front().diagonal() / (1.15f * kAdult));
  std::vector<View> views;
  for (std::size_t i = 0; i < boxes.size(); ++i)
    views.push_back({targets[i] + distances[i] * direction, targets[i], fov, unit});
  return views;
}

}  // namespace

std::vector<View> plan_camera(const scene::Recording& rec, float aspect) {
  std::vector<Box> boxes = boxes_of(rec);
  const float fov = rec.camera.vertical_fov_deg * kPi / 180;
  const Vec3<float> offset = rec.camera.eye - rec.camera.target;
  const bool following = rec.camera.follow_character >= 0 &&
                         rec.camera.follow_character < static_cast<int>(rec.characters.size());
  if (rec.camera.frame_automatically) {
    if (!following && rec.characters.size() < 2) {  // one view of everything
      Box all;
      for (const Box& box : boxes) {
        all.add(box.low);
        all.add(box.high);
      }
      std::fill(boxes.begin(), boxes.end(), all);
    }
    return follow(rec, boxes, offset.normalized(), fov, aspect, false);
  }
  std::vector<Vec3<float>> shift(boxes.size(), Vec3<float>::Zero());
  if (following) {
    const auto place = [&](std::size_t i) {
      Vec3<float> root = rec.frames[i]
                             .characters[static_cast<std::size_t>(rec.camera.follow_character)]
                             .model[0]
                             .translation;
      root.z() = 0;
      return root;
    };
    for (std::size_t i = 0; i < shift.size(); ++i) shift[i] = place(i) - place(0);
    shift = smoothed(shift, std::max(0.1f, 0.35f * float(rec.frame_rate)));
  }
  const float unit = std::max(1e-3f, boxes.front().diagonal() / (1.15f * kAdult));
  std::vector<View> views;
  views.reserve(shift.size());
  for (const Vec3<float>& s : shift) views.push_back({rec.camera.eye + s, rec.camera.target + s, fov, unit});
  return views;
}

std::vector<View> plan_turntable(const scene::Recording& rec, float aspect, int per_revolution) {
  constexpr float kDown = 0.16f;  // sine of the pitch
  const float start = -0.62f;     // rad: a little from the figure's right
  std::vector<View> views =
      follow(rec, boxes_of(rec), Vec3<float>(std::sqrt(1 - kDown * kDown), 0, kDown), 0.5f, aspect, true);
  for (std::size_t n = 0; n < views.size(); ++n) {
    const double turn = per_revolution > 0 ? 2 * 3.14159265358979 * double(n) / double(per_revolution) : 0;
    const Quat<float> around(Eigen::AngleAxisf(start + float(turn), Vec3<float>::UnitZ()));
    views[n].eye = views[n].target + around * (views[n].eye - views[n].target);
  }
  return views;
}

float lowest_point(const scene::Recording& rec, std::size_t frames) {
  Box box;
  for (std::size_t n = 0; n < frames; ++n)
    for (std::size_t c = 0; c < rec.characters.size(); ++c)
      add_character(*rec.characters[c], rec.frames[n].characters[c], box);
  return box.low.z();
}

}  // namespace sinew::render
