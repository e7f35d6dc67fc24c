// Figures that a scene file describes itself, how they start and where they are driven.
#include "scene/figure.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "scene/humanoid.h"
#include "scene/run.h"
#include "scene/timeline.h"

namespace sinew::scene {
namespace {

Skeleton figure(const std::string& text) {
  return read_figure(json::parse(text), "figure");
}

std::string refusal(const std::string& text) {
  try {
    figure(text);
  } catch (const std::exception& e) {
    return e.what();
  }
  return "";
}

convert::Error load(const std::string& text, Scene& scene) {
  const std::filesystem::path file =
      std::filesystem::path(testing::TempDir()) / ("sinew_figure_" + std::to_string(getpid()) + ".json");
  std::ofstream(file) << text;
  convert::Error error = load_scene(file.string(), scene);
  std::filesystem::remove(file);
  return error;
}

/// Frames of a scene without a floor and weight.
Recording frames(const std::string& members) {
  Scene scene;
  Recording recording;
  Telemetry telemetry;
  const convert::Error error = load(R"({"gravity": [0, 0, 0], "ground": false, )" + members + "}", scene);
  EXPECT_FALSE(error) << error.message;
  const convert::Error failed = run_scene(scene, recording, telemetry, {});
  EXPECT_FALSE(failed) << failed.message;
  return recording;
}

const Transform<float>& root(const Recording& recording, double t) {
  return recording.frames[static_cast<std::size_t>(std::lround(t * recording.frame_rate))]
      .characters[0]
      .model[0];
}

TEST(Figure, IsAHumanoidWithWhatIsChangedInIt) {
  const Skeleton plain = humanoid();
  const Skeleton s = figure(R"({"kind": "humanoid", "change": [
      {"joint": "chest", "mass": 52}, {"joint": "forearm_l", "limits": [[-2.4, 0]], "torque": [[10, 20]]}]})");
  const int chest = s.find("chest"), elbow = s.find("forearm_l");
  EXPECT_EQ(s.joints[chest].mass, 52);
  EXPECT_TRUE(s.joints[chest].inertia.isApprox(2 * plain.joints[chest].inertia));  // the same body, denser
  EXPECT_EQ(s.joints[elbow].dofs[0].lower, -2.4);
  EXPECT_EQ(s.joints[elbow].dofs[0].torque_minus, 10);
  EXPECT_EQ(s.joints[elbow].dofs[0].torque_plus, 20);
  EXPECT_EQ(s.joints[s.find("forearm_r")], plain.joints[elbow + 3]);
}

TEST(Figure, IsAListOfJointsInWhichRodsKnowTheirInertia) {
  const Skeleton s = figure(R"({"joints": [
      {"name": "a", "type": "hinge", "axis": [0, 0, 1], "mass": 3, "rod": {"to": [2, 0, 0]}},
      {"name": "b", "parent": "a", "type": "ball", "at": [2, 0, 0], "mass": 1, "inertia": [1, 2, 2],
       "torque": [1, 2, 3], "colliders": [{"size": 0.2}]}]})");
  ASSERT_EQ(s.body_count, 2);
  EXPECT_TRUE(s.joints[0].inertia.isApprox(Vec3<double>(0, 1, 1).asDiagonal().toDenseMatrix()));  // m·l²/12
  EXPECT_EQ(s.joints[0].center_of_mass, Vec3<double>(1, 0, 0));
  EXPECT_EQ(s.joints[1].parent, 0);
  EXPECT_EQ(s.joints[1].dofs[2].torque_plus, 3);
  ASSERT_EQ(s.colliders.size(), 1u);
  EXPECT_EQ(s.colliders[0].joint, 1);
}

TEST(Figure, IsRefusedWithTheFaultAndItsPlace) {
  EXPECT_THAT(refusal(R"({"kind": "snake"})"), testing::HasSubstr("(figure.kind)"));
  EXPECT_THAT(refusal(R"({"kind": "box", "radius": 1})"), testing::HasSubstr("unknown key 'radius'"));
  EXPECT_THAT(refusal(R"({"joints": [{"mass": 1, "parent": "b"}]})"),
              testing::HasSubstr("unknown joint 'b'"));
  EXPECT_THAT(refusal(R"({"joints": [{"mass": 0}]})"), testing::HasSubstr("(figure)"));
  EXPECT_THAT(refusal(R"({"kind": "chain", "change": [{"joint": "link1", "limits": [0, 1]}]})"),
              testing::HasSubstr("(figure.change[0].limits)"));
}

TEST(Figure, IsNoAssetAtTheSameTime) {
  Scene scene;
  const convert::Error error =
      load(R"({"characters": [{"asset": "a.sinew", "figure": {"kind": "ball"}}]})", scene);
  EXPECT_THAT(error.message, testing::HasSubstr("characters[0].figure"));
}

constexpr const char* kFree = R"("root": "free", "strength": 0)";

TEST(Start, HasTheSpeedsThatTheFileGives) {
  const Recording r =
      frames(std::string(R"("duration": 1, "characters": [{"figure": {"kind": "ball"}, "position": [1, 0, 2],
                          "velocity": [3, 0, 0], "spin": {"body": [0, 0, 0.5]}, )") +
             kFree + "}]");
  EXPECT_TRUE(root(r, 0).translation.isApprox(Vec3<float>(1, 0, 2)));
  // Rounding of float over 60 steps.
  EXPECT_NEAR(root(r, 1).translation.x(), 4, 1e-4);
  EXPECT_NEAR(root(r, 1).rotation.angularDistance(Quat<float>::Identity()), 0.5, 2e-3);
}

