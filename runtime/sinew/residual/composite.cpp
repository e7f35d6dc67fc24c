#include "sinew/residual/composite.h"

namespace sinew {

void Unknowns::reserve(int dofs) {
  pattern.reserve(dofs);
  of_dof.reserve(dofs);
  dof.reserve(dofs);
}

void Unknowns::clear() {
  pattern.clear();
  of_dof.clear();
  dof.clear();
}

template <class T>
int append_unknowns(const Tree<T>& tree, std::span<const std::uint8_t> free, Unknowns& out) {
  const int first = static_cast<int>(out.of_dof.size());
  for (int d = 0; d < tree.dofs; ++d) {
    out.of_dof.push_back(-1);
    if (!free[d]) continue;
    int above = tree.dof_parent[d];
    while (above >= 0 && out.of_dof[first + above] < 0) above = tree.dof_parent[above];
    out.of_dof.back() = out.pattern.add(above < 0 ? -1 : out.of_dof[first + above]);
    out.dof.push_back(d);
  }
  return first;
}

template <class T>
int path_entries(const Tree<T>& tree, int body) {
  int dofs = 0;
  for (int i = body; i >= 0; i = tree.parent[i]) dofs += tree.dof_count(i);
  return TreePattern::padded(dofs);
}

template <class T>
int matrix_entries(const Tree<T>& tree) {
  int entries = 0;
  for (int i = 0; i < tree.bodies; ++i) entries += tree.dof_count(i) * path_entries(tree, i);
  return entries;
}

template <class T>
int unknown_above(const Tree<T>& tree, int body, const Unknowns& unknowns, int first) {
  int dof = -1;
  for (int i = body; i >= 0 && dof < 0; i = tree.parent[i])
    if (tree.dof_count(i) > 0) dof = tree.first_dof[i + 1] - 1;
  while (dof >= 0 && unknowns.of_dof[first + dof] < 0) dof = tree.dof_parent[dof];
  return dof < 0 ? -1 : unknowns.of_dof[first + dof];
}

namespace {

/// Of the inertia about the common origin.
constexpr double kFloor = 5e-7;

/// Second derivative of the pose: l acts on what k moves.
template <class T>
Vec3<T> geometric_column(const Composite<T>& c, const Vec3<T>& w, const Vec3<T>& v) {
  return c.virial * w + v.cross(c.force) + T(0.5) * w.cross(c.couple);
}

}  // namespace

template <class T>
void assemble_tree_matrix(const Tree<T>& tree, const Kinematics<T>& kin, const PathAxes<T>& axes,
                          std::span<Composite<T>> bodies, const Unknowns& unknowns, int first, bool geometric,
                          TreeMatrix<T>& out) {
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
        if (kin.w[d].isZero(T(0)) || kin.w[e].isZero(T(0))) continue;
        path[position] +=
            T(0.5) * (kin.w[d].dot(geometric_column(c, kin.w[e], kin.v[e])) - kin.w[e].dot(turned));
      }
    }
    if (const int p = tree.parent[i]; p >= 0) bodies[p] += bodies[i];
  }
}

template <class T>
void add_floor(const Tree<T>& tree, const Kinematics<T>& kin, std::span<const Composite<T>> bodies,
               const Unknowns& unknowns, int first, TreeMatrix<T>& out) {
  for (int d = 0; d < tree.dofs; ++d) {
    const int k = unknowns.of_dof[first + d];
    if (k < 0) continue;
    const Composite<T>& c = bodies[tree.dof_body[d]];
    out.row(k)[unknowns.pattern.depth[k]] +=
        T(kFloor) * (c.mass * kin.v[d].squaredNorm() + c.rotational.trace() * kin.w[d].squaredNorm());
  }
}

SINEW_COMPOSITE_INSTANCES(template, float)
SINEW_COMPOSITE_INSTANCES(template, double)

}  // namespace sinew
