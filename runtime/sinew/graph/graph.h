// A graph bound to the clips of one asset, ready to be played by any number of characters.
//
// Set-up:
//
//     sinew::Graph graph;                                        // one an asset
//     sinew::Graph::bind(definition, asset, graph);              // names become indices
//     sinew::GraphScratch<float> scratch(graph);                 // one a thread
//     sinew::GraphMemory state(graph.state_bytes<float>());      // one a character
//     sinew::start_graph<float>(graph, state);
//
// Every frame:
//
//     sinew::GraphParameters<float>(graph, state).set(speed, 1.4f);
//     sinew::GraphStepJob<float>{&graph, state, h, &scratch, jets, &events}.Run();
//     character.set_target(jets);
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "sinew/animation/blend_space.h"
#include "sinew/animation/foot_leg.h"
#include "sinew/animation/look_chain.h"
#include "sinew/animation/mirror_job.h"
#include "sinew/animation/phase_map.h"
#include "sinew/graph/graph_definition.h"
#include "sinew/io/asset.h"

namespace sinew {

/// Memory for a character's block, or a recording: zeros that begin at a multiple of 16, as not every
/// platform's std::vector<std::byte> does.
class GraphMemory {
 public:
  GraphMemory() = default;
  /// So many; allocates.
  explicit GraphMemory(std::size_t bytes) : rows_((bytes + 15) / 16), bytes_(bytes) {}

  /// At a multiple of 16, or null where there are none.
  std::byte* data() { return rows_.empty() ? nullptr : rows_.front().bytes; }
  const std::byte* data() const { return rows_.empty() ? nullptr : rows_.front().bytes; }  ///< the same
  std::size_t size() const { return bytes_; }                                              ///< bytes
  std::byte* begin() { return data(); }                     ///< as of a vector, for std::span
  std::byte* end() { return data() + bytes_; }              ///< as of a vector
  const std::byte* begin() const { return data(); }         ///< as of a vector
  const std::byte* end() const { return data() + bytes_; }  ///< as of a vector

 private:
  struct alignas(16) Row {
    std::byte bytes[16] = {};
  };
  std::vector<Row> rows_;
  std::size_t bytes_ = 0;
};

/// Where in a character's block what stands, in bytes. All a multiple of 16.
struct GraphLayout {
  std::size_t parameters = 0;     ///< GraphParameterState, [parameter]
  std::size_t groups = 0;         ///< GraphGroupState, [group]
  std::size_t clips = 0;          ///< TimeJet<double>, [Graph::BoundClip::time]
  std::size_t fresh = 0;          ///< a bit each, [clip]
  std::size_t machines = 0;       ///< GraphMachineState, [machine]
  std::size_t offsets = 0;        ///< what a transition keeps of the pose, [Graph::BoundMachine::offset]
  std::size_t curve_offsets = 0;  ///< and of the curves: TimeJet, [Graph::BoundMachine::offset][slot]
  std::size_t feet = 0;           ///< GraphFeetState, if the graph has feet
  std::size_t looks = 0;          ///< GraphLookState, [look]
  std::size_t bytes = 0;          ///< of the whole block
};

/// Constant once bound. Refers to the asset's clips, which must stay where they are. The same definition may
/// be bound to several assets: other clips under the same names.
class Graph {
 public:
  /// Refuses what the asset does not have: `Status::index` is the node then, or the parameter.
  /// On an error `out` stays as it was. Set-up: allocates, and bakes the blends' weights.
  static Status bind(const GraphDefinition& definition, const Asset& asset, Graph& out);

  const GraphDefinition& definition() const { return definition_; }          ///< its own copy
  int joint_count() const { return joint_count_; }                           ///< of the asset's skeleton
  int curve_count() const { return static_cast<int>(curve_slots_.size()); }  ///< the asset's curve slots

  /// Of the block that a character needs: trivially copyable bytes without pointers, at an address that is a
  /// multiple of 16 (GraphMemory). A snapshot is a copy of it.
  template <class T>
  std::size_t state_bytes() const {
    return layout<T>().bytes;
  }

  // What playing needs; see graph_update.cpp and graph_pose.cpp.
  static constexpr float kSoftEnd = 0.1f;  ///< s before its end in which a clip that does not loop slows down
  /// A kClip node.
  struct BoundClip {
    const Clip* clip = nullptr;  ///< the asset's
    PhaseMap map;                ///< of those in a group; of mirrored ones half a cycle on
    int node = 0;                ///< of the definition
    int time = -1;               ///< which of the block's times it plays by; −1: by its group's phase
    std::vector<ClipEvent> mirrored_events;  ///< of mirrored ones, by the other side's names

