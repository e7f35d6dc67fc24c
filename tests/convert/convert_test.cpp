#include "convert/convert.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>

#include "convert/options.h"
#include "convert/roles.h"

namespace sinew::convert {
namespace {

namespace fs = std::filesystem;

TEST(Convert, EverySharedAssetConvertsAndWhatMustBeRefusedIs) {
  const fs::path root = fs::path(SINEW_SHARED_DIR) / "assets";
  if (!fs::exists(root)) GTEST_SKIP() << "no ../shared here: its assets were not converted";
  std::vector<fs::path> files;
  for (const auto& entry : fs::recursive_directory_iterator(root)) {
    const std::string e = entry.path().extension().string();
    if (e == ".bvh" || e == ".fbx" || e == ".glb" || e == ".gltf" || e == ".dae" || e == ".urdf")
      files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  std::printf("%-36s %6s %6s %5s %8s %7s %6s %9s\n", "file", "joints", "bodies", "DOF", "mass kg", "height",
              "clips", "error mm");
  for (const fs::path& file : files) {
    Asset asset;
    nlohmann::json report;
    const Error error = convert_files({file.string()}, {}, asset, report);
    const std::string name = file.filename().string();
    if (file.string().find("expected_error") != std::string::npos) {
      EXPECT_TRUE(error) << name;
      EXPECT_NE(error.message.find("neck"), std::string::npos) << error.message;
      std::printf("%-36s refused: %s\n", name.c_str(),
                  error.message.substr(error.message.rfind(": ") + 2).c_str());
      continue;
    }
    ASSERT_FALSE(error) << error.message;
    EXPECT_TRUE(validate(asset.skeleton).ok()) << name;
    double worst = 0;
    if (report.contains("clips"))
      for (const auto& clip : report["clips"]) worst = std::max(worst, clip["max_error_mm"].get<double>());
    EXPECT_LE(worst, 1.0001) << name;  // the default budget
    Asset back;
    const std::vector<std::uint8_t> bytes = write_asset(asset);
    EXPECT_TRUE(read_asset(bytes, back).ok()) << name;
    std::printf("%-36s %6zu %6d %5d %8.1f %7.2f %6zu %9.3f\n", name.c_str(), asset.skeleton.joints.size(),
                asset.skeleton.body_count, asset.skeleton.dof_total(), asset.skeleton.total_mass(),
                report.value("height_m", 0.0), asset.clips.size(), worst);
  }
  EXPECT_GE(files.size(), 35u);
}

TEST(Convert, TheDemoCharacterGivesTheSameBytesTwice) {
  const std::string file = std::string(SINEW_SOURCE_DIR) + "/assets/character/mannequin.glb";
  Asset a, b;
  nlohmann::json report;
  ASSERT_FALSE(convert_files({file}, {{"total_mass", 75}}, a, report));
  EXPECT_NEAR(a.skeleton.total_mass(), 75, 1e-9);
  ASSERT_FALSE(convert_files({file}, {{"total_mass", 75}}, b, report));
  EXPECT_EQ(write_asset(a), write_asset(b));
  for (const Role role : {Role::kPelvis, Role::kChest, Role::kHead, Role::kUpperArmL, Role::kForearmR,
                          Role::kThighL, Role::kShinR, Role::kFootL})
    EXPECT_GE(a.skeleton.find(role), 0) << role_name(role);
  EXPECT_EQ(a.skeleton.joints[static_cast<std::size_t>(a.skeleton.find(Role::kShinL))].type,
            JointType::kRevolute);
}

TEST(Convert, OptionsAreCheckedByName) {
  Options options;
  EXPECT_NE(Options::parse({{"totalmass", 3}}, options).message.find("totalmass"), std::string::npos);
  EXPECT_NE(Options::parse({{"total_mass", -3}}, options).message.find("total_mass"), std::string::npos);
  EXPECT_TRUE(Options::parse({{"up", 3}}, options));
  EXPECT_TRUE(Options::parse({{"up", "w"}}, options));
  EXPECT_FALSE(Options::parse(nlohmann::json::parse(reference_options(), nullptr, true, true), options));
}

TEST(Roles, AreFoundInTheNamesOfCommonRigs) {
  const std::pair<const char*, Role> names[] = {{"mixamorig:LeftUpLeg", Role::kThighL},
                                                {"mixamorig:LeftLeg", Role::kShinL},
                                                {"mixamorig:RightForeArm", Role::kForearmR},
                                                {"mixamorig:LeftArm", Role::kUpperArmL},
                                                {"mixamorig:LeftShoulder", Role::kClavicleL},
                                                {"LeftUpLeg", Role::kThighL},
                                                {"RightFoot", Role::kFootR},
                                                {"LowerBack", Role::kSpine},
                                                {"upperarm_l", Role::kUpperArmL},
                                                {"lowerarm_r", Role::kForearmR},
                                                {"calf_l", Role::kShinL},
                                                {"thigh_r", Role::kThighR},
                                                {"upperarm.l", Role::kUpperArmL},
                                                {"lowerleg.r", Role::kShinR},
                                                {"DEF-shin.L", Role::kShinL},
                                                {"DEF-forearm.R", Role::kForearmR},
                                                {"J_Bip_L_UpperLeg", Role::kThighL},
                                                {"J_Bip_R_LowerArm", Role::kForearmR},
                                                {"Bip01 L Calf", Role::kShinL},
                                                {"Bip01 Head", Role::kHead},
                                                {"Hips", Role::kPelvis},
                                                {"LeftHandIndex1", Role::kNone},
                                                {"kneeIK.l", Role::kNone},
                                                {"handslot.r", Role::kNone}};
  for (const auto& [name, role] : names) EXPECT_EQ(role_of_name(name), role) << name;
}

}  // namespace
}  // namespace sinew::convert
