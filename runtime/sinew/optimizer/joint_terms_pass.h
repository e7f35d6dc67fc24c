// The rows of joint_terms.h on any scalar: float, double or a pack of characters of one rig (pack.h).
//
// `p` is a TreeProblem<T> or what has its members. Rows of a pack are in the same order for all its lanes;
// add_row(row, present) leaves one out where it is not present.
#pragma once

#include <algorithm>
#include <type_traits>

#include "sinew/muscle/joint_coordinates_pass.h"
#include "sinew/optimizer/problem.h"

namespace sinew {

/// From here on a bound is none.
constexpr double kUnlimited = 1e9;

/// Where a ball or free joint's row of offsets depends on the joint's own three rotations.
template <class T>
void set_gradient(const JointOffset<T>& offset, int rotational_first, int k, int first_dof,
                  JointRow<T>& row) {
  if (rotational_first >= 0 && k >= rotational_first) {
    row.dof = first_dof + rotational_first;
    row.count = 3;
    for (int a = 0; a < 3; ++a) row.gradient[a] = offset.rotational(k - rotational_first, a);
  } else {
    row.dof = first_dof + k;
    row.count = 1;
    row.gradient[0] = T(1);
  }
}

/// Rows of a scalar between two bounds, of which each may be there or not. `at_start` tells the scalar when
/// the step began, and is asked only where the bound is near.
template <class T, class Problem, class Present, class AtStart>
void add_limits(const StepSettings<Number<T>>& settings, const T& scalar, Number<T> lower,
                const Present& has_lower, Number<T> upper, const Present& has_upper, const AtStart& at_start,
                JointRow<T> row, Problem& p) {
  constexpr auto near = Number<T>(0.05);  // rad or m
  row.kind = RowKind::kOneSided;
  row.stiffness = settings.limit_stiffness;
  const auto add = [&](Number<T> sign, Number<T> bound, const Present& present) {
    if (!any(present)) return;
    row.value = T(sign) * (scalar - T(bound));
    const auto begun = [&] { return T(T(sign) * (at_start() - T(bound))); };
    const T start = choose(row.value > T(-near), begun, [] { return T(0); });
    row.damp(T(settings.limit_damping), T(settings.h), start);
    p.add_row(row, present);
  };
  add(1, upper, has_upper);
  row.sign = -row.sign;
  for (T& g : row.gradient) g = -g;
  add(-1, lower, has_lower);
}

template <class T, class Problem>
void add_ellipsoid(const StepSettings<T>& settings, int i, const JointOffset<T>& from_target, Problem& p) {
  EllipsoidRow<T>& row = p.ellipsoids.emplace_back();
  row.dof = p.tree->first_dof[i];
  row.gradient = from_target.rotational;
  row.width = settings.kink_width;
  for (int a = 0; a < 3; ++a) {
    row.value[a] = from_target.value[a];
    row.minus[a] = p.law.torque_minus[row.dof + a];
    row.plus[a] = p.law.torque_plus[row.dof + a];
  }
}

/// Swing cone and twist range of a ball joint, about the bone direction a at rest. With b the direction now,
/// the swing angle changes by n·w, n = (a × b)/|a × b|, the twist by (a + b)·w/(1 + a·b); w in rest axes.
template <class T, class Problem>
void add_cone(const StepSettings<Number<T>>& settings, int i, Problem& p) {
  using std::atan2;
  const Tree<Number<T>>& tree = *p.tree;
  const Quat<T> relative = tree.rest[i].rotation.conjugate().template cast<T>() * p.local[i].rotation;
  const Vec3<T> a = p.law.swing_axis[i].template cast<T>();
  const Vec3<T> b = relative * a;
  const Vec3<T> across = a.cross(b);
  const T sine = across.norm(), cosine = a.dot(b);
  const auto start = [&] {
    return Quat<T>(tree.rest[i].rotation.conjugate().template cast<T>() * p.start[i].rotation);
  };
  JointRow<T> row;
  row.dof = tree.first_dof[i];
  row.count = 3;
  const auto set = [&](const Vec3<T>& in_rest) {
    const Vec3<T> in_child = relative.conjugate() * in_rest;
    row.gradient = {in_child.x(), in_child.y(), in_child.z()};
  };
  // Rows well inside the range cannot become active within a step; leave them out.
  constexpr auto near = Number<T>(0.5);
  const Number<T> limit = p.law.swing_limit[i];
  const auto none = T(0) > T(0);
  if (limit - near < Number<T>(3.14159265)) {
    const auto bent = both(sine > T(1e-6), cosine < T(std::cos(std::max(limit - near, Number<T>(0)))));
    if (any(bent)) {
      row.scalar = RowScalar::kSwing;
      set(across / sine);
      const auto swing_at_start = [&] {
        const Vec3<T> bone = start() * a;
        return T(atan2(T(a.cross(bone).norm()), T(a.dot(bone))));
      };
      add_limits<T>(settings, T(atan2(sine, cosine)), 0, none, limit, bent, swing_at_start, row, p);
    }
  }
  const T toward = T(1) + a.dot(b);
  if (const auto open = toward > T(0.05); any(open)) {
    const T twist = twist_angle<T>(relative, a);
    row.scalar = RowScalar::kTwist;
    set((a + b) / toward);
    const Number<T> lower = p.law.twist_lower[i], upper = p.law.twist_upper[i];
    const auto low = lower > -kUnlimited ? both(open, twist < T(lower + near)) : none;
    const auto high = upper < kUnlimited ? both(open, twist > T(upper - near)) : none;
    const auto twist_at_start = [&] { return twist_angle<T>(start(), a); };
    add_limits<T>(settings, twist, lower, low, upper, high, twist_at_start, row, p);
  }
}

/// Second derivative of the swing angle and the twist of a ball joint by a small rotation of the child, child
/// axes, weighted by the rows' slopes. With w in rest axes: swing'' = [cos·(|w|² − (n·w)²) − (a·w)(b·w)]/sin,
/// twist'' = (w·(a + b))(w·(a × b))/(1 + a·b)².
template <class T, class Problem>
Mat3<T> cone_curvature(const Problem& p, int i, T swing_slope, T twist_slope) {
  const Quat<T> relative = p.tree->rest[i].rotation.conjugate().template cast<T>() * p.local[i].rotation;
  const Vec3<T> a = p.law.swing_axis[i].template cast<T>();
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

/// See measure_joint_rows.
template <class T, class Problem>
void measure_rows(const StepSettings<Number<T>>& settings, Problem& p) {
  const Tree<Number<T>>& tree = *p.tree;
  const T zero = T(0);
  const auto always = zero <= zero;
  p.clear_rows();
  for (int i = 0; i < tree.bodies; ++i) {
    const int first = tree.first_dof[i], count = tree.dof_count(i);
    if (count == 0 || !p.free[first]) continue;
    const int rotational = tree.type[i] == JointType::kBall ? 0 : (tree.type[i] == JointType::kFree ? 3 : -1);
    bool muscles = false, passive = false;
    bool boxed = tree.type[i] != JointType::kFree && p.law.swing_limit[i] < 0, bounded = false;
    for (int dof = first; dof < first + count; ++dof) {
      muscles = muscles || any(p.law.torque_minus[dof] > zero) || any(p.law.torque_plus[dof] > zero);
      passive = passive || p.law.dry_friction[dof] > 0 || p.law.damping[dof] > 0;
      bounded = bounded || p.law.lower[dof] > -kUnlimited || p.law.upper[dof] < kUnlimited;
    }
    boxed = boxed && bounded;
    const bool coned = p.law.swing_limit[i] >= 0;
    if (!muscles && !passive && !boxed && !coned) continue;
    const auto offset = [&](bool needed, const Transform<T>& reference) {
      return needed ? offset_of<T>(tree, i, reference, p.local[i]) : JointOffset<T>{};
    };
    const JointOffset<T> from_target = offset(muscles, p.target[i]);
    const JointOffset<T> from_start = offset(passive, p.start[i]);
    const JointOffset<T> from_rest = offset(boxed, tree.rest[i].template cast<T>());
    const bool ellipsoid = muscles && p.law.ellipsoidal[i];
    if constexpr (std::is_arithmetic_v<T>)
      if (ellipsoid) add_ellipsoid(settings, i, from_target, p);
    for (int k = 0; k < count; ++k) {
      const int dof = first + k;
      JointRow<T> row;
      row.component = k - std::max(rotational, 0);
      const auto pulls = either(p.law.torque_minus[dof] > zero, p.law.torque_plus[dof] > zero);
      if (!ellipsoid && any(pulls)) {
        set_gradient(from_target, rotational, k, first, row);
        row.value = from_target.value[k];
        row.minus = p.law.torque_minus[dof];
        row.plus = p.law.torque_plus[dof];
        row.width = settings.kink_width;
        row.muscle = true;
        p.add_row(row, pulls);
        row.muscle = false;
      }
      row.scalar = RowScalar::kFromStart;
      if (p.law.dry_friction[dof] > 0) {
        set_gradient(from_start, rotational, k, first, row);
        row.value = from_start.value[k];
        row.minus = row.plus = p.law.dry_friction[dof];
        row.width = 10 * settings.kink_width;
        p.add_row(row, always);
      }
      if (p.law.damping[dof] > 0) {
        set_gradient(from_start, rotational, k, first, row);
        row.kind = RowKind::kSpring;
        row.value = from_start.value[k];
        row.stiffness = p.law.damping[dof] / settings.h;
        p.add_row(row, always);
      }
      const bool has_lower = p.law.lower[dof] > -kUnlimited, has_upper = p.law.upper[dof] < kUnlimited;
      if (boxed && (has_lower || has_upper)) {
        row.scalar = RowScalar::kFromRest;
        set_gradient(from_rest, rotational, k, first, row);
        const auto at_start = [&] {
          return offset_value_of<T>(tree, i, tree.rest[i].template cast<T>(), p.start[i])[k];
        };
        add_limits<T>(settings, from_rest.value[k], p.law.lower[dof], has_lower ? always : !always,
                      p.law.upper[dof], has_upper ? always : !always, at_start, row, p);
      }
    }
    if (coned) add_cone<T>(settings, i, p);
  }
}

/// See measure_joint_curvature.
template <class T, class Problem>
void measure_curvature(Problem& p) {
  const Tree<Number<T>>& tree = *p.tree;
  std::size_t r = 0, e = 0;
  for (int i = 0; i < tree.bodies; ++i) {
    Mat3<T>& curvature = p.joint_curvature[i];
    curvature.setZero();
    const bool ball = tree.type[i] == JointType::kBall;
    const int rotational = ball ? tree.first_dof[i] : tree.first_dof[i] + 3;
    Vec3<T> offset[3] = {Vec3<T>::Zero(), Vec3<T>::Zero(), Vec3<T>::Zero()};  // from target, start, rest
    T swing = T(0), twist = T(0);
    for (; r < p.rows.size() && p.rows[r].dof < tree.first_dof[i + 1]; ++r) {
      const JointRow<T>& row = p.rows[r];
      if (row.count != 3 || row.dof != rotational) continue;
      const T slope = row.sign * row.slope(row.value);
      if (row.scalar == RowScalar::kSwing)
        swing += slope;
      else if (row.scalar == RowScalar::kTwist)
        twist += slope;
      else
        offset[static_cast<int>(row.scalar)][row.component] += slope;
    }
    if constexpr (std::is_arithmetic_v<T>)
      if (e < p.ellipsoids.size() && p.ellipsoids[e].dof == rotational && ball) {
        offset[0] += p.ellipsoids[e].slope(p.ellipsoids[e].value);
        ++e;
      }
    const Mat3<T> nothing = Mat3<T>::Zero();
    const Transform<T> rest = tree.rest[i].template cast<T>();
    const Transform<T>* reference[3] = {&p.target[i], &p.start[i], &rest};
    bool curved = false;
    for (int f = 0; f < 3; ++f) {
      const auto bears = offset[f].squaredNorm() > T(0);
      if (!any(bears)) continue;
      const Mat3<T> bent = log_curvature<T>(
          rotation_log<T>(reference[f]->rotation.conjugate() * p.local[i].rotation), offset[f]);
      curvature += select(bears, bent, nothing);
      curved = true;
    }
    if (const auto bears = either(swing != T(0), twist != T(0)); any(bears)) {
      curvature += select(bears, cone_curvature<T>(p, i, swing, twist), nothing);
      curved = true;
    }
    if (!ball && curved) {
      // A free joint's chart turns on the left, exp(d)·R = R·exp(Rᵀd).
      const Mat3<T> turn = p.local[i].rotation.toRotationMatrix();
      curvature = (turn * curvature * turn.transpose()).eval();
    }
  }
}

}  // namespace sinew
