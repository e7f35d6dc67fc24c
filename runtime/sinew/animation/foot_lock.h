// One foot on whatever ground there is: where it is wanted, and where it stays while it bears.
//
// Everything is in model space, the axes of the root's parent, which must be level (Z up); the ground may
// move there. Lengths in metres.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "sinew/animation/moving_transform.h"
#include "sinew/animation/smooth_input.h"

namespace sinew {

/// What a ray of the host met in this frame.
template <class T>
struct GroundHit {
  Vec3<T> point = Vec3<T>::Zero();    ///< m
  Vec3<T> normal = Vec3<T>::UnitZ();  ///< unit, upwards
  int ground = -1;                    ///< index of the body that was met; −1: what does not move
};

/// What the host knows of a foot in a frame. Cast rays from above the toe, from above the heel, and from
/// where the toe will be within 0.3 s (from poses of the clip ahead): a foot has to rise before a stair and
/// not in it. Of all that were met the highest under the foot counts. No hits: the foot keeps the ground it
/// had.
template <class T>
struct FootInput {
  T contact = 0;                             ///< 0 … 1, that the foot rests
  std::span<const GroundHit<T>> under = {};  ///< the foot as it is
  std::span<const GroundHit<T>> ahead = {};  ///< on its way; not for a foot that comes to rest
};

/// When a foot locks, and how it comes and goes. FootPlacementJob says what is out of range.
template <class T>
struct FootSettings {
  T lock_at = T(0.6);       ///< contact weight from which a foot locks, ≤ 1
  T release_at = T(0.4);    ///< contact weight below which it leaves, in [0, lock_at]
  T lock_time = T(0.1);     ///< s, until a foot that comes down rests
  T release_time = T(0.2);  ///< s, until a foot that leaves is back on the animation
  T half_life = T(0.1);     ///< s, of steps of the ground under a foot that is free
  T farthest = T(0.2);      ///< m, from the animation on the ground: a lock breaks, and may close anew
  T steepest = T(0.85);     ///< rad: steeper ground is taken for a wall, and as level where it was met
};

/// What of a foot stays on the ground.
enum class FootHold : std::uint8_t {
  kFree,  ///< nothing: it goes as animated
  kToe,   ///< the toe stays, the heel may rise
  kHeel,  ///< the heel stays, the toe comes down
};

/// What a foot remembers; a snapshot copies it. {} for a character that appears.
template <class T>
struct FootState {
  FootHold hold = FootHold::kFree;                  ///< what of it stays
  bool started = false;                             ///< it has found a ground, see find_ground()
  int ground = -1;                                  ///< of the plane below
  std::array<T, 3> point = {};                      ///< of the plane, in that ground's axes
  std::array<T, 3> normal = {};                     ///< unit
  std::array<T, 3> lock = {};                       ///< where the toe or heel stays, in that ground's axes
  SmoothInput<T> height;                            ///< m, what is left of planes before
  SmoothInput<T> slope[2];                          ///< of their gradients
  TimeJet<T> offset[3] = {{T(0)}, {T(0)}, {T(0)}};  ///< m, of toe or heel, when `hold` changed
  TimeJet<T> grip{T(0)};                            ///< 1 = on the ground, less than what it tends to
  T elapsed = 0;                                    ///< s since `hold` changed
  T duration = 0;                                   ///< s, until `offset` and `grip` have faded

  /// Its toe or its heel stays.
  bool locked() const { return hold != FootHold::kFree; }
  /// Locked, and at rest relative to the ground.
  bool at_rest() const { return locked() && elapsed >= duration; }
};

/// What the animation wants of a foot at an instant.
template <class T>
struct FootMotion {
  MovingTransform<T> foot;  ///< foot joint → model
  Vec3<T> toe;              ///< m, foot joint's axes: point of the sole under the ball
  Vec3<T> heel;             ///< m, foot joint's axes: point of the sole under the heel; = toe: a point foot
  MovingVector<T> toe_at;   ///< m, `toe` in model space
  MovingVector<T> heel_at;  ///< m, `heel` in model space
  TimeJet<T> level;         ///< m, height of the ground that the animation walks on

  FootMotion() = default;
  /// In the order of the members; what is in model space follows.
  FootMotion(const MovingTransform<T>& joint, const Vec3<T>& under_ball, const Vec3<T>& under_heel,
             const TimeJet<T>& floor)
      : foot(joint),
        toe(under_ball),
        heel(under_heel),
        toe_at(joint * under_ball),
        heel_at(under_heel == under_ball ? toe_at : joint * under_heel),
        level(floor) {}
};

/// A foot's target: where its joint shall be, and how it lies.
template <class T>
struct FootTarget {
  MovingVector<T> ankle;       ///< m, model space: origin of the foot joint
  MovingRotation<T> rotation;  ///< foot joint → model
};

/// Moves a foot's state h seconds on.
template <class T>
void step_foot(const FootSettings<T>& settings, T h, FootState<T>& state);

/// Chooses the ground for a foot that is not locked. What changes by it fades in `state`: the target does not
/// jump. `grounds` [GroundHit::ground] body → model.
template <class T>
void find_ground(const FootMotion<T>& motion, const FootSettings<T>& settings, const FootInput<T>& input,
                 std::span<const MovingTransform<T>> grounds, FootState<T>& state);

/// Where the foot goes at this instant. Turned as the ground leans; neither end of the sole in it.
template <class T>
FootTarget<T> foot_target(const FootMotion<T>& motion, std::span<const MovingTransform<T>> grounds,
                          const FootState<T>& state);

/// Locks, changes from heel to toe, or releases, as `contact` (0 … 1) and the distance ask. `reached`: the
/// leg is long enough. The target of this instant stays as it is, with its rates; from then on it tends to
/// the new goal by a quintic.
template <class T>
void change_hold(const FootMotion<T>& motion, const FootSettings<T>& settings, T contact, bool reached,
                 std::span<const MovingTransform<T>> grounds, FootState<T>& state);

#define SINEW_FOOT_LOCK_INSTANCES(prefix, T)                                                              \
  prefix template void step_foot<T>(const FootSettings<T>&, T, FootState<T>&);                            \
  prefix template void find_ground<T>(const FootMotion<T>&, const FootSettings<T>&, const FootInput<T>&,  \
                                      std::span<const MovingTransform<T>>, FootState<T>&);                \
  prefix template FootTarget<T> foot_target<T>(const FootMotion<T>&, std::span<const MovingTransform<T>>, \
                                               const FootState<T>&);                                      \
  prefix template void change_hold<T>(const FootMotion<T>&, const FootSettings<T>&, T, bool,              \
                                      std::span<const MovingTransform<T>>, FootState<T>&);
SINEW_FOOT_LOCK_INSTANCES(extern, float)
SINEW_FOOT_LOCK_INSTANCES(extern, double)

}  // namespace sinew
