// Characters that are taken along and led back, sensors, and clips without a graph, through the C interface:
// as in C++, to the bit.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

#include "c/pose_scene.h"
#include "sinew/animation/crossfade.h"
#include "sinew/animation/curve_job.h"
#include "sinew/animation/event_job.h"
#include "sinew/animation/root_motion.h"
#include "sinew/animation/smooth_input.h"
#include "sinew/animation/socket.h"
#include "sinew/character/sensor.h"
#include "sinew/character/world.h"
#include "sinew/effects/static_shape.h"
#include "sinew/skeleton/convex_hull.h"

namespace sinew {
namespace {

using fixtures::CInterfacePoses;
using fixtures::CScene;
using fixtures::expect_refused;
using fixtures::expect_same;
using fixtures::initialised;
using fixtures::Jets;

constexpr float kStep = 1 / 60.f;
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

// ---- Rides, and the return ----

constexpr int kFrames = 60, kPushedAt = 10, kLedBackAt = 20, kTakenAlongFrom = 30;
constexpr double kPush[3] = {3, 0, 0};               ///< N s: gives way, and does not fall
constexpr double kOnChest[3] = {0, 0, 1.2};          ///< m
constexpr double kRide[4] = {0.01, 0, 0.02, 0.002};  ///< m, m, rad, m: of every frame

/// Numbers of a model, without the padding of its transforms.
void append(const void* model, std::size_t joints, std::vector<float>& out) {
  const auto* const numbers = static_cast<const float*>(model);
  for (std::size_t j = 0; j < joints; ++j) out.insert(out.end(), &numbers[8 * j], &numbers[8 * j + 7]);
}

std::vector<float> ride_in_cpp(Displacement& displaced) {
  Asset asset;
  EXPECT_TRUE(load_asset(fixtures::sample_asset().c_str(), asset));
  World<float> world({});
  Status status;
  CharacterSettings settings;
  settings.root = RootDrive::kGrounded;
  Character<float> hero = world.character(world.add_character(asset.skeleton, settings, status));
  EXPECT_TRUE(status) << status.reason;
  std::vector<JointJet<float>> jets(asset.skeleton.joints.size());
  const Clip& stand = asset.clips[std::size_t(asset.find_clip("stand"))];
  std::vector<float> poses;
  for (int frame = 0; frame < kFrames; ++frame) {
    EXPECT_TRUE((SamplingJob<float>{&stand, double(frame) / 60, jets}.Run()));
    if (frame >= kTakenAlongFrom) {
      EXPECT_TRUE(hero.ride({kRide[0], kRide[1], kRide[2], kRide[3]}));
    }
    EXPECT_TRUE(hero.set_target(jets));
    if (frame == 0) {
      EXPECT_TRUE(hero.reset());
    }
    if (frame == kPushedAt) {
      EXPECT_TRUE(hero.apply_impulse(asset.skeleton.find(Role::kChest),
                                     Eigen::Map<const Vec3<double>>(kOnChest).cast<float>(),
                                     Eigen::Map<const Vec3<double>>(kPush).cast<float>()));
    }
    if (frame > kPushedAt) {
      EXPECT_TRUE(hero.give_hand());
      EXPECT_TRUE(hero.keep_out(2e-3));
    }
    if (frame == kLedBackAt) {
      EXPECT_TRUE(hero.come_back());
    }
    EXPECT_TRUE(world.step(kStep));
    append(hero.model().data(), hero.model().size(), poses);
  }
  displaced = hero.displacement();
  return poses;
}

/// Stands, whom nothing but the ground holds.
struct Standing : CScene {
  int stand = -1, chest = -1;

