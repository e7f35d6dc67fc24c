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

#include <vector>

#include "sinew/graph/graph_step.h"

namespace sinew {

/// What a recorded frame is known by.
template <class T>
struct GraphFrame {
  std::uint64_t number = 0;     ///< since the recorder began
  std::uint64_t digest = 0;     ///< of the block and the pose after it
  T h = 0;                      ///< s
  std::uint32_t joints = 0;     ///< that were posed
  std::uint32_t rays = 0;       ///< that were cast
  std::uint32_t bodies = 0;     ///< GraphGround::bodies
  std::uint32_t durations = 0;  ///< that GraphMuscles was asked for
  std::uint32_t bytes = 0;      ///< that it takes in the recording
  bool whole = false;           ///< the block before it is there; else what the game changed of it
  bool physical = false;        ///< GraphStepJob::physical was shown, and is kept
  bool ground = false;          ///< GraphGround::below was there, where the graph has feet
  bool muscles = false;         ///< GraphMuscles::duration was there
  /// All that went in has found room: no more than 64 rays (frames of a sixth of a second), 8 bodies and 16
  /// durations.
  bool complete = true;
};

/// A frame is kept as all that went in: what the game changed of the block since the frame before, what rays
/// met, and whatever else the frame made use of. The buffer is a ring of pages, of at most 200 frames each,
/// that begin with a whole block, from which the others are repeated; the oldest page makes room for the next
/// one. A frame takes 24 bytes, 12 and more for each parameter that was set, 5 and more for each ray; a
/// physical pose that is shown takes 76 for each joint (float). Allocates nothing; costs some copies and a
/// comparison of the block, and a digest of what came out.
template <class T>
class GraphRecorder {
 public:
  /// Of a buffer that always holds so many of the last frames, as long as they take 100 bytes on average (150
  /// where the graph has feet; twice that in double precision); what is negative counts as 0.
  static std::size_t bytes_for(const Graph& graph, int frames);

  /// Goes on with what a recorder of this graph wrote into the buffer, and begins anew in any other. The
  /// buffer begins at a multiple of 16; one too small for three frames records nothing.
  GraphRecorder(const Graph& graph, std::span<std::byte> buffer);

  /// Runs the job, and keeps what went in. Answers as the job does.
  Status step(const GraphStepJob<T>& job);

 private:
  std::byte* begin_frame(bool whole);

  std::size_t block_bytes_ = 0, most_ = 0;  ///< of a block; of a frame with one
  std::span<std::byte> buffer_;
};

/// Repeats frames of a recording.
template <class T>
class GraphReplay {
 public:
  /// What a ray of a frame met.
  struct Ray {
    GroundHit<T> hit;  ///< where `met`
    bool met = false;  ///< it met something
  };

  /// The graph is the recorded one, bound to the same asset. Allocates; the recording must outlive it, and is
  /// not to change.
  GraphReplay(const Graph& graph, std::span<const std::byte> recording);

  /// What is wrong with the recording: another graph's, cut off, damaged.
  Status Validate() const { return status_; }
  int count() const { return static_cast<int>(at_.size()); }  ///< frames, the oldest first; 0: Validate()
  GraphFrame<T> info(int k) const;                            ///< of one of them

  /// Puts `state` where it was before the frame: as it was at the frame before, if that was repeated last;
  /// else by repeating all frames from the last whole block on, at most 200. Spans as of frame().
  Status before(int k, GraphScratch<T>& scratch, std::span<std::byte> state, std::span<JointJet<T>> jets);
  /// The same, and plays it. `same`: block and pose are what they were, to the bit; once that is false, it is
  /// so up to the next whole block. `jets` [joint]: all of the graph. Errors are the frame's own, or that it
  /// was not complete.
  Status frame(int k, GraphScratch<T>& scratch, std::span<std::byte> state, std::span<JointJet<T>> jets,
               bool& same, EventSink* events = nullptr);
  /// Of the frame that was repeated last, in the order in which they were cast.
  std::span<const Ray> rays() const { return rays_; }

 private:
  struct Answers;
  Status index();
  bool set_block(int k);
  Status copy_block(std::span<std::byte> state) const;
  Status play(int k, GraphScratch<T>& scratch, std::span<JointJet<T>> jets, EventSink* events, bool& same);

  const Graph& graph_;
  std::span<const std::byte> bytes_;
  std::uint64_t first_ = 0;      ///< number of the oldest frame
  std::vector<std::size_t> at_;  ///< [frame] where it begins in the recording
  GraphMemory block_;            ///< after the frame that was repeated last
  int after_ = -1;               ///< which one that was; −1: none
  int before_ = -1;              ///< instead, the frame that block_ is the one before
  std::vector<Ray> rays_;
  Status status_;
};

/// Of any bytes whose number is a multiple of 8: for files to tell damage by.
std::uint64_t digest_of(std::span<const std::byte> bytes, std::uint64_t seed = 14695981039346656037u);

extern template class GraphRecorder<float>;
extern template class GraphRecorder<double>;
extern template class GraphReplay<float>;
extern template class GraphReplay<double>;

}  // namespace sinew
