// `sinew export` as a user runs it. What is in the files, tests/export looks at.
#include <nlohmann/json.hpp>

#include "cli/command.h"
#include "fixtures/paths.h"

namespace sinew::test {
namespace {

using nlohmann::json;

const std::string kAsset = binary_dir() + "/sample.sinew";

TEST(ExportCommand, WritesClipsOfAnAsset) {
  const std::string out = own_directory() + "walk.glb";
  const Outcome run = sinew("export " + kAsset + " -o " + out +
                            " --clip walk --clip run --rate 30 --interpolation cubic --json");
  ASSERT_EQ(run.code, 0) << run.out;
  const json report = json::parse(run.out);
  ASSERT_EQ(report["animations"].size(), 2u);
  EXPECT_EQ(report["animations"][0]["name"], "walk");
  EXPECT_EQ(report["animations"][0]["keys"], 33);  // 1.067 s: both ends
  EXPECT_EQ(report["bytes"], std::filesystem::file_size(out));
  EXPECT_EQ(bytes_of(out).substr(0, 4), "glTF");
  EXPECT_NE(sinew("export " + kAsset + " -o " + out).out.find("animation get_up_prone: 3.20 s"),
            std::string::npos);
  const std::string again = own_directory() + "again.glb";
  ASSERT_EQ(sinew("export " + kAsset + " -o " + again).code, 0);
  EXPECT_EQ(bytes_of(out), bytes_of(again));
}

TEST(ExportCommand, PlaysAScene) {
  const std::string scene = written("two.json", R"({"title": "two", "duration": 0.5, "characters": [
        {"asset": ")" + kAsset + R"(", "name": "anna"}, {"asset": ")" +
                                                    kAsset + R"(", "name": "ben", "position": [0, 2, 0]}]})");
  const std::string both = own_directory() + "both.gltf", one = own_directory() + "one.gltf";
  ASSERT_EQ(sinew("export " + scene + " -o " + both).code, 0);
  ASSERT_EQ(sinew("export " + scene + " --character ben -o " + one).code, 0);
  EXPECT_EQ(json::parse(bytes_of(both))["skins"].size(), 2u);
  EXPECT_EQ(json::parse(bytes_of(one))["skins"].size(), 1u);
  EXPECT_EQ(json::parse(bytes_of(one))["animations"][0]["name"], "two");
  expect_refused("export " + scene + " --character carl -o " + one, "no character 'carl' (anna, ben)");
  expect_refused("export " + scene + " --clip walk -o " + one, "--clip is for assets");
  expect_refused("export " + scene + " --rate 30 -o " + one, "a key per step");
  expect_refused("export " + scene + " --interpolation cubic -o " + one, "cubic is for clips");
}

TEST(ExportCommand, WritesOneMotionAsBvh) {
  const std::string out = own_directory() + "one.bvh";
  ASSERT_EQ(sinew("export " + kAsset + " --clip walk -o " + out).code, 0);
  EXPECT_EQ(bytes_of(out).rfind("HIERARCHY\nROOT ", 0), 0u);
  EXPECT_NE(bytes_of(out).find("\nFrames: 65\n"), std::string::npos);
  expect_refused("export " + kAsset + " -o " + out, "BVH holds one clip: choose with --clip (walk, run");
  expect_refused("export " + kAsset + " --clip walk --interpolation cubic -o " + out,
                 ".bvh holds no splines");
  const std::string scene =
      written("pair.json", R"({"duration": 0.1, "characters": [
    {"asset": ")" + kAsset + R"(", "name": "anna"}, {"asset": ")" +
                               kAsset + R"(", "name": "ben", "position": [0, 2, 0]}]})");
  expect_refused("export " + scene + " -o " + out,
                 "BVH holds one character: choose with --character (anna, ben)");
  ASSERT_EQ(sinew("export " + scene + " --character ben -o " + out).code, 0);
  EXPECT_NE(bytes_of(out).find("\nFrames: 7\n"), std::string::npos);
}

TEST(ExportCommand, WritesThePhysicalBodyAndSaysWhatIsNotInIt) {
  for (const char* name : {"body.xml", "body.urdf"}) {
    const std::string out = own_directory() + name;
    const Outcome run = sinew("export " + kAsset + " --json -o " + out);
    ASSERT_EQ(run.code, 0) << run.out;
    EXPECT_FALSE(json::parse(run.out)["notes"].empty());
    EXPECT_NE(bytes_of(out).find("name=\"pelvis\""), std::string::npos) << name;
    expect_refused("export " + kAsset + " --clip walk -o " + out, "holds no motion");
    expect_refused("export " + kAsset + " --rate 30 -o " + out, "--rate is for glTF and BVH");
    expect_refused("export " + kAsset + " --mesh shapes -o " + out, "--mesh is for glTF");
    const std::string scene =
        written("one.json", R"({"duration": 0.1, "characters": [{"asset": ")" + kAsset + R"("}]})");
    expect_refused("export " + scene + " -o " + out, "a scene is played");
  }
  const std::string body = own_directory() + "body.urdf";
  EXPECT_EQ(sinew("info " + body).code, 0);
  expect_refused("export " + body + " -o " + own_directory() + "./body.urdf", "body.urdf: is the input");
}

TEST(ExportCommand, BadInputIsNamedInOneLineAndNothingIsLeftBehind) {
  const std::string out = own_directory() + "never.glb";
  expect_refused("export /no/such.sinew -o " + out, "/no/such.sinew");
  expect_refused("export " + kAsset + " -o " + own_directory() + "never.usd", "never.usd: what it is to be");
  expect_refused("export " + kAsset + " -o /no/such/directory/x.glb", "/no/such/directory");
  expect_refused("export " + kAsset + " --clip moonwalk -o " + out, "no clip 'moonwalk' (walk, run");
  expect_refused("export " + kAsset + " --character anna -o " + out, "--character is for scenes");
  EXPECT_EQ(sinew("export " + kAsset).code, 2);
  EXPECT_EQ(sinew("export " + kAsset + " --rate 0 -o " + out).code, 2);
  EXPECT_EQ(sinew("export " + kAsset + " --interpolation step -o " + out).code, 2);
  for (const auto& entry : std::filesystem::directory_iterator(own_directory()))
    EXPECT_EQ(entry.path().filename().string().find("never"), std::string::npos) << entry.path();
}

TEST(ExportCommand, HelpSaysEveryDefault) {
  const Outcome help = sinew("export --help");
  EXPECT_EQ(help.code, 0);
  for (const char* words : {"=60", "=linear", "=skin", "NAME=all", "Examples", "Exit codes"})
    EXPECT_NE(help.out.find(words), std::string::npos) << words << "\n" << help.out;
}

}  // namespace
}  // namespace sinew::test
