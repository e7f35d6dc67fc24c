// How much memory a solve may need: the rooms of trees that are solved together add up.
#pragma once

#include <algorithm>

#include "sinew/residual/composite.h"

namespace sinew {

struct SolveCapacity {
  int trees = 0, dofs = 0, bodies = 0;
  int path_entries = 0;     ///< of a tree matrix with every degree of freedom unknown, padding included
  int contacts = 0;         ///< candidates; when there are more, those found last are dropped
  int contact_entries = 0;  ///< of contact rows; a side that finds no room stands still in the inner problem
  int loaded = 0;           ///< contacts that bear something
  int colliders = 0;
  int effect_rows = 0;                          ///< of joints, that effects bring
  int nodes = 0, stencils = 0, tetrahedra = 0;  ///< of couplings
  int node_entries = 0;                         ///< of the paths of all nodes
  int loops = 0, loop_entries = 0;              ///< stencils of loops, and of the paths of their nodes

  /// Member by member.
  template <class Function>
  static SolveCapacity combined(const SolveCapacity& a, const SolveCapacity& b, Function f) {
    return {f(a.trees, b.trees),
            f(a.dofs, b.dofs),
            f(a.bodies, b.bodies),
            f(a.path_entries, b.path_entries),
            f(a.contacts, b.contacts),
            f(a.contact_entries, b.contact_entries),
            f(a.loaded, b.loaded),
            f(a.colliders, b.colliders),
            f(a.effect_rows, b.effect_rows),
            f(a.nodes, b.nodes),
            f(a.stencils, b.stencils),
            f(a.tetrahedra, b.tetrahedra),
            f(a.node_entries, b.node_entries),
            f(a.loops, b.loops),
            f(a.loop_entries, b.loop_entries)};
  }
  SolveCapacity& operator+=(const SolveCapacity& other) {
    return *this = combined(*this, other, [](int a, int b) { return a + b; });
  }
  SolveCapacity times(int count) const {
    return combined(*this, {}, [&](int a, int) { return a * count; });
  }
  /// A part of it, rounded up.
  SolveCapacity per(int parts) const {
    return combined(*this, {}, [&](int a, int) { return (a + parts - 1) / parts; });
  }
  bool fits(const SolveCapacity& into) const;
  bool operator==(const SolveCapacity&) const = default;
};

inline SolveCapacity smaller(const SolveCapacity& a, const SolveCapacity& b) {
  return SolveCapacity::combined(a, b, [](int x, int y) { return std::min(x, y); });
}
inline SolveCapacity larger(const SolveCapacity& a, const SolveCapacity& b) {
  return SolveCapacity::combined(a, b, [](int x, int y) { return std::max(x, y); });
}
inline bool SolveCapacity::fits(const SolveCapacity& into) const {
  return larger(*this, into) == into;
}

/// Of one tree with so many contacts, of which so many bear something, and so many colliders.
template <class T>
SolveCapacity capacity_of(const Tree<T>& tree, int contacts, int loaded, int colliders) {
  SolveCapacity capacity;
  capacity.trees = 1;
  capacity.dofs = tree.dofs;
  capacity.bodies = tree.bodies;
  capacity.path_entries = matrix_entries(tree);
  capacity.contacts = contacts;
  capacity.loaded = loaded;
  capacity.colliders = colliders;
  int longest = 0;
  for (int i = 0; i < tree.bodies; ++i) longest = std::max(longest, path_entries(tree, i));
  // Most contacts are with something static and near the ends of limbs: one whole path each.
  capacity.contact_entries = contacts * longest;
  return capacity;
}

/// What all trees of a world, and what ties them together, bring to solves.
struct SolveCapacities {
  SolveCapacity all, largest;  ///< sum and maximum
  SolveCapacity share;         ///< most that a tree, or several tied together, need per degree of freedom

  void add(const SolveCapacity& tree) {
    all += tree;
    include(tree);
  }
  /// What can be solved as one: a tree, or trees that have been added and couplings whose room has been.
  void include(const SolveCapacity& part) {
    share = larger(share, part.per(std::max(part.dofs, 1)));
    largest = larger(largest, part);
  }
  /// Of so many degrees of freedom at most, perhaps of those that need most of everything else.
  SolveCapacity of_island(int dofs) const {
    SolveCapacity most = share.times(dofs);
    most += largest;
    return smaller(all, most);
  }
};

}  // namespace sinew
