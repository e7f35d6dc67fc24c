#include "scene/graph_motion.h"

#include <algorithm>
#include <cmath>

namespace sinew::scene {

template <class T>
GraphMotion<T>::GraphMotion(const GraphUse& use, const Skeleton& skeleton, const Transform<double>& place)
    : use_(use),
      skeleton_(skeleton),
      scratch_(std::make_shared<GraphScratch<T>>(*use.graph)),
      state_(use.graph->state_bytes<T>()),
      physical_(skeleton.joints.size()) {
  (void)start_graph<T>(*use.graph, state_);
  const Quat<double>& q = place.rotation;
  GraphParameters<T>(*use.graph, state_).put(place.translation, 2 * std::atan2(q.z(), q.w()));
}

template <class T>
Status GraphMotion<T>::at(double t, const Felt<T>& felt, std::vector<JointJet<T>>& jets,
                          std::span<TimeJet<T>> curves) {
  const std::span<const Transform<T>> now = felt.local;
  for (std::size_t j = 0; j < physical_.size() && j < now.size(); ++j) {
    physical_[j] = {};
    physical_[j].rotation = now[j].rotation;
    physical_[j].translation = now[j].translation;
  }
  feel(felt);
  const double from = time_ < 0 ? -1e300 : time_, h = time_ < 0 ? 0 : std::max(0.0, t - time_);
  use_.inputs.apply(*use_.graph, state_, from, time_ < 0 ? t + 1e-9 : t - 1e-9);
  GraphStepJob<T> job{use_.graph.get(), state_, T(h), scratch_.get(), jets};
  job.curves = curves;
  job.physical = physical_;
  job.spare_acceleration = felt.spare_acceleration;
  if (use_.ground) job.ground = use_.ground->for_graph<T>();
  time_ = t;
  return job.Run();
}

template <class T>
void GraphMotion<T>::feel(const Felt<T>& felt) {
  if (felt.local.empty()) return;
  const Transform<double> root = felt.local[0].template cast<double>();
  const Mat3<double> turned =
      (root.rotation * skeleton_.joints[0].rest.rotation.conjugate()).toRotationMatrix();
  const double height = skeleton_.joints[0].rest.translation.z();
  const auto set = [&](const char* name, double value) {
    const int parameter = use_.graph->definition().find_parameter(name);
    if (parameter >= 0) (void)GraphParameters<T>(*use_.graph, state_).set(parameter, T(value));
  };
  set("physics.tilt", std::acos(std::clamp(turned(2, 2), -1.0, 1.0)));
  set("physics.face_up", turned(2, 0));
  set("physics.height", height > 0 ? root.translation.z() / height : 1);
  set("physics.load", felt.load);
}

template class GraphMotion<float>;
template class GraphMotion<double>;

}  // namespace sinew::scene
