// Falls judged as a crowd: the mean kinetic energy of many starts beside that of the same engine's finest
// steps. A single fall is chaotic (after a second the finest runs are decimetres apart), while the means of
// finest runs agree.
#pragma once

#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "convert/convert.h"
#include "study/engine.h"

namespace sinew::study {

/// A fall whose start is drawn anew for every seed.
struct EnsembleScene {
  std::string name, title;
  EngineScene (*start)(unsigned seed);
};

/// Limp humanoids (37 degrees of freedom): "fall", joints at 3 rad/s rms, feet 0.3 m up; "tumbling_fall",
/// turning as a whole at 10 rad/s, feet 0.8 m up.
const std::vector<EnsembleScene>& ensemble_scenes();

/// Over the seeds, J.
struct EnergyCurve {
  std::vector<double> mean, deviation;  ///< [time]; standard deviation
};

struct Ensemble {
  std::string engine, option, scene;
  double hz = 0;
  int seeds = 0;          ///< that were run to the end, with these steps and with the finest
  int lost = 0;           ///< others
  std::vector<double> t;  ///< s: every step but the first and the last
  EnergyCurve energy, truth;

  /// Mean over true mean, at the sample next to a time.
  double share(double time) const;
  /// Standard error of that, were the starts of both drawn apart.
  double uncertainty(double time) const;

 private:
  std::size_t sample(double time) const;
};

/// Kinetic energy (J) halfway between two poses (joint frames in the world) that are `span` seconds apart,
/// from nothing but them: mean velocities of the centres of mass, and the rotation from one to the other.
double kinetic_energy(const Skeleton& skeleton, const std::vector<Transform<double>>& before,
                      const std::vector<Transform<double>>& after, double span);

/// Falls of a scene at an engine's finest steps.
struct TrueFalls {
  double seconds = 0;
  /// [seed − 1][n] poses (joint frames in the world) at n/kTrueHz s; fewer where the engine gave up.
  std::vector<std::vector<std::vector<Transform<double>>>> poses;
};
constexpr double kTrueHz = 60;

/// Steps of 1/finest s, a multiple of kTrueHz. Seeds 1 to `seeds`, on all processors.
TrueFalls true_falls(const EnsembleScene& scene, const EngineOption& with, double finest, int seeds,
                     double seconds);

/// The same falls at steps of 1/hz s, of which kTrueHz is a multiple; both are judged by poses 2/hz s apart.
Ensemble run_ensemble(const EnsembleScene& scene, const EngineOption& with, double hz,
                      const TrueFalls& truth);

/// Every scene at 60 and 30 Hz, by our schemes and the peers that take any step. All of ours are judged by
/// the most accurate of them at the finest steps, a peer by itself. `quick`: 96 seeds instead of 384, finest
/// steps of 1/1920 s instead of 1/3840 (at 1/960 bdf2 still has a tenth less energy after 0.75 s). `seeds`:
/// so many instead.
std::vector<Ensemble> run_ensembles(bool quick, const std::function<void(int, int)>& progress, int seeds = 0);

/// {"ensembles": [{"engine", "scene", "hz", "scheme", "scalar", "seeds", "lost", "t", "energy",
/// "energy_deviation", "truth", "truth_deviation"}]}, energies in J.
nlohmann::json ensembles_json(const std::vector<Ensemble>& all);
/// Share of the true mean at 0.5, 0.75, 1 and 1.5 s, and its standard error.
std::string ensembles_table(const std::vector<Ensemble>& all);
/// Curves of one scene and step as an SVG element; empty where nobody has run it.
std::string ensembles_svg(const std::vector<Ensemble>& all, const EnsembleScene& scene, double hz);
/// The same, .png or .svg.
convert::Error draw_ensembles(const std::vector<Ensemble>& all, const EnsembleScene& scene, double hz,
                              const std::string& file);

}  // namespace sinew::study
