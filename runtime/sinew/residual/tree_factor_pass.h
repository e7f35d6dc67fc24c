// What TreeMatrix does, on any scalar: float, double or a pack of matrices of one pattern (pack.h).
//
// `values`: the entries as the pattern lays them out. Rows of packs need no padding.
#pragma once

#include <algorithm>
#include <span>
#include <type_traits>

#include "sinew/residual/tree_factor.h"
#include "sinew/skeleton/scalar.h"

namespace sinew {

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

/// For the runs of unknowns on the path of `last` (-1: none), from it to the root, but for the first `least`:
/// does(first unknown, its position on the path, how many there are).
template <class Does>
inline void for_runs(const TreePattern& p, int last, int least, const Does& does) {
  int position = last < 0 ? least : p.depth[last] + 1;
  while (position > least) {
    const int count = std::min(last - p.run[last] + 1, position - least), first = last - count + 1;
    position -= count;
    does(first, position, count);
    last = p.parent[first];
  }
}

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

/// Solves LᵀL·x = b in place, with the factor that factorise_tree left. Three unknowns of a run at a time (a
/// ball joint's): the way to the root is gone once for them, 2.2 times as fast as for each.
template <class T>
void solve_by_tree(const TreePattern& p, const T* values, std::span<T> b) {
  for (int k = p.size - 1; k >= 0;) {  // Lᵀ y = b
    const T* last = values + p.row[k];
    int position = p.depth[k];
    if (k - p.run[k] < 2) {
      const T y = b[k] *= last[position--];
      for (int l = p.parent[k]; l >= 0; l = p.parent[l], --position) b[l] -= last[position] * y;
      --k;
      continue;
    }
    const T *first = values + p.row[k - 2], *second = values + p.row[k - 1];
    const T y2 = b[k] *= last[position];
    const T y1 = b[k - 1] = (b[k - 1] - last[position - 1] * y2) * second[position - 1];
    position -= 2;
    const T y0 = b[k - 2] = (b[k - 2] - last[position] * y2 - second[position] * y1) * first[position];
    --position;
    for (int l = p.parent[k - 2]; l >= 0; l = p.parent[l], --position)
      b[l] -= first[position] * y0 + second[position] * y1 + last[position] * y2;
    k -= 3;
  }
  for (int k = 0; k < p.size;) {  // L x = y
    const T* first = values + p.row[k];
    const int depth = p.depth[k];
    int position = depth - 1;
    if (k + 2 >= p.size || p.run[k + 2] != p.run[k]) {
      T sum = b[k];
      for (int l = p.parent[k]; l >= 0; l = p.parent[l], --position) sum -= first[position] * b[l];
      b[k++] = sum * first[depth];
      continue;
    }
    const T *second = values + p.row[k + 1], *last = values + p.row[k + 2];
    T x0 = b[k], x1 = b[k + 1], x2 = b[k + 2];
    for (int l = p.parent[k]; l >= 0; l = p.parent[l], --position) {
      x0 -= first[position] * b[l];
      x1 -= second[position] * b[l];
      x2 -= last[position] * b[l];
    }
    b[k] = x0 *= first[depth];
    b[k + 1] = x1 = (x1 - second[depth] * x0) * second[depth + 1];
    b[k + 2] = (x2 - last[depth] * x0 - last[depth + 1] * x1) * last[depth + 2];
    k += 3;
  }
}

}  // namespace sinew
