// A run through the C interface is the run through C++, to the bit.
#include <cstdio>
#include <cstring>
#include <memory>

#include "c/scene.h"
#include "sinew/animation/sampling_job.h"
#include "sinew/character/contact_events.h"
#include "sinew/character/queries.h"
#include "sinew/character/recording.h"
#include "sinew/character/world.h"
#include "sinew/io/asset.h"
#include "sinew/optimizer/presets.h"

namespace sinew {
namespace {

using fixtures::CScene;
using fixtures::initialised;

/// FNV-1a over rotation and translation of every joint, as the samples have it.
std::uint64_t add_pose(std::uint64_t hash, std::span<const Transform<float>> model) {
  for (const Transform<float>& joint : model) {
    unsigned char bytes[7 * sizeof(float)];
    std::memcpy(bytes, joint.rotation.coeffs().data(), 4 * sizeof(float));
    std::memcpy(bytes + 4 * sizeof(float), joint.translation.data(), 3 * sizeof(float));
    for (const unsigned char byte : bytes) hash = (hash ^ byte) * 0x100000001b3u;
  }
  return hash;
}

/// samples/c/main.c in C++; `most`: degrees of freedom solved for at most.
std::uint64_t sample_in_cpp(int frames, int& most) {
  Asset asset;
  EXPECT_TRUE(load_asset(fixtures::sample_asset().c_str(), asset));
  World<float> world({});
  Status status;
  Character<float> hero = world.character(world.add_character(asset.skeleton, {}, status));
  PropSettings ball;
  ball.mass = 4;
  ball.pose.translation = {0, 3, 1.5};
  ball.velocity = {1.2, -6, 2};
  EXPECT_EQ(world.add_prop(ball, status), 0) << status.reason;
  const int chest = asset.skeleton.find(Role::kChest);
  std::vector<JointJet<float>> jets(asset.skeleton.joints.size());
  std::uint64_t hash = 0xcbf29ce484222325u;
  for (int frame = 0; frame < frames; ++frame) {
    EXPECT_TRUE((SamplingJob<float>{&asset.clips[0], frame / 60.0, jets}.Run()));
    EXPECT_TRUE(hero.set_target(jets));
    if (frame == 0) {
      EXPECT_TRUE(hero.reset());
    }
    if (frame == 60) {
      EXPECT_TRUE(hero.apply_impulse(chest, hero.model()[chest].translation, {0, 90, 0}));
    }
    EXPECT_TRUE(world.step(1 / 60.f));
    most = std::max(most, hero.report().unknown_dofs);
    if (frame == 59) {
      EXPECT_GT(most, 0) << "the ball misses";
    }
    hash = add_pose(hash, hero.model());
  }
  return hash;
}

/// What a command prints.
std::string output_of(const std::string& command) {
  const std::unique_ptr<FILE, int (*)(FILE*)> pipe(popen(command.c_str(), "r"), pclose);
  std::string text;
  for (int c = 0; pipe && (c = std::fgetc(pipe.get())) != EOF;) text += static_cast<char>(c);
  return text;
}

std::string hash_line(std::uint64_t hash) {
  char line[40];
  std::snprintf(line, sizeof line, "pose hash %016llx\n", static_cast<unsigned long long>(hash));
  return line;
}

/// That a command, given the sample asset, prints the hash of the same run in C++.
void expect_same_run(const std::string& command) {
  int most = 0;
  const std::string wanted = hash_line(sample_in_cpp(180, most));
  EXPECT_GT(most, 0) << "nothing disturbed the run";
  const std::string printed = output_of(command + " " + fixtures::sample_asset());
  EXPECT_NE(printed.find(wanted), std::string::npos) << printed << "wanted: " << wanted;
}

TEST(CInterfaceSameBits, SampleInCGoesTheWayOfTheSameRunInCpp) {
  expect_same_run(binary_dir() + "/samples/sample_c");
}

TEST(CInterfaceSameBits, SampleInPythonGoesTheWayOfTheSameRunInCpp) {
#ifdef SINEW_PYTHON
  expect_same_run("PYTHONPATH=" + binary_dir() + "/python " SINEW_PYTHON " " + source_dir() +
                  "/samples/python/sample.py");
#else
  GTEST_SKIP() << "without Python, and with the sanitizers";
#endif
}

TEST(CInterfaceSameBits, SampleInCSharpGoesTheWayOfTheSameRunInCpp) {
#ifdef SINEW_CSHARP_SAMPLE
  expect_same_run(SINEW_MONO " " + binary_dir() + "/csharp/sample.exe");
#else
  GTEST_SKIP() << "without mono (apt-get install mono-mcs mono-runtime), and with the sanitizers";
#endif
}

TEST(CInterfaceSameBits, SampleInRustGoesTheWayOfTheSameRunInCpp) {
#ifdef SINEW_RUST_SAMPLE
  expect_same_run(binary_dir() + "/rust/sample_rust");
#else
  GTEST_SKIP() << "without rustc (apt-get install rustc), and with the sanitizers";
#endif
}

TEST(CInterfaceSameBits, DefaultsAreThoseOfCpp) {
  const sinew_world_settings c = initialised(sinew_world_settings_init);
  const WorldSettings cpp;
  EXPECT_EQ(c.gravity[2], cpp.gravity.z());
  EXPECT_EQ(c.ground_friction, cpp.ground_friction);
  EXPECT_EQ(c.island_dofs, cpp.island_dofs);
  EXPECT_EQ(c.tolerance, cpp.accuracy.tolerance);
  EXPECT_EQ(c.max_passes, cpp.accuracy.max_passes);
  EXPECT_EQ(c.return_time, cpp.accuracy.return_time);
  EXPECT_EQ(c.dwell, cpp.detail.dwell);
  EXPECT_EQ(c.bake_every, cpp.detail.bake_every);
  const sinew_character_settings someone = initialised(sinew_character_settings_init);
  EXPECT_EQ(someone.strength, CharacterSettings().strength);
  EXPECT_EQ(someone.help_torque, CharacterSettings().help_torque);
  EXPECT_EQ(someone.most, static_cast<sinew_level>(CharacterSettings().detail.most));
  const sinew_prop_settings prop = initialised(sinew_prop_settings_init);
  EXPECT_EQ(prop.extent[1], PropSettings().size.y());
  EXPECT_EQ(prop.pose.rotation[3], 1);
}

TEST(CInterfaceSameBits, PresetsAreTheMeasuredOnes) {
  sinew_world_settings settings = initialised(sinew_world_settings_init);
  ASSERT_EQ(sinew_world_settings_use_preset(&settings, "cinematic"), SINEW_OK);
  EXPECT_EQ(settings.substeps, kCinematicPreset.accuracy.substeps);
  EXPECT_EQ(settings.tolerance, kCinematicPreset.accuracy.tolerance);
  EXPECT_EQ(sinew_world_settings_use_preset(&settings, "crowd"), SINEW_OK);
  EXPECT_EQ(settings.substeps, kCrowdPreset.accuracy.substeps);
  EXPECT_EQ(sinew_world_settings_use_preset(&settings, "reference"), SINEW_NOT_FOUND);
}

TEST(CInterfaceSameBits, ViewsShowWhatCopiesHold) {
  const CScene scene;
  for (int frame = 0; frame < 5; ++frame) {
    scene.play(frame / 60.0);
    scene.step();
  }
  sinew_view view{};
  ASSERT_EQ(sinew_character_get_view(scene.hero, SINEW_VIEW_MODEL, &view), SINEW_OK);
  std::vector<sinew_transform> copy(static_cast<std::size_t>(scene.joints));
  std::int32_t count = 0;
  ASSERT_EQ(sinew_world_copy_models(scene.world, copy.data(), scene.joints, &count), SINEW_OK);
  ASSERT_EQ(view.count, count);
  ASSERT_EQ(view.stride, static_cast<int>(sizeof(sinew_transform)));
  EXPECT_EQ(std::memcmp(view.data, copy.data(), copy.size() * sizeof(sinew_transform)), 0);
  ASSERT_EQ(sinew_character_get_view(scene.hero, SINEW_VIEW_UNKNOWN, &view), SINEW_OK);
  EXPECT_EQ(view.stride, 1);
  EXPECT_EQ(view.count, scene.report().dofs);
}

TEST(CInterfaceSameBits, TargetsByJetsAreTargetsByClip) {
  const CScene by_clip, by_jets;
  for (int frame = 0; frame < 30; ++frame) {
    by_clip.play(frame / 60.0);
    ASSERT_EQ(sinew_character_set_target(by_jets.hero, by_jets.jets(frame / 60.0).data(), by_jets.joints),
              SINEW_OK);
    const double point[3] = {0, 0, 1.2}, push[3] = {0, 60, 0};
    if (frame == 10) {
      ASSERT_EQ(sinew_character_apply_impulse(by_clip.hero, 2, point, push), SINEW_OK);
      ASSERT_EQ(sinew_character_apply_impulse(by_jets.hero, 2, point, push), SINEW_OK);
    }
    by_clip.step();
    by_jets.step();
  }
  sinew_view a{}, b{};
  ASSERT_EQ(sinew_character_get_view(by_clip.hero, SINEW_VIEW_LOCAL, &a), SINEW_OK);
  ASSERT_EQ(sinew_character_get_view(by_jets.hero, SINEW_VIEW_LOCAL, &b), SINEW_OK);
  EXPECT_EQ(std::memcmp(a.data, b.data, std::size_t(a.count) * std::size_t(a.stride)), 0);
}

/// Jobs on the calling thread, last first.
void run_backwards(void* calls, std::int32_t count, sinew_task task, void* context) {
  ++*static_cast<int*>(calls);
  for (std::int32_t n = count; n-- > 0;) task(context, n);
}

TEST(CInterfaceSameBits, SnapshotsRecordingsAndJobsRepeatToTheBit) {
  CScene scene;
  int calls = 0;
  std::vector<char> start(1 << 16), end(1 << 16), again(1 << 16);
  std::size_t size = 0, end_size = 0, again_size = 0;
  const auto run = [&] {
    for (int frame = 0; frame < 20; ++frame) {
      scene.play(frame / 60.0);
      const double point[3] = {0, 0, 1.2}, push[3] = {40, 0, 0};
      if (frame == 3) {
        ASSERT_EQ(sinew_character_apply_impulse(scene.hero, 2, point, push), SINEW_OK);
      }
      scene.step();
    }
  };
  ASSERT_EQ(sinew_world_save(scene.world, SINEW_SNAPSHOT_STATE, start.data(), start.size(), &size), SINEW_OK);
  ASSERT_EQ(sinew_world_record(scene.world, 1), SINEW_OK);
  run();
  sinew_view view{};
  ASSERT_EQ(sinew_world_get_recording(scene.world, &view), SINEW_OK);
  const std::vector<char> recording(static_cast<const char*>(view.data),
                                    static_cast<const char*>(view.data) + view.count);
  ASSERT_EQ(sinew_world_record(scene.world, 0), SINEW_OK);
  ASSERT_EQ(sinew_world_save(scene.world, SINEW_SNAPSHOT_STATE, end.data(), end.size(), &end_size), SINEW_OK);
  ASSERT_EQ(sinew_world_restore(scene.world, SINEW_SNAPSHOT_STATE, start.data(), size), SINEW_OK);
  ASSERT_EQ(sinew_world_set_jobs(scene.world, run_backwards, &calls), SINEW_OK);
  run();
  EXPECT_EQ(calls, 20);
  ASSERT_EQ(sinew_world_save(scene.world, SINEW_SNAPSHOT_STATE, again.data(), again.size(), &again_size),
            SINEW_OK);
  ASSERT_EQ(end_size, again_size);
  EXPECT_EQ(std::memcmp(end.data(), again.data(), end_size), 0);
  sinew_replay_report report{};
  report.size = sizeof report;
  ASSERT_EQ(sinew_world_replay(scene.world, recording.data(), recording.size(), &report), SINEW_OK)
      << sinew_last_reason();
  EXPECT_EQ(report.steps, 20);
  EXPECT_EQ(report.same, 1);
}

/// A ball that is dropped.
sinew_prop drop_ball(sinew_world world) {
  sinew_prop_settings settings = initialised(sinew_prop_settings_init);
  settings.pose.translation[0] = 3;
  settings.pose.translation[2] = 0.3;
  sinew_prop ball = 0;
  EXPECT_EQ(sinew_world_add_prop(world, &settings, &ball), SINEW_OK) << sinew_last_reason();
  return ball;
}

TEST(CInterfaceSameBits, EventsAndCastsTellOfABallThatFalls) {
  CScene scene;
  const sinew_prop ball = drop_ball(scene.world);
  sinew_contact_settings reports = initialised(sinew_contact_settings_init);
  ASSERT_EQ(sinew_world_report_contacts(scene.world, &reports), SINEW_OK) << sinew_last_reason();
  bool landed = false;
  for (int frame = 0; frame < 60; ++frame) {
    scene.play(0);
    scene.step();
    sinew_contact_event events[16];
    std::int32_t count = 0;
    ASSERT_EQ(sinew_world_take_contacts(scene.world, events, 16, &count, nullptr), SINEW_OK);
    for (int n = 0; n < count; ++n)
      landed |= events[n].phase == SINEW_CONTACT_BEGIN && events[n].a.kind == SINEW_BODY_PROP &&
                events[n].b.kind == SINEW_BODY_GROUND && events[n].impulse > 0;
  }
  EXPECT_TRUE(landed);
  sinew_query ray = initialised(sinew_query_init);
  ray.origin[0] = 3;
  ray.origin[2] = 2;
  ray.motion[2] = -4;
  sinew_hit hits[2];
  std::int32_t count = 0;
  ASSERT_EQ(sinew_world_cast(scene.world, &ray, hits, 2, &count), SINEW_OK) << sinew_last_reason();
  ASSERT_EQ(count, 2);
  EXPECT_EQ(hits[0].body.kind, SINEW_BODY_PROP);
  EXPECT_NEAR(hits[0].position[2], 0.2, 0.01)
      << "a ball of 0.1 m that lies on the floor, a centimetre for where it rolled";
  EXPECT_EQ(hits[1].body.kind, SINEW_BODY_GROUND);
  ray.without_prop = ball;
  ASSERT_EQ(sinew_world_cast(scene.world, &ray, hits, 1, &count), SINEW_OK);
  EXPECT_EQ(hits[0].body.kind, SINEW_BODY_GROUND);
}

TEST(CInterfaceSameBits, HostShapesHeightFieldsAndObstaclesBearBalls) {
  CScene scene;
  const sinew_prop ball = drop_ball(scene.world);
  sinew_host_shape shelf = initialised(sinew_host_shape_init);
  shelf.distance = [](void*, const double* point, double* normal) {
    normal[0] = normal[1] = 0;
    normal[2] = 1;
    return point[2] - 0.1;
  };
  ASSERT_EQ(sinew_world_add_host_shape(scene.world, &shelf), SINEW_OK) << sinew_last_reason();
  for (int frame = 0; frame < 60; ++frame) scene.step();
  sinew_transform at{};
  float velocity[3];
  ASSERT_EQ(sinew_prop_get_state(ball, &at, velocity), SINEW_OK);
  EXPECT_NEAR(at.translation[2], 0.2f, 0.005f)
      << "ball of 0.1 m on a shelf at 0.1 m; sink_depth is half a millimetre";
  const double heights[4] = {0.5, 0.5, 0.5, 0.5};
  sinew_height_field field = initialised(sinew_height_field_init);
  field.heights = heights;
  field.columns = field.rows = 2;
  ASSERT_EQ(sinew_world_add_height_field(scene.world, &field), SINEW_OK) << sinew_last_reason();
  sinew_obstacle box = initialised(sinew_obstacle_init);
  box.shape = SINEW_SHAPE_BOX;
  ASSERT_EQ(sinew_world_add_obstacle(scene.world, &box), SINEW_OK) << sinew_last_reason();
  at.translation[2] = 1;
  const float none[3] = {0, 0, 0};
  ASSERT_EQ(sinew_prop_set_state(ball, &at, none, none), SINEW_OK) << sinew_last_reason();
  for (int frame = 0; frame < 60; ++frame) scene.step();
  ASSERT_EQ(sinew_prop_get_state(ball, &at, nullptr), SINEW_OK);
  EXPECT_NEAR(at.translation[2], 0.6f, 0.005f);
}

TEST(CInterfaceSameBits, LoopsHoldWhatTheyTie) {
  CScene scene;
  const sinew_prop ball = drop_ball(scene.world);
  sinew_loop_settings rope = initialised(sinew_loop_settings_init);
  rope.kind = SINEW_LOOP_POINT;
  rope.a.kind = SINEW_ANCHOR_PROP;
  rope.a.handle = ball;
  rope.b.pose.translation[0] = 3;
  rope.b.pose.translation[2] = 0.3;
  sinew_loop loop = 0;
  ASSERT_EQ(sinew_world_add_loop(scene.world, &rope, &loop), SINEW_OK) << sinew_last_reason();
  for (int frame = 0; frame < 60; ++frame) scene.step();
  double gap = 1;
  float force[3] = {};
  ASSERT_EQ(sinew_loop_get_state(loop, &gap, force), SINEW_OK);
  EXPECT_LT(gap, 0.0005) << "the default stiffness: its weight moves it by 0.1 mm";
  EXPECT_NEAR(force[2], 9.81f, 0.2f) << "the weight of 1 kg; it has come to rest within 2 %";
  ASSERT_EQ(sinew_loop_set_closed(loop, 0), SINEW_OK);
  for (int frame = 0; frame < 60; ++frame) scene.step();
  sinew_transform at{};
  ASSERT_EQ(sinew_prop_get_state(ball, &at, nullptr), SINEW_OK);
  EXPECT_LT(at.translation[2], 0.11f) << "let go, it lies on the floor";
}

TEST(CInterfaceSameBits, WhoIsPushedHardFallsAndIsTold) {
  CScene scene;
  ASSERT_EQ(sinew_character_set_root_drive(scene.hero, SINEW_ROOT_GROUNDED), SINEW_OK);
  ASSERT_EQ(sinew_character_add_behaviour(scene.hero, nullptr), SINEW_OK) << sinew_last_reason();
  ASSERT_EQ(sinew_character_order(scene.hero, SINEW_BEHAVIOUR_KNOCK_DOWN), SINEW_OK);
  sinew_behaviour_report report{};
  report.size = sizeof report;
  for (int frame = 0; frame < 30; ++frame) {
    std::vector<sinew_jet> jets = scene.jets();
    ASSERT_EQ(sinew_character_balance(scene.hero, jets.data(), scene.joints, 1 / 60.f), SINEW_OK)
        << sinew_last_reason();
    scene.step();
  }
  ASSERT_EQ(sinew_character_get_behaviour(scene.hero, &report), SINEW_OK);
  EXPECT_GE(report.state, SINEW_BEHAVIOUR_FALL);
}

}  // namespace
}  // namespace sinew
