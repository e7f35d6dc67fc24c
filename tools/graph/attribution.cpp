#include "graph/attribution.h"

#include <algorithm>
#include <cmath>

namespace sinew::graph_tools {

Attribution::Attribution(const Graph& graph, const GraphScratch<float>& scratch, int joint)
    : graph_(graph), scratch_(scratch), joint_(joint), registers_(std::size_t(graph.registers())) {}

GraphWatch<float> Attribution::watch() {
  return {[](void* tool, const GraphTask& task, std::span<const JointJet<float>> out) {
            static_cast<Attribution*>(tool)->done(task, out);
          },
          this};
}

std::vector<AccelerationShare> Attribution::shares() const {
  Shares merged;
  for (const AccelerationShare& share : registers_[0]) {
    const auto same = std::find_if(merged.begin(), merged.end(), [&](const AccelerationShare& m) {
      return m.node == share.node && m.time == share.time;
    });
    if (same == merged.end())
      merged.push_back(share);
    else
      same->alpha += share.alpha;
  }
  std::stable_sort(merged.begin(), merged.end(), [](const AccelerationShare& a, const AccelerationShare& b) {
    return a.alpha.norm() > b.alpha.norm();
  });
  return merged;
}

void Attribution::add(const Shares& from, float weight, Shares& to) {
  for (const AccelerationShare& share : from) to.push_back({share.node, share.time, weight * share.alpha});
}

Vec3<float> Attribution::sum(const Shares& shares) {
  Vec3<float> total = Vec3<float>::Zero();
  for (const AccelerationShare& share : shares) total += share.alpha;
  return total;
}

void Attribution::rest(int node, const Vec3<float>& alpha, Shares& shares) const {
  shares.push_back({node, false, alpha - sum(shares)});
}

void Attribution::done(const GraphTask& task, std::span<const JointJet<float>> out) {
  if (std::size_t(joint_) >= out.size()) return;
  const JointJet<float>& jet = out[std::size_t(joint_)];
  Shares& at = registers_[task.out];
  const auto machine = [&] { return graph_.machines()[std::size_t(task.index)].node; };
  switch (task.kind) {
    case GraphTask::Kind::kSample: {
      const int node = graph_.clips()[std::size_t(task.index)].node;
      const float warp =
          task.time.rate == 0 ? 0 : static_cast<float>(task.time.acceleration / task.time.rate);
      at = {{node, true, warp * jet.omega}};
      return rest(node, jet.alpha, at);
    }
    case GraphTask::Kind::kPhysical:
    case GraphTask::Kind::kMirror:  // whose parts are the other side's
      at = {{task.index, false, jet.alpha}};
      return;
    case GraphTask::Kind::kBlend: {
      Shares mixed;
      for (int k = 0; k < task.count; ++k)
        add(registers_[std::size_t(task.out) + std::size_t(k)],
            scratch_.weights[std::size_t(task.weights) + std::size_t(k)].value, mixed);
      at = std::move(mixed);
      return rest(task.index, jet.alpha, at);
    }
    case GraphTask::Kind::kCrossfade: {
      const float w = scratch_.weights[std::size_t(task.weights)].value;
      Shares mixed;
      add(at, 1 - w, mixed);
      add(registers_[std::size_t(task.out) + 1], w, mixed);
      at = std::move(mixed);
      return rest(machine(), jet.alpha, at);
    }
    case GraphTask::Kind::kLayer: {
      const Graph::BoundLayer& layer = graph_.layer(task.index, task.layer);
      const bool over = graph_.node(task.index).layers[std::size_t(task.layer)].mode == LayerMode::kOverride;
      float w = scratch_.weights[std::size_t(task.weights)].value;
      if (layer.mask >= 0) w *= scratch_.masks[std::size_t(layer.mask)][std::size_t(joint_)];
      Shares mixed;
      add(at, over ? 1 - w : 1.f, mixed);
      if (over) add(registers_[std::size_t(task.out) + 1], w, mixed);
      at = std::move(mixed);
      return rest(task.index, jet.alpha, at);
    }
    case GraphTask::Kind::kOffset:
    case GraphTask::Kind::kLeft:
      return rest(machine(), jet.alpha, at);
    case GraphTask::Kind::kFeet:
    case GraphTask::Kind::kLook:
      return rest(task.index, jet.alpha, at);
    case GraphTask::Kind::kKeep:
    case GraphTask::Kind::kBeginOffset:
    case GraphTask::Kind::kLeave:
    case GraphTask::Kind::kTravel:
      return;
  }
}

}  // namespace sinew::graph_tools
