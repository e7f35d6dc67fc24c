// The last frames of a character's graph, in the game's own buffer: to look at after something went wrong.
//
//     std::vector<std::byte> ring(sinew::GraphRecorder<float>::bytes_for(graph, 120));  // one a character
//     sinew::GraphRecorder<float> recorder(graph, ring);
//     world.keep_with_state(ring);                                   // snapshots and recordings hold it, too
//     recorder.step(job);                                            // in place of job.Run()
//
//     sinew::GraphReplay<float> replay(graph, ring);                 // later, or elsewhere from a file
//     for (int k = 0; k < replay.count(); ++k) replay.frame(k, scratch, state, jets, found);
#pragma once

#include "sinew/graph/graph_step.h"

namespace sinew {

/// What a recorded frame is known by.
template <class T>
struct GraphFrame {
  std::uint64_t number = 0;  ///< since the recorder began
  std::uint64_t digest = 0;  ///< of the block and the pose after it
  T h = 0;                   ///< s
  std::uint32_t joints = 0;  ///< that were posed
  std::uint32_t rays = 0;    ///< that were cast
  std::uint32_t bodies = 0;  ///< GraphGround::bodies
  bool physical = false;     ///< GraphStepJob::physical was given, and kept: some node asks for it
  bool spare = false;        ///< GraphStepJob::spare_acceleration, where some transition has a budget
  bool ground = false;       ///< GraphGround::below, where the graph has feet
  /// All that went in has found room: no more than 64 rays (frames of a sixth of a second) and 8 bodies.
  bool complete = true;
};

/// Where in a recording what stands, in bytes; of a graph and a precision always the same.
struct GraphRecordingLayout {
  std::size_t block = 0;     ///< in a frame, behind its GraphFrame: the block before it
  std::size_t rays = 0;      ///< what they met, in their order; no bytes where the graph has no feet
  std::size_t bodies = 0;    ///< body → world; likewise
  std::size_t physical = 0;  ///< JointJet, [joint]; no bytes where no node asks for it
  std::size_t spare = 0;     ///< rad/s², [joint]; no bytes where no transition has a budget
  std::size_t slot = 0;      ///< of a whole frame
};

/// Each frame is kept as the block before it, with all that the game set, and everything else that went in,
/// so that it can be repeated alone. Allocates nothing; costs some copies, and a digest of what came out.
template <class T>
class GraphRecorder {
 public:
  /// Of a buffer for so many frames; what is negative counts as 0.
  static std::size_t bytes_for(const Graph& graph, int frames);

  /// Goes on with what a recorder of this graph wrote into the buffer, and begins anew in any other. The
  /// buffer begins at a multiple of 16; one too small for a frame records nothing.
  GraphRecorder(const Graph& graph, std::span<std::byte> buffer);

  /// Runs the job, and keeps what went in. Answers as the job does.
  Status step(const GraphStepJob<T>& job);

 private:
  std::byte* next();
  void keep(const GraphStepJob<T>& job, std::byte* slot) const;

  GraphRecordingLayout at_;
  std::span<std::byte> buffer_;
};

/// Repeats frames of a recording.
template <class T>
class GraphReplay {
 public:
  /// The graph is the recorded one, bound to the same asset.
  GraphReplay(const Graph& graph, std::span<const std::byte> recording);

  /// What is wrong with the recording: another graph's, cut off.
  Status Validate() const;
  int count() const;                               ///< frames, the oldest first; 0 where Validate() fails
  GraphFrame<T> info(int k) const;                 ///< of one of them
  std::span<const std::byte> before(int k) const;  ///< the block before it

  /// What ray `ray` of the frame met; false for nothing.
  bool ray(int k, int ray, GroundHit<T>& hit) const;

  /// Puts `state` where it was before the frame, and plays that. `same`: block and pose are what they were,
  /// to the bit. Errors are the frame's own, or that it was not complete.
  Status frame(int k, GraphScratch<T>& scratch, std::span<std::byte> state, std::span<JointJet<T>> jets,
               bool& same, EventSink* events = nullptr) const;

 private:
  const std::byte* slot(int k) const;

  const Graph& graph_;
  GraphRecordingLayout at_;
  std::span<const std::byte> bytes_;
};

/// Of any bytes whose number is a multiple of 8: for files to tell damage by.
std::uint64_t digest_of(std::span<const std::byte> bytes, std::uint64_t seed = 14695981039346656037u);

extern template class GraphRecorder<float>;
extern template class GraphRecorder<double>;
extern template class GraphReplay<float>;
extern template class GraphReplay<double>;

}  // namespace sinew
