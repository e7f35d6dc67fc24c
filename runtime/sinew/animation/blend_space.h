// Weights of clips by one or two parameters: idle, walk and run by speed; directions by a stick.
#pragma once

#include <span>
#include <vector>

#include "sinew/animation/clip.h"
#include "sinew/animation/time_jet.h"

namespace sinew {

/// Weights at the nodes of a grid over one or two parameters, between which a cubic B-spline runs: C²
/// wherever the parameters go, never negative, adding up to 1. Beyond the grid they stay as at its edge.
/// Triangles and lines between points, as others use them, have kinks at every edge.
struct BlendSpace {
  static constexpr int kMaxClips = 16;  ///< of one space
  int clips = 0;                        ///< 1 … kMaxClips
  int dimensions = 1;                   ///< 1 or 2
  int size[2] = {1, 1};                 ///< nodes along each
  double origin[2] = {0, 0};            ///< parameters of the first node
  double interval[2] = {1, 1};          ///< between nodes
  std::vector<float> node_weights;      ///< [second][first][clip]
};

/// Set-up: weights for clips that each have a point, `points` [clip][dimension], on a grid of `nodes` along
/// each dimension. Between points by gradient bands (Johansen 2009: wᵢ = minⱼ(1 − (p−pᵢ)·(pⱼ−pᵢ)/|pⱼ−pᵢ|²)
/// above 0, normalised): any set of points, also on a line. Within two nodes of a point its clip has all of
/// the weight, so that at the point itself it plays alone. Refuses points nearer than five nodes.
/// `Status::index`: point.
Status bake_blend_space(std::span<const double> points, int dimensions, int nodes, BlendSpace& out);

/// Weights [clip] at parameters [dimension] that move, with their rates: p through SmoothInput makes them C².
/// Allocates nothing. Parameters must be finite; cost 16 nodes (4 with one parameter) times the clips.
template <class T>
void blend_space_weights(const BlendSpace& space, std::span<const TimeJet<T>> parameters,
                         std::span<TimeJet<T>> weights);

#define SINEW_BLEND_SPACE_INSTANCES(prefix, T)                                                \
  prefix template void blend_space_weights<T>(const BlendSpace&, std::span<const TimeJet<T>>, \
                                              std::span<TimeJet<T>>);
SINEW_BLEND_SPACE_INSTANCES(extern, float)
SINEW_BLEND_SPACE_INSTANCES(extern, double)

}  // namespace sinew