  Standing() {
    EXPECT_EQ(sinew_character_set_root_drive(hero, SINEW_ROOT_GROUNDED), SINEW_OK);
    EXPECT_EQ(sinew_asset_find_clip(asset, "stand", &stand), SINEW_OK);
    EXPECT_EQ(sinew_asset_find_role(asset, SINEW_ROLE_CHEST, &chest), SINEW_OK);
  }
  void play_stand(int frame) const {
    const sinew_play play{hero, asset, stand, 0, double(frame) / 60, 1, 0};
    EXPECT_EQ(sinew_play_clips(&play, 1), SINEW_OK) << sinew_last_reason();
  }
};

TEST(CInterfaceRides, GoTheWayOfTheSameRunInCpp) {
  Displacement wanted_displacement;
  const std::vector<float> wanted = ride_in_cpp(wanted_displacement);
  const Standing scene;
  std::vector<float> poses;
  for (int frame = 0; frame < kFrames; ++frame) {
    if (frame >= kTakenAlongFrom) {
      EXPECT_EQ(sinew_character_ride(scene.hero, kRide), SINEW_OK) << sinew_last_reason();
    }
    scene.play_stand(frame);
    if (frame == 0) {
      EXPECT_EQ(sinew_character_reset(scene.hero), SINEW_OK);
    }
    if (frame == kPushedAt) {
      EXPECT_EQ(sinew_character_apply_impulse(scene.hero, scene.chest, kOnChest, kPush), SINEW_OK);
    }
    if (frame > kPushedAt) {
      EXPECT_EQ(sinew_character_give_hand(scene.hero), SINEW_OK) << sinew_last_reason();
      EXPECT_EQ(sinew_character_keep_out(scene.hero, 2e-3), SINEW_OK) << sinew_last_reason();
    }
    if (frame == kLedBackAt) {
      EXPECT_EQ(sinew_character_come_back(scene.hero), SINEW_OK) << sinew_last_reason();
    }
    scene.step();
    sinew_view model{};
    EXPECT_EQ(sinew_character_get_view(scene.hero, SINEW_VIEW_MODEL, &model), SINEW_OK);
    append(model.data, std::size_t(model.count), poses);
  }
  ASSERT_EQ(poses.size(), wanted.size());
  for (std::size_t n = 0; n < wanted.size(); ++n) ASSERT_EQ(poses[n], wanted[n]) << n;
  double displaced[3], rise = 0;
  EXPECT_EQ(sinew_character_get_displacement(scene.hero, displaced), SINEW_OK);
  EXPECT_EQ(sinew_character_get_rise(scene.hero, &rise), SINEW_OK);
  EXPECT_EQ(displaced[0], wanted_displacement.x);
  EXPECT_EQ(displaced[2], wanted_displacement.yaw);
  EXPECT_EQ(rise, wanted_displacement.z);
  EXPECT_GT(rise, 0.05) << "thirty rides of 2 mm";
}

TEST(CInterfaceRides, WhatCannotBeMeantIsRefused) {
  const Standing scene;
  const double nowhere[4] = {0, kNan, 0, 0};
  EXPECT_EQ(sinew_character_ride(scene.hero, nowhere), SINEW_NOT_FINITE);
  expect_refused(sinew_character_ride(scene.hero, nullptr), SINEW_INVALID_ARGUMENT, "null");
  expect_refused(sinew_character_come_back(scene.world), SINEW_BAD_HANDLE, "another kind");
  expect_refused(sinew_character_give_hand(scene.world), SINEW_BAD_HANDLE, "another kind");
  expect_refused(sinew_character_keep_out(scene.world, 0), SINEW_BAD_HANDLE, "another kind");
  expect_refused(sinew_character_keep_out(scene.hero, kNan), SINEW_INVALID_ARGUMENT, "no number");
}

// ---- What was set is read again ----

TEST(CInterfaceReading, WhatWasSetLast) {
  const CScene scene;
  float strength = 0;
  ASSERT_EQ(sinew_character_set_strength(scene.hero, 0.25f), SINEW_OK);
  ASSERT_EQ(sinew_character_get_strength(scene.hero, &strength), SINEW_OK);
  EXPECT_EQ(strength, 0.25f);
  ASSERT_EQ(sinew_character_set_detail(scene.hero, 3, SINEW_LEVEL_PARTIAL, 5, 1), SINEW_OK);
  double significance = 0;
  std::int32_t most = 0, check_every = 0, bake = 0;
  ASSERT_EQ(sinew_character_get_detail(scene.hero, &significance, &most, &check_every, &bake), SINEW_OK);
  EXPECT_EQ(significance, 3);
  EXPECT_EQ(most, SINEW_LEVEL_PARTIAL);
  EXPECT_EQ(check_every, 5);
  EXPECT_EQ(bake, 1);
  for (const std::int32_t away : {1, 0}) {
    std::int32_t parked = 2;
    ASSERT_EQ(sinew_character_park(scene.hero, away), SINEW_OK);
    ASSERT_EQ(sinew_character_get_parked(scene.hero, &parked), SINEW_OK);
    EXPECT_EQ(parked, away);
  }
}

TEST(CInterfaceReading, HowManyThereAre) {
  const CScene scene;
  sinew_prop ball = 0;
  ASSERT_EQ(sinew_world_add_prop(scene.world, nullptr, &ball), SINEW_OK);
  ASSERT_EQ(sinew_world_add_prop(scene.world, nullptr, &ball), SINEW_OK);
  sinew_particles strand = 0;
  ASSERT_EQ(sinew_world_add_strand(scene.world, nullptr, &strand), SINEW_OK) << sinew_last_reason();
  const auto count = [&](sinew_body_kind kind) {
    std::int32_t out = -1;
    EXPECT_EQ(sinew_world_get_count(scene.world, kind, &out), SINEW_OK) << sinew_last_reason();
    return out;
  };
  EXPECT_EQ(count(SINEW_BODY_CHARACTER), 1);
  EXPECT_EQ(count(SINEW_BODY_PROP), 2);
  EXPECT_EQ(count(SINEW_BODY_PARTICLES), 1);
  std::int32_t out = 0;
  expect_refused(sinew_world_get_count(scene.world, SINEW_BODY_OBSTACLE, &out), SINEW_INVALID_ARGUMENT,
                 "counted");
  expect_refused(sinew_world_get_count(scene.world, 6, &out), SINEW_INVALID_ARGUMENT, "counted");
}

TEST(CInterfaceReading, GroundIsThatOfTheReport) {
  const CScene scene;
  ASSERT_EQ(sinew_character_set_root_drive(scene.hero, SINEW_ROOT_FREE), SINEW_OK);
  ASSERT_EQ(sinew_character_set_strength(scene.hero, 0), SINEW_OK);
  bool borne = false;
  for (int frame = 0; frame < 60; ++frame) {
    scene.play(double(frame) / 60);
    scene.step();
    double force = -1, place[3], velocity[3], turn_rate = 1;
    ASSERT_EQ(sinew_character_get_ground(scene.hero, &force, place, velocity, &turn_rate), SINEW_OK);
    const sinew_character_report report = scene.report();
    borne |= force > 0;
    EXPECT_EQ(force, report.ground_force);
    EXPECT_EQ(turn_rate, report.ground_turn_rate);
    for (int k = 0; k < 3; ++k) {
      EXPECT_EQ(place[k], report.ground_place[k]);
      EXPECT_EQ(velocity[k], report.ground_velocity[k]);
    }
  }
  EXPECT_TRUE(borne) << "who falls comes to lie on the floor";
}

TEST(CInterfaceReading, BytesOfASnapshotHaveNames) {
  const CScene scene;
  scene.step();
  std::size_t size = 0;
  EXPECT_EQ(sinew_world_save(scene.world, SINEW_SNAPSHOT_STATE, nullptr, 0, &size), SINEW_TOO_SMALL);
  std::vector<char> bytes(size);
  ASSERT_EQ(sinew_world_save(scene.world, SINEW_SNAPSHOT_STATE, bytes.data(), size, &size), SINEW_OK);
  bool of_hero = false;
  for (std::size_t byte = 0; byte < size; ++byte) {
    sinew_snapshot_field field{};
    ASSERT_EQ(sinew_world_get_snapshot_field(scene.world, byte, &field), SINEW_OK) << sinew_last_reason();
    EXPECT_STRNE(field.name, "") << byte;
    of_hero |= field.body == 0;
  }
  EXPECT_TRUE(of_hero);
  sinew_snapshot_field beyond{};
  ASSERT_EQ(sinew_world_get_snapshot_field(scene.world, size, &beyond), SINEW_OK);
  EXPECT_STREQ(beyond.name, "");
}

// ---- Sensors ----

TEST(CInterfaceSensors, TellOfABallThatFallsThroughAsInCpp) {
  World<float> wanted({});
  Status status;
  PropSettings cpp_ball;
  cpp_ball.pose.translation = {0, 0, 3};
  ASSERT_EQ(wanted.add_prop(cpp_ball, status), 0) << status.reason;
  Sensor<float> door(2);
  door.shape.from = {0, 0, 1.5};
  door.shape.radius = 0.3;

  sinew_world world = 0;
  ASSERT_EQ(sinew_world_create(nullptr, &world), SINEW_OK);
  sinew_prop_settings settings = initialised(sinew_prop_settings_init);
  settings.pose.translation[2] = 3;
  sinew_prop ball = 0;
  ASSERT_EQ(sinew_world_add_prop(world, &settings, &ball), SINEW_OK);
  sinew_query where = initialised(sinew_query_init);
  where.origin[2] = 1.5;
  where.radius = 0.3;
  where.kinds = 1u << SINEW_BODY_PROP;
  sinew_sensor sensor = 0;
  ASSERT_EQ(sinew_world_add_sensor(world, &where, 2, &sensor), SINEW_OK) << sinew_last_reason();
  int told = 0;
  for (int frame = 0; frame < 90; ++frame) {
    ASSERT_TRUE(wanted.step(kStep));
    ASSERT_TRUE(door.update(wanted));
    ASSERT_EQ(sinew_world_step(world, kStep), SINEW_OK);
    std::int32_t left_out = -1, count = -1;
    ASSERT_EQ(sinew_sensor_update(sensor, &left_out), SINEW_OK) << sinew_last_reason();
    EXPECT_EQ(left_out, 0);
    std::array<sinew_sensor_event, 4> events;
    ASSERT_EQ(sinew_sensor_get_events(sensor, events.data(), 4, &count), SINEW_OK);
    ASSERT_EQ(count, int(door.events().size()));
    for (int e = 0; e < count; ++e) {
      EXPECT_EQ(events[std::size_t(e)].phase, int(door.events()[std::size_t(e)].phase));
      EXPECT_EQ(events[std::size_t(e)].body.kind, SINEW_BODY_PROP);
    }
    told += count;
    std::array<sinew_body, 2> bodies;
    ASSERT_EQ(sinew_sensor_get_bodies(sensor, bodies.data(), 2, &count), SINEW_OK);
    ASSERT_EQ(count, int(door.bodies().size()));
    if (count > 0) {
      expect_refused(sinew_sensor_get_bodies(sensor, bodies.data(), 0, &count), SINEW_TOO_SMALL, "fewer");
    }
  }
  EXPECT_EQ(told, 2) << "in, and out";

  where.kinds = ~0u;
  where.accept = [](void*, const sinew_body* body) -> std::int32_t {
    return body->kind == SINEW_BODY_GROUND;
  };
  where.origin[2] = 0;
  ASSERT_EQ(sinew_sensor_place(sensor, &where), SINEW_OK) << sinew_last_reason();
  ASSERT_EQ(sinew_sensor_update(sensor, nullptr), SINEW_OK);
  sinew_body floor{};
  std::int32_t count = 0;
  ASSERT_EQ(sinew_sensor_get_bodies(sensor, &floor, 1, &count), SINEW_OK);
  EXPECT_EQ(floor.kind, SINEW_BODY_GROUND);
  EXPECT_EQ(count, 1) << "the ball is passed by";

  where.radius = -1;
  expect_refused(sinew_sensor_place(sensor, &where), SINEW_INVALID_ARGUMENT, "radius");
  where.radius = 1;
  expect_refused(sinew_world_add_sensor(world, &where, 0, &sensor), SINEW_INVALID_ARGUMENT, "bodies");
  expect_refused(sinew_sensor_update(ball, nullptr), SINEW_BAD_HANDLE, "another kind");
  EXPECT_EQ(sinew_world_destroy(world), SINEW_OK);
  EXPECT_EQ(sinew_sensor_update(sensor, nullptr), SINEW_BAD_HANDLE);
}

// ---- Who passes through whom ----

TEST(CInterfaceMeets, BallsPassThroughEachOtherByLayersOrByPair) {
  for (const bool by_layer : {true, false}) {
    sinew_world world = 0;
    ASSERT_EQ(sinew_world_create(nullptr, &world), SINEW_OK);
    sinew_prop_settings settings = initialised(sinew_prop_settings_init);
    EXPECT_EQ(settings.meets, ~0u);
    sinew_prop balls[2];
    for (int n = 0; n < 2; ++n) {
      settings.pose.translation[2] = n == 0 ? 0.1 : 0.5;
      settings.layers = n == 0 ? 2 : 4;
      if (by_layer && n == 1) settings.meets = ~2u;
      ASSERT_EQ(sinew_world_add_prop(world, &settings, &balls[n]), SINEW_OK) << sinew_last_reason();
    }
    const sinew_body lower{SINEW_BODY_PROP, 0, 0}, upper{SINEW_BODY_PROP, 1, 0}, none{SINEW_BODY_PROP, 2, 0};
    if (!by_layer) {
      ASSERT_EQ(sinew_world_keep_apart(world, &lower, &upper, 1), SINEW_OK) << sinew_last_reason();
    }
    for (int frame = 0; frame < 60; ++frame) ASSERT_EQ(sinew_world_step(world, kStep), SINEW_OK);
    sinew_transform at{};
    ASSERT_EQ(sinew_prop_get_state(balls[1], &at, nullptr), SINEW_OK);
    EXPECT_NEAR(at.translation[2], 0.1f, 0.002f) << "on the floor, in the other";
    expect_refused(sinew_world_keep_apart(world, &lower, &none, 1), SINEW_INVALID_ARGUMENT, "no such");
    const sinew_body odd{7, 0, 0};
    expect_refused(sinew_world_keep_apart(world, &odd, &upper, 1), SINEW_INVALID_ARGUMENT, "kind");
    expect_refused(sinew_world_keep_apart(world, nullptr, &upper, 1), SINEW_INVALID_ARGUMENT, "null");
    EXPECT_EQ(sinew_world_destroy(world), SINEW_OK);
  }
}

TEST(CInterfaceMeets, CallersWhoDoNotKnowOfItMeetEverybody) {
  sinew_world world = 0;
  ASSERT_EQ(sinew_world_create(nullptr, &world), SINEW_OK);
  for (const double height : {0.1, 0.5}) {
    sinew_prop_settings old{};
    old.size = offsetof(sinew_prop_settings, meets);
    ASSERT_EQ(sinew_prop_settings_init(&old), SINEW_OK) << sinew_last_reason();
    EXPECT_EQ(old.meets, 0u) << "beyond what the caller knows";
    old.pose.translation[2] = height;
    sinew_prop ball = 0;
    ASSERT_EQ(sinew_world_add_prop(world, &old, &ball), SINEW_OK) << sinew_last_reason();
  }
  for (int frame = 0; frame < 60; ++frame) ASSERT_EQ(sinew_world_step(world, kStep), SINEW_OK);
  sinew_prop upper = 0;
  sinew_transform at{};
  ASSERT_EQ(sinew_world_get_prop(world, 1, &upper), SINEW_OK);
  ASSERT_EQ(sinew_prop_get_state(upper, &at, nullptr), SINEW_OK);
  EXPECT_NEAR(at.translation[2], 0.3f, 0.01f);
  EXPECT_EQ(sinew_world_destroy(world), SINEW_OK);
}

// ---- Convex solids ----

TEST(CInterfaceSolids, BallsRollOffARampAsInCpp) {
  const double steep = 0.5;  // rad
  const double faces[5][4] = {
      {std::sin(steep), 0, std::cos(steep), 1}, {-1, 0, 0, 2}, {0, 1, 0, 2}, {0, -1, 0, 2}, {0, 0, -1, 1}};
  std::vector<ConvexSolid::Face> cpp_faces;
  for (const auto& f : faces) cpp_faces.push_back({Vec3<double>(f[0], f[1], f[2]).normalized(), f[3]});
  const ConvexSolid ramp(cpp_faces, 0.5);
  World<float> wanted({});
  Status status;
  PropSettings ball_settings;
  ball_settings.pose.translation = {0, 0, 2};
  const int wanted_ball = wanted.add_prop(ball_settings, status);
  ASSERT_TRUE(wanted.add_obstacle(ramp));

  sinew_world world = 0;
  ASSERT_EQ(sinew_world_create(nullptr, &world), SINEW_OK);
  sinew_prop_settings settings = initialised(sinew_prop_settings_init);
  settings.pose.translation[2] = 2;
  sinew_prop ball = 0;
  ASSERT_EQ(sinew_world_add_prop(world, &settings, &ball), SINEW_OK);
  sinew_convex_solid solid = initialised(sinew_convex_solid_init);
  solid.faces = faces[0];
  solid.face_count = 5;
  solid.inner_radius = 0.5;
  ASSERT_EQ(sinew_world_add_convex_solid(world, &solid), SINEW_OK) << sinew_last_reason();
  sinew_transform at{};
  for (int frame = 0; frame < 60; ++frame) {
    ASSERT_TRUE(wanted.step(kStep));
    ASSERT_EQ(sinew_world_step(world, kStep), SINEW_OK);
    ASSERT_EQ(sinew_prop_get_state(ball, &at, nullptr), SINEW_OK);
    for (int k = 0; k < 3; ++k)
      ASSERT_EQ(at.translation[k], wanted.prop_pose(wanted_ball).translation[k]) << frame;
  }
  EXPECT_GT(at.translation[0], 0.1f) << "down the ramp";
  EXPECT_EQ(sinew_world_destroy(world), SINEW_OK);
}

TEST(CInterfaceSolids, HullsAreThoseOfCpp) {
  const double wedge[6][3] = {{-0.3, -0.2, 0}, {0.3, -0.2, 0}, {0.3, -0.2, 0.3},
                              {-0.3, 0.2, 0},  {0.3, 0.2, 0},  {0.3, 0.2, 0.3}};
  std::vector<Vec3<double>> points;
  for (const auto& p : wedge) points.emplace_back(p[0], p[1], p[2]);
  ConvexHull hull;
  ASSERT_TRUE(ConvexHull::make(points, hull));
  World<float> wanted({});
  Status status;
  PropSettings falls;
  falls.hull = &hull;
  falls.pose.translation = {0.1, 0, 1.5};
  const int index = wanted.add_prop(falls, status);
  ASSERT_TRUE(wanted.add_obstacle(convex_collider(hull)));

  sinew_world world = 0;
  ASSERT_EQ(sinew_world_create(nullptr, &world), SINEW_OK);
  sinew_prop_settings settings = initialised(sinew_prop_settings_init);
  settings.pose.translation[0] = 0.1;
  settings.pose.translation[2] = 1.5;
  sinew_prop prop = 0;
  ASSERT_EQ(sinew_world_add_convex_prop(world, &settings, wedge[0], 6, &prop), SINEW_OK)
      << sinew_last_reason();
  const sinew_obstacle stands = initialised(sinew_obstacle_init);
  ASSERT_EQ(sinew_world_add_convex_obstacle(world, &stands, wedge[0], 6), SINEW_OK) << sinew_last_reason();
  sinew_transform at{};
  for (int frame = 0; frame < 60; ++frame) {
    ASSERT_TRUE(wanted.step(kStep));
    ASSERT_EQ(sinew_world_step(world, kStep), SINEW_OK);
    ASSERT_EQ(sinew_prop_get_state(prop, &at, nullptr), SINEW_OK);
    for (int k = 0; k < 3; ++k) ASSERT_EQ(at.translation[k], wanted.prop_pose(index).translation[k]) << frame;
  }
  expect_refused(sinew_world_add_convex_prop(world, &settings, wedge[0], 3, &prop), SINEW_INVALID_ARGUMENT,
                 "four");
  expect_refused(sinew_world_add_convex_prop(world, &settings, nullptr, 6, &prop), SINEW_INVALID_ARGUMENT,
                 "null");
  expect_refused(sinew_world_add_convex_prop(world, &settings, wedge[0], -1, &prop), SINEW_INVALID_ARGUMENT,
                 "count");
  double bad[4][3] = {{0, 0, 0}, {1, 0, 0}, {0, kNan, 0}, {0, 0, 1}};
  expect_refused(sinew_world_add_convex_obstacle(world, &stands, bad[0], 4), SINEW_INVALID_ARGUMENT,
                 "finite");
  EXPECT_EQ(sinew_last_index(), 2);
  EXPECT_EQ(sinew_world_destroy(world), SINEW_OK);
}

TEST(CInterfaceSolids, WhatCannotBeMeantIsRefused) {
  const CScene scene;
  double faces[2][4] = {{0, 0, 1, 1}, {0, 0, -1, 0}};
  sinew_convex_solid solid = initialised(sinew_convex_solid_init);
  solid.face_count = 2;
  expect_refused(sinew_world_add_convex_solid(scene.world, &solid), SINEW_INVALID_ARGUMENT, "null");
  solid.faces = faces[0];
  faces[1][2] = -2;
  expect_refused(sinew_world_add_convex_solid(scene.world, &solid), SINEW_INVALID_ARGUMENT, "unit");
  EXPECT_EQ(sinew_last_index(), 1);
  faces[1][2] = kNan;
  expect_refused(sinew_world_add_convex_solid(scene.world, &solid), SINEW_NOT_FINITE, "finite");
  faces[1][2] = -1;
  faces[0][3] = 1e7;
  expect_refused(sinew_world_add_convex_solid(scene.world, &solid), SINEW_OUT_OF_RANGE, "1e6");
  solid.face_count = 0;
  expect_refused(sinew_world_add_convex_solid(scene.world, &solid), SINEW_INVALID_ARGUMENT, "a face");
  solid.face_count = 1;
  solid.inner_radius = 0;
  expect_refused(sinew_world_add_convex_solid(scene.world, &solid), SINEW_INVALID_ARGUMENT, "inner_radius");
}

// ---- Roots and sockets ----

TEST_F(CInterfacePoses, RootsArePlacedAndSplitAsInCpp) {
  const Transform<double> to{rotation_exp<double>(Vec3<double>(0, 0, 0.7)), {2, -1, 0.5}};
  sinew_pose place{};
  std::copy_n(to.rotation.coeffs().data(), 4, place.rotation);
  std::copy_n(to.translation.data(), 3, place.translation);
  Jets walk = pose("walk", 0.3), wanted = walk;
  place_root(to.cast<float>(), wanted[0]);
  ASSERT_EQ(sinew_place_jets(&place, c(walk), joints), SINEW_OK) << sinew_last_reason();
  expect_same(walk, wanted);

  const RootMotion<float> split = split_root(wanted[0]);
  Jets parts(2);
  ASSERT_EQ(sinew_split_root(c(walk), c(parts), c(parts) + 1), SINEW_OK) << sinew_last_reason();
  expect_same(parts, {split.travel, split.body});
  EXPECT_GT(parts[0].velocity.norm(), 0.5f) << "it walks";

  place.rotation[0] = 1;
  expect_refused(sinew_place_jets(&place, c(walk), joints), SINEW_INVALID_ARGUMENT, "unit");
  expect_refused(sinew_place_jets(&place, c(walk), 0), SINEW_INVALID_ARGUMENT, "no jet");
  walk[0].rotation = Quat<float>(0, 1, 0, 0);
  expect_refused(sinew_split_root(c(walk), c(parts), c(parts)), SINEW_OUT_OF_RANGE, "upside down");
  walk[0].velocity[1] = float(kNan);
  expect_refused(sinew_split_root(c(walk), c(parts), c(parts)), SINEW_NOT_FINITE, "finite");
}

TEST_F(CInterfacePoses, SocketsMoveAsInCpp) {
  const Jets run = pose("run", 0.2);
  const int hand = joint(Role::kHandR);
  sinew_transform palm{{0, 0, std::sin(0.2f), std::cos(0.2f)}, {0.01f, -0.05f, 0.02f}};
  Socket<float> socket{hand};
  socket.offset = {Quat<float>(palm.rotation), Vec3<float>(palm.translation)};
  Jets motion(1);
  ASSERT_EQ(sinew_asset_get_socket(asset, c(run), joints, hand, &palm, c(motion)), SINEW_OK)
      << sinew_last_reason();
  expect_same(motion, {joint_jet(socket_motion<float>(socket, run, parents))});
  EXPECT_GT(motion[0].velocity.norm(), 0.5f) << "it runs";
  ASSERT_EQ(sinew_asset_get_socket(asset, c(run), joints, hand, nullptr, c(motion)), SINEW_OK);
  EXPECT_LT((motion[0].translation - Vec3<float>(model(run)[std::size_t(hand)].translation)).norm(), 1e-5f)
      << "the same chain, rounded in another order";

  expect_refused(sinew_asset_get_socket(asset, c(run), joints, joints, nullptr, c(motion)),
                 SINEW_INVALID_ARGUMENT, "joint");
  palm.rotation[3] = 3;
  expect_refused(sinew_asset_get_socket(asset, c(run), joints, hand, &palm, c(motion)),
                 SINEW_INVALID_ARGUMENT, "unit");
  palm.translation[0] = float(kNan);
  expect_refused(sinew_asset_get_socket(asset, c(run), joints, hand, &palm, c(motion)), SINEW_NOT_FINITE,
                 "finite");
}

// ---- Clips without a graph ----

TEST_F(CInterfacePoses, EventsThatFramesPassAreThoseOfCpp) {
  const int walk = cpp.find_clip("walk");
  const Clip& clip = cpp.clips[std::size_t(walk)];
  ASSERT_FALSE(clip.events.empty()) << "steps of the sample's walk";
  int told = 0;
  for (int frame = -20; frame < 130; ++frame) {  // backwards at first
    const int from = std::abs(frame), to = std::abs(frame + 1);
    sinew_clip_passage passage = initialised(sinew_clip_passage_init);
    passage.clip = walk;
    passage.before = double(from) / 60;
    passage.now = double(to) / 60;
    passage.starts = frame == -20;
    passage.step = 1 / 60.0;
    std::array<sinew_graph_event, 8> events;
    std::int32_t count = -1;
    ASSERT_EQ(sinew_asset_get_passed_events(asset, &passage, events.data(), 8, &count), SINEW_OK)
        << sinew_last_reason();
    std::array<EventHit, 8> hits;
    EventSink sink{hits};
    ASSERT_TRUE((EventJob{clip.events, double(clip.duration), clip.loops, passage.before, passage.now,
                          passage.starts != 0, 1 / 60.f, 1, 0.5f, &sink}
                     .Run()));
    ASSERT_EQ(count, sink.count);
    for (int e = 0; e < count; ++e) {
      EXPECT_EQ(events[std::size_t(e)].name, hits[std::size_t(e)].event->name);
      EXPECT_EQ(events[std::size_t(e)].kind, int(hits[std::size_t(e)].kind));
      EXPECT_EQ(events[std::size_t(e)].seconds_ago, hits[std::size_t(e)].seconds_ago);
    }
    told += count;
  }
  EXPECT_GT(told, 3) << "two loops of a walk";

  sinew_clip_passage all = initialised(sinew_clip_passage_init);
  all.clip = walk;
  all.now = double(clip.duration) * 5;
  sinew_graph_event one;
  std::int32_t count = 0;
  expect_refused(sinew_asset_get_passed_events(asset, &all, &one, 1, &count), SINEW_TOO_SMALL, "fewer");
  EXPECT_GT(count, 5);
  all.clip = static_cast<std::int32_t>(cpp.clips.size());
  expect_refused(sinew_asset_get_passed_events(asset, &all, &one, 1, &count), SINEW_INVALID_ARGUMENT, "clip");
  all.clip = walk;
  all.before = kNan;
  expect_refused(sinew_asset_get_passed_events(asset, &all, &one, 1, &count), SINEW_NOT_FINITE, "before");
  all.before = -1e8;
  EXPECT_EQ(sinew_asset_get_passed_events(asset, &all, &one, 1, &count), SINEW_OUT_OF_RANGE)
      << "more than a thousand loops: " << sinew_last_reason();
}

TEST_F(CInterfacePoses, EventsThatAreEndedAreThoseOfCpp) {
  int ended = 0;
  for (std::size_t n = 0; n < cpp.clips.size(); ++n) {
    const Clip& clip = cpp.clips[n];
    for (int k = 0; k < 40; ++k) {
      const double at = double(clip.duration) * k / 40;
      std::array<EventHit, 8> hits;
      EventSink sink{hits};
      end_events(clip.events, double(clip.duration), clip.loops, at, k % 2 != 0, sink);
      std::array<sinew_graph_event, 8> events;
      std::int32_t count = -1;
      ASSERT_EQ(sinew_asset_get_ended_events(asset, static_cast<int>(n), at, k % 2, events.data(), 8, &count),
                SINEW_OK)
          << sinew_last_reason();
      ASSERT_EQ(count, sink.count);
      for (int e = 0; e < count; ++e)
        EXPECT_EQ(events[std::size_t(e)].name, hits[std::size_t(e)].event->name);
      ended += count;
    }
  }
  EXPECT_GT(ended, 0) << "the sample's clips have parts";
  std::int32_t count = 0;
  expect_refused(sinew_asset_get_ended_events(asset, 0, kNan, 0, nullptr, 0, &count), SINEW_NOT_FINITE,
                 "time");
}

TEST_F(CInterfacePoses, CurvesOfAClipAreThoseOfCpp) {
  ASSERT_FALSE(cpp.curve_slots.empty());
  std::vector<TimeJet<float>> wanted(cpp.curve_slots.size());
  std::vector<sinew_curve_value> values(wanted.size());
  const auto slots = static_cast<std::int32_t>(values.size());
  std::int32_t count = 0;
  bool moves = false;
  for (std::size_t n = 0; n < cpp.clips.size(); ++n)
    for (double time = 0.05; time < double(cpp.clips[n].duration); time += 0.1) {
      ASSERT_TRUE((CurveJob<float>{&cpp.clips[n], {time, 1.5, 0.2}, cpp.curve_slots, wanted}.Run()));
      ASSERT_EQ(
          sinew_asset_sample_curves(asset, static_cast<int>(n), time, 1.5, 0.2, values.data(), slots, &count),
          SINEW_OK)
          << sinew_last_reason();
      ASSERT_EQ(count, slots);
      for (std::size_t k = 0; k < wanted.size(); ++k) {
        EXPECT_EQ(values[k].value, wanted[k].value);
        EXPECT_EQ(values[k].rate, wanted[k].rate);
        EXPECT_EQ(values[k].acceleration, wanted[k].acceleration);
        moves |= values[k].rate != 0;
      }
    }
  EXPECT_TRUE(moves) << "one of the sample's clips moves one";
  expect_refused(sinew_asset_sample_curves(asset, 0, 0, 1, 0, values.data(), 0, &count), SINEW_TOO_SMALL,
                 "fewer");
  expect_refused(sinew_asset_sample_curves(asset, -1, 0, 1, 0, values.data(), slots, &count),
                 SINEW_INVALID_ARGUMENT, "clip");
  EXPECT_EQ(sinew_asset_sample_curves(asset, 0, kNan, 1, 0, values.data(), slots, &count), SINEW_NOT_FINITE);
}

TEST(CInterfaceInputs, FollowTheirGoalsAsInCpp) {
  sinew_curve_value input{1, 0, 0};
  SmoothInput<float> wanted{TimeJet<float>(1)};
  for (int frame = 0; frame < 50; ++frame) {
    const float goal = frame < 20 ? 4.f : -2.f, step = frame % 2 == 0 ? kStep : 2 * kStep;
    wanted.step(goal, SmoothInput<float>::pole_of(0.2f), step);
    ASSERT_EQ(sinew_smooth(&input, goal, 0.2f, step), SINEW_OK) << sinew_last_reason();
    ASSERT_EQ(input.value, wanted.x.value);
    ASSERT_EQ(input.rate, wanted.x.rate);
    ASSERT_EQ(input.acceleration, wanted.x.acceleration);
  }
  const sinew_curve_value before = input;
  expect_refused(sinew_smooth(&input, float(kNan), 0.2f, kStep), SINEW_NOT_FINITE, "finite");
  expect_refused(sinew_smooth(&input, 1, 0, kStep), SINEW_OUT_OF_RANGE, "half_life");
  expect_refused(sinew_smooth(&input, 1, 0.2f, -1), SINEW_OUT_OF_RANGE, "step");
  expect_refused(sinew_smooth(nullptr, 1, 0.2f, kStep), SINEW_INVALID_ARGUMENT, "null");
  EXPECT_EQ(input.value, before.value);
  EXPECT_EQ(input.rate, before.rate);
  EXPECT_EQ(input.acceleration, before.acceleration);
}

}  // namespace
}  // namespace sinew
