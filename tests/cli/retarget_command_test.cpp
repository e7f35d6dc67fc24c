// `sinew retarget` as a user runs it, and what `sinew convert` says of clips for another skeleton.
#include <nlohmann/json.hpp>

#include "cli/command.h"
#include "fixtures/paths.h"

namespace sinew::test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

const std::string kMannequin = source_dir() + "/assets/character/mannequin.glb";

/// The mannequin at half its size.
std::string small() {
  const std::string path = own_directory() + "small.sinew";
  if (!fs::exists(path)) sinew("convert " + kMannequin + " --unit 0.5 -o " + path);
  return path;
}

TEST(RetargetCommand, WritesTheTargetWithTheClipsAndReportsThem) {
  const std::string out = own_directory() + "walks.sinew", report = own_directory() + "report.json";
  const Outcome run = sinew("retarget " + kMannequin + " --to " + small() + " --clip walk --time froude -o " +
                            out + " --report " + report);
  ASSERT_EQ(run.code, 0) << run.out;
  EXPECT_NE(run.out.find("thigh_l: thigh_l -> thigh_l"), std::string::npos) << run.out;
  EXPECT_NE(run.out.find("soles"), std::string::npos) << run.out;
  const json made = json::parse(bytes_of(report))["sources"][0];
  EXPECT_NEAR(made["scale"].get<double>(), 0.5, 1e-6);
  EXPECT_EQ(made["clips"].size(), 1u);
  const Outcome info = sinew("info " + out + " --json");
  ASSERT_EQ(info.code, 0) << info.out;
  EXPECT_EQ(json::parse(info.out)["clips"].size(), 1u);
}

TEST(RetargetCommand, TakesTheClipsOwnCharacterFromAnotherFile) {
  const std::string out = own_directory() + "from.sinew", clips = own_directory() + "clips.sinew";
  ASSERT_EQ(sinew("convert " + kMannequin + " -o " + clips).code, 0);
  EXPECT_EQ(
      sinew("retarget " + clips + " --from " + kMannequin + " --to " + small() + " --clip walk -o " + out)
          .code,
      0);
  expect_refused(
      "retarget " + small() + " --from " + written("x.glb", "no model") + " --to " + small() + " -o " + out,
      "x.glb");
}

TEST(RetargetCommand, BadInputIsNamedInOneLine) {
  const std::string out = own_directory() + "never.sinew", to = " --to " + small() + " -o " + out;
  expect_refused("retarget /no/such.glb" + to, "/no/such.glb");
  expect_refused("retarget " + written("text.bvh", "hello") + to, "text.bvh");
  expect_refused("retarget " + kMannequin + " --to /no/such.glb -o " + out, "/no/such.glb");
  expect_refused("retarget " + kMannequin + to + " --clip swim", "no clip 'swim'");
  expect_refused("retarget " + kMannequin + to + " --map " + written("map.json", "{\"legs\": {}}"), "'legs'");
  expect_refused("retarget " + kMannequin + to + " --map " + written("map.json", "{"), "map.json");
  const std::string robot =
      written("box.urdf", R"(<robot name="box"><link name="box"><inertial><mass value="1"/>
      <inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link></robot>)");
  expect_refused("retarget " + kMannequin + " --to " + robot + " -o " + out, "box.urdf");
  EXPECT_FALSE(fs::exists(out));
  EXPECT_EQ(sinew("retarget " + kMannequin + to + " --time warp").code, 2);
  EXPECT_EQ(sinew("retarget").code, 2);
}

TEST(RetargetCommand, ConvertSaysHowClipsOfAnotherSkeletonAreFittedAndDoesItWhenAsked) {
  // Two legs on other joints' names: a BVH of four frames.
  const std::string other = written("other.bvh", R"(HIERARCHY
ROOT Hips
{
  OFFSET 0 90 0
  CHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation
  JOINT LeftUpLeg
  {
    OFFSET 10 0 0
    CHANNELS 3 Zrotation Xrotation Yrotation
    JOINT LeftLeg
    {
      OFFSET 0 -42 0
      CHANNELS 3 Zrotation Xrotation Yrotation
      JOINT LeftFoot
      {
        OFFSET 0 -42 0
        CHANNELS 3 Zrotation Xrotation Yrotation
        End Site
        {
          OFFSET 0 -6 16
        }
      }
    }
  }
  JOINT RightUpLeg
  {
    OFFSET -10 0 0
    CHANNELS 3 Zrotation Xrotation Yrotation
    JOINT RightLeg
    {
      OFFSET 0 -42 0
      CHANNELS 3 Zrotation Xrotation Yrotation
      JOINT RightFoot
      {
        OFFSET 0 -42 0
        CHANNELS 3 Zrotation Xrotation Yrotation
        End Site
        {
          OFFSET 0 -6 16
        }
      }
    }
  }
}
MOTION
Frames: 4
Frame Time: 0.05
0 90 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0
0 90 0 0 5 0 0 -5 0 0 5 0 0 0 0 0 0 0 0 0 0 0 0 0
0 90 0 0 9 0 0 -9 0 0 9 0 0 0 0 0 0 0 0 0 0 0 0 0
0 90 0 0 12 0 0 -12 0 0 12 0 0 0 0 0 0 0 0 0 0 0 0 0
)");
  const std::string out = own_directory() + "both.sinew",
                    both = "convert " + kMannequin + " " + other + " -o " + out;
  expect_refused(
      both, "sinew retarget " + other + " --to " + kMannequin + " -o OUT.sinew, or convert with --retarget");
  const Outcome run = sinew(both + " --retarget");
  ASSERT_EQ(run.code, 0) << run.out;
  const json info = json::parse(sinew("info " + out + " --json").out);
  EXPECT_EQ(info["clips"].size(), 7u);
  EXPECT_TRUE(info["retarget"].contains(other));
}

}  // namespace
}  // namespace sinew::test
