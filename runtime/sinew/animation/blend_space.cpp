#include "sinew/animation/blend_space.h"

#include <algorithm>
#include <cmath>

#include "sinew/animation/bspline.h"

namespace sinew {
namespace {

using Point = Eigen::Vector2d;

constexpr int kPlateau = 2;  ///< nodes around a point that a cubic spline at the point can see

Status check(std::span<const double> points, int dimensions, int nodes) {
  if (dimensions != 1 && dimensions != 2)
    return Status::error(Code::kInvalidArgument, "dimensions are not 1 or 2");
  if (nodes < 8 || nodes > 257) return Status::error(Code::kOutOfRange, "nodes are not within 8 and 257");
  const std::size_t clips = points.size() / std::size_t(dimensions);
  if (clips < 1 || clips > BlendSpace::kMaxClips || points.size() % std::size_t(dimensions) != 0)
    return Status::error(Code::kInvalidArgument, "points of 1 to 16 clips are needed");
  for (std::size_t i = 0; i < points.size(); ++i)
    if (!std::isfinite(points[i]) || std::abs(points[i]) > 1e6)
      return Status::error(Code::kNotFinite, "point is not finite, or absurd",
                           static_cast<int>(i) / dimensions);
  return {};
}

/// Gradient bands, in numbers of nodes.
void bands(std::span<const Point> points, const Point& p, float* weights) {
  double sum = 0, all[BlendSpace::kMaxClips] = {};
  for (std::size_t i = 0; i < points.size(); ++i) {
    double w = 1;
    for (std::size_t j = 0; j < points.size(); ++j) {
      const Point apart = points[j] - points[i];
      if (j != i) w = std::min(w, 1 - (p - points[i]).dot(apart) / apart.squaredNorm());
    }
    all[i] = std::max(w, 0.0);
    if ((p - points[i]).cwiseAbs().maxCoeff() < kPlateau) {  // alone
      std::fill(all, all + points.size(), 0.0);
      all[i] = sum = 1;
      break;
    }
    sum += all[i];
  }
  for (std::size_t i = 0; i < points.size(); ++i) weights[i] = static_cast<float>(all[i] / sum);
}

/// Basis functions along one dimension, for a parameter that moves, and the nodes that they weigh.
template <class T>
struct Along {
  int node[4] = {};
  TimeJet<T> weight[4];

  Along(const BlendSpace& space, int dimension, const TimeJet<T>& p) {
    const T nodes = T(1 / space.interval[dimension]);
    const T place = std::clamp((p.value - T(space.origin[dimension])) * nodes, T(-1e6), T(1e6));
    const T whole = std::floor(place), rate = p.rate * nodes, acceleration = p.acceleration * nodes;
    const BsplineBasis<T> w = BsplineBasis<T>::at(3, place - whole);
    for (int t = 0; t < 4; ++t) {
      node[t] = std::clamp(static_cast<int>(whole) + t - 1, 0, space.size[dimension] - 1);
      // Rounding makes the first and the last function as little as −2e-9 near their ends.
      weight[t] = {std::max(w.value[t], T(0)), w.first[t] * rate,
                   w.second[t] * (rate * rate) + w.first[t] * acceleration};
    }
  }
};

}  // namespace

Status bake_blend_space(std::span<const double> points, int dimensions, int nodes, BlendSpace& out) {
  if (Status status = check(points, dimensions, nodes); !status) return status;
  BlendSpace space;
  space.clips = static_cast<int>(points.size()) / dimensions;
  space.dimensions = dimensions;
  const auto coordinate = [&](int clip, int d) {
    return points[std::size_t(clip) * std::size_t(dimensions) + std::size_t(d)];
  };
  for (int d = 0; d < dimensions; ++d) {
    double low = coordinate(0, d), high = low;
    for (int i = 1; i < space.clips; ++i) {
      low = std::min(low, coordinate(i, d));
      high = std::max(high, coordinate(i, d));
    }
    space.size[d] = nodes;
    space.interval[d] = high > low ? (high - low) / (nodes - 1 - 2 * kPlateau) : 1;
    space.origin[d] = low - kPlateau * space.interval[d];
  }
  std::vector<Point> in_nodes(std::size_t(space.clips), Point::Zero());
  for (int i = 0; i < space.clips; ++i) {
    for (int d = 0; d < dimensions; ++d)
      in_nodes[std::size_t(i)][d] = (coordinate(i, d) - space.origin[d]) / space.interval[d];
    for (int j = 0; j < i; ++j)
      if ((in_nodes[std::size_t(i)] - in_nodes[std::size_t(j)]).cwiseAbs().maxCoeff() < 2 * kPlateau + 1)
        return Status::error(Code::kInvalidArgument, "points are nearer than five nodes", i);
  }
  space.node_weights.resize(std::size_t(space.size[0]) * space.size[1] * space.clips);
  float* weights = space.node_weights.data();
  for (int y = 0; y < space.size[1]; ++y)
    for (int x = 0; x < space.size[0]; ++x, weights += space.clips) bands(in_nodes, Point(x, y), weights);
  out = std::move(space);
  return {};
}

template <class T>
void blend_space_weights(const BlendSpace& space, std::span<const TimeJet<T>> parameters,
                         std::span<TimeJet<T>> weights) {
  const Along<T> x(space, 0, parameters[0]);
  const bool plane = space.dimensions == 2;
  const Along<T> y(space, plane ? 1 : 0, parameters[plane ? 1 : 0]);
  T sums[3][BlendSpace::kMaxClips] = {};  // values, rates, accelerations: each side by side for the compiler
  const int clips = std::min(static_cast<int>(weights.size()), space.clips);
  for (int b = 0; b < (plane ? 4 : 1); ++b)
    for (int a = 0; a < 4; ++a) {
      const TimeJet<T> basis = plane ? x.weight[a] * y.weight[b] : x.weight[a];
      const int node = x.node[a] + (plane ? y.node[b] * space.size[0] : 0);
      const float* at = space.node_weights.data() + std::size_t(node) * std::size_t(space.clips);
      for (int i = 0; i < clips; ++i) sums[0][i] += T(at[i]) * basis.value;
      for (int i = 0; i < clips; ++i) sums[1][i] += T(at[i]) * basis.rate;
      for (int i = 0; i < clips; ++i) sums[2][i] += T(at[i]) * basis.acceleration;
    }
  for (std::size_t i = 0; i < weights.size(); ++i) weights[i] = {sums[0][i], sums[1][i], sums[2][i]};
}

SINEW_BLEND_SPACE_INSTANCES(, float)
SINEW_BLEND_SPACE_INSTANCES(, double)

}  // namespace sinew
