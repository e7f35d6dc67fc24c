// URDF: the project's own reader makes the same body of it.
#include "export/urdf.h"

#include <cmath>
#include <numbers>

#include "bodies.h"
#include "exported.h"

namespace sinew::exporting::test {
namespace {

Skeleton read_back(const Skeleton& skeleton, std::vector<std::string>& notes) {
  std::string text;
  const convert::Error error = write_urdf(skeleton, text, notes);
  EXPECT_FALSE(error) << error.message;
  return converted(written("body.urdf", text)).skeleton;
}

Skeleton read_back(const Skeleton& skeleton) {
  std::vector<std::string> notes;
  return read_back(skeleton, notes);
}

const Joint& named(const Skeleton& s, const std::string& name) {
  const int found = s.find(name.c_str());
  if (found < 0) throw std::runtime_error("no joint '" + name + "'");
  return s.joints[static_cast<std::size_t>(found)];
}

/// To rounding of angles: rotations go through roll, pitch and yaw.
void expect_same_joint(const Joint& a, const Joint& b) {
  EXPECT_EQ(a.type, b.type) << a.name;
  EXPECT_EQ(a.source_joint, b.source_joint) << a.name;
  EXPECT_LT((a.rest.translation - b.rest.translation).norm(), 1e-15) << a.name;
  EXPECT_LT(a.rest.rotation.angularDistance(b.rest.rotation), 1e-12) << a.name;
  if (dof_count(a.type) == 1 || a.type == JointType::kPlanar) {
    EXPECT_LT((a.axis - b.axis).norm(), 1e-15) << a.name;
  }
  EXPECT_EQ(a.mass, b.mass) << a.name;
  EXPECT_EQ(a.center_of_mass, b.center_of_mass) << a.name;
  EXPECT_LT((a.inertia - b.inertia).norm(), 1e-15 * (1 + a.inertia.norm())) << a.name;
  for (int k = 0; k < dof_count(a.type); ++k) EXPECT_EQ(a.dofs[k], b.dofs[k]) << a.name;
}

std::vector<Collider> of_joint(const Skeleton& s, const std::string& name) {
  std::vector<Collider> found;
  for (const Collider& c : s.colliders)
    if (s.joints[static_cast<std::size_t>(c.joint)].name == name) found.push_back(c);
  return found;
}

void expect_same_body(const Skeleton& a, const Skeleton& b) {
  ASSERT_EQ(a.joints.size(), b.joints.size());
  for (const Joint& joint : a.joints) {
    const Joint& other = named(b, joint.name);
    expect_same_joint(joint, other);
    if (joint.parent >= 0) {
      EXPECT_EQ(a.joints[static_cast<std::size_t>(joint.parent)].name,
                b.joints[static_cast<std::size_t>(other.parent)].name);
    }
    const std::vector<Collider> ours = of_joint(a, joint.name), theirs = of_joint(b, joint.name);
    ASSERT_EQ(ours.size(), theirs.size()) << joint.name;
    for (std::size_t c = 0; c < ours.size(); ++c) {
      EXPECT_EQ(ours[c].shape, theirs[c].shape);
      EXPECT_LT((ours[c].size - theirs[c].size).norm(), 1e-15) << joint.name;
      EXPECT_LT((ours[c].local.translation - theirs[c].local.translation).norm(), 1e-15) << joint.name;
      EXPECT_LT(ours[c].local.rotation.angularDistance(theirs[c].local.rotation), 1e-12) << joint.name;
    }
  }
}

/// Of every degree of freedom of `a`, the one of `b` that stands for it. What became several joints has links
/// named after its axes in front of it.
std::vector<int> same_dofs(const Skeleton& a, const Skeleton& b) {
  std::map<std::string, int> first;
  int dof = 0;
  for (int i = 0; i < b.body_count; ++i) {
    const Joint& joint = b.joints[static_cast<std::size_t>(i)];
    first[joint.name] = dof;
    dof += dof_count(joint.type);
  }
  std::vector<int> found;
  for (int i = 0; i < a.body_count; ++i) {
    const Joint& joint = a.joints[static_cast<std::size_t>(i)];
    std::vector<std::string> axes;
    if (joint.type == JointType::kUniversal) axes = {"_1_axis", ""};
    if (joint.type == JointType::kBall || joint.type == JointType::kTranslation)
      axes = {"_x_axis", "_y_axis", ""};
    for (const std::string& axis : axes) found.push_back(first.at(joint.name + axis));
    for (int k = 0; k < dof_count(joint.type) && axes.empty(); ++k) found.push_back(first.at(joint.name) + k);
  }
  return found;
}

void expect_same_mass_matrix_at_rest(const Skeleton& a, const Skeleton& b) {
  const auto at_rest = [](const Skeleton& s) {
    return evaluate_dynamics(s, std::vector<JointState>(static_cast<std::size_t>(s.body_count)),
                             {0, 0, -9.81});
  };
  ASSERT_EQ(a.dof_total(), b.dof_total());
  const DynamicsResult ours = at_rest(a), theirs = at_rest(b);
  const std::vector<int> dofs = same_dofs(a, b);
  const double largest = ours.mass_matrix.cwiseAbs().maxCoeff();
  for (std::size_t k = 0; k < dofs.size(); ++k) {
    const auto row = static_cast<Eigen::Index>(k);
    EXPECT_NEAR(ours.inverse_dynamics[row], theirs.inverse_dynamics[dofs[k]], 1e-9 * 9.81 * largest);
    for (std::size_t l = 0; l < dofs.size(); ++l)
      EXPECT_NEAR(ours.mass_matrix(row, static_cast<Eigen::Index>(l)), theirs.mass_matrix(dofs[k], dofs[l]),
                  1e-9 * largest);
  }
}

TEST(UrdfExport, JointsThatUrdfLacksBecomeSeveralThatMoveTheSameMass) {
  const Skeleton s = chain_of_all_joints(JointType::kFree);
  std::vector<std::string> notes;
  const Skeleton back = read_back(s, notes);
  expect_same_mass_matrix_at_rest(s, back);
  EXPECT_EQ(named(back, "part 1").dofs[0].torque_plus, 16);  // the larger, with the muscle beside it
  EXPECT_EQ(named(back, "part 3").source_joint, "part 3_z");
  EXPECT_EQ(named(back, "part 2_1_axis").mass, 0);
  EXPECT_EQ(named(back, "finger").type, JointType::kFixed);
  std::string all;
  for (const std::string& note : notes) all += note + "\n";
  EXPECT_NE(all.find("differ by direction: the larger is the effort (part 1)"), std::string::npos) << all;
  EXPECT_NE(all.find("bounds each of its axes (part 3"), std::string::npos) << all;
}

TEST(UrdfExport, BoltedRootHangsOnTheWorld) {
  const Skeleton s = chain_of_all_joints(JointType::kFixed), back = read_back(s);
  EXPECT_EQ(back.joints[0].name, "world");
  EXPECT_EQ(back.joints[0].type, JointType::kFixed);
  expect_same_mass_matrix_at_rest(s, back);
}

TEST(UrdfExport, OnlyABoltedRootIsCalledWorld) {
  Skeleton s = chain_of_all_joints(JointType::kFixed);
  s.joints[0].name = "world";
  EXPECT_EQ(read_back(s).joints.size(), read_back(chain_of_all_joints(JointType::kFixed)).joints.size() - 1);
  s.joints[0].type = JointType::kFree;
  const Skeleton free = read_back(s);
  EXPECT_EQ(free.joints[0].name, "world_2");
  EXPECT_EQ(free.joints[0].type, JointType::kFree);
}

TEST(UrdfExport, CharacterMovesTheSameMass) {
  const Skeleton s = mannequin().skeleton, back = read_back(s);
  expect_same_mass_matrix_at_rest(s, back);
  EXPECT_EQ(back.colliders.size(), s.colliders.size());
  EXPECT_NEAR(back.total_mass(), s.total_mass(), 1e-12);
}

/// Where the pitch is a quarter turn, roll and yaw are one turn; close to it they tell each other apart
/// badly.
TEST(UrdfExport, TurnsOfAQuarterAreKept) {
  Skeleton s = chain_of_all_joints(JointType::kFree);
  for (const double off : {0.0, 1e-9, 1e-6, 1e-3})
    for (const double sign : {-1.0, 1.0})
      for (const double roll : {-2.0, 0.0, 0.7}) {
        s.joints[1].rest.rotation =
            Quat<double>(Eigen::AngleAxisd(0.4, Vec3<double>::UnitZ()) *
                         Eigen::AngleAxisd(sign * (std::numbers::pi / 2 - off), Vec3<double>::UnitY()) *
                         Eigen::AngleAxisd(roll, Vec3<double>::UnitX()));
        EXPECT_LT(s.joints[1].rest.rotation.angularDistance(named(read_back(s), "part 1").rest.rotation),
                  1e-7)
            << off << " " << roll;
      }
}

TEST(UrdfExport, SeveralRootsAreRefused) {
  Skeleton s = chain_of_all_joints(JointType::kFree);
  s.joints[4].parent = -1;
  std::string text;
  std::vector<std::string> notes;
  EXPECT_NE(write_urdf(s, text, notes).message.find("2 roots"), std::string::npos);
}

class ForeignRobot : public testing::TestWithParam<const char*> {};

TEST_P(ForeignRobot, IsReadBackAsItWas) {
  const std::string path = shared_asset(GetParam());
  if (!std::filesystem::exists(path))
    GTEST_SKIP() << "no ../shared here: " << GetParam() << " was not exported";
  const Skeleton s = converted(path).skeleton;
  expect_same_body(s, read_back(s));
}

INSTANTIATE_TEST_SUITE_P(Files, ForeignRobot,
                         testing::Values("urdf/bullet_humanoid.urdf", "urdf/bullet_quadruped.urdf",
                                         "urdf/panda.urdf", "urdf/romeo.urdf",
                                         "urdf/simple_humanoid_classical.urdf", "urdf/solo12.urdf",
                                         "urdf/unitree_g1_29dof.urdf", "urdf/unitree_h1.urdf"));

}  // namespace
}  // namespace sinew::exporting::test
