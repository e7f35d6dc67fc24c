// Contacts: distances, laws and how gap and slip change with the bodies.
#include "sinew/effects/contact.h"

#include <gtest/gtest.h>

#include "residual/random_tree.h"

namespace sinew {
namespace {

using V = Vec3<double>;
using fixtures::Random;

TEST(SignedDistance, KnowsSphereCapsuleAndBox) {
  const V size(0.2, 0.3, 0.4);
  EXPECT_NEAR(signed_distance<double>(Shape::kSphere, size, {1, 0, 0}).distance, 0.8, 1e-15);
  EXPECT_NEAR(signed_distance<double>(Shape::kSphere, size, {0, 0.1, 0}).distance, -0.1, 1e-15);
  EXPECT_NEAR(signed_distance<double>(Shape::kCapsule, size, {0.5, 0, 0.3}).distance, 0.3, 1e-15);
  EXPECT_NEAR(signed_distance<double>(Shape::kCapsule, size, {0, 0, -1}).distance, 0.4, 1e-15);
  EXPECT_NEAR(signed_distance<double>(Shape::kBox, size, {0.5, 0.7, 0}).distance, 0.5, 1e-15);  // 3-4-5 edge
  EXPECT_NEAR(signed_distance<double>(Shape::kBox, size, {0.1, 0, 0}).distance, -0.1, 1e-15);
}

TEST(SignedDistance, NormalIsTheGradient) {
  Random random(5);
  constexpr double step = 1e-6;
  const V size(0.2, 0.3, 0.4);
  for (const Shape shape : {Shape::kSphere, Shape::kCapsule, Shape::kBox})
    for (int n = 0; n < 200; ++n) {
      const V x = random.vector(0.5);
      const SignedDistance<double> at = signed_distance<double>(shape, size, x);
      EXPECT_NEAR(at.normal.norm(), 1, 1e-12);
      if (at.distance < -0.02) continue;  // deep inside a box the nearest face changes
      for (int a = 0; a < 3; ++a) {
        const V e = V::Unit(a) * step;
        const double ahead = signed_distance<double>(shape, size, x + e).distance;
        const double behind = signed_distance<double>(shape, size, x - e).distance;
        EXPECT_NEAR((ahead - behind) / (2 * step), at.normal[a], 1e-6) << int(shape) << " " << x.transpose();
      }
    }
}

TEST(SignedDistance, IsFiniteInTheMiddleOfEveryShape) {
  for (const Shape shape : {Shape::kSphere, Shape::kCapsule, Shape::kBox}) {
    const auto d = signed_distance<float>(shape, {0.2f, 0.3f, 0.4f}, {0, 0, 0});
    EXPECT_LT(d.distance, 0);
    EXPECT_NEAR(d.normal.norm(), 1, 1e-6f);
  }
}

TEST(ContactPoints, SpanTheCollider) {
  Collider box;
  box.shape = Shape::kBox;
  box.size = {0.1, 0.2, 0.3};
  box.local.translation = {1, 0, 0};
  std::vector<ContactPoint<double>> points;
  append_contact_points<double>(box, points);
  ASSERT_EQ(points.size(), 8u);
  V low = points[0].local, high = low;
  for (const auto& p : points) {
    const V round = V::Constant(p.radius);  // corners are small balls that touch the faces from within
    low = low.cwiseMin(p.local - round);
    high = high.cwiseMax(p.local + round);
    EXPECT_LE(p.radius, 0.01);
  }
  EXPECT_LT((low - V(0.9, -0.2, -0.3)).norm() + (high - V(1.1, 0.2, 0.3)).norm(), 1e-12);

  Collider capsule;
  capsule.shape = Shape::kCapsule;
  capsule.size = {0.05, 0.05, 0.2};
  points.clear();
  append_contact_points<double>(capsule, points);
  // Two ends, the axis between them, and what fills it at most two radii apart.
  ASSERT_EQ(points.size(), 2u + 1u + 4u);
  EXPECT_EQ(points[2].kind, PointKind::kAxis);
  EXPECT_NEAR(points[2].half_axis.norm(), 0.2, 1e-12);
  EXPECT_NEAR((points[0].local - points[1].local).norm(), 0.4, 1e-12);
  EXPECT_EQ(points[0].radius, 0.05);
}

TEST(ContactLaw, ForceAndCurvatureAreDerivativesAndContinuous) {
  using Law = ContactLaw<double>;
  constexpr double k = 1e5, step = 1e-8, width = 5e-4;
  for (const double gap : {1e-3, -1e-5, -2e-4, -4.9e-4, -5.1e-4, -3e-3}) {
    EXPECT_NEAR(-(Law::energy(k, gap + step, width) - Law::energy(k, gap - step, width)) / (2 * step),
                Law::force(k, gap, width), 1e-4);
    EXPECT_NEAR(-(Law::force(k, gap + step, width) - Law::force(k, gap - step, width)) / (2 * step),
                Law::curvature(k, gap, width), 1e-3 * k);
  }
  for (const double gap : {0.0, -width}) {  // C² where pieces meet: differences of order k·1e-10/width
    EXPECT_NEAR(Law::energy(k, gap + 1e-10, width), Law::energy(k, gap - 1e-10, width), 1e-8);
    EXPECT_NEAR(Law::force(k, gap + 1e-10, width), Law::force(k, gap - 1e-10, width), 1e-4);
    EXPECT_NEAR(Law::curvature(k, gap + 1e-10, width), Law::curvature(k, gap - 1e-10, width), 1e-6 * k);
  }
  EXPECT_EQ(Law::force(k, 1e-9, width), 0);
}

TEST(FrictionLaw, IsTwiceContinuouslyDifferentiable) {
  using Law = FrictionLaw<double>;
  constexpr double stick = 1e-3, step = 1e-7;
  const auto slope = [](double s) { return s * Law::slope_over_slip(s, stick); };
  for (const double s : {1e-5, 3e-4, 9.9e-4, 1.01e-3, 5e-3}) {
    EXPECT_NEAR((Law::energy(s + step, stick) - Law::energy(s - step, stick)) / (2 * step), slope(s), 1e-7);
    EXPECT_NEAR((slope(s + step) - slope(s - step)) / (2 * step), Law::curvature(s, stick), 1e-6 / stick);
  }
  const double before = stick * (1 - 1e-9), after = stick * (1 + 1e-9);
  EXPECT_NEAR(Law::energy(before, stick), Law::energy(after, stick), 1e-11);
  EXPECT_NEAR(slope(before), slope(after), 1e-11);
  EXPECT_NEAR(Law::curvature(before, stick), Law::curvature(after, stick), 1e-5);
  // At rest the law is even in the slip, so its slope must vanish there.
  EXPECT_EQ(slope(0), 0);
  EXPECT_NEAR(Law::slope_over_slip(0, stick), Law::curvature(0, stick), 1e-9);
}

TEST(FrictionLaw, NeverExceedsCoulombsLimit) {
  for (double s = 0; s < 5e-3; s += 1e-5) {
    const double slope = s * FrictionLaw<double>::slope_over_slip(s, 1e-3);
    EXPECT_LE(slope, 1 + 1e-12);
    EXPECT_GE(FrictionLaw<double>::curvature(s, 1e-3), 0);
  }
}

/// Two random trees with a contact between a body of each.
struct Pair {
  Tree<double> tree{fixtures::random_skeleton(1)};
  Random random;
  std::vector<Transform<double>> pose_a, pose_b;
  Kinematics<double> a{tree}, b{tree};
  Contact<double> contact;

