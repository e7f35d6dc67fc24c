// Getting up through the C interface is getting up through C++, to the bit.
#include <cstring>

#include "c/scene.h"
#include "sinew/animation/sampling_job.h"
#include "sinew/behaviour/behaviour.h"
#include "sinew/io/asset.h"

namespace sinew {
namespace {

using fixtures::CScene;
using fixtures::initialised;

constexpr float kStep = 1 / 60.f;
constexpr int kKnockedAt = 20;                  ///< frame
constexpr int kMost = 1200;                     ///< frames: 20 s
constexpr double kPush[3] = {0, 40, 0};         ///< N s
constexpr double kPushedAt[3] = {0, 0.1, 1.2};  ///< m

/// What a run of either side shows.
struct Shown {
  int stood = -1;  ///< frame
  int clip = -1;   ///< by which it got up
  std::vector<float> poses;

  void add(const void* model, std::size_t count) {
    const auto* const numbers = static_cast<const float*>(model);
    for (std::size_t joint = 0; joint < count; ++joint)  // without the padding of a transform
      poses.insert(poses.end(), &numbers[8 * joint], &numbers[8 * joint + 7]);
  }
};

Shown get_up_in_cpp() {
  Asset asset;
  EXPECT_TRUE(load_asset(fixtures::sample_asset().c_str(), asset));
  World<float> world({});
  Status status;
  CharacterSettings settings;
  settings.root = RootDrive::kGrounded;
  Character<float> hero = world.character(world.add_character(asset.skeleton, settings, status));
  Behaviour<float> balance(asset.skeleton, {}, status);
  EXPECT_TRUE(status) << status.reason;
  EXPECT_TRUE(balance.use_get_ups(asset.skeleton, asset.clips));
  std::vector<JointJet<float>> jets(asset.skeleton.joints.size());
  const Clip& stand = asset.clips[std::size_t(asset.find_clip("stand"))];
  Shown run;
  for (int frame = 0; frame < kMost && run.stood < 0; ++frame) {
    EXPECT_TRUE((SamplingJob<float>{&stand, double(frame) / 60, jets}.Run()));
    if (frame == 0) {
      EXPECT_TRUE(hero.set_target(jets));
      EXPECT_TRUE(hero.reset());
    }
    if (frame == kKnockedAt) {
      balance.knock_down(hero);
      EXPECT_TRUE(hero.apply_impulse(asset.skeleton.find(Role::kChest),
                                     Eigen::Map<const Vec3<double>>(kPushedAt).cast<float>(),
                                     Eigen::Map<const Vec3<double>>(kPush).cast<float>()));
    }
    EXPECT_TRUE(balance.update(hero, jets, kStep));
    for (const BehaviourEvent& event : balance.events())
      if (event.kind == BehaviourEventKind::kStanding) run.stood = frame;
    EXPECT_TRUE(hero.set_target(jets));
    EXPECT_TRUE(world.step(kStep));
    run.add(hero.model().data(), hero.model().size());
  }
  const GetUp<float>& up = balance.getting_up();
  run.clip = static_cast<int>(up.clips().variants()[std::size_t(up.variant())].clip - asset.clips.data());
  return run;
}

struct Grounded : CScene {
  int stand = -1, chest = -1;

