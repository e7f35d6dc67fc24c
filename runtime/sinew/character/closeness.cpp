#include "sinew/character/closeness.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "sinew/effects/crossing_edges.h"

namespace sinew {
namespace {

/// m/s²: what two bodies approach faster by after a step than before, over the step. Falling takes a third of
/// it; who is struck may do more and is met a step later, inside.
constexpr double kSurprise = 30;
constexpr int kSections = 16;      ///< of an axis: to a thousandth of its length
constexpr double kGolden = 0.618;  ///< of what is left

/// Most that the animation moves a collider of a body by against its root's centre of mass (m/s): its turns,
/// each at its distance.
template <class T>
T animated_speed(const CharacterState<T>& s, std::size_t collider) {
  const std::vector<JointJet<T>>& jets = s.last_target();
  const int body = s.colliders[collider].joint;
  T arm = s.bound_center[collider].norm() + s.bound_radius[collider], speed = T(0);
  for (int i = body; i > 0; i = s.tree.parent[i]) {
    speed += jets[i].omega.norm() * arm + jets[i].velocity.norm();
    arm += jets[i].translation.norm();
  }
  return speed + jets[0].omega.norm() * (arm + s.tree.center_of_mass[0].norm());
}

template <class T>
MovingCollider<T> moving_collider(CharacterState<T>& s, std::size_t collider, T h) {
  MovingCollider<T> m;
  m.collider = &s.colliders[collider];
  const int body = m.collider->joint;
  const Transform<T>& joint = s.model()[body];
  m.pose = joint * m.collider->local.template cast<T>();
  m.radius = s.bound_radius[collider];
  const bool played = s.driven && s.undisturbed();
  if (played || s.deferred.motion) {
    m.velocity = s.history.velocity[0];
    m.any = h * (played ? animated_speed(s, collider) : T(kLimbSpeed) * s.tree.scale.time);
  } else {
    const T arm = (s.bound_center[collider] - s.tree.center_of_mass[body]).norm() + m.radius;
    const T spin = s.history.rotation_rate[body].norm() / T(std::numbers::sqrt2);
    m.velocity = s.history.velocity[body];
    m.any = std::min(h * spin, T(2)) * arm;  // a chord
  }
  for (const ExternalForce<T>& force : s.forces)
    m.any += h * h * force.force.norm() / std::max(s.tree.mass[force.body], std::numeric_limits<T>::min());
  for (const ExternalForce<T>& impulse : s.impulses)
    m.any += h * impulse.force.norm() / std::max(s.tree.mass[impulse.body], std::numeric_limits<T>::min());
  return m;
}

/// Distance of a sphere or capsule to a convex shape, m, and the direction in which it leaves that.
template <class T>
SignedDistance<T> distance_to(const PlacedCollider<T>& a, const PlacedCollider<T>& b) {
  const Collider& c = *a.collider;
  const T half = c.shape == Shape::kCapsule ? T(c.size.z()) : T(0);
  T along = T(0);
  SignedDistance<T> d = distance_of_axis<T>(a.pose.translation, a.pose.rotation * Vec3<T>(0, 0, half), b.pose,
                                            *b.collider, kSections, along);
  d.distance -= T(c.size.x());
  d.normal = b.pose.rotation * d.normal;
  return d;
}

template <class T>
bool comes_close(const MovingCollider<T>& a, const MovingCollider<T>& b, T h, T margin) {
  const Vec3<T> velocity = a.velocity - b.velocity;
  const T fastest = std::max({velocity.norm(), a.velocity.norm(), b.velocity.norm()});
  const T any = margin + a.any + b.any, most = any + h * fastest;
  const T reach = a.radius + b.radius + most;
  if ((a.pose.translation - b.pose.translation).squaredNorm() > reach * reach) return false;
  const SignedDistance<T> d = distance_between<T>(a, b);
  // Either may be stopped within the step while the other goes on.
  const T closing = std::max({-velocity.dot(d.normal), -a.velocity.dot(d.normal), b.velocity.dot(d.normal)});
  return d.distance < any + h * std::max(closing, T(0));
}

/// m, about the shape's centre: all that it may reach in h seconds.
template <class T>
T swept_radius(const MovingCollider<T>& c, T h) {
  return c.radius + c.any + h * c.velocity.norm();
}

}  // namespace

template <class T>
SignedDistance<T> distance_of_axis(const Vec3<T>& middle, const Vec3<T>& half_axis, const Transform<T>& pose,
                                   const Collider& shape, int sections, T& along) {
  const Mat3<T> to_shape = pose.rotation.conjugate().toRotationMatrix();
  const Vec3<T> center = to_shape * (middle - pose.translation), axis = to_shape * half_axis,
                size = shape.size.template cast<T>();
  const auto at = [&](T t) { return signed_distance<T>(shape.shape, size, center + t * axis, shape.hull); };
  along = T(0);
  if (half_axis.squaredNorm() == T(0)) return at(T(0));
  T low = T(-1), high = T(1), left = high - T(kGolden) * (high - low),
    right = low + T(kGolden) * (high - low);
  T of_left = at(left).distance, of_right = at(right).distance;
  for (int n = 0; n < sections; ++n) {
    if (of_left < of_right) {
      high = right, right = left, of_right = of_left;
      left = high - T(kGolden) * (high - low);
      of_left = at(left).distance;
    } else {
      low = left, left = right, of_left = of_right;
      right = low + T(kGolden) * (high - low);
      of_right = at(right).distance;
    }
  }
  along = (low + high) / 2;
  return at(along);
}

template <class T>
SignedDistance<T> distance_between(const PlacedCollider<T>& a, const PlacedCollider<T>& b) {
  if (!is_polyhedron(a.collider->shape)) return distance_to(a, b);
  if (is_polyhedron(b.collider->shape)) {
    const auto placed = [](const PlacedCollider<T>& solid) {
      const Collider& c = *solid.collider;
      return PlacedShape<T>(c.shape, c.size.template cast<T>(), solid.pose, T(1), c.hull);
    };
    return separation(placed(a), placed(b));
  }
  SignedDistance<T> d = distance_to(b, a);
  d.normal = -d.normal;
  return d;
}

template <class T>
void append_moving(CharacterState<T>& s, T h, std::vector<MovingCollider<T>>& out) {
  for (std::size_t c = 0; c < s.colliders.size(); ++c) out.push_back(moving_collider(s, c, h));
}

namespace {

constexpr int kMostBounds = 128;  ///< bodies whose speeds are bounded one from the other

/// By bounds on the animation's speeds from the root down: what reaches e from the joint of a body moves no
/// faster than turn·e + shift against the root's centre of mass, which is what animated_speed() adds up.
template <class T>
Eigen::AlignedBox<T, 3> box_of_animation(CharacterState<T>& s, T h) {
  struct Bound {
    T turn, shift;  ///< rad/s, m/s
  };
  std::array<Bound, kMostBounds> bounds;
  const std::vector<JointJet<T>>& jets = s.last_target();
  const std::vector<Transform<T>>& model = s.model();
  const T root_way = h * s.history.velocity[0].norm();
  Eigen::AlignedBox<T, 3> box;
  for (int i = 0; i < s.tree.bodies; ++i) {
    const int parent = s.tree.parent[i];
    const T turn = jets[i].omega.norm();
    if (parent < 0) {
      bounds[i] = {turn, turn * s.tree.center_of_mass[0].norm()};
    } else {
      const Bound& above = bounds[parent];
      bounds[i] = {above.turn + turn,
                   above.shift + above.turn * jets[i].translation.norm() + jets[i].velocity.norm()};
    }
    const T reach = s.rig->body_reach[i];
    if (reach == T(0)) continue;
    const Vec3<T> way = Vec3<T>::Constant(reach + root_way + h * (bounds[i].turn * reach + bounds[i].shift));
    box.extend(model[i].translation - way).extend(model[i].translation + way);
  }
  return box;
}

}  // namespace

template <class T>
Eigen::AlignedBox<T, 3> swept_box(CharacterState<T>& s, T h) {
  if (s.driven && s.undisturbed() && !s.pushed() && s.tree.bodies <= kMostBounds)
    return box_of_animation(s, h);
  Eigen::AlignedBox<T, 3> box;
  for (std::size_t c = 0; c < s.colliders.size(); ++c) {
    const MovingCollider<T> m = moving_collider(s, c, h);
    const Vec3<T> reach = Vec3<T>::Constant(swept_radius(m, h));
    box.extend(m.pose.translation - reach).extend(m.pose.translation + reach);
  }
  return box;
}

template <class T>
bool boxes_come_close(const Eigen::AlignedBox<T, 3>& a, const Eigen::AlignedBox<T, 3>& b, T h, T margin) {
  constexpr T kRounding = T(1e-4);  // m
  const T reach = margin + T(kSurprise) * h * h + kRounding;
  return a.squaredExteriorDistance(b) <= reach * reach;
}

template <class T>
bool come_close(std::span<const MovingCollider<T>> a, std::span<const MovingCollider<T>> b, T h, T margin) {
  margin += T(kSurprise) * h * h;
  Eigen::AlignedBox<T, 3> around;  // all of b, so that most of a need not look at each
  for (const MovingCollider<T>& other : b) {
    const Vec3<T> reach = Vec3<T>::Constant(swept_radius(other, h));
    around.extend(other.pose.translation - reach).extend(other.pose.translation + reach);
  }
  return std::any_of(a.begin(), a.end(), [&](const MovingCollider<T>& one) {
    const T reach = swept_radius(one, h) + margin;
    if (around.squaredExteriorDistance(one.pose.translation) > reach * reach) return false;
    return std::any_of(b.begin(), b.end(),
                       [&](const MovingCollider<T>& other) { return comes_close<T>(one, other, h, margin); });
  });
}

SINEW_CLOSENESS_INSTANCES(template, float)
SINEW_CLOSENESS_INSTANCES(template, double)

}  // namespace sinew
