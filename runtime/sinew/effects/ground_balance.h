// What the ground can do for a character: forces at the points that stand, within friction, that come closest
// to what its motion asks of the root.
//
// share_support (support.h) gives what standing people do; on one leg, or where weight moves from foot to
// foot, it drops negative forces and no longer holds the tilt. Here the same forces are moved as little as it
// takes to balance all six components,
//
//     min ½ Σ |f_p − f⁰_p|²/w_p + |r − G f|²/(2ε),   f_p in its friction cone,
//
// r the wrench that is asked for, G f that of the forces, w_p the share of the weight that a point may bear,
// ε next to nothing. The dual has six unknowns y = (r − G f)/ε, one for each component, and is smooth:
// f_p(y) = P(f⁰_p + w_p G_pᵀ y) with P the projection on the cone, and Newton's matrix Σ w_p G_p P' G_pᵀ + ε
// is positive. Where the ground can't, the rest is what some other hand would have to do.
#pragma once

#include <span>

#include "sinew/skeleton/scalar.h"

namespace sinew {

template <class T>
struct BearingPoint {
  Vec3<T> place;   ///< m, from the common origin
  Vec3<T> normal;  ///< of the ground there, unit
  T share;         ///< of what it may bear: 1 on the ground, 0 at the reach
  T friction;      ///< μ
  int body;
  int point = 0;                    ///< its number among all that may stand
  Vec3<T> force = Vec3<T>::Zero();  ///< N, on the body; before: what it would bear by preference
};

/// Chooses `force` of all points so that they balance `force` (N) and `moment` (N·m, about the common origin)
/// as well as the ground can. `weight` (N) and `unit` (m): of the character, what is large for it. Returns
/// the Newton steps taken, at most kBalanceSteps. O(points).
template <class T>
int balance_ground(std::span<BearingPoint<T>> points, const Vec3<T>& force, const Vec3<T>& moment, T weight,
                   T unit);

/// Where little stands and much is asked it takes up to 42. Fewer leave what is worse than nothing.
constexpr int kBalanceSteps = 64;

extern template int balance_ground<float>(std::span<BearingPoint<float>>, const Vec3<float>&,
                                          const Vec3<float>&, float, float);
extern template int balance_ground<double>(std::span<BearingPoint<double>>, const Vec3<double>&,
                                           const Vec3<double>&, double, double);

}  // namespace sinew
