#include "sinew/residual/spatial_stiffness.h"

namespace sinew {

template <class T>
void add_stiffness(const Tree<T>& tree, const Kinematics<T>& kin, const PathAxes<T>& axes,
                   std::span<SpatialStiffness<T>> bodies, const Unknowns& unknowns, int first,
                   std::span<T> path, TreeMatrix<T>& out) {
  for (int i = tree.bodies - 1; i >= 0; --i) {
    const SpatialStiffness<T>& s = bodies[i];
    for (int d = tree.first_dof[i]; d < tree.first_dof[i + 1]; ++d) {
      const int k = unknowns.of_dof[first + d];
      if (k < 0) continue;
      const Vec3<T> force = s.linear * kin.v[d] + s.mixed * kin.w[d];
      const Vec3<T> moment = s.mixed.transpose() * kin.v[d] + s.angular * kin.w[d];
      const int depth = unknowns.pattern.depth[k];
      axes.project(k, force, moment, depth, path.data());
      for (int j = 0; j <= depth; ++j) out.row(k)[j] += path[j];
    }
    if (const int p = tree.parent[i]; p >= 0) bodies[p] += bodies[i];
  }
}

SINEW_STIFFNESS_INSTANCES(template, float)
SINEW_STIFFNESS_INSTANCES(template, double)

}  // namespace sinew
