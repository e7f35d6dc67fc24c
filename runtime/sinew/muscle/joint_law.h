// What a skeleton says about its joints' muscles, friction, damping and limits.
#pragma once

#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "sinew/muscle/muscle_side.h"
#include "sinew/residual/tree.h"

namespace sinew {

/// Which of a law's properties any joint has: what none has is not looked for in joint after joint.
struct JointLawPresence {
  bool muscles = false, losses = false, ranges = false, cones = false;
};

/// Limits and passive properties of a tree's joints, as the step needs them.
template <class T>
struct JointLaw {
  static constexpr T kUnlimited = T(1e9);  ///< of `lower` and `upper`

  std::vector<T> torque_minus, torque_plus;  ///< [dof] muscle limits now (strength applied), N·m
  std::vector<T> dry_friction, damping;      ///< [dof] N·m, N·m·s/rad
  std::vector<T> lower, upper;               ///< [dof] rad or m; |bound| ≥ kUnlimited: none
  std::vector<T> swing_limit;                ///< [body] rad, < 0: none
  std::vector<Vec3<T>> swing_axis;           ///< [body]
  std::vector<T> twist_lower, twist_upper;   ///< [body]
  std::vector<std::uint8_t> ellipsoidal;     ///< [body] 1: the three limits are an ellipsoid's half axes
  JointLawPresence present;

  JointLaw(const Tree<T>& tree, const Skeleton& skeleton);
  /// After muscles came or went.
  void refresh_presence();
  /// Whether a muscle pulls on a degree of freedom at all.
  bool has_muscle(int dof) const { return torque_minus[dof] > T(0) || torque_plus[dof] > T(0); }
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
