// Which node of a graph makes a joint accelerate.
#pragma once

#include <span>
#include <utility>
#include <vector>

#include "sinew/graph/graph_pose.h"

namespace sinew::graph_tools {

/// A part of one joint's angular acceleration (rad/s², child axes) and the node that it comes from.
struct AccelerationShare {
  int node = 0;
  bool time = false;  ///< of a clip: because its speed changes, not because of its motion
  Vec3<float> alpha = Vec3<float>::Zero();
};

/// Follows one joint through the tasks of a pose. A clip accounts for what it gives, weighted as it is mixed;
/// a blend, a layer or a transition for what it adds to that: weights that move, offsets that fade. The
/// shares add up to the joint's acceleration.
///
///     Attribution attribution(graph, scratch, joint);
///     job.watch = attribution.watch();
///     job.Run();
///     attribution.shares();
class Attribution {
 public:
  Attribution(const Graph& graph, const GraphScratch<float>& scratch, int joint);
  GraphWatch<float> watch();
  /// Of the pose, the greatest first.
  std::vector<AccelerationShare> shares() const;

 private:
  using Shares = std::vector<AccelerationShare>;
  static void add(const Shares& from, float weight, Shares& to);
  static Vec3<float> sum(const Shares& shares);
  void done(const GraphTask& task, std::span<const JointJet<float>> out);
  /// What is not accounted for is this node's.
  void rest(int node, const Vec3<float>& alpha, Shares& shares) const;

  const Graph& graph_;
  const GraphScratch<float>& scratch_;
  int joint_;
  std::vector<Shares> registers_;
};

}  // namespace sinew::graph_tools
