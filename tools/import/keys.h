// Keyed curves and node transforms, as the readers need them to merge nodes.
#pragma once

#include <algorithm>
#include <cmath>
#include <type_traits>
#include <vector>

#include "import/source_scene.h"

namespace sinew::import {

/// Value of a keyed curve at t: linear (positions, scales) or the shorter way round (rotations).
template <class V>
V interpolate(const std::vector<double>& times, const std::vector<V>& keys, double t, const V& otherwise) {
  if (keys.empty()) return otherwise;
  const auto after = std::upper_bound(times.begin(), times.end(), t);
  if (after == times.begin()) return keys.front();
  if (after == times.end()) return keys.back();
  const std::size_t i = static_cast<std::size_t>(after - times.begin());
  const double span = times[i] - times[i - 1], u = span > 0 ? (t - times[i - 1]) / span : 0;
  if constexpr (std::is_same_v<V, Eigen::Quaterniond>) {
    return keys[i - 1].slerp(u, keys[i]);
  } else {
    return keys[i - 1] + u * (keys[i] - keys[i - 1]);
  }
}

/// Position, rotation and scale per axis of a node's transform; a mirror becomes a negative first scale.
struct Parts {
  Eigen::Vector3d position, scale;
  Eigen::Quaterniond rotation;

  explicit Parts(const Eigen::Matrix4d& m) : position(m.block<3, 1>(0, 3)) {
    Eigen::Matrix3d axes = m.block<3, 3>(0, 0);
    scale = axes.colwise().norm();
    if (axes.determinant() < 0) scale[0] = -scale[0];
    for (int k = 0; k < 3; ++k) axes.col(k) /= std::abs(scale[k]) > 1e-12 ? scale[k] : 1;
    rotation = Eigen::Quaterniond(axes).normalized();
  }
};

/// Transform of a node at time t: its channel's where that has keys, else its own.
inline Eigen::Matrix4d local_at(const SourceNode& node, const SourceChannel* c, double t) {
  if (!c) return node.local;
  const Parts rest(node.local);
  const Eigen::Quaterniond r = interpolate(c->rotation_times, c->rotations, t, rest.rotation);
  const Eigen::Vector3d s = interpolate(c->scale_times, c->scales, t, rest.scale);
  Eigen::Matrix4d m = Eigen::Matrix4d::Identity();
  m.block<3, 3>(0, 0) = r.normalized().toRotationMatrix() * s.asDiagonal();
  m.block<3, 1>(0, 3) = interpolate(c->position_times, c->positions, t, rest.position);
  return m;
}

}  // namespace sinew::import
