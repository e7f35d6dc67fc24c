#include "convert/convert.h"

#include <gtest/gtest.h>

#include "convert/options.h"
#include "convert/roles.h"
#include "fixtures/paths.h"

namespace sinew::convert {
namespace {

TEST(Convert, TheDemoCharacterGivesTheSameBytesTwice) {
  const std::string file = source_dir() + "/assets/character/mannequin.glb";
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
  EXPECT_EQ(Options::parse({{"up", 3}}, options).message.rfind("option 'up' has the wrong type", 0), 0u);
  const auto joint = nlohmann::json::parse(R"({"joints": {"head": {"mass": "5"}}})");
  EXPECT_EQ(Options::parse(joint, options).message.rfind("option 'joints.head' has the wrong type", 0), 0u);
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
