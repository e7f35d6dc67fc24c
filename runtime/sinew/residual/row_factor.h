// What rows across two paths add to a tree matrix, solved exactly.
//
// A loop, or a contact between two limbs, stiffens what its two sides do together, which no entry of a tree
// matrix is. With H = LᵀL the tree matrix without it and B its rows, transposed, times a root of their
// stiffness,
//
//     (H + B Bᵀ)⁻¹ = L⁻¹ (I − Y S⁻¹ Yᵀ) L⁻ᵀ,    Y = L⁻ᵀB,    S = I + YᵀY
//
// (Woodbury 1950). L⁻ᵀ leads from the leaves to the root, so a column of Y stays on the two paths, and S has
// entries only where rows share one: it is stored and factorised from each row's first entry on. Internal to
// solves.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "sinew/residual/tree_factor.h"

namespace sinew {

template <class T>
class RowFactor {
 public:
  static constexpr int kRows = 4;  ///< of one group at most: three of a loop or a contact fill a vector
  using Quad = std::array<T, kRows>;

  /// Set-up for groups of rows, whose sides' paths have so many entries.
  void reserve(int groups, int entries);
  /// That reserve() takes.
  static std::size_t bytes(int groups, int entries);

  void clear();
  /// From now on so many groups and entries more at most, whatever there is memory for.
  void allow(int groups, int entries) {
    most_groups_ = groups_.size() + groups;
    most_entries_ = half_.size() + entries;
  }
  bool empty() const { return groups_.empty(); }
  /// Appends a group of rows, each of whose sides moves with the path to an unknown (−1: nothing moves it).
  /// What they are, times the root of their stiffness, is for the caller to write: [depth][row], zero so
  /// far. Null where it is one too many.
  struct Room {
    Quad* side[2];
    explicit operator bool() const { return side[0]; }
  };
  Room add(const TreePattern& pattern, int rows, int leaf_a, int leaf_b);

  /// For the factor of the tree matrix, once. False where rounding would spoil it, since a row has hardly any
  /// inertia to move, or where rows share so many paths that conjugate gradients cost less.
  bool factorise(const TreeMatrix<T>& tree);
  /// Solves in place with what `tree` and the rows make together.
  void solve(const TreeMatrix<T>& tree, std::span<T> b);

 private:
  struct Group {
    int rows = 0;
    int first_row = 0;
    int leaf[2];
    int half[2];  ///< first entry of each side's path
  };

  static int most_products(int groups);
  void go_up(const TreeMatrix<T>& tree, const Group& group);
  bool add_products(const TreePattern& pattern, const Group& a, const Group& b, Quad (&sum)[kRows]) const;
  bool append_rows(const TreePattern& pattern, const Group& group);
  bool factorise_products();

  std::size_t most_groups_ = 0, most_entries_ = 0;
  std::vector<Group> groups_;
  std::vector<Quad> half_;   ///< [entry] of B, then of Y
  std::vector<T> products_;  ///< S, then its factor: of each row the entries from its first to its own
  std::vector<int> first_;   ///< [row] of S, its first column
  std::vector<int> row_;     ///< [row] where its column 0 would be in products_
  std::vector<T> pull_;      ///< [row]
};

extern template class RowFactor<float>;
extern template class RowFactor<double>;

}  // namespace sinew
