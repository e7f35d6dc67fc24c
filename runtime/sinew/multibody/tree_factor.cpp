#include "sinew/multibody/tree_factor.h"

#include <algorithm>
#include <cmath>
#include <set>

namespace sinew::multibody {
namespace {

/// Relative to the row that it stands in: below, elimination without pivoting has lost the digits that Newton
/// needs.
constexpr double kLost = 1e-10;

}  // namespace

TreeFactor::TreeFactor(const Model& model) {
  const int n = model.size();
  std::vector<std::set<int>> coupled(n);
  const auto couple = [&](int i, int k) {
    if (i != k) coupled[std::max(i, k)].insert(std::min(i, k));
  };
  for (int i = 0; i < n; ++i)
    for (int k = model.tree.parent[i]; k >= 0; k = model.tree.parent[k]) couple(i, k);
  for (const ForceModel& f : model.forces)
    for (const int a : f.path.of_a)
      for (const int b : f.path.of_b) couple(a, b);
  // Eliminating a joint couples all that it is coupled with.
  for (int i = n - 1; i >= 0; --i) {
    above_.emplace_back(coupled[i].begin(), coupled[i].end());
    if (coupled[i].empty()) continue;
    const int next = *coupled[i].rbegin();
    for (const int k : above_.back())
      if (k != next) couple(next, k);
  }
  std::reverse(above_.begin(), above_.end());
}

long TreeFactor::entries() const {
  long count = 0;
  for (const std::vector<int>& row : above_) count += 2 * static_cast<long>(row.size()) + 1;
  return count;
}

bool TreeFactor::factorise(const Matrix& a) {
  factor_ = a;
  for (int i = static_cast<int>(above_.size()) - 1; i >= 0; --i) {
    const std::vector<int>& above = above_[i];
    const double pivot = factor_(i, i);
    double largest = 0;
    for (const int k : above) largest = std::max({largest, std::abs(factor_(i, k)), std::abs(factor_(k, i))});
    if (!(std::abs(pivot) > kLost * largest) || !std::isfinite(pivot)) return false;
    // Row i is scaled by the pivot; what is above loses its share: A_kl −= A_ki·A_il/A_ii.
    for (const int l : above) {
      const double share = factor_(i, l) /= pivot;
      for (const int k : above) factor_(k, l) -= factor_(k, i) * share;
    }
  }
  return true;
}

void TreeFactor::solve(Eigen::Ref<Vector> x) const {
  const int n = static_cast<int>(above_.size());
  for (int i = n - 1; i >= 0; --i) {
    x[i] /= factor_(i, i);
    for (const int k : above_[i]) x[k] -= factor_(k, i) * x[i];
  }
  for (int i = 0; i < n; ++i)
    for (const int k : above_[i]) x[i] -= factor_(i, k) * x[k];
}

}  // namespace sinew::multibody