    /// Those that playing it passes.
    std::span<const ClipEvent> events() const {
      return mirrored_events.empty() ? std::span<const ClipEvent>(clip->events) : mirrored_events;
    }
  };
  /// One layer of a kLayers node.
  struct BoundLayer {
    int mask = -1;                            ///< of the asset; −1: all joints
    std::vector<Transform<float>> reference;  ///< additive: [joint]
  };
  /// A kMachine node.
  struct BoundMachine {
    int node = 0;        ///< of the definition
    int offset = -1;     ///< which of the block's offsets its transitions use, also for a pose left behind;
                         ///< −1: none does
    bool fades = false;  ///< has an empty state
    std::vector<int> profiles;  ///< [transition] mask of its profile, of the asset; −1: none
  };
  /// The graph's kFeet node.
  struct BoundFeet {
    int node = -1;                               ///< of the definition; −1: none
    int pelvis = -1;                             ///< joint that carries both legs
    int joints = 0;                              ///< that have to be posed
    std::array<FootLeg<float>, 2> legs_float;    ///< left, right
    std::array<FootLeg<double>, 2> legs_double;  ///< the same
    /// Either, by the precision.
    template <class T>
    std::span<const FootLeg<T>> legs() const {
      if constexpr (sizeof(T) == sizeof(double))
        return legs_double;
      else
        return legs_float;
    }
  };
  /// A kLook node.
  struct BoundLook {
    LookChain<float> chain_float;    ///< by the node's joints, or by their roles
    LookChain<double> chain_double;  ///< the same
    /// Either, by the precision.
    template <class T>
    const LookChain<T>& chain() const {
      if constexpr (sizeof(T) == sizeof(double))
        return chain_double;
      else
        return chain_float;
    }
  };
  /// A float parameter that set_physics() sets: its name is one of kPhysicsNames.
  struct BoundPhysics {
    int parameter = 0;  ///< of the definition
    int value = 0;      ///< of kPhysicsNames
    int mask = -1;      ///< of the asset; −1: of all joints
  };
  /// Of a character's block; that of the other precision differs.
  template <class T>
  const GraphLayout& layout() const {
    return layouts_[sizeof(T) == sizeof(double)];
  }
  /// Of the definition, 0 … root(): not checked, as everything that takes a node from here on.
  const GraphNode& node(int index) const { return definition_.nodes[std::size_t(index)]; }
  int root() const { return static_cast<int>(definition_.nodes.size()) - 1; }  ///< the last node
  /// Where a node stands among those of its type: in clips(), spaces(), machines() or looks(), of kLayers its
  /// first layer; −1 of other types.
  int slot(int node) const { return slots_[std::size_t(node)]; }
  const std::vector<BoundClip>& clips() const { return clips_; }           ///< [slot] of kClip nodes
  const std::vector<BlendSpace>& spaces() const { return spaces_; }        ///< [slot] of kBlend nodes
  const std::vector<BoundMachine>& machines() const { return machines_; }  ///< [slot] of kMachine nodes
  /// Of layer `layer` of a kLayers node.
  const BoundLayer& layer(int node, int layer) const {
    return layers_[std::size_t(slot(node)) + std::size_t(layer)];
  }
  const BoundFeet& feet() const { return feet_; }                        ///< a graph has at most one pair
  const std::vector<BoundLook>& looks() const { return looks_; }         ///< [slot] of kLook nodes
  const std::vector<BoundPhysics>& physics() const { return physics_; }  ///< in the parameters' order
  const std::vector<JointMask>& masks() const { return masks_; }         ///< the asset's
  const std::vector<CurveSlot>& curve_slots() const { return curve_slots_; }  ///< the asset's
  const std::vector<int>& parents() const { return parents_; }                ///< [joint] −1: root
  const std::vector<Transform<float>>& rest() const { return rest_; }         ///< [joint] joint → parent
  /// Which joint takes whose place below a kMirror node; empty where the graph has none.
  template <class T>
  const MirrorMap<T>& mirror() const {
    if constexpr (sizeof(T) == sizeof(double))
      return mirror_double_;
    else
      return mirror_float_;
  }
  bool mirrored(int node) const { return mirrored_[std::size_t(node)] != 0; }  ///< by the mirrors above it
  int registers() const { return registers_; }        ///< poses that playing it needs at once
  int translated() const { return translated_; }      ///< first joints that clips move against their parents
  std::uint32_t event_bit(std::uint32_t name) const;  ///< bit of an event that conditions ask for, or 0
  std::uint64_t hash() const { return hash_; }  ///< of the definition and the sizes of what it is bound to

 private:
  Status bind_mirrors(const Asset& asset);
  Status bind_clip(int node, const Asset& asset);
  Status bind_layers(int node, const Asset& asset);
  Status bind_blend(int node);
  Status bind_machine(int node, const Asset& asset);
  Status bind_feet(int node, const Asset& asset);
  Status bind_look(int node, const Asset& asset);
  Status bind_node(int node, const Asset& asset);
  Status bind_physics(const Asset& asset);
  void lay_out();

  GraphDefinition definition_;
  int joint_count_ = 0, registers_ = 0, translated_ = 1;
  std::vector<int> slots_;
  std::vector<BoundClip> clips_;
  std::vector<BlendSpace> spaces_;
  std::vector<BoundLayer> layers_;
  std::vector<BoundMachine> machines_;
  BoundFeet feet_;
  std::vector<BoundLook> looks_;
  std::vector<BoundPhysics> physics_;
  std::vector<JointMask> masks_;
  std::vector<CurveSlot> curve_slots_;
  std::vector<int> parents_;
  std::vector<Transform<float>> rest_;
  std::vector<std::uint32_t> event_names_;
  std::vector<char> mirrored_;  ///< [node] below an odd number of mirrors
  MirrorMap<float> mirror_float_;
  MirrorMap<double> mirror_double_;
  GraphLayout layouts_[2];
  std::uint64_t hash_ = 0;
};

}  // namespace sinew
