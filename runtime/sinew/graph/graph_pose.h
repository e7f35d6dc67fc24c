// The pose that a graph gives, with velocities and accelerations.
#pragma once

#include "sinew/graph/graph_ground.h"
#include "sinew/graph/graph_scratch.h"

namespace sinew {

/// Is told of every task and of the motion that it left in its register: for tools that explain a pose.
template <class T>
struct GraphWatch {
  void (*task_done)(void* tool, const GraphTask& task, std::span<const JointJet<T>> out) = nullptr;
  void* tool = nullptr;
};

/// Carries out what GraphUpdateJob left in `scratch` for this character, right after it, and moves the
/// character over the ground: root = travel ∘ body, the travel integrated from the blended velocities of the
/// clips' roots,
///
///     p₁ = p₀ + h/2·(ṗ₀ + ṗ₁) + h²/12·(p̈₀ − p̈₁), the heading alike.
///
/// Allocates nothing. Fewer joints are a level of detail; one joint is what a server needs that only wants to
/// know where characters are.
template <class T>
struct GraphPoseJob {
  const Graph* graph = nullptr;
  std::span<std::byte> state;
  GraphScratch<T>* scratch = nullptr;
  std::span<JointJet<T>> jets;                 ///< [joint]: what the character is to do
  std::span<TimeJet<T>> curves = {};           ///< [slot], where wanted
  std::span<const JointJet<T>> physical = {};  ///< [joint] what it does do, for NodeType::kPhysical
  std::span<const T> spare_acceleration = {};  ///< [joint] rad/s², see GraphTransition::budget
  GraphWatch<T> watch = {};
  GraphGround<T> ground = {};  ///< for NodeType::kFeet

  /// A look or a foot that fails leaves the pose without it; `Status::index` is its node.
  Status Validate() const;
  Status Run() const;
};

extern template struct GraphPoseJob<float>;
extern template struct GraphPoseJob<double>;

}  // namespace sinew
