#include "sinew/behaviour/stance.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "sinew/animation/inverse_kinematics.h"
#include "sinew/animation/model_motion_job.h"
#include "sinew/animation/soft_limits.h"
#include "sinew/effects/contact.h"
#include "sinew/effects/joint_limit.h"
#include "sinew/skeleton/rotation.h"

namespace sinew {
namespace {

constexpr double kLevel = 0.02;  ///< m over the lowest point of a foot at rest: what may stand
constexpr double kTip = 0.7;     ///< of the way to their farthest point, from which toes end
constexpr double kSoft = 1e-3;   ///< m, in which a sole begins to be lifted
constexpr int kRounds = 3;       ///< in which the root comes to where the centre of mass is wanted

Transform<double> rest_of(const Skeleton& skeleton, int joint) {
  Transform<double> rest;
  for (int i = joint; i >= 0; i = skeleton.joints[static_cast<std::size_t>(i)].parent)
    rest = skeleton.joints[static_cast<std::size_t>(i)].rest * rest;
  return rest;
}

/// Points of a foot and its toes that are lowest at rest.
template <class T>
std::vector<SolePoint<T>> sole_of(const Skeleton& skeleton, int foot, int toes) {
  const Transform<double> at = rest_of(skeleton, foot);
  std::vector<std::pair<int, Vec3<double>>> low;
  double lowest = std::numeric_limits<double>::infinity();
  for (const Collider& collider : skeleton.colliders) {
    if (collider.joint != foot && collider.joint != toes) continue;
    std::vector<ContactPoint<double>> points;
    append_contact_points<double>(collider, points);
    for (const ContactPoint<double>& p : points) {
      if (!p.meets_plane()) continue;
      low.emplace_back(p.body, rest_of(skeleton, p.body) * p.local - Vec3<double>(0, 0, p.radius));
      lowest = std::min(lowest, low.back().second.z());
    }
  }
  std::vector<SolePoint<T>> sole;
  for (const auto& [joint, p] : low)
    if (p.z() < lowest + kLevel)
      sole.push_back({joint, (rest_of(skeleton, joint).inverse() * p).template cast<T>(),
                      (at.inverse() * p).template cast<T>()});
  return sole;
}

/// Points of toes that are far from their joint: who turns that lifts them.
template <class T>
std::vector<SolePoint<T>> tips_of(const std::vector<SolePoint<T>>& sole, int toes) {
  T farthest = T(0);
  for (const SolePoint<T>& p : sole)
    if (p.joint == toes) farthest = std::max(farthest, p.local.norm());
  std::vector<SolePoint<T>> tips;
  for (const SolePoint<T>& p : sole)
    if (p.joint == toes && p.local.norm() > T(kTip) * farthest) tips.push_back(p);
  return tips;
}

/// Turns the foot to where it is wanted, whatever the leg above it does, as far from the clip's as its ankle
/// can.
template <class T>
void set_foot(const StandingBody<T>& body, std::size_t side, const MovingRotation<T>& foot,
              std::span<JointJet<T>> jets) {
  const auto joint = static_cast<std::size_t>(body.legs[side].foot);
  const MovingTransform<T> above = model_motion<T>(jets, body.parents, body.parents[joint]);
  const JointJet<T> clip = jets[joint];
  JointJet<T>& now = jets[joint];
  set_rotation<T>(above.rotation.conjugate() * foot, now);
  const Ankle<T>& ankle = body.ankles[side];
  if (ankle.most < T(0)) return;
  const Quat<T> unrest = ankle.rest.conjugate();
  const T wanted = swing_angle<T>(unrest * now.rotation, ankle.axis),
          had = swing_angle<T>(unrest * clip.rotation, ankle.axis);
  if (wanted <= ankle.most || wanted <= had) return;
  const T share = std::max(ankle.most - had, T(0)) / (wanted - had);
  const Vec3<T> off = rotation_log<T>(clip.rotation.conjugate() * now.rotation);
  now.rotation = clip.rotation * rotation_exp<T>(share * off);
  now.omega = clip.omega + share * (now.omega - clip.omega);
  now.alpha = clip.alpha + share * (now.alpha - clip.alpha);
}

/// Brings an ankle to its place by the joints above it, and the foot as it is wanted.
template <class T>
void reach_foot(const StandingBody<T>& body, std::size_t side, const MovingVector<T>& ankle,
                const MovingRotation<T>& foot, std::span<JointJet<T>> jets) {
  const FootLeg<T>& leg = body.legs[side];
  TwoBoneJob<T> reach{body.parents, jets, leg.upper, leg.middle, leg.foot, ankle};
  reach.pole = model_motion<T>(jets, body.parents, leg.upper).rotation * still<T>(leg.bend);
  reach.hinge = leg.hinge;
  reach.keep_end = false;
  (void)reach.Run();
  set_foot<T>(body, side, foot, jets);
}

/// m, by which the lowest of those points that are a joint's is below a ground, softly; 0 where none is.
template <class T>
TimeJet<T> below(std::span<const SolePoint<T>> points, int joint, const MovingTransform<T>& at, T ground) {
  TimeJet<T> deepest{T(0)};
  for (const SolePoint<T>& p : points)
    if (p.joint == joint)
      deepest =
          soft_max<T>(deepest, TimeJet<T>(ground) - MovingVector<T>(at * still<T>(p.local)).z(), T(kSoft));
  return deepest;
}

/// Bends toes up whose tips are below a ground.
template <class T>
void lift_tips(const StandingBody<T>& body, std::size_t side, T ground, std::span<JointJet<T>> jets) {
  const std::vector<SolePoint<T>>& tips = body.tips[side];
  if (tips.empty()) return;
  const auto joint = static_cast<std::size_t>(tips[0].joint);
  const MovingTransform<T> foot = model_motion<T>(jets, body.parents, body.parents[joint]);
  const MovingTransform<T> toes = foot * moving_transform<T>(jets[joint]);
  Vec3<T> tip = Vec3<T>::Zero();
  for (const SolePoint<T>& p : tips) tip += p.local / T(tips.size());
  const MovingVector<T> reach = toes.rotation * still<T>(tip);
  MovingVector<T> lifted = reach;
  lifted.z() += below<T>(tips, tips[0].joint, toes, ground);
  set_rotation<T>(foot.rotation.conjugate() * (shortest_arc<T>(reach, lifted) * toes.rotation), jets[joint]);
}

/// The root's motion, turned a little about world axes.
template <class T>
JointJet<T> turned(const JointJet<T>& root, const MovingVector<double>& turn) {
  MovingTransform<T> out = moving_transform<T>(root);
  out.rotation = turned_by(cast_motion<T>(turn)) * out.rotation;
  return joint_jet<T>(out);
}

}  // namespace

template <class T>
Status StandingBody<T>::find(const Skeleton& skeleton) {
  for (const Joint& joint : skeleton.joints) {
    parents.push_back(joint.parent);
    mass.push_back(static_cast<T>(joint.mass));
    center_of_mass.push_back(joint.center_of_mass.template cast<T>());
    total_mass += joint.mass;
  }
  if (!(total_mass > 0)) return Status::error(Code::kInvalidArgument, "a body without mass");
  for (T& m : mass) m /= static_cast<T>(total_mass);
  double sole = std::numeric_limits<double>::infinity();
  for (std::size_t side = 0; side < 2; ++side) {
    FootLeg<T>& leg = legs[side];
    if (Status status = find_foot_leg<T>(skeleton, side == 0 ? Role::kFootL : Role::kFootR, leg); !status)
      return status;
    const Joint& foot = skeleton.joints[static_cast<std::size_t>(leg.foot)];
    ankles[side] = {foot.rest.rotation.template cast<T>(), foot.swing_axis.template cast<T>(),
                    static_cast<T>(foot.type == JointType::kBall ? foot.swing_limit : -1)};
    const int toes = skeleton.find(side == 0 ? Role::kToesL : Role::kToesR);
    soles[side] = sole_of<T>(skeleton, leg.foot, toes);
    if (soles[side].empty())
      return Status::error(Code::kInvalidArgument, "a foot without colliders", leg.foot);
    tips[side] = tips_of<T>(soles[side], toes);
    const Transform<double> hip = rest_of(skeleton, leg.upper), knee = rest_of(skeleton, leg.middle),
                            ankle = rest_of(skeleton, leg.foot);
    leg_length[side] =
        (knee.translation - hip.translation).norm() + (ankle.translation - knee.translation).norm();
    sole_up[side] = ankle.rotation.conjugate() * Vec3<double>::UnitZ();
    sole = std::min(sole, lowest_of(side, ankle));
  }
  height = skeleton.joints[0].rest.translation.z() - sole;
  return {};
}

template <class T>
MassMotion StandingBody<T>::mass_of(std::span<const Transform<T>> model) const {
  MassMotion sum;
  for (std::size_t i = 0; i < mass.size(); ++i)
    if (mass[i] > T(0)) sum.place += double(mass[i]) * (model[i] * center_of_mass[i]).template cast<double>();
  return sum;
}

template <class T>
MassMotion StandingBody<T>::mass_of(std::span<const JointJet<T>> jets,
                                    std::span<MovingTransform<T>> model) const {
  (void)ModelMotionJob<T>{.parents = parents, .jets = jets, .model = model}.Run();
  MassMotion sum;
  for (std::size_t i = 0; i < mass.size(); ++i) {
    if (!(mass[i] > T(0))) continue;
    const MovingVector<T> center = model[i] * still<T>(center_of_mass[i]);
    sum.place += double(mass[i]) * value_of(center).template cast<double>();
    sum.velocity += double(mass[i]) * rate_of(center).template cast<double>();
    sum.acceleration += double(mass[i]) * acceleration_of(center).template cast<double>();
  }
  return sum;
}

template <class T>
void StandingBody<T>::add_sole(int foot, const Transform<double>& place, Sole& sole) const {
  for (const SolePoint<T>& p : soles[static_cast<std::size_t>(foot)])
    sole.add((place * Vec3<double>(p.on_foot.template cast<double>())).template head<2>());
}

template <class T>
template <class U, class Place>
double StandingBody<T>::lowest(std::size_t foot, const Place& place_of) const {
  U low = std::numeric_limits<U>::infinity();
  for (const SolePoint<T>& p : soles[foot]) low = std::min(low, place_of(p).z());
  return double(low);
}

template <class T>
double StandingBody<T>::lowest_of(std::size_t foot, const Transform<double>& place) const {
  return lowest<double>(foot, [&](const SolePoint<T>& p) {
    return Vec3<double>(place * Vec3<double>(p.on_foot.template cast<double>()));
  });
}

template <class T>
double StandingBody<T>::lowest_of(std::size_t foot, std::span<const Transform<T>> model) const {
  return lowest<T>(foot, [&](const SolePoint<T>& p) {
    return Vec3<T>(model[static_cast<std::size_t>(p.joint)] * p.local);
  });
}

template <class T>
double StandingBody<T>::lowest_of(std::size_t foot, std::span<const MovingTransform<T>> model) const {
  return lowest<T>(foot, [&](const SolePoint<T>& p) {
    const MovingTransform<T>& at = model[static_cast<std::size_t>(p.joint)];
    return Vec3<T>(at.rotation.value * p.local + value_of(at.translation));
  });
}

template <class T>
void take_stance(const StandingBody<T>& body, const Stance& stance, std::span<JointJet<T>> jets,
                 std::span<MovingTransform<T>> model) {
  const JointJet<T> root = jets[0];
  std::array<std::array<JointJet<T>, 3>, 2> legs;
  const auto leg_joint = [&](std::size_t side, std::size_t n) -> JointJet<T>& {
    const FootLeg<T>& leg = body.legs[side];
    return jets[static_cast<std::size_t>(n == 0 ? leg.upper : n == 1 ? leg.middle : leg.foot)];
  };
  for (std::size_t side = 0; side < 2; ++side)
    for (std::size_t n = 0; n < 3; ++n) legs[side][n] = leg_joint(side, n);
  JointJet<T> stands = turned<T>(root, stance.turn);
  stands.translation.z() += static_cast<T>(stance.height.value);
  stands.velocity.z() += static_cast<T>(stance.height.rate);
  stands.acceleration.z() += static_cast<T>(stance.height.acceleration);
  stands.acceleration.template head<2>() = stance.body_acceleration.cast<T>();
  for (int round = 0; round < kRounds; ++round) {
    const MassMotion is = body.mass_of(jets, model);
    const Vec2 off = stance.body - is.place.head<2>(), slow = stance.body_velocity - is.velocity.head<2>();
    stands.translation.template head<2>() = (jets[0].translation.template head<2>() + off.cast<T>()).eval();
    stands.velocity.template head<2>() = (jets[0].velocity.template head<2>() + slow.cast<T>()).eval();
    jets[0] = stands;
    for (std::size_t side = 0; side < 2; ++side) {
      for (std::size_t n = 0; n < 3; ++n) leg_joint(side, n) = legs[side][n];
      reach_foot<T>(body, side, cast_motion<T>(stance.ankle[side]), {stance.foot[side].template cast<T>()},
                    jets);
    }
  }
}

template <class T>
void take_feet(const StandingBody<T>& body, const MovingVector<double>& shift,
               const MovingVector<double>& turn, const std::array<MovingTransform<T>, 2>& feet,
               std::span<JointJet<T>> jets) {
  MovingTransform<T> root = moving_transform<T>(turned<T>(jets[0], turn));
  root.translation = root.translation + cast_motion<T>(shift);
  jets[0] = joint_jet<T>(root);
  for (std::size_t side = 0; side < 2; ++side)
    reach_foot<T>(body, side, feet[side].translation, feet[side].rotation, jets);
}

template <class T>
void lift_soles(const StandingBody<T>& body, T ground, std::span<JointJet<T>> jets) {
  for (std::size_t side = 0; side < 2; ++side) {
    const int joint = body.legs[side].foot;
    MovingTransform<T> foot = model_motion<T>(jets, body.parents, joint);
    foot.translation.z() += below<T>(body.soles[side], joint, foot, ground);
    reach_foot<T>(body, side, foot.translation, foot.rotation, jets);
    lift_tips<T>(body, side, ground, jets);
  }
}

template struct StandingBody<float>;
template struct StandingBody<double>;
template void take_stance<float>(const StandingBody<float>&, const Stance&, std::span<JointJet<float>>,
                                 std::span<MovingTransform<float>>);
template void lift_soles<float>(const StandingBody<float>&, float, std::span<JointJet<float>>);
template void lift_soles<double>(const StandingBody<double>&, double, std::span<JointJet<double>>);
template void take_feet<float>(const StandingBody<float>&, const MovingVector<double>&,
                               const MovingVector<double>&, const std::array<MovingTransform<float>, 2>&,
                               std::span<JointJet<float>>);
template void take_feet<double>(const StandingBody<double>&, const MovingVector<double>&,
                                const MovingVector<double>&, const std::array<MovingTransform<double>, 2>&,
                                std::span<JointJet<double>>);
template void take_stance<double>(const StandingBody<double>&, const Stance&, std::span<JointJet<double>>,
                                  std::span<MovingTransform<double>>);

}  // namespace sinew
