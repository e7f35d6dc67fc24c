#include "sinew/character/touching.h"

#include <algorithm>
#include <cmath>

namespace sinew {
namespace {

constexpr int kHalvings = 8;
/// Angle of a turn by the difference of its quaternions, at most: 2.22 at half a turn, 2 at none.
constexpr double kAngle = 2.25;

/// m: as far as any point of a collider goes at most from one place to another, but for `common`.
template <class T>
T way(const PlacedCollider<T>& from, const PlacedCollider<T>& to, const Vec3<T>& common) {
  const auto &p = from.pose.rotation.coeffs(), &q = to.pose.rotation.coeffs();
  const T turned = from.collider->shape == Shape::kSphere
                       ? T(0)
                       : std::sqrt(std::min((p - q).squaredNorm(), (p + q).squaredNorm()));
  return (to.pose.translation - from.pose.translation - common).norm() + T(kAngle) * turned * from.radius;
}

template <class T>
PlacedCollider<T> halfway(const PlacedCollider<T>& from, const PlacedCollider<T>& to) {
  PlacedCollider<T> middle = from;
  middle.pose.translation = (from.pose.translation + to.pose.translation) / 2;
  const T side = from.pose.rotation.dot(to.pose.rotation) < T(0) ? T(-1) : T(1);
  middle.pose.rotation.coeffs() =
      (from.pose.rotation.coeffs() + side * to.pose.rotation.coeffs()).normalized();
  return middle;
}

/// `apart`, `apart_after` (m): at the ends. They touch where they are no more than 0 apart, `depth` added.
template <class T>
bool touch(const PlacedCollider<T>& a, const PlacedCollider<T>& a_after, const PlacedCollider<T>& b,
           const PlacedCollider<T>& b_after, T apart, T apart_after, T depth, int halvings) {
  if (!(apart > T(0)) || !(apart_after > T(0))) return true;
  // Both ways in b's: what moves along with each other does not come nearer.
  const Vec3<T> common = b_after.pose.translation - b.pose.translation;
  if (way(a, a_after, common) + way(b, b_after, common) < apart + apart_after) return false;
  if (halvings == 0) return true;
  const PlacedCollider<T> a_middle = halfway(a, a_after), b_middle = halfway(b, b_after);
  const T between = distance_between(a_middle, b_middle).distance + depth;
  return touch(a, a_middle, b, b_middle, apart, between, depth, halvings - 1) ||
         touch(a_middle, a_after, b_middle, b_after, between, apart_after, depth, halvings - 1);
}

/// A ball about all of a way.
template <class T>
bool ways_meet(const PlacedCollider<T>& a, const PlacedCollider<T>& a_after, const PlacedCollider<T>& b,
               const PlacedCollider<T>& b_after) {
  const Vec3<T> apart = a.pose.translation - b.pose.translation,
                after = a_after.pose.translation - b_after.pose.translation;
  const T reach = a.radius + b.radius + (after - apart).norm() / 2;
  return (apart + after).squaredNorm() <= 4 * reach * reach;
}

/// m: at least so far apart are they, by the ball about the smaller of them.
template <class T>
T at_least_apart(const PlacedCollider<T>& a, const PlacedCollider<T>& b) {
  if (a.radius > b.radius) return at_least_apart(b, a);
  const Vec3<T> place = b.pose.rotation.conjugate() * (a.pose.translation - b.pose.translation);
  const Collider& of_b = *b.collider;
  return signed_distance<T>(of_b.shape, of_b.size.template cast<T>(), place, of_b.hull).distance - a.radius;
}

/// Whether a ball about the smaller one, all of its way long, stays away from the other: said for less than
/// their distances.
template <class T>
bool keeps_away(const PlacedCollider<T>& a, const PlacedCollider<T>& a_after, const PlacedCollider<T>& b,
                const PlacedCollider<T>& b_after, T depth) {
  const T apart = at_least_apart(a, b) + depth, after = at_least_apart(a_after, b_after) + depth;
  const Vec3<T> common = b_after.pose.translation - b.pose.translation;
  return apart > T(0) && after > T(0) && way(a, a_after, common) + way(b, b_after, common) < apart + after;
}

}  // namespace

template <class T>
void place_colliders(CharacterState<T>& s, std::span<const Transform<T>> pose, const Vec3<double>& root,
                     const Vec3<double>& origin, std::vector<PlacedCollider<T>>& out) {
  std::copy_n(pose.begin(), s.tree.bodies, s.wanted.begin());
  if (s.floats) s.wanted[0].translation = (root - origin).template cast<T>();
  const Vec3<T> common = s.floats ? Vec3<T>(Vec3<T>::Zero()) : Vec3<T>(origin.template cast<T>());
  forward_kinematics<T>(s.tree, s.wanted, common, s.guessed);
  for (std::size_t c = 0; c < s.colliders.size(); ++c) {
    const Collider& collider = s.colliders[c];
    PlacedCollider<T>& placed = out.emplace_back();
    placed.collider = &collider;
    const Transform<T> body{Quat<T>(s.guessed.rotation[collider.joint]), s.guessed.origin[collider.joint]};
    placed.pose = body * collider.local.template cast<T>();
    placed.radius = s.bound_radius[c];
  }
}

template <class T>
void predict_colliders(CharacterState<T>& s, std::span<const PlacedCollider<T>> from,
                       const Vec3<double>& origin, const Vec3<T>& gravity, T h,
                       std::vector<PlacedCollider<T>>& out) {
  if (s.undisturbed() && s.driven) {
    for (int i = 0; i < s.tree.bodies; ++i)
      s.problem.target[i] = {s.target[i].rotation, s.target[i].translation};
    return place_colliders<T>(s, s.problem.target, s.target[0].translation.template cast<double>(), origin,
                              out);
  }
  for (const PlacedCollider<T>& at : from) {
    const int body = at.collider->joint;
    const Vec3<T> omega = angular_velocity(s.history, body);
    PlacedCollider<T>& placed = out.emplace_back(at);
    const Vec3<T> velocity =
        s.history.velocity[body] + omega.cross(at.pose.translation - s.guessed.center[body]);
    placed.pose.translation += h * velocity + h * h / 2 * gravity;
    placed.pose.rotation = (rotation_exp<T>(h * omega) * at.pose.rotation).normalized();
  }
}

template <class T>
bool touch_on_the_way(const ColliderPaths<T>& a, const ColliderPaths<T>& b, T depth) {
  for (std::size_t i = 0; i < a.from.size(); ++i)
    for (std::size_t j = 0; j < b.from.size(); ++j) {
      const PlacedCollider<T>&one = a.from[i], &other = b.from[j];
      if (!ways_meet(one, a.to[i], other, b.to[j]) || keeps_away(one, a.to[i], other, b.to[j], depth))
        continue;
      if (touch(one, a.to[i], other, b.to[j], distance_between(one, other).distance + depth,
                distance_between(a.to[i], b.to[j]).distance + depth, depth, kHalvings))
        return true;
    }
  return false;
}

SINEW_TOUCHING_INSTANCES(template, float)
SINEW_TOUCHING_INSTANCES(template, double)

}  // namespace sinew
