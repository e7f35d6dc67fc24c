// Jobs on poses through the C interface are those of C++, to the bit.
#include <algorithm>
#include <cmath>
#include <iterator>

#include "c/pose_scene.h"
#include "sinew/animation/blending_job.h"
#include "sinew/animation/crossfade.h"
#include "sinew/animation/inertialize_job.h"
#include "sinew/animation/inverse_kinematics.h"
#include "sinew/animation/look_at_job.h"
#include "sinew/animation/mesh_additive_job.h"
#include "sinew/animation/mirror_job.h"

namespace sinew {
namespace {

using fixtures::CInterfacePoses;
using fixtures::expect_refused;
using fixtures::expect_same;
using fixtures::initialised;
using fixtures::Jets;

TEST_F(CInterfacePoses, BlendsAreThoseOfCpp) {
  const Jets walk = pose("walk", 0.3), run = pose("run", 0.2), stand = pose("stand", 1);
  std::vector<float> mask(parents.size());
  for (std::size_t j = 0; j < mask.size(); ++j) mask[j] = float(j % 3) / 2;
  Jets added = pose("walk", 0.9);
  Jets added_cpp = added;
  subtract_reference<float>(rest, added_cpp, added_cpp);
  ASSERT_EQ(sinew_asset_subtract(asset, nullptr, 0, c(added), joints), SINEW_OK) << sinew_last_reason();
  expect_same(added, added_cpp);

  float w[3];
  ASSERT_EQ(sinew_ease(0.1f, 0.3f, w), SINEW_OK);
  const EaseWeight<float> ease = EaseWeight<float>::at(0.1f, 0.3f);
  EXPECT_EQ(w[2], ease.acceleration);
  const std::array<BlendLayer<float>, 4> wanted_layers{
      BlendLayer<float>{walk, TimeJet<float>(0.4f)}, BlendLayer<float>{run, TimeJet<float>(0.6f)},
      BlendLayer<float>{stand, ease, mask, BlendMode::kOverride},
      BlendLayer<float>{added_cpp, TimeJet<float>(0.5f), {}, BlendMode::kAdditive}};
  Jets wanted(parents.size()), blended(parents.size());
  ASSERT_TRUE((BlendingJob<float>{wanted_layers, rest, wanted}.Run()));
  sinew_blend_layer layers[4] = {{c(walk), nullptr, SINEW_BLEND_MIX, 0.4f, 0, 0},
                                 {c(run), nullptr, SINEW_BLEND_MIX, 0.6f, 0, 0},
                                 {c(stand), mask.data(), SINEW_BLEND_OVERRIDE, w[0], w[1], w[2]},
                                 {c(added), nullptr, SINEW_BLEND_ADDITIVE, 0.5f, 0, 0}};
  ASSERT_EQ(sinew_asset_blend(asset, layers, 4, c(blended), joints), SINEW_OK) << sinew_last_reason();
  expect_same(blended, wanted);

  layers[1].weight = -1;
  expect_refused(sinew_asset_blend(asset, layers, 4, c(blended), joints), SINEW_OUT_OF_RANGE, "weight");
  EXPECT_EQ(sinew_last_index(), 1);
  layers[1].mode = 3;
  expect_refused(sinew_asset_blend(asset, layers, 4, c(blended), joints), SINEW_INVALID_ARGUMENT, "mode");
  layers[2].jets = nullptr;
  layers[1].mode = SINEW_BLEND_MIX;
  expect_refused(sinew_asset_blend(asset, layers, 4, c(blended), joints), SINEW_INVALID_ARGUMENT, "null");
  EXPECT_EQ(sinew_last_index(), 2);
  expect_refused(sinew_asset_blend(asset, layers, 17, c(blended), joints), SINEW_INVALID_ARGUMENT, "16");
  expect_refused(sinew_asset_blend(asset, layers, 1, c(blended), joints + 1), SINEW_INVALID_ARGUMENT, "jets");
  expect_refused(sinew_asset_subtract(asset, c(walk), joints - 1, c(blended), joints), SINEW_INVALID_ARGUMENT,
                 "another number");
  expect_same(blended, wanted);
}

TEST_F(CInterfacePoses, LayersInModelSpaceAreThoseOfCpp) {
  const Jets stand = pose("stand", 1);
  Jets added = pose("walk", 0.3), added_cpp = added;
  std::vector<MovingRotation<float>> turns(2 * parents.size());
  subtract_in_model<float>(parents, stand, added_cpp, turns, added_cpp);
  Jets scratch(2 * parents.size());
  ASSERT_EQ(sinew_asset_subtract_in_model(asset, c(stand), joints, c(added), joints, c(scratch), 2 * joints),
            SINEW_OK)
      << sinew_last_reason();
  expect_same(added, added_cpp);

  std::vector<float> mask(parents.size());
  for (std::size_t j = 0; j < mask.size(); ++j) mask[j] = float(j % 3) / 2;
  Jets wanted = pose("run", 0.2), turned = wanted;
  MeshAdditiveJob<float> job{parents, wanted, added_cpp, {0.5f, 1, 2}, mask, turns};
  ASSERT_TRUE(job.Run());
  sinew_blend_layer layer{c(added), mask.data(), SINEW_BLEND_ADDITIVE, 0.5f, 1, 2};
  const auto add = [&](sinew_jet* memory, int count) {
    return sinew_asset_add_in_model(asset, &layer, c(turned), joints, memory, count);
  };
  ASSERT_EQ(add(c(scratch), 2 * joints), SINEW_OK) << sinew_last_reason();
  expect_same(turned, wanted);
  EXPECT_NE(turned[5].rotation.coeffs(), pose("run", 0.2)[5].rotation.coeffs());

  expect_refused(add(c(scratch), 2 * joints - 1), SINEW_TOO_SMALL, "two jets");
  expect_refused(add(nullptr, 2 * joints), SINEW_INVALID_ARGUMENT, "null");
  layer.weight = -1;
  expect_refused(add(c(scratch), 2 * joints), SINEW_OUT_OF_RANGE, "weight");
  layer.mode = SINEW_BLEND_OVERRIDE;
  expect_refused(add(c(scratch), 2 * joints), SINEW_INVALID_ARGUMENT, "additive");
  expect_refused(
      sinew_asset_subtract_in_model(asset, c(stand), joints - 1, c(turned), joints, c(scratch), 2 * joints),
      SINEW_INVALID_ARGUMENT, "another number");
  expect_refused(
      sinew_asset_subtract_in_model(asset, nullptr, joints, c(turned), joints, c(scratch), 2 * joints),
      SINEW_INVALID_ARGUMENT, "null");
  expect_same(turned, wanted);
  // The pose at rest, for who wants the difference from that.
  ASSERT_EQ(sinew_asset_blend(asset, nullptr, 0, c(turned), joints), SINEW_OK) << sinew_last_reason();
  for (std::size_t j = 0; j < rest.size(); ++j)
    EXPECT_EQ(turned[j].rotation.coeffs(), rest[j].rotation.coeffs()) << j;
}

TEST_F(CInterfacePoses, MirrorsAreThoseOfCpp) {
  Jets mirrored = pose("walk", 0.3);
  ASSERT_EQ(sinew_asset_mirror(asset, c(mirrored), joints), SINEW_OK) << sinew_last_reason();
  MirrorMap<float> map;
  ASSERT_TRUE(build_mirror_map<float>(cpp.skeleton, map));
  Jets wanted = pose("walk", 0.3);
  ASSERT_TRUE((MirrorJob<float>{&map, wanted, wanted}.Run()));
  expect_same(mirrored, wanted);
  int partner = -5;
  ASSERT_EQ(sinew_asset_get_partner(asset, joint(Role::kFootL), &partner), SINEW_OK);
  EXPECT_EQ(partner, joint(Role::kFootR));
  expect_refused(sinew_asset_get_partner(asset, joints, &partner), SINEW_INVALID_ARGUMENT, "joint");
  expect_refused(sinew_asset_mirror(asset, c(mirrored), joints - 1), SINEW_INVALID_ARGUMENT, "fewer joints");
}

TEST_F(CInterfacePoses, TransitionsAreThoseOfCpp) {
  constexpr float kDuration = 0.3f;
  InertialState<float> wanted;
  std::vector<float> offsets(inertial_numbers(joints, joints)), state(5000);
  std::int32_t count = 0;
  for (int frame = 0; frame < 40; ++frame) {
    Jets old = pose("stand", frame / 60.0), jets = pose("walk", 0.2 + frame / 60.0), in_c = jets;
    if (frame == 10) {
      wanted.offsets = offsets;
      wanted.joints = joints;
      EXPECT_EQ(
          sinew_asset_begin_transition(asset, c(old), joints, c(jets), joints, kDuration, nullptr, 0, &count),
          SINEW_TOO_SMALL);
      EXPECT_EQ(sinew_asset_begin_transition(asset, c(old), joints, c(jets), joints, kDuration, state.data(),
                                             5000, &count),
                SINEW_OK)
          << sinew_last_reason();
      EXPECT_GT(count, 144);
      state.resize(std::size_t(count));
      wanted.translated = int(state[3]);
      EXPECT_GE(wanted.translated, 1) << "the root";
      EXPECT_TRUE(begin_inertial<float>(old, jets, kDuration, wanted));
    }
    if (frame < 10) continue;
    if (frame > 10) wanted.elapsed += 1 / 60.f;
    EXPECT_TRUE((InertializeJob<float>{jets, &wanted, {}, jets}.Run()));
    EXPECT_EQ(
        sinew_asset_play_transition(asset, state.data(), count, frame > 10 ? 1 / 60.f : 0.f, c(in_c), joints),
        SINEW_OK)
        << sinew_last_reason();
    expect_same(in_c, jets);
    if (frame == 10) {
      for (int j = 0; j < joints; ++j)
        EXPECT_LT(in_c[std::size_t(j)].rotation.angularDistance(old[std::size_t(j)].rotation), 1e-3f) << j;
    }
    if (frame == 39) expect_same(in_c, pose("walk", 0.2 + frame / 60.0));
  }
  Jets jets = pose("walk", 0);
  for (const std::size_t n : {2, 3}) {
    std::vector<float> broken = state;
    for (const float x : {-1.f, 0.5f, 1e9f, std::nanf("")}) {
      broken[n] = x;
      EXPECT_EQ(sinew_asset_play_transition(asset, broken.data(), count, 0, c(jets), joints),
                SINEW_INVALID_ARGUMENT);
    }
  }
  EXPECT_EQ(sinew_asset_play_transition(asset, state.data(), 3, 0, c(jets), joints), SINEW_INVALID_ARGUMENT);
  EXPECT_EQ(sinew_asset_play_transition(asset, state.data(), count, -1, c(jets), joints),
            SINEW_INVALID_ARGUMENT);
}

TEST_F(CInterfacePoses, LimbsReachAsInCpp) {
  Jets reached = pose("walk", 0.3), wanted = reached;
  const int upper = joint(Role::kUpperArmL), middle = joint(Role::kForearmL), end = joint(Role::kHandL);
  const sinew_transform hand = model(reached)[std::size_t(end)];
  sinew_two_bone limb = initialised(sinew_two_bone_init);
  EXPECT_EQ(limb.keep_end, 1);
  limb.upper = upper;
  limb.middle = middle;
  limb.end = end;
  for (int k = 0; k < 3; ++k) limb.target[k] = double(hand.translation[k]);
  limb.target[2] += 0.0625;
  limb.target_velocity[2] = 0.5;
  limb.weight_rate = 0.25;
  ASSERT_EQ(sinew_asset_two_bone(asset, &limb, c(reached), joints), SINEW_OK) << sinew_last_reason();
  TwoBoneJob<float> job{parents, wanted, upper, middle, end};
  job.target = still<float>(Vec3<double>(limb.target).cast<float>());
  job.target.z().rate = 0.5f;
  job.weight = {1, 0.25f, 0};
  ASSERT_TRUE(job.Run());
  expect_same(reached, wanted);
  const sinew_transform there = model(reached)[std::size_t(end)];
  for (int k = 0; k < 3; ++k) EXPECT_NEAR(double(there.translation[k]), limb.target[k], 1e-4) << "m";

  limb.middle = upper;
  expect_refused(sinew_asset_two_bone(asset, &limb, c(reached), joints), SINEW_INVALID_ARGUMENT, "below");
  limb.target[0] = NAN;
  expect_refused(sinew_asset_two_bone(asset, &limb, c(reached), joints), SINEW_NOT_FINITE, "target");
  expect_same(reached, wanted);
}

TEST_F(CInterfacePoses, JointsAimAsInCpp) {
  Jets aimed = pose("stand", 0), wanted = aimed;
  sinew_aim aim = initialised(sinew_aim_init);
  aim.joint = joint(Role::kHead);
  aim.target[0] = 2;
  aim.target[1] = 1;
  aim.target[2] = 1.5;
  aim.weight = 0.5;
  ASSERT_EQ(sinew_asset_aim(asset, &aim, c(aimed), joints), SINEW_OK) << sinew_last_reason();
  AimJob<float> job{parents, wanted, aim.joint};
  job.target = still<float>(Vec3<float>(2, 1, 1.5f));
  job.weight = TimeJet<float>(0.5f);
  ASSERT_TRUE(job.Run());
  expect_same(aimed, wanted);
  aim.axis[0] = 0;
  expect_refused(sinew_asset_aim(asset, &aim, c(aimed), joints), SINEW_INVALID_ARGUMENT, "unit");
}

TEST_F(CInterfacePoses, LooksAreThoseOfCpp) {
  LookChain<float> chain;
  ASSERT_TRUE(find_look_chain(cpp.skeleton, chain));
  LookState<float> remembered;
  sinew_look_state state{};
  sinew_look look = initialised(sinew_look_init);
  EXPECT_EQ(look.behind, LookSettings<double>().behind);
  look.half_life = 0.1;
  look.step = 1 / 60.;
  for (int frame = 0; frame < 60; ++frame) {
    const double now = frame / 60.;
    const bool other = frame >= 30;
    Jets looked = pose("stand", now), wanted = looked;
    look.target[0] = 2;
    look.target[1] = other ? -1.5 : 1.0;
    look.target[2] = 1;
    look.changed = frame == 30;
    look.before[0] = 2;
    look.before[1] = 1;
    look.before[2] = 1;
    ASSERT_EQ(sinew_asset_look(asset, &look, &state, c(looked), joints), SINEW_OK) << sinew_last_reason();
    const MovingVector<float> before = still<float>(Vec3<float>(2, 1, 1));
    LookAtJob<float> job{parents, wanted, &chain, &remembered};
    job.target = still<float>(Vec3<float>(2, other ? -1.5f : 1.f, 1));
    job.before = frame == 30 ? &before : nullptr;
    job.step = float(1 / 60.);
    job.settings.half_life = 0.1f;
    ASSERT_TRUE(job.Run());
    expect_same(looked, wanted);
    if (HasFailure()) return;
  }
  Jets jets = pose("stand", 0);
  const sinew_look_state whole = state;
  look.weight = 2;
  expect_refused(sinew_asset_look(asset, &look, &state, c(jets), joints), SINEW_INVALID_ARGUMENT, "weight");
  EXPECT_TRUE(std::equal(std::begin(state.numbers), std::end(state.numbers), std::begin(whole.numbers)));
  look.weight = 1;
  state.numbers[7] = NAN;
  expect_refused(sinew_asset_look(asset, &look, &state, c(jets), joints), SINEW_NOT_FINITE, "state");
  expect_refused(sinew_asset_look(asset, &look, nullptr, c(jets), joints), SINEW_INVALID_ARGUMENT, "null");
}

TEST_F(CInterfacePoses, MasksAreReadByName) {
  sinew_asset_info info{};
  info.size = sizeof info;
  ASSERT_EQ(sinew_asset_get_info(asset, &info), SINEW_OK);
  EXPECT_EQ(info.masks, static_cast<int>(cpp.masks.size()));
  EXPECT_EQ(info.events, static_cast<int>(cpp.event_names.size()));
  int mask = -1, count = 0;
  EXPECT_EQ(sinew_asset_find_mask(asset, "no such mask", &mask), SINEW_NOT_FOUND);
  if (!cpp.masks.empty()) {
    ASSERT_EQ(sinew_asset_find_mask(asset, cpp.masks[0].name.c_str(), &mask), SINEW_OK);
    std::vector<float> weights(parents.size()), wanted(parents.size());
    ASSERT_EQ(sinew_asset_get_mask(asset, mask, weights.data(), joints, &count), SINEW_OK);
    cpp.masks[0].write(std::span(wanted));
    EXPECT_EQ(weights, wanted);
  }
  for (std::size_t n = 0; n < cpp.event_names.size(); ++n) {
    sinew_event_info event{};
    event.size = sizeof event;
    ASSERT_EQ(sinew_asset_get_event(asset, static_cast<int>(n), &event), SINEW_OK);
    EXPECT_EQ(event.name, cpp.event_names[n]);
    std::uint32_t number = 0;
    ASSERT_EQ(sinew_asset_find_event(asset, event.name, &number), SINEW_OK);
    EXPECT_EQ(number, event.number);
  }
}

}  // namespace
}  // namespace sinew
