// Poses and jets are the same bytes on both sides of the C interface.
#pragma once

#include <cmath>
#include <cstddef>
#include <span>

#include "sinew/animation/clip.h"
#include "sinew/animation/clip_time.h"
#include "sinew/c/call.h"
#include "sinew/c/sinew.h"
#include "sinew/io/asset.h"

namespace sinew::c {

static_assert(sizeof(sinew_jet) == sizeof(JointJet<float>) && alignof(sinew_jet) == alignof(JointJet<float>));
static_assert(offsetof(sinew_jet, angular_velocity) == offsetof(JointJet<float>, omega));
static_assert(offsetof(sinew_jet, angular_acceleration) == offsetof(JointJet<float>, alpha));
static_assert(offsetof(sinew_jet, translation) == offsetof(JointJet<float>, translation));
static_assert(offsetof(sinew_jet, velocity) == offsetof(JointJet<float>, velocity));
static_assert(offsetof(sinew_jet, acceleration) == offsetof(JointJet<float>, acceleration));
static_assert(sizeof(sinew_transform) == sizeof(Transform<float>));
static_assert(alignof(sinew_transform) == alignof(Transform<float>));
static_assert(offsetof(sinew_transform, translation) == offsetof(Transform<float>, translation));

constexpr const char* kTooMany = "65535 worlds, assets and graphs live already";
constexpr const char* kOtherSkeleton = "the asset's skeleton has not the character's number of joints";

/// `count` ≥ 0 jets at an aligned address.
inline std::span<JointJet<float>> jets_of(sinew_jet* jets, int count) noexcept {
  return {reinterpret_cast<JointJet<float>*>(jets), std::size_t(count)};
}
inline std::span<const JointJet<float>> jets_of(const sinew_jet* jets, int count) noexcept {
  return {reinterpret_cast<const JointJet<float>*>(jets), std::size_t(count)};
}

/// Whether a jet that comes in can be meant; bounds are those of targets (Character::set_target).
inline sinew_status check_jet(const JointJet<float>& jet, int index) noexcept {
  constexpr float kFarthest = 1e6f, kFastest = 1e5f, kSharpest = 1e8f;
  const bool finite = jet.rotation.coeffs().allFinite() && jet.omega.allFinite() && jet.alpha.allFinite() &&
                      jet.translation.allFinite() && jet.velocity.allFinite() && jet.acceleration.allFinite();
  if (!finite) return fail(SINEW_NOT_FINITE, "a jet is not finite", index);
  if (!(std::abs(jet.rotation.norm() - 1) <= 1e-2f))
    return fail(SINEW_INVALID_ARGUMENT, "a jet's rotation is not a unit quaternion", index);
  if (jet.translation.norm() > kFarthest || jet.velocity.norm() > kFastest || jet.omega.norm() > kFastest ||
      jet.acceleration.norm() > kSharpest || jet.alpha.norm() > kSharpest)
    return fail(SINEW_OUT_OF_RANGE, "a jet is absurdly far or fast", index);
  return SINEW_OK;
}

/// What a clip of an asset shows.
sinew_status sample(const Asset& asset, int clip, const ClipTime& time, std::span<JointJet<float>> jets);

}  // namespace sinew::c
