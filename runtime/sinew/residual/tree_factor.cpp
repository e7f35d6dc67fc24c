#include "sinew/residual/tree_factor.h"

#include <algorithm>
#include <cmath>

namespace sinew {

void TreePattern::reserve(int capacity) {
  parent.reserve(capacity);
  depth.reserve(capacity);
  row.reserve(capacity);
}

void TreePattern::clear() {
  parent.clear();
  depth.clear();
  row.clear();
  size = entries = 0;
}

int TreePattern::add(int above) {
  parent.push_back(above);
  depth.push_back(above < 0 ? 0 : depth[above] + 1);
  row.push_back(entries);
  entries += padded(depth.back() + 1);
  return size++;
}

int TreePattern::common(int a, int b) const {
  while (a != b) {
    if (a < 0 || b < 0) return -1;
    int& deeper = depth[a] >= depth[b] ? a : b;
    deeper = parent[deeper];
  }
  return a;
}

template <class T>
void TreeMatrix<T>::multiply(std::span<const T> x, std::span<T> y) const {
  const TreePattern& p = *pattern_;
  for (int k = 0; k < p.size; ++k) y[k] = T(0);
  for (int k = 0; k < p.size; ++k) {
    const T* values = row(k);
    T sum = values[p.depth[k]] * x[k];
    for (int l = p.parent[k]; l >= 0; l = p.parent[l]) {
      sum += values[p.depth[l]] * x[l];
      y[l] += values[p.depth[l]] * x[k];
    }
    y[k] += sum;
  }
}

namespace {

/// target −= factor·path over the blocks that hold entries 0 … last.
template <class T>
inline void subtract(T* __restrict target, const T* __restrict path, T factor, int last) {
  for (int block = 0; block <= last; block += TreePattern::kBlock)
    for (int i = block; i < block + TreePattern::kBlock; ++i) target[i] -= factor * path[i];
}

}  // namespace

template <class T>
bool TreeMatrix<T>::factorise() {
  constexpr T kRounding = sizeof(T) == 4 ? T(1e-5) : T(1e-12);  // of the diagonal
  const TreePattern& p = *pattern_;
  diagonal_.resize(p.size);
  for (int k = 0; k < p.size; ++k) diagonal_[k] = row(k)[p.depth[k]];
  for (int k = p.size - 1; k >= 0; --k) {
    T* path = row(k);
    const int depth = p.depth[k];
    const T smallest = kRounding * diagonal_[k];
    if (!(path[depth] > -smallest)) return false;  // also catches NaN
    const T pivot = std::max(path[depth], smallest);
    if (!(pivot > T(0))) return false;
    const T root = std::sqrt(pivot);
    const T inverse = T(1) / root;
    path[depth] = root;
    for (int i = 0; i < depth; ++i) path[i] *= inverse;
    int position = depth - 1;
    for (int l = p.parent[k]; l >= 0; l = p.parent[l], --position)
      subtract(row(l), path, path[position], position);
  }
  return true;
}

template <class T>
void TreeMatrix<T>::solve(std::span<T> b) const {
  const TreePattern& p = *pattern_;
  for (int k = p.size - 1; k >= 0; --k) {  // Lᵀ y = b
    const T* path = row(k);
    b[k] /= path[p.depth[k]];
    int position = p.depth[k] - 1;
    for (int l = p.parent[k]; l >= 0; l = p.parent[l], --position) b[l] -= path[position] * b[k];
  }
  for (int k = 0; k < p.size; ++k) {  // L x = y
    const T* path = row(k);
    T sum = b[k];
    int position = p.depth[k] - 1;
    for (int l = p.parent[k]; l >= 0; l = p.parent[l], --position) sum -= path[position] * b[l];
    b[k] = sum / path[p.depth[k]];
  }
}

template class TreeMatrix<float>;
template class TreeMatrix<double>;

}  // namespace sinew
