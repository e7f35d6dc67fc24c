#include "retarget/reach.h"

#include <algorithm>
#include <cmath>

#include "sinew/animation/inverse_kinematics.h"
#include "sinew/skeleton/rotation.h"

namespace sinew::retarget {

const Limb kLimbs[4] = {{Role::kThighL, Role::kShinL, Role::kFootL, true},
                        {Role::kThighR, Role::kShinR, Role::kFootR, true},
                        {Role::kUpperArmL, Role::kForearmL, Role::kHandL, false},
                        {Role::kUpperArmR, Role::kForearmR, Role::kHandR, false}};

namespace {

constexpr double kStraight = 0.9985;  ///< of the length: where TwoBoneJob with kSoftness begins to slow down
constexpr double kSoftness = 0.001;
constexpr double kMargin = 0.002;   ///< of the length: over which a limb slows down before `longest`
constexpr double kBend = 0.3;       ///< of the upper bone: how far a limb that walks bends to the side
constexpr double kLearns = 0.01;    ///< of the upper bone, squared: bend from which on a plane can be seen
constexpr double kFromStop = 0.01;  ///< rad that a hinge keeps from the end of its range

bool is_hinge(const Joint& joint) {
  return joint.type == JointType::kRevolute;
}
bool flexes_forwards(const Joint& joint) {
  return joint.dofs[0].upper >= -joint.dofs[0].lower;
}

}  // namespace

Reach::Reach(const PoseMap& map, const Limb& limb)
    : map_(map),
      upper_(map.to[limb.upper].joints.front()),
      middle_(map.to[limb.middle].joints.front()),
      end_(map.to[limb.end].joints.front()) {
  for (const Joint& joint : map.target->joints) parents_.push_back(joint.parent);
  const Vec3<double>& knee = map.to_rest[middle_].translation;
  const Vec3<double> second = map.to_rest[end_].translation - knee;
  const Vec3<double> first = knee - map.to_rest[upper_].translation;
  length_ = first.norm() + second.norm();
  const Joint& joint = map.target->joints[middle_];
  Vec3<double> pole = Vec3<double>::Zero();
  if (is_hinge(joint)) {
    const Vec3<double> axis = map.to_rest[middle_].rotation * joint.axis;
    pole = (flexes_forwards(joint) ? -1 : 1) * axis.cross(second);
  }
  if (pole.norm() < 0.1 * second.norm()) {
    const Vec3<double> left = map.to_rest[map.to[Role::kThighL].joints.front()].translation -
                              map.to_rest[map.to[Role::kThighR].joints.front()].translation;
    pole = (limb.leg ? 1 : -1) * left.cross(Vec3<double>::UnitZ());
  }
  pole_ = map.to_rest[upper_].rotation.conjugate() * pole.normalized();
  find_range();
}

double Reach::reach_at(double angle) const {
  const Vec3<double>& knee = map_.to_rest[middle_].translation;
  const Quat<double>& rest = map_.to_rest[middle_].rotation;
  const Quat<double> turn =
      rest * rotation_exp<double>(angle * map_.target->joints[middle_].axis) * rest.conjugate();
  return (knee + turn * (map_.to_rest[end_].translation - knee) - map_.to_rest[upper_].translation).norm();
}

void Reach::find_range() {
  longest_ = kStraight * length_;
  const Joint& joint = map_.target->joints[middle_];
  if (!is_hinge(joint) || joint.dofs[0].upper - joint.dofs[0].lower > 6) return;
  constexpr int kSteps = 200;
  double most = 0, least = 1e300;
  const double low = joint.dofs[0].lower + kFromStop, high = joint.dofs[0].upper - kFromStop;
  for (int k = 0; k <= kSteps && low < high; ++k) {
    const double reach = reach_at(low + (high - low) * k / kSteps);
    most = std::max(most, reach);
    least = std::min(least, reach);
  }
  if (most > 0 && least < most) shortest_ = least;
  if (most > 0) longest_ = std::min(longest_, most);
}

void Reach::turn_as_hinge(Transform<double>& local) const {
  const Joint& joint = map_.target->joints[middle_];
  if (!is_hinge(joint)) return;
  const double angle = twist_angle<double>(joint.rest.rotation.conjugate() * local.rotation, joint.axis);
  local.rotation =
      joint.rest.rotation *
      rotation_exp<double>(std::clamp(angle, joint.dofs[0].lower, joint.dofs[0].upper) * joint.axis);
}

void Reach::learn_plane(const std::vector<std::vector<Transform<double>>>& local) {
  Vec3<double> sum = Vec3<double>::Zero();
  double weights = 0;
  for (const auto& frame : local) {
    const std::vector<Transform<double>> model = model_of(*map_.target, frame);
    const Vec3<double> bone = model[middle_].translation - model[upper_].translation;
    const Vec3<double> along = (model[end_].translation - model[upper_].translation).normalized();
    const Vec3<double> side = bone - along * along.dot(bone);
    sum += side.norm() * (model[upper_].rotation.conjugate() * side);
    weights += bone.squaredNorm();
  }
  // Of a limb that hardly bends nothing is learnt, nor of one that bends the other way.
  if (!(weights > 0) || sum.norm() < kLearns * weights || sum.normalized().dot(pole_) < 0) return;
  pole_ = sum.normalized();
}

bool Reach::solve(const Vec3<double>& goal, double learnt, std::span<Transform<double>> local) const {
  std::vector<Transform<double>> model = model_of(*map_.target, local);
  const Quat<double> kept = model[end_].rotation;
  const Vec3<double> from = model[upper_].translation;
  Vec3<double> way = goal - from;
  const double far = way.norm(), margin = kMargin * length_, begin = longest_ - margin;
  if (!(far > 1e-6)) return false;
  const Vec3<double> along = way / far;
  if (far < shortest_) way = along * shortest_;
  if (far > begin) way = along * (begin + margin * (far - begin) / (far - begin + margin));
  const Vec3<double> bone = model[middle_].translation - from;
  const Vec3<double> pole = (1 - learnt) * (bone - along * along.dot(bone)) +
                            learnt * kBend * bone.norm() * (model[upper_].rotation * pole_);

  std::vector<Transform<double>> turned(local.begin(), local.end());
  turn_as_hinge(turned[middle_]);
  std::vector<JointJet<double>> jets(turned.size());
  for (std::size_t j = 0; j < jets.size(); ++j) {
    jets[j].rotation = turned[j].rotation;
    jets[j].translation = turned[j].translation;
  }
  TwoBoneJob<double> job;
  job.parents = parents_;
  job.jets = jets;
  job.upper = upper_;
  job.middle = middle_;
  job.end = end_;
  job.target = still<double>(from + way);
  job.pole = still<double>(pole);
  job.softness = kSoftness;
  if (is_hinge(map_.target->joints[middle_])) job.hinge = map_.target->joints[middle_].axis;
  if (!job.Run()) return false;
  for (const int j : {upper_, middle_}) local[j].rotation = jets[j].rotation.normalized();
  model = model_of(*map_.target, local);
  local[end_].rotation = (model[parents_[end_]].rotation.conjugate() * kept).normalized();
  return true;
}

double beyond_range(const Joint& joint, const Quat<double>& local) {
  const double angle = twist_angle<double>(joint.rest.rotation.conjugate() * local, joint.axis);
  return std::max(angle - joint.dofs[0].upper, joint.dofs[0].lower - angle);
}

}  // namespace sinew::retarget
