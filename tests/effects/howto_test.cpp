// The README's example of a new effect, compiled as it stands there: a file pair and a line of the registry.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <sstream>

#include "breeze.h"
#include "fixtures/paths.h"
#include "scene/effect_registry.h"
#include "scene/run.h"

namespace sinew::scene {
namespace {

std::vector<EffectRow> with_the_readmes_line() {
  std::vector<EffectRow> rows(effect_registry().begin(), effect_registry().end());
  rows.insert(rows.end(), {
#include "breeze_row.inc"
                          });
  return rows;
}

/// Loads a scene with a limp, weightless sample character and these effects.
convert::Error load(const std::string& effects, Scene& scene) {
  const std::filesystem::path file =
      std::filesystem::path(testing::TempDir()) / ("sinew_howto_" + std::to_string(getpid()) + ".json");
  std::ofstream(file) << R"({"duration": 6, "characters": [{"asset": ")" << binary_dir()
                      << R"(/sample.sinew", "strength": [[0, 0]], "root": [[0, "free"]]}], "effects": )"
                      << effects << "}";
  const std::vector<EffectRow> rows = with_the_readmes_line();
  convert::Error error = load_scene(file.string(), rows, scene);
  std::filesystem::remove(file);
  return error;
}

TEST(Howto, SceneWithTheNewEffectRunsAndTheBreezeTakesTheBodyAlong) {
  Scene scene;
  const convert::Error loaded = load(R"([{"effect": "breeze", "velocity": [3, 0, 0], "drag": 20}])", scene);
  ASSERT_FALSE(loaded) << loaded.message;
  Recording recording;
  Telemetry telemetry;
  const convert::Error ran = run_scene(scene, recording, telemetry, {});
  ASSERT_FALSE(ran) << ran.message;
  const std::size_t last = recording.frames.size() - 1;
  const auto center = [&](std::size_t frame) {
    const Skeleton& s = scene.characters[0].asset->skeleton;
    Vec3<double> sum = Vec3<double>::Zero();
    for (int i = 0; i < s.body_count; ++i)
      sum += s.joints[i].mass *
             (recording.frames[frame].characters[0].model[i].cast<double>() * s.joints[i].center_of_mass);
    return Vec3<double>(sum / s.total_mass());
  };
  const Vec3<double> speed = (center(last) - center(last - 60)) / 1.0;
  // Bodies of 20 N·s/m lag by e^(−t·c/m): the heaviest, some 25 kg, by 1 % after 5.5 s.
  EXPECT_NEAR(speed.x(), 3, 0.1);
  EXPECT_NEAR(speed.tail<2>().norm(), 0, 0.1);
}

TEST(Howto, FaultsOfTheNewEffectAreNamedLikeThoseOfOthers) {
  Scene scene;
  EXPECT_THAT(
      load(R"([{"effect": "breeze", "strength": 3}])", scene).message,
      testing::HasSubstr("unknown key 'strength', known are: characters, drag, effect, props, velocity"));
  ASSERT_FALSE(load(R"([{"effect": "breeze", "drag": -1}])", scene));
  Recording recording;
  Telemetry telemetry;
  EXPECT_EQ(run_scene(scene, recording, telemetry, {}).message,
            "effect 'breeze': breeze needs a finite velocity and a drag ≥ 0");
}

}  // namespace
}  // namespace sinew::scene
