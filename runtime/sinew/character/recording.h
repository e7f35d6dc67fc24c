// Runs of a world that repeat to the bit: the state at the start, the inputs of every step, and the state
// after it.
//
//     Recorder<float> recorder(world);       // in place of world.step(h) call
//     recorder.step(h);                      // …
//     keep(recorder.bytes());
//
//     ReplayReport report;
//     replay(same_world, bytes, report);     // stops at the first byte that differs and names its field
//
// A tool for finding what differs between machines, builds or inputs; the recording grows (allocates) by a
// few kB per character and step. What the host does to a world between two steps besides targets and impulses
// (strengths, root drives, resets, props put elsewhere) is recorded as the whole state.
#pragma once

#include <vector>

#include "sinew/character/world.h"

namespace sinew {

/// Steps a world, on the caller's thread alone, and writes down what replay() needs.
template <class T>
class Recorder {
 public:
  /// Begins with the world's present state; the world must outlive the recorder.
  explicit Recorder(World<T>& world);

  /// Steps the world and records the step; a refused step is not recorded.
  Status step(T h);
  /// The recording so far; valid until the next step().
  std::span<const std::byte> bytes() const { return bytes_; }

 private:
  World<T>& world_;
  std::vector<std::byte> bytes_, state_, before_, inputs_;
};

/// How far a replay went, and where it left the recording.
struct ReplayReport {
  int steps = 0;         ///< that were repeated, the differing one included
  bool same = true;      ///< every byte after every step
  std::size_t byte = 0;  ///< otherwise: the first of the snapshot that differs,
  SnapshotField field;   ///< and what it stands for
};

/// Repeats a recording in a world set up as the recorded one was, in any state. An error where the recording
/// does not fit the world or is damaged.
template <class T>
Status replay(World<T>& world, std::span<const std::byte> recording, ReplayReport& report);

#define SINEW_RECORDING_INSTANCES(prefix, T) \
  prefix class Recorder<T>;                  \
  prefix Status replay<T>(World<T>&, std::span<const std::byte>, ReplayReport&);
SINEW_RECORDING_INSTANCES(extern template, float)
SINEW_RECORDING_INSTANCES(extern template, double)

}  // namespace sinew
