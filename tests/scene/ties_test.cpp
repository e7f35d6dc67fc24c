// Loops and particle bodies declared by scene files: the samples in assets, and what is refused.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <sstream>

#include "fixtures/paths.h"
#include "scene/run.h"

namespace sinew::scene {
namespace {

const std::string kAsset = binary_dir() + "/sample.sinew";

std::string written(const std::string& name, std::string content) {
  const std::string wanted = "mannequin.sinew";
  if (const std::size_t at = content.find(wanted); at != std::string::npos)
    content.replace(at, wanted.size(), kAsset);
  const std::filesystem::path directory = testing::TempDir() + "sinew_ties_" + std::to_string(getpid());
  std::filesystem::create_directories(directory);
  std::ofstream(directory / name) << content;
  return (directory / name).string();
}

std::string sample(const std::string& name) {
  std::ifstream in(source_dir() + "/assets/scenes/" + name);
  std::stringstream content;
  content << in.rdbuf();
  return content.str();
}

class Sample : public testing::TestWithParam<const char*> {};

TEST_P(Sample, RunsConvergedAndStaysWithItsFigure) {
  Scene scene;
  const convert::Error error = load_scene(written(GetParam(), sample(GetParam())), scene);
  ASSERT_FALSE(error) << error.message;
  Recording recording;
  Telemetry telemetry;
  const convert::Error failed = run_scene(scene, recording, telemetry, {});
  ASSERT_FALSE(failed) << failed.message;
  int unconverged = 0;
  for (const TelemetryRow& row : telemetry.rows) unconverged += !row.report.converged;
  EXPECT_EQ(unconverged, 0);
  ASSERT_FALSE(recording.props.empty()) << "nothing to be seen of it";
  for (const Frame& frame : recording.frames) {
    ASSERT_EQ(frame.props.size(), recording.props.size());
    const Vec3<float> root = frame.characters[0].model[0].translation;
    for (const PropFrame& prop : frame.props)
      ASSERT_LT((prop.world.translation - root).norm(), 2.0f) << "at " << frame.time << " s";
  }
}

INSTANTIATE_TEST_SUITE_P(Assets, Sample,
                         testing::Values("loop.json", "strand.json", "cloth.json", "soft_tissue.json"),
                         [](const auto& parameter) {
                           const std::string name = parameter.param;
                           return name.substr(0, name.find('.'));
                         });

TEST(Ties, RefusesWhatCannotBeMeant) {
  const std::string head = R"({"characters": [{"asset": "mannequin.sinew"}], )";
  const auto refusal = [&](const std::string& rest) {
    Scene scene;
    return load_scene(written("bad.json", head + rest + "}"), scene).message;
  };
  using testing::HasSubstr;
  EXPECT_THAT(refusal(R"("loops": [{"a": {"joint": "hand_l"}}])"), HasSubstr("'b' is missing"));
  EXPECT_THAT(refusal(R"("loops": [{"kind": "knot", "a": {}, "b": {}}])"), HasSubstr("loops[0].kind"));
  EXPECT_THAT(refusal(R"("loops": [{"a": {"joint": "tail"}, "b": {}}])"), HasSubstr("unknown joint 'tail'"));
  EXPECT_THAT(refusal(R"("loops": [{"a": {"joint": "hand_l"}, "b": {"character": 0, "at": [0, 0, 1]}}])"),
              HasSubstr("names a character but no joint of it (loops[0].b)"));
  EXPECT_THAT(refusal(R"("loops": [{"a": {"prop": "ball"}, "b": {}}])"), HasSubstr("unknown prop"));
  EXPECT_THAT(refusal(R"("loops": [{"kind": "rod", "a": {"joint": "hand_l"}, "b": {}}])"),
              HasSubstr("a rod needs a length"));
  EXPECT_THAT(refusal(R"("particles": [{"kind": "jelly"}])"), HasSubstr("particles[0]"));
  EXPECT_THAT(refusal(R"("particles": [{"kind": "strand", "width": 1}])"), HasSubstr("unknown key 'width'"));
  EXPECT_THAT(refusal(R"("particles": [{"kind": "strand", "direction": [0, 0, 0]}])"),
              HasSubstr("particles[0]"));
  EXPECT_THAT(refusal(R"("particles": [{"kind": "soft_tissue", "cells": [0, 1, 1]}])"), HasSubstr("cells"));
}

}  // namespace
}  // namespace sinew::scene
