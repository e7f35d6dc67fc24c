// What the ground gives a character whose root is driven by the animation.
//
// A kinematic root bears the whole weight, so its legs would seem to hang. The residual wrench at the root is
// therefore shared out to the points that stand on the floor, and the joints between see what a standing
// body's joints see. Statically indeterminate with two feet: the smallest weighted forces that balance weight
// and tilt are taken, and they lean towards the hips as the forces of walking people do (Maus, Lipfert,
// Gross, Rummel & Seyfarth 2010, Nature Communications 1:70: they meet in a point above the centre of mass).
#pragma once

#include <cmath>
#include <span>
#include <vector>

#include "sinew/effects/contact.h"
#include "sinew/effects/step_plan.h"
#include "sinew/skeleton/scalar.h"

namespace sinew {

/// Who bears, and how far forces lean.
struct SupportSettings {
  /// m of a figure of human size; a point this high above the floor bears nothing, at the floor it bears
  /// fully
  double reach = 0.025;
  double lean = 0.4;  ///< most that a force leans towards the hip, horizontal by vertical
};

/// The points of a tree that may stand on the ground, by body.
template <class T>
struct SupportPoints {
  /// A ball; a corner has no radius.
  struct Point {
    Vec3<T> local;  ///< m, body axes
    T radius;       ///< m
    T friction;     ///< μ on a floor whose own is 1
  };
  std::vector<Point> points;  ///< body after body
  std::vector<int> first;     ///< [body + 1]
  std::vector<int> limb;      ///< [body] where its limb leaves the root
  T unit = T(1);              ///< see Scale::length
  std::vector<T> bound;       ///< [body] m, from the joint's origin to the furthest of its points

  SupportPoints() = default;
  /// Of `contacts`, those that meet planes; O(bodies + points).
  SupportPoints(const Tree<T>& tree, std::span<const ContactPoint<T>> contacts);
};

/// A point near enough to the ground to bear weight.
template <class T>
struct StandingPoint {
  Vec3<T> place;  ///< from the common origin, its lowest
  T share;        ///< of what it may bear: 1 on the floor, smoothly 0 at the reach
};

/// A level floor, for share_support_to().
template <class T>
struct LevelGround {
  T height;  ///< m, from the common origin

  /// Which lanes' bodies may have a point within the reach.
  [[gnu::always_inline]] auto near(const SupportPoints<Number<T>>& points, int body, const Vec3<T>& origin,
                                   Number<T> reach) const {
    return origin.z() - height < T(points.bound[body] + reach);
  }
  /// Whether any lane's has.
  [[gnu::always_inline]] bool may_stand(const SupportPoints<Number<T>>& points, int body,
                                        const Vec3<T>& origin, Number<T> reach) const {
    return points.first[body] < points.first[body + 1] && any(near(points, body, origin, reach));
  }
  /// Where a point with its centre `at` would touch, m.
  [[gnu::always_inline]] Vec3<T> lowest(int, Vec3<T> at, Number<T> radius) const {
    at.z() -= T(radius);
    return at;
  }
  /// m, of a place that would touch.
  [[gnu::always_inline]] T gap(int, const Vec3<T>& at) const { return at.z() - height; }
  [[gnu::always_inline]] const T& height_at(int, const Vec3<T>&) const {
    return height;
  }  ///< m, of the ground
};

/// What is under a point that may stand where the ground is no level floor.
template <class T>
struct GroundUnder {
  T gap = T(1e9);                     ///< m, negative inside
  Vec3<T> normal = Vec3<T>::UnitZ();  ///< outwards, unit
  T friction = T(1);                  ///< μ of the two
  int moving = -1;                    ///< the surroundings' number of what is there; −1: it stands still
};

/// Answers what is under points, m from the common origin, in a check.
template <class T>
struct GroundProbe {
  const void* surroundings = nullptr;  ///< that the two are called with
  std::span<GroundUnder<T>> room;      ///< [point]
  /// Whether something may be within `reach` of a point.
  bool (*near)(const void* surroundings, const Vec3<T>& point, T reach) = nullptr;
  /// Of all that can be stood on, what is nearest to a point of a body.
  GroundUnder<T> (*under)(const void* surroundings, const Vec3<T>& center,
                          const typename SupportPoints<T>::Point& point) = nullptr;
};

/// The same for share_support_to(), when it has been asked.
template <class T>
struct ProbedGround {
  std::span<const GroundUnder<T>> under;  ///< [point]

