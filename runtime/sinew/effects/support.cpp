#include "sinew/effects/support.h"

#include <algorithm>
#include <utility>

#include "sinew/effects/check_pass.h"

namespace sinew {

template <class T>
SupportPoints<T>::SupportPoints(const Tree<T>& tree, std::span<const ContactPoint<T>> contacts)
    : first(tree.bodies + 1, 0), unit(tree.scale.length), bound(tree.bodies, T(0)) {
  const auto stands = [&](const ContactPoint<T>& c) { return c.body < tree.bodies && c.meets_plane(); };
  for (const ContactPoint<T>& contact : contacts)
    if (stands(contact)) ++first[contact.body + 1];
  for (int i = 0; i < tree.bodies; ++i) {
    first[i + 1] += first[i];
    int from = i;
    while (from > 0 && tree.parent[from] > 0) from = tree.parent[from];
    limb.push_back(from);
  }
  points.resize(first.back());
  std::vector<int> next = first;
  for (const ContactPoint<T>& contact : contacts) {
    if (!stands(contact)) continue;
    points[next[contact.body]++] = {contact.local, contact.radius, contact.friction};
    bound[contact.body] = std::max(bound[contact.body], contact.local.norm() + contact.radius);
  }
}

template struct SupportPoints<float>;
template struct SupportPoints<double>;

namespace {

template <class T>
SupportPoints<T> points_of(const Tree<T>& tree, std::span<const ContactPoint<T>> contacts) {
  return {tree, contacts};
}

constexpr double kBearsNothing = 1e-4;  ///< of a point's full share: left out

template <class T>
void stand_on_floor(const SupportPoints<T>& points, const T& ground, const CheckScratch<T>& r) {
  stand<T>(points, LevelGround<T>{ground}, r);
}

/// bearing_of(point): normal of the ground under it, and its friction.
template <class T, class Ground, class BearingOf>
void balance(const SupportPoints<T>& points, const Ground& ground, T weight, const CheckScratch<T>& r,
             BearingOf bearing_of) {
  wrenches_in_world(r);
  Vec3<T> force = Vec3<T>::Zero(), moment = Vec3<T>::Zero();
  for (std::size_t i = 0; i < r.body.size(); ++i) {
    force += r.force[i];
    moment += r.moment[i];
  }
  std::size_t count = 0;
  share_support_to<T>(points, r.rotation, r.origin.first(r.body.size()), ground, {}, r.standing, r.force,
                      r.moment, [&](int body, const StandingPoint<T>& s, const Vec3<T>& push) {
                        if (!(s.share > T(kBearsNothing))) return;
                        const auto point = &s - r.standing.data();
                        const auto [normal, friction] = bearing_of(point);
                        r.bearing[count++] = {s.place, normal, s.share, friction, body, int(point), push};
                      });
  const std::span<BearingPoint<T>> bearing = r.bearing.first(count);
  for (BearingPoint<T>& nothing : r.bearing.subspan(count)) nothing.force.setZero();
  balance_ground<T>(bearing, force, moment, weight, points.unit);
  for (const BearingPoint<T>& p : bearing) {
    r.force[p.body] -= p.force;
    r.moment[p.body] -= p.place.cross(p.force);
  }
  wrenches_to_bodies(points, ground, r);
}

template <class T>
void balance_on_floor(const SupportPoints<T>& points, const T& ground, T friction, T weight,
                      const CheckScratch<T>& r) {
  balance(points, LevelGround<T>{ground}, weight, r, [&](std::ptrdiff_t point) {
    return std::pair{Vec3<T>(Vec3<T>::UnitZ()), friction * points.points[point].friction};
  });
}

template <class T>
void stand_on_surroundings(const SupportPoints<T>& points, const GroundProbe<T>& probe, T weight,
                           const CheckScratch<T>& r) {
  const T reach = T(SupportSettings{}.reach) * points.unit;
  const std::span<GroundUnder<T>> under = probe.room;
  for (std::size_t i = 0; i < r.body.size(); ++i) {
    const bool near = points.first[i] < points.first[i + 1] &&
                      probe.near(probe.surroundings, r.origin[i], points.bound[i] + reach);
    for (int k = points.first[i]; k < points.first[i + 1]; ++k) {
      const auto& point = points.points[k];
      const Vec3<T> center = r.origin[i] + r.rotation[i] * point.local;
      under[k] = near ? probe.under(probe.surroundings, center, point) : GroundUnder<T>{};
    }
  }
  const ProbedGround<T> ground{under};
  if (!(weight > T(0))) return stand<T>(points, ground, r);
  balance(points, ground, weight, r, [&](std::ptrdiff_t point) {
    return std::pair{under[point].normal, under[point].friction};
  });
}

template <class T>
constexpr SupportTerm<T> kSupport{points_of<T>, stand_on_floor<T>, balance_on_floor<T>,
                                  stand_on_surroundings<T>};

}  // namespace

template <class T>
void Support<T>::declare(StepPlan<T>& plan) {
  plan.support = &kSupport<T>;
}

template struct Support<float>;
template struct Support<double>;

}  // namespace sinew
