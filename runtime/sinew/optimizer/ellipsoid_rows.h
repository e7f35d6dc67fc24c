// Ellipsoidal muscle limits in the convex model of an outer pass, as contact_rows.h for contacts.
#pragma once

#include <span>
#include <vector>

#include "sinew/optimizer/problem.h"

namespace sinew {

template <class T>
class EllipsoidRows {
 public:
  void reserve(int joints) { rows_.reserve(joints); }
  /// That reserve() takes.
  static std::size_t bytes(int joints) { return joints * sizeof(Row); }

  /// Takes the rows of the trees as they were measured. Unknowns are those of all trees together.
  void collect(std::span<TreeProblem<T>* const> trees, const Unknowns& unknowns);
  bool empty() const { return rows_.empty(); }
  void add_gradient(std::span<T> gradient) const;
  /// Derivative along the step of look_along(), t of it away.
  T slope(T t) const;
  void look_along(std::span<const T> step);
  void move(T t);
  void add_curvature(const Unknowns& unknowns, TreeMatrix<T>& matrix) const;
  void multiply(std::span<const T> x, std::span<T> y) const;
  /// Back to the values that were collected.
  void rewind();
  /// Values as the trees hold them now. False where the rows are others than those collected.
  bool measure(std::span<TreeProblem<T>* const> trees);

 private:
  struct Row {
    EllipsoidRow<T> row;
    int unknown = 0;  ///< of the joint's first degree of freedom
    Vec3<T> value = Vec3<T>::Zero(), d_value = Vec3<T>::Zero();
  };
  std::vector<Row> rows_;
};

extern template class EllipsoidRows<float>;
extern template class EllipsoidRows<double>;

}  // namespace sinew
