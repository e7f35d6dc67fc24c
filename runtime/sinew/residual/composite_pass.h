// The composite-body recursion of composite.h, on any scalar: float, double or a pack of characters of one
// rig with the same unknowns (pack.h).
//
// `kin` is a Kinematics<T> or what has its members, `axes` projects wrenches on paths as PathAxes<T> does,
// `out` has a row() per unknown as TreeMatrix<T>.
#pragma once

#include "sinew/residual/composite.h"
#include "sinew/residual/tree_pass.h"

namespace sinew {

/// Of the inertia about the common origin.
constexpr double kInertiaFloor = 5e-7;

/// Second derivative of the pose: l acts on what k moves.
template <class T>
Vec3<T> geometric_column(const Composite<T>& c, const Vec3<T>& w, const Vec3<T>& v) {
  return c.virial * w + v.cross(c.force) + T(0.5) * w.cross(c.couple);
}

/// See assemble_tree_matrix.
template <class T, class K, class Axes, class Matrix>
void assemble_rows(const Tree<Number<T>>& tree, const K& kin, const Axes& axes,
                   std::span<Composite<T>> bodies, const Unknowns& unknowns, int first, bool geometric,
                   Matrix& out) {
  const TreePattern& pattern = unknowns.pattern;
  for (int i = tree.bodies - 1; i >= 0; --i) {
    const Composite<T>& c = bodies[i];
    const bool one_rotation_vector = tree.type[i] == JointType::kBall || tree.type[i] == JointType::kFree;
    for (int d = tree.first_dof[i]; d < tree.first_dof[i + 1]; ++d) {
      const int k = unknowns.of_dof[first + d];
      if (k < 0) continue;
      const Vec3<T> force = c.mass * kin.v[d] + kin.w[d].cross(c.first);
      const Vec3<T> moment = c.rotational * kin.w[d] + c.first.cross(kin.v[d]);
      const Vec3<T> turned = geometric ? geometric_column(c, kin.w[d], kin.v[d]) : Vec3<T>(Vec3<T>::Zero());
      const int depth = pattern.depth[k];
      T* path = out.row(k);
      axes.project(k, force, moment + turned, depth, path);
      if (!geometric || !one_rotation_vector) continue;
      // One rotation vector: neither axis acts first.
      int position = depth;
      for (int l = k; l >= 0 && tree.dof_body[unknowns.dof[l]] == i; l = pattern.parent[l], --position) {
        const int e = unknowns.dof[l];
        if (slides(tree, d) || slides(tree, e)) continue;
        path[position] +=
            T(0.5) * (kin.w[d].dot(geometric_column(c, kin.w[e], kin.v[e])) - kin.w[e].dot(turned));
      }
    }
    if (const int p = tree.parent[i]; p >= 0) bodies[p] += bodies[i];
  }
}

/// See add_floor.
template <class T, class K, class Matrix>
void add_floor_to_rows(const Tree<Number<T>>& tree, const K& kin, std::span<const Composite<T>> bodies,
                       const Unknowns& unknowns, int first, Matrix& out) {
  for (int d = 0; d < tree.dofs; ++d) {
    const int k = unknowns.of_dof[first + d];
    if (k < 0) continue;
    const Composite<T>& c = bodies[tree.dof_body[d]];
    out.row(k)[unknowns.pattern.depth[k]] +=
        T(kInertiaFloor) * (c.mass * kin.v[d].squaredNorm() + c.rotational.trace() * kin.w[d].squaredNorm());
  }
}

}  // namespace sinew
