// What accuracy costs in time: work-precision points of every engine on the same scenes.
#pragma once

#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "study/engine.h"

namespace sinew::study {

/// A scene of the study; every engine is measured against its own converged run of it, since contact laws
/// differ.
struct AccuracyScene {
  std::string name, title, reading;  ///< `reading`: what the diagram says to whoever looks at it
  std::string beside_peers;          ///< the same, of the peers: for builds that have them
  std::string to_catch_up;           ///< what it would take us where a peer is ahead
  double seconds = 1;                ///< of the trajectory that is compared
  EngineScene scene;
  bool contacts = false;
  std::vector<EngineOption> options;  ///< that are compared; empty: all that there are
  bool settles = false;               ///< only the pose at the end counts, against that of a long run at rest
  /// Targets and pushes of the step from t to t + h; empty where nothing is driven.
  std::function<void(Engine&, double t, double h)> drive;
};

/// Tumbling body, pendulum, limp figure's flights, collapse and drop, 50 : 1 stack, walk and run with pushes,
/// levels of detail.
std::vector<AccuracyScene> accuracy_scenes();
/// The stiff driver of the reference family: in joint coordinates, without figures of its own.
AccuracyScene stiff_driver();
/// Scenes of the same kinds by which nothing was chosen: presets must keep their word here.
std::vector<AccuracyScene> unseen_scenes();

/// One setting on one scene.
struct AccuracyPoint {
  std::string engine, option, varied;  ///< `varied`: what this sweep changes: "step", "tolerance" …
  double h = 0;                        ///< s
  Accuracy accuracy;
  bool survived = false;
  std::string refusal;  ///< why the engine cannot do the scene
  double error = 0;     ///< m: largest rms displacement of all mass from the converged run
  double degrees = 0;   ///< largest rms of all joint angles from that run
  double momentum = 0;  ///< relative change of the angular momentum, where the scene keeps it
  double energy = 0;    ///< change over the kinetic energy of the start or of a metre's fall; undriven scenes
  /// Processor time per simulated 1/60 s: mean of the scene's frames, median of repeated runs.
  double us = 0;
  double us_low = 0, us_high = 0;     ///< quartiles of the runs
  double us_p99 = -1, us_worst = -1;  ///< over the scene's frames, see frame_costs(); negative: not measured
  double instructions = -1;           ///< per simulated 1/60 s, by callgrind; negative: not counted
  double passes = 0;                  ///< mean per solved step
  bool pareto = false;                ///< no point is both faster and more accurate
  std::string label() const { return engine + " " + option; }
};

/// Integrators over tolerances (AccuracyPoint::h is 0: they choose their steps); none without the mechanism.
std::vector<AccuracyPoint> driver_points(int runs);

constexpr double kExact = 1e-7;  ///< m: solves are to 1e-9, over hundreds of steps

struct Slope {
  std::string engine, option;
  /// Order in h. Found 0: every error is below kExact, and no order shows. Expected 0: no theory claimed.
  double found = 0, expected = 0;
};

/// One step's own estimate of its error beside the truth, m (rms of all mass).
struct EstimatedFrame {
  double time = 0, estimated = 0, truth = 0;
};

struct AccuracyResult {
  AccuracyScene scene;
  std::vector<AccuracyPoint> points;
  std::vector<Slope> slopes;
  double references_apart = -1;  ///< m, between ours and the peer's converged run; < 0: not comparable
  double uncertainty =
      -1;  ///< m, between our converged run and one of twice its step: finer errors mean nothing
  std::vector<EstimatedFrame> estimates;  ///< of our scheme at 1/60 s
};

struct AccuracyOptions {
  bool quick = false;
  std::string only = {};   ///< scene; empty: all
  std::string store = {};  ///< file of finished points, to go on where a study was stopped; empty: none
};

/// `progress(done, total)` may be empty.
std::vector<AccuracyResult> run_accuracy(const AccuracyOptions& options,
                                         const std::function<void(int, int)>& progress);

/// Runs a scene with the estimate on; the truth of a step is 32 steps of a part of it from the same state.
/// Meant for options in double.
std::vector<EstimatedFrame> estimated_frames(const AccuracyScene& scene, const EngineOption& with, double h,
                                             const Accuracy& accuracy = {});

/// Instructions per simulated 1/60 s at such a tolerance and number of substeps, counted by callgrind in a
/// program of its own: the figure that repeats. Negative where it cannot be counted.
double instructions_of(const AccuracyScene& scene, const EngineOption& with, double h,
                       const Accuracy& accuracy = {});
/// Whether valgrind and the program are there.
bool can_count_instructions();

/// Root mean square displacement (m) of the mass of a figure between two poses.
double displacement(const Skeleton& skeleton, const std::vector<Transform<double>>& a,
                    const std::vector<Transform<double>>& b);
/// Least squares slope of log error over log h.
double order_of(const std::vector<AccuracyPoint>& points);
void mark_pareto(std::vector<AccuracyPoint>& points);
/// What the first screen of the report is about: errors (m) and scenes.
constexpr double kSummaryErrors[] = {1e-2, 1e-3};
constexpr const char* kSummaryScenes[] = {"tracking", "running", "collapse"};

/// The runtime's only scheme, as options are called that step by it.
constexpr const char* kDefaultScheme = "bossak";
/// Schemes of the study, which no game can ask for.
bool for_comparison(const AccuracyPoint& point);
/// In steps of 1/60 s and finer, or of an integrator's own choice; none of those for comparison, nor where
/// contacts are others or solves are cut short.
std::vector<AccuracyPoint> at_60_hz(const std::vector<AccuracyPoint>& points);
/// The cheapest survivor of an engine within `bound` (metres, or degrees of &AccuracyPoint::degrees), or
/// nullptr.
const AccuracyPoint* cheapest(const std::vector<AccuracyPoint>& points, const std::string& engine,
                              double bound, double AccuracyPoint::*error = &AccuracyPoint::error);

/// Peers' points that are no dearer and no further off than our scheme in float at 1/60 s: each peer's
/// cheapest. The first is our own; empty where it was not measured.
std::vector<AccuracyPoint> ahead_of_ours(const std::vector<AccuracyPoint>& points);

nlohmann::json point_json(const AccuracyPoint& point);
AccuracyPoint point_from(const nlohmann::json& json);

}  // namespace sinew::study
