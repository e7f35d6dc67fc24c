// The physical body: volumes, masses, strengths.
#include "convert/body.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "convert/human.h"
#include "convert/muscles.h"
#include "convert/volume.h"
#include "fixtures/paths.h"
#include "sinew/skeleton/principal_axes.h"

namespace sinew::convert {
namespace {

/// An axis-aligned closed box as a mesh; `open` leaves out its upper lid.
Mesh box(const Vec3<double>& low, const Vec3<double>& high, bool open = false) {
  Mesh mesh;
  for (int corner = 0; corner < 8; ++corner)
    for (int k = 0; k < 3; ++k)
      mesh.positions.push_back(static_cast<float>(corner & (1 << k) ? high[k] : low[k]));
  mesh.indices = {0, 2, 1, 1, 2, 3, 0, 1, 4, 1, 5, 4, 2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5};
  if (!open) mesh.indices.insert(mesh.indices.end(), {4, 5, 6, 5, 7, 6});
  return mesh;
}

// Cells are 1/128 of the longest side; faces fall within half a cell of where they are counted.
TEST(Volume, OfABoxWithItsCentreAndInertia) {
  const Vec3<double> low(0.1, -0.2, 0.3), high(0.5, 0.1, 1.1), size = high - low;
  const std::vector<Mesh> meshes{box(low, high)};
  const Solid solid = part_solids(meshes, {std::vector<int>(8, 0)}, 1)[0];
  EXPECT_NEAR(solid.volume, size.prod(), 0.03 * size.prod());
  EXPECT_LT((solid.center - (low + high) / 2).norm(), 0.8 / 128);
  const Mat3<double> inertia = inertia_of(solid, 2);
  const Vec3<double> q = size.cwiseProduct(size) * (2.0 / 12);
  EXPECT_NEAR(inertia(0, 0), q.y() + q.z(), 0.03 * (q.y() + q.z()));
  EXPECT_NEAR(inertia(2, 2), q.x() + q.y(), 0.03 * (q.x() + q.y()));
}

TEST(Volume, OverlappingShellsCountOnceAndALidMayBeMissing) {
  const Vec3<double> low(0, 0, 0), high(0.4, 0.3, 1);
  const double expected = 0.4 * 0.3;
  const std::vector<std::vector<int>> both(2, std::vector<int>(8, 0));
  EXPECT_NEAR(part_solids(std::vector<Mesh>{box(low, high), box(low, high)}, both, 1)[0].volume, expected,
              0.03 * expected);
  EXPECT_NEAR(part_solids(std::vector<Mesh>{box(low, high, true)}, {std::vector<int>(8, 0)}, 1)[0].volume,
              expected, 0.03 * expected);
}

TEST(Volume, IsSharedBetweenPartsByTheNearestVertex) {
  // The lower four corners follow part 0, the upper four part 1: the cut is half way up.
  const std::vector<Solid> solids =
      part_solids(std::vector<Mesh>{box({0, 0, 0}, {0.3, 0.3, 1})}, {{0, 0, 0, 0, 1, 1, 1, 1}}, 2);
  EXPECT_NEAR(solids[0].volume, solids[1].volume, 0.03 * solids[0].volume);
  EXPECT_NEAR(solids[0].center.z(), 0.25, 0.01);
  EXPECT_NEAR(solids[1].center.z(), 0.75, 0.01);
}

TEST(Body, MannequinsPartsWeighWhatHumanPartsDo) {
  Asset asset;
  nlohmann::json report;
  const std::string file = source_dir() + "/assets/character/mannequin.glb";
  ASSERT_FALSE(convert_files({file}, {{"total_mass", 75}}, asset, report));
  const Skeleton& s = asset.skeleton;
  const auto share = [&](std::initializer_list<Role> roles) {
    double sum = 0;
    for (const Joint& joint : s.joints)
      for (const Role role : roles)
        if (joint.role == role) sum += joint.mass;
    return sum / s.total_mass();
  };
  // de Leva's, Winter's and Dumas' tables lie within a third of each other: thigh 10–14.2 %, trunk 43–50 %.
  EXPECT_NEAR(share({Role::kThighL}), 0.12, 0.04);
  EXPECT_NEAR(share({Role::kShinL}), 0.046, 0.015);
  EXPECT_NEAR(share({Role::kFootL, Role::kToesL}), 0.014, 0.005);
  EXPECT_NEAR(share({Role::kHead, Role::kNeck}), 0.072, 0.02);
  EXPECT_NEAR(share({Role::kPelvis, Role::kSpine, Role::kChest, Role::kClavicleL, Role::kClavicleR}), 0.46,
              0.06);
  for (const Joint& joint : s.joints) {
    if (joint.mass <= 0) continue;
    const Vec3<double> principal = principal_axes(joint.inertia).values;
    EXPECT_GT(principal[0] + principal[1], principal[2]) << joint.name;
  }
}

// The mannequin's hands are mittens to its body and have fingers in pictures.
TEST(Body, IsFittedToTheMeshThatIsNotDrawn) {
  namespace fs = std::filesystem;
  const std::string file = source_dir() + "/assets/character/mannequin.glb";
  std::ifstream in(file, std::ios::binary);
  std::string bytes((std::istreambuf_iterator<char>(in)), std::istreambuf_iterator<char>());
  const auto converted = [&](const std::string& name, const std::string& instead, Asset& asset) {
    for (std::size_t at = 0; (at = bytes.find(name, at)) != std::string::npos; at += instead.size())
      bytes.replace(at, name.size(), instead);
    const std::string renamed = (fs::temp_directory_path() / "sinew_not_drawn.glb").string();
    std::ofstream(renamed, std::ios::binary) << bytes;
    nlohmann::json report;
    ASSERT_FALSE(convert_files({renamed}, {{"clips", {"stand"}}}, asset, report));
    fs::remove(renamed);
  };
  Asset both, drawn;
  converted("UCX_body", "UCX_body", both);
  converted("UCX_body", "old_body", drawn);
  ASSERT_EQ(both.meshes.size(), 1u);
  EXPECT_EQ(both.meshes[0].name, "body");
  ASSERT_EQ(drawn.meshes.size(), 2u);
  EXPECT_GT(both.meshes[0].positions.size(), drawn.meshes[1].positions.size());
  const int hand = both.skeleton.find("hand_l");
  ASSERT_GE(hand, 0);
  const auto mass = [&](const Asset& a) { return a.skeleton.joints[std::size_t(hand)].mass; };
  EXPECT_NE(mass(both), mass(drawn)) << "fingers weigh, too, where they are of the body";
}

TEST(Body, ADollHasHumanDensityAndAChildIsSlight) {
  EXPECT_NEAR(mass_from_height(1.75, {}), 68.9, 0.1);
  EXPECT_NEAR(mass_from_height(0.7, {}) / mass_from_height(1.4, {}), 0.125, 1e-12);
  EXPECT_LT(mass_from_height(1.38, {false, 10}), 35);
}

TEST(Body, SharesOfASkinlessHumanAddUpToOne) {
  double sum = 0;
  for (const Role role :
       {Role::kPelvis,    Role::kSpine,     Role::kChest,     Role::kNeck,      Role::kHead,
        Role::kClavicleL, Role::kClavicleR, Role::kUpperArmL, Role::kUpperArmR, Role::kForearmL,
        Role::kForearmR,  Role::kHandL,     Role::kHandR,     Role::kThighL,    Role::kThighR,
        Role::kShinL,     Role::kShinR,     Role::kFootL,     Role::kFootR,     Role::kToesL,
        Role::kToesR})
    sum += mass_share(role, {});
  EXPECT_NEAR(sum, 1, 1e-3);  // the table's own rounding
}

Joint ball() {
  Joint joint;
  joint.type = JointType::kBall;
  return joint;
}

TEST(Muscles, OfTheHipDifferByDirectionAndMirrorSides) {
  const auto rows = muscle_rows({});
  const Quat<double> rest = Quat<double>::Identity();
  AnatomicalAxes axes;
  Joint left = ball(), right = ball();
  ASSERT_TRUE(anatomical_axes(Role::kThighL, -Vec3<double>::UnitZ(), rest, axes));
  set_muscles(axes, rows, 75, left);
  ASSERT_TRUE(anatomical_axes(Role::kThighR, -Vec3<double>::UnitZ(), rest, axes));
  set_muscles(axes, rows, 75, right);
  // About y (to the left): positive swings the thigh back.
  EXPECT_NEAR(left.dofs[1].torque_plus, 75 * rows.at("hip_extension"), 1e-9);
  EXPECT_NEAR(left.dofs[1].torque_minus, 75 * rows.at("hip_flexion"), 1e-9);
  // About x (forward): positive lifts the left thigh away to the left, the right one across.
  EXPECT_NEAR(left.dofs[0].torque_plus, 75 * rows.at("hip_abduction"), 1e-9);
  EXPECT_NEAR(right.dofs[0].torque_plus, 75 * rows.at("hip_adduction"), 1e-9);
}

TEST(Muscles, AreTheSameForARigWithOtherBoneAxes) {
  const auto rows = muscle_rows({});
  AnatomicalAxes axes;
  Joint straight = ball(), turned = ball();
  ASSERT_TRUE(anatomical_axes(Role::kFootR, Vec3<double>::UnitX(), Quat<double>::Identity(), axes));
  set_muscles(axes, rows, 75, straight);
  // This rig's foot has its own x where the model's y is.
  const Quat<double> rest(Eigen::AngleAxisd(std::acos(0.0), Vec3<double>::UnitZ()));
  ASSERT_TRUE(anatomical_axes(Role::kFootR, Vec3<double>::UnitX(), rest, axes));
  set_muscles(axes, rows, 75, turned);
  EXPECT_NEAR(turned.dofs[0].torque_plus, straight.dofs[1].torque_plus, 1e-9);
  EXPECT_NEAR(turned.dofs[0].torque_minus, straight.dofs[1].torque_minus, 1e-9);
  // Half way between two axes the limit lies between theirs.
  const Quat<double> half(Eigen::AngleAxisd(std::acos(0.0) / 2, Vec3<double>::UnitZ()));
  ASSERT_TRUE(anatomical_axes(Role::kFootR, Vec3<double>::UnitX(), half, axes));
  set_muscles(axes, rows, 75, turned);
  EXPECT_GT(turned.dofs[0].torque_plus, straight.dofs[0].torque_plus);
  EXPECT_LT(turned.dofs[0].torque_plus, straight.dofs[1].torque_plus);
}

TEST(Muscles, OfAnElbowBendStrongerThanTheyStretchInAnyRestPose) {
  const auto rows = muscle_rows({});
  for (const Vec3<double>& bone :
       {Vec3<double>(0, 1, 0), Vec3<double>(0, 0.7, -0.7), Vec3<double>(0, 0.1, -1)}) {
    AnatomicalAxes axes;
    ASSERT_TRUE(anatomical_axes(Role::kForearmL, bone.normalized(), Quat<double>::Identity(), axes));
    Joint elbow;
    elbow.type = JointType::kRevolute;
    elbow.axis = -axes.axes.col(1);
    // Flexion brings the hand forward.
    const Vec3<double> bent = Eigen::AngleAxisd(1.0, elbow.axis) * bone.normalized();
    EXPECT_GT(bent.x(), 0.5);
    set_muscles(axes, rows, 1, elbow);
    EXPECT_NEAR(elbow.dofs[0].torque_plus, rows.at("elbow_flexion"), 1e-12);
    EXPECT_NEAR(elbow.dofs[0].torque_minus, rows.at("elbow_extension"), 1e-12);
  }
}

TEST(Muscles, OfWomenChildrenAndTheOldAreWeaker) {
  const double adult = muscle_rows({}).at("knee_extension");
  EXPECT_LT(muscle_rows({true, 0}).at("knee_extension"), adult);
  EXPECT_NEAR(muscle_rows({false, 10}).at("knee_extension"), 0.75 * adult, 1e-12);
  EXPECT_NEAR(muscle_rows({false, 75}).at("knee_extension"), 0.6 * adult, 1e-12);
}

TEST(Muscles, AreNotRaisedByWhatAMarkersJumpAsksForAFrameOrTwo) {
  const std::string bvh = "/usr/share/assimp/models/BVH/01_01.bvh";
  if (!std::filesystem::exists(bvh)) GTEST_SKIP() << "assimp-testmodels is not installed";
  Asset asset;
  nlohmann::json report;
  ASSERT_FALSE(convert_files({bvh}, {}, asset, report));
  const auto strongest = [&](Role role) {
    const Joint& joint = asset.skeleton.joints[static_cast<std::size_t>(asset.skeleton.find(role))];
    double most = 0;
    for (int k = 0; k < dof_count(joint.type); ++k)
      most = std::max({most, joint.dofs[k].torque_minus, joint.dofs[k].torque_plus});
    return most / asset.skeleton.total_mass();
  };
  // Published maxima are 1.3 and 0.7 N·m/kg. A frame of this capture asks ten times as much of the left
  // shoulder as the frames around it, and its T-pose in front asked 50; the margin is 1.5.
  EXPECT_LT(strongest(Role::kUpperArmL), 3);
  EXPECT_LT(strongest(Role::kUpperArmR), 3);
  EXPECT_LT(strongest(Role::kHead), 1.5);
  EXPECT_NE(report["notes"].dump().find("reference pose"), std::string::npos);
  // The T-pose is left out, the frame after it stays.
  EXPECT_NEAR(asset.clips[0].duration, 2750 / 120.0, 0.01);
}

TEST(Body, OptionsOverrideMassesAndTorquesByNameOrRole) {
  Asset asset;
  nlohmann::json report;
  const std::string file = source_dir() + "/assets/character/mannequin.glb";
  const nlohmann::json options = {
      {"total_mass", 75},
      {"muscles", {{"neck_rotation", 9}}},
      {"joints",
       {{"head", {{"mass", 6}}}, {"thigh_l", {{"torque", {11, 22}}, {"swing", 40}, {"ellipsoid", true}}}}}};
  ASSERT_FALSE(convert_files({file}, options, asset, report));
  const Skeleton& s = asset.skeleton;
  const Joint& head = s.joints[static_cast<std::size_t>(s.find(Role::kHead))];
  const Joint& thigh = s.joints[static_cast<std::size_t>(s.find(Role::kThighL))];
  EXPECT_NEAR(head.mass, 6, 1e-12);
  EXPECT_NEAR(s.total_mass(), 75, 1e-9);
  EXPECT_GT(std::max({head.dofs[0].torque_plus, head.dofs[1].torque_plus, head.dofs[2].torque_plus}), 9 * 70);
  EXPECT_EQ(thigh.dofs[1].torque_minus, 11);
  EXPECT_EQ(thigh.dofs[1].torque_plus, 22);
  EXPECT_NEAR(thigh.swing_limit, 40 * std::acos(-1.0) / 180, 1e-12);
  EXPECT_TRUE(thigh.ellipsoidal_limit);
  const Error unknown = convert_files({file}, {{"joints", {{"tail", {{"mass", 1}}}}}}, asset, report);
  EXPECT_NE(unknown.message.find("tail"), std::string::npos);
  const Error row = convert_files({file}, {{"muscles", {{"biceps", 1}}}}, asset, report);
  EXPECT_NE(row.message.find("biceps"), std::string::npos);
}

}  // namespace
}  // namespace sinew::convert
