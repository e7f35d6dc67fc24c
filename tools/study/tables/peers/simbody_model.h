// A mechanism as a Simbody system: its own mobilizers, constraints and equations of motion; the force laws of
// the file in one custom force.
#pragma once

#include <Simbody.h>

#include <memory>
#include <vector>

#include "sinew/multibody/mechanism.h"

namespace sinew::study {

class SimbodyModel {
 public:
  /// `one_angle` [loop]: leave out the second of the two conditions on a revolute loop's axis. Told to keep
  /// redundant conditions, Simbody loses its way (Bricard at 1e-5: off by 0.7 rad); the condition follows
  /// from the others.
  SimbodyModel(const multibody::Mechanism& mechanism, const std::vector<bool>& one_angle);

  SimTK::MultibodySystem system;
  SimTK::SimbodyMatterSubsystem matter;
  SimTK::GeneralForceSubsystem forces;
  std::vector<SimTK::MobilizedBody> bodies;  ///< [joint]
  SimTK::State start() const;

 private:
  const multibody::Mechanism& mechanism_;
};

}  // namespace sinew::study
