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

#include <span>
#include <vector>

#include "sinew/optimizer/accuracy.h"
#include "sinew/residual/tree.h"

namespace sinew {

/// How the motion of a step was changed after it was solved: `push` added to all velocities (set_momentum);
/// then what was relative to a rigid motion scaled by `factor`, and all turned faster by `turn`
/// (change_motion). Kept for snapshots, which go by it.
template <class T>
struct MotionChange {
  Vec3<T> push = Vec3<T>::Zero();                                ///< m/s
  Vec3<T> center = Vec3<T>::Zero(), velocity = Vec3<T>::Zero();  ///< m, m/s
  Vec3<T> spin = Vec3<T>::Zero(), turn = Vec3<T>::Zero();        ///< rad/s
  T factor = T(1);

  bool none() const { return factor == T(1) && push.isZero(T(0)) && turn.isZero(T(0)); }
  /// What the velocity of a point at x gains from scaling.
  Vec3<T> scaled(const Vec3<T>& x, const Vec3<T>& v) const {
    return (factor - 1) * (v - (velocity + spin.cross(x - center)));
  }
  /// The same with the turn.
  Vec3<T> faster(const Vec3<T>& x, const Vec3<T>& v) const { return scaled(x, v) + turn.cross(x - center); }
  /// What the rate of a rotation gains.
  Mat3<T> faster(const Mat3<T>& rotation, const Mat3<T>& rate) const {
    const Vec3<T> gained = turn - (factor - 1) * spin;
    Mat3<T> sum = (factor - 1) * rate;
    for (int a = 0; a < 3; ++a) sum.col(a) += gained.cross(rotation.col(a));
    return sum;
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
  std::vector<Vec3<T>> acceleration;               ///< Bossak's scheme: of the centre of mass, m/s²
  std::vector<Vec3<T>> torque;                     ///< the same: change of the angular momentum, N·m
  bool accelerates = false;                        ///< these two are known
  Scheme scheme = Scheme::kBdf2;                   ///< that led here
  MotionChange<T> changed;                         ///< by the last step, after it was solved
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
  Mat3<double> inertia = Mat3<double>::Zero();   ///< of all, joints locked, about the centre, kg·m²

  /// Spin (rad/s) that a change of the angular momentum makes; a rod's about itself changes nothing.
  Vec3<double> spin_of(const Vec3<double>& momentum) const;
};

/// Of a history that bdf2 led to.
template <class T>
RigidMotion rigid_motion(const Tree<T>& tree, const History<T>& history, const Totals& totals);

/// Scales the motion relative to the rigid one, which keeps the momenta, and turns all faster by `turn`
/// (rad/s). What was before is scaled with it, so that the backward differences of the next steps see a
/// change of speed and no jolt; a turn mends an angular momentum that was right before.
template <class T>
void change_motion(const Tree<T>& tree, const RigidMotion& rigid, T factor, const Vec3<double>& turn,
                   History<T>& history);

/// Targets of inertia for one step, relative to the common origin.
template <class T>
struct Prediction {
  std::vector<Vec3<T>> center;    ///< ĉ
  std::vector<Mat3<T>> rotation;  ///< R̂
  std::vector<Vec3<T>> momentum;  ///< L*, so that L₁ = L* + βh·g
  std::vector<Mat3<T>> start;     ///< R₀ (momentum scheme)
  T weight = T(0);                ///< α, 1/s²
  T momentum_step = T(0);         ///< βh, s
  T rho = T(0);                   ///< Bossak's scheme: see BossakWeights
  T k1 = T(1), k2 = T(0);  ///< of the backward difference: rate at the end = (k1 (x₁ − x₀) − k2 (x₀ − x₋₁))/h
  Scheme scheme = Scheme::kBdf1;
  bool exact = false;  ///< where nothing touches the tree: see predict_free_flight
  bool first = false;  ///< bdf2 with no earlier state: see predict_first

