// Limits of joints: ranges of single degrees of freedom from the rest pose, or a ball joint's swing cone and
// twist range. One-sided springs of Accuracy::limit_stiffness, damped as contacts are.
#pragma once

#include <cmath>

#include "sinew/effects/joint_step.h"
#include "sinew/effects/step_plan.h"
#include "sinew/skeleton/portable_math.h"

namespace sinew {

/// Rows of a scalar between two bounds, of which each may be there or not; `unit`: see JointStep. `at_start`
/// tells the scalar when the step began, and is asked only where the bound is near.
template <class T, class Law, class Present, class AtStart, class Rows>
void append_bounds(const JointStep<T, Law>& joint, const T& scalar, Number<T> lower, const Present& has_lower,
                   Number<T> upper, const Present& has_upper, const AtStart& at_start, JointRow<T> row,
                   Rows& rows, Number<T> unit = Number<T>(1)) {
  const Number<T> near = Number<T>(0.05) * unit;  // rad or m
  row.kind = RowKind::kOneSided;
  row.stiffness = joint.limit_stiffness / (unit * unit);
  const auto append = [&](Number<T> sign, Number<T> bound, const Present& present) {
    if (!any(present)) return;
    row.value = T(sign) * (scalar - T(bound));
    const auto begun = [&] { return T(T(sign) * (at_start() - T(bound))); };
    const T start = choose(row.value > T(-near), begun, [] { return T(0); });
    row.damp(T(joint.limit_damping), T(joint.h), start);
    rows.add_row(row, present);
  };
  append(1, upper, has_upper);
  row.sign = -row.sign;
  for (T& g : row.gradient) g = -g;
  append(-1, lower, has_lower);
}

/// Ranges of single degrees of freedom.
template <class T, class Law = JointLaw<T>, class Rows = JointRowList<T>>
struct JointLimitRows {
  using Step = JointStep<T, Law>;  ///< a joint as the step has it now

  /// Whether it has ranges of single degrees of freedom; its offset from the rest pose then.
  static bool look(const Step& joint, JointOffset<T>& from_rest, Rows& /*rows*/) {
    const Law& law = joint.law;
    const bool ranges = law.swing_limit[joint.body] < 0 && joint.tree.type[joint.body] != JointType::kFree &&
                        joint.any_dof([&](int dof) {
                          return law.lower[dof] > -law.kUnlimited || law.upper[dof] < law.kUnlimited;
                        });
    if (ranges) from_rest = offset_of<T>(joint.tree, joint.body, rest_of(joint), joint.local);
    return ranges;
  }
  /// Adds the rows of its k-th degree of freedom.
  static void append(const Step& joint, const JointOffset<T>& from_rest, int k, Rows& rows) {
    const int dof = joint.first_dof() + k;
    const Number<T> lower = joint.law.lower[dof], upper = joint.law.upper[dof], most = joint.law.kUnlimited;
    if (!(lower > -most || upper < most)) return;
    const auto always = T(0) <= T(0);
    const auto at_start = [&] {
      return offset_value_of<T>(joint.tree, joint.body, rest_of(joint), joint.start)[k];
    };
    append_bounds(joint, from_rest.value[k], lower, lower > -most ? always : !always, upper,
                  upper < most ? always : !always, at_start, joint.row(from_rest, RowScalar::kFromRest, k),
                  rows, joint.unit(k));
  }
  static constexpr JointTerm<T, Law, Rows> kTerm{look, append};  ///< as a plan holds it