  /// Whether a body has a point within the reach.
  bool near(const SupportPoints<T>& points, int body, const Vec3<T>&, T reach) const {
    for (int k = points.first[body]; k < points.first[body + 1]; ++k)
      if (under[k].gap < reach) return true;
    return false;
  }
  /// The same.
  bool may_stand(const SupportPoints<T>& points, int body, const Vec3<T>& origin, T reach) const {
    return near(points, body, origin, reach);
  }
  /// Where a point with its centre `at` would touch, m.
  Vec3<T> lowest(int k, const Vec3<T>& at, T radius) const { return at - radius * under[k].normal; }
  T gap(int k, const Vec3<T>&) const { return under[k].gap; }                    ///< m, of it
  T height_at(int k, const Vec3<T>& at) const { return at.z() - under[k].gap; }  ///< m, of the ground
};

/// Shares the support out: put(body, point in `room`, force) for every point that may stand. `rotation`,
/// `origin` [body]: see Kinematics. `force` and `moment` [body] hold the wrenches that the motion asks for,
/// about the common origin; `ground`: a LevelGround or a ProbedGround. Nothing in flight. `room` [point]. T
/// may be a pack of characters (pack.h). O(points).
template <class T, class Ground, class Put>
[[gnu::always_inline]] inline void share_support_to(const SupportPoints<Number<T>>& points,
                                                    std::span<const Mat3<T>> rotation,
                                                    std::span<const Vec3<T>> origin, const Ground& ground,
                                                    const SupportSettings& settings,
                                                    std::span<StandingPoint<T>> room,
                                                    std::span<const Vec3<T>> force,
                                                    std::span<const Vec3<T>> moment, Put put) {
  using std::sqrt;
  const int bodies = int(rotation.size());
  const Number<T> reach = Number<T>(settings.reach) * points.unit, area = points.unit * points.unit;
  const T zero = T(0), one = T(1);
  Vec3<T> total = Vec3<T>::Zero(), tilt = Vec3<T>::Zero();
  for (int i = 0; i < bodies; ++i) {
    total += force[i];
    tilt += moment[i];
  }
  // Vertical forces f_p = w_p·(1, y, −x)·λ balance (F_z, M_x, M_y): weighted least squares with three
  // multipliers.
  T sum = zero, y_sum = zero, x_sum = zero, yy = zero, xy = zero, xx = zero;
  for (int i = 0; i < bodies; ++i) {
    if (!ground.may_stand(points, i, origin[i], reach)) continue;
    for (int k = points.first[i]; k < points.first[i + 1]; ++k) {
      const auto& point = points.points[k];
      const Vec3<T> at =
          ground.lowest(k, origin[i] + rotation[i] * point.local.template cast<T>(), point.radius);
      const T down = one - largest<T>(zero, smallest<T>(one, ground.gap(k, at) * T(1 / reach)));
      const T w = down * down;
      room[k] = {at, w};
      sum += w;
      y_sum += w * at.y();
      x_sum += w * at.x();
      yy += w * at.y() * at.y();
      xy += w * at.x() * at.y();
      xx += w * at.x() * at.x();
    }
  }
  const auto standing = both(total.z() > zero, sum > T(Number<T>(1e-3)));
  if (!any(standing)) return;
  // One point alone can't hold a tilt. The symmetric matrix's inverse by cofactors.
  const T slack = T(Number<T>(1e-6)) * (one + (sum + yy / T(area) + xx / T(area))), wide = slack * T(area);
  const T a = sum + slack, b = y_sum, c = -x_sum, d = yy + wide, e = -xy, f = xx + wide;
  const T c00 = d * f - e * e, c01 = c * e - b * f, c02 = b * e - c * d, c11 = a * f - c * c,
          c12 = b * c - a * e, c22 = a * d - b * b;
  const T inverse = one / (a * c00 + b * c01 + c * c02);
  const T l0 = inverse * (c00 * total.z() + c01 * tilt.x() + c02 * tilt.y()),
          l1 = inverse * (c01 * total.z() + c11 * tilt.x() + c12 * tilt.y()),
          l2 = inverse * (c02 * total.z() + c12 * tilt.x() + c22 * tilt.y());
  // A point can't pull: dropping negative forces and scaling the rest keeps the total.
  const auto lift = [&](const StandingPoint<T>& s) {
    return largest<T>(zero, s.share * (l0 + (l1 * s.place.y() - l2 * s.place.x())));
  };
  // Forces lean towards where their limb leaves the root by as much as all points can follow, so that a
  // stride's feet brake and push against each other and the hips carry little.
  struct Lean {
    T x, y;
  };
  const auto lean = [&](int body, const StandingPoint<T>& s) {
    const Vec3<T>&hip = origin[points.limb[body]], &at = s.place;
    const T height = hip.z() - ground.height_at(int(&s - room.data()), at);
    const T slope = select(height > T(reach), T(one / height), zero);
    return Lean{slope * (hip.x() - at.x()), slope * (hip.y() - at.y())};
  };
  const auto for_each_standing = [&](auto visit) {
    for (int i = 0; i < bodies; ++i)
      if (ground.may_stand(points, i, origin[i], reach))
        for (int k = points.first[i]; k < points.first[i + 1]; ++k) visit(i, room[k]);
  };
  T carried = zero, x_mean = zero, y_mean = zero, steepest = zero;
  for_each_standing([&](int body, const StandingPoint<T>& s) {
    const T up = lift(s);
    const Lean away = lean(body, s);
    carried += up;
    x_mean += up * away.x;
    y_mean += up * away.y;
    const T steep = select(up > zero, T(away.x * away.x + away.y * away.y), zero);
    steepest = largest<T>(steepest, steep);
  });
  // Hardly standing (about to land, or just off): hardly borne, so that forces fade in.
  const T scale = total.z() / carried * smallest<T>(one, sum * T(5));
  // Level forces: no more friction than the floor could give, and the lean about its mean, which the motion
  // does not ask for.
  const T level = one / largest<T>(total.z(), sqrt(total.x() * total.x() + total.y() * total.y()));
  const T follow =
      smallest<T>(one, T(Number<T>(settings.lean)) / largest<T>(sqrt(steepest), T(Number<T>(1e-6))));
  const T x_push = level * total.x() - follow * (x_mean / carried),
          y_push = level * total.y() - follow * (y_mean / carried);
  for_each_standing([&](int body, const StandingPoint<T>& s) {
    const T raw = lift(s);
    const auto bears = both(standing, raw > zero);
    const T up = scale * raw;
    const Lean away = lean(body, s);
    const Vec3<T> push(select(bears, T(up * (x_push + follow * away.x)), zero),
                       select(bears, T(up * (y_push + follow * away.y)), zero), select(bears, up, zero));
    put(body, s, push);
  });
}

/// Subtracts the support forces from the body wrenches (before project_wrenches), see share_support_to.
template <class T, class Ground>
void share_support(const SupportPoints<Number<T>>& points, std::span<const Mat3<T>> rotation,
                   std::span<const Vec3<T>> origin, const Ground& ground, const SupportSettings& settings,
                   std::span<StandingPoint<T>> room, std::span<Vec3<T>> force, std::span<Vec3<T>> moment) {
  share_support_to<T>(points, rotation, origin, ground, settings, room, force, moment,
                      [&](int body, const StandingPoint<T>& s, const Vec3<T>& push) {
                        force[body] -= push;
                        moment[body] -= s.place.cross(push);
                      });
}

extern template struct SupportPoints<float>;
extern template struct SupportPoints<double>;

template <class T>
struct CheckScratch;

/// The same as a character's step calls it, see check_pass.h.
template <class T>
struct SupportTerm {
  /// Set-up: which points may stand.
  SupportPoints<T> (*points)(const Tree<T>& tree, std::span<const ContactPoint<T>> contacts);
  /// As a driven root leaves it to them, which bears what they don't.
  void (*stand)(const SupportPoints<T>& points, const T& ground, const CheckScratch<T>& scratch);
  /// As the ground can, for a root that has nothing else (ground_balance.h). `friction`: the floor's;
  /// `weight`, N.
  void (*balance)(const SupportPoints<T>& points, const T& ground, T friction, T weight,
                  const CheckScratch<T>& scratch);
  /// Either (`weight` 0: a driven root) on what is around.
  void (*on_surroundings)(const SupportPoints<T>& points, const GroundProbe<T>& ground, T weight,
                          const CheckScratch<T>& scratch);
};

/// What World::declare takes. Without, what a driven root bears is not asked of the floor: legs hang.
template <class T>
struct Support {
  /// Writes its functions into the world's plan.
  static void declare(StepPlan<T>& plan);
};

extern template struct Support<float>;
extern template struct Support<double>;

}  // namespace sinew
