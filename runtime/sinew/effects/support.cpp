#include "sinew/effects/support.h"

#include <algorithm>

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
void balance(const SupportPoints<T>& points, const T& ground, T friction, T weight,
             const CheckScratch<T>& r) {
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
                        const T grip = friction * points.points[&s - r.standing.data()].friction;
                        r.bearing[count++] = {s.place, Vec3<T>::UnitZ(), s.share, grip, body, push};
                      });
  const std::span<BearingPoint<T>> bearing = r.bearing.first(count);
  balance_ground<T>(bearing, force, moment, weight, points.unit);
  for (const BearingPoint<T>& p : bearing) {
    r.force[p.body] -= p.force;
    r.moment[p.body] -= p.place.cross(p.force);
  }
  wrenches_to_bodies(points, ground, r);
}

template <class T>
constexpr SupportTerm<T> kSupport{points_of<T>, stand<T>, balance<T>};

}  // namespace

template <class T>
void Support<T>::declare(StepPlan<T>& plan) {
  plan.support = &kSupport<T>;
}

template struct Support<float>;
template struct Support<double>;

}  // namespace sinew