  Grounded() {
    EXPECT_EQ(sinew_character_set_root_drive(hero, SINEW_ROOT_GROUNDED), SINEW_OK);
    EXPECT_EQ(sinew_asset_find_clip(asset, "stand", &stand), SINEW_OK);
    EXPECT_EQ(sinew_asset_find_role(asset, SINEW_ROLE_CHEST, &chest), SINEW_OK);
    EXPECT_EQ(sinew_character_add_behaviour(hero, nullptr), SINEW_OK) << sinew_last_reason();
    sample(0);
    EXPECT_EQ(sinew_character_set_target(hero, jets.data(), joints), SINEW_OK);
    EXPECT_EQ(sinew_character_reset(hero), SINEW_OK);
  }
  void sample(double time) {
    jets.resize(std::size_t(joints));
    EXPECT_EQ(sinew_clip_sample(asset, stand, time, 1, 0, jets.data(), joints), SINEW_OK);
  }
  /// A frame; whether it began to stand.
  bool frame(int n) {
    sample(double(n) / 60);
    if (n == kKnockedAt) {
      EXPECT_EQ(sinew_character_order(hero, SINEW_BEHAVIOUR_KNOCK_DOWN), SINEW_OK);
      EXPECT_EQ(sinew_character_apply_impulse(hero, chest, kPushedAt, kPush), SINEW_OK);
    }
    EXPECT_EQ(sinew_character_balance(hero, jets.data(), joints, kStep), SINEW_OK) << sinew_last_reason();
    sinew_behaviour_event events[4];
    std::int32_t count = 0;
    EXPECT_EQ(sinew_character_get_behaviour_events(hero, events, 4, &count), SINEW_OK);
    bool stands = false;
    for (int e = 0; e < count; ++e) stands |= events[e].kind == SINEW_BEHAVIOUR_EVENT_STANDING;
    step();
    return stands;
  }
  sinew_behaviour_report behaviour() const {
    sinew_behaviour_report r{};
    r.size = sizeof r;
    EXPECT_EQ(sinew_character_get_behaviour(hero, &r), SINEW_OK);
    return r;
  }
  sinew_view model() const {
    sinew_view view{};
    EXPECT_EQ(sinew_character_get_view(hero, SINEW_VIEW_MODEL, &view), SINEW_OK);
    return view;
  }

