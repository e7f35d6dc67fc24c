// Our operators on vectors and matrices of three against Eigen's own.
#include "sinew/skeleton/vector.h"

#include <gtest/gtest.h>

#include <limits>
#include <random>

namespace outside {  // of namespace sinew: only Eigen's operators are seen

template <class A, class B>
auto sum(const A& a, const B& b) {
  return (a + b).eval();
}
template <class A, class B>
auto difference(const A& a, const B& b) {
  return (a - b).eval();
}
template <class A, class B>
auto product(const A& a, const B& b) {
  return (a * b).eval();
}
template <class A, class B>
auto quotient(const A& a, const B& b) {
  return (a / b).eval();
}
template <class A, class B>
auto transposed_product(const A& a, const B& b) {
  return (a.transpose() * b).eval();
}
template <class A, class B>
auto product_transposed(const A& a, const B& b) {
  return (a * b.transpose()).eval();
}

}  // namespace outside

namespace sinew {
namespace {

constexpr unsigned kSeed = 5;

template <class T>
class Vector : public testing::Test {
 public:
  Vec3<T> vector() { return {number(), number(), number()}; }
  Mat3<T> matrix() {
    Mat3<T> m;
    for (int k = 0; k < 9; ++k) m.data()[k] = number();
    return m;
  }
  T number() { return normal_(random_); }

  static constexpr bool kFloat = sizeof(T) == 4;

 private:
  std::mt19937 random_{kSeed};
  std::normal_distribution<T> normal_;
};
using Scalars = testing::Types<float, double>;
TYPED_TEST_SUITE(Vector, Scalars);

TYPED_TEST(Vector, SumsAndScalingHaveEigensBits) {
  using T = TypeParam;
  for (int n = 0; n < 1000; ++n) {
    const Vec3<T> a = this->vector(), b = this->vector();
    const Mat3<T> m = this->matrix(), k = this->matrix();
    const T s = this->number();
    EXPECT_EQ(Vec3<T>(a + b), outside::sum(a, b));
    EXPECT_EQ(Vec3<T>(a - b), outside::difference(a, b));
    EXPECT_EQ(Vec3<T>(-a), outside::product(a, -1));
    EXPECT_EQ(Vec3<T>(a * s), outside::product(a, s));
    EXPECT_EQ(Vec3<T>(s * a), outside::product(s, a));
    EXPECT_EQ(Vec3<T>(3 * a), outside::product(T(3), a));
    EXPECT_EQ(Vec3<T>(a / s), outside::quotient(a, s));
    EXPECT_EQ(Mat3<T>(m + k), outside::sum(m, k));
    EXPECT_EQ(Mat3<T>(m - k), outside::difference(m, k));
    EXPECT_EQ(Mat3<T>(-m), outside::product(m, -1));
    EXPECT_EQ(Mat3<T>(m * s), outside::product(m, s));
    EXPECT_EQ(Mat3<T>(s * m), outside::product(s, m));
    EXPECT_EQ(Mat3<T>(m / s), outside::quotient(m, s));
  }
}

/// In float to the bits. In double Eigen sums two of three rows in another order: a rounding each of three
/// terms.
TYPED_TEST(Vector, ProductsAreEigens) {
  using T = TypeParam;
  const auto off = [](const auto& ours, const auto& eigens) { return (ours - eigens).cwiseAbs().maxCoeff(); };
  for (int n = 0; n < 1000; ++n) {
    const Mat3<T> a = this->matrix(), b = this->matrix();
    const Vec3<T> v = this->vector();
    const T largest = std::max({a.cwiseAbs().maxCoeff(), b.cwiseAbs().maxCoeff(), v.cwiseAbs().maxCoeff()});
    const T rounding = this->kFloat ? T(0) : 3 * std::numeric_limits<T>::epsilon() * largest * largest;
    EXPECT_LE(off(a * v, outside::product(a, v)), rounding);
    EXPECT_LE(off(a.transpose() * v, outside::transposed_product(a, v)), rounding);
    EXPECT_LE(off(a * b, outside::product(a, b)), rounding);
    EXPECT_LE(off(a.transpose() * b, outside::transposed_product(a, b)), rounding);
    EXPECT_LE(off(a * b.transpose(), outside::product_transposed(a, b)), rounding);
  }
}

TYPED_TEST(Vector, AProductMayBeAssignedToItsOwnOperand) {
  using T = TypeParam;
  Mat3<T> a = this->matrix();
  const Mat3<T> b = this->matrix(), expected = a * b;
  a = a * b;
  EXPECT_EQ(a, expected);
  Vec3<T> v = this->vector();
  const Vec3<T> turned = b * v;
  v = b * v;
  EXPECT_EQ(v, turned);
}

}  // namespace
}  // namespace sinew
