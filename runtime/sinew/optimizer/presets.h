// Accuracy presets, chosen from measured curves: written by `sinew study accuracy` (DIR/presets.h), not by
// hand. The same figures, with where and when they were measured, are in assets/accuracy_presets.json.
#pragma once

#include "sinew/optimizer/accuracy.h"

namespace sinew {

struct AccuracyPreset {
  const char* name;
  bool double_precision;  ///< World<double>, else World<float>
  Accuracy accuracy;      ///< substeps are those of a step of 1/60 s
  double error;           ///< m, the largest measured: rms of all mass from a converged run
};

/// For close-ups, recorded takes. Within 0.0057 m of a converged run; 22 µs per 1/60 s
/// while pushed, 57 µs while collapsing.
inline constexpr AccuracyPreset kCinematicPreset{
    "cinematic", false, {.tolerance = 3e-05, .substeps = 2}, 0.0057};
/// For many characters, seen from afar. Within 0.1 m of a converged run; 9 µs per 1/60 s
/// while pushed, 28 µs while collapsing.
inline constexpr AccuracyPreset kCrowdPreset{
    "crowd", false, {.tolerance = 0.0003, .substeps = 1}, 0.1};
/// For players and those near them. Within 0.017 m of a converged run; 12 µs per 1/60 s
/// while pushed, 33 µs while collapsing.
inline constexpr AccuracyPreset kGamePreset{
    "game", false, {.tolerance = 0.0003, .substeps = 1}, 0.017};
/// For comparing others with. Within 0.00037 m of a converged run; 206 µs per 1/60 s
/// while pushed, 449 µs while collapsing.
inline constexpr AccuracyPreset kReferencePreset{
    "reference", true, {.tolerance = 1e-07, .substeps = 16}, 0.00037};

}  // namespace sinew
