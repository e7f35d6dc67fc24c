// A character of a scene whose animation is a graph: `graph` and `inputs` of the scene file.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "graph/trace.h"
#include "scene/ground.h"
#include "sinew/graph/graph_physics.h"
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
  std::span<const Transform<T>> local = {};  ///< [joint] its pose
  std::span<const JointJet<T>> motion = {};  ///< [joint] see physical_motion(); empty: `local`, at rest
  PhysicsValues<T> values = {};              ///< see physics_values(); counts where there is a motion
  GraphMuscles<T> muscles = {};              ///< see FadeTimer
};

/// Plays it. Copies are independent: one may be asked what comes next. The use must outlive it. Parameters
/// that set_physics() knows are set in every frame.
template <class T>
class GraphMotion {
 public:
  GraphMotion(const GraphUse& use, const Transform<double>& place);

  /// The motion at t, which does not run backwards, and what its curves are then.
  Status at(double t, const Felt<T>& felt, std::vector<JointJet<T>>& jets, std::span<TimeJet<T>> curves);

 private:
  const GraphUse& use_;
  std::shared_ptr<GraphScratch<T>> scratch_;  ///< shared by copies: holds nothing between frames
  GraphMemory state_;
  std::vector<JointJet<T>> physical_;
  double time_ = -1;  ///< of the last frame; none yet
};

extern template class GraphMotion<float>;
extern template class GraphMotion<double>;

}  // namespace sinew::scene