  std::vector<sinew_jet> jets;
};

TEST(CInterfaceGetUp, GoesTheWayOfTheSameRunInCpp) {
  const Shown wanted = get_up_in_cpp();
  ASSERT_GT(wanted.stood, 0) << "it does not stand again";
  Grounded scene;
  // Of another reading of the same file, which then goes: its clips stay with the behaviour.
  sinew_asset clips = 0;
  ASSERT_EQ(sinew_asset_load(fixtures::sample_asset().c_str(), &clips), SINEW_OK);
  ASSERT_EQ(sinew_character_use_get_ups(scene.hero, clips), SINEW_OK) << sinew_last_reason();
  ASSERT_EQ(sinew_asset_destroy(clips), SINEW_OK);
  Shown run;
  bool rose = false;
  for (int n = 0; n < kMost && run.stood < 0; ++n) {
    if (scene.frame(n)) run.stood = n;
    const sinew_view model = scene.model();
    run.add(model.data, std::size_t(model.count));
    rose |= scene.behaviour().state == SINEW_BEHAVIOUR_RISE && scene.behaviour().off > 0;
  }
  EXPECT_TRUE(rose);
  EXPECT_EQ(run.stood, wanted.stood);
  EXPECT_EQ(scene.behaviour().clip, wanted.clip);
  EXPECT_GT(scene.behaviour().clip_time, 1);
  ASSERT_EQ(run.poses.size(), wanted.poses.size());
  EXPECT_EQ(std::memcmp(run.poses.data(), wanted.poses.data(), run.poses.size() * sizeof(float)), 0);
}

TEST(CInterfaceGetUp, IsRestoredBesideItsWorld) {
  constexpr int kSavedAt = kKnockedAt + 60, kFollowed = 40;
  Grounded scene;
  for (int n = 0; n < kSavedAt; ++n) (void)scene.frame(n);
  std::vector<std::byte> world(1 << 16), behaviour(1 << 16);
  std::size_t size = 0;
  ASSERT_EQ(sinew_world_save(scene.world, SINEW_SNAPSHOT_STATE, world.data(), world.size(), &size), SINEW_OK);
  world.resize(size);
  EXPECT_EQ(sinew_character_save_behaviour(scene.hero, nullptr, 0, &size), SINEW_TOO_SMALL);
  ASSERT_EQ(sinew_character_save_behaviour(scene.hero, behaviour.data(), behaviour.size(), &size), SINEW_OK);
  behaviour.resize(size);
  Shown first, again;
  for (int n = 0; n < kFollowed; ++n) {
    (void)scene.frame(kSavedAt + n);
    first.add(scene.model().data, std::size_t(scene.model().count));
  }
  ASSERT_EQ(sinew_world_restore(scene.world, SINEW_SNAPSHOT_STATE, world.data(), world.size()), SINEW_OK);
  ASSERT_EQ(sinew_character_restore_behaviour(scene.hero, behaviour.data(), behaviour.size()), SINEW_OK);
  for (int n = 0; n < kFollowed; ++n) {
    (void)scene.frame(kSavedAt + n);
    again.add(scene.model().data, std::size_t(scene.model().count));
  }
  EXPECT_EQ(first.poses, again.poses);
  behaviour[behaviour.size() / 2] ^= std::byte{4};
  EXPECT_EQ(sinew_character_restore_behaviour(scene.hero, behaviour.data(), behaviour.size()),
            SINEW_BAD_FILE);
}

TEST(CInterfaceGetUp, WhoMayNotLiesUntilHeMay) {
  Grounded scene;
  sinew_behaviour_settings settings = initialised(sinew_behaviour_settings_init);
  EXPECT_EQ(settings.get_up, SINEW_GET_UP_AUTO);
  EXPECT_EQ(settings.gather, BehaviourSettings().gather);
  EXPECT_EQ(settings.rise_torque, BehaviourSettings().rise_torque);
  EXPECT_EQ(settings.walk_torque, BehaviourSettings().walk_torque);
  EXPECT_EQ(settings.walk_force, BehaviourSettings().walk_force);
  EXPECT_EQ(settings.reach_strength, BehaviourSettings().reach_strength);
  settings.get_up = SINEW_GET_UP_WHEN_ALLOWED;
  ASSERT_EQ(sinew_character_add_behaviour(scene.hero, &settings), SINEW_OK) << sinew_last_reason();
  EXPECT_EQ(sinew_character_order(scene.hero, SINEW_BEHAVIOUR_GET_UP), SINEW_INVALID_ARGUMENT)
      << "without clips";
  EXPECT_EQ(scene.behaviour().clip, -1);
  ASSERT_EQ(sinew_character_use_get_ups(scene.hero, scene.asset), SINEW_OK) << sinew_last_reason();
  int n = 0;
  for (; n < kMost && scene.behaviour().state != SINEW_BEHAVIOUR_DOWN; ++n) scene.frame(n);
  for (const int end = n + 60; n < end; ++n) scene.frame(n);
  EXPECT_EQ(scene.behaviour().state, SINEW_BEHAVIOUR_DOWN);
  ASSERT_EQ(sinew_character_order(scene.hero, SINEW_BEHAVIOUR_GET_UP), SINEW_OK) << sinew_last_reason();
  scene.frame(n);
  EXPECT_EQ(scene.behaviour().state, SINEW_BEHAVIOUR_GATHER);
  EXPECT_EQ(scene.behaviour().tries, 1);
  EXPECT_EQ(sinew_character_use_get_ups(scene.hero, scene.asset), SINEW_INVALID_ARGUMENT)
      << "while it gets up";
}

TEST(CInterfaceGetUp, CallersWhoDoNotKnowOfItAreServed) {
  Grounded scene;
  sinew_behaviour_settings settings{};
  settings.size = 48;  // up to let_go
  ASSERT_EQ(sinew_behaviour_settings_init(&settings), SINEW_OK) << sinew_last_reason();
  EXPECT_EQ(settings.let_go, BehaviourSettings().let_go);
  EXPECT_EQ(settings.gather, 0);
  settings.rise_torque = NAN;  // beyond what he knows
  EXPECT_EQ(sinew_character_add_behaviour(scene.hero, &settings), SINEW_OK) << sinew_last_reason();
  sinew_behaviour_report report{};
  report.size = 40;
  EXPECT_EQ(sinew_character_get_behaviour(scene.hero, &report), SINEW_OK);
  EXPECT_EQ(report.clip, 0);
}

}  // namespace
}  // namespace sinew
