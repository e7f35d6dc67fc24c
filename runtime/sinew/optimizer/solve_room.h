// How much memory a solve may need: the rooms of trees that are solved together add up.
#pragma once

#include <algorithm>

#include "sinew/residual/composite.h"

namespace sinew {

struct SolveRoom {
  int trees = 0, dofs = 0, bodies = 0;
  int path_entries = 0;     ///< of a tree matrix with every degree of freedom unknown, padding included
  int contacts = 0;         ///< candidates; when there are more, those found last are dropped
  int contact_entries = 0;  ///< of contact rows; a side that finds no room stands still in the inner problem
  int loaded = 0;           ///< contacts that bear something
  int colliders = 0;
  int effect_rows = 0;                          ///< of joints, that effects bring
  int nodes = 0, stencils = 0, tetrahedra = 0;  ///< of couplings
  int node_entries = 0;                         ///< of the paths of all nodes

  /// Member by member.
  template <class Function>
  static SolveRoom combined(const SolveRoom& a, const SolveRoom& b, Function f) {
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
            f(a.node_entries, b.node_entries)};
  }
  SolveRoom& operator+=(const SolveRoom& other) {
    return *this = combined(*this, other, [](int a, int b) { return a + b; });
  }
  SolveRoom times(int count) const {
    return combined(*this, {}, [&](int a, int) { return a * count; });
  }
  /// A part of it, rounded up.
  SolveRoom per(int parts) const {
    return combined(*this, {}, [&](int a, int) { return (a + parts - 1) / parts; });
  }
  bool fits(const SolveRoom& into) const;
  bool operator==(const SolveRoom&) const = default;
};

inline SolveRoom smaller(const SolveRoom& a, const SolveRoom& b) {
  return SolveRoom::combined(a, b, [](int x, int y) { return std::min(x, y); });
}
inline SolveRoom larger(const SolveRoom& a, const SolveRoom& b) {
  return SolveRoom::combined(a, b, [](int x, int y) { return std::max(x, y); });
}
inline bool SolveRoom::fits(const SolveRoom& into) const {
  return larger(*this, into) == into;
}

/// Of one tree with so many contacts, of which so many bear something, and so many colliders.
template <class T>
SolveRoom room_of(const Tree<T>& tree, int contacts, int loaded, int colliders) {
  SolveRoom room;
  room.trees = 1;
  room.dofs = tree.dofs;
  room.bodies = tree.bodies;
  room.path_entries = matrix_entries(tree);
  room.contacts = contacts;
  room.loaded = loaded;
  room.colliders = colliders;
  int longest = 0;
  for (int i = 0; i < tree.bodies; ++i) longest = std::max(longest, path_entries(tree, i));
  // Most contacts are with something static and near the ends of limbs: one whole path each.
  room.contact_entries = contacts * longest;
  return room;
}

/// What all trees of a world, and what ties them together, bring to solves.
struct SolveRooms {
  SolveRoom all, largest;  ///< sum and maximum
  SolveRoom share;         ///< most that a tree, or several tied together, need per degree of freedom

  void add(const SolveRoom& tree) {
    all += tree;
    include(tree);
  }
  /// What can be solved as one: a tree, or trees that have been added and couplings whose room has been.
  void include(const SolveRoom& part) {
    share = larger(share, part.per(std::max(part.dofs, 1)));
    largest = larger(largest, part);
  }
  /// Of so many degrees of freedom at most, perhaps of those that need most of everything else.
  SolveRoom of_island(int dofs) const {
    SolveRoom most = share.times(dofs);
    most += largest;
    return smaller(all, most);
  }
};

}  // namespace sinew
