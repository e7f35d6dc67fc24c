#include "sinew/graph/graph_contacts.h"

#include "sinew/animation/foot_leg.h"

namespace sinew {

template <class T>
T graph_contact(const Graph& graph, const GraphScratch<T>& scratch, int joint) {
  T all = 0, resting = 0;
  if (joint < 0 || joint >= graph.joint_count()) return T(0);
  for (int k = 0; k < scratch.task_count; ++k) {
    const GraphTask& task = scratch.tasks[std::size_t(k)];
    if (task.kind != GraphTask::Kind::kSample || task.at_change) continue;
    const T weight = T(scratch.shares[std::size_t(task.index)]);
    all += weight;
    const Graph::BoundClip& bound = graph.clips()[std::size_t(task.index)];
    const int resting_joint =
        graph.mirrored(bound.node) ? graph.template mirror<T>().partners[std::size_t(joint)] : joint;
    if (in_contact(*bound.clip, task.time.value, resting_joint)) resting += weight;
  }
  return all > T(0) ? resting / all : T(0);
}

template float graph_contact<float>(const Graph&, const GraphScratch<float>&, int);
template double graph_contact<double>(const Graph&, const GraphScratch<double>&, int);

}  // namespace sinew
