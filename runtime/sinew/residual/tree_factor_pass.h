// What TreeMatrix does, on any scalar: float, double or a pack of matrices of one pattern (pack.h).
//
// `values`: the entries as the pattern lays them out. Rows of packs need no padding.
#pragma once

#include <span>
#include <type_traits>

#include "sinew/residual/tree_factor.h"
#include "sinew/skeleton/scalar.h"

namespace sinew {

/// y = H·x.
template <class T>
void multiply_by_tree(const TreePattern& p, const T* values, std::span<const T> x, std::span<T> y) {
  for (int k = 0; k < p.size; ++k) y[k] = T(0);
  for (int k = 0; k < p.size; ++k) {
    const T* row = values + p.row[k];
    T sum = row[p.depth[k]] * x[k];
    for (int l = p.parent[k]; l >= 0; l = p.parent[l]) {
      sum += row[p.depth[l]] * x[l];
      y[l] += row[p.depth[l]] * x[k];
    }
    y[k] += sum;
  }
}

/// target −= factor·path over the blocks that hold entries 0 … last.
template <class T>
inline void subtract_path(T* __restrict target, const T* __restrict path, T factor, int last) {
  constexpr int kBlock = std::is_arithmetic_v<T> ? TreePattern::kBlock : 1;
  for (int block = 0; block <= last; block += kBlock)
    for (int i = block; i < block + kBlock; ++i) target[i] -= factor * path[i];
}

/// Replaces H by its factor, whose diagonal is stored as its inverse; `diagonal` [unknown] is room. Set where
/// H is positive definite: see TreeMatrix::factorise.
template <class T>
auto factorise_tree(const TreePattern& p, T* values, std::span<T> diagonal) {
  using std::sqrt;
  constexpr auto kRounding = Number<T>(sizeof(Number<T>) == 4 ? 1e-5 : 1e-12);  // of the diagonal
  for (int k = 0; k < p.size; ++k) diagonal[k] = values[p.row[k] + p.depth[k]];
  auto definite = T(1) > T(0);
  for (int k = p.size - 1; k >= 0; --k) {
    T* path = values + p.row[k];
    const int depth = p.depth[k];
    const T least = kRounding * diagonal[k];
    const T pivot = largest(path[depth], least);
    definite = both(definite, both(path[depth] > -least, pivot > T(0)));  // not so where they are NaN
    if (!any(definite)) return definite;
    const T inverse = T(1) / sqrt(pivot);
    path[depth] = inverse;
    for (int i = 0; i < depth; ++i) path[i] *= inverse;
    int position = depth - 1;
    for (int l = p.parent[k]; l >= 0; l = p.parent[l], --position)
      subtract_path(values + p.row[l], path, path[position], position);
  }
  return definite;
}

/// Solves Lᵀ·y = b in place, with the factor that factorise_tree left. Up to the root with three unknowns at
/// a time where each is the next one's parent (a ball joint's), in the order of one after the other: the way
/// is gone once for them.
template <class T>
void solve_up_tree(const TreePattern& p, const T* values, std::span<T> b) {
  for (int k = p.size - 1; k >= 0;) {
    const T* last = values + p.row[k];
    int position = p.depth[k];
    const T y2 = b[k] *= last[position];
    if (k < 2 || p.parent[k] != k - 1 || p.parent[k - 1] != k - 2) {
      --position;
      for (int l = p.parent[k]; l >= 0; l = p.parent[l], --position) b[l] -= last[position] * y2;
      --k;
      continue;
    }
    const T *first = values + p.row[k - 2], *second = values + p.row[k - 1];
    --position;
    const T y1 = b[k - 1] = (b[k - 1] - last[position] * y2) * second[position];
    --position;
    const T y0 = b[k - 2] = (b[k - 2] - last[position] * y2 - second[position] * y1) * first[position];
    --position;
    for (int l = p.parent[k - 2]; l >= 0; l = p.parent[l], --position)
      b[l] = b[l] - last[position] * y2 - second[position] * y1 - first[position] * y0;
    k -= 3;
  }
}

/// Solves L·x = y in place.
template <class T>
void solve_down_tree(const TreePattern& p, const T* values, std::span<T> y) {
  for (int k = 0; k < p.size; ++k) {
    const T* path = values + p.row[k];
    T sum = y[k];
    int position = p.depth[k] - 1;
    for (int l = p.parent[k]; l >= 0; l = p.parent[l], --position) sum -= path[position] * y[l];
    y[k] = sum * path[p.depth[k]];
  }
}

/// Solves LᵀL·x = b in place.
template <class T>
void solve_by_tree(const TreePattern& p, const T* values, std::span<T> b) {
  solve_up_tree<T>(p, values, b);
  solve_down_tree<T>(p, values, b);
}

}  // namespace sinew
