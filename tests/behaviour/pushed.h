// The sample character, grounded, playing a clip and being pushed.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <vector>

#include "fixtures/paths.h"
#include "sinew/animation/sampling_job.h"
#include "sinew/behaviour/behaviour.h"
#include "sinew/character/world.h"
#include "sinew/io/asset.h"

namespace sinew::fixtures {

struct Pushed {
  Asset asset;
  World<float> world{WorldSettings{}};
  int hero = -1;
  const Clip* clip = nullptr;
  std::vector<JointJet<float>> jets;
  float h = 1 / 60.f;
  int frame = 0;
  int solved = 0;  ///< frames with unknowns
  std::function<void(std::span<JointJet<float>>)> behave;

  float ground = 0;  ///< m, height of the box that it stands on, where it does

  explicit Pushed(const char* name, RootDrive root = RootDrive::kGrounded, float ground_height = 0,
                  bool self_collision = false)
      : ground(ground_height) {
    EXPECT_TRUE(load_asset((binary_dir() + "/sample.sinew").c_str(), asset));
    if (ground > 0) {
      Collider box;
      box.shape = Shape::kBox;
      box.size = {20, 20, double(ground) / 2};
      box.local.translation.z() = double(ground) / 2;
      EXPECT_TRUE(world.add_obstacle(box));
    }
    CharacterSettings settings;
    settings.root = root;
    settings.self_collision = self_collision;
    Status status;
    hero = world.add_character(asset.skeleton, settings, status);
    EXPECT_TRUE(status) << status.reason;
    clip = &asset.clips[static_cast<std::size_t>(asset.find_clip(name))];
    jets.resize(asset.skeleton.joints.size());
    sample();
    (void)character().set_target(jets);
    (void)character().reset();
  }
  Character<float> character() { return world.character(hero); }
  double time() const { return frame * double(h); }
  void sample() {
    (void)SamplingJob<float>{clip, time(), jets}.Run();
    jets[0].translation.z() += ground;
  }
  void step(const Vec3<float>& force = Vec3<float>::Zero()) {
    ++frame;
    sample();
    if (behave) behave(jets);
    EXPECT_TRUE(character().set_target(jets));
    const int chest = asset.skeleton.find(Role::kChest);
    if (force.norm() > 0)
      (void)character().apply_force(chest, character().model()[static_cast<std::size_t>(chest)].translation,
                                    force);
    (void)world.step(h);
    if (character().report().unknown_dofs > 0) ++solved;
  }
  void run(double seconds) {
    for (const int end = frame + static_cast<int>(std::lround(seconds / double(h))); frame < end;) step();
  }
  /// N·s over a tenth of a second, `direction` from straight ahead to the left.
  void push(double impulse, double direction) {
    const Vec3<double> force = impulse / 0.1 * Vec3<double>(std::cos(direction), std::sin(direction), 0);
    for (const int end = frame + static_cast<int>(std::lround(0.1 / double(h))); frame < end;)
      step(force.cast<float>());
  }
  double root_height() { return double(character().model()[0].translation.z() - ground); }
};

}  // namespace sinew::fixtures
