// Feet on the ground through the C interface are those of C++, to the bit.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>

#include "c/pose_scene.h"
#include "sinew/animation/foot_placement_job.h"

namespace sinew {
namespace {

using fixtures::CInterfacePoses;
using fixtures::expect_refused;
using fixtures::expect_same;
using fixtures::initialised;
using fixtures::Jets;

constexpr float kStep = 1 / 60.f;
constexpr float kRise = 0.12f, kTread = 0.4f;  ///< m, of stairs
constexpr int kFrames = 240;
constexpr std::size_t kNumbers = 19;  ///< of a jet; the rest fills it up

using StateBytes = std::array<unsigned char, sizeof(sinew_feet_state)>;

StateBytes bytes_of(const sinew_feet_state& state) {
  StateBytes bytes{};
  std::memcpy(bytes.data(), &state, bytes.size());
  return bytes;
}

/// A walk up stairs that stand on the floor or on a lift which rises and turns.
struct CInterfaceFeet : CInterfacePoses {
  std::array<FootLeg<float>, 2> legs;
  std::array<FootState<float>, 2> states;
  SmoothInput<float> drop;
  std::array<std::array<GroundHit<float>, 2>, 2> under;
  std::array<std::array<GroundHit<float>, 3>, 2> ahead;
  std::array<sinew_ground_hit, 10> hits;  ///< the same
  std::array<FootInput<float>, 2> inputs;
  std::array<sinew_foot, 2> feet{};  ///< the same
  sinew_feet settings{};
  sinew_feet_state state{};
  TimeJet<float> level{0.f};
  JointJet<float> lift;
  bool on_lift = false;

  void SetUp() override {
    CInterfacePoses::SetUp();
    ASSERT_TRUE(find_foot_leg<float>(cpp.skeleton, Role::kFootL, legs[0]));
    ASSERT_TRUE(find_foot_leg<float>(cpp.skeleton, Role::kFootR, legs[1]));
    settings = initialised(sinew_feet_init);
  }

