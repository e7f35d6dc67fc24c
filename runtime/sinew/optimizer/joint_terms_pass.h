// The rows of joint_terms.h on any scalar: float, double or a pack of characters of one rig (pack.h).
//
// `p` is a TreeProblem<T> or what has its members. Rows of a pack are in the same order for all its lanes;
// add_row(row, present) leaves one out where it is not present.
#pragma once

#include <type_traits>

#include "sinew/effects/joint_step.h"
#include "sinew/optimizer/bossak.h"
#include "sinew/optimizer/problem.h"

namespace sinew {

/// See StepSettings::constant_muscles.
template <class T, class Settings>
T emphasis(const Settings& settings, const T& weight) {
  return settings.constant_muscles ? constant_emphasis<T>(weight, settings.h) : T(1);
}

/// Joint i of a tree as the effects see it.
template <class T, class Problem>
auto joint_step(const StepSettings<Number<T>>& settings, const Problem& p, int i) {
  return JointStep<T, std::remove_cvref_t<decltype(p.law)>>{*p.tree,
                                                            p.law,
                                                            i,
                                                            p.local[i],
                                                            p.target[i],
                                                            p.start[i],
                                                            settings.h,
                                                            p.kink_width,
                                                            settings.limit_stiffness * p.tree->scale.load,
                                                            settings.limit_damping * p.tree->scale.time,
                                                            emphasis<T>(settings, p.prediction.weight)};
}

/// See measure_joint_rows. `terms`: JointTerms of the problem's law and rows.
template <class T, class Terms, class Problem>
void measure_rows(const StepSettings<Number<T>>& settings, const Terms& terms, Problem& p) {
  const Tree<Number<T>>& tree = *p.tree;
  constexpr int kTerms = 3;
  const JointLawPresence there = p.law.present;
  using Term = decltype(terms.muscles);
  const Term in_order[kTerms] = {there.muscles ? terms.muscles : nullptr,
                                 there.losses ? terms.damping : nullptr,
                                 there.ranges ? terms.limits : nullptr};
  const auto cones = there.cones ? terms.cones : nullptr;
  JointOffset<T> offset[kTerms];
  p.clear_rows();
  if (!in_order[0] && !in_order[1] && !in_order[2] && !cones) return;
  for (int i = 0; i < tree.bodies; ++i) {
    if (tree.dof_count(i) == 0 || !p.free[tree.first_dof[i]]) continue;
    const auto joint = joint_step<T>(settings, p, i);
    bool acts[kTerms] = {}, any_acts = false;
    for (int n = 0; n < kTerms; ++n)
      if (in_order[n]) any_acts |= acts[n] = in_order[n]->look(joint, offset[n], p);
    for (int k = 0; any_acts && k < joint.dofs(); ++k)
      for (int n = 0; n < kTerms; ++n)
        if (acts[n]) in_order[n]->append(joint, offset[n], k, p);
    if (cones && p.law.swing_limit[i] >= 0) cones->append(joint, p);
  }
}

/// See measure_joint_curvature.
template <class T, class Terms, class Problem>
void measure_curvature(const Terms& terms, Problem& p) {
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
      curvature += select(bears,
                          terms.cones->curvature(rest.rotation.conjugate() * p.local[i].rotation,
                                                 p.law.swing_axis[i].template cast<T>(), swing, twist),
                          nothing);
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
