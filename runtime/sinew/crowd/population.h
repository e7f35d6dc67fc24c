// A crowd of one rig of which a few are in a world at a time: those who were pushed, whose muscles are too
// weak for their animation, or whom one of these, or a prop, may touch.
//
//     auto people = Population::create(asset.skeleton, settings, status);
//     for (int i = 0; i < 1000; ++i) (void)people->play(i, {&clip, start[i], place[i]});
//     …each frame:
//     (void)people->push(i, chest, {60, 0, 0});
//     (void)people->step(1 / 60.f, jobs);
//     draw(people->model(i));
//
// Everybody else is sampled and checked in the crowd's batches and costs about as much as playback. Props
// that are awake, and characters of the world's own that are not on their animation, call in whom they may
// touch; what rests, obstacles, and two who play their clips into each other do not. Who is called for enters
// the world in the same step, with the pose and speed that the clip had at its beginning, and leaves it when
// it has been on its animation for a while.
#pragma once

#include <memory>

#include "sinew/character/world.h"
#include "sinew/crowd/crowd.h"

namespace sinew {

/// Of a crowd, and of the world that its overloaded characters enter.
struct PopulationSettings {
  CrowdSettings crowd;          ///< capacity, lanes, chunks; gravity and ground are the world's
  WorldSettings world;          ///< workers, level of detail, budget
  CharacterSettings character;  ///< of those in the world
  int places = 64;              ///< characters that may be in the world at once; each takes memory
};

/// A crowd of which those whose muscles do not suffice, or who are pushed, are simulated in a world until
/// they are back on their clips. Calls of one population do not overlap.
class Population {
 public:
  /// Set-up: allocates everything. Null with `status` set if something cannot be meant.
  static std::unique_ptr<Population> create(const Skeleton& skeleton, const PopulationSettings& settings,
                                            Status& status);
  ~Population();
  Population(const Population&) = delete;
  Population& operator=(const Population&) = delete;

  /// From now on a character plays this clip, on its place. Leaves the world if it was in it.
  Status play(int character, const CrowdTrack& track);
  /// It is gone: out of the world, in its rest pose, called by nobody, until it plays again.
  Status stop(int character);
  /// Of all its muscles, ≥ 0, until it is stopped: on its clip infinity is never overloaded, and it enters
  /// the world as strong. One that is there has it at once.
  Status set_strength(int character, float strength);
  /// Impulse (N·s, world) on the body of a joint, at the joint, in the next step. Refused with kOutOfRange
  /// where the world has no place left.
  Status push(int character, int joint, const Vec3<float>& impulse);

  /// One frame of h seconds. Allocates nothing. Same bits for any number of threads.
  Status step(float h, const ParallelFor& parallel_for = {});

  std::span<const Transform<float>> model(int character) const;  ///< [joint] joint → world
  /// kChecked outside of the world.
  Level level(int character) const;
  /// Whether it is simulated now.
  bool in_world(int character) const;
  /// Which of the world's characters it is now, or -1.
  int place(int character) const;
  /// Its handle while it is in the world.
  Character<float> solved(int character);
  int solved_count() const;  ///< characters that are in the world
  /// Characters that were called for in the last step and found no place: they stay on their clips.
  int turned_away() const;
  /// Props, obstacles, report. Its characters belong to the population.
  World<float>& world();
  /// Those on their clips.
  Crowd& crowd();
  int capacity() const;  ///< characters, as set up

  // Snapshots: what the next step depends on, as flat bytes; those of the world (World::save) and 64 bytes
  // for each character. A population set up the same way, with the same props, obstacles and clips, restored
  // and given the same inputs, goes on to the bit. Pushes are inputs of the world: World::save_inputs() has
  // those that wait. Allocates nothing.

  /// Bytes that a snapshot takes at most.
  std::size_t snapshot_capacity() const;
  /// `clips` hold all that anybody plays: the snapshot tells them by their place in there. `written`: bytes;
  /// kOutOfRange where `out` is too small.
  Status save(std::span<const Clip> clips, std::span<std::byte> out, std::size_t& written);
  /// Refuses what save() of such a population did not write, with nothing moved. `clips` are as they were
  /// there. Poses are there at once; overloaded() and loads of the crowd are those of this moment.
  Status restore(std::span<const Clip> clips, std::span<const std::byte> snapshot);

 private:
  struct Impl;
  explicit Population(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace sinew
