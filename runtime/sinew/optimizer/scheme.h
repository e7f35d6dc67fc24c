// Implicit schemes: where inertia alone would carry each body, and the history that this needs.
//
// The step minimises  E(q) = α/2 Σ [ m‖c − ĉ‖² + tr((R − R̂) P (R − R̂)ᵀ) ] + potentials  (Gauss's principle of
// least constraint at finite displacement). ĉ, R̂ and α are what a scheme is:
//
//   momentum as bdf1, but the rotational residual is (I₁ω₁ − L₀)/h with ω₁ = log(R₁R₀ᵀ)/h: no gradient of
//          any energy
//   bdf1   ĉ = c₀ + h ċ₀                     R̂ = R₀ + h Ṙ₀ (affine)      α = 1/h²
//   bdf2   ĉ = a₀c₀ + a₁c₋₁ + βh(a₀ċ₀ + a₁ċ₋₁)   R̂ = R₀ exp(x)           α = 1/(βh)²
//          a₀ = (1+w)²/(1+2w), a₁ = −w²/(1+2w), β = (1+w)/(1+2w), w = h/h₋₁
//
// x is the torque-free rotation: I·(derivative of the rotation vector) = exp(−x) R₀ᵀ L*, L* = a₀L₀ + a₁L₋₁.
// With an affine R̂ bdf2 would be as stable, but free spin would decay.
#pragma once

#include <vector>

#include "sinew/optimizer/accuracy.h"
#include "sinew/residual/tree.h"

namespace sinew {

/// How the motion of a step was scaled after it was solved (scale_relative): what is relative to a rigid
/// motion, by `factor`. Kept for snapshots, which go by it.
template <class T>
struct RelativeScaling {
  Vec3<T> center = Vec3<T>::Zero(), velocity = Vec3<T>::Zero();  ///< m, m/s
  Vec3<T> spin = Vec3<T>::Zero();                                ///< rad/s
  T factor = T(1);

  /// What the velocity of a point at x gains.
  Vec3<T> faster(const Vec3<T>& x, const Vec3<T>& v) const {
    return (factor - 1) * (v - (velocity + spin.cross(x - center)));
  }
  /// What the rate of a rotation gains.
  Mat3<T> faster(const Mat3<T>& rotation, const Mat3<T>& rate) const {
    return (factor - 1) * (rate - skew<T>(spin) * rotation);
  }
};

/// Present and previous state of every body. Positions are relative to `place`, which follows the root in
/// double precision: float keeps its digits however far from the world's origin a character is.
template <class T>
struct History {
  Vec3<double> place = Vec3<double>::Zero();       ///< m, world; of the root's origin
  std::vector<Vec3<T>> center, center_before;      ///< m, from `place`
  std::vector<Vec3<T>> velocity, velocity_before;  ///< of the centre of mass, m/s
  std::vector<Mat3<T>> rotation, rotation_before;
  std::vector<Mat3<T>> rotation_rate;              ///< Ṙ₀
  std::vector<Vec3<T>> momentum, momentum_before;  ///< angular, about the centre of mass, kg·m²/s
  Scheme scheme = Scheme::kBdf2;                   ///< that led here
  RelativeScaling<T> scaled;                       ///< of the last step; factor 1: not
  T step_before = T(0);                            ///< s between before and now; 0: no earlier state

  explicit History(int bodies);
  /// Takes all motion out.
  void stop();
};

/// Sums over a tree, of the momenta that the schemes carry.
struct Totals {
  double kinetic_energy = 0, potential_energy = 0;       ///< J; gravity, from the world's origin
  Vec3<double> momentum = Vec3<double>::Zero();          ///< kg·m/s
  Vec3<double> angular_momentum = Vec3<double>::Zero();  ///< kg·m²/s, about the tree's centre of mass
};

/// Motion that a tree would have if its joints locked now: momenta as they are, nothing relative.
struct RigidMotion {
  Vec3<double> center = Vec3<double>::Zero();    ///< m, from the history's place
  Vec3<double> velocity = Vec3<double>::Zero();  ///< of the centre of mass, m/s
  Vec3<double> spin = Vec3<double>::Zero();      ///< rad/s
  double relative_energy = 0;                    ///< kinetic energy of the motion relative to it, J
};

/// Of a history that bdf2 led to.
template <class T>
RigidMotion rigid_motion(const Tree<T>& tree, const History<T>& history, const Totals& totals);

/// Scales the motion relative to the rigid one; momenta stay. What was before changes with it, so that the
/// backward differences of the next steps see a change of speed and no jolt.
template <class T>
void scale_relative(const Tree<T>& tree, const RigidMotion& rigid, T factor, History<T>& history);

/// Targets of inertia for one step, relative to the common origin.
template <class T>
struct Prediction {
  std::vector<Vec3<T>> center;    ///< ĉ
  std::vector<Mat3<T>> rotation;  ///< R̂
  std::vector<Vec3<T>> momentum;  ///< L*, so that L₁ = L* + βh·g
  std::vector<Mat3<T>> start;     ///< R₀ (momentum scheme)
  T weight = T(0);                ///< α, 1/s²
  T momentum_step = T(0);         ///< βh, s
  Scheme scheme = Scheme::kBdf1;
  bool exact = false;  ///< where nothing touches the tree: see predict_free_flight

