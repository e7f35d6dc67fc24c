// One run of a scene, and how far two runs are apart.
#pragma once

#include "study/accuracy.h"

namespace sinew::study {

/// Poses of all figures at multiples of 1/30 s; of scenes that settle, the last alone.
using Track = std::vector<std::vector<std::vector<Transform<double>>>>;

struct Trip {
  bool survived = false;
  std::string refusal;
  Track track;                 ///< where asked for
  double seconds = 0;          ///< of processor time, spent in steps
  std::vector<double> frames;  ///< s, of these: by frames of 1/60 s, or by steps where those are longer
  double energy = 0;  ///< change over the kinetic energy of the start, or over that of a metre's fall
  double momentum =
      0;  ///< largest change of the angular momentum, of scenes that keep it and engines that tell it
  double passes = 0;
};

/// What frames cost, in the unit of the times.
struct FrameCosts {
  double mean = 0, p99 = 0, worst = 0;  ///< over frames; the 99th percentile between its two neighbours
};
/// Of repeated runs of the same work, [run][frame]: of every frame the median over runs, which is the work's,
/// not that of what disturbed one of them.
FrameCosts frame_costs(const std::vector<std::vector<double>>& runs);

Trip travel(const AccuracyScene& scene, const EngineOption& with, double h, const Accuracy& accuracy,
            bool observe);

/// The converged run that engine `with` is measured against: steps of 1/7680 s (coarse: 1/3840) solved to the
/// nanometre; where a scene settles, six seconds at rest.
/// Half as fine where `coarse`.
Track converged(const AccuracyScene& scene, const EngineOption& with, bool coarse);

/// Largest rms displacement of all mass over the poses, m.
double apart(const AccuracyScene& scene, const Track& a, const Track& b);
/// Largest root mean square angle of all joints (the root's is none) over the poses, degrees.
double degrees_apart(const AccuracyScene& scene, const Track& a, const Track& b);

}  // namespace sinew::study
