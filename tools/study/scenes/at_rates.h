// A scene at the rates that games step at, judged run by run.
#pragma once

#include <initializer_list>

#include "study/scenes/situation.h"

namespace sinew::study {

/// Everybody thrown otherwise.
inline scene::Scene reseeded(scene::Scene scene, int seed) {
  for (scene::SceneCharacter& c : scene.characters)
    if (c.speeds.random > 0) c.speeds.seed += 100u * static_cast<unsigned>(seed);
  return scene;
}

inline double fastest_of(const Judge& judge, int first, int last, int member = -1) {
  return judge.worst(first, last, [&](int f) { return judge.fastest(f, member); });
}

inline double deepest_between(const Judge& judge, int first, int last) {
  return judge.worst(first, last, [&](int f) { return judge.depth_between(f); });
}

inline void note_times(const Played& played, Findings& found) {
  double most = 0, sum = 0;
  for (const scene::TelemetryRow& row : played.telemetry.rows) {
    most = std::max(most, 1e-3 * row.microseconds);
    sum += 1e-3 * row.microseconds;
  }
  found.note("longest step (ms)", most);
  found.note("mean step (ms)", sum / double(std::max<std::size_t>(played.telemetry.rows.size(), 1)));
}

inline void note_passes(const Played& played, Findings& found) {
  double passes = 0;
  for (const scene::TelemetryRow& row : played.telemetry.rows) passes += row.report.outer_passes;
  found.note("passes of a step, mean",
             passes / double(std::max<std::size_t>(played.telemetry.rows.size(), 1)));
}

inline constexpr std::initializer_list<double> kRates = {30.0, 60.0, 120.0};  ///< Hz that a game may step at

/// Plays a scene at each rate (Hz), everybody thrown in so many ways, for look(played, judge). Nothing may be
/// deeper in floor and obstacles than `depth` (m).
template <class Look>
void at_rates(const scene::Scene& scene, std::initializer_list<double> rates, int throws, double depth,
              Findings& found, const Look& look) {
  for (const double hz : rates)
    for (int seed = 0; seed < throws; ++seed) {
      scene::Scene at = reseeded(scene, seed);
      at.frame_rate = hz;
      const Played played(at);
      found.sound(played, depth);
      look(played, played.judge());
    }
}

}  // namespace sinew::study
