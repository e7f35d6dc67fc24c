// Muscles of a driven figure in Simbody, which has no motor with a force limit of its own: torques from its
// own inverse dynamics and mass matrix, within the muscles' limits. The root moves as told (Motion).
#pragma once

#include <Simbody.h>

#include <Eigen/Cholesky>

#include "study/tables/peers/simbody_world.h"

namespace sinew::study {

SimTK::Vec3 simtk(const Vec3<double>& v);
SimTK::Rotation simtk(const Quat<double>& q);

/// Where a driven figure shall be: `jets` at time `at`, and on the way there as they say.
struct SimbodyTarget {
  std::vector<SimbodyJet> jets;
  double at = 0;  ///< s
  SimbodyJet when(int body, double time) const;
};

/// What all muscles and pushes work on; lives as long as the system.
struct SimbodyDriven {
  const SimbodyScene* scene;
  const SimTK::SimbodyMatterSubsystem* matter;
  const SimTK::Force::Gravity* gravity;
  const SimTK::ContactTrackerSubsystem* tracker;
  const SimTK::CompliantContactSubsystem* contacts;
  std::vector<std::vector<SimTK::MobilizedBody>> bodies;  ///< [figure][body]
  std::vector<SimbodyTarget> targets;                     ///< [figure]
  SimTK::Vector_<SimTK::SpatialVec> pushes;  ///< [mobilised body] N·m and N at its origin, world
};

/// Pushes, and muscles that bring each joint back to its target critically damped, under gravity, pushes and
/// contacts: where the torque for that is beyond its limit, the limit, and the other joints bear what
/// follows.
class SimbodyMuscles : public SimTK::Force::Custom::Implementation {
 public:
  explicit SimbodyMuscles(const SimbodyDriven& driven) : driven_(driven) {}
  bool dependsOnlyOnPositions() const override { return false; }
  SimTK::Real calcPotentialEnergy(const SimTK::State&) const override { return 0; }
  void calcForce(const SimTK::State& state, SimTK::Vector_<SimTK::SpatialVec>& on_bodies,
                 SimTK::Vector_<SimTK::Vec3>& on_particles, SimTK::Vector& on_mobilities) const override;

 private:
  /// Degrees of freedom that muscles pull at: limits in N·m and [mobility × dof] directions, child axes.
  struct Dofs {
    std::vector<double> lower, upper;
    Eigen::MatrixXd directions;
  };
  Dofs dofs(const SimTK::State& state) const;
  Eigen::VectorXd limited(const SimTK::State& state, const Dofs& dofs, const Eigen::VectorXd& torques) const;
  SimTK::Vector wanted(const SimTK::State& state) const;
  SimTK::Vector_<SimTK::SpatialVec> outside(const SimTK::State& state) const;

  const SimbodyDriven& driven_;
};

/// A driven root: place, velocity and acceleration as a function of time.
class SimbodyRoot : public SimTK::Motion::Custom::Implementation {
 public:
  SimbodyRoot(const SimbodyDriven& driven, int figure) : driven_(driven), figure_(figure) {}
  Implementation* clone() const override { return new SimbodyRoot(*this); }
  SimTK::Motion::Level getLevel(const SimTK::State&) const override { return SimTK::Motion::Position; }
  void calcPrescribedPosition(const SimTK::State& s, int nq, SimTK::Real* q) const override;
  void calcPrescribedPositionDot(const SimTK::State& s, int nq, SimTK::Real* qdot) const override;
  void calcPrescribedPositionDotDot(const SimTK::State& s, int nq, SimTK::Real* qdotdot) const override;

 private:
  SimbodyJet now(const SimTK::State& s) const { return driven_.targets[figure_].when(0, s.getTime()); }

  const SimbodyDriven& driven_;
  int figure_;
};

}  // namespace sinew::study
