// A character of a scene whose animation is a graph: `graph` and `inputs` of the scene file.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "graph/trace.h"
#include "scene/ground.h"
#include "sinew/graph/graph_step.h"

namespace sinew::scene {

/// The graph of a character, and what a player would do with it.
struct GraphUse {
  std::shared_ptr<const Graph> graph;
  graph_tools::InputScript inputs;
  std::shared_ptr<const Ground> ground;  ///< for its feet; none: level
};

/// What the physical character says of itself.
template <class T>
struct Felt {
  std::span<const Transform<T>> local = {};    ///< [joint] its pose
  double load = 0;                             ///< the greatest of its muscles
  std::span<const T> spare_acceleration = {};  ///< [joint], see spare_acceleration()
};

/// Plays it. Copies are independent: one may be asked what comes next. The use must outlive it.
///
/// Parameters that the graph has under these names are set in every frame: `physics.tilt`, how far the root
/// is from upright (rad); `physics.height`, of the root over the ground as a part of that at rest;
/// `physics.face_up`, 1 on the back, −1 on the belly; `physics.load`, the greatest load of a muscle.
template <class T>
class GraphMotion {
 public:
  GraphMotion(const GraphUse& use, const Skeleton& skeleton, const Transform<double>& place);

  /// The motion at t, which does not run backwards, and what its curves are then.
  Status at(double t, const Felt<T>& felt, std::vector<JointJet<T>>& jets, std::span<TimeJet<T>> curves);

 private:
  void feel(const Felt<T>& felt);

  const GraphUse& use_;
  const Skeleton& skeleton_;
  std::shared_ptr<GraphScratch<T>> scratch_;  ///< shared by copies: holds nothing between frames
  GraphMemory state_;
  std::vector<JointJet<T>> physical_;
  double time_ = -1;  ///< of the last frame; none yet
};

extern template class GraphMotion<float>;
extern template class GraphMotion<double>;

}  // namespace sinew::scene
