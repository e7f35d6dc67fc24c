// A character's place in its graph: one flat block of bytes, and what stands in it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "sinew/animation/foot_lock.h"
#include "sinew/animation/inertialize_job.h"
#include "sinew/animation/look_at_job.h"
#include "sinew/graph/graph.h"
#include "sinew/graph/graph_keep.h"

namespace sinew {

/// How the root moves over the ground in heading axes: forwards, to the left, and the turn. Each with its
/// velocity (m/s, rad/s) and acceleration. Blends mix these, not places.
template <class T>
struct TravelVelocity {
  T velocity[3] = {};  ///< m/s forwards, m/s to the left, rad/s
  T change[3] = {};    ///< of these in the (turning) heading axes, m/s² and rad/s²
};

/// What a block begins with.
template <class T>
struct GraphHeader {
  std::uint64_t hash;        ///< of the graph that the block belongs to
  double place[2];           ///< m, on the ground
  double heading;            ///< rad, about Z
  TravelVelocity<T> travel;  ///< at the end of the last frame
  std::uint32_t events;      ///< that conditions ask for and the last frame passed, a bit each
  std::uint32_t begun;       ///< the pose of an instant has been shown
};

/// Of one GraphParameter.
template <class T>
struct GraphParameterState {
  T goal;        ///< as the game set it; of a trigger the seconds that it still waits
  TimeJet<T> x;  ///< filtered
};

/// Of a group of clips that step together.
struct GraphGroupState {
  TimeJet<double> phase;  ///< cycles
  std::uint64_t active;   ///< a clip of it plays
};

/// How a machine goes from one state to the next.
enum class GraphFade : std::uint32_t {
  kNone,        ///< nothing fades: no transition runs, or it was a cut
  kOffset,      ///< what was different fades away
  kLeft,        ///< the pose left behind does
  kCrossfade,   ///< the old state still plays
  kSmoothstep,  ///< likewise, by a weight of third degree
};

/// Of a kMachine node.
template <class T>
struct GraphMachineState {
  double time;               ///< s in the present state
  std::int16_t state;        ///< present
  std::int16_t posed;        ///< the one whose pose is shown: `state`, or the one that an empty one follows
  std::int16_t source;       ///< of a crossfade, or −1
  std::int16_t transition;   ///< that runs, or −1
  GraphFade fade;            ///< how that transition goes
  std::int32_t faded_by;     ///< transition whose offset fades, also while a later one fades the machine out
  T elapsed;                 ///< s, of the fade
  T duration;                ///< s, of the fade
  TravelVelocity<T> travel;  ///< what of the travel fades
  TimeJet<T> shown_from;     ///< how far `shown` was from its target when that changed
  T shown_elapsed;           ///< s since then
  T shown_duration;          ///< s, in which that fades
  T shown;                   ///< target: 0 in an empty state, else 1

  /// Whether something of a transition is left.
  bool fading() const { return fade != GraphFade::kNone || shown_elapsed < shown_duration; }
};

/// Of the kFeet node.
template <class T>
struct GraphFeetState {
  FootState<T> legs[2];  ///< left, right
  SmoothInput<T> drop;   ///< m, of FootPlacementJob
  SmoothInput<T> level;  ///< m, world: height of the ground under the character
  T waited;              ///< s, in which no legs were posed
  std::uint32_t begun;   ///< the level is known
};

/// Of a kLook node.
template <class T>
struct GraphLookState {
  LookState<T> look;  ///< of LookAtJob
  T waited;           ///< s, in which it was not posed
};

/// The block, taken apart. Offers what playing needs, and checks no index; games use GraphParameters.
template <class T>
class GraphBlock {
 public:
  /// `state` must pass check_block(); graph and block must outlive this.
  GraphBlock(const Graph& graph, std::span<std::byte> state)
      : graph_(graph), at_(graph.layout<T>()), data_(state.data()) {}

