// Many characters of one rig that follow their animation: which of them can their muscles not carry along?
//
//     Status status;
//     auto crowd = Crowd::create(asset.skeleton, {.capacity = 1000}, status);
//     for (int i = 0; i < 1000; ++i) (void)crowd->play(i, {&clip, start[i], place[i]});
//     …each frame:
//     crowd->step(1 / 60.0, jobs);
//     for (int i : crowd->overloaded()) promote(i, crowd->jets(i));   // into a World
//     draw(crowd->model(i));
//
// The check is the one that World makes of an undisturbed character with a kinematic root: torques of the
// motion, with the ground's support shared out to the feet, against the muscles' limits. It runs in batches
// of 8 or 16 characters, one per SIMD lane. Pushes and contacts with others are the World's business: promote
// first.
#pragma once

#include <memory>
#include <span>

#include "sinew/animation/clip.h"
#include "sinew/animation/clip_time.h"
#include "sinew/animation/instruction_set.h"
#include "sinew/skeleton/parallel_for.h"
#include "sinew/skeleton/skeleton.h"

namespace sinew {

/// Results have the same bits for every instruction set, number of lanes and number of chunks.
struct CrowdSettings {
  int capacity = 1000;                                      ///< characters
  InstructionSet instruction_set = best_instruction_set();  ///< what this machine has, or less
  int lanes = 0;   ///< characters per batch: 8, 16, or 0 for what the instruction set does best
  int chunks = 1;  ///< that a frame is divided into for the host's threads: a few per thread
  Vec3<double> gravity{0, 0, -9.81};  ///< m/s², world
  bool ground = true;                 ///< shares out its support; false: weights hang from the root
  double ground_height = 0;           ///< m, world
  bool model_poses = true;            ///< write `model`
};

/// What a character plays.
struct CrowdTrack {
  const Clip* clip = nullptr;   ///< valid while it plays; null: the host writes `jets` before every step
  ClipTime time = {};           ///< s, of the clip, with its rates; a step moves it on by h
  Transform<float> place = {};  ///< clip → world
};

/// Many characters of one skeleton on their clips: sampled, checked against their muscles and posed in
/// batches. Knows no contacts; Population hands who is overloaded to a world. Calls of one crowd do not
/// overlap.
class Crowd {
 public:
  /// Set-up: copies the skeleton and allocates everything. Null with `status` set if something cannot be
  /// meant.
  static std::unique_ptr<Crowd> create(const Skeleton& skeleton, const CrowdSettings& settings,
                                       Status& status);
  ~Crowd();
  Crowd(const Crowd&) = delete;
  Crowd& operator=(const Crowd&) = delete;

  /// From now on a character plays this; it stands in its rest pose before. Makes it active.
  Status play(int character, const CrowdTrack& track);
  /// Inactive characters are neither sampled nor posed nor reported; their torques and loads mean nothing.
  Status set_active(int character, bool active);
  /// Inactive, at rest, of strength 1: as if it had never played.
  Status stop(int character);
  /// Of all its muscles, ≥ 0; infinity: never overloaded.
  Status set_strength(int character, float strength);
  float strength(int character) const;  ///< 1 where nobody has set it

  /// One frame: times move on by h (s, ≥ 0), active characters are sampled, checked and posed. Allocates
  /// nothing.
  Status step(double h, const ParallelFor& parallel_for = {});

  /// Active characters whose motion asks for more than a muscle has (or is not finite), ascending.
  std::span<const int> overloaded() const;
  /// Largest |torque| / limit of a character's degrees of freedom, the root's left out.
  float peak_load(int character) const;
  /// N·m (N for translations), degrees of freedom as JointType orders them; the root's is what must hold it.
  float torque(int character, int dof) const;
  int dof_count() const;  ///< of one character
  /// [joint] local, the root's in the world. Those of a clip are made when asked for: a step keeps none.
  std::span<JointJet<float>> jets(int character);
  Vec3<float> root_velocity(int character) const;                ///< m/s, world
  std::span<const Transform<float>> model(int character) const;  ///< [joint] joint → world
  const CrowdTrack& track(int character) const;                  ///< what it plays, at the time that it is at

 private:
  struct Impl;
  explicit Crowd(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace sinew
