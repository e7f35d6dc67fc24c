// Strands: hair, ropes, tails of a coat, antennae. Springs between neighbours and a stiffness against
// bending.
#pragma once

#include "sinew/effects/particles.h"

namespace sinew {

/// Made straight along `direction` from `root`, in the axes of `frame`.
struct StrandSettings {
  Anchor frame;                              ///< what its root is fixed to
  Vec3<double> root = Vec3<double>::Zero();  ///< m
  Vec3<double> direction{0, 0, -1};          ///< any length but 0
  double length = 0.3;                       ///< m
  int particles = 12;                        ///< free ones, at equal distances
  double mass = 0.02;                        ///< kg, all of it
  double stretch = 0.01;                     ///< share of its length by which it gives under its own weight
  double bending = 1e-5;                     ///< N·m²: E·I of a beam
  bool clamped = true;                       ///< leaves the root along `direction`; else it hangs on a pivot
  double radius = 0.005;                     ///< m, see ParticleBody
  double friction = 0.5;                     ///< see ParticleBody
  double damping = 0;                        ///< N·s/m of every node against the air
};

/// Settings that make no sense make a body that World::add_particles refuses.
ParticleBody make_strand(const StrandSettings& settings);

}  // namespace sinew
