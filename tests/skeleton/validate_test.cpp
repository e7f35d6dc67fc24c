// validate() must name each fault that an importer, an editor or a file can produce.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <string>

#include "fixtures/humanoid.h"
#include "sinew/skeleton/skeleton.h"

namespace sinew {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

TEST(Validate, AcceptsTheHumanoid) {
  const Status status = validate(fixtures::humanoid());
  EXPECT_TRUE(status.ok()) << status.reason << " at joint " << status.index;
}

TEST(Validate, AcceptsMasslessJointWithHeavyChild) {
  Skeleton s = fixtures::humanoid();
  s.joints[1].mass = 0;
  s.joints[1].inertia.setZero();
  EXPECT_TRUE(validate(s).ok());
}

TEST(Validate, AcceptsRodsAndPlates) {
  Skeleton s = fixtures::humanoid();
  s.joints[2].inertia = Vec3<double>(1, 1, 0).asDiagonal();  // all mass on a line
  s.joints[3].inertia = Vec3<double>(1, 1, 2).asDiagonal();  // all mass in a plane
  EXPECT_TRUE(validate(s).ok());
}

struct Fault {
  const char* name;
  std::function<void(Skeleton&)> apply;
  Code code;
  int index;  ///< joint that must be named
};

class BrokenSkeleton : public testing::TestWithParam<Fault> {};

TEST_P(BrokenSkeleton, IsRefusedWithItsJointAndReason) {
  Skeleton s = fixtures::humanoid();
  GetParam().apply(s);
  const Status status = validate(s);
  EXPECT_FALSE(status.ok());
  EXPECT_EQ(status.code, GetParam().code) << status.reason;
  EXPECT_EQ(status.index, GetParam().index) << status.reason;
  EXPECT_FALSE(std::string(status.reason).empty());
}

std::vector<Fault> faults() {
  const Code invalid = Code::kInvalidArgument, not_finite = Code::kNotFinite;
  return {
      {"NoJoints", [](Skeleton& s) { s.joints.clear(); }, invalid, -1},
      {"NoBodies", [](Skeleton& s) { s.body_count = 0; }, invalid, -1},
      {"MoreBodiesThanJoints", [](Skeleton& s) { s.body_count = 15; }, invalid, -1},
      {"ParentAfterChild", [](Skeleton& s) { s.joints[3].parent = 4; }, invalid, 3},
      {"OwnParent", [](Skeleton& s) { s.joints[3].parent = 3; }, invalid, 3},
      {"ParentBelowMinusOne", [](Skeleton& s) { s.joints[3].parent = -2; }, invalid, 3},
      {"RestTranslationNan", [](Skeleton& s) { s.joints[5].rest.translation.y() = kNan; }, not_finite, 5},
      {"RestRotationNotUnit", [](Skeleton& s) { s.joints[5].rest.rotation.w() = 2; }, not_finite, 5},
      {"RideAlongWithMass", [](Skeleton& s) { s.body_count = 13; }, invalid, 13},
      {"SimulatedBelowRideAlong",
       [](Skeleton& s) {
         s.joints[13].mass = 0;
         s.joints[13].parent = 12;
         s.body_count = 12;
         s.joints[12].mass = 0;
         s.joints[11].parent = 12;
       },
       invalid, 11},
      {"AxisTooLong", [](Skeleton& s) { s.joints[3].axis *= 1.1; }, invalid, 3},
      {"SecondAxisZero", [](Skeleton& s) { s.joints[3].axis2.setZero(); }, invalid, 3},
      {"SwingAxisNan", [](Skeleton& s) { s.joints[3].swing_axis.x() = kNan; }, invalid, 3},
      {"MassInfinite", [](Skeleton& s) { s.joints[6].mass = kInfinity; }, not_finite, 6},
      {"MassNegative", [](Skeleton& s) { s.joints[6].mass = -1; }, invalid, 6},
      {"CenterOfMassNan", [](Skeleton& s) { s.joints[6].center_of_mass.z() = kNan; }, not_finite, 6},
      {"InertiaNan", [](Skeleton& s) { s.joints[6].inertia(0, 1) = kNan; }, not_finite, 6},
      {"InertiaUnsymmetric", [](Skeleton& s) { s.joints[6].inertia(0, 1) += 0.01; }, invalid, 6},
      {"InertiaNegative", [](Skeleton& s) { s.joints[6].inertia = Vec3<double>(-0.1, 1, 1).asDiagonal(); },
       invalid, 6},
      {"InertiaBreaksTriangleInequality",
       [](Skeleton& s) { s.joints[6].inertia = Vec3<double>(1, 1, 2.01).asDiagonal(); }, invalid, 6},
      {"LimitNan", [](Skeleton& s) { s.joints[3].dofs[0].upper = kNan; }, not_finite, 3},
      {"LimitsCrossed",
       [](Skeleton& s) {
         s.joints[2].dofs[2].lower = 1;
         s.joints[2].dofs[2].upper = 0.5;
       },
       invalid, 2},
      {"MuscleNan", [](Skeleton& s) { s.joints[2].dofs[1].torque_plus = kNan; }, not_finite, 2},
      {"MuscleNegative", [](Skeleton& s) { s.joints[2].dofs[1].torque_minus = -1; }, invalid, 2},
      {"DampingNegative", [](Skeleton& s) { s.joints[2].dofs[0].damping = -1; }, invalid, 2},
      {"DryFrictionNegative", [](Skeleton& s) { s.joints[2].dofs[0].dry_friction = -1; }, invalid, 2},
      {"JointMovesNoMass",
       [](Skeleton& s) {
         s.joints[13].mass = 0;
         s.joints[13].inertia.setZero();
       },
       invalid, 13},
      {"ColliderWithoutJoint", [](Skeleton& s) { s.colliders[4].joint = 14; }, invalid, 14},
      {"ColliderSizeNegative", [](Skeleton& s) { s.colliders[4].size.x() = -0.1; }, invalid, 4},
      {"ColliderPlaceNan", [](Skeleton& s) { s.colliders[4].local.translation.x() = kNan; }, invalid, 4},
      {"ColliderFrictionNegative", [](Skeleton& s) { s.colliders[4].friction = -0.1; }, invalid, 4},
      {"SwingLimitNan", [](Skeleton& s) { s.joints[2].swing_limit = kNan; }, not_finite, 2},
      {"TwistLimitNan", [](Skeleton& s) { s.joints[2].twist_upper = kNan; }, not_finite, 2},
      {"TwistLimitsCrossed",
       [](Skeleton& s) {
         s.joints[2].swing_limit = 1;
         s.joints[2].twist_lower = 0.5;
         s.joints[2].twist_upper = -0.5;
       },
       invalid, 2},
      {"EllipsoidOfAHinge", [](Skeleton& s) { s.joints[3].ellipsoidal_limit = true; }, invalid, 3},
      {"MuscleOfNoJoint",
       [](Skeleton& s) {
         s.muscles.push_back({"m", "", 14, 0, 1, 1});
       },
       invalid, 14},
      {"MuscleOfNoFreedom",
       [](Skeleton& s) {
         s.muscles.push_back({"m", "", 3, 1, 1, 1});
       },
       invalid, 3},
      {"MuscleOnTheFreeRoot",
       [](Skeleton& s) {
         s.muscles.push_back({"m", "", 0, 0, 1, 1});
       },
       invalid, 0},
      {"AddedMuscleNan",
       [](Skeleton& s) {
         s.muscles.push_back({"m", "", 2, 0, 1, kNan});
       },
       invalid, 2},
      {"UniversalAxesNotSquare",
       [](Skeleton& s) {
         s.joints[3].type = JointType::kUniversal;
         s.joints[3].axis2 = Vec3<double>(1, 1, 0).normalized();
       },
       invalid, 3},
  };
}

INSTANTIATE_TEST_SUITE_P(Faults, BrokenSkeleton, testing::ValuesIn(faults()),
                         [](const auto& fault) { return fault.param.name; });

TEST(Skeleton, FindsJointsByNameAndRole) {
  Skeleton s = fixtures::humanoid();
  s.joints[3].role = Role::kShinL;
  EXPECT_EQ(s.find("shin_l"), 3);
  EXPECT_EQ(s.find("tail"), -1);
  EXPECT_EQ(s.find(Role::kShinL), 3);
  EXPECT_EQ(s.find(Role::kHead), -1);
}

TEST(Skeleton, CountsTheSeedTalksHumanoid) {
  const Skeleton s = fixtures::humanoid();
  EXPECT_EQ(s.dof_total(), 37);
  EXPECT_NEAR(s.total_mass(), 75.4, 1e-9);
}

}  // namespace
}  // namespace sinew
