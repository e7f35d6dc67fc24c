#include "scene/graph_motion.h"

#include <algorithm>
#include <cmath>

namespace sinew::scene {

template <class T>
GraphMotion<T>::GraphMotion(const GraphUse& use, const Transform<double>& place)
    : use_(use),
      scratch_(std::make_shared<GraphScratch<T>>(*use.graph)),
      state_(use.graph->state_bytes<T>()),
      physical_(std::size_t(use.graph->joint_count())) {
  (void)start_graph<T>(*use.graph, state_);
  const Quat<double>& q = place.rotation;
  GraphParameters<T>(*use.graph, state_).put(place.translation, 2 * std::atan2(q.z(), q.w()));
}

template <class T>
Status GraphMotion<T>::at(double t, const Felt<T>& felt, std::vector<JointJet<T>>& jets,
                          std::span<TimeJet<T>> curves) {
  if (felt.motion.size() == physical_.size()) {
    std::copy(felt.motion.begin(), felt.motion.end(), physical_.begin());
    (void)set_physics<T>(*use_.graph, state_, felt.values);
  }
  for (std::size_t j = 0; felt.motion.empty() && j < physical_.size() && j < felt.local.size(); ++j) {
    physical_[j] = {};
    physical_[j].rotation = felt.local[j].rotation;
    physical_[j].translation = felt.local[j].translation;
  }
  const double from = time_ < 0 ? -1e300 : time_, h = time_ < 0 ? 0 : std::max(0.0, t - time_);
  use_.inputs.apply(*use_.graph, state_, from, time_ < 0 ? t + 1e-9 : t - 1e-9);
  GraphStepJob<T> job{use_.graph.get(), state_, T(h), scratch_.get(), jets};
  job.curves = curves;
  job.physical = physical_;
  job.muscles = felt.muscles;
  if (use_.ground) job.ground = use_.ground->for_graph<T>();
  time_ = t;
  return job.Run();
}

template class GraphMotion<float>;
template class GraphMotion<double>;

}  // namespace sinew::scene
