// Springs between the bodies of a tree and the world: second derivatives that a composite inertia cannot
// hold, because they differ from direction to direction.
#pragma once

#include <span>

#include "sinew/residual/composite.h"
#include "sinew/skeleton/rotation.h"

namespace sinew {

/// Quadratic form ½ (v, w)ᵀ K (v, w) of one body's small motion about the common origin. Adds up along the
/// tree.
template <class T>
struct SpatialStiffness {
  Mat3<T> linear = Mat3<T>::Zero();   ///< N/m
  Mat3<T> mixed = Mat3<T>::Zero();    ///< force by rotation, N/rad
  Mat3<T> angular = Mat3<T>::Zero();  ///< N·m/rad

  SpatialStiffness& operator+=(const SpatialStiffness& other) {
    linear += other.linear;
    mixed += other.mixed;
    angular += other.angular;
    return *this;
  }
  /// A symmetric stiffness k at the material point x, which moves by v + w × x.
  void add_point(const Vec3<T>& x, const Mat3<T>& k) {
    const Mat3<T> arm = skew(x);
    const Mat3<T> turned = k * arm;
    linear += k;
    mixed -= turned;
    angular -= arm * turned;
  }
};

/// Composite-body recursion of such forms, added to `out`; arguments as assemble_tree_matrix. `path` is room
/// for one padded row. O(unknowns · depth).
template <class T>
void add_stiffness(const Tree<T>& tree, const Kinematics<T>& kinematics, const PathAxes<T>& axes,
                   std::span<SpatialStiffness<T>> bodies, const Unknowns& unknowns, int first,
                   std::span<T> path, TreeMatrix<T>& out);

#define SINEW_STIFFNESS_INSTANCES(prefix, T)                                                       \
  prefix void add_stiffness<T>(const Tree<T>&, const Kinematics<T>&, const PathAxes<T>&,           \
                               std::span<SpatialStiffness<T>>, const Unknowns&, int, std::span<T>, \
                               TreeMatrix<T>&);
SINEW_STIFFNESS_INSTANCES(extern template, float)
SINEW_STIFFNESS_INSTANCES(extern template, double)

}  // namespace sinew
