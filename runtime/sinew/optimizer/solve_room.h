// How much memory a solve may need: the rooms of trees that are solved together add up.
#pragma once

#include <algorithm>

#include "sinew/residual/tree.h"
#include "sinew/residual/tree_factor.h"

namespace sinew {

struct SolveRoom {
  int trees = 0, dofs = 0, bodies = 0;
  int path_entries = 0;     ///< of a tree matrix with every degree of freedom unknown, padding included
  int contacts = 0;         ///< candidates; when there are more, those found last are dropped
  int contact_entries = 0;  ///< of contact rows; a side that finds no room stands still in the inner problem
  int loaded = 0;           ///< contacts that bear something
  int colliders = 0;
  int effect_rows = 0;  ///< of joints, that effects bring

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
            f(a.effect_rows, b.effect_rows)};
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
  SolveRoom room{1, tree.dofs, tree.bodies, 0, contacts, 0, loaded, colliders, 0};
  int longest = 0;
  for (int dof = 0; dof < tree.dofs; ++dof) {
    int path = 1;
    for (int above = tree.dof_parent[dof]; above >= 0; above = tree.dof_parent[above]) ++path;
    room.path_entries += TreePattern::padded(path);
    longest = std::max(longest, TreePattern::padded(path));
  }
  // Most contacts are with something static and near the ends of limbs: one whole path each.
  room.contact_entries = contacts * longest;
  return room;
}

/// What all trees of a world bring to solves.
struct SolveRooms {
  SolveRoom all, largest;  ///< sum and maximum
  SolveRoom share;         ///< most that a tree needs per degree of freedom

  void add(const SolveRoom& tree) {
    all += tree;
    share = larger(share, tree.per(std::max(tree.dofs, 1)));
    largest = larger(largest, tree);
  }
  /// Of so many degrees of freedom at most, perhaps of those that need most of everything else.
  SolveRoom of_island(int dofs) const {
    SolveRoom most = share.times(dofs);
    most += largest;
    return smaller(all, most);
  }
};

}  // namespace sinew
