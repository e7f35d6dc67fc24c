#include "sinew/optimizer/joint_terms.h"

#include <optional>

#include "sinew/effects/joint_damping.h"
#include "sinew/effects/joint_limit.h"
#include "sinew/effects/muscle.h"

namespace sinew {

template <class T>
void measure_joint_rows(const StepSettings<T>& settings, TreeProblem<T>& p) {
  const Tree<T>& tree = *p.tree;
  p.rows.clear();
  p.ellipsoids.clear();
  for (int i = 0; i < tree.bodies; ++i) {
    if (tree.dof_count(i) == 0 || !p.free[tree.first_dof[i]]) continue;
    const JointStep<T> joint{tree,
                             p.law,
                             i,
                             p.local[i],
                             p.target[i],
                             p.start[i],
                             settings.h,
                             settings.kink_width,
                             settings.limit_stiffness,
                             settings.limit_damping};
    std::optional<MuscleRows<T>> muscles;
    std::optional<JointDampingRows<T>> damping;
    std::optional<JointLimitRows<T>> limits;
    if (MuscleRows<T>::act(joint)) muscles.emplace(joint);
    if (JointDampingRows<T>::act(joint)) damping.emplace(joint);
    if (JointLimitRows<T>::act(joint)) limits.emplace(joint);
    if (muscles && p.law.ellipsoidal[i]) {
      muscles->append(joint, p.ellipsoids);
      muscles.reset();
    }
    for (int k = 0; (muscles || damping || limits) && k < joint.dofs(); ++k) {
      if (muscles) muscles->append(joint, k, p.rows);
      if (damping) damping->append(joint, k, p.rows);
      if (limits) limits->append(joint, k, p.rows);
    }
    if (p.law.swing_limit[i] >= T(0)) append_cone(joint, p.rows);
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
    if (swing != T(0) || twist != T(0))
      curvature += cone_curvature<T>(tree.rest[i].rotation.conjugate() * p.local[i].rotation,
                                     p.law.swing_axis[i], swing, twist);
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
