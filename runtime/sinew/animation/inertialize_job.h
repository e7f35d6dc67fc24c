// Transitions that play one motion only: the difference at the switch fades away on top of it.
#pragma once

#include <span>

#include "sinew/animation/clip.h"

namespace sinew {

/// How far a character's motion was from the one that it changed to, when it changed. The caller owns the
/// numbers: a plain block that snapshots copy.
template <class T>
struct InertialState {
  std::span<T> offsets;  ///< `inertial_numbers(joints, translated)`
  int joints = 0;        ///< whose rotations differ, from the first on
  /// The first joints whose translations differ too (the others take the new motion's): 1 where nothing but
  /// the root moves against its parent.
  int translated = 0;
  T elapsed = 0;   ///< s since the change; the caller moves it on
  T duration = 0;  ///< s until nothing is left

  /// Something is left.
  bool running() const { return elapsed < duration; }
};

/// Length of InertialState::offsets: nine numbers for each rotation and for each translation that differ,
/// both rounded up to sixteen joints.
constexpr std::size_t inertial_numbers(int joints, int translated) {
  return 144 * (std::size_t(joints + 15) / 16 + std::size_t(translated + 15) / 16);
}

/// Begins a transition: `now` is what the character did up to this instant, whatever made it do so (another
/// transition included, so that interrupting one costs nothing and loses nothing), `next` what the new motion
/// does at this instant. Resets `elapsed`. Spans hold state.joints at least. Refuses a duration that is not
/// within 0 and 1000 s, and `offsets` that are too short: then `state` is left as it was.
template <class T>
Status begin_inertial(std::span<const JointJet<T>> now, std::span<const JointJet<T>> next, T duration,
                      InertialState<T>& state);

/// The shortest duration within [least, most] (s) in which no joint's fading offset adds more than
/// `acceleration` [joint] (rad/s², > 0) to what it begins with: what a muscle can spare, (its limit − what
/// the new motion asks of it) / the inertia that it moves. See `shortest_fade`.
template <class T>
T inertial_duration(const InertialState<T>& state, std::span<const T> acceleration, T least = T(0.08),
                    T most = T(0.6));

/// Adds to a motion what is left of the offset: rotations as modified Rodrigues parameters, translations as
/// they are, each by the quintic that meets value, rate and acceleration at the change and ends at rest. So
/// the result is C² at both ends, with exact derivatives:
///
///     out = destination ⊗ b(σ(t)),  ω = b⁻¹ω_d + ω_b,  α = b⁻¹α_d + α_b + (b⁻¹ω_d)×ω_b
///
/// After `duration` the result is the destination itself. Allocates nothing; runs 8 joints at a time where
/// the processor has AVX2, 4 elsewhere, with the same bits. A root that walks: give its body part (see
/// `split_root`), or place the new motion where the character is; its offset is in the frame given.
template <class T>
struct InertializeJob {
  std::span<const JointJet<T>> destination;  ///< [joint] the new motion, at this instant
  const InertialState<T>* state = nullptr;   ///< that begin_inertial() filled in
  std::span<const T> profile = {};  ///< [joint] part of the duration in (0, 1]; empty = 1: arms may be faster
  std::span<JointJet<T>> out;       ///< may be `destination`; shorter means fewer joints

  Status Validate() const;  ///< what Run() refuses: sizes, times, a profile out of range
  Status Run() const;       ///< on an error `out` is left as it was
};

/// A motion that goes on for a while without its source: rates die away with `slowing`, and the acceleration
/// that it had with `loss`, much faster, so that it is not carried far:
///
///     v(t) = v₀·e^(−yt) + (a₀ + y·v₀)·(e^(−yt) − e^(−zt))/(z − y)
///
/// C² from the start on. Faded into a new motion by `crossfade` it is the gentlest transition between poses
/// that are far apart ("dead blending"), at the price of damping what was going on.
template <class T>
struct ExtrapolateJob {
  std::span<const JointJet<T>> from;  ///< [joint] the motion at its last instant
  T elapsed = 0;                      ///< s since then, ≥ 0
  T slowing = 7;                      ///< y, 1/s: half of a rate is gone after 0.69/y
  T loss = 120;                       ///< z > y, 1/s
  std::span<JointJet<T>> out;         ///< may be `from`; shorter means fewer joints

  Status Validate() const;  ///< what Run() refuses: sizes, a time below 0, decays out of order
  Status Run() const;       ///< on an error `out` is left as it was
};

#define SINEW_INERTIAL_INSTANCES(prefix, T)                                                               \
  prefix template Status begin_inertial<T>(std::span<const JointJet<T>>, std::span<const JointJet<T>>, T, \
                                           InertialState<T>&);                                            \
  prefix template T inertial_duration<T>(const InertialState<T>&, std::span<const T>, T, T);              \
  prefix template struct InertializeJob<T>;                                                               \
  prefix template struct ExtrapolateJob<T>;
SINEW_INERTIAL_INSTANCES(extern, float)
SINEW_INERTIAL_INSTANCES(extern, double)

}  // namespace sinew
