#include "retarget/landing.h"

#include <algorithm>
#include <cmath>

#include "retarget/reach.h"
#include "retarget/sole.h"
#include "sinew/animation/sampling_job.h"

namespace sinew::retarget {
namespace {

constexpr double kRate = 120;           ///< frames a second
constexpr double kPatch = 0.002 / 0.9;  ///< of the leg's length

std::vector<Transform<double>> model_at(const Clip& clip, const Skeleton& skeleton, double time,
                                        std::vector<Transform<double>>& local) {
  local.resize(skeleton.joints.size());
  SamplingJob<double> job;
  job.clip = &clip;
  job.time = time;
  job.poses = local;
  if (!job.Run()) return {};
  return model_of(skeleton, local);
}

double lowest_point(const Sole& sole, std::span<const Transform<double>> model) {
  double low = 1e300;
  for (const ContactPoint<double>& p : sole.points)
    low = std::min(low, (model[p.body] * p.local).z() - p.radius);
  return low;
}

void look_at(const Clip& clip, const Skeleton& skeleton, const ContactWindow& window, double floor,
             const Vec3<double>& carried, double width, Landing& landing) {
  const Sole sole(skeleton, window.joint);
  const int count = std::max(1, static_cast<int>(std::lround(double(window.end - window.begin) * kRate)));
  const double step = double(window.end - window.begin) / count;
  Vec3<double> moved = Vec3<double>::Zero(), before = moved;
  Patch last;
  std::vector<Vec3<double>> path;
  std::vector<Transform<double>> local;
  for (int f = 0; f <= count; ++f) {
    const auto model = model_at(clip, skeleton, double(window.begin) + f * step, local);
    if (model.empty()) return;
    const double height = lowest_point(sole, model) - floor;
    landing.lowest = std::min(landing.lowest, height);
    landing.highest = std::max(landing.highest, height);
    Patch patch = patch_of(sole, model, width);
    const Vec3<double> at = model[window.joint].translation;
    if (f > 0) moved += slip(last, patch, at - before) - step * carried;
    path.push_back(moved);
    for (const Vec3<double>& earlier : path)
      landing.slide = std::max(landing.slide, (moved - earlier).norm());
    last = std::move(patch);
    before = at;
  }
}

}  // namespace

Landing landing_of(const Clip& clip, const Skeleton& skeleton, const BodyMap& map, double floor,
                   const Vec3<double>& carried, double leg) {
  Landing landing;
  landing.lowest = 1e300;
  landing.highest = -1e300;
  for (const ContactWindow& window : clip.contacts) {
    look_at(clip, skeleton, window, floor, carried, kPatch * leg, landing);
    ++landing.windows;
  }
  if (landing.windows == 0) landing.lowest = landing.highest = 0;
  std::vector<Transform<double>> local;
  landing.beyond = -1e300;
  const int frames = static_cast<int>(double(clip.duration) * kRate);
  for (int f = 0; f <= frames; ++f) {
    if (model_at(clip, skeleton, f / kRate, local).empty()) break;
    for (const Role role : {Role::kShinL, Role::kShinR}) {
      const int knee = map[role].joints.front();
      if (skeleton.joints[knee].type == JointType::kRevolute)
        landing.beyond = std::max(landing.beyond, beyond_range(skeleton.joints[knee], local[knee].rotation));
    }
  }
  landing.beyond = std::max(landing.beyond, 0.0);
  return landing;
}

}  // namespace sinew::retarget
