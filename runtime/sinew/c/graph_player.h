// A character that follows a graph, for the C interface.
#pragma once

#include <algorithm>
#include <cstddef>
#include <memory>
#include <optional>
#include <vector>

#include "sinew/c/grounds.h"
#include "sinew/c/sinew.h"
#include "sinew/character/fade_timer.h"
#include "sinew/graph/graph_step.h"
#include "sinew/io/asset.h"

namespace sinew::c {

/// A graph and the asset whose clips it plays.
struct BoundGraph {
  std::shared_ptr<const Asset> asset;
  Graph graph;
  bool feels = false;   ///< some node shows the physical pose
  bool spends = false;  ///< some transition asks what the muscles can spare
};

constexpr const char* kNoParameter = "the graph has no such parameter";
constexpr const char* kNoMachine = "the graph has no machine of this number";
constexpr const char* kNoName = "the graph has nothing of that name";

/// Index of a name in things that have one; -1: none.
template <class Things>
int find_named(const Things& things, const char* name) noexcept {
  const auto at = std::find_if(things.begin(), things.end(), [&](const auto& t) { return t.name == name; });
  return at == things.end() ? -1 : static_cast<int>(at - things.begin());
}

/// Whether there is an element of that number.
template <class Things>
bool has(const Things& things, int index) {
  return index >= 0 && std::size_t(index) < things.size();
}

/// What the handle of a graph names; players share the graph.
struct OwnedGraph {
  std::shared_ptr<const BoundGraph> bound;
};

/// Before the bytes of a saved block.
struct SavedBlock {
  std::uint64_t graph = 0;   ///< Graph::hash
  std::uint64_t digest = 0;  ///< of the block
};

/// What sinew_graph_settings holds of a player.
struct PlayerSettings {
  int events = 32;
  double place[2] = {0, 0};
  double heading = 0;
  int ground = SINEW_GROUND_LEVEL;
  std::uint32_t layers = ~0u;
  double reach = 10;
  bool physics = true;
};

/// What its feet stand on.
struct PlayerGround {
  int kind = SINEW_GROUND_LEVEL;
  const World<float>* world = nullptr;
  std::uint32_t layers = ~0u;
  double reach = 0;  ///< m
  sinew_ground_below below = nullptr;
  void* context = nullptr;
  Grounds grounds;

  /// For a job; this must outlive it.
  GraphGround<float> for_graph() const;
};

/// All that a frame needs is allocated when it is made.
class GraphPlayer {
 public:
  /// Of a character of the world, which must outlive it. `scratch`: of one thread, for this graph.
  GraphPlayer(std::shared_ptr<const BoundGraph> bound, std::shared_ptr<GraphScratch<float>> scratch,
              const PlayerSettings& settings, World<float>& world, int character);

  const BoundGraph& bound() const { return *bound_; }
  const std::shared_ptr<GraphScratch<float>>& scratch() const { return scratch_; }
  bool plays(const BoundGraph& graph) const { return bound_.get() == &graph; }
  GraphParameters<float> parameters() { return {bound_->graph, block_}; }
  std::span<std::byte> block() { return block_; }
  /// Moves on by h s. What it wants is in jets() then; also, whole, where the status tells of a node.
  Status play(const Character<float>& character, float h);
  /// After a step: the parameters that tell of the character.
  void feel(const Character<float>& character);
  std::span<const JointJet<float>> jets() const { return jets_; }
  const EventSink& events() const { return events_; }
  std::span<const TimeJet<float>> curves() const { return curves_; }

  PlayerGround ground;

 private:
  std::shared_ptr<const BoundGraph> bound_;
  std::shared_ptr<GraphScratch<float>> scratch_;
  GraphMemory block_;
  std::vector<JointJet<float>> jets_, physical_;  ///< [joint]
  std::optional<FadeTimer<float>> timer_;         ///< where some transition asks
  std::vector<float> loads_;                      ///< [joint]; none where no parameter tells of the character
  std::vector<TimeJet<float>> curves_;            ///< [slot]
  std::vector<EventHit> hits_;
  EventSink events_;
};

}  // namespace sinew::c
