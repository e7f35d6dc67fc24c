// The step's scheme in time: Bossak's, of second order from one step back, through changes of contact.
//
// State: places, velocities v₀, angular momenta L₀ and, of each body, the acceleration a₀ and torque τ₀ that
// the forces at the end of the last step have left. With the spectral radius ρ that the fastest motions keep,
//
//   α_m = (ρ − 1)/(ρ + 1),  γ = ½ − α_m,  κ = (1 − α_m)/4
//   ĉ = c₀ + h v₀ + h²(½ − κ) a₀      R̂ = R₀ turned freely for h under L₀ + h(½ − κ) τ₀      α = 1/(κh²)
//
// The step minimises the incremental potential of scheme.h: all forces are those at its end. What they have
// done to a body there, f = α(c₁ − ĉ) and likewise g, is the smooth forces' and that of w, which moved it by
// (Δc, Δφ) = J M⁻¹Jᵀ w/α in this step and is not carried into the next one: impulses (a contact that has just
// closed), and forces that are constant over the step (muscles, pushes, what leads joints):
//
//   f ← f − αΔc,  g ← g − αIΔφ
//   a₁ = (f − α_m a₀)/(1 − α_m)                 τ₁ likewise
//   v* = v₀ + h[(1 − γ)a₀ + γa₁] + sΔc/h        L* likewise, with sIΔφ/h; s = 1 for impulses, 2 for constants
//
// Of what constants leave as speed half is J M⁻¹Jᵀ w as it was where the step began: so they act along the
// axes and at the lever arms of its middle. With those of its end alone a body that tips over an edge gains
// ½h|w × v| of angular momentum in every step. Where the two halves differ by much, as of a stiff pendulum in
// a strong wind, all of it is that of the end, which damps.
//
// The velocities are then those of the joints: u₁ = M⁻¹Jᵀ(m v*, L*) (end_velocities.h). Sources: Wood, Bossak
// and Zienkiewicz, "An alpha modification of Newmark's method", 1980; the split into smooth forces and
// impulses after Acary, "Projected event-capturing time-stepping schemes for nonsmooth mechanical systems",
// 2013.
#pragma once

#include <algorithm>
#include <span>

#include "sinew/optimizer/scheme.h"
#include "sinew/skeleton/scalar.h"

namespace sinew {

/// As above.
template <class T>
struct BossakWeights {
  T alpha_m, gamma, kappa;
  explicit BossakWeights(T rho)
      : alpha_m((rho - 1) / (rho + 1)), gamma(T(0.5) - alpha_m), kappa(T(0.25) * (1 - alpha_m)) {}
};

/// By what a force that is constant over a step of h seconds is larger in the potential: it moves a body by
/// ½h² of its acceleration, not by κh², and leaves twice that over h as speed.
/// T may be a pack.
template <class T>
T constant_emphasis(const T& weight, Number<T> h) {
  return largest(T(weight * (h * h / 2)), T(1));
}

/// 2κ of a step of h seconds with the weight α; 1 for implicit Euler's. See lasting() in contact.h.
template <class T>
T lasting_share(T weight, T h) {
  return std::min(2 / (weight * h * h), T(1));
}

/// rad: how far a body turns in a step of h seconds at its rate.
template <class T>
T turn_of(const History<T>& history, int body, T h);

/// rad: the furthest that a body of the tree turns in a step of h seconds at its rate.
template <class T>
T largest_turn(const Tree<T>& tree, const History<T>& history, T h);

/// Share of a tree's kinetic energy about its centre of mass that is of bodies which turn faster than `speed`
/// (rad/s), 0 to 1. O(bodies).
template <class T>
T share_turning_faster(const Tree<T>& tree, const History<T>& history, T speed);

/// Ṙ of a body, from its angular momentum.
template <class T>
Mat3<T> rotation_rate_of(const Tree<T>& tree, int body, const Mat3<T>& rotation, const Vec3<T>& momentum);

/// ρ where bodies turn by at most so far in a step. Small turns need next to none of its damping, and the
/// error of slow motions grows with 1 − ρ; far ones need more, for the axes that forces act along turn with
/// them. Less where something is driven: nothing bounds what that gains. Loops count as such: they are held
/// at the end of a step only, and what their forces alternate by dies away as ρⁿ.
template <class T>
T spectral_radius(T largest_turn, bool driven);

/// What bodies move less in a step than at the velocities that impulses have left in a tree's history just
/// before it, for these act within it.
template <class T>
struct Strike {
  std::span<const Vec3<T>> velocity;  ///< [body] m/s; empty: nothing
  std::span<const Vec3<T>> momentum;  ///< [body] angular, kg·m²/s
};

/// Targets of inertia for one step. The history must know its accelerations. O(bodies).
template <class T>
void predict_bossak(const Tree<T>& tree, const History<T>& history, const Strike<T>& strike, T rho, T h,
                    const Vec3<double>& common_origin, Prediction<T>& out);

/// How the bodies accelerate where a solve that began and ended at rest has led them (predict_at_rest), into
/// the history.
template <class T>
void accelerate(const Tree<T>& tree, const Kinematics<T>& kinematics, const Prediction<T>& at_rest,
                std::span<const Vec3<T>> torque, History<T>& history);

/// What impulses and constant forces have done to the bodies of a tree within a step.
template <class T>
struct Jumps {
  std::span<const Vec3<T>> moved;   ///< [body] Δc, m; empty: nothing
  std::span<const Vec3<T>> turned;  ///< [body] Δφ, rad, world axes
};

/// Moves the history on to the solution `kinematics`, but for the rotations' rates: velocities are still to
/// be those of the joints (EndVelocities). `torque` [body] is the rotational part of the inertial gradient
/// there (about each centre of mass). What impulses and constant forces leave as speed is still to be added
/// (EndVelocities::project). From a prediction of implicit Euler's velocities are those of the step, whatever
/// moved it, and accelerations those of its smooth forces.
template <class T>
void advance_bossak(const Tree<T>& tree, const Kinematics<T>& kinematics, const Prediction<T>& prediction,
                    std::span<const Vec3<T>> torque, const Jumps<T>& jumps, T h,
                    const Vec3<double>& common_origin, History<T>& history);

#define SINEW_BOSSAK_INSTANCES(prefix, T)                                                          \
  prefix T turn_of<T>(const History<T>&, int, T);                                                  \
  prefix T largest_turn<T>(const Tree<T>&, const History<T>&, T);                                  \
  prefix T share_turning_faster<T>(const Tree<T>&, const History<T>&, T);                          \
  prefix Mat3<T> rotation_rate_of<T>(const Tree<T>&, int, const Mat3<T>&, const Vec3<T>&);         \
  prefix T spectral_radius<T>(T, bool);                                                            \
  prefix void predict_bossak<T>(const Tree<T>&, const History<T>&, const Strike<T>&, T, T,         \
                                const Vec3<double>&, Prediction<T>&);                              \
  prefix void accelerate<T>(const Tree<T>&, const Kinematics<T>&, const Prediction<T>&,            \
                            std::span<const Vec3<T>>, History<T>&);                                \
  prefix void advance_bossak<T>(const Tree<T>&, const Kinematics<T>&, const Prediction<T>&,        \
                                std::span<const Vec3<T>>, const Jumps<T>&, T, const Vec3<double>&, \
                                History<T>&);
SINEW_BOSSAK_INSTANCES(extern template, float)
SINEW_BOSSAK_INSTANCES(extern template, double)

}  // namespace sinew
