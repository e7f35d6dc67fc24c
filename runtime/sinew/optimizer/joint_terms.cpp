#include "sinew/optimizer/joint_terms.h"

#include <algorithm>

namespace sinew {
namespace {

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

/// Rows of a scalar between two bounds; none for a bound that is not there. `at_start` tells the scalar when
/// the step began, and is asked only where the bound is near.
template <class T, class AtStart>
void append_limit(const StepSettings<T>& settings, T scalar, T lower, T upper, AtStart at_start,
                  JointRow<T> row, std::vector<JointRow<T>>& rows) {
  constexpr T near = T(0.05);  // rad or m
  row.kind = RowKind::kOneSided;
  row.stiffness = settings.limit_stiffness;
  const auto append = [&](T sign, T bound) {
    row.value = sign * (scalar - bound);
    row.damp(settings.limit_damping, settings.h, row.value > -near ? sign * (at_start() - bound) : T(0));
    rows.push_back(row);
  };
  if (upper < T(kUnlimited)) append(T(1), upper);
  if (lower <= T(-kUnlimited)) return;
  row.sign = -row.sign;
  for (T& g : row.gradient) g = -g;
  append(T(-1), lower);
}

template <class T>
void append_ellipsoid(const StepSettings<T>& settings, int i, const JointOffset<T>& from_target,
                      TreeProblem<T>& p) {
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
template <class T>
void append_cone(const StepSettings<T>& settings, const TreeProblem<T>& p, int i,
                 std::vector<JointRow<T>>& rows) {
  const Tree<T>& tree = *p.tree;
  const Quat<T> relative = tree.rest[i].rotation.conjugate() * p.local[i].rotation;
  const Vec3<T>& a = p.law.swing_axis[i];
  const Vec3<T> b = relative * a;
  const Vec3<T> across = a.cross(b);
  const T sine = across.norm(), cosine = a.dot(b);
  const auto start = [&] { return Quat<T>(tree.rest[i].rotation.conjugate() * p.start[i].rotation); };
  JointRow<T> row;
  row.dof = tree.first_dof[i];
  row.count = 3;
  const auto set = [&](const Vec3<T>& in_rest) {
    const Vec3<T> in_child = relative.conjugate() * in_rest;
    row.gradient = {in_child.x(), in_child.y(), in_child.z()};
  };
  // Rows well inside the range cannot become active within a step; leave them out.
  constexpr T near = T(0.5);
  const T limit = p.law.swing_limit[i];
  if (sine > T(1e-6) && limit - near < T(3.14159265) && cosine < std::cos(std::max(limit - near, T(0)))) {
    row.scalar = RowScalar::kSwing;
    set(across / sine);
    const auto swing_at_start = [&] {
      const Vec3<T> bone = start() * a;
      return std::atan2(a.cross(bone).norm(), a.dot(bone));
    };
    append_limit<T>(settings, std::atan2(sine, cosine), T(-kUnlimited), limit, swing_at_start, row, rows);
  }
  if (const T toward = T(1) + a.dot(b); toward > T(0.05)) {
    const T twist = twist_angle<T>(relative, a);
    row.scalar = RowScalar::kTwist;
    set((a + b) / toward);
    const T lower = p.law.twist_lower[i], upper = p.law.twist_upper[i];
    append_limit<T>(
        settings, twist, twist < lower + near ? lower : T(-kUnlimited),
        twist > upper - near ? upper : T(kUnlimited), [&] { return twist_angle<T>(start(), a); }, row, rows);
  }
}

/// Second derivative of the swing angle and the twist of a ball joint by a small rotation of the child, child
/// axes, weighted by the rows' slopes. With w in rest axes: swing'' = [cos·(|w|² − (n·w)²) − (a·w)(b·w)]/sin,
/// twist'' = (w·(a + b))(w·(a × b))/(1 + a·b)².
template <class T>
Mat3<T> cone_curvature(const TreeProblem<T>& p, int i, T swing_slope, T twist_slope) {
  const Quat<T> relative = p.tree->rest[i].rotation.conjugate() * p.local[i].rotation;
  const Vec3<T>& a = p.law.swing_axis[i];
  const Vec3<T> b = relative * a;
  const Vec3<T> across = a.cross(b);
  const T sine = std::max(across.norm(), T(1e-6)), cosine = a.dot(b);
  const Vec3<T> n = across / sine;
  const T toward = std::max(T(1) + cosine, T(0.05));
  const Mat3<T> swing = (cosine * (Mat3<T>::Identity() - n * n.transpose()) -
                         T(0.5) * (a * b.transpose() + b * a.transpose())) /
                        sine;
  const Vec3<T> sum = a + b;
  const Mat3<T> twist = T(0.5) * (sum * across.transpose() + across * sum.transpose()) / (toward * toward);
  const Mat3<T> turn = relative.toRotationMatrix();
  return turn.transpose() * (swing_slope * swing + twist_slope * twist) * turn;
}

}  // namespace

template <class T>
void measure_joint_rows(const StepSettings<T>& settings, TreeProblem<T>& p) {
  const Tree<T>& tree = *p.tree;
  p.rows.clear();
  p.ellipsoids.clear();
  for (int i = 0; i < tree.bodies; ++i) {
    const int first = tree.first_dof[i], count = tree.dof_count(i);
    if (count == 0 || !p.free[first]) continue;
    const int rotational = tree.type[i] == JointType::kBall ? 0 : (tree.type[i] == JointType::kFree ? 3 : -1);
    bool muscles = false, passive = false;
    bool boxed = tree.type[i] != JointType::kFree && p.law.swing_limit[i] < T(0), bounded = false;
    for (int dof = first; dof < first + count; ++dof) {
      muscles = muscles || p.law.torque_minus[dof] > T(0) || p.law.torque_plus[dof] > T(0);
      passive = passive || p.law.dry_friction[dof] > T(0) || p.law.damping[dof] > T(0);
      bounded = bounded || p.law.lower[dof] > T(-kUnlimited) || p.law.upper[dof] < T(kUnlimited);
    }
    boxed = boxed && bounded;
    const bool coned = p.law.swing_limit[i] >= T(0);
    if (!muscles && !passive && !boxed && !coned) continue;
    const auto offset = [&](bool needed, const Transform<T>& reference) {
      return needed ? joint_offset<T>(tree, i, reference, p.local[i]) : JointOffset<T>{};
    };
    const JointOffset<T> from_target = offset(muscles, p.target[i]);
    const JointOffset<T> from_start = offset(passive, p.start[i]);
    const JointOffset<T> from_rest = offset(boxed, tree.rest[i]);
    const bool ellipsoid = muscles && p.law.ellipsoidal[i];
    if (ellipsoid) append_ellipsoid(settings, i, from_target, p);
    for (int k = 0; k < count; ++k) {
      const int dof = first + k;
      JointRow<T> row;
      row.component = k - std::max(rotational, 0);
      if (!ellipsoid && (p.law.torque_minus[dof] > T(0) || p.law.torque_plus[dof] > T(0))) {
        set_gradient(from_target, rotational, k, first, row);
        row.value = from_target.value[k];
        row.minus = p.law.torque_minus[dof];
        row.plus = p.law.torque_plus[dof];
        row.width = settings.kink_width;
        row.muscle = true;
        p.rows.push_back(row);
        row.muscle = false;
      }
      row.scalar = RowScalar::kFromStart;
      if (p.law.dry_friction[dof] > T(0)) {
        set_gradient(from_start, rotational, k, first, row);
        row.value = from_start.value[k];
        row.minus = row.plus = p.law.dry_friction[dof];
        row.width = 10 * settings.kink_width;
        p.rows.push_back(row);
      }
      if (p.law.damping[dof] > T(0)) {
        set_gradient(from_start, rotational, k, first, row);
        row.kind = RowKind::kSpring;
        row.value = from_start.value[k];
        row.stiffness = p.law.damping[dof] / settings.h;
        p.rows.push_back(row);
      }
      if (boxed && (p.law.lower[dof] > T(-kUnlimited) || p.law.upper[dof] < T(kUnlimited))) {
        row.scalar = RowScalar::kFromRest;
        set_gradient(from_rest, rotational, k, first, row);
        append_limit<T>(
            settings, from_rest.value[k], p.law.lower[dof], p.law.upper[dof],
            [&] { return joint_offset_value<T>(tree, i, tree.rest[i], p.start[i])[k]; }, row, p.rows);
      }
    }
    if (coned) append_cone(settings, p, i, p.rows);
  }
}

template <class T>
void measure_joint_curvature(TreeProblem<T>& p) {
  const Tree<T>& tree = *p.tree;
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
    if (e < p.ellipsoids.size() && p.ellipsoids[e].dof == rotational && ball) {
      offset[0] += p.ellipsoids[e].slope(p.ellipsoids[e].value);
      ++e;
    }
    const Transform<T>* reference[3] = {&p.target[i], &p.start[i], &tree.rest[i]};
    for (int f = 0; f < 3; ++f)
      if (offset[f].squaredNorm() > T(0))
        curvature += log_curvature<T>(
            rotation_log<T>(reference[f]->rotation.conjugate() * p.local[i].rotation), offset[f]);
    if (swing != T(0) || twist != T(0)) curvature += cone_curvature(p, i, swing, twist);
    if (!ball && !curvature.isZero(T(0))) {
      // A free joint's chart turns on the left, exp(d)·R = R·exp(Rᵀd).
      const Mat3<T> turn = p.local[i].rotation.toRotationMatrix();
      curvature = (turn * curvature * turn.transpose()).eval();
    }
  }
}

SINEW_JOINT_TERMS_INSTANCES(template, float)
SINEW_JOINT_TERMS_INSTANCES(template, double)

}  // namespace sinew
