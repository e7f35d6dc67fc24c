#include "sinew/behaviour/protective_reach.h"

#include <algorithm>
#include <cmath>

#include "sinew/animation/inverse_kinematics.h"
#include "sinew/skeleton/byte_stream.h"
#include "sinew/skeleton/portable_math.h"
#include "sinew/skeleton/rotation.h"

namespace sinew {
namespace {

// Of a human.
constexpr double kReachTime = 0.08;             ///< s, in which a joint follows, critically damped
constexpr double kFastest = 7;                  ///< rad/s, of a joint
constexpr double kAhead = 0.25, kApart = 0.2;   ///< m, of a hand from below its shoulder
constexpr double kStraightest = 0.96;           ///< of its length: elbows are 30° bent
constexpr double kBent = 0.5;                   ///< rad, of an elbow, in which its bend is found
constexpr double kComesDown = 6;                ///< m/s², of shoulders over feet that bear something
constexpr double kLeans = 0.3;                  ///< s, of their speed that count as much as how far they lean
constexpr double kTouch = 0.01;                 ///< m
constexpr double kLetsGo = 1, kWaits = 1.5;     ///< s, after a touch; s in which there has been none
constexpr double kTrunk = 0.85, kLegs = 0.15;   ///< of the arms' share of their strength
constexpr double kLegsGo = 0.5;                 ///< s, in which legs give way
constexpr double kChinIn = 0.6, kChinUp = 0.5;  ///< rad

}  // namespace

template <class T>
void ProtectiveReach<T>::prepare(const Skeleton& skeleton, const BehaviourSettings& settings, double unit) {
  settings_ = settings;
  unit_ = unit;
  const std::size_t joints = skeleton.joints.size();
  std::vector<Transform<double>> rest;  // joint → model
  for (const Joint& joint : skeleton.joints) {
    rest.push_back(joint.parent < 0 ? joint.rest : rest[static_cast<std::size_t>(joint.parent)] * joint.rest);
    parents_.push_back(joint.parent);
    rest_.push_back(joint.rest.rotation.cast<T>());
    leftwards_.push_back((rest.back().rotation.conjugate() * Vec3<double>::UnitY()).template cast<T>());
  }
  pose_.resize(joints);
  activation_.resize(joints);
  const auto below = [&](int joint, int ancestor) {
    while (joint > ancestor) joint = skeleton.joints[static_cast<std::size_t>(joint)].parent;
    return ancestor >= 0 && joint == ancestor;
  };
  for (std::size_t side = 0; side < 2; ++side) {
    Arm& arm = arms_[side];
    const auto role = [&](Role left, Role right) { return skeleton.find(side == 0 ? left : right); };
    const int upper = role(Role::kUpperArmL, Role::kUpperArmR);
    arm.forearm = role(Role::kForearmL, Role::kForearmR);
    arm.hand = role(Role::kHandL, Role::kHandR);
    if (!below(arm.forearm, upper) || !below(arm.hand, arm.forearm)) continue;
    arm.upper = upper;
    const auto at = [&](int joint) { return rest[static_cast<std::size_t>(joint)]; };
    arm.length = (at(arm.forearm).translation - at(upper).translation).norm() +
                 (at(arm.hand).translation - at(arm.forearm).translation).norm();
    const double left = side == 0 ? 1 : -1;
    const int carries = skeleton.joints[static_cast<std::size_t>(upper)].parent;
    arm.elbow = (at(carries).rotation.conjugate() * Vec3<double>(-1, 0.3 * left, -0.3)).template cast<T>();
    const Joint& elbow = skeleton.joints[static_cast<std::size_t>(arm.forearm)];
    Quat<double> bent = elbow.rest.rotation;
    if (elbow.type == JointType::kRevolute) {
      const double way = elbow.dofs[0].upper + elbow.dofs[0].lower < 0 ? -1 : 1;
      bent = bent * rotation_exp<double>(way * kBent * elbow.axis);
      arm.hinge = elbow.axis.template cast<T>();
    }
    arm.bent = bent.template cast<T>();
    for (const Collider& collider : skeleton.colliders)
      if (below(collider.joint, arm.forearm)) append_contact_points<T>(collider, palms_);
  }
  std::erase_if(palms_, [](const ContactPoint<T>& p) { return !p.meets_plane(); });
  neck_ = {skeleton.find(Role::kNeck), skeleton.find(Role::kHead)};
  std::erase(neck_, -1);
  const int thighs[] = {skeleton.find(Role::kThighL), skeleton.find(Role::kThighR)};
  for (int joint = 0; joint < static_cast<int>(joints); ++joint) {
    Part part = Part::kTrunk;
    if (below(joint, thighs[0]) || below(joint, thighs[1])) part = Part::kLeg;
    if (!neck_.empty() && below(joint, neck_[0])) part = Part::kNeck;
    if (below(joint, arms_[0].upper) || below(joint, arms_[1].upper)) part = Part::kArm;
    part_.push_back(part);
  }
}

template <class T>
void ProtectiveReach<T>::begin() {
  time_ = 0;
  touched_ = -1;
}

template <class T>
bool ProtectiveReach<T>::acts() const {
  return touched_ <= 2 * kLetsGo * std::sqrt(unit_);
}

template <class T>
bool ProtectiveReach<T>::touches(std::span<const Transform<T>> model, double ground) const {
  const auto is_low = [&](const ContactPoint<T>& p) {
    const Vec3<T> at = model[static_cast<std::size_t>(p.body)] * p.local;
    return double(at.z() - p.radius) < ground + kTouch * unit_;
  };
  return std::any_of(palms_.begin(), palms_.end(), is_low);
}

/// Seen from above; a unit vector.
template <class T>
Vec2 ProtectiveReach<T>::way_of_fall(const FallingBody& body, std::span<const Transform<T>> model) const {
  Vec3<double> shoulders = Vec3<double>::Zero();
  for (const Arm& arm : arms_)
    shoulders += model[static_cast<std::size_t>(arm.upper)].translation.template cast<double>() / 2;
  const Vec3<double> speed = body.mass.velocity + body.spin.cross(shoulders - body.mass.place);
  const Vec2 way = from_above(shoulders + kLeans * std::sqrt(unit_) * speed) - body.feet;
  const Vec2 either = way.norm() > 1e-3 * unit_ ? way : from_above(body.forward);
  return either.norm() > 0 ? Vec2(either.normalized()) : Vec2(Vec2::UnitX());
}

/// Writes the arm's joints as they reach for the ground into `pose_`. Whether there is a way.
template <class T>
bool ProtectiveReach<T>::reach(const Arm& arm, std::span<const Transform<T>> model, const FallingBody& body,
                               const Vec2& way) {
  const auto at = [&](int joint) {
    return Vec3<double>(model[static_cast<std::size_t>(joint)].translation.template cast<double>());
  };
  const Arm& other = &arm == &arms_[0] ? arms_[1] : arms_[0];
  const Vec3<double> shoulder = at(arm.upper);
  const Vec3<double> speed = body.mass.velocity + body.spin.cross(shoulder - body.mass.place);
  const double height = std::max(shoulder.z() - body.ground - kStraightest * arm.length, 0.0),
               down = -speed.z();
  const double falls = (std::sqrt(down * down + 2 * kComesDown * height) - down) / kComesDown;
  Vec2 across = from_above(shoulder - at(other.upper));
  across = across.norm() > 0 ? Vec2(across.normalized()) : Vec2(Vec2::Zero());
  Vec3<double> to = shoulder;
  to.head<2>() += falls * from_above(speed) + unit_ * (kAhead * way + kApart * across);
  to.z() = std::min(body.ground, shoulder.z() - kAhead * unit_);  // who falls from it reaches further down
  Vec3<double> reaches = to - shoulder;
  if (const double far = reaches.norm(); far > kStraightest * arm.length)
    reaches *= kStraightest * arm.length / far;
  const auto carries = static_cast<std::size_t>(parents_[static_cast<std::size_t>(arm.upper)]);
  const auto upper = static_cast<std::size_t>(arm.upper), forearm = static_cast<std::size_t>(arm.forearm);
  pose_[upper].rotation = rest_[upper];
  pose_[forearm].rotation = arm.bent;
  TwoBoneJob<T> job{parents_,    pose_,    arm.upper,
                    arm.forearm, arm.hand, still<T>((shoulder + reaches).template cast<T>())};
  job.pole = still<T>(Vec3<T>(model[carries].rotation * arm.elbow));
  job.hinge = arm.hinge;
  job.keep_end = false;
  job.softness = T(0.01);
  return job.Run().ok();
}

template <class T>
void ProtectiveReach<T>::nod(double angle) {
  for (const int joint : neck_) {
    const auto i = static_cast<std::size_t>(joint);
    pose_[i].rotation = rest_[i] * rotation_exp<T>(Vec3<T>(leftwards_[i] * T(angle / double(neck_.size()))));
  }
}

/// What a part has of its strength.
template <class T>
double ProtectiveReach<T>::share_of(Part part) const {
  const double time = std::sqrt(unit_), least = settings_.fallen_strength;
  const double of_arms = part == Part::kLeg ? kLegs : part == Part::kTrunk ? kTrunk : 1;
  const double reaches = possible() ? std::max(of_arms * settings_.reach_strength, least) : least;
  const double comes = std::min(time_ / std::max(settings_.let_go, 1e-9), 1.0);
  // Legs give way in any case: who stands in balance on little would not come down.
  const double gone = part == Part::kLeg ? time_ / kLegsGo : touched_ / kLetsGo;
  const double goes = std::clamp(gone / time, 0.0, 1.0);
  return std::lerp(std::lerp(1.0, reaches, comes), least, goes);
}

/// What is asked of joints goes on to what is wanted of them, or comes to rest.
template <class T>
void ProtectiveReach<T>::follow(std::span<JointJet<T>> jets, double h) const {
  const double time = kReachTime * std::sqrt(unit_), fades = -portable::expm1(-2 * h / time);
  const T fastest = T(kFastest / std::sqrt(unit_));
  for (std::size_t i = 1; i < jets.size(); ++i) {
    JointJet<T>& jet = jets[i];
    Vec3<T> wanted = Vec3<T>::Zero();  // rad/s
    if (touched_ < 0 && (part_[i] == Part::kArm || part_[i] == Part::kNeck))
      wanted = rotation_log<T>(jet.rotation.conjugate() * pose_[i].rotation) / T(2 * time);
    if (const T fast = wanted.norm(); fast > fastest) wanted *= fastest / fast;
    jet.alpha = (wanted - jet.omega) * T(fades / h);
    const Vec3<T> turn = T(h) * jet.omega + T(h * h / 2) * jet.alpha;
    jet.rotation = (jet.rotation * rotation_exp<T>(turn)).normalized();
    jet.omega += T(h) * jet.alpha;
  }
}

/// Writes arms that reach for the ground and a head that keeps away from it into `pose_`; the rest is as it
/// is.
template <class T>
void ProtectiveReach<T>::take_pose(const Character<T>& character, const FallingBody& body,
                                   std::span<const JointJet<T>> asked) {
  const std::span<const Transform<T>> model = character.model(), local = character.local();
  for (std::size_t i = 0; i < pose_.size(); ++i) {
    const Transform<T>& now = i == 0 ? model[0] : local[i];
    pose_[i] = {};
    pose_[i].rotation = now.rotation;
    pose_[i].translation = now.translation;
  }
  const Vec2 way = way_of_fall(body, model);
  for (const Arm& arm : arms_) {
    const auto upper = static_cast<std::size_t>(arm.upper), forearm = static_cast<std::size_t>(arm.forearm),
               hand = static_cast<std::size_t>(arm.hand);
    if (!reach(arm, model, body, way)) {
      pose_[upper].rotation = asked[upper].rotation;
      pose_[forearm].rotation = asked[forearm].rotation;
    }
    pose_[hand].rotation = rest_[hand];
  }
  const double ahead = way.dot(from_above(body.forward));
  nod(ahead > 0 ? -kChinUp * ahead : -kChinIn * ahead);
}

template <class T>
void ProtectiveReach<T>::update(Character<T>& character, const FallingBody& body, std::span<JointJet<T>> jets,
                                double h) {
  const double time = std::sqrt(unit_);
  time_ += h;
  if (touched_ >= 0)
    touched_ += h;
  else if (!possible() || time_ > kWaits * time || touches(character.model(), body.ground))
    touched_ = 0;
  if (touched_ < 0) take_pose(character, body, jets);
  follow(jets, h);
  for (std::size_t i = 0; i < activation_.size(); ++i) activation_[i] = T(share_of(part_[i]));
  (void)character.set_activation(activation_);
}

template <class T>
void ProtectiveReach<T>::visit(ByteStream& stream) {
  stream.value("time of the fall", time_);
  stream.value("time since it touched the ground", touched_);
}

template class ProtectiveReach<float>;
template class ProtectiveReach<double>;

}  // namespace sinew
