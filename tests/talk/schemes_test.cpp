// The schemes that the talk argues against, where they do work: in steps that are short enough they go where
// all others go.
#include "study/schemes/schemes.h"

#include <gtest/gtest.h>

#include "fixtures/paths.h"
#include "scene/run.h"

namespace sinew::study {
namespace {

scene::Scene talk_scene(const char* name) {
  scene::Scene scene;
  const convert::Error error =
      scene::load_scene(source_dir() + "/assets/scenes/talk/" + name + ".json", scene);
  EXPECT_FALSE(error) << error.message;
  scene.double_precision = true;
  scene.world.accuracy.tolerance = 1e-9;
  return scene;
}

std::vector<Transform<float>> after(scene::Scene scene, double seconds, Compared scheme, double rate) {
  scene.scheme = scheme;
  scene.frame_rate = rate;
  scene.duration = seconds;
  scene::Recording recording;
  scene::Telemetry telemetry;
  const convert::Error error = scene::run_scene(scene, recording, telemetry, {});
  EXPECT_FALSE(error) << error.message;
  return recording.frames.back().characters[0].model;
}

/// m, furthest that a joint's origin, or what is a metre from it, is off.
double apart(const std::vector<Transform<float>>& a, const std::vector<Transform<float>>& b) {
  double most = 0;
  for (std::size_t i = 0; i < a.size(); ++i)
    most = std::max(most, double((a[i].translation - b[i].translation).norm()) +
                              double(a[i].rotation.angularDistance(b[i].rotation)));
  return most;
}

class OfFirstOrder : public testing::TestWithParam<const char*> {};

TEST_P(OfFirstOrder, TwoLinkedBodiesInFlight) {
  const scene::Scene scene = talk_scene("linked_bodies");
  const Compared scheme = *scheme_named(GetParam());
  const auto truth = after(scene, 0.25, Compared::kBossak, 7680);
  const double coarse = apart(after(scene, 0.25, scheme, 240), truth),
               fine = apart(after(scene, 0.25, scheme, 480), truth);
  EXPECT_NEAR(std::log2(coarse / fine), 1, 0.2);  // still nearing its limit
  EXPECT_LT(fine, 0.05);
}

INSTANTIATE_TEST_SUITE_P(Schemes, OfFirstOrder, testing::Values("forward_euler", "semi_implicit", "bdf1"),
                         [](const auto& of) { return std::string(of.param); });

TEST(ForwardEuler, FallsByItsOwnSum) {
  scene::Scene scene = talk_scene("stiff_contact");
  const auto now = after(scene, 0.25, Compared::kForwardEuler, 60);  // 15 steps
  EXPECT_NEAR(now[0].translation.x(), -0.7 + 3 * 0.25, 1e-6);
  EXPECT_NEAR(now[0].translation.z(), 0.6 - 9.81 / 3600 * 15 * 14 / 2, 1e-6);
}

TEST(SemiImplicit, IsImplicitEulerWhereTheHessianDoesNotChange) {
  const scene::Scene scene = talk_scene("stiff_spring");
  EXPECT_LT(apart(after(scene, 0.5, Compared::kSemiImplicit, 60), after(scene, 0.5, Compared::kBdf1, 60)),
            1e-6);
}

TEST(Schemes, AreNamed) {
  for (const char* name : {"bossak", "bdf2", "bdf1", "momentum", "semi_implicit", "forward_euler"})
    EXPECT_TRUE(scheme_named(name)) << name;
  EXPECT_FALSE(scheme_named("euler"));
}

}  // namespace
}  // namespace sinew::study
