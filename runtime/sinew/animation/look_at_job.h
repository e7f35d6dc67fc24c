// Looking at something with the whole upper body: spine, neck and head each take their share.
#pragma once

#include <cmath>
#include <span>

#include "sinew/animation/look_chain.h"
#include "sinew/animation/moving_transform.h"
#include "sinew/animation/smooth_input.h"

namespace sinew {

/// How far and how fast a look turns.
template <class T>
struct LookSettings {
  T yaw = T(1.4);         ///< rad, to either side; ≥ softness, < 3.1
  T pitch_down = T(0.9);  ///< rad; ≥ softness, ≤ 1.5 with it
  T pitch_up = T(0.8);    ///< rad; the same
  T softness = T(0.2);    ///< rad, > 0: limits are reached in as much before and beyond them
  T behind = T(0.35);     ///< rad: as far as a target behind has to pass for the side to change
  T fastest = T(6);       ///< rad/s, of a turn to another target or to the other side
  T least_time = T(0.2);  ///< s, of such a turn
  /// s; 0: the aim is exact while the target moves. Else all turns lag, and none is faster than `limit_of`.
  T half_life = 0;

  /// rad/s, that the direction never exceeds with a lag, whatever the target does: three poles' largest rate
  /// after a step from one end of the range to the other.
  T limit_of() const {
    const T high = pitch_up + pitch_down + 2 * softness, wide = 2 * (yaw + softness);
    return T(0.2707) * SmoothInput<T>::pole_of(half_life) * std::sqrt(wide * wide + high * high);
  }
};

/// What a look remembers; a snapshot copies it.
template <class T>
struct LookState {
  /// Yaw and pitch, rad: what is left of those that were looked at when the target changed, and, with a lag,
  /// those that are.
  struct Track {
    TimeJet<T> offset[2] = {{T(0)}, {T(0)}};  ///< yaw, pitch, when the target changed; fades as a quintic
    SmoothInput<T> angles[2];                 ///< yaw, pitch, that are looked at; only with a lag
  };
  bool started = false;  ///< false: the next run looks at its target at once
  int side = 1;          ///< 1 left, −1 right: where a target behind is looked for
  Track body;            ///< as seen from where the animation has the last joint, for all others
  Track head;            ///< as seen from where they have carried it, for the last joint
  T elapsed = 0;         ///< s since the offsets began to fade
  T duration = 0;        ///< s, until they have
};

/// Turns a chain so that its last joint looks at the target, from wherever the turn of the others has carried
/// it: exactly, within the limits. Yaw and pitch are limited softly, each for itself. A target behind is
/// looked for on the side where it was, until it has clearly passed to the other. Turns to that side and to
/// another target fade as a quintic, in the axes of the base. Exact derivatives, C². Allocates nothing.
///
/// A target that is lost: let `weight` go to 0 (SmoothInput). Straight above and below, yaw means nothing and
/// fades to 0 from 60° of pitch on.
template <class T>
struct LookAtJob {
  std::span<const int> parents;                         ///< [joint]
  std::span<JointJet<T>> jets;                          ///< [joint] local; the chain's are changed
  const LookChain<T>* chain = nullptr;                  ///< who looks
  LookState<T>* state = nullptr;                        ///< the caller's, one per look
  MovingVector<T> target = still<T>(Vec3<T>::UnitX());  ///< m, model space
  /// The target up to now, with where it is at this instant: in the run in which it changes, else null.
  const MovingVector<T>* before = nullptr;
  TimeJet<T> weight{T(1)};        ///< 0 … 1
  T step = 0;                     ///< s since the last run
  LookSettings<T> settings = {};  ///< limits and speeds

  Status Validate() const;  ///< `Status::index`: joint at fault
  /// Refuses as well a target within 0.1 mm of the last joint, which leaves all as it was, and one straight
  /// behind where the chain looks: the state has moved on then, and joints above the one at fault have
  /// turned.
  Status Run() const;
};

extern template struct LookAtJob<float>;
extern template struct LookAtJob<double>;

}  // namespace sinew
