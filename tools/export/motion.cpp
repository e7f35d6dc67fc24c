#include "export/motion.h"

#include <algorithm>
#include <cmath>

#include "sinew/animation/curve_job.h"
#include "sinew/animation/sampling_job.h"

namespace sinew::exporting {
namespace {

std::vector<double> key_times(double duration, double rate, Keys keys) {
  std::vector<double> times{0};
  if (!(duration > 0)) return times;
  if (keys == Keys::kEven) {
    const auto spans = std::max(1L, std::lround(duration * rate));
    for (long k = 1; k <= spans; ++k) times.push_back(duration * double(k) / double(spans));
    return times;
  }
  constexpr double kRounding = 1e-3;  // of a key's interval: the end is a key of the grid
  for (long k = 1; double(k) < duration * rate - kRounding; ++k) times.push_back(double(k) / rate);
  times.push_back(duration);
  return times;
}

}  // namespace

Motion sample_clip(const Asset& asset, const Clip& clip, double rate, Keys keys) {
  Motion motion{clip.name, &clip, key_times(double(clip.duration), rate, keys), {}};
  for (const double t : motion.times) {
    std::vector<JointJet<double>> frame(asset.skeleton.joints.size());
    SamplingJob<double> job;
    job.clip = &clip;
    job.time = t;
    job.jets = frame;
    (void)job.Run();  // clip and sizes are valid: the asset is
    motion.frames.push_back(std::move(frame));
    std::vector<TimeJet<double>> jets(asset.curve_slots.size());
    (void)CurveJob<double>{&clip, t, asset.curve_slots, jets}.Run();
    std::vector<double>& values = motion.curves.emplace_back();
    for (const TimeJet<double>& jet : jets) values.push_back(jet.value);
  }
  return motion;
}

Motion played_motion(const scene::Recording& recording, int character, const std::string& name) {
  const auto n = static_cast<std::size_t>(character);
  const Asset& asset = *recording.characters[n];
  const std::vector<Joint>& joints = asset.skeleton.joints;
  Motion motion{name, nullptr, {}, {}};
  for (const scene::Frame& from : recording.frames) {
    std::vector<JointJet<double>> frame(joints.size());
    const std::vector<Transform<float>>& model = from.characters[n].model;
    for (std::size_t j = 0; j < joints.size(); ++j) {
      Transform<double> local = model[j].cast<double>();
      if (const int parent = joints[j].parent; parent >= 0)
        local = model[static_cast<std::size_t>(parent)].cast<double>().inverse() * local;
      frame[j].rotation = local.rotation.normalized();
      frame[j].translation = local.translation;
    }
    motion.times.push_back(from.time);
    motion.frames.push_back(std::move(frame));
    std::vector<double>& values = motion.curves.emplace_back();
    for (std::size_t slot = 0; slot < asset.curve_slots.size(); ++slot)
      values.push_back(double(from.characters[n].curve(asset, slot)));
  }
  return motion;
}

std::vector<Transform<double>> model_pose(const Skeleton& skeleton,
                                          const std::vector<JointJet<double>>& frame) {
  std::vector<Transform<double>> model;
  for (std::size_t j = 0; j < skeleton.joints.size(); ++j) {
    const Transform<double> local{frame[j].rotation, frame[j].translation};
    const int parent = skeleton.joints[j].parent;
    model.push_back(parent < 0 ? local : model[static_cast<std::size_t>(parent)] * local);
  }
  return model;
}

std::vector<Transform<double>> rest_pose(const Skeleton& skeleton) {
  std::vector<Transform<double>> model;
  for (const Joint& joint : skeleton.joints)
    model.push_back(joint.parent < 0 ? joint.rest
                                     : model[static_cast<std::size_t>(joint.parent)] * joint.rest);
  return model;
}

Quat<double> to_y_up() {
  return {0.5, -0.5, -0.5, -0.5};  // (x, y, z) → (y, z, x)
}

}  // namespace sinew::exporting