TEST(Start, DrawsTheSameSpeedsForTheSameSeed) {
  const auto thrown = [](int seed) {
    return frames(R"("duration": 0.2, "characters": [{"figure": {"kind": "humanoid"}, "random_spin":
                      {"rms": 3, "seed": )" +
                  std::to_string(seed) + "}, " + kFree + "}]");
  };
  EXPECT_EQ(root(thrown(1), 0.2).translation, root(thrown(1), 0.2).translation);
  EXPECT_NE(root(thrown(1), 0.2).translation, root(thrown(2), 0.2).translation);
}

TEST(Lead, GoesAlongThePathAndTurnsAtTheRate) {
  const Recording r = frames(R"("duration": 2, "characters": [{"figure": {"kind": "box"},
      "path": [[0, [0, 0, 1]], [1, [2, 0, 1]], [1, [5, 0, 1]], [2, [5, 1, 1]]], "turn_rate": [[0, 0], [1, 2]]}])");
  EXPECT_NEAR(root(r, 0.5).translation.x(), 1, 1e-5);
  EXPECT_NEAR(root(r, 1).translation.x(), 5, 1e-5);  // a jump
  EXPECT_NEAR(root(r, 1.5).translation.y(), 0.5, 1e-5);
  EXPECT_NEAR(root(r, 1.5).rotation.angularDistance(Quat<float>::Identity()), 2,
              1e-4);  // t² to 1 s, then 2·t − 1
}

TEST(Lead, BendsJointsOverTime) {
  const Recording r = frames(R"("duration": 1, "characters": [{"figure": {"kind": "humanoid"},
      "pose": {"forearm_l": [[0, [0, 0, 0]], [1, [0, -1, 0]]], "forearm_r": [0, -0.5, 0]}}])");
  const Skeleton body = humanoid();
  const auto bent = [&](const char* name, std::size_t frame) {
    const int joint = body.find(name);
    const auto& model = r.frames[frame].characters[0].model;
    return double(model[joint].rotation.angularDistance(model[body.joints[joint].parent].rotation));
  };
  // Rounding of float.
  EXPECT_NEAR(bent("forearm_l", 30), 0.5, 1e-5);
  EXPECT_NEAR(bent("forearm_l", 60), 1, 1e-5);
  EXPECT_NEAR(bent("forearm_r", 0), 0.5, 1e-5);
  EXPECT_NEAR(bent("forearm_r", 60), 0.5, 1e-5);
}

TEST(Push, MayBeAForceOverTimeOrComeAgain) {
  // 2 N on 1 kg for half a second: 1 m/s.
  const Recording forced =
      frames(std::string(R"("duration": 1, "characters": [{"figure": {"kind": "ball"}, )") + kFree +
             R"(}], "pushes": [{"joint": "body", "force": [[0, [0, 0, 0]], [0.5, [4, 0, 0]]]}])");
  const auto speed = [](const Recording& r) {
    return 60 * (root(r, 1).translation.x() - root(r, 1 - 1.0 / 60).translation.x());
  };
  EXPECT_NEAR(speed(forced), 1 - 2.0 / 60, 1e-3);  // the force of a step is that at its beginning
  const Recording again =
      frames(std::string(R"("duration": 1, "characters": [{"figure": {"kind": "ball"}, )") + kFree +
             R"(}], "pushes": [{"joint": "body", "impulse": [1, 0, 0], "time": 0.1, "every": 0.25}])");
  EXPECT_NEAR(speed(again), 4, 1e-3);  // at 0.1, 0.35, 0.6 and 0.85 s
}

TEST(Scenes, MayHavePropsAlone) {
  const Recording r = frames(R"("duration": 0.5, "props": [{"position": [0, 0, 1], "velocity": [2, 0, 0]}])");
  EXPECT_NEAR(r.frames.back().props[0].world.translation.x(), 1, 1e-4);
  Scene scene;
  EXPECT_THAT(load("{}", scene).message, testing::HasSubstr("neither characters nor props"));
}

TEST(Timelines, AreJoinedByStraightLinesThatMayJump) {
  const Timeline<double> line{{0, 0}, {1, 2}, {1, 4}, {3, 0}};
  EXPECT_EQ(ramp_at(line, -1), 0);
  EXPECT_EQ(ramp_at(line, 0.5), 1);
  EXPECT_EQ(ramp_at(line, 1.0), 4);
  EXPECT_EQ(ramp_at(line, 2.0), 2);
  EXPECT_EQ(ramp_at(line, 9.0), 0);
  EXPECT_EQ(slope_at(line, 0.5), 2);
  EXPECT_EQ(slope_at(line, 1.0), -2);
  EXPECT_EQ(slope_at(line, 9.0), 0);
  EXPECT_DOUBLE_EQ(integral_at(line, 0.5), 0.25);
  EXPECT_DOUBLE_EQ(integral_at(line, 3), 5);
  EXPECT_DOUBLE_EQ(integral_at(line, 4), 5);
  // Of a jump at the time itself what comes before it, whatever rounding makes of that time.
  const Timeline<double> jump = {{1, 0}, {1, -1.5}};
  for (const double t : {1 - 1e-12, 1.0, 1 + 1e-12}) EXPECT_NEAR(integral_at(jump, t), 0, 1e-9);
  EXPECT_DOUBLE_EQ(integral_at(jump, 2), -1.5);
}

}  // namespace
}  // namespace sinew::scene
