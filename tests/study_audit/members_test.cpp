// Shapes, joints and depths where geometry gives the answer.
#include <gtest/gtest.h>

#include "study/audit/member.h"
#include "study_audit/motions.h"

namespace sinew::audit {
namespace {

using Eigen::Vector3d;

Solid box(const Vector3d& half, const Vector3d& at) {
  Solid s;
  s.shape = Shape::kBox;
  s.half = half;
  s.pose.translation() = at;
  return s;
}
Solid capsule(double radius, double half, const Vector3d& at, const Vector3d& axis) {
  Solid s;
  s.shape = Shape::kCapsule;
  s.radius = radius;
  s.half.z() = half;
  s.pose.linear() = Eigen::Quaterniond::FromTwoVectors(Vector3d::UnitZ(), axis).toRotationMatrix();
  s.pose.translation() = at;
  return s;
}

TEST(Solids, OverlapsAreExact) {
  const Solid table = box({1, 1, 0.1}, {0, 0, 0});
  EXPECT_NEAR(overlap(box({0.1, 0.1, 0.1}, {0, 0, 0.195}), table), 5e-3, 1e-12);
  EXPECT_NEAR(overlap(capsule(0.1, 5, {0, 0, 0.19}, {1, 0, 0}), table), 0.01, 1e-6) << "beyond both edges";
  const double corner = std::sqrt(0.5) * 0.5;  // of a box that stands on its edge
  Solid tilted = box({0.25, 0.25, 0.25}, {0, 0, 0.1 + corner - 2e-3});
  tilted.pose.linear() = Eigen::AngleAxisd(kPi / 4, Vector3d::UnitX()).toRotationMatrix();
  EXPECT_NEAR(overlap(tilted, table), 2e-3, 1e-9);
  EXPECT_NEAR(overlap(capsule(0.1, 1, {0, 0, 0.15}, {1, 0, 0}), capsule(0.1, 1, {0, 0, 0}, {0, 1, 0})), 0.05,
              1e-12)
      << "crossed";
  EXPECT_NEAR(below(box({0.1, 0.2, 0.3}, {0, 0, 0.29}), 0), 0.01, 1e-12);
}

TEST(Solids, InertiasAreThoseOfTheirVolume) {
  // Summed up over a grid of 50³ points: good to some percent at surfaces that it cuts through.
  const double mass = 3;
  for (const Solid& s : {box({0.1, 0.2, 0.3}, {0, 0, 0}), capsule(0.2, 0.3, {0, 0, 0}, {0, 0, 1}),
                         capsule(0.25, 0, {0, 0, 0}, {0, 0, 1})}) {
    Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
    int inside = 0;
    Solid point;
    for (int n = 0; n < 50 * 50 * 50; ++n) {
      const int row = n / 50 % 50, layer = n / 2500;
      point.pose.translation() = (Vector3d(n % 50, row, layer) / 49.0 - Vector3d::Constant(0.5)) * 1.2;
      if (overlap(point, s) < 0) continue;
      const Vector3d p = point.pose.translation();
      sum += p.squaredNorm() * Eigen::Matrix3d::Identity() - p * p.transpose();
      ++inside;
    }
    EXPECT_LE((sum * mass / inside - inertia_of(s, mass)).norm(), 0.05 * inertia_of(s, mass).norm());
  }
}

ConvexHull cuboid(const Vector3d& half, const Vector3d& at) {
  std::vector<Vector3d> corners;
  for (int n = 0; n < 8; ++n)
    corners.emplace_back(at + half.cwiseProduct(Vector3d(n & 1 ? 1 : -1, n & 2 ? 1 : -1, n & 4 ? 1 : -1)));
  ConvexHull hull;
  EXPECT_TRUE(ConvexHull::make(corners, hull).ok());
  return hull;
}

TEST(Solids, HullsOfBoxesAreBoxes) {
  const Vector3d half(0.3, 0.2, 0.1);
  const ConvexHull hull = cuboid(half, Vector3d::Zero());
  for (int n = 0; n < 60; ++n) {
    Solid other = n % 2 ? box({0.1, 0.3, 0.2}, {0, 0, 0}) : capsule(0.1, 0.3, {0, 0, 0}, {1, 2, 3});
    other.pose.rotate(Eigen::AngleAxisd(0.7 * n, Vector3d(1, 0.3 * n, -2).normalized()));
    other.pose.translation() = 0.01 * Vector3d(n % 30, 20 - n % 11, n % 17);
    const double wanted = overlap(box(half, {0, 0, 0}), other),
                 found = overlap(solid_of(hull, Eigen::Isometry3d::Identity()), other);
    if (other.shape == Shape::kBox || wanted < 0.1) {  // where its axis is outside
      EXPECT_NEAR(found, wanted, 5e-4);
    }
  }
  EXPECT_NEAR(below(solid_of(hull, Eigen::Isometry3d(Eigen::Translation3d(0, 0, 0.09))), 0), 0.01, 1e-12);
  Vector3d middle;
  const Eigen::Matrix3d inertia = inertia_of(cuboid(half, {1, -2, 0.5}), 3, middle);
  EXPECT_LT((middle - Vector3d(1, -2, 0.5)).norm(), 1e-12);
  EXPECT_LT((inertia - inertia_of(box(half, {0, 0, 0}), 3)).norm(), 1e-12);
}

/// A rod on a joint of the given kind at (0, 0, 1) of the world's body.
Member on_joint(JointType type) {
  Member member = one_body(1, Vector3d::Ones());
  Body rod = member.bodies[0];
  rod.type = type;
  rod.parent = 0;
  rod.rest.translation = {0, 0, 1};
  rod.axis = Vector3d::UnitY();
  rod.axis2 = Vector3d::UnitX();
  rod.first_dof = 6;
  member.dofs += dof_count(type);
  member.bodies.push_back(rod);
  return member;
}

Gap gap_of(JointType type, const Vector3d& turned, const Vector3d& moved) {
  const Transform<double> base{turn({0.3, 0.2, 0.1}), {1, 2, 3}};
  const Transform<double> local{turn(turned), Vector3d(0, 0, 1) + moved};
  const std::vector<Transform<double>> poses{base, base * local};
  return joint_gap(on_joint(type), poses);
}

TEST(Joints, StandOpenByWhatTheyCannotDo) {
  const Vector3d still = Vector3d::Zero();
  for (const JointType type :
       {JointType::kFixed, JointType::kRevolute, JointType::kUniversal, JointType::kBall})
    EXPECT_NEAR(gap_of(type, still, {3e-3, 4e-3, 0}).distance, 5e-3, 1e-12);
  EXPECT_NEAR(gap_of(JointType::kPrismatic, still, {3e-3, 0.7, 0}).distance, 3e-3, 1e-12);
  EXPECT_NEAR(gap_of(JointType::kPlanar, still, {0.5, 2e-3, 0.7}).distance, 2e-3, 1e-12);
  EXPECT_NEAR(gap_of(JointType::kFree, {1, 1, 1}, {1, 1, 1}).distance, 0, 1e-12);
  EXPECT_NEAR(gap_of(JointType::kFixed, {1e-3, 0, 0}, still).angle, 1e-3, 1e-9);
  EXPECT_NEAR(gap_of(JointType::kRevolute, {0, 0.8, 0}, still).angle, 0, 1e-9);
  EXPECT_NEAR(gap_of(JointType::kRevolute, {1e-3, 0, 0}, still).angle, 1e-3, 1e-9);
  EXPECT_NEAR(gap_of(JointType::kUniversal, {0, 0, 1e-3}, still).angle, 1e-3, 1e-9);
  EXPECT_NEAR(gap_of(JointType::kBall, {0.5, 0.3, 1}, still).angle, 0, 1e-9);
}

TEST(Depths, AreThoseOfWhatMayMeet) {
  // Three boxes in a row on balls: neighbours overlap, the first and the last may meet once it is folded.
  Member chain = one_body(1, Vector3d::Ones());
  chain.bodies[0].solids = {box({0.1, 0.1, 0.5}, {0, 0, 0.5})};
  for (int n = 1; n < 3; ++n) {
    Body next = chain.bodies[0];
    next.type = JointType::kBall;
    next.parent = n - 1;
    next.rest.translation = {0, 0, 1};
    chain.bodies.push_back(next);
  }
  const auto folded = [](double second, double third) {
    std::vector<Transform<double>> poses{{Eigen::Quaterniond::Identity(), Vector3d::Zero()}};
    for (const double angle : {second, third})
      poses.push_back(poses.back() * Transform<double>{turn({0, angle, 0}), {0, 0, 1}});
    return poses;
  };
  chain.touches_itself = true;
  const std::vector<Member> members{chain};
  const auto depth = [&](const std::vector<Transform<double>>& poses) {
    const std::vector<Poses> all{poses};
    return deepest_between(members, all);
  };
  EXPECT_EQ(depth(folded(0, 0)), 0);
  EXPECT_EQ(depth(folded(kPi / 2, kPi / 2)), 0) << "beside each other, 0.8 m apart";
  EXPECT_NEAR(depth(folded(kPi / 2, 0.9 * kPi)), 0.2, 0.2) << "the third back through the first";
  Surroundings floor;
  floor.ground = true;
  floor.ground_height = 0.02;
  EXPECT_NEAR(depth_in(floor, chain, folded(0, 0)), 0.02, 1e-12);
  chain.touches_ground = false;
  EXPECT_EQ(depth_in(floor, chain, folded(0, 0)), 0);
}

TEST(Depths, BetweenManyAreThoseOfPairs) {
  std::vector<Member> balls(30, loose_solid(Shape::kSphere, Vector3d::Constant(0.5), 1));
  std::vector<std::vector<Transform<double>>> at(balls.size());
  std::vector<Poses> poses;
  for (std::size_t n = 0; n < balls.size(); ++n) {
    const auto row = n / 6;
    at[n] = {{Eigen::Quaterniond::Identity(), {std::fmod(7.3 * double(n), 5), 1.1 * double(row), 0}}};
    poses.emplace_back(at[n]);
  }
  double deepest = 0;
  for (std::size_t a = 0; a < balls.size(); ++a)
    for (std::size_t b = a + 1; b < balls.size(); ++b) {
      deepest = std::max(deepest, depth_between(balls[a], poses[a], balls[b], poses[b]));
      EXPECT_NEAR(distance_between(balls[a], poses[a], balls[b], poses[b]),
                  (at[a][0].translation - at[b][0].translation).norm() - 1, 1e-12);
    }
  EXPECT_GT(deepest, 0.01);
  EXPECT_DOUBLE_EQ(deepest_between(balls, poses), deepest);
}

}  // namespace
}  // namespace sinew::audit
