// What the C interface does with what cannot be meant: handles, sizes, nulls, numbers, calls at the wrong
// time. A status with a reason, and nothing moves.
#include <climits>
#include <cmath>
#include <thread>

#include "c/scene.h"

namespace sinew {
namespace {

using fixtures::CScene;
using fixtures::initialised;

void expect_refused(sinew_status status, sinew_status wanted, const std::string& reason) {
  EXPECT_EQ(sinew_status_name(status), std::string(sinew_status_name(wanted)));
  EXPECT_NE(std::string(sinew_last_reason()).find(reason), std::string::npos) << sinew_last_reason();
}

constexpr const char* kGone = "destroyed";

TEST(CInterface, HandlesOfWhatWasDestroyedAreRefusedForEver) {
  sinew_world first = 0;
  ASSERT_EQ(sinew_world_create(nullptr, &first), SINEW_OK);
  ASSERT_EQ(sinew_world_destroy(first), SINEW_OK);
  expect_refused(sinew_world_destroy(first), SINEW_BAD_HANDLE, kGone);
  sinew_world second = 0;  // in its slot
  ASSERT_EQ(sinew_world_create(nullptr, &second), SINEW_OK);
  EXPECT_NE(first, second);
  expect_refused(sinew_world_step(first, 0.01f), SINEW_BAD_HANDLE, kGone);
  EXPECT_EQ(sinew_world_destroy(second), SINEW_OK);
}

TEST(CInterface, WhatIsInAWorldGoesWithIt) {
  CScene scene;
  sinew_prop ball = 0;
  ASSERT_EQ(sinew_world_add_prop(scene.world, nullptr, &ball), SINEW_OK) << sinew_last_reason();
  ASSERT_EQ(sinew_world_destroy(scene.world), SINEW_OK);
  expect_refused(sinew_character_reset(scene.hero), SINEW_BAD_HANDLE, kGone);
  expect_refused(sinew_prop_park(ball), SINEW_BAD_HANDLE, kGone);
}

TEST(CInterface, HandlesOfAnotherKindAreRefused) {
  CScene scene;
  expect_refused(sinew_world_step(scene.asset, 0.01f), SINEW_BAD_HANDLE, "another kind");
  expect_refused(sinew_world_step(scene.hero, 0.01f), SINEW_BAD_HANDLE, "another kind");
  expect_refused(sinew_character_reset(scene.world), SINEW_BAD_HANDLE, "another kind");
  expect_refused(sinew_asset_destroy(scene.world), SINEW_BAD_HANDLE, "another kind");
  expect_refused(sinew_world_destroy(0), SINEW_BAD_HANDLE, "is 0");
  expect_refused(sinew_character_reset(scene.hero + 1), SINEW_BAD_HANDLE, kGone);  // an index that nobody has
  expect_refused(sinew_world_step(scene.world + 1, 0.01f), SINEW_BAD_HANDLE, kGone);
}

TEST(CInterface, AssetsMayGoBeforeTheirCharacters) {
  CScene scene;
  ASSERT_EQ(sinew_asset_destroy(scene.asset), SINEW_OK);
  scene.step();
  const sinew_play play{scene.hero, scene.asset, 0, 0, 0, 1, 0};
  expect_refused(sinew_play_clips(&play, 1), SINEW_BAD_HANDLE, kGone);
  EXPECT_EQ(sinew_last_index(), 0);
}

TEST(CInterface, NullsAreRefused) {
  CScene scene;
  for (const sinew_status status :
       {sinew_asset_load(nullptr, nullptr), sinew_world_create(nullptr, nullptr),
        sinew_asset_find_joint(scene.asset, nullptr, nullptr), sinew_asset_get_info(scene.asset, nullptr),
        sinew_world_settings_init(nullptr), sinew_play_clips(nullptr, 1),
        sinew_character_set_target(scene.hero, nullptr, scene.joints),
        sinew_character_apply_impulse(scene.hero, 0, nullptr, nullptr),
        sinew_character_get_view(scene.hero, 0, nullptr),
        sinew_world_save(scene.world, 0, nullptr, 0, nullptr),
        sinew_world_restore(scene.world, 0, nullptr, 9), sinew_world_draw(scene.world, nullptr),
        sinew_world_add_obstacle(scene.world, nullptr),
        sinew_character_set_group_strength(scene.hero, nullptr, 1)})
    expect_refused(status, SINEW_INVALID_ARGUMENT, "null");
}

TEST(CInterface, StructsWithoutASizeOrOfANewerHeaderAreRefused) {
  sinew_world_settings settings{};
  expect_refused(sinew_world_settings_init(&settings), SINEW_INVALID_ARGUMENT, "size");
  sinew_world world = 0;
  expect_refused(sinew_world_create(&settings, &world), SINEW_INVALID_ARGUMENT, "size");
  settings = initialised(sinew_world_settings_init);
  settings.size += 8;
  expect_refused(sinew_world_create(&settings, &world), SINEW_BAD_VERSION, "newer");
  EXPECT_EQ(world, 0u);
}

TEST(CInterface, NumbersThatAreNoneAreRefusedAndLeaveThePose) {
  CScene scene;
  scene.step();
  const double at = scene.report().position[0];
  std::vector<sinew_jet> jets = scene.jets();
  jets[3].velocity[1] = NAN;
  expect_refused(sinew_character_set_target(scene.hero, jets.data(), scene.joints), SINEW_NOT_FINITE,
                 "not finite");
  EXPECT_EQ(sinew_last_index(), 3);
  const double point[3] = {0, 0, 1}, push[3] = {NAN, 0, 0};
  expect_refused(sinew_character_apply_impulse(scene.hero, 0, point, push), SINEW_NOT_FINITE, "not finite");
  expect_refused(sinew_world_step(scene.world, NAN), SINEW_NOT_FINITE, "not finite");
  expect_refused(sinew_world_step(scene.world, -1), SINEW_INVALID_ARGUMENT, "positive");
  expect_refused(sinew_character_set_strength(scene.hero, NAN), SINEW_INVALID_ARGUMENT, "strength");
  const double by[3] = {0, NAN, 0};
  expect_refused(sinew_character_displace(scene.hero, by), SINEW_NOT_FINITE, "not finite");
  expect_refused(sinew_character_raise(scene.hero, NAN), SINEW_NOT_FINITE, "not finite");
  const double far_away[] = {1e300, 0, 0};
  expect_refused(sinew_character_displace(scene.hero, far_away), SINEW_OUT_OF_RANGE, "1e6 m");
  const sinew_play play{scene.hero, scene.asset, 0, 0, NAN, 1, 0};
  EXPECT_NE(sinew_play_clips(&play, 1), SINEW_OK);
  EXPECT_EQ(scene.report().position[0], at);
}

TEST(CInterface, SettingsAreRefusedWithTheFieldThatIsWrong) {
  sinew_world world = 0;
  sinew_world_settings settings = initialised(sinew_world_settings_init);
  settings.gravity[2] = NAN;
  expect_refused(sinew_world_create(&settings, &world), SINEW_NOT_FINITE, "gravity");
  settings = initialised(sinew_world_settings_init);
  settings.substeps = 0;
  expect_refused(sinew_world_create(&settings, &world), SINEW_INVALID_ARGUMENT, "substeps");
  CScene scene;
  sinew_character someone = 0;
  sinew_character_settings character = initialised(sinew_character_settings_init);
  character.root = 77;
  expect_refused(sinew_world_add_character(scene.world, scene.asset, &character, &someone),
                 SINEW_INVALID_ARGUMENT, "root drive");
  sinew_prop prop = 0;
  sinew_prop_settings ball = initialised(sinew_prop_settings_init);
  ball.pose.rotation[3] = 3;
  expect_refused(sinew_world_add_prop(scene.world, &ball, &prop), SINEW_INVALID_ARGUMENT, "unit quaternion");
  sinew_height_field field = initialised(sinew_height_field_init);
  const double heights[4] = {0, 1, NAN, 0};
  field.heights = heights;
  field.columns = field.rows = 2;
  expect_refused(sinew_world_add_height_field(scene.world, &field), SINEW_NOT_FINITE, "heights");
  EXPECT_EQ(sinew_last_index(), 2);
}

TEST(CInterface, SizesAreChecked) {
  CScene scene;
  std::vector<sinew_jet> jets = scene.jets();
  expect_refused(sinew_character_set_target(scene.hero, jets.data(), scene.joints - 1),
                 SINEW_INVALID_ARGUMENT, "per joint");
  expect_refused(sinew_character_set_target(scene.hero, jets.data(), INT_MIN), SINEW_INVALID_ARGUMENT,
                 "below 0");
  expect_refused(sinew_clip_sample(scene.asset, 0, 0, 1, 0, jets.data(), scene.joints + 1),
                 SINEW_INVALID_ARGUMENT, "jets");
  auto* const between = reinterpret_cast<sinew_jet*>(reinterpret_cast<char*>(jets.data()) + 4);
  expect_refused(sinew_character_set_target(scene.hero, between, 1), SINEW_INVALID_ARGUMENT,
                 "multiple of 16");
  std::size_t size = 0;
  expect_refused(sinew_world_save(scene.world, SINEW_SNAPSHOT_STATE, nullptr, 0, &size), SINEW_TOO_SMALL,
                 "room");
  std::vector<char> bytes(size);
  ASSERT_EQ(sinew_world_save(scene.world, SINEW_SNAPSHOT_STATE, bytes.data(), bytes.size(), &size), SINEW_OK);
  EXPECT_NE(sinew_world_restore(scene.world, SINEW_SNAPSHOT_STATE, bytes.data(), size - 1), SINEW_OK);
  EXPECT_EQ(sinew_world_restore(scene.world, SINEW_SNAPSHOT_STATE, bytes.data(), size), SINEW_OK);
  std::int32_t joints = 0;
  expect_refused(sinew_world_copy_models(scene.world, nullptr, 0, &joints), SINEW_TOO_SMALL, "room");
  EXPECT_EQ(joints, scene.joints);
}

TEST(CInterface, NamesThatNothingHasAreNotFound) {
  CScene scene;
  std::int32_t index = -5;
  EXPECT_EQ(sinew_asset_find_joint(scene.asset, "tail", &index), SINEW_NOT_FOUND);
  EXPECT_EQ(sinew_asset_find_clip(scene.asset, "", &index), SINEW_NOT_FOUND);
  EXPECT_EQ(index, -5) << "outputs stay as they were";
  EXPECT_STREQ(sinew_status_name(SINEW_NOT_FOUND), "SINEW_NOT_FOUND");
  EXPECT_STREQ(sinew_status_name(-1), "unknown status");
}

TEST(CInterface, CallsFromWithinACallbackAreRefused) {
  CScene scene;
  struct Asked {
    sinew_world world;
    sinew_status destroyed = SINEW_OK, stepped = SINEW_OK;
  } asked{scene.world};
  sinew_draw_settings view = initialised(sinew_draw_settings_init);
  view.context = &asked;
  view.line = [](void* context, const double*, const double*, std::uint32_t) {
    auto& a = *static_cast<Asked*>(context);
    a.destroyed = sinew_world_destroy(a.world);
    a.stepped = sinew_world_step(a.world, 0.01f);
  };
  EXPECT_EQ(sinew_world_draw(scene.world, &view), SINEW_OK);
  EXPECT_EQ(asked.destroyed, SINEW_BUSY);
  EXPECT_EQ(asked.stepped, SINEW_BUSY);
  scene.step();
}

TEST(CInterface, CallsFromASecondThreadAreRefusedWhileOneRuns) {
  CScene scene;
  sinew_status from_thread = SINEW_OK;
  std::string reason;
  sinew_query query = initialised(sinew_query_init);
  query.origin[2] = 2;
  query.motion[2] = -4;
  struct Host {
    const CScene& scene;
    sinew_status& status;
    std::string& reason;
  } host{scene, from_thread, reason};
  query.context = &host;
  query.accept = [](void* context, const sinew_body*) {
    auto& h = *static_cast<Host*>(context);
    std::thread([&] {
      h.status = sinew_character_reset(h.scene.hero);
      h.reason = sinew_last_reason();
    }).join();
    return 1;
  };
  sinew_hit hit{};
  std::int32_t count = 0;
  EXPECT_EQ(sinew_world_cast(scene.world, &query, &hit, 1, &count), SINEW_OK) << sinew_last_reason();
  EXPECT_EQ(count, 1);
  EXPECT_EQ(from_thread, SINEW_BUSY);
  EXPECT_NE(reason.find("another call"), std::string::npos) << reason;
}

TEST(CInterface, ReasonsBelongToTheirThread) {
  EXPECT_EQ(sinew_world_destroy(0), SINEW_BAD_HANDLE);
  std::thread([] { EXPECT_STREQ(sinew_last_reason(), ""); }).join();
  EXPECT_STRNE(sinew_last_reason(), "");
}

}  // namespace
}  // namespace sinew
