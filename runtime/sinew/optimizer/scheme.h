// What a step in time begins with: the history of every body, and where inertia alone would carry it.
//
// The step minimises  E(q) = α/2 Σ [ m‖c − ĉ‖² + tr((R − R̂) P (R − R̂)ᵀ) ] + potentials  (Gauss's principle of
// least constraint at finite displacement). ĉ, R̂ and α are what a scheme is: bossak.h.
#pragma once

#include <span>
#include <vector>

#include "sinew/residual/tree.h"

namespace sinew {

template <class T>
class TimeScheme;

/// State of every body. Positions are relative to `place`, which follows the root in double precision: float
/// keeps its digits however far from the world's origin a character is.
template <class T>
struct History {
  Vec3<double> place = Vec3<double>::Zero();  ///< m, world; of the root's origin
  std::vector<Vec3<T>> center;                ///< m, from `place`
  std::vector<Vec3<T>> velocity;              ///< of the centre of mass, m/s
  std::vector<Mat3<T>> rotation;
  std::vector<Mat3<T>> rotation_rate;  ///< Ṙ₀
  std::vector<Vec3<T>> momentum;       ///< angular, about the centre of mass, kg·m²/s
  std::vector<Vec3<T>> acceleration;   ///< of the centre of mass, by smooth forces, m/s²
  std::vector<Vec3<T>> torque;         ///< the same: change of the angular momentum, N·m
  bool accelerates = false;            ///< these two are known
  T step_before = T(0);                ///< s, the last step; 0: none since a reset
  std::vector<T> other;                ///< another scheme's own, see TimeScheme; empty
  bool turns_as_differenced = false;   ///< the same: its energy of turning is that of `rotation_rate`

  explicit History(int bodies);
  /// Takes all motion out.
  void stop();
};

/// rad/s, world axes.
template <class T>
Vec3<T> angular_velocity(const History<T>& history, int body) {
  const Mat3<T> w = history.rotation_rate[body] * history.rotation[body].transpose();
  return Vec3<T>(w(2, 1) - w(1, 2), w(0, 2) - w(2, 0), w(1, 0) - w(0, 1)) / 2;
}

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

/// Of a history's motion.
template <class T>
RigidMotion rigid_motion(const Tree<T>& tree, const History<T>& history, const Totals& totals);

/// Scales the motion relative to the rigid one, which keeps the momenta, and turns all faster by `turn`
/// (rad/s), which mends an angular momentum that was right before.
template <class T>
void change_motion(const Tree<T>& tree, const RigidMotion& rigid, T factor, const Vec3<double>& turn,
                   History<T>& history);

/// Targets of inertia for one step, relative to the common origin.
template <class T>
struct Prediction {
  std::vector<Vec3<T>> center;           ///< ĉ
  std::vector<Mat3<T>> rotation;         ///< R̂
  std::vector<Vec3<T>> momentum;         ///< L*, so that L₁ = L* + βh·g
  T weight = T(0);                       ///< α, 1/s²
  T momentum_step = T(0);                ///< βh, s
  T rho = T(0);                          ///< see BossakWeights; 0: implicit Euler's, see predict_euler
  const TimeScheme<T>* other = nullptr;  ///< whose they are; null: the runtime's own

  explicit Prediction(int bodies);
};

/// Targets of implicit Euler, ĉ = c₀ + h v₀, R̂ = R₀ + hṘ₀, α = 1/h²: at the pose where the step begins (1) is
/// the kinetic energy, so that what a descent from there stores is no more than there was.
template <class T>
void predict_euler(const Tree<T>& tree, const History<T>& history, T h, const Vec3<double>& common_origin,
                   Prediction<T>& out);

/// Targets with which a solve that begins and ends at rest finds how the tree's bodies accelerate now, under
/// the torques that its rows have at the start: it moves them by `span` (s²) times that. `force` and `couple`
/// [body] (about each centre of mass) are what the motion asks for were no joint accelerated.
template <class T>
void predict_at_rest(const Tree<T>& tree, const History<T>& history, std::span<const Vec3<T>> force,
                     std::span<const Vec3<T>> couple, T span, const Vec3<double>& common_origin,
                     Prediction<T>& out);

/// kg·m/s, of the velocities that a tree's bodies have.
template <class T>
Vec3<double> linear_momentum(const Tree<T>& tree, const History<T>& history);

/// Gives a tree the linear momentum (kg·m/s) that it must have after a step, by the same change of all
/// velocities: differences of rounded places, and what a solve leaves unbalanced, would add up in it.
template <class T>
void set_momentum(const Tree<T>& tree, const Vec3<double>& momentum, History<T>& history);

/// Moves the history on to a pose whose velocities and accelerations are known exactly (playback). `gravity`
/// (m/s²): that `motion` was measured under.
template <class T>
void advance_exactly(const Tree<T>& tree, const Kinematics<T>& kinematics, const Motion<T>& motion, T h,
                     const Vec3<T>& gravity, const Vec3<double>& common_origin, History<T>& history);

/// The kinetic energy is ½m|ċ|² + ½L·I⁻¹L of the carried momentum, which torque-free flight keeps; a
/// difference of rotations would wobble by h²|ω|² around it.
template <class T>
Totals totals(const Tree<T>& tree, const History<T>& history, const Vec3<double>& gravity);

/// Of the motion `jets` [body], the root's in the world. Of `kinematics` and `motion`, which are room, it
/// leaves rotations, origins from the root's, their velocities, and angular velocities. O(bodies).
template <class T>
Totals totals(const Tree<T>& tree, std::span<const JointJet<T>> jets, const Vec3<double>& gravity,
              Kinematics<T>& kinematics, Motion<T>& motion);

/// Where a free body that is at `start` (body → world) with the angular momentum L (world) is after h
/// seconds, which may be negative: Ṙ = R ω^, ω = I⁻¹ Rᵀ L, by Magnus's series of fourth order in parts of
/// 0.15 rad (Hairer, Lubich and Wanner, "Geometric Numerical Integration", 2006, section IV.7).
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
  prefix void predict_euler<T>(const Tree<T>&, const History<T>&, T, const Vec3<double>&, Prediction<T>&);   \
  prefix void predict_at_rest<T>(const Tree<T>&, const History<T>&, std::span<const Vec3<T>>,                \
                                 std::span<const Vec3<T>>, T, const Vec3<double>&, Prediction<T>&);          \
  prefix Vec3<double> linear_momentum<T>(const Tree<T>&, const History<T>&);                                 \
  prefix void set_momentum<T>(const Tree<T>&, const Vec3<double>&, History<T>&);                             \
  prefix Totals totals<T>(const Tree<T>&, const History<T>&, const Vec3<double>&);                           \
  prefix Totals totals<T>(const Tree<T>&, std::span<const JointJet<T>>, const Vec3<double>&, Kinematics<T>&, \
                          Motion<T>&);                                                                       \
  prefix RigidMotion rigid_motion<T>(const Tree<T>&, const History<T>&, const Totals&);                      \
  prefix void change_motion<T>(const Tree<T>&, const RigidMotion&, T, const Vec3<double>&, History<T>&);     \
  prefix void advance_exactly<T>(const Tree<T>&, const Kinematics<T>&, const Motion<T>&, T, const Vec3<T>&,  \
                                 const Vec3<double>&, History<T>&);                                          \
  prefix Vec3<T> follow_root<T>(const Kinematics<T>&, const Vec3<double>&, History<T>&);
SINEW_SCHEME_INSTANCES(extern template, float)
SINEW_SCHEME_INSTANCES(extern template, double)

}  // namespace sinew
