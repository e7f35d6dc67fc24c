// What a skeleton says about its joints' muscles, friction, damping and limits.
#pragma once

#include <cmath>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "sinew/muscle/muscle_side.h"
#include "sinew/residual/tree.h"

namespace sinew {

/// Which of a law's properties any joint has: what none has is not looked for in joint after joint.
struct JointLawPresence {
  bool muscles = false;  ///< torque limits above 0
  bool losses = false;   ///< dry friction or damping
  bool ranges = false;   ///< bounds of degrees of freedom
  bool cones = false;    ///< of ball joints' swing
  bool tone = false;     ///< of some muscle, that is not rigid
};

/// Of one degree of freedom's muscle, see tone.h.
template <class T>
struct ToneOfDof {
  T stiffness = std::numeric_limits<T>::infinity();  ///< N·m/rad that was asked for; ∞: rigid
  T damping_ratio = T(0);                            ///< ζ ≥ 0
  T feed_forward = T(0);  ///< N·m, what the animation asks for by itself at the end of the frame
  T before = T(0);        ///< N·m, the same at its beginning
  // Of the present part of a step
  T asked = T(0);    ///< N·m, what it asks for over the part, with what the joint loses
  T inertia = T(0);  ///< kg·m², of what the joint carries, about its axis
  T slope = T(0);    ///< κ, N·m/rad: k and d in one
  T neutral = T(0);  ///< s*, rad from the animation: where the muscle does nothing

  /// As stiff as its limit allows.
  bool rigid() const { return !(stiffness < std::numeric_limits<T>::infinity()); }
};

/// Limits and passive properties of a tree's joints, as the step needs them.
template <class T>
struct JointLaw {
  static constexpr T kUnlimited = T(1e9);  ///< of `lower` and `upper`

  std::vector<T> torque_minus;  ///< [dof] N·m, ≥ 0: muscle limit now (strength applied), negative direction
  std::vector<T> torque_plus;   ///< [dof] N·m, ≥ 0: the same, positive direction
  std::vector<T> dry_friction;            ///< [dof] N·m; 0 of a free joint
  std::vector<T> damping;                 ///< [dof] N·m·s/rad
  std::vector<T> lower;                   ///< [dof] rad or m; ≤ −kUnlimited: none
  std::vector<T> upper;                   ///< [dof] rad or m; ≥ kUnlimited: none
  std::vector<T> swing_limit;             ///< [body] rad, < 0: none
  std::vector<Vec3<T>> swing_axis;        ///< [body] see Joint::swing_axis
  std::vector<T> twist_lower;             ///< [body] rad, of a ball with a swing cone
  std::vector<T> twist_upper;             ///< [body] the same
  std::vector<std::uint8_t> ellipsoidal;  ///< [body] 1: the three limits are an ellipsoid's half axes
  std::vector<ToneOfDof<T>> tone;         ///< [dof]; empty where nobody can ask for any
  JointLawPresence present;               ///< as refresh_presence() found it

  /// Set-up: all muscles at strength 1 and rigid.
  JointLaw(const Tree<T>& tree, const Skeleton& skeleton);
  /// After muscles came or went.
  void refresh_presence();
  /// Whether a muscle pulls on a degree of freedom at all.
  bool has_muscle(int dof) const { return torque_minus[dof] > T(0) || torque_plus[dof] > T(0); }
  /// Whether that gives way below its limit. One without a limit plays the animation, whatever its tone.
  bool has_tone(int dof) const {
    return present.tone && !tone[dof].rigid() && has_muscle(dof) && std::isfinite(torque_minus[dof]) &&
           std::isfinite(torque_plus[dof]);
  }
  /// Muscle limit of a degree of freedom on the side of `torque`.
  T limit(int dof, T torque) const { return on_side(torque, torque_minus[dof], torque_plus[dof]); }
  /// Whether `torque` [dof] is more than the muscle of a degree of freedom can give. Cheaper than load().
  bool overloaded(const Tree<T>& tree, int body, int dof, std::span<const T> torque) const {
    return ellipsoidal[body] ? load(tree, body, dof, torque) > T(1)
                             : std::abs(torque[dof]) > limit(dof, torque[dof]);
  }
  /// Share of its limit that a muscle gives for `torque` [dof]; 0 where there is none. An ellipsoid's three
  /// share one.
  T load(const Tree<T>& tree, int body, int dof, std::span<const T> torque) const;
};

extern template struct JointLaw<float>;
extern template struct JointLaw<double>;

}  // namespace sinew
