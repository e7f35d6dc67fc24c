// One joint within a step, as the effects see it that are energies of a joint's own freedom: muscle.h,
// joint_damping.h, joint_limit.h. Each looks at the joint once and appends a row per degree of freedom that
// it acts on; together they go from one degree of freedom to the next.
#pragma once

#include <algorithm>
#include <vector>

#include "sinew/muscle/ellipsoid_row.h"
#include "sinew/muscle/joint_coordinates.h"
#include "sinew/muscle/joint_law.h"
#include "sinew/muscle/joint_rows.h"

namespace sinew {

template <class T>
struct JointStep {
  const Tree<T>& tree;
  const JointLaw<T>& law;
  int body = 0;
  const Transform<T>&local, &target, &start;  ///< now, where muscles pull, when the step began
  T h = T(0);                                 ///< s
  T kink_width = T(0);                        ///< rad: muscles and dry friction are rounded over it
  T limit_stiffness = T(0);                   ///< N·m/rad
  T limit_damping = T(0);                     ///< s

  int first_dof() const { return tree.first_dof[body]; }
  int dofs() const { return tree.dof_count(body); }
  /// The first of a ball's or free joint's three rotations, within the joint; −1: it has none such.
  int rotational() const {
    return tree.type[body] == JointType::kBall ? 0 : (tree.type[body] == JointType::kFree ? 3 : -1);
  }
  /// Whether `is` holds for any of its degrees of freedom.
  template <class Predicate>
  bool any(Predicate is) const {
    for (int dof = tree.first_dof[body]; dof < tree.first_dof[body + 1]; ++dof)
      if (is(dof)) return true;
    return false;
  }
  /// A row of the kth offset, with its value and gradient.
  JointRow<T> row(const JointOffset<T>& offset, RowScalar scalar, int k) const {
    const int rotations = rotational();
    JointRow<T> row;
    row.scalar = scalar;
    row.component = k - std::max(rotations, 0);
    row.value = offset.value[k];
    if (rotations >= 0 && k >= rotations) {
      row.dof = first_dof() + rotations;
      row.count = 3;
      for (int a = 0; a < 3; ++a) row.gradient[a] = offset.rotational(k - rotations, a);
    } else {
      row.dof = first_dof() + k;
      row.gradient[0] = T(1);
    }
    return row;
  }
};

}  // namespace sinew
