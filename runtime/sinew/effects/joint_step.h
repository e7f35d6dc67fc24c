// One joint within a step, as the effects see it that are energies of a joint's own freedom: muscle.h,
// joint_damping.h, joint_limit.h. Each looks at the joint once and appends a row per degree of freedom that
// it acts on; together they go from one degree of freedom to the next. Rows go to a JointRowList or to what
// has its add_row(row, present).
#pragma once

#include <algorithm>
#include <type_traits>
#include <vector>

#include "sinew/muscle/ellipsoid_row.h"
#include "sinew/muscle/joint_coordinates_pass.h"
#include "sinew/muscle/joint_law.h"
#include "sinew/muscle/joint_rows.h"
#include "sinew/residual/tree_pass.h"

namespace sinew {

/// T may be a pack of characters of one rig (pack.h), with a law that has a JointLaw's members.
template <class T, class Law = JointLaw<T>>
struct JointStep {
  const Tree<Number<T>>& tree;
  const Law& law;
  int body = 0;
  const Transform<T>&local, &target, &start;  ///< now, where muscles pull, when the step began
  Number<T> h = 0;                            ///< s
  Number<T> kink_width = 0;       ///< rad: muscles and dry friction are rounded over it; see kink()
  Number<T> limit_stiffness = 0;  ///< N·m/rad, of this tree
  Number<T> limit_damping = 0;    ///< s
  T emphasis = T(1);              ///< of muscles, friction and damping: see StepSettings

  int first_dof() const { return tree.first_dof[body]; }
  int dofs() const { return tree.dof_count(body); }
  /// The first of a ball's or free joint's three rotations, within the joint; −1: it has none such.
  int rotational() const {
    return tree.type[body] == JointType::kBall ? 0 : (tree.type[body] == JointType::kFree ? 3 : -1);
  }
  /// Whether `is` holds for any of its degrees of freedom.
  template <class Predicate>
  bool any_dof(Predicate is) const {
    for (int dof = tree.first_dof[body]; dof < tree.first_dof[body + 1]; ++dof)
      if (any(is(dof))) return true;
    return false;
  }
  /// m by rad: 1 where the kth degree of freedom turns, the tree's unit of length where it slides.
  Number<T> unit(int k) const { return slides(tree, first_dof() + k) ? tree.scale.length : Number<T>(1); }
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

/// Rows of a tree's joints at the present pose, in the order of the bodies.
template <class T>
struct JointRowList {
  std::vector<JointRow<T>> rows;
  std::vector<EllipsoidRow<T>> ellipsoids;

  void clear_rows() {
    rows.clear();
    ellipsoids.clear();
  }
  void add_row(const JointRow<T>& row, bool present) {
    if (present) rows.push_back(row);
  }
};

/// What one of these effects does in a step: functions that its own object file holds.
template <class T, class Law = JointLaw<T>, class Rows = JointRowList<T>>
struct JointTerm {
  using Step = JointStep<T, Law>;
  /// Whether it has rows to append; then with the joint's offset from where it measures.
  bool (*look)(const Step& joint, JointOffset<T>& offset, Rows& rows);
  /// Those of the kth degree of freedom.
  void (*append)(const Step& joint, const JointOffset<T>& offset, int k, Rows& rows);
};

/// The same of a ball joint's swing cone and twist range, whose rows are the joint's last.
template <class T, class Law = JointLaw<T>, class Rows = JointRowList<T>>
struct ConeTerm {
  void (*append)(const JointStep<T, Law>& joint, Rows& rows);
  /// See cone_curvature.
  Mat3<T> (*curvature)(const Quat<T>& relative, const Vec3<T>& bone, const T& swing_slope,
                       const T& twist_slope);
};

/// What acts on joints; null: not declared.
template <class T, class Law = JointLaw<T>, class Rows = JointRowList<T>>
struct JointTerms {
  const JointTerm<T, Law, Rows>*muscles = nullptr, *damping = nullptr, *limits = nullptr;
  const ConeTerm<T, Law, Rows>* cones = nullptr;
};

}  // namespace sinew
