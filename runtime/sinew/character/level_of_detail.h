// How much work a character gets: asleep, played, checked, solved in part, in whole, with substeps.
//
// Nobody switches this by hand. A character goes up at once, in the step in which its muscles, a push or a
// neighbour call for it, and down when it has not needed its level for a while. Between a clip and a solve
// the pose is the same, so neither is seen. The host may cap a character (CharacterDetail), or give the world
// a budget per step, which then caps the least significant ones.
#pragma once

#include <array>
#include <cstdint>

#include "sinew/skeleton/status.h"

namespace sinew {

/// Seed talk, "Bake" and "LOD"; states after research/hard-cases-and-solvers.md, section 4.2.
enum class Level : std::uint8_t {
  kAsleep,    ///< limp and at rest: nothing is computed
  kPlayback,  ///< on the clip, or on a smooth return to it; what its muscles can do is not asked
  kChecked,   ///< on the clip, which its muscles can follow
  kPartial,   ///< some degrees of freedom are solved for
  kFull,      ///< all are
  kSubsteps,  ///< all or some are, in parts of a step
};
constexpr int kLevelCount = 6;  ///< of Level

/// What the host asks for one character; part of its state, like its strength.
struct CharacterDetail {
  /// The budget takes from the least significant first: size on the screen, say.
  double significance = 1;
  /// At most this. kPlayback and kChecked hold for characters whose every joint has a muscle; the others
  /// have no clip to fall back on, and are solved. kPartial solves without substeps, and with `bake`.
  Level most = Level::kSubsteps;
  /// Steps from one check of the muscles to the next, for those far away, while nothing pushes or touches
  /// them; in between they are played.
  int check_every = 1;
  /// Hands, feet and toes are dynamic in one of LevelOfDetail::bake_every steps, and where a blow or a touch
  /// calls for it (CharacterReport::unbaked); in the others they move by themselves, as their own muscles and
  /// inertia have it, and the rest of the body is solved for as if they were animated (baking.h).
  bool bake = false;
};

/// Refuses a significance that is not finite (kNotFinite) and a check_every that is not from 1 to 1000
/// (kOutOfRange).
Status validate(const CharacterDetail& detail);

/// How much a step may cost, all characters and props together. 0: no limit.
struct Budget {
  double limit = 0;  ///< µs by `clock`; without one, units of work (see WorldReport::cost)
  /// Time in µs, from any thread. Without it work is counted instead: the same on every machine, so that runs
  /// repeat to the bit.
  double (*clock)(void* context) = nullptr;
  void* clock_context = nullptr;  ///< what `clock` gets
};

/// When the characters of a world go from level to level.
struct LevelOfDetail {
  /// s, that a level is kept after it was last needed, and that a cap of the budget stays at least: nobody
  /// goes up and down more than once in this time while the load is steady.
  double dwell = 1;
  /// s at rest after which what is limp, or follows a target that stands still, falls asleep, together with
  /// everything near it. 0: never. Touch, a push, a new target, strength or drive wake it.
  /// These three are a figure's of human size; others' are in proportion (residual/scale.h).
  double sleep_after = 0;
  double sleep_speed = 0.01;  ///< m/s of every body's centre; below, it rests
  double sleep_spin = 0.05;   ///< rad/s
  int bake_every = 4;         ///< the talk: wrists and ankles are dynamic a quarter of the time
  /// 1/s. Above 0 baked joints move as the talk has it, q'' = −k·q', whatever their arm does and nothing
  /// calls for a solve: for comparisons. 0: by themselves (baking.h).
  double baked_decay = 0;
  Budget budget;  ///< for steps; caps the least significant
};

/// What the last step did with the whole world.
struct WorldReport {
  /// µs by the budget's clock, summed over workers; without a clock, units of work, of which one is about a
  /// nanosecond on the machine that the weights were fitted on (levels.cpp).
  double cost = 0;
  double forecast = 0;                        ///< the same, smoothed over 0.2 s: what the budget goes by
  std::array<int, kLevelCount> characters{};  ///< at each level
  int capped = 0;                             ///< characters that the budget holds down
};

}  // namespace sinew
