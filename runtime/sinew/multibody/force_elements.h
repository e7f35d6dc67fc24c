// Forces of a mechanism: wrenches on bodies and forces on coordinates, their energies, and their derivatives.
#pragma once

#include "sinew/multibody/motion.h"

namespace sinew::multibody {

/// Everything that acts besides gravity: per body a force and a moment about the world's origin (N, N·m),
/// per coordinate what its joint's spring, damper and friction exert.
struct AppliedForces {
  std::vector<Vec3<double>> force, moment;
  Vector joint;

  explicit AppliedForces(const Model& model)
      : force(model.size()), moment(model.size()), joint(Vector::Zero(model.size())) {}
};

/// Poses and rates of `motion` must be those of (q, qd).
void apply_forces(const Model& model, double t, const ConstVector& q, const ConstVector& qd,
                  const BodyMotion& motion, AppliedForces& out);

/// Gravity, linear and cubic joint springs, springs of mode `both` and anchor springs, J.
double potential_energy(const Model& model, double t, const ConstVector& q, const BodyMotion& motion);
/// Work per second, W, of everything that `potential_energy` leaves out (dampers, one-sided and prescribed
/// forces), so that d(kinetic + potential)/dt = this.
double power_of_others(const Model& model, double t, const ConstVector& q, const ConstVector& qd,
                       const BodyMotion& motion);
double kinetic_energy(const Model& model, const BodyMotion& motion);

/// Adds −∂Q/∂q to `stiffness` and −∂Q/∂q' to `damping` [N×N], Q the forces on the coordinates (equation 78:
/// the derivatives of the motion axes inside Q = Rᵀ·force are left out, those of the force law are exact).
void add_force_tangent(const Model& model, double t, const ConstVector& q, const ConstVector& qd,
                       const BodyMotion& motion, Matrix& stiffness, Matrix& damping);

/// A force law's value and its derivatives.
struct Law {
  double force = 0, by_length = 0, by_rate = 0;
};
/// Pull of a spring damper at length l and rate l' (positive draws the points together).
Law spring_damper_law(const Force& f, double length, double rate);
/// One-sided push at depth d and rate d': k·s(d) + c·s'(d)·d' (contact plane, tyre).
Law contact_law(const Force& f, double depth, double rate);

}  // namespace sinew::multibody
