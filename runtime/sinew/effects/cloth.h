// Cloth: triangles whose edges are springs and whose bends cost energy.
//
// Springs by Van Gelder, "Approximate simulation of elastic membranes by triangulated spring meshes", 1998;
// bending quadratic in the positions, by Bergou, Wardetzky, Harmon, Zorin & Grinspun, "A quadratic bending
// model for inextensible surfaces", 2006: for cloth that was flat at rest.
#pragma once

#include <array>
#include <vector>

#include "sinew/effects/particles.h"

namespace sinew {

/// One sheet. An edge that more than two triangles share does not resist bending.
struct ClothSettings {
  Anchor frame;                               ///< what it hangs on
  std::vector<Vec3<double>> positions;        ///< m, at rest, in the frame's axes
  std::vector<std::array<int, 3>> triangles;  ///< indices of positions, either way round
  std::vector<int> fixed;                     ///< nodes that ride on the frame
  double density = 0.2;                       ///< kg/m²
  double stretch = 400;   ///< N/m: a strip pulled by so much per metre of width is twice as long
  double bending = 3e-5;  ///< N·m
  double radius = 0.01;   ///< m, see ParticleBody
  double friction = 0.5;  ///< see ParticleBody
  double damping = 0;     ///< N·s/m of every node against the air
};

/// A rectangle of columns × rows cells in the x–z plane, its upper edge along x from the origin, hanging
/// down. Node (column, row) is number row·(columns + 1) + column.
void make_grid(double width, double height, int columns, int rows, ClothSettings& out);

/// Settings that make no sense make a body that World::add_particles refuses.
ParticleBody make_cloth(const ClothSettings& settings);

}  // namespace sinew
