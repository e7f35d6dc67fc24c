// A mechanism as a Simbody system: its own mobilizers, constraints and equations of motion; the force laws of the file
// in one custom force.
#pragma once

#include <Simbody.h>

#include <memory>
#include <vector>

#include "sinew/multibody/mechanism.h"

namespace sinew::study {

class SimbodyModel {
 public:
  explicit SimbodyModel(const multibody::Mechanism& mechanism);

  SimTK::MultibodySystem system;
  SimTK::SimbodyMatterSubsystem matter;
  SimTK::GeneralForceSubsystem forces;
  std::vector<SimTK::MobilizedBody> bodies;  ///< [joint]
  SimTK::State start() const;

 private:
  const multibody::Mechanism& mechanism_;
};

}  // namespace sinew::study
