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

/// For comparing others with. Within 0.44 mm of a converged run; 73 µs per 1/60 s
/// while pushed, 207 µs while collapsing.
inline constexpr AccuracyPreset kReferencePreset{
    "reference", true, {.tolerance = 1e-06, .substeps = 4}, 0.00044};
/// For close-ups, recorded takes. Within 1.9 mm of a converged run; 34 µs per 1/60 s
/// while pushed, 104 µs while collapsing.
inline constexpr AccuracyPreset kCinematicPreset{
    "cinematic", false, {.tolerance = 3e-05, .substeps = 2}, 0.0019};
/// For players and those near them. Within 6.7 mm of a converged run; 18 µs per 1/60 s
/// while pushed, 60 µs while collapsing.
inline constexpr AccuracyPreset kGamePreset{"game", false, {.tolerance = 3e-05, .substeps = 1}, 0.0067};
/// For many characters, seen from afar. No cheaper setting was measured: another name of kGamePreset.
inline constexpr AccuracyPreset kCrowdPreset = kGamePreset;

}  // namespace sinew
