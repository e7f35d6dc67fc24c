#include "sinew/animation/foot_leg.h"

#include <algorithm>
#include <cmath>

namespace sinew {
namespace {

/// Of a collider at rest: how far it goes in a direction of the model.
double extent(const Collider& c, const Transform<double>& joint, const Vec3<double>& direction) {
  const Transform<double> shape = joint * c.local;
  const Vec3<double> own = shape.rotation.conjugate() * direction;
  double half = c.size.x();
  if (c.shape == Shape::kCapsule) half += c.size.z() * std::abs(own.z());
  if (c.shape == Shape::kBox) half = c.size.cwiseProduct(own.cwiseAbs()).sum();
  return shape.translation.dot(direction) + half;
}

}  // namespace

template <class T>
Status find_foot_leg(const Skeleton& skeleton, Role foot, FootLeg<T>& out) {
  if (foot != Role::kFootL && foot != Role::kFootR)
    return Status::error(Code::kInvalidArgument, "not the role of a foot");
  const auto beside = [&](int steps) {
    return skeleton.find(static_cast<Role>(static_cast<int>(foot) + steps));
  };
  const int thigh = beside(-4), shin = beside(-2), ankle = beside(0), toes = beside(2);
  if (thigh < 0 || shin < 0 || ankle < 0 || toes < 0)
    return Status::error(Code::kInvalidArgument, "thigh, shin, foot or toes have no role");
  const auto rest_of = [&](int joint) {
    Transform<double> rest;
    for (int i = joint; i >= 0; i = skeleton.joints[std::size_t(i)].parent)
      rest = skeleton.joints[std::size_t(i)].rest * rest;
    return rest;
  };
  const Transform<double> foot_rest = rest_of(ankle), toes_rest = rest_of(toes);
  const Vec3<double> up = Vec3<double>::UnitZ();
  Vec3<double> forward = toes_rest.translation - foot_rest.translation;
  forward.z() = 0;
  if (!(forward.norm() > 0))
    return Status::error(Code::kInvalidArgument, "toes straight below the ankle", toes);
  forward.normalize();
  double sole = std::min(foot_rest.translation.z(), toes_rest.translation.z());
  double back = foot_rest.translation.dot(forward);
  for (const Collider& c : skeleton.colliders) {
    if (c.joint != ankle && c.joint != toes) continue;
    const Transform<double>& rest = c.joint == ankle ? foot_rest : toes_rest;
    sole = std::min(sole, -extent(c, rest, -up));
    back = std::min(back, -extent(c, rest, -forward));
  }
  Vec3<double> toe = toes_rest.translation, heel = foot_rest.translation;
  heel += (back - heel.dot(forward)) * forward;
  toe.z() = heel.z() = sole;
  out = {thigh, shin, ankle};
  out.toe = (foot_rest.inverse() * toe).cast<T>();
  out.heel = (foot_rest.inverse() * heel).cast<T>();
  const Vec3<double> bend = rest_of(thigh).rotation.conjugate() * forward;
  out.bend = bend.cast<T>();
  return {};
}

template <class T>
Status find_foot_legs(const Skeleton& skeleton, std::span<FootLeg<T>, 2> out, int& pelvis) {
  if (Status status = find_foot_leg(skeleton, Role::kFootL, out[0]); !status) return status;
  if (Status status = find_foot_leg(skeleton, Role::kFootR, out[1]); !status) return status;
  int left = out[0].upper, right = out[1].upper;
  while (left != right)  // parents stand before their children
    (left > right ? left : right) = skeleton.joints[std::size_t(std::max(left, right))].parent;
  if (left < 0) return Status::error(Code::kInvalidArgument, "legs have no joint in common");
  pelvis = left;
  return {};
}

bool in_contact(const Clip& clip, double time, int joint) {
  const double length = clip.duration;
  const double now = clip.loops && length > 0 ? time - std::floor(time / length) * length : time;
  return std::any_of(clip.contacts.begin(), clip.contacts.end(), [&](const ContactWindow& w) {
    const auto holds = [&](double t) { return w.begin <= t && t <= w.end; };
    return w.joint == joint && (holds(now) || (clip.loops && holds(now + length)));
  });
}

template Status find_foot_leg<float>(const Skeleton&, Role, FootLeg<float>&);
template Status find_foot_leg<double>(const Skeleton&, Role, FootLeg<double>&);
template Status find_foot_legs<float>(const Skeleton&, std::span<FootLeg<float>, 2>, int&);
template Status find_foot_legs<double>(const Skeleton&, std::span<FootLeg<double>, 2>, int&);

}  // namespace sinew
