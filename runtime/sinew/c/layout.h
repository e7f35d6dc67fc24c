// Poses and jets are the same bytes on both sides of the C interface.
#pragma once

#include <cstddef>
#include <span>

#include "sinew/animation/clip.h"
#include "sinew/animation/clip_time.h"
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

/// What a clip of an asset shows.
sinew_status sample(const Asset& asset, int clip, const ClipTime& time, std::span<JointJet<float>> jets);

}  // namespace sinew::c
