#include "sinew/graph/graph_physics.h"

#include <algorithm>
#include <cmath>

namespace sinew {
namespace {

template <class T>
T load_of(const JointMask& mask, std::span<const T> loads) {
  constexpr std::uint8_t kHalf = 128;
  T most = T(0);
  for (std::size_t j = 0; j < std::min(loads.size(), mask.weights.size()); ++j)
    if (mask.weights[j] >= kHalf) most = std::max(most, loads[j]);
  return most;
}

}  // namespace

template <class T>
Status set_physics(const Graph& graph, std::span<std::byte> state, const PhysicsValues<T>& v) {
  if (Status status = check_block<T>(&graph, state, true); !status) return status;
  const T all[] = {v.tilt, v.face_up, v.height, v.load, v.contacts, v.off_animation, v.contact_force};
  static_assert(std::size(all) == std::size(kPhysicsNames));
  GraphParameters<T> parameters(graph, state);
  for (const Graph::BoundPhysics& bound : graph.physics()) {
    const T value =
        bound.mask < 0 ? all[bound.value] : load_of<T>(graph.masks()[std::size_t(bound.mask)], v.joint_load);
    if (std::isnan(value)) continue;
    if (Status status = parameters.set(bound.parameter, std::clamp(value, T(-1e6), T(1e6))); !status)
      return status;
  }
  return {};
}

template Status set_physics<float>(const Graph&, std::span<std::byte>, const PhysicsValues<float>&);
template Status set_physics<double>(const Graph&, std::span<std::byte>, const PhysicsValues<double>&);

}  // namespace sinew
