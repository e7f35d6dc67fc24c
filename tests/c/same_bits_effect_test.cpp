// Effects through the C interface are those of C++, to the bit.
#include <cmath>
#include <cstring>
#include <memory>

#include "c/scene.h"
#include "sinew/animation/sampling_job.h"
#include "sinew/character/world.h"
#include "sinew/effects/buoyancy.h"
#include "sinew/effects/force_field.h"
#include "sinew/effects/joint_spring.h"
#include "sinew/effects/wind.h"
#include "sinew/io/asset.h"

namespace sinew {
namespace {

using fixtures::CScene;
using fixtures::initialised;

constexpr float kStep = 1 / 60.f;
constexpr int kFrames = 60;
constexpr int kGustAt = 20, kCalmAt = 40;  ///< frames

/// Of a ball and of a limp figure's root.
struct Shown {
  std::vector<float> places;
  void add(const float* ball, const void* model) {
    const auto* const root = static_cast<const float*>(model);
    places.insert(places.end(), ball, ball + 3);
    places.insert(places.end(), root, root + 7);
  }
};

Shown run_in_cpp() {
  Asset asset;
  EXPECT_TRUE(load_asset(fixtures::sample_asset().c_str(), asset));
  World<float> world({});
  Status status;
  CharacterSettings settings;
  settings.strength = 0;
  settings.root = RootDrive::kFree;
  Character<float> hero = world.character(world.add_character(asset.skeleton, settings, status));
  PropSettings thrown;
  thrown.pose.translation = {3, 0, 0.5};
  EXPECT_EQ(world.add_prop(thrown, status), 0) << status.reason;
  EffectId wind_id;
  WindSettings air;
  air.velocity = {4, 1, 0};
  EXPECT_TRUE(world.add_effect(0, std::make_unique<Wind<float>>(air), &wind_id));
  BuoyancySettings water;
  water.level = 0.4;
  water.flow = {0, 0.5, 0};
  EXPECT_TRUE(world.add_prop_effect(0, std::make_unique<Buoyancy<float>>(water)));
  ForceFieldSettings pull;
  pull.center = {0, 0, 2};
  pull.acceleration = 3;
  EXPECT_TRUE(world.add_prop_effect(0, std::make_unique<ForceField<float>>(pull)));
  JointSpringSettings spring;
  spring.stiffness = 80;
  spring.damping = 4;
  spring.joints = {asset.skeleton.joints[std::size_t(asset.skeleton.find(Role::kHead))].name};
  EXPECT_TRUE(world.add_effect(0, std::make_unique<JointSpring<float>>(spring)));
  std::vector<JointJet<float>> jets(asset.skeleton.joints.size());
  EXPECT_TRUE((SamplingJob<float>{&asset.clips[0], 0.0, jets}.Run()));
  EXPECT_TRUE(hero.set_target(jets));
  EXPECT_TRUE(hero.reset());
  Shown shown;
  for (int frame = 0; frame < kFrames; ++frame) {
    if (frame == kGustAt) dynamic_cast<Wind<float>&>(*world.effect(wind_id)).settings.velocity = {25, 0, 2};
    if (frame == kCalmAt) {
      EXPECT_TRUE(world.remove_effect(wind_id));
    }
    EXPECT_TRUE(world.step(kStep));
    const Vec3<float> ball = world.prop_pose(0).translation;
    shown.add(ball.data(), hero.model().data());
  }
  return shown;
}

struct Limp : CScene {
  sinew_prop ball = 0;
  sinew_effect wind = 0, water = 0, pull = 0, spring = 0;

