#include "sinew/behaviour/get_up_clips.h"

#include <algorithm>
#include <limits>
#include <string_view>

#include "sinew/behaviour/sole.h"
#include "sinew/effects/contact.h"

namespace sinew {
namespace {

constexpr double kEntered =
    0.2;  ///< of a clip, until which it may be entered: who lies does not come into a later pose
constexpr double kEvery = 0.1;    ///< s from one entry to the next
constexpr double kBears = 0.02;   ///< m over the lowest point: what bears
constexpr double kInside = 0.01;  ///< m, of the centre of mass inside what bears
constexpr double kAsNear = 0.08;  ///< m, as far off as another pose, or no further off than that
constexpr double kReach = 0.25;   ///< m off the nearest entry, from which a roll is looked for

bool begins_with(const std::string& name, std::string_view word) {
  return name.compare(0, word.size(), word) == 0;
}

/// Whether a pose's centre of mass is over what touches the ground.
template <class T>
bool bears(const Skeleton& skeleton, std::span<const Transform<T>> model, double unit) {
  std::vector<Vec3<double>> low;
  double lowest = std::numeric_limits<double>::infinity();
  for (const Collider& collider : skeleton.colliders) {
    std::vector<ContactPoint<double>> points;
    append_contact_points<double>(collider, points);
    for (const ContactPoint<double>& p : points) {
      if (!p.meets_plane()) continue;
      const Transform<T>& joint = model[static_cast<std::size_t>(p.body)];
      low.push_back((joint * Vec3<T>(p.local.template cast<T>())).template cast<double>() -
                    Vec3<double>(0, 0, p.radius));
      lowest = std::min(lowest, low.back().z());
    }
  }
  Sole ground;
  for (const Vec3<double>& p : low)
    if (p.z() < lowest + kBears * unit) ground.add(from_above(p));
  ground.close();
  Vec3<double> center = Vec3<double>::Zero();
  for (std::size_t i = 0; i < skeleton.joints.size(); ++i)
    center +=
        skeleton.joints[i].mass / skeleton.total_mass() *
        (model[i] * Vec3<T>(skeleton.joints[i].center_of_mass.template cast<T>())).template cast<double>();
  return ground.depth(from_above(center)) > kInside * unit;
}

}  // namespace

template <class T>
void GetUpClips<T>::prepare(const Skeleton& skeleton, std::span<const Clip> clips, double unit) {
  unit_ = unit;
  variants_.clear();
  entries_.clear();
  poses_.clear();
  parents_.clear();
  points_ = {};
  points_.prepare(skeleton, unit);
  for (const Joint& joint : skeleton.joints) parents_.push_back(joint.parent);
  const bool sides = bool(build_mirror_map<T>(skeleton, mirror_));
  std::vector<JointJet<T>> jets(skeleton.joints.size());
  std::vector<Transform<T>> model(skeleton.joints.size());
  for (const Clip& clip : clips) {
    const bool rolls = begins_with(clip.name, "roll");
    if (!rolls && !begins_with(clip.name, "get_up")) continue;
    if (static_cast<std::size_t>(clip.joint_count) != skeleton.joints.size()) continue;
    add(skeleton, {&clip, false, rolls, 0}, jets, model);
    if (sides) add(skeleton, {&clip, true, rolls, 0}, jets, model);
  }
}

template <class T>
void GetUpClips<T>::add(const Skeleton& skeleton, const GetUpVariant& variant, std::span<JointJet<T>> jets,
                        std::span<Transform<T>> model) {
  if (variants_.size() == kMostVariants) return;
  const int index = static_cast<int>(variants_.size());
  variants_.push_back(variant);
  sample(index, ClipTime{double(variant.clip->duration), 0, 0}, jets);
  variants_.back().end_height = double(jets[0].translation.z());
  std::vector<Vec3<double>> points(points_.count());
  bool any = false;
  for (double time = 0; time <= kEntered * double(variant.clip->duration); time += kEvery) {
    sample(index, ClipTime{time, 0, 0}, jets);
    place(jets, model, points);
    if (!bears<T>(skeleton, model, unit_)) continue;
    any = true;
    entries_.push_back({index, time});
    poses_.insert(poses_.end(), points.begin(), points.end());
  }
  if (any) return;
  sample(index, ClipTime{0, 0, 0}, jets);
  place(jets, model, points);
  entries_.push_back({index, 0});
  poses_.insert(poses_.end(), points.begin(), points.end());
}

template <class T>
std::span<const Vec3<double>> GetUpClips<T>::pose(int entry) const {
  return std::span(poses_).subspan(static_cast<std::size_t>(entry) * points_.count(), points_.count());
}

template <class T>
Fit GetUpClips<T>::fit(int entry, std::span<const Vec3<double>> is) const {
  return fit_pose(points_.mass(), pose(entry), is);
}

template <class T>
GetUpChoice GetUpClips<T>::choose(std::span<const Vec3<double>> is, std::uint32_t tried, bool turns) const {
  GetUpChoice up, roll;
  for (int n = 0; n < static_cast<int>(entries_.size()); ++n) {
    const int variant = entry(n).variant;
    if ((tried >> variant) & 1u) continue;

    GetUpChoice& best = variants_[static_cast<std::size_t>(variant)].rolls ? roll : up;
    const Fit found = fit(n, is);
    if (best.entry < 0 || found.off < best.fit.off) best = {n, found};
  }
  if (roll.entry < 0) return up;
  if (up.entry < 0) return roll;
  const double nearer = up.fit.off - roll.fit.off;  // m, is the roll
  const bool far = up.fit.off > kReach * unit_;
  return (far && nearer > 0) || (turns && nearer > -kAsNear * unit_) ? roll : up;
}

template <class T>
void GetUpClips<T>::sample(int variant, const ClipTime& time, std::span<JointJet<T>> jets) const {
  const GetUpVariant& of = variants_[static_cast<std::size_t>(variant)];
  (void)SamplingJob<T>{of.clip, time, jets}.Run();
  if (of.mirrored) (void)MirrorJob<T>{&mirror_, jets, jets}.Run();
}

template <class T>
void GetUpClips<T>::place(std::span<const JointJet<T>> jets, std::span<Transform<T>> model,
                          std::span<Vec3<double>> out) const {
  for (std::size_t i = 0; i < jets.size(); ++i) {
    const Transform<T> local{jets[i].rotation, jets[i].translation};
    model[i] = parents_[i] < 0 ? local : model[static_cast<std::size_t>(parents_[i])] * local;
  }
  points_.place(model, out);
}

template class GetUpClips<float>;
template class GetUpClips<double>;

}  // namespace sinew
