#include "sinew/residual/tree_factor.h"

#include "sinew/residual/tree_factor_pass.h"

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
  multiply_by_tree<T>(*pattern_, values_.data(), x, y);
}

template <class T>
bool TreeMatrix<T>::factorise() {
  diagonal_.resize(pattern_->size);
  return factorise_tree<T>(*pattern_, values_.data(), diagonal_);
}

template <class T>
void TreeMatrix<T>::solve(std::span<T> b) const {
  solve_by_tree<T>(*pattern_, values_.data(), b);
}

template <class T>
void TreeMatrix<T>::solve_up(std::span<T> b) const {
  solve_up_tree<T>(*pattern_, values_.data(), b);
}

template <class T>
void TreeMatrix<T>::solve_down(std::span<T> y) const {
  solve_down_tree<T>(*pattern_, values_.data(), y);
}

template class TreeMatrix<float>;
template class TreeMatrix<double>;

}  // namespace sinew