  /// Place, heading and travel.
  GraphHeader<T>& header() { return *place<GraphHeader<T>>(0); }
  /// Of GraphDefinition::parameters.
  GraphParameterState<T>& parameter(int k) { return place<GraphParameterState<T>>(at_.parameters)[k]; }
  /// Of GraphDefinition::groups.
  GraphGroupState& group(int k) { return place<GraphGroupState>(at_.groups)[k]; }
  /// s played, which does not wrap; of a clip that is not synchronised (BoundClip::time).
  TimeJet<double>& time(int k) { return place<TimeJet<double>>(at_.clips)[k]; }
  /// Of a clip: entered, and not yet advanced.
  bool fresh(int clip) const { return (place<std::uint8_t>(at_.fresh)[clip / 8] >> (clip % 8) & 1) != 0; }
  /// Sets what fresh() answers.
  void set_fresh(int clip, bool fresh) {
    std::uint8_t& bits = place<std::uint8_t>(at_.fresh)[clip / 8];
    const int bit = 1 << (clip % 8);
    bits = static_cast<std::uint8_t>(fresh ? bits | bit : bits & ~bit);
  }
  /// Of Graph::machines().
  GraphMachineState<T>& machine(int k) { return place<GraphMachineState<T>>(at_.machines)[k]; }
  /// Only where Graph::feet() has a node.
  GraphFeetState<T>& feet() { return *place<GraphFeetState<T>>(at_.feet); }
  /// Of Graph::looks().
  GraphLookState<T>& look(int k) { return place<GraphLookState<T>>(at_.looks)[k]; }
  /// What a transition keeps of the pose (graph_keep.h), by Graph::BoundMachine::offset.
  std::span<std::byte> offset(int k) {
    const std::size_t bytes = (kept_bytes<T>(graph_.joint_count(), graph_.translated()) + 15) / 16 * 16;
    return {data_ + at_.offsets + std::size_t(k) * bytes, bytes};
  }
  /// [slot] what it keeps of the curves, likewise.
  std::span<TimeJet<T>> curve_offsets(int k) {
    const std::size_t count = std::size_t(graph_.curve_count());
    return {place<TimeJet<T>>(at_.curve_offsets) + std::size_t(k) * count, count};
  }

 private:
  template <class V>
  V* place(std::size_t offset) const {
    return reinterpret_cast<V*>(data_ + offset);
  }

  const Graph& graph_;
  const GraphLayout& at_;
  std::byte* data_;
};

/// Refuses blocks of another size or alignment; with `begun`, also those of another graph.
template <class T>
Status check_block(const Graph* graph, std::span<std::byte> state, bool begun);

/// Puts a character where its graph begins: parameters as the definition says, at the origin.
template <class T>
Status start_graph(const Graph& graph, std::span<std::byte> state);

/// What a game sets and asks for. Indices as of the definition (`find_parameter`); wrong ones do nothing and
/// give 0.
template <class T>
class GraphParameters {
 public:
  /// `state` must have passed start_graph(), and is not checked again; graph and block must outlive this.
  GraphParameters(const Graph& graph, std::span<std::byte> state) : graph_(graph), block_(graph, state) {}

  /// A float, or a bool as 0 or 1. Refuses numbers that are not finite, or beyond 10⁶.
  Status set(int parameter, T value);
  /// Asks for something once; forgotten when no transition has taken it within the trigger's buffer.
  Status trigger(int parameter);
  T goal(int parameter);               ///< as set
  TimeJet<T> filtered(int parameter);  ///< as weights and speeds see it

  /// Present state of a machine (`node`: GraphDefinition::nodes), −1 where it is none.
  int state(int node);
  /// s since the machine entered it; 0 where `node` is no machine.
  double seconds_in_state(int node);
  /// Whether a transition of the machine runs.
  bool fading(int node);

  /// m, world, z = 0: where the graph's root motion brought the character.
  Vec3<double> place();
  /// rad about Z, 0 along X: where it heads.
  double heading();
  /// For a game whose controller moves characters: stands and heads there (m, the height ignored; rad) from
  /// the next frame on. Feet forget where they stood if that is more than a metre away. Not checked: what is
  /// not finite ends up in the pose.
  void put(const Vec3<double>& place, double heading);
  /// How it went over the ground at the end of the last frame.
  TravelVelocity<T> travel();

 private:
  bool is(int parameter, bool trigger) const;
  bool machine(int node) const;

  const Graph& graph_;
  GraphBlock<T> block_;
};

#define SINEW_GRAPH_STATE_INSTANCES(prefix, T)                                     \
  prefix template Status check_block<T>(const Graph*, std::span<std::byte>, bool); \
  prefix template Status start_graph<T>(const Graph&, std::span<std::byte>);       \
  prefix template class GraphParameters<T>;
SINEW_GRAPH_STATE_INSTANCES(extern, float)
SINEW_GRAPH_STATE_INSTANCES(extern, double)

}  // namespace sinew
