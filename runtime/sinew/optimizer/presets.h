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

/// For close-ups, recorded takes. Within 0.005 m of a converged run; 17 µs per 1/60 s
/// while pushed, 55 µs while collapsing.
inline constexpr AccuracyPreset kCinematicPreset{
    "cinematic", false, {.scheme = Scheme::kBdf2, .tolerance = 3e-05, .substeps = 2}, 0.005};
/// For many characters, seen from afar. Within 0.018 m of a converged run; 9 µs per 1/60 s
/// while pushed, 31 µs while collapsing.
inline constexpr AccuracyPreset kCrowdPreset{
    "crowd", false, {.scheme = Scheme::kBdf2, .tolerance = 0.0003, .substeps = 1}, 0.018};
/// For players and those near them. Within 0.018 m of a converged run; 9 µs per 1/60 s
/// while pushed, 31 µs while collapsing.
inline constexpr AccuracyPreset kGamePreset{
    "game", false, {.scheme = Scheme::kBdf2, .tolerance = 0.0003, .substeps = 1}, 0.018};
/// For comparing others with. Within 0.00038 m of a converged run; 154 µs per 1/60 s
/// while pushed, 395 µs while collapsing.
inline constexpr AccuracyPreset kReferencePreset{
    "reference", true, {.scheme = Scheme::kBdf2, .tolerance = 1e-07, .substeps = 16}, 0.00038};

}  // namespace sinew