  explicit Prediction(int bodies);
};

/// Fills `out` for a step of h seconds. bdf2 needs an earlier state; without one, bdf1 is used.
template <class T>
void predict(const Tree<T>& tree, const History<T>& history, Scheme scheme, T h,
             const Vec3<double>& common_origin, Prediction<T>& out);

/// Targets with which a solve that begins and ends at rest finds how the tree's bodies accelerate now, under
/// the torques that its rows have at the start: it moves them by `span` (s²) times that. `force` and `couple`
/// [body] (about each centre of mass) are what the motion asks for were no joint accelerated.
template <class T>
void predict_at_rest(const Tree<T>& tree, const History<T>& history, std::span<const Vec3<T>> force,
                     std::span<const Vec3<T>> couple, T span, const Vec3<double>& common_origin,
                     Prediction<T>& out);

/// The first step of bdf2, as if the one before had been infinitely short (w → ∞): the trapezoidal rule, of
/// second order from the first step on. `out` holds the targets of predict_at_rest, `kinematics` and `torque`
/// [body] what its solve has found.
template <class T>
void predict_first(const Tree<T>& tree, const History<T>& history, const Kinematics<T>& kinematics,
                   std::span<const Vec3<T>> torque, T h, const Vec3<double>& common_origin,
                   Prediction<T>& out);

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

/// Moves the history on to a pose whose velocities and accelerations are known exactly (playback). `gravity`
/// (m/s²): that `motion` was measured under.
template <class T>
void advance_exactly(const Tree<T>& tree, const Kinematics<T>& kinematics, const Motion<T>& motion, T h,
                     const Vec3<T>& gravity, const Vec3<double>& common_origin, History<T>& history);

/// The kinetic energy is the one that the scheme dissipates. bdf2: ½m|ċ|² + ½L·I⁻¹L of the carried momentum,
/// which torque-free flight keeps; a difference of rotations would wobble by h²|ω|² around it. bdf1: ½ṘP:Ṙ
/// of the difference of rotations.
template <class T>
Totals totals(const Tree<T>& tree, const History<T>& history, const Vec3<double>& gravity);

/// Where a free body that is at `start` (body → world) with the angular momentum L (world) is after h seconds,
/// which may be negative: Ṙ = R ω^, ω = I⁻¹ Rᵀ L, by Magnus's series of fourth order in parts of 0.15 rad
/// (Hairer, Lubich and Wanner, "Geometric Numerical Integration", 2006, section IV.7).
template <class T>
Mat3<T> free_rotation(const Mat3<T>& inverse_inertia, const Mat3<T>& start, const Vec3<T>& momentum, T h);
extern template Mat3<float> free_rotation<float>(const Mat3<float>&, const Mat3<float>&, const Vec3<float>&,
                                                 float);
extern template Mat3<double> free_rotation<double>(const Mat3<double>&, const Mat3<double>&,
                                                   const Vec3<double>&, double);

/// Moves a history's place on to the root of `kinematics`; returns by how much.
template <class T>
Vec3<T> follow_root(const Kinematics<T>& kinematics, const Vec3<double>& common_origin, History<T>& history);

#define SINEW_SCHEME_INSTANCES(prefix, T)                                                                    \
  prefix struct History<T>;                                                                                  \
  prefix struct Prediction<T>;                                                                               \
  prefix void predict<T>(const Tree<T>&, const History<T>&, Scheme, T, const Vec3<double>&, Prediction<T>&); \
  prefix void predict_at_rest<T>(const Tree<T>&, const History<T>&, std::span<const Vec3<T>>,                \
                                 std::span<const Vec3<T>>, T, const Vec3<double>&, Prediction<T>&);          \
  prefix void predict_first<T>(const Tree<T>&, const History<T>&, const Kinematics<T>&,                      \
                               std::span<const Vec3<T>>, T, const Vec3<double>&, Prediction<T>&);            \
  prefix void predict_free_flight<T>(const Tree<T>&, const History<T>&, T, Prediction<T>&);                  \
  prefix void advance<T>(const Tree<T>&, const Kinematics<T>&, const Prediction<T>&,                         \
                         std::span<const Vec3<T>>, T, const Vec3<double>&, History<T>&);                     \
  prefix Vec3<double> carried_momentum<T>(const Tree<T>&, const History<T>&, const Prediction<T>&, T);       \
  prefix void set_momentum<T>(const Tree<T>&, const Vec3<double>&, History<T>&);                             \
  prefix Totals totals<T>(const Tree<T>&, const History<T>&, const Vec3<double>&);                           \
  prefix RigidMotion rigid_motion<T>(const Tree<T>&, const History<T>&, const Totals&);                      \
  prefix void change_motion<T>(const Tree<T>&, const RigidMotion&, T, const Vec3<double>&, History<T>&);     \
  prefix void advance_exactly<T>(const Tree<T>&, const Kinematics<T>&, const Motion<T>&, T, const Vec3<T>&,  \
                                 const Vec3<double>&, History<T>&);                                          \
  prefix Vec3<T> follow_root<T>(const Kinematics<T>&, const Vec3<double>&, History<T>&);
SINEW_SCHEME_INSTANCES(extern template, float)
SINEW_SCHEME_INSTANCES(extern template, double)

}  // namespace sinew
