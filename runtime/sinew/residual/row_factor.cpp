#include "sinew/residual/row_factor.h"

#include <algorithm>
#include <cmath>

#include "sinew/skeleton/hooks.h"

namespace sinew {
namespace {

constexpr int kMostDense = 40;  ///< groups that may all share paths with each other
/// Of S's diagonal, how many times stiffer a row may be than what it ties: each digit is one less of T's.
template <class T>
constexpr T kStiffest = sizeof(T) == 4 ? T(1e5) : T(1e12);

}  // namespace

template <class T>
int RowFactor<T>::most_products(int groups) {
  const int rows = kRows * std::min(groups, kMostDense);
  return rows * (rows + 1) / 2;
}

template <class T>
std::size_t RowFactor<T>::bytes(int groups, int entries) {
  return groups * (sizeof(Group) + kRows * (sizeof(T) + 2 * sizeof(int))) + entries * sizeof(Quad) +
         most_products(groups) * sizeof(T);
}

template <class T>
void RowFactor<T>::reserve(int groups, int entries) {
  groups_.reserve(groups);
  half_.reserve(entries);
  products_.reserve(most_products(groups));
  for (std::vector<int>* v : {&first_, &row_}) v->reserve(kRows * groups);
  pull_.reserve(kRows * groups);
}

template <class T>
void RowFactor<T>::clear() {
  groups_.clear();
  half_.clear();
  most_groups_ = groups_.capacity();
  most_entries_ = half_.capacity();
}

template <class T>
typename RowFactor<T>::Room RowFactor<T>::add(const TreePattern& pattern, int rows, int leaf_a, int leaf_b) {
  const int size_a = leaf_a < 0 ? 0 : pattern.depth[leaf_a] + 1;
  const int size_b = leaf_b < 0 ? 0 : pattern.depth[leaf_b] + 1;
  const std::size_t begin = half_.size(), end = begin + size_a + size_b;
  if (groups_.size() >= most_groups_ || end > most_entries_) return {};
  SINEW_ASSERT(groups_.size() < groups_.capacity() && end <= half_.capacity());
  const int first_row = groups_.empty() ? 0 : groups_.back().first_row + groups_.back().rows;
  groups_.push_back({rows, first_row, {leaf_a, leaf_b}, {int(begin), int(begin) + size_a}});
  half_.resize(end, Quad{});
  return {{half_.data() + begin, half_.data() + begin + size_a}};
}

/// Makes a group's B its Y.
template <class T>
void RowFactor<T>::go_up(const TreeMatrix<T>& tree, const Group& group) {
  const TreePattern& pattern = tree.pattern();
  for (int s = 0; s < 2; ++s) {
    Quad* path = half_.data() + group.half[s];
    for (int k = group.leaf[s]; k >= 0; k = pattern.parent[k]) {
      const int depth = pattern.depth[k];
      const T* row = tree.row(k);
      Quad& own = path[depth];
      for (T& v : own) v *= row[depth];
      for (int above = 0; above < depth; ++above)
        for (int i = 0; i < kRows; ++i) path[above][i] -= row[above] * own[i];
    }
  }
}

/// Block of YᵀY; false where the groups share no path.
template <class T>
bool RowFactor<T>::add_products(const TreePattern& pattern, const Group& a, const Group& b,
                                Quad (&sum)[kRows]) const {
  bool any = false;
  for (int s = 0; s < 2; ++s)
    for (int r = 0; r < 2; ++r) {
      const int shared = pattern.common(a.leaf[s], b.leaf[r]);
      if (shared < 0) continue;
      any = true;
      const Quad *x = half_.data() + a.half[s], *y = half_.data() + b.half[r];
      for (int d = 0; d <= pattern.depth[shared]; ++d)
        for (int i = 0; i < kRows; ++i)
          for (int j = 0; j < kRows; ++j) sum[i][j] += x[d][i] * y[d][j];
    }
  return any;
}

/// A group's rows of S, from the first group on with which it shares a path.
template <class T>
bool RowFactor<T>::append_rows(const TreePattern& pattern, const Group& group) {
  const int begin = static_cast<int>(products_.size());
  const int most = most_products(static_cast<int>(groups_.size()));
  const auto begin_at = [&](int first) {
    const int size = group.first_row - first;
    const auto at = [&](int i) { return begin + i * size + i * (i + 1) / 2; };
    if (at(group.rows) > most) return false;
    for (int i = 0; i < group.rows; ++i) {
      first_.push_back(first);
      row_.push_back(at(i) - first);
    }
    products_.resize(at(group.rows));
    return true;
  };
  bool begun = false;
  for (const Group* b = groups_.data(); b <= &group; ++b) {
    const bool own = b == &group;
    Quad block[kRows] = {};
    if (!add_products(pattern, group, *b, block) && !begun && !own) continue;
    if (!begun && !begin_at(b->first_row)) return false;
    begun = true;
    for (int i = 0; i < group.rows; ++i)
      std::copy_n(block[i].begin(), own ? i + 1 : b->rows,
                  products_.begin() + row_[group.first_row + i] + b->first_row);
  }
  for (int i = group.first_row; i < group.first_row + group.rows; ++i) {
    T& diagonal = products_[row_[i] + i];
    if (!(diagonal < kStiffest<T>)) return false;
    diagonal += T(1);
  }
  return true;
}

/// S by its factor, on the diagonal the inverse.
template <class T>
bool RowFactor<T>::factorise_products() {
  const int rows = static_cast<int>(row_.size());
  for (int i = 0; i < rows; ++i) {
    T* row = products_.data() + row_[i];
    for (int j = first_[i]; j <= i; ++j) {
      const T* other = products_.data() + row_[j];
      T sum = row[j];
      for (int k = std::max(first_[i], first_[j]); k < j; ++k) sum -= row[k] * other[k];
      if (j == i && !(sum > T(0))) return false;
      row[j] = j < i ? sum * other[j] : T(1) / std::sqrt(sum);
    }
  }
  return true;
}

template <class T>
bool RowFactor<T>::factorise(const TreeMatrix<T>& tree) {
  SINEW_ZONE("factorise rows");
  products_.clear();
  first_.clear();
  row_.clear();
  for (const Group& group : groups_) go_up(tree, group);
  return std::all_of(groups_.begin(), groups_.end(),
                     [&](const Group& group) { return append_rows(tree.pattern(), group); }) &&
         factorise_products();
}

template <class T>
void RowFactor<T>::solve(const TreeMatrix<T>& tree, std::span<T> b) {
  const TreePattern& pattern = tree.pattern();
  tree.solve_up(b);
  const int rows = static_cast<int>(row_.size());
  pull_.resize(rows);
  for (const Group& group : groups_) {
    Quad sum = {};
    for (int s = 0; s < 2; ++s)
      for (int k = group.leaf[s]; k >= 0; k = pattern.parent[k]) {
        const Quad& y = half_[group.half[s] + pattern.depth[k]];
        for (int i = 0; i < kRows; ++i) sum[i] += b[k] * y[i];
      }
    std::copy_n(sum.begin(), group.rows, pull_.begin() + group.first_row);
  }
  for (int i = 0; i < rows; ++i) {
    const T* row = products_.data() + row_[i];
    T sum = pull_[i];
    for (int j = first_[i]; j < i; ++j) sum -= row[j] * pull_[j];
    pull_[i] = sum * row[i];
  }
  for (int i = rows - 1; i >= 0; --i) {
    const T* row = products_.data() + row_[i];
    pull_[i] *= row[i];
    for (int j = first_[i]; j < i; ++j) pull_[j] -= row[j] * pull_[i];
  }
  for (const Group& group : groups_) {
    Quad pull = {};
    std::copy_n(pull_.begin() + group.first_row, group.rows, pull.begin());
    for (int s = 0; s < 2; ++s)
      for (int k = group.leaf[s]; k >= 0; k = pattern.parent[k]) {
        const Quad& y = half_[group.half[s] + pattern.depth[k]];
        T sum = T(0);
        for (int i = 0; i < kRows; ++i) sum += pull[i] * y[i];
        b[k] -= sum;
      }
  }
  tree.solve_down(b);
}

template class RowFactor<float>;
template class RowFactor<double>;

}  // namespace sinew