  Pair(Shape shape, bool against_body, bool plane, bool axis = false, unsigned seed = 77) : random(seed) {
    pose_a = fixtures::random_pose(tree, random, 0.4);
    pose_b = fixtures::random_pose(tree, random, 0.4);
    refresh();
    contact.body_a = 9;
    contact.local_a = random.vector(0.2);
    contact.radius = 0.03;
    if (axis) contact.half_axis_a = random.vector(0.15);
    contact.shape = shape;
    contact.size = {0.1, 0.15, 0.2};
    contact.shape_pose = {random.rotation(), random.vector(0.2)};
    contact.plane = plane;
    contact.plane_height = -0.2;
    if (against_body) {
      contact.tree_b = 1;
      contact.body_b = 7;
    }
    begin_step<double>(a, other(), contact);
    // A step later both have moved.
    move(pose_a);
    move(pose_b);
    refresh();
    measure<double>(a, other(), contact);
  }
  void move(std::vector<Transform<double>>& pose) {
    std::vector<double> d(tree.dofs);
    for (double& x : d) x = random.normal(0.02);
    pose = fixtures::displaced_pose(tree, pose, d.data());
  }
  void refresh() {
    forward_kinematics<double>(tree, pose_a, V::Zero(), a);
    forward_kinematics<double>(tree, pose_b, V::Zero(), b);
  }
  const Kinematics<double>* other() const { return contact.tree_b < 0 ? nullptr : &b; }
  bool moves(int dof, int body) const {
    while (body > tree.dof_body[dof]) body = tree.parent[body];
    return body == tree.dof_body[dof];
  }
  /// Gap and slips with one degree of freedom displaced.
  V measured(std::vector<Transform<double>>& pose, int dof, double by) {
    const std::vector<Transform<double>> before = pose;
    std::vector<double> d(tree.dofs, 0.0);
    d[dof] = by;
    pose = fixtures::displaced_pose(tree, pose, d.data());
    refresh();
    Contact<double> c = contact;
    measure<double>(a, other(), c);
    pose = before;
    refresh();
    return {c.gap, c.slip[0], c.slip[1]};
  }
};

void expect_gradients(Pair& p) {
  constexpr double step = 1e-6;  // curvature of a distance is 1/distance; error of order step²
  const Contact<double> c = p.contact;
  for (int side = 0; side < (c.tree_b < 0 ? 1 : 2); ++side)
    for (int dof = 0; dof < p.tree.dofs; ++dof) {
      auto& pose = side == 0 ? p.pose_a : p.pose_b;
      const V difference = (p.measured(pose, dof, step) - p.measured(pose, dof, -step)) / (2 * step);
      V expected = V::Zero();
      if (p.moves(dof, side == 0 ? c.body_a : c.body_b)) {
        const Kinematics<double>& k = side == 0 ? p.a : p.b;
        const V slide = k.v[dof] + k.w[dof].cross(side == 0 ? c.material_point : c.material_point_b);
        expected = {c.normal.dot(k.v[dof] + k.w[dof].cross(c.point)), c.frame.col(0).dot(slide),
                    c.frame.col(1).dot(slide)};
        if (side == 1) expected = -expected;
      }
      EXPECT_LT((difference - expected).norm(), 1e-7) << "side " << side << " dof " << dof;
    }
}

TEST(Contact, GapAndSlipChangeAsTheirGradientsSay) {
  for (const Shape shape : {Shape::kSphere, Shape::kCapsule, Shape::kBox})
    for (const bool against_body : {false, true}) {
      Pair pair(shape, against_body, false);
      SCOPED_TRACE(testing::Message() << "shape " << int(shape) << " against body " << against_body);
      expect_gradients(pair);
    }
  // Axis against axis: nearest inside both, at an end of one, or at ends of both, as the seeds fall.
  for (unsigned seed = 1; seed <= 30; ++seed)
    for (const Shape shape : {Shape::kSphere, Shape::kCapsule}) {
      Pair pair(shape, true, false, true, seed);
      SCOPED_TRACE(testing::Message() << "axis, shape " << int(shape) << " seed " << seed);
      expect_gradients(pair);
    }
  Pair floor(Shape::kSphere, false, true);
  expect_gradients(floor);
}

// By central differences of the gap, as body a turns and moves as a whole; seeds let the nearest points lie
// inside both axes, at an end of one, or at ends of both.
TEST(Contact, GapBendsAsItsSurfaceAndItsSlidingSay) {
  int sliding = 0;
  for (unsigned seed = 1; seed <= 400; ++seed)
    for (const Shape shape : {Shape::kSphere, Shape::kCapsule}) {
      SCOPED_TRACE(testing::Message() << "shape " << int(shape) << " seed " << seed);
      Pair p(shape, true, false, true, seed);
      const Contact<double> c = p.contact;
      const V axis = (p.a.rotation[c.body_a] * c.half_axis_a).normalized();
      if (c.sliding.slides && std::abs(c.sliding.across.dot(axis)) < 0.5) continue;  // see kParallel
      sliding += c.sliding.slides;
      const V spin = p.random.vector(1), speed = p.random.vector(1);
      const Transform<double> root = p.pose_a[0];
      const auto gap = [&](double t) {
        const Quat<double> turn(Eigen::AngleAxisd(t * spin.norm(), spin.normalized()));
        p.pose_a[0] = Transform<double>{turn, t * speed} * root;
        p.refresh();
        Contact<double> moved = c;
        measure<double>(p.a, p.other(), moved);
        return moved.gap;
      };
      constexpr double step = 1e-4;
      const double second = (gap(step) - 2 * gap(0) + gap(-step)) / (step * step);
      const V moves = speed + spin.cross(c.point);
      double expected = c.normal.dot(spin.cross(spin.cross(c.point)));
      if (c.bends) expected += moves.dot(c.bending * moves);
      if (c.sliding.slides) {
        const double tips = spin.dot(c.sliding.tipping);
        expected += 2 * tips * moves.dot(c.sliding.across) - c.sliding.lever * tips * tips;
      }
      EXPECT_NEAR(second, expected, 1e-4 + 0.02 * std::abs(expected) + 0.02 * spin.squaredNorm());
    }
  EXPECT_GT(sliding, 20);
}

TEST(Contact, SlipIsZeroWhenTheStepBegins) {
  Pair pair(Shape::kBox, true, false);
  begin_step<double>(pair.a, pair.other(), pair.contact);
  EXPECT_NEAR(pair.contact.slip[0], 0, 1e-14);
  EXPECT_NEAR(pair.contact.slip[1], 0, 1e-14);
  const Mat3<double>& f = pair.contact.frame;
  EXPECT_LT((f.transpose() * f - Mat3<double>::Identity()).norm(), 1e-12);
  EXPECT_LT((f.col(2) - pair.contact.normal).norm(), 1e-14);
}

TEST(Contact, BodiesThatMoveTogetherDoNotSlip) {
  Pair pair(Shape::kBox, true, false);
  begin_step<double>(pair.a, pair.other(), pair.contact);
  const Transform<double> together{Quat<double>::Identity(), {0.3, -0.1, 0.2}};
  pair.pose_a[0] = together * pair.pose_a[0];
  pair.pose_b[0] = together * pair.pose_b[0];
  const double gap = pair.contact.gap;
  pair.refresh();
  measure<double>(pair.a, pair.other(), pair.contact);
  EXPECT_NEAR(pair.contact.slip[0], 0, 1e-13);
  EXPECT_NEAR(pair.contact.slip[1], 0, 1e-13);
  EXPECT_NEAR(pair.contact.gap, gap, 1e-13);
}

}  // namespace
}  // namespace sinew
