// Work of couples, loads and strikes, where the textbook has it.
#include "study/audit/work.h"

#include <gtest/gtest.h>

#include <array>

#include "study_audit/motions.h"

namespace sinew::audit {
namespace {

using Eigen::Vector3d;

/// A body on a joint whose axes lie askew, below a parent that stands askew.
Body askew(JointType type) {
  Body body = one_body(1, Vector3d::Ones()).bodies[0];
  body.type = type;
  body.rest = {turn({0.4, -0.2, 0.9}), {0.1, 0.2, 0.3}};
  body.axis = Vector3d(1, 2, 3).normalized();
  body.axis2 = body.axis.unitOrthogonal();
  return body;
}
const Transform<double> kParent{turn({-0.3, 0.8, 0.1}), {1, -2, 0.5}};

std::array<double, 6> way_of(const Body& body, const Transform<double>& from, const Transform<double>& to) {
  std::array<double, 6> way{};
  joint_way(body, kParent, kParent * body.rest * from, kParent, kParent * body.rest * to, way);
  return way;
}

TEST(Work, WayOfAHingeIsItsAngle) {
  const Body hinge = askew(JointType::kRevolute);
  const auto at = [&](double a) { return Transform<double>{turn(a * hinge.axis), Vector3d::Zero()}; };
  EXPECT_NEAR(way_of(hinge, at(0.2), at(0.7))[0], 0.5, 1e-12);
  EXPECT_NEAR(way_of(hinge, at(3), at(3.4))[0], 0.4, 1e-12) << "through half a turn";
}

TEST(Work, WayOfASlideIsItsLength) {
  const Body slide = askew(JointType::kPrismatic);
  const auto at = [&](double a) { return Transform<double>{Eigen::Quaterniond::Identity(), a * slide.axis}; };
  EXPECT_NEAR(way_of(slide, at(-0.1), at(0.25))[0], 0.35, 1e-12);
}

TEST(Work, WayOfAUniversalJointIsItsTwoAngles) {
  const Body joint = askew(JointType::kUniversal);
  const auto at = [&](double a, double b) {
    return Transform<double>{turn(a * joint.axis) * turn(b * joint.axis2), Vector3d::Zero()};
  };
  const auto way = way_of(joint, at(0.2, -0.4), at(0.5, 0.3));
  EXPECT_NEAR(way[0], 0.3, 1e-12);
  EXPECT_NEAR(way[1], 0.7, 1e-12);
}

TEST(Work, WayOfABallIsTheTurnInItsOwnAxes) {
  const Body ball = askew(JointType::kBall);
  const Vector3d by(0.1, -0.2, 0.3);
  const Transform<double> from{turn({1, 0.5, 0.2}), Vector3d::Zero()},
      to{from.rotation * turn(by), Vector3d::Zero()};
  const auto way = way_of(ball, from, to);
  for (int k = 0; k < 3; ++k) EXPECT_NEAR(way[static_cast<std::size_t>(k)], by[k], 1e-12);
}

TEST(Work, OfACoupleIsTheKineticEnergyThatItLeaves) {
  // 0.6 N·m about a fixed axis of a free body, 0.3 kg·m² about it, for a second: α = 2 rad/s².
  const Member body = one_body(2, {0.1, 0.2, 0.3});
  const Transform<double> stand{turn({0, 0.7, 0}), {5, 6, 7}};  // the axis is the body's z wherever it stands
  const Vector3d axis = stand.rotation * Vector3d::UnitZ();
  double work = 0;
  std::vector<Transform<double>> before{stand};
  for (int n = 1; n <= 50; ++n) {
    const double t = n / 50.0;
    const std::vector<Transform<double>> after{{turn(axis * (t * t)) * stand.rotation, stand.translation}};
    const Vector3d couple = 0.6 * axis;
    const std::array<double, 6> torques{0, 0, 0, couple.x(), couple.y(), couple.z()};
    work += work_of_torques(body, before, after, torques);
    before = after;
  }
  EXPECT_NEAR(work, 0.5 * 0.3 * 4, 1e-12);
}

TEST(Work, OfTorquesBetweenBodiesCountsTheirMotionAgainstEachOther) {
  // Both turn by 0.5 rad about the same axis, the second by 0.2 more: only that is the joint's.
  Member pair = one_body(1, Vector3d::Ones());
  Body second = askew(JointType::kRevolute);
  second.parent = 0;
  second.first_dof = 6;
  pair.bodies.push_back(second);
  pair.dofs = 7;
  const auto at = [&](double root, double joint) {
    std::vector<Transform<double>> poses{{turn({0, 0, root}), Vector3d::Zero()}};
    poses.push_back(poses[0] * second.rest * Transform<double>{turn(joint * second.axis), Vector3d::Zero()});
    return poses;
  };
  const std::array<double, 7> torques{0, 0, 0, 0, 0, 0, 10};
  EXPECT_NEAR(work_of_torques(pair, at(0, 0.1), at(0.5, 0.3), torques), 2, 1e-12);
}

TEST(Work, OfAStrikeOnAFreeBodyIsTheTextbooks) {
  // Off its centre, while it moves: J·v + ½J²/m + ½(r × J)·I⁻¹(r × J).
  const Member body = one_body(2, {0.1, 0.2, 0.3});
  const std::vector<Transform<double>> at{{Eigen::Quaterniond::Identity(), {1, 2, 3}}};
  const Vector3d arm(0.5, 0, 0), impulse(1, 3, 0), speed(4, 5, 6);
  const PointImpulse struck{0, at[0].translation + arm, impulse, speed};
  const double turned = arm.cross(impulse).z();
  const double expected = impulse.dot(speed) + impulse.squaredNorm() / (2 * 2) + turned * turned / (2 * 0.3);
  EXPECT_NEAR(work_of_impulses(body, at, false, {&struck, 1}), expected, 1e-12);
  // Driven, it does not move but as it does anyhow.
  EXPECT_NEAR(work_of_impulses(body, at, true, {&struck, 1}), impulse.dot(speed), 1e-12);
}

TEST(Work, OfAStrikeOnAHingedRodIsTheTextbooks) {
  // At a distance r from the hinge the rod has the mass I/r², I its moment about the hinge. A couple of two
  // impulses turns it by their sum.
  Member rod = one_body(5, Vector3d::Ones());
  Body link = askew(JointType::kRevolute);
  link.mass = 2;
  link.axis = Vector3d::UnitY();
  link.center = {0, 0, -0.3};
  link.inertia = Vector3d(0.06, 0.06, 0.001).asDiagonal();
  link.parent = 0;
  link.first_dof = 6;
  rod.bodies.push_back(link);
  rod.dofs = 7;
  const std::vector<Transform<double>> at{kParent, kParent * link.rest};
  const Vector3d axis = at[1].rotation * link.axis, along = at[1].rotation * -Vector3d::UnitZ();
  const Vector3d across = axis.cross(along);
  const double about = 0.06 + 2 * 0.3 * 0.3;
  const auto hit = [&](double r, double impulse) {
    return PointImpulse{1, at[1].translation + r * along, impulse * across, 7 * r * across};
  };
  const PointImpulse one = hit(0.5, 3);
  EXPECT_NEAR(work_of_impulses(rod, at, true, {&one, 1}), 3 * 7 * 0.5 + 1.5 * 1.5 / (2 * about), 1e-12);
  const PointImpulse two[] = {hit(0.5, 3), hit(0.2, -2)};
  const double torque = 0.5 * 3 - 0.2 * 2;
  EXPECT_NEAR(work_of_impulses(rod, at, true, two), 7 * torque + torque * torque / (2 * about), 1e-12);
}

}  // namespace
}  // namespace sinew::audit
