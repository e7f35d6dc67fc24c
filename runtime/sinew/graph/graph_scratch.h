// What one thread needs to play a graph for any number of characters, one after another.
#pragma once

#include <span>
#include <vector>

#include "sinew/animation/clip_time.h"
#include "sinew/animation/event_job.h"
#include "sinew/animation/moving_transform.h"
#include "sinew/graph/graph_state.h"

namespace sinew {

/// A step of making a pose, on registers: GraphUpdateJob writes them, GraphPoseJob carries them out.
struct GraphTask {
  /// What the step does to its registers.
  enum class Kind : std::uint8_t {
    kSample,       ///< clip `index` at `time` → out
    kPhysical,     ///< the character's physical pose → out
    kBlend,        ///< `count` registers from `out` on, mixed by weights → out
    kCrossfade,    ///< out and out + 1, by one weight → out
    kMirror,       ///< left and right of out exchanged
    kLayer,        ///< out + 1 upon out; `index`: node, `layer`
    kKeep,         ///< copies out to `from`
    kBeginOffset,  ///< `from` at the instant of a change, out what follows; `index`: machine, `layer`:
                   ///< transition
    kOffset,       ///< what is left of it upon out
    kLeave,        ///< keeps `from` as the pose left behind
    kLeft,         ///< fades from the pose left behind to out
    kTravel,       ///< out goes over the ground as parameters say; `index`: node
    kFeet,         ///< of the whole pose, where the character stands; `index`: node, by one weight
    kLook,         ///< likewise
  };
  Kind kind = Kind::kSample;  ///< says which of the others it uses
  bool at_change = false;     ///< at the instant of a change, before the frame
  bool whole = false;         ///< all joints, whatever level of detail
  std::uint16_t out = 0;      ///< register that it leaves its motion in
  std::uint16_t from = 0;     ///< register, see Kind
  std::uint16_t count = 0;    ///< registers, see Kind
  int index = 0;              ///< clip, node or machine, see Kind
  int layer = 0;              ///< see Kind
  int weights = 0;            ///< first of GraphScratch::weights
  ClipTime time;              ///< kSample: of the clip; of fades value and rate are s elapsed, s in all
};

/// Registers, and the steps to take on them. Fits the graph that it was made for, and no other; one at a time
/// uses it, and from an update to the pose that follows it belongs to one character.
template <class T>
struct GraphScratch {
  static constexpr std::size_t kMostHits = 64;  ///< events of one clip in one frame
  /// Allocates; nothing after this does.
  explicit GraphScratch(const Graph& graph);

  /// One motion.
  struct Register {
    std::span<JointJet<T>> jets;   ///< [joint] the root without its travel
    std::span<TimeJet<T>> curves;  ///< [slot]
    TravelVelocity<T> travel;      ///< of the root over the ground
  };
  /// A clip that plays by its group's phase.
  struct Member {
    int task;                ///< that samples it
    int clip;                ///< of Graph::clips()
    int group;               ///< of GraphDefinition::groups
    TimeJet<double> weight;  ///< ≥ 0, in the whole pose
  };
  std::uint64_t hash;                                 ///< of the graph that it was made for
  std::vector<JointJet<T>> jets;                      ///< [register][joint]
  std::vector<TimeJet<T>> curves;                     ///< [register][slot]
  std::vector<Register> registers;                    ///< on these two; the first has the pose at the end
  std::vector<std::vector<T>> masks;                  ///< [mask][joint]
  std::vector<std::vector<Transform<T>>> references;  ///< [layer][joint], of the additive ones
  std::vector<Transform<T>> rest;                     ///< [joint] joint → parent
  std::vector<MovingRotation<T>> rotations;           ///< two per joint
  std::vector<T> offset;                              ///< of the transition that is carried out
  std::vector<JointJet<T>> left;                      ///< [joint] the pose left behind by it, or a reference
  std::vector<T> profile;                             ///< [joint] of a transition, parts of its duration

  // Of one update:
  std::vector<GraphTask> tasks;     ///< in the order in which they are carried out
  int task_count = 0;               ///< of `tasks`, in use
  std::vector<TimeJet<T>> weights;  ///< that tasks refer to
  int weight_count = 0;             ///< of `weights`, in use
  std::vector<Member> members;      ///< synchronised clips that were sampled
  int member_count = 0;             ///< of `members`, in use
  /// A machine that has begun to fade from what it did.
  struct Change {
    int machine;  ///< of Graph::machines()
    int kept;     ///< register of what it did up to the change
  };
  std::vector<Change> changes;             ///< of this frame
  int change_count = 0;                    ///< of `changes`, in use
  std::vector<PhaseMember> phase_members;  ///< of one group
  std::vector<ClipTime> times;             ///< of these
  std::vector<double> before;              ///< [clip] clip time at the last frame, of those not synchronised
  std::vector<double> now;                 ///< [clip] and now, of those that are
  std::vector<double> phases;              ///< [group] at the last frame
  std::vector<EventHit> hits;              ///< of one clip
  std::vector<float> shares;               ///< [clip] weight in this frame; < 0: not played
  T h = 0;                                 ///< s, of this frame
  bool shows_physical = false;             ///< since a recorder looked, a pose was of GraphPoseJob::physical
};

/// Refuses none, and that of another graph.
template <class T>
Status check_scratch(const Graph& graph, const GraphScratch<T>* scratch);

/// @cond
extern template Status check_scratch<float>(const Graph&, const GraphScratch<float>*);
extern template Status check_scratch<double>(const Graph&, const GraphScratch<double>*);
/// @endcond
extern template struct GraphScratch<float>;
extern template struct GraphScratch<double>;

}  // namespace sinew
