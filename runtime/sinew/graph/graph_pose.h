// The pose that a graph gives, with velocities and accelerations.
#pragma once

#include "sinew/graph/graph_ground.h"
#include "sinew/graph/graph_muscles.h"
#include "sinew/graph/graph_scratch.h"

namespace sinew {

/// Is told of every task and of the motion that it left in its register: for tools that explain a pose.
template <class T>
struct GraphWatch {
  /// After each task; `out` [joint]: the motion that it left, of as many joints as it made. Null: not told.
  void (*task_done)(void* tool, const GraphTask& task, std::span<const JointJet<T>> out) = nullptr;
  void* tool = nullptr;  ///< what task_done gets
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
  const Graph* graph = nullptr;                ///< the one that `state` and `scratch` were made for
  std::span<std::byte> state;                  ///< the character's block
  GraphScratch<T>* scratch = nullptr;          ///< as GraphUpdateJob left it
  std::span<JointJet<T>> jets;                 ///< [joint]: what the character is to do, 1 … all joints
  std::span<TimeJet<T>> curves = {};           ///< [slot], where wanted
  std::span<const JointJet<T>> physical = {};  ///< [joint] what it does do, for NodeType::kPhysical
  GraphWatch<T> watch = {};                    ///< for tools
  GraphGround<T> ground = {};                  ///< for NodeType::kFeet
  GraphMuscles<T> muscles = {};                ///< for GraphTransition::budget

  /// Refuses a block or scratch of another graph, no joints or too many, and a graph that plays a physical
  /// pose which is not given for all joints.
  Status Validate() const;
  /// A look or a foot that fails leaves the pose without it; `Status::index` is its node.
  Status Run() const;
};

extern template struct GraphPoseJob<float>;
extern template struct GraphPoseJob<double>;

}  // namespace sinew
