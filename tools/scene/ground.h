// The ground of a scene as a graph's feet see it: the floor, and boxes and spheres that stand about.
#pragma once

#include <optional>
#include <vector>

#include "sinew/graph/graph_ground.h"
#include "sinew/skeleton/skeleton.h"

namespace sinew::scene {

struct Ground {
  std::optional<double> floor;      ///< m, its height
  std::vector<Collider> obstacles;  ///< world space; capsules are not stood upon

  /// The highest point of them straight below a point.
  template <class T>
  bool below(const Vec3<T>& point, GroundHit<T>& hit) const;
  /// For a job; this must outlive it.
  template <class T>
  GraphGround<T> for_graph() const {
    const auto below = [](const void* self, const Vec3<T>& point, GroundHit<T>& hit) {
      return static_cast<const Ground*>(self)->below(point, hit);
    };
    return {below, this, {}};
  }
};

extern template bool Ground::below<float>(const Vec3<float>&, GroundHit<float>&) const;
extern template bool Ground::below<double>(const Vec3<double>&, GroundHit<double>&) const;

}  // namespace sinew::scene
