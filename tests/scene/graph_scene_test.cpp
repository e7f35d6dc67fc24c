// Characters of scenes that follow a graph: the sample in assets, judged from its poses, and what is refused.
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "fixtures/paths.h"
#include "scene/run.h"

namespace sinew::scene {
namespace {

const std::string kAsset = binary_dir() + "/sample.sinew";

std::string written(const std::string& name, const std::string& content) {
  const std::filesystem::path directory = testing::TempDir() + "sinew_graphs_" + std::to_string(getpid());
  std::filesystem::create_directories(directory);
  std::ofstream(directory / name) << content;
  return (directory / name).string();
}

std::string replaced(std::string text, const std::string& what, const std::string& by) {
  const std::size_t at = text.find(what);
  EXPECT_NE(at, std::string::npos) << what;
  return text.replace(at, what.size(), by);
}

TEST(GraphScene, WalksRunsIsHitFallsGetsUpAndRuns) {
  std::ifstream in(source_dir() + "/assets/scenes/graph.json");
  std::stringstream text;
  text << in.rdbuf();
  Scene scene;
  const convert::Error error =
      load_scene(written("graph.json", replaced(replaced(text.str(), "mannequin.sinew", kAsset),
                                                "../character", source_dir() + "/assets/character")),
                 scene);
  ASSERT_FALSE(error) << error.message;
  Recording recording;
  Telemetry telemetry;
  const convert::Error failed = run_scene(scene, recording, telemetry, {});
  ASSERT_FALSE(failed) << failed.message;
  const auto root = [&](double t) {
    return recording.frames[std::size_t(std::lround(60 * t))].characters[0].model[0].translation;
  };
  const auto speed = [&](double t) { return (root(t + 0.25) - root(t - 0.25)).head<2>().norm() / 0.5f; };
  EXPECT_LT(speed(0.3), 0.1f) << "stands";
  EXPECT_NEAR(speed(2), 1.275f, 0.1f) << "walks";
  EXPECT_NEAR(speed(3.7), 3.2f, 0.2f) << "runs";
  EXPECT_NEAR(speed(5), 1.275f, 0.1f) << "walks again";
  EXPECT_LT(root(8)[2], 0.35f) << "lies";
  EXPECT_GT(root(12.2)[2], 0.85f) << "is up";
  EXPECT_GT(speed(14.7), 2.0f) << "runs on";
  const Asset& asset = *recording.characters[0];
  const auto control = [&](const Frame& frame) {
    return frame.characters[0].curve(asset, std::size_t(asset.find_curve("control")));
  };
  EXPECT_NEAR(control(recording.frames.back()), 1, 1e-5f) << "listens to the player";
  EXPECT_LT(
      control(*std::min_element(recording.frames.begin(), recording.frames.end(),
                                [&](const Frame& a, const Frame& b) { return control(a) < control(b); })),
      0.1f)
      << "does not while it gets up";
  // It goes on where it is: nothing leaps. The fastest that anything does here is to fall and to run.
  for (std::size_t k = 1; k < recording.frames.size(); ++k) {
    const auto &now = recording.frames[k].characters[0].model,
               &before = recording.frames[k - 1].characters[0].model;
    EXPECT_LT((now[0].translation - before[0].translation).norm() * 60, 6)
        << recording.frames[k].time << " s";
  }
}

TEST(GraphScene, FaultsNameTheirPlace) {
  const auto message = [](const std::string& character) {
    Scene scene;
    return load_scene(
               written("wrong.json", R"({"characters": [{"asset": ")" + kAsset + "\", " + character + "}]}"),
               scene)
        .message;
  };
  const auto says = [&](const std::string& character, const std::string& what) {
    const std::string said = message(character);
    EXPECT_NE(said.find(what), std::string::npos) << character << "\n  said: " << said;
    EXPECT_EQ(said.find('\n'), std::string::npos);
  };
  says(R"("graph": "none.json")", "cannot read");
  says(R"("graph": {"graph": "wolk"})", "no clip of this name ('wolk')");
  says(R"("graph": {"grahp": 1})", "unknown key 'grahp'");
  says(R"("graph": {"graph": "walk"}, "clips": [{"clip": "walk"}])", "there are clips too");
  says(R"("graph": {"graph": "walk"}, "inputs": [[0, "speed", 1]])", "no parameter 'speed'");
  says(R"("inputs": [[0, "speed", 1]])", "there is no graph");
  says(R"("graph": {"graph": "walk"}, "path": [[0, [0, 0, 0]]])", "has no path");
  EXPECT_EQ(message(R"("graph": {"graph": "walk"})"), "");
}

}  // namespace
}  // namespace sinew::scene
