// Ellipsoidal muscle limits in the convex model of an outer pass, as contact_rows.h for contacts.
#pragma once

#include <memory>
#include <span>

#include "sinew/optimizer/problem.h"

namespace sinew {

/// As the inner problem calls it: null there where no muscles are declared.
template <class T>
class EllipsoidModel {
 public:
  virtual ~EllipsoidModel() = default;
  /// Set-up for so many joints; nothing allocates afterwards.
  virtual void reserve(int joints) = 0;
  /// That reserve() takes.
  virtual std::size_t bytes(int joints) const = 0;

  /// Takes the rows of the trees as they were measured. Unknowns are those of all trees together.
  virtual void collect(std::span<TreeProblem<T>* const> trees, const Unknowns& unknowns) = 0;
  virtual void add_gradient(std::span<T> gradient) const = 0;
  /// Derivative along the step of look_along(), t of it away.
  virtual T slope(T t) const = 0;
  virtual void look_along(std::span<const T> step) = 0;
  virtual void move(T t) = 0;
  virtual void add_curvature(const Unknowns& unknowns, TreeMatrix<T>& matrix) const = 0;
  virtual void multiply(std::span<const T> x, std::span<T> y) const = 0;
  /// Back to the values that were collected.
  virtual void rewind() = 0;
  /// Values as the trees hold them now. False where the rows are others than those collected.
  virtual bool measure(std::span<TreeProblem<T>* const> trees) = 0;
};

template <class T>
std::unique_ptr<EllipsoidModel<T>> make_ellipsoid_rows();

extern template std::unique_ptr<EllipsoidModel<float>> make_ellipsoid_rows<float>();
extern template std::unique_ptr<EllipsoidModel<double>> make_ellipsoid_rows<double>();

}  // namespace sinew
