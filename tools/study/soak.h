// Endurance: twenty characters in a crowd, who are pushed against each other, teleported, weakened and woken,
// for as long as you like.
#pragma once

#include <cstdint>

#include "study/stage.h"

namespace sinew::study {

struct SoakReport {
  int frames = 0;
  int not_finite = 0;                 ///< frames in which any joint was NaN or infinite
  long heap_growth = 0;               ///< bytes that steps after the first second left in use, all told
  double median_us = 0, p999_us = 0;  ///< of a frame
  int looked = 0, touching = 0;       ///< frames looked at, and those in which characters touched each other
  Measurement measured;               ///< counts of passes and unconverged steps
};

template <class T>
SoakReport soak(double seconds, double h, std::uint64_t seed);

}  // namespace sinew::study
