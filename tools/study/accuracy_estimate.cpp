// How well a step knows its own error: estimate beside truth, frame by frame.
#include <cmath>

#include "study/accuracy.h"

namespace sinew::study {

namespace {

constexpr int kParts = 32;  ///< of a step: what is left of a first-order error is 3 %

}  // namespace

std::vector<EstimatedFrame> estimated_frames(const AccuracyScene& s, const EngineOption& with, double h,
                                             const Accuracy& accuracy) {
  Accuracy estimating = accuracy, exact = accuracy;
  estimating.estimate_error = true;
  exact.tolerance = 1e-7;
  exact.max_splits = 0;
  const std::unique_ptr<Engine> engine = with.make(s.scene, h, estimating),
                                truth = with.make(s.scene, h / kParts, exact);
  std::vector<EstimatedFrame> frames;
  const int steps = static_cast<int>(std::lround(s.seconds / h));
  for (int n = 0; n < steps; ++n) {
    if (!truth->take_state(*engine)) return {};
    if (s.drive) s.drive(*engine, n * h, h);
    if (!engine->step()) return frames;
    for (int k = 0; k < kParts; ++k) {
      if (s.drive) s.drive(*truth, n * h + k * h / kParts, h / kParts);
      if (!truth->step()) return frames;
    }
    EstimatedFrame& frame = frames.emplace_back();
    frame.time = (n + 1) * h;
    frame.estimated = engine->estimated_error();
    double sum = 0, mass = 0;
    for (std::size_t f = 0; f < s.scene.figures.size(); ++f) {
      const Skeleton& skeleton = s.scene.figures[f].skeleton;
      const double m = skeleton.total_mass();
      const int at = static_cast<int>(f);
      sum += m * std::pow(displacement(skeleton, engine->pose(at), truth->pose(at)), 2);
      mass += m;
    }
    frame.truth = std::sqrt(sum / mass);
  }
  return frames;
}

}  // namespace sinew::study
