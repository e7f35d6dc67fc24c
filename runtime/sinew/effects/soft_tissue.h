// Soft tissue: a belly, a tail, a cushion. Tetrahedra of a stable Neo-Hookean solid (coupling.h).
#pragma once

#include <array>
#include <vector>

#include "sinew/effects/particles.h"

namespace sinew {

/// One piece of tissue.
struct SoftTissueSettings {
  Anchor frame;                         ///< what it hangs on
  std::vector<Vec3<double>> positions;  ///< m, at rest, in the frame's axes
  std::vector<std::array<int, 4>>
      tetrahedra;          ///< right-handed: the fourth corner sees 1, 2, 3 anticlockwise from outside
  std::vector<int> fixed;  ///< nodes that ride on the frame
  double density = 1000;   ///< kg/m³
  double young = 2e4;      ///< Pa: stiffness against pulling; fat 2e3, muscle 5e4
  double poisson = 0.45;   ///< below ½; near it, volume is kept
  double radius = 0.01;    ///< m, see ParticleBody
  double friction = 0.5;   ///< see ParticleBody
  double damping = 0;      ///< N·s/m of every node against the air
};

/// A box from the origin to `size` (m) in cells, six tetrahedra each. Node (i, j, k) is number
/// (k·(cells y + 1) + j)·(cells x + 1) + i.
void make_block(const Vec3<double>& size, const std::array<int, 3>& cells, SoftTissueSettings& out);

/// Settings that make no sense (a flat or inverted tetrahedron among them) make a body that
/// World::add_particles refuses.
ParticleBody make_soft_tissue(const SoftTissueSettings& settings);

}  // namespace sinew
