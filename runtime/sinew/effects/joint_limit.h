// Limits of joints: ranges of single degrees of freedom from the rest pose, or a ball joint's swing cone and
// twist range. One-sided springs of Accuracy::limit_stiffness, damped as contacts are.
#pragma once

#include "sinew/effects/joint_step.h"

namespace sinew {

/// Ranges of single degrees of freedom.
template <class T>
class JointLimitRows {
 public:
  static bool act(const JointStep<T>& joint) {
    const JointLaw<T>& law = joint.law;
    return law.swing_limit[joint.body] < T(0) && joint.tree.type[joint.body] != JointType::kFree &&
           joint.any(
               [&](int dof) { return law.lower[dof] > -law.kUnlimited || law.upper[dof] < law.kUnlimited; });
  }
  explicit JointLimitRows(const JointStep<T>& joint);

  void append(const JointStep<T>& joint, int k, std::vector<JointRow<T>>& rows) const;

 private:
  JointOffset<T> from_rest_;
};

/// Swing cone and twist range about the bone direction a at rest. With b the direction now, the swing angle
/// changes by n·w, n = (a × b)/|a × b|, the twist by (a + b)·w/(1 + a·b); w in rest axes.
template <class T>
void append_cone(const JointStep<T>& joint, std::vector<JointRow<T>>& rows);

/// Second derivative of the swing angle and the twist of a ball joint by a small rotation of the child, child
/// axes, weighted by the rows' slopes; `relative`: from the rest pose. With w in rest axes:
/// swing'' = [cos·(|w|² − (n·w)²) − (a·w)(b·w)]/sin, twist'' = (w·(a + b))(w·(a × b))/(1 + a·b)².
template <class T>
Mat3<T> cone_curvature(const Quat<T>& relative, const Vec3<T>& swing_axis, T swing_slope, T twist_slope);

#define SINEW_JOINT_LIMIT_INSTANCES(prefix, T)                                \
  prefix class JointLimitRows<T>;                                             \
  prefix void append_cone<T>(const JointStep<T>&, std::vector<JointRow<T>>&); \
  prefix Mat3<T> cone_curvature<T>(const Quat<T>&, const Vec3<T>&, T, T);
SINEW_JOINT_LIMIT_INSTANCES(extern template, float)
SINEW_JOINT_LIMIT_INSTANCES(extern template, double)

}  // namespace sinew
