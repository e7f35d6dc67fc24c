// Symmetric matrices with the sparsity of a tree, and their factorisation without fill-in.
//
// Entry (k, l) is non-zero only where l lies on the path from k to the root, so row k holds the path:
// contiguous, root first, k last. H = LᵀL, solved leaves → root and back (Featherstone, "Rigid Body Dynamics
// Algorithms", 2008, section 6.5). O(n·depth²). Storing whole paths contiguously makes the inner loop a plain
// vector update: 2.9 times faster than the pointer-chasing form (solver-prototype, addendum A). Rows are
// padded to whole blocks, so that the update needs no tail; what lies in the padding is never read into an
// entry.
#pragma once

#include <span>
#include <vector>

namespace sinew {

/// Which unknowns there are and how they hang together; shared by all matrices of one solve.
struct TreePattern {
  static constexpr int kBlock = 4;  ///< values per block

  /// Room that a path of so many entries takes: whole blocks, and one more for those who begin inside a
  /// block.
  static constexpr int padded(int entries) { return (entries + kBlock - 1) / kBlock * kBlock + kBlock; }

  std::vector<int> parent;  ///< [unknown] next unknown towards the root, or -1
  std::vector<int> depth;   ///< [unknown] position in its own path = number of unknowns above it
  std::vector<int> row;     ///< [unknown] first entry of its path in the value array
  int size = 0;
  int entries = 0;  ///< of the value array, padding included

  /// Set-up for at most `capacity` unknowns: later rebuilds allocate nothing.
  void reserve(int capacity);
  void clear();
  /// Appends an unknown below `above` (-1: a root). Returns its index.
  int add(int above);
  /// The last unknown that lies on both paths, or -1 (also where one of them is -1).
  int common(int a, int b) const;
};

/// Value array of a symmetric tree matrix: entry (k, position on the path of k).
template <class T>
class TreeMatrix {
 public:
  explicit TreeMatrix(const TreePattern& pattern) : pattern_(&pattern) {}
  /// Set-up for patterns of at most so many unknowns and entries.
  void reserve(int unknowns, int entries) {
    values_.reserve(entries);
    diagonal_.reserve(unknowns);
  }
  void set_zero() { values_.assign(pattern_->entries, T(0)); }
  T* row(int k) { return values_.data() + pattern_->row[k]; }
  const T* row(int k) const { return values_.data() + pattern_->row[k]; }
  std::vector<T>& values() { return values_; }
  const std::vector<T>& values() const { return values_; }

  /// y = H·x.
  void multiply(std::span<const T> x, std::span<T> y) const;
  /// Replaces H by its factor L, on the diagonal the inverse of L's. False (and a half-finished factor) when
  /// H is not positive definite. A pivot that elimination has left nothing of but rounding (a massless link's
  /// spin between two ball joints moves nothing) becomes a small share of the diagonal that it was.
  bool factorise();
  /// Solves LᵀL·x = b in place; call after factorise().
  void solve(std::span<T> b) const;
  /// Its two halves, one after the other: Lᵀ·y = b, leaves → root, and L·x = y.
  void solve_up(std::span<T> b) const;
  void solve_down(std::span<T> y) const;
  const TreePattern& pattern() const { return *pattern_; }

 private:
  const TreePattern* pattern_;
  std::vector<T> values_;
  std::vector<T> diagonal_;  ///< [unknown] before elimination
};

extern template class TreeMatrix<float>;
extern template class TreeMatrix<double>;

}  // namespace sinew