  explicit Prediction(int bodies);
};

/// Fills `out` for a step of h seconds. bdf2 needs an earlier state; without one, bdf1 is used.
template <class T>
void predict(const Tree<T>& tree, const History<T>& history, Scheme scheme, T h,
             const Vec3<double>& common_origin, Prediction<T>& out);

/// Turns bdf2's prediction of a rigid tree with a free root about its centre of mass by what the backward
/// difference misses of a free body's rotation: where nothing touches it, it moves exactly, whatever the
/// turn.
template <class T>
void predict_free_flight(const Tree<T>& tree, const History<T>& history, T h, Prediction<T>& out);

/// Moves the history on to the solution `kinematics`. `torque` [body] is the rotational part of the inertial
/// gradient there (about each centre of mass).
template <class T>
void advance(const Tree<T>& tree, const Kinematics<T>& kinematics, const Prediction<T>& prediction,
             std::span<const Vec3<T>> torque, T h, const Vec3<double>& common_origin, History<T>& history);

/// What the scheme makes of the linear momentum in a step in which no force acts, kg·m/s; before advance().
template <class T>
Vec3<double> carried_momentum(const Tree<T>& tree, const History<T>& history, const Prediction<T>& prediction,
                              T h);

/// Gives a tree the linear momentum (kg·m/s) that it must have after advance(), by the same change of all
/// velocities: differences of rounded places, and what a solve leaves unbalanced, would add up in it.
template <class T>
void set_momentum(const Tree<T>& tree, const Vec3<double>& momentum, History<T>& history);

/// Moves the history on to a pose whose velocities are known exactly (playback).
template <class T>
void advance_exactly(const Tree<T>& tree, const Kinematics<T>& kinematics, const Motion<T>& motion, T h,
                     const Vec3<double>& common_origin, History<T>& history);

/// The kinetic energy is the one that the scheme dissipates. bdf2: ½m|ċ|² + ½L·I⁻¹L of the carried momentum,
/// which torque-free flight keeps; a difference of rotations would wobble by h²|ω|² around it. bdf1: ½ṘP:Ṙ
/// of the difference of rotations.
template <class T>
Totals totals(const Tree<T>& tree, const History<T>& history, const Vec3<double>& gravity);

#define SINEW_SCHEME_INSTANCES(prefix, T)                                                                    \
  prefix struct History<T>;                                                                                  \
  prefix struct Prediction<T>;                                                                               \
  prefix void predict<T>(const Tree<T>&, const History<T>&, Scheme, T, const Vec3<double>&, Prediction<T>&); \
  prefix void predict_free_flight<T>(const Tree<T>&, const History<T>&, T, Prediction<T>&);                  \
  prefix void advance<T>(const Tree<T>&, const Kinematics<T>&, const Prediction<T>&,                         \
                         std::span<const Vec3<T>>, T, const Vec3<double>&, History<T>&);                     \
  prefix Vec3<double> carried_momentum<T>(const Tree<T>&, const History<T>&, const Prediction<T>&, T);       \
  prefix void set_momentum<T>(const Tree<T>&, const Vec3<double>&, History<T>&);                             \
  prefix Totals totals<T>(const Tree<T>&, const History<T>&, const Vec3<double>&);                           \
  prefix RigidMotion rigid_motion<T>(const Tree<T>&, const History<T>&, const Totals&);                      \
  prefix void scale_relative<T>(const Tree<T>&, const RigidMotion&, T, History<T>&);                         \
  prefix void advance_exactly<T>(const Tree<T>&, const Kinematics<T>&, const Motion<T>&, T,                  \
                                 const Vec3<double>&, History<T>&);
SINEW_SCHEME_INSTANCES(extern template, float)
SINEW_SCHEME_INSTANCES(extern template, double)

}  // namespace sinew
