#include "sinew/optimizer/ellipsoid_rows.h"

#include <vector>

namespace sinew {
namespace {

template <class T>
Vec3<T> three(std::span<const T> x, int first) {
  return {x[first], x[first + 1], x[first + 2]};
}

template <class T>
void add_three(const Vec3<T>& v, int first, std::span<T> x) {
  for (int a = 0; a < 3; ++a) x[first + a] += v[a];
}

template <class T>
class EllipsoidRows final : public EllipsoidModel<T> {
 public:
  void reserve(int joints) override { rows_.reserve(joints); }
  std::size_t bytes(int joints) const override { return joints * sizeof(Row); }
  void collect(std::span<TreeProblem<T>* const> trees, const Unknowns& unknowns) override;
  void add_gradient(std::span<T> gradient) const override;
  T slope(T t) const override;
  void look_along(std::span<const T> step) override;
  void move(T t) override;
  void add_curvature(const Unknowns& unknowns, TreeMatrix<T>& matrix) const override;
  void multiply(std::span<const T> x, std::span<T> y) const override;
  void rewind() override;
  bool measure(std::span<TreeProblem<T>* const> trees) override;

 private:
  struct Row {
    EllipsoidRow<T> row;
    int unknown = 0;  ///< of the joint's first degree of freedom
    Vec3<T> value = Vec3<T>::Zero(), d_value = Vec3<T>::Zero();
  };
  std::vector<Row> rows_;
};

template <class T>
void EllipsoidRows<T>::collect(std::span<TreeProblem<T>* const> trees, const Unknowns& unknowns) {
  rows_.clear();
  for (const TreeProblem<T>* p : trees)
    for (const EllipsoidRow<T>& row : p->ellipsoids)
      rows_.push_back(
          {row, unknowns.of_dof[p->first_unknown_map + row.dof], row.value, Vec3<T>(Vec3<T>::Zero())});
}

template <class T>
void EllipsoidRows<T>::add_gradient(std::span<T> gradient) const {
  for (const Row& r : rows_)
    add_three<T>(r.row.gradient.transpose() * r.row.slope(r.value), r.unknown, gradient);
}

template <class T>
T EllipsoidRows<T>::slope(T t) const {
  T sum = T(0);
  for (const Row& r : rows_) sum += r.row.slope(r.value + t * r.d_value).dot(r.d_value);
  return sum;
}

template <class T>
void EllipsoidRows<T>::look_along(std::span<const T> step) {
  for (Row& r : rows_) r.d_value = r.row.gradient * three<T>(step, r.unknown);
}

template <class T>
void EllipsoidRows<T>::move(T t) {
  for (Row& r : rows_) r.value += t * r.d_value;
}

template <class T>
void EllipsoidRows<T>::add_curvature(const Unknowns& unknowns, TreeMatrix<T>& matrix) const {
  for (const Row& r : rows_) {
    const Mat3<T> curvature = r.row.gradient.transpose() * r.row.curvature(r.value) * r.row.gradient;
    for (int a = 0; a < 3; ++a)
      for (int b = 0; b <= a; ++b)
        matrix.row(r.unknown + a)[unknowns.pattern.depth[r.unknown + b]] += curvature(a, b);
  }
}

template <class T>
void EllipsoidRows<T>::multiply(std::span<const T> x, std::span<T> y) const {
  for (const Row& r : rows_) {
    const Vec3<T> along = r.row.gradient * three<T>(x, r.unknown);
    add_three<T>(r.row.gradient.transpose() * (r.row.curvature(r.value) * along), r.unknown, y);
  }
}

template <class T>
void EllipsoidRows<T>::rewind() {
  for (Row& r : rows_) r.value = r.row.value;
}

template <class T>
bool EllipsoidRows<T>::measure(std::span<TreeProblem<T>* const> trees) {
  std::size_t n = 0;
  for (const TreeProblem<T>* p : trees)
    for (const EllipsoidRow<T>& row : p->ellipsoids) {
      if (n == rows_.size() || rows_[n].row.dof != row.dof) return false;
      rows_[n++].value = row.value;
    }
  return n == rows_.size();
}

}  // namespace

template <class T>
std::unique_ptr<EllipsoidModel<T>> make_ellipsoid_rows() {
  return std::make_unique<EllipsoidRows<T>>();
}

template std::unique_ptr<EllipsoidModel<float>> make_ellipsoid_rows<float>();
template std::unique_ptr<EllipsoidModel<double>> make_ellipsoid_rows<double>();

}  // namespace sinew
