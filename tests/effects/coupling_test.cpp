// Coupling elements: gradients and curvatures against differences, the material law, what is refused.
#include "sinew/effects/coupling.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <random>

#include "sinew/effects/cloth.h"
#include "sinew/effects/loop.h"
#include "sinew/effects/soft_tissue.h"
#include "sinew/effects/strand.h"

namespace sinew {
namespace {

using V = Vec3<double>;
using Matrix12 = TetrahedronHessian<double>;
using Vector12 = Eigen::Matrix<double, 12, 1>;

/// Four nodes around the corners of a unit tetrahedron, each coordinate off by a normal deviate.
Coupling<double> four_nodes(unsigned seed, double spread) {
  std::mt19937 random(seed);
  std::normal_distribution<double> off(0, spread);
  const V corners[] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  Coupling<double> c;
  for (const V& x : corners) c.nodes.emplace_back().point = x + V(off(random), off(random), off(random));
  return c;
}

Coupling<double> one_tetrahedron(unsigned seed, double spread) {
  Coupling<double> c = four_nodes(seed, spread);
  const V corners[] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  Tetrahedron<double> e;
  EXPECT_TRUE(set_rest_shape(corners, e));
  set_material(1000, 0.4, e);
  for (int i = 0; i < 4; ++i) e.node[i] = i;
  c.tetrahedra.push_back(e);
  return c;
}

Coupling<double> one_stencil(unsigned seed, double length, bool only_pulls) {
  Coupling<double> c = four_nodes(seed, 0.3);
  Stencil<double> e;
  e.count = 4;
  const double weights[] = {1, -0.3, -0.9, 0.2};
  for (int i = 0; i < 4; ++i) {
    e.node[i] = i;
    e.weight[i] = weights[i];
  }
  e.stiffness = 700;
  e.length = length;
  e.only_pulls = only_pulls;
  c.stencils.push_back(e);
  return c;
}

Vector12 gradient(Coupling<double>& c) {
  measure_elements(c);
  Vector12 g;
  for (int i = 0; i < 4; ++i) g.segment<3>(3 * i) = c.nodes[i].gradient;
  return g;
}

void expect_gradient_is_the_difference_quotient(Coupling<double> c) {
  const Vector12 g = gradient(c);
  constexpr double step = 1e-6;  // truncation step² and rounding 1e-16/step are both below 1e-9 relative
  for (int k = 0; k < 12; ++k) {
    double& x = c.nodes[k / 3].point[k % 3];
    const double at = x;
    x = at + step;
    const double ahead = measure_elements(c);
    x = at - step;
    const double behind = measure_elements(c);
    x = at;
    EXPECT_NEAR((ahead - behind) / (2 * step), g[k], 1e-6 * (1 + g.norm())) << k;
  }
}

Matrix12 difference_of_gradients(Coupling<double> c) {
  constexpr double step = 1e-6;
  Matrix12 h;
  for (int k = 0; k < 12; ++k) {
    double& x = c.nodes[k / 3].point[k % 3];
    const double at = x;
    x = at + step;
    const Vector12 ahead = gradient(c);
    x = at - step;
    h.col(k) = (ahead - gradient(c)) / (2 * step);
    x = at;
  }
  return h;
}

Matrix12 without_negative(const Matrix12& h) {
  const Eigen::SelfAdjointEigenSolver<Matrix12> modes(0.5 * (h + h.transpose()));
  return modes.eigenvectors() * modes.eigenvalues().cwiseMax(0).asDiagonal() *
         modes.eigenvectors().transpose();
}

TEST(Stencil, GradientIsTheDifferenceQuotient) {
  for (unsigned seed = 0; seed < 5; ++seed) {
    expect_gradient_is_the_difference_quotient(one_stencil(seed, 0, false));
    expect_gradient_is_the_difference_quotient(one_stencil(seed, 0.4, false));
    expect_gradient_is_the_difference_quotient(one_stencil(seed, 0.4, true));
  }
}

TEST(Stencil, CurvatureIsTheSecondDerivativeWithoutItsNegativePart) {
  int pulled = 0, pressed = 0;
  for (unsigned seed = 0; seed < 12; ++seed)
    for (const double length : {0.0, 0.4, 2.0}) {
      const Coupling<double> c = one_stencil(seed, length, false);
      const Stencil<double>& e = c.stencils[0];
      (reach(c, e).norm() > length ? pulled : pressed)++;
      const Mat3<double> b = stencil_curvature(c, e);
      Matrix12 h;
      for (int i = 0; i < 4; ++i)
        for (int j = 0; j < 4; ++j) h.block<3, 3>(3 * i, 3 * j) = e.weight[i] * e.weight[j] * b;
      const Matrix12 wanted = without_negative(difference_of_gradients(c));
      EXPECT_LT((h - wanted).norm(), 1e-5 * wanted.norm()) << "seed " << seed << ", length " << length;
    }
  EXPECT_GT(pulled, 5);
  EXPECT_GT(pressed, 5);
}

TEST(Stencil, ForcesAndMomentsAddUpToNothing) {
  Coupling<double> c = one_stencil(3, 0.4, false);
  measure_elements(c);
  V force = V::Zero(), moment = V::Zero();
  double size = 0;
  for (const CouplingNode<double>& node : c.nodes) {
    force += node.gradient;
    moment += node.point.cross(node.gradient);
    size += node.gradient.norm();
  }
  EXPECT_GT(size, 1);
  EXPECT_LT(force.norm() + moment.norm(), 1e-12 * size);
}

TEST(Tetrahedron, GradientIsTheDifferenceQuotient) {
  for (unsigned seed = 0; seed < 5; ++seed)
    expect_gradient_is_the_difference_quotient(one_tetrahedron(seed, 0.4));
}

TEST(Tetrahedron, CurvatureIsTheSecondDerivativeWithoutItsNegativePart) {
  // Also far from rest and inside out. The shape functions' slopes are not orthonormal, so the projection is
  // that of the energy's second derivative by F, compared where nothing had to be cut, else bounded.
  int exact = 0, cut = 0;
  for (unsigned seed = 0; seed < 40; ++seed) {
    const Coupling<double> c = one_tetrahedron(seed, seed % 2 ? 0.03 : 0.8);
    const Matrix12 h = tetrahedron_curvature(c, c.tetrahedra[0]), full = difference_of_gradients(c);
    const double smallest = Eigen::SelfAdjointEigenSolver<Matrix12>(h).eigenvalues()[0];
    EXPECT_GT(smallest, -1e-9 * h.norm()) << "seed " << seed;
    const double difference =
        Eigen::SelfAdjointEigenSolver<Matrix12>(h - 0.5 * (full + full.transpose())).eigenvalues()[0];
    EXPECT_GT(difference, -1e-5 * h.norm()) << "only negative parts were taken away, seed " << seed;
    if ((h - full).norm() < 1e-5 * h.norm())
      ++exact;
    else
      ++cut;
  }
  EXPECT_GT(exact, 5);
  EXPECT_GT(cut, 5);
}

TEST(Tetrahedron, RestsUnstrainedAndPullsBackAsHookeSays) {
  // Small uniaxial stretch with free sides: sigma = E·epsilon; the sides shrink by Poisson's ratio.
  Coupling<double> c = one_tetrahedron(0, 0);
  EXPECT_NEAR(measure_elements(c), 0, 1e-12);
  EXPECT_LT(gradient(c).norm(), 1e-9);
  constexpr double strain = 1e-4;
  for (CouplingNode<double>& node : c.nodes)
    node.point = V(1 + strain, 1 - 0.4 * strain, 1 - 0.4 * strain).cwiseProduct(node.point);
  measure_elements(c);
  // Node 1 carries the x face: V·P·slope = (1/6)·σ in a unit tetrahedron.
  EXPECT_NEAR(c.nodes[1].gradient.x(), 1000 * strain / 6, 0.01 * 1000 * strain / 6);
  EXPECT_LT(c.nodes[2].gradient.norm(), 0.01 * 1000 * strain / 6) << "free sides";
}

TEST(Tetrahedron, InsideOutItStillPushesTheRightWay) {
  Coupling<double> c = one_tetrahedron(0, 0);
  c.nodes[3].point.z() = -0.5;
  const double energy = measure_elements(c);
  EXPECT_TRUE(std::isfinite(energy));
  EXPECT_LT(c.nodes[3].gradient.z(), 0) << "out through the face that it went in by";
}

/// Energy of a sheet of B = 1 N·m and about 1 m², rolled on a radius of 10 m about the z axis, J.
double energy_rolled(ClothSettings& s) {
  s.bending = 1;
  s.stretch = 0;
  const ParticleBody body = make_cloth(s);
  EXPECT_TRUE(check(body).ok());
  Coupling<double> c = make_elements<double>(body, 0, {});
  for (std::size_t i = 0; i < c.nodes.size(); ++i) c.nodes[i].point = body.nodes[i].position;
  EXPECT_NEAR(measure_elements(c), 0, 1e-20) << "flat";
  for (CouplingNode<double>& node : c.nodes)
    node.point = {10 * std::sin(node.point.x() / 10), 10 - 10 * std::cos(node.point.x() / 10),
                  node.point.z()};
  return measure_elements(c);
}

TEST(Elements, RolledClothStoresHalfItsStiffnessOverTheRadiusSquared) {
  // Border edges carry no bend: a share of about 1/n is missing.
  constexpr int n = 40;
  const double side = 1.0 / n, wanted = 0.5 / 100;
  ClothSettings equilateral;
  for (int row = 0; row <= n; ++row)
    for (int column = 0; column <= n; ++column)
      equilateral.positions.emplace_back((column + 0.5 * row) * side, 0, -row * std::sqrt(0.75) * side);
  for (int row = 0; row < n; ++row)
    for (int column = 0; column < n; ++column) {
      const int a = row * (n + 1) + column, b = a + 1, c = a + n + 1, d = c + 1;
      equilateral.triangles.push_back({a, c, b});
      equilateral.triangles.push_back({b, c, d});
    }
  EXPECT_NEAR(energy_rolled(equilateral) / std::sqrt(0.75), wanted, 0.06 * wanted);
  ClothSettings grid;
  make_grid(1, 1, n, n, grid);
  EXPECT_NEAR(energy_rolled(grid), wanted, 0.06 * wanted);
}

TEST(Elements, MassesAreTheMaterials) {
  ClothSettings cloth;
  make_grid(2, 0.5, 5, 4, cloth);
  SoftTissueSettings tissue;
  make_block({0.2, 0.3, 0.4}, {2, 3, 1}, tissue);
  const auto mass = [](const ParticleBody& body) {
    double sum = 0;
    for (const ParticleNode& node : body.nodes) sum += node.mass;
    return sum;
  };
  EXPECT_NEAR(mass(make_cloth(cloth)), 0.2 * 1.0, 1e-12);
  EXPECT_NEAR(mass(make_soft_tissue(tissue)), 1000 * 0.024, 1e-9);
}

TEST(Elements, NonsenseIsRefused) {
  EXPECT_FALSE(check(ParticleBody()).ok()) << "nothing in it";
  StrandSettings strand;
  EXPECT_TRUE(check(make_strand(strand)).ok());
  strand.mass = -1;
  EXPECT_FALSE(check(make_strand(strand)).ok());
  strand.mass = 1;
  strand.particles = 0;
  EXPECT_FALSE(check(make_strand(strand)).ok());
  strand.particles = 3;
  strand.direction.setZero();
  EXPECT_FALSE(check(make_strand(strand)).ok());
  ClothSettings cloth;
  make_grid(1, 1, 2, 2, cloth);
  cloth.triangles.push_back({0, 1, 99});
  EXPECT_FALSE(check(make_cloth(cloth)).ok()) << "no such corner";
  SoftTissueSettings tissue;
  make_block({1, 1, 1}, {1, 1, 1}, tissue);
  EXPECT_TRUE(check(make_soft_tissue(tissue)).ok());
  std::swap(tissue.tetrahedra[0][0], tissue.tetrahedra[0][1]);
  EXPECT_FALSE(check(make_soft_tissue(tissue)).ok()) << "inside out";
  ParticleBody body = make_strand(StrandSettings());
  body.stencils[0].weight[0] = 2;
  EXPECT_FALSE(check(body).ok()) << "weights that do not add up to 0 would hold on to the origin";
}

}  // namespace
}  // namespace sinew
