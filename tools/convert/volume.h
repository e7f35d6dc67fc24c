// Volume, centre and second moments of the parts of a skinned mesh.
#pragma once

#include <span>
#include <vector>

#include "sinew/io/asset.h"

namespace sinew::convert {

/// The solid of one body part, model axes.
struct Solid {
  double volume = 0;                                  ///< m³
  Vec3<double> center = Vec3<double>::Zero();         ///< m
  Mat3<double> second_moment = Mat3<double>::Zero();  ///< ∫ x xᵀ dV about the centre, m⁵
  int cells = 0;                                      ///< how many cells it is made of: its precision
};

/// Inertia about the centre for a mass in kg; always satisfies the triangle inequality.
Mat3<double> inertia_of(const Solid& solid, double mass);

/// Fills the meshes with cubic cells and gives each cell to the part of its nearest vertex. A cell is inside
/// when at least two of the three lines along the axes say so by their winding number: overlapping shells
/// count once, and a hole or an open hem spoils one direction only. `part_of_vertex[mesh][vertex]` in [0,
/// parts). About 1 % of the height per cell; O(cells + triangles).
std::vector<Solid> part_solids(std::span<const Mesh> meshes,
                               const std::vector<std::vector<int>>& part_of_vertex, int parts);

}  // namespace sinew::convert