 private:
  static Transform<T> rest_of(const Step& joint) { return joint.tree.rest[joint.body].template cast<T>(); }
};

/// rad, by which a rotation from rest swings the bone direction there: what a cone limits.
template <class T>
T swing_angle(const Quat<T>& relative, const Vec3<T>& bone) {
  const Vec3<T> now = relative * bone;
  return portable::atan2(T(bone.cross(now).norm()), T(bone.dot(now)));
}

/// Swing cone and twist range about the bone direction a at rest. With b the direction now, the swing angle
/// changes by n·w, n = (a × b)/|a × b|, the twist by (a + b)·w/(1 + a·b); w in rest axes.
template <class T, class Law, class Rows>
void append_cone(const JointStep<T, Law>& joint, Rows& rows) {
  using portable::atan2;
  const Law& law = joint.law;
  const int i = joint.body;
  const Quat<T> unrest = joint.tree.rest[i].rotation.conjugate().template cast<T>();
  const Quat<T> relative = unrest * joint.local.rotation;
  const Vec3<T> a = law.swing_axis[i].template cast<T>();
  const Vec3<T> b = relative * a;
  const Vec3<T> across = a.cross(b);
  const T sine = across.norm(), cosine = a.dot(b);
  const auto start = [&] { return Quat<T>(unrest * joint.start.rotation); };
  JointRow<T> row;
  row.dof = joint.first_dof();
  row.count = 3;
  const auto set = [&](const Vec3<T>& in_rest) {
    const Vec3<T> in_child = relative.conjugate() * in_rest;
    row.gradient = {in_child.x(), in_child.y(), in_child.z()};
  };
  // Rows well inside the range cannot become active within a step; leave them out.
  constexpr auto near = Number<T>(0.5);
  const Number<T> limit = law.swing_limit[i], most = law.kUnlimited;
  const auto none = T(0) > T(0);
  if (limit - near < Number<T>(3.14159265)) {
    const auto bent = both(sine > T(1e-6), cosine < T(portable::cos(std::max(limit - near, Number<T>(0)))));
    if (any(bent)) {
      row.scalar = RowScalar::kSwing;
      set(across / sine);
      const auto swing_at_start = [&] {
        const Vec3<T> bone = start() * a;
        return T(atan2(T(a.cross(bone).norm()), T(a.dot(bone))));
      };
      append_bounds(joint, T(atan2(sine, cosine)), Number<T>(0), none, limit, bent, swing_at_start, row,
                    rows);
    }
  }
  const T toward = T(1) + a.dot(b);
  if (const auto open = toward > T(0.05); any(open)) {
    const T twist = twist_angle<T>(relative, a);
    row.scalar = RowScalar::kTwist;
    set((a + b) / toward);
    const Number<T> lower = law.twist_lower[i], upper = law.twist_upper[i];
    const auto low = lower > -most ? both(open, twist < T(lower + near)) : none;
    const auto high = upper < most ? both(open, twist > T(upper - near)) : none;
    append_bounds(
        joint, twist, lower, low, upper, high, [&] { return twist_angle<T>(start(), a); }, row, rows);
  }
}

/// Second derivative of the swing angle and the twist of a ball joint by a small rotation of the child, child
/// axes, weighted by the rows' slopes; `relative`: from the rest pose. With w in rest axes:
/// swing'' = [cos·(|w|² − (n·w)²) − (a·w)(b·w)]/sin, twist'' = (w·(a + b))(w·(a × b))/(1 + a·b)².
template <class T>
Mat3<T> cone_curvature(const Quat<T>& relative, const Vec3<T>& a, const T& swing_slope,
                       const T& twist_slope) {
  const Vec3<T> b = relative * a;
  const Vec3<T> across = a.cross(b);
  const T sine = largest(T(across.norm()), T(1e-6)), cosine = a.dot(b);
  const Vec3<T> n = across / sine;
  const T toward = largest(T(T(1) + cosine), T(0.05));
  const Mat3<T> swing = (cosine * (Mat3<T>::Identity() - n * n.transpose()) -
                         T(0.5) * (a * b.transpose() + b * a.transpose())) /
                        sine;
  const Vec3<T> sum = a + b;
  const Mat3<T> twist = T(0.5) * (sum * across.transpose() + across * sum.transpose()) / (toward * toward);
  const Mat3<T> turn = relative.toRotationMatrix();
  return turn.transpose() * (swing_slope * swing + twist_slope * twist) * turn;
}

/// Cones and twists of ball joints.
template <class T, class Law = JointLaw<T>, class Rows = JointRowList<T>>
struct ConeRows {
  /// As a plan holds it.
  static constexpr ConeTerm<T, Law, Rows> kTerm{append_cone<T, Law, Rows>, cone_curvature<T>};
};

/// What World::declare takes. Without, joints bend as far as they are bent.
template <class T>
struct JointLimits {
  /// Writes its functions into the world's plan.
  static void declare(StepPlan<T>& plan);
};

extern template struct JointLimits<float>;
extern template struct JointLimits<double>;

}  // namespace sinew