  /// The walk at a time, as high as the stairs are where its root is.
  Jets walk(float time) {
    Jets jets = pose("walk", double(time));
    MovingTransform<float> root = moving_transform(jets[0]);
    level = (kRise / kTread) * root.translation.x() - TimeJet<float>(kRise / 2);
    if (on_lift) level += moving_transform(lift).translation.z();
    root.translation.z() += level;
    jets[0] = joint_jet(root);
    return jets;
  }
  GroundHit<float> below(const Jets& jets, const FootLeg<float>& leg, const Vec3<float>& sole) const {
    const MovingTransform<float> foot = model_motion<float>(jets, parents, leg.foot);
    Vec3<float> point = value_of<float>(MovingVector<float>(foot * still<float>(sole)));
    point.z() = kRise * std::floor(point.x() / kTread) + (on_lift ? lift.translation.z() : 0.f);
    return {point, Vec3<float>::UnitZ(), on_lift ? 0 : -1};
  }
  /// What both sides are told of the feet.
  void look_at_ground(float time) {
    std::size_t next = 0;
    const auto copy = [&](std::span<const GroundHit<float>> from) {
      const sinew_ground_hit* const first = &hits[next];
      for (const GroundHit<float>& hit : from) {
        sinew_ground_hit& to = hits[next++];
        std::copy_n(hit.point.data(), 3, to.point);
        std::copy_n(hit.normal.data(), 3, to.normal);
        to.body = hit.ground;
      }
      return first;
    };
    for (std::size_t k = 0; k < 2; ++k) {
      const Jets now = walk(time);
      under[k] = {below(now, legs[k], legs[k].toe), below(now, legs[k], legs[k].heel)};
      for (int n = 0; n < 3; ++n)
        ahead[k][std::size_t(n)] = below(walk(time + 0.1f * float(n + 1)), legs[k], legs[k].toe);
      const int clip = cpp.find_clip("walk");
      std::int32_t rests = -1;
      EXPECT_EQ(sinew_clip_in_contact(asset, clip, double(time), legs[k].foot, &rests), SINEW_OK);
      EXPECT_EQ(rests, in_contact(cpp.clips[std::size_t(clip)], double(time), legs[k].foot));
      inputs[k] = {float(rests), under[k], ahead[k]};
      feet[k] = {copy(under[k]), copy(ahead[k]), 2, 3, float(rests), 0};
    }
  }
  /// One frame on both sides; the poses are the same.
  void step(int frame) {
    const float time = float(frame) * kStep;
    lift.translation = {0, 0, 0.1f * time};
    lift.velocity = {0, 0, 0.1f};
    lift.rotation = Quat<float>(std::cos(0.1f * time), 0, 0, std::sin(0.1f * time));
    lift.omega = {0, 0, 0.2f};
    look_at_ground(time);
    Jets placed = walk(time), wanted = placed;
    const MovingTransform<float> ground = moving_transform(lift);
    FootPlacementJob<float> job{parents, wanted, joint(Role::kPelvis), legs, inputs, states, &drop};
    if (on_lift) job.grounds = std::span(&ground, 1);
    job.level = level;
    job.step = frame == 0 ? 0 : kStep;
    job.settings.half_life = 0.07f;
    job.follow = 0.25f;
    ASSERT_TRUE(job.Run()) << frame;
    settings.level = double(level.value);
    settings.level_rate = double(level.rate);
    settings.level_acceleration = double(level.acceleration);
    settings.step = double(job.step);
    settings.half_life = 0.07;
    settings.follow = 0.25;
    ASSERT_EQ(place(placed), SINEW_OK) << sinew_last_reason() << " in frame " << frame;
    expect_same(placed, wanted);
  }
  sinew_status place(Jets& jets) {
    return sinew_asset_place_feet(asset, &settings, feet.data(),
                                  on_lift ? reinterpret_cast<const sinew_jet*>(&lift) : nullptr, on_lift,
                                  &state, c(jets), int(jets.size()));
  }
  /// What is refused leaves jets and state as they were.
  void expect_nothing_placed(sinew_status status, const char* reason, int foot = -1) {
    Jets jets = walk(1);
    expect_nothing_placed(jets, status, reason, foot);
  }
  void expect_nothing_placed(Jets& jets, sinew_status status, const char* reason, int foot = -1) {
    const Jets before = jets;
    const sinew_feet_state remembered = state;
    expect_refused(place(jets), status, reason);
    EXPECT_EQ(sinew_last_index(), foot) << reason;
    for (std::size_t j = 0; j < jets.size(); ++j)
      EXPECT_EQ(std::memcmp(&c(jets)[j], &c(before)[j], kNumbers * sizeof(float)), 0) << reason << j;
    EXPECT_EQ(bytes_of(state), bytes_of(remembered)) << reason;
  }
};

TEST_F(CInterfaceFeet, LegsAreThoseOfCpp) {
  for (const std::size_t k : {0, 1}) {
    sinew_leg_info leg{};
    leg.size = sizeof leg;
    ASSERT_EQ(sinew_asset_get_leg(asset, k == 0 ? SINEW_ROLE_FOOT_L : SINEW_ROLE_FOOT_R, &leg), SINEW_OK);
    EXPECT_EQ(leg.upper, legs[k].upper);
    EXPECT_EQ(leg.middle, legs[k].middle);
    EXPECT_EQ(leg.foot, legs[k].foot);
    EXPECT_EQ(Vec3<float>(leg.toe), legs[k].toe);
    EXPECT_EQ(Vec3<float>(leg.heel), legs[k].heel);
    expect_refused(sinew_asset_get_leg(asset, SINEW_ROLE_HAND_L, &leg), SINEW_INVALID_ARGUMENT, "foot");
  }
  EXPECT_EQ(settings.lock_at, FootSettings<double>().lock_at);
  EXPECT_EQ(settings.steepest, FootSettings<double>().steepest);
  EXPECT_EQ(settings.deepest, FootPlacementJob<double>().deepest);
}

TEST_F(CInterfaceFeet, ClimbStairsAsInCpp) {
  for (const bool moves : {false, true}) {
    SCOPED_TRACE(moves ? "on a lift" : "on the floor");
    on_lift = moves;
    states = {};
    drop = {};
    state = {};
    int locks = 0;
    sinew_feet_state snapshot{};
    std::array<FootState<float>, 2> states_then;
    SmoothInput<float> drop_then;
    for (int frame = 0; frame < kFrames; ++frame) {
      const sinew_feet_state before = state;
      if (frame == kFrames / 2) {
        snapshot = state;
        states_then = states;
        drop_then = drop;
      }
      step(frame);
      if (HasFatalFailure() || HasNonfatalFailure()) return;
      for (const std::size_t k : {0, 1}) {
        const sinew_foot_state& foot = state.feet[k];
        EXPECT_EQ(foot.hold, int(states[k].hold));
        EXPECT_EQ(foot.elapsed >= foot.duration && foot.hold != SINEW_HOLD_FREE, states[k].at_rest());
        EXPECT_EQ(foot.ground, moves ? 0 : -1);
        locks += before.feet[k].hold == SINEW_HOLD_FREE && foot.hold != SINEW_HOLD_FREE;
      }
      EXPECT_EQ(state.drop[0], drop.x.value);
    }
    EXPECT_GE(locks, 6) << "of a walk of 4 s";
    const sinew_feet_state end = state;
    state = snapshot;
    states = states_then;
    drop = drop_then;
    for (int frame = kFrames / 2; frame < kFrames; ++frame) step(frame);
    EXPECT_EQ(bytes_of(state), bytes_of(end)) << "a copy is a snapshot";
  }
}

TEST_F(CInterfaceFeet, LegsThatFindNoPlaneLeaveThePoseAsItWas) {
  for (int frame = 0; frame < 30; ++frame) step(frame);
  Jets jets = walk(0.5f);
  jets[std::size_t(legs[1].middle)].translation.setZero();
  expect_nothing_placed(jets, SINEW_OUT_OF_RANGE, "without length", 1);
  jets = walk(0.5f);
  jets[std::size_t(legs[0].upper)].rotation.x() = std::numeric_limits<float>::quiet_NaN();
  expect_nothing_placed(jets, SINEW_NOT_FINITE, "not finite", 0);
  jets = walk(0.5f);
  jets[0].velocity.z() = 1e30f;
  expect_nothing_placed(jets, SINEW_OUT_OF_RANGE, "absurdly");
}

TEST_F(CInterfaceFeet, EveryReachThatIsInRangeIsTaken) {
  for (const double reach : {0.5, 0.998}) {
    look_at_ground(1);
    settings.reach = reach;
    Jets jets = walk(1);
    EXPECT_EQ(place(jets), SINEW_OK) << reach << ": " << sinew_last_reason();
  }
}

TEST_F(CInterfaceFeet, WhatCannotBeMeantIsRefused) {
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  for (int frame = 0; frame < 30; ++frame) step(frame);
  /// A field that is wrong until it is put back.
  const auto with = [&](auto& field, auto wrong, sinew_status status, const char* reason, int foot = -1) {
    const auto right = field;
    field = wrong;
    expect_nothing_placed(status, reason, foot);
    field = right;
  };
  with(settings.level, 2e6, SINEW_INVALID_ARGUMENT, "level must");
  with(settings.level_rate, double(kNan), SINEW_NOT_FINITE, "level_rate must");
  with(settings.step, -1.0, SINEW_INVALID_ARGUMENT, "step must");
  with(settings.lock_at, 1.5, SINEW_INVALID_ARGUMENT, "lock_at must");
  with(settings.release_at, 0.7, SINEW_INVALID_ARGUMENT, "release_at must");
  with(settings.half_life, 0.0, SINEW_INVALID_ARGUMENT, "half_life must");
  with(settings.farthest, 0.0, SINEW_INVALID_ARGUMENT, "farthest must");
  with(settings.steepest, 1.6, SINEW_INVALID_ARGUMENT, "steepest must");
  with(settings.reach, 0.4, SINEW_INVALID_ARGUMENT, "reach must");
  with(settings.follow, 1.5, SINEW_INVALID_ARGUMENT, "follow must");
  with(settings.rise, 0.0, SINEW_INVALID_ARGUMENT, "rise must");
  with(settings.deepest, -1.0, SINEW_INVALID_ARGUMENT, "deepest must");
  with(settings.size, 4u, SINEW_INVALID_ARGUMENT, "size");

  with(feet[1].contact, 1.5f, SINEW_OUT_OF_RANGE, "contact", 1);
  with(feet[0].contact, kNan, SINEW_OUT_OF_RANGE, "contact", 0);
  with(feet[0].under_count, -1, SINEW_INVALID_ARGUMENT, "fewer hits", 0);
  with(feet[1].ahead, nullptr, SINEW_INVALID_ARGUMENT, "null", 1);
  with(hits[0].point[1], kNan, SINEW_NOT_FINITE, "point of a hit", 0);
  with(hits[6].normal[2], 2.f, SINEW_NOT_FINITE, "normal", 1);
  with(hits[0].point[2], 1e38f, SINEW_OUT_OF_RANGE, "within 1e6 m", 0);
  for (const int body : {0, -2}) with(hits[9].body, body, SINEW_INVALID_ARGUMENT, "no such ground", 1);

  with(state.feet[1].numbers[17], kNan, SINEW_OUT_OF_RANGE, "state", 1);
  with(state.drop[1], 1e20f, SINEW_OUT_OF_RANGE, "state");
  with(state.feet[0].hold, 3, SINEW_OUT_OF_RANGE, "state", 0);
  with(state.feet[0].elapsed, -1.f, SINEW_OUT_OF_RANGE, "state", 0);
  for (const int body : {0, -2})
    with(state.feet[1].ground, body, SINEW_INVALID_ARGUMENT, "the foot is on", 1);

  on_lift = true;
  with(lift.velocity.x(), kNan, SINEW_NOT_FINITE, "jet", 0);
  on_lift = false;
  Jets jets = walk(1);
  jets.resize(std::size_t(std::max(legs[0].foot, legs[1].foot)));
  expect_nothing_placed(jets, SINEW_INVALID_ARGUMENT, "no such joint", legs[0].foot < legs[1].foot);
  const auto call = [&](const sinew_feet* s, const sinew_foot* f, int grounds, sinew_feet_state* remembered,
                        sinew_jet* to) {
    return sinew_asset_place_feet(asset, s, f, nullptr, grounds, remembered, to, int(jets.size()));
  };
  expect_refused(call(nullptr, feet.data(), 0, &state, c(jets)), SINEW_INVALID_ARGUMENT, "null");
  expect_refused(call(&settings, nullptr, 0, &state, c(jets)), SINEW_INVALID_ARGUMENT, "null");
  expect_refused(call(&settings, feet.data(), 1, &state, c(jets)), SINEW_INVALID_ARGUMENT, "null");
  expect_refused(call(&settings, feet.data(), -1, &state, c(jets)), SINEW_INVALID_ARGUMENT, "null");
  expect_refused(call(&settings, feet.data(), 0, nullptr, c(jets)), SINEW_INVALID_ARGUMENT, "null");
  expect_refused(call(&settings, feet.data(), 0, &state, nullptr), SINEW_INVALID_ARGUMENT, "null");

  std::int32_t rests = 0;
  expect_refused(sinew_clip_in_contact(asset, -1, 0, 0, &rests), SINEW_INVALID_ARGUMENT, "clip");
  expect_refused(sinew_clip_in_contact(asset, 0, 0, joints, &rests), SINEW_INVALID_ARGUMENT, "joint");
  expect_refused(sinew_clip_in_contact(asset, 0, NAN, 0, &rests), SINEW_NOT_FINITE, "time");
  expect_refused(sinew_clip_in_contact(asset, 0, 0, 0, nullptr), SINEW_INVALID_ARGUMENT, "null");
}

}  // namespace
}  // namespace sinew
