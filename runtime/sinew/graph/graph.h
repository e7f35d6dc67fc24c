// A graph bound to the clips of one asset, ready to be played by any number of characters.
//
// Set-up:
//
//     sinew::Graph graph;                                        // one an asset
//     sinew::Graph::bind(definition, asset, graph);              // names become indices
//     sinew::GraphScratch<float> scratch(graph);                 // one a thread
//     std::vector<std::byte> state(graph.state_bytes<float>());  // one a character
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

/// Where in a character's block what stands, in bytes. All a multiple of 16.
struct GraphLayout {
  std::size_t parameters = 0, groups = 0, clips = 0, fresh = 0, machines = 0, offsets = 0, curve_offsets = 0,
              feet = 0, looks = 0, bytes = 0;
};

/// Constant once bound. Refers to the asset's clips, which must stay where they are. The same definition may
/// be bound to several assets: other clips under the same names.
class Graph {
 public:
  /// Refuses what the asset does not have: `Status::index` is the node then, or the parameter.
  static Status bind(const GraphDefinition& definition, const Asset& asset, Graph& out);

  const GraphDefinition& definition() const { return definition_; }
  int joint_count() const { return joint_count_; }
  int curve_count() const { return static_cast<int>(curve_slots_.size()); }

  /// Of the block that a character needs: trivially copyable bytes without pointers, at an address that is a
  /// multiple of 16. A snapshot is a copy of it.
  template <class T>
  std::size_t state_bytes() const {
    return layout<T>().bytes;
  }

  // What playing needs; see graph_update.cpp and graph_pose.cpp.
  static constexpr float kSoftEnd = 0.1f;  ///< s before its end in which a clip that does not loop slows down
  struct BoundClip {
    const Clip* clip = nullptr;
    PhaseMap map;  ///< of those in a group; of mirrored ones half a cycle on
    int node = 0;
    int time = -1;  ///< which of the block's times it plays by; −1: by its group's phase
    std::vector<ClipEvent> mirrored_events;  ///< of mirrored ones, by the other side's names

    std::span<const ClipEvent> events() const {
      return mirrored_events.empty() ? std::span<const ClipEvent>(clip->events) : mirrored_events;
    }
  };
  struct BoundLayer {
    int mask = -1;                            ///< of the asset
    std::vector<Transform<float>> reference;  ///< additive: [joint]
  };
  struct BoundMachine {
    int node = 0;
    int offset = -1;     ///< which of the block's offsets its transitions use, also for a pose left behind
    bool fades = false;  ///< has an empty state
  };
  struct BoundFeet {
    int node = -1;                             ///< none
    int pelvis = -1;                           ///< joint that carries both legs
    int joints = 0;                            ///< that have to be posed
    std::array<FootLeg<float>, 2> legs_float;  ///< left, right
    std::array<FootLeg<double>, 2> legs_double;
    template <class T>
    std::span<const FootLeg<T>> legs() const {
      if constexpr (sizeof(T) == sizeof(double))
        return legs_double;
      else
        return legs_float;
    }
  };
  struct BoundLook {
    LookChain<float> chain_float;
    LookChain<double> chain_double;
    template <class T>
    const LookChain<T>& chain() const {
      if constexpr (sizeof(T) == sizeof(double))
        return chain_double;
      else
        return chain_float;
    }
  };
  template <class T>
  const GraphLayout& layout() const {
    return layouts_[sizeof(T) == sizeof(double)];
  }
  const GraphNode& node(int index) const { return definition_.nodes[std::size_t(index)]; }
  int root() const { return static_cast<int>(definition_.nodes.size()) - 1; }
  int slot(int node) const { return slots_[std::size_t(node)]; }  ///< among the nodes of its type
  const std::vector<BoundClip>& clips() const { return clips_; }
  const std::vector<BlendSpace>& spaces() const { return spaces_; }
  const std::vector<BoundMachine>& machines() const { return machines_; }
  /// Of layer `layer` of a kLayers node.
  const BoundLayer& layer(int node, int layer) const {
    return layers_[std::size_t(slot(node)) + std::size_t(layer)];
  }
  const BoundFeet& feet() const { return feet_; }
  const std::vector<BoundLook>& looks() const { return looks_; }
  const std::vector<JointMask>& masks() const { return masks_; }
  const std::vector<CurveSlot>& curve_slots() const { return curve_slots_; }
  const std::vector<int>& parents() const { return parents_; }
  const std::vector<Transform<float>>& rest() const { return rest_; }
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
  void bind_machine(int node);
  Status bind_feet(int node, const Asset& asset);
  Status bind_look(int node, const Asset& asset);
  Status bind_node(int node, const Asset& asset);
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
