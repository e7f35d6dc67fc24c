#include "retarget/sole.h"

#include <algorithm>
#include <cmath>

#include "convert/contact_windows.h"
#include "retarget/pose_map.h"
#include "sinew/animation/sampling_job.h"

namespace sinew::retarget {

Motion sample_motion(const Clip& clip, const Skeleton& skeleton, double least_rate) {
  Motion motion;
  motion.loops = clip.loops;
  double rate = least_rate;
  for (const Clip::Group& group : clip.groups)
    if (group.knot_interval > 0) rate = std::max(rate, std::min(240.0, 2 / double(group.knot_interval)));
  const int frames = std::max(0, static_cast<int>(std::ceil(double(clip.duration) * rate - 1e-6)));
  motion.rate = frames > 0 ? frames / double(clip.duration) : rate;
  for (int f = 0; f <= frames; ++f) {
    std::vector<Transform<double>> local(skeleton.joints.size());
    SamplingJob<double> job;
    job.clip = &clip;
    job.time = f < frames ? f / motion.rate : double(clip.duration);
    job.poses = local;
    if (!job.Run()) return {};
    motion.model.push_back(model_of(skeleton, local));
    motion.local.push_back(std::move(local));
  }
  return motion;
}

namespace {
constexpr double kSharper = 0.3;  ///< of the patch's width: over which its height is a mean
}

Sole::Sole(const Skeleton& skeleton, int foot) : joint(foot), points(convert::points_below(skeleton, foot)) {
  if (!points.empty()) return;
  points.emplace_back();
  points.back().body = foot;
}

Patch patch_of(const Sole& sole, std::span<const Transform<double>> model, double width) {
  Patch patch;
  double lowest = 1e300;
  for (const ContactPoint<double>& p : sole.points) {
    patch.at.emplace_back(model[p.body] * p.local - model[sole.joint].translation -
                          p.radius * Vec3<double>::UnitZ());
    lowest = std::min(lowest, patch.at.back().z());
  }
  double sum = 0, sharp_sum = 0;
  for (const Vec3<double>& at : patch.at) {
    patch.share.push_back(std::exp(-(at.z() - lowest) / width));
    sum += patch.share.back();
    const double sharp = std::exp(-(at.z() - lowest) / (kSharper * width));
    sharp_sum += sharp;
    patch.low += sharp * at.z();
  }
  patch.low /= sharp_sum;
  for (double& share : patch.share) share /= sum;
  return patch;
}

Vec3<double> slip(const Patch& before, const Patch& after, const Vec3<double>& travel) {
  Vec3<double> sum = travel;
  for (std::size_t k = 0; k < before.at.size(); ++k)
    sum += (before.share[k] + after.share[k]) / 2 * (after.at[k] - before.at[k]);
  return {sum.x(), sum.y(), 0};
}

}  // namespace sinew::retarget
