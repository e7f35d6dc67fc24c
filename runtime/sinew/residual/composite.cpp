#include "sinew/residual/composite.h"

#include "sinew/residual/composite_pass.h"

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
  out.of_dof.resize(first + tree.dofs, -1);
  int* const of_dof = out.of_dof.data() + first;
  for (int d = 0; d < tree.dofs; ++d) {
    if (!free[d]) continue;
    int above = tree.dof_parent[d];
    while (above >= 0 && of_dof[above] < 0) above = tree.dof_parent[above];
    of_dof[d] = out.pattern.add(above < 0 ? -1 : of_dof[above]);
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

template <class T>
void assemble_tree_matrix(const Tree<T>& tree, const Kinematics<T>& kin, const PathAxes<T>& axes,
                          std::span<Composite<T>> bodies, const Unknowns& unknowns, int first, bool geometric,
                          TreeMatrix<T>& out) {
  assemble_rows<T>(tree, kin, axes, bodies, unknowns, first, geometric, out);
}

template <class T>
void add_floor(const Tree<T>& tree, const Kinematics<T>& kin, std::span<const Composite<T>> bodies,
               const Unknowns& unknowns, int first, TreeMatrix<T>& out) {
  add_floor_to_rows<T>(tree, kin, bodies, unknowns, first, out);
}

SINEW_COMPOSITE_INSTANCES(template, float)
SINEW_COMPOSITE_INSTANCES(template, double)

}  // namespace sinew