  Limp() {
    EXPECT_EQ(sinew_character_set_strength(hero, 0), SINEW_OK);
    EXPECT_EQ(sinew_character_set_root_drive(hero, SINEW_ROOT_FREE), SINEW_OK);
    sinew_prop_settings thrown = initialised(sinew_prop_settings_init);
    thrown.pose.translation[0] = 3;
    thrown.pose.translation[2] = 0.5;
    EXPECT_EQ(sinew_world_add_prop(world, &thrown, &ball), SINEW_OK) << sinew_last_reason();
    sinew_wind air = initialised(sinew_wind_init);
    air.velocity[0] = 4;
    air.velocity[1] = 1;
    EXPECT_EQ(sinew_character_add_wind(hero, &air, &wind), SINEW_OK) << sinew_last_reason();
    sinew_buoyancy of_water = initialised(sinew_buoyancy_init);
    of_water.level = 0.4;
    of_water.flow[1] = 0.5;
    EXPECT_EQ(sinew_prop_add_buoyancy(ball, &of_water, &water), SINEW_OK) << sinew_last_reason();
    sinew_force_field field = initialised(sinew_force_field_init);
    field.center[2] = 2;
    field.acceleration = 3;
    EXPECT_EQ(sinew_prop_add_force_field(ball, &field, &pull), SINEW_OK) << sinew_last_reason();
    sinew_joint_spring of_neck = initialised(sinew_joint_spring_init);
    int head = -1;
    EXPECT_EQ(sinew_asset_find_role(asset, SINEW_ROLE_HEAD, &head), SINEW_OK);
    of_neck.stiffness = 80;
    of_neck.damping = 4;
    of_neck.joints = &head;
    of_neck.joint_count = 1;
    EXPECT_EQ(sinew_character_add_joint_spring(hero, &of_neck, &spring), SINEW_OK) << sinew_last_reason();
  }
};

TEST(CInterfaceEffects, GoTheWayOfTheSameRunInCpp) {
  const Shown wanted = run_in_cpp();
  const Limp scene;
  Shown shown;
  for (int frame = 0; frame < kFrames; ++frame) {
    if (frame == kGustAt) {
      sinew_wind gust = initialised(sinew_wind_init);
      gust.velocity[0] = 25;
      gust.velocity[2] = 2;
      ASSERT_EQ(sinew_effect_set_wind(scene.wind, &gust), SINEW_OK) << sinew_last_reason();
    }
    if (frame == kCalmAt) {
      ASSERT_EQ(sinew_effect_remove(scene.wind), SINEW_OK) << sinew_last_reason();
    }
    scene.step();
    sinew_transform at{};
    ASSERT_EQ(sinew_prop_get_state(scene.ball, &at, nullptr), SINEW_OK);
    sinew_view model{};
    ASSERT_EQ(sinew_character_get_view(scene.hero, SINEW_VIEW_MODEL, &model), SINEW_OK);
    shown.add(at.translation, model.data);
  }
  EXPECT_GT(shown.places[shown.places.size() - 9], 0.1f) << "the water has not carried the ball";
  ASSERT_EQ(shown.places.size(), wanted.places.size());
  EXPECT_EQ(std::memcmp(shown.places.data(), wanted.places.data(), shown.places.size() * sizeof(float)), 0);
}

TEST(CInterfaceEffects, DefaultsAreThoseOfCpp) {
  EXPECT_EQ(initialised(sinew_wind_init).density, WindSettings().density);
  EXPECT_EQ(initialised(sinew_buoyancy_init).density, BuoyancySettings().density);
  EXPECT_EQ(initialised(sinew_buoyancy_init).volume, BuoyancySettings().volume);
  EXPECT_EQ(initialised(sinew_force_field_init).reach, ForceFieldSettings().reach);
  EXPECT_EQ(initialised(sinew_joint_spring_init).stiffness, JointSpringSettings().stiffness);
}

TEST(CInterfaceEffects, WhatCannotBeMeantIsRefused) {
  const Limp scene;
  const auto expect = [](sinew_status status, sinew_status wanted, const char* reason) {
    EXPECT_EQ(status, wanted) << reason;
    EXPECT_NE(std::string(sinew_last_reason()).find(reason), std::string::npos) << sinew_last_reason();
  };
  sinew_effect out = 0;
  sinew_wind air = initialised(sinew_wind_init);
  air.density = -1;
  expect(sinew_character_add_wind(scene.hero, &air, &out), SINEW_INVALID_ARGUMENT, "density");
  air = initialised(sinew_wind_init);
  air.velocity[1] = NAN;
  expect(sinew_effect_set_wind(scene.wind, &air), SINEW_NOT_FINITE, "velocity");
  expect(sinew_effect_set_wind(scene.wind, nullptr), SINEW_INVALID_ARGUMENT, "null");
  air = initialised(sinew_wind_init);
  expect(sinew_effect_set_wind(scene.water, &air), SINEW_INVALID_ARGUMENT, "another kind");
  const int joints[2] = {0, 999};
  air.joints = joints;
  air.joint_count = 2;
  expect(sinew_character_add_wind(scene.hero, &air, &out), SINEW_INVALID_ARGUMENT, "not simulated");
  EXPECT_EQ(sinew_last_index(), 1);
  air.joint_count = -2;
  expect(sinew_character_add_wind(scene.hero, &air, &out), SINEW_INVALID_ARGUMENT, "below 0");
  air.joint_count = 1;
  air.joints = nullptr;
  expect(sinew_character_add_wind(scene.hero, &air, &out), SINEW_INVALID_ARGUMENT, "null");
  air.joints = joints;
  expect(sinew_prop_add_wind(scene.ball, &air, &out), SINEW_INVALID_ARGUMENT, "not simulated");
  expect(sinew_character_add_wind(scene.hero, nullptr, nullptr), SINEW_INVALID_ARGUMENT, "null");
  sinew_force_field field = initialised(sinew_force_field_init);
  field.reach = 0;
  expect(sinew_effect_set_force_field(scene.pull, &field), SINEW_INVALID_ARGUMENT, "reach");
  ASSERT_EQ(sinew_effect_remove(scene.water), SINEW_OK);
  expect(sinew_effect_remove(scene.water), SINEW_BAD_HANDLE, "destroyed");
  ASSERT_EQ(sinew_character_remove_effects(scene.hero), SINEW_OK);
  expect(sinew_effect_set_wind(scene.wind, &air), SINEW_BAD_HANDLE, "destroyed");
  const sinew_force_field whole = initialised(sinew_force_field_init);
  EXPECT_EQ(sinew_effect_set_force_field(scene.pull, &whole), SINEW_OK) << "it is the ball's";
}

}  // namespace
}  // namespace sinew
