// What accuracy costs in time: work-precision points of every engine on the same scenes.
#pragma once

#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "convert/convert.h"
#include "study/engine.h"

namespace sinew::study {

/// A scene of the study; every engine is measured against its own converged run of it, since contact laws
/// differ.
struct AccuracyScene {
  std::string name, title, reading;  ///< `reading`: what the diagram says to whoever looks at it
  double seconds = 1;                ///< of the trajectory that is compared
  EngineScene scene;
  bool contacts = false;
  bool settles = false;  ///< only the pose at the end counts, against that of a long run at rest
  /// Targets and pushes of the step from t to t + h; empty where nothing is driven.
  std::function<void(Engine&, double t, double h)> drive;
};

/// Tumbling body, limp figure's drop, 50 : 1 stack, walk with pushes.
std::vector<AccuracyScene> accuracy_scenes();

/// One setting on one scene.
struct AccuracyPoint {
  std::string engine, option, varied;  ///< `varied`: what this sweep changes: "step", "tolerance" …
  double h = 0;                        ///< s
  Accuracy accuracy;
  bool survived = false;
  std::string refusal;             ///< why the engine cannot do the scene
  double error = 0;                ///< m: largest rms displacement of all mass from the converged run
  double energy = 0;               ///< change over the largest kinetic energy; undriven scenes
  double us = 0;                   ///< median, per simulated 1/60 s
  double us_low = 0, us_high = 0;  ///< quartiles
  double passes = 0;               ///< mean per solved step
  bool pareto = false;             ///< no point is both faster and more accurate
  std::string label() const { return engine + " " + option; }
};

struct Slope {
  std::string engine, option;
  double found = 0, expected = 0;  ///< order in h; expected 0: no theory claimed
};

struct AccuracyResult {
  AccuracyScene scene;
  std::vector<AccuracyPoint> points;
  std::vector<Slope> slopes;
  double references_apart = -1;  ///< m, between ours and the peer's converged run; < 0: not comparable
};

struct AccuracyOptions {
  bool quick = false;
  std::string only;  ///< scene; empty: all
};

/// `progress(done, total)` may be empty.
std::vector<AccuracyResult> run_accuracy(const AccuracyOptions& options,
                                         const std::function<void(int, int)>& progress);

/// One step's own estimate of its error beside the truth, m (rms of all mass).
struct EstimatedFrame {
  double time = 0, estimated = 0, truth = 0;
};
/// Runs a scene with the estimate on; the truth of a step is 32 steps of a part of it from the same state.
/// Meant for options in double.
std::vector<EstimatedFrame> estimated_frames(const AccuracyScene& scene, const EngineOption& with, double h,
                                             const Accuracy& accuracy = {});

/// Root mean square displacement (m) of the mass of a figure between two poses.
double displacement(const Skeleton& skeleton, const std::vector<Transform<double>>& a,
                    const std::vector<Transform<double>>& b);
/// Least squares slope of log error over log h.
double order_of(const std::vector<AccuracyPoint>& points);
void mark_pareto(std::vector<AccuracyPoint>& points);
/// Least time (µs per 1/60 s) among points of an engine within `error` metres, or a negative number.
double price_of(const std::vector<AccuracyPoint>& points, const std::string& engine, double error);

std::string accuracy_csv(const std::vector<AccuracyResult>& results);
nlohmann::json accuracy_json(const std::vector<AccuracyResult>& results);
/// One self-contained page.
std::string accuracy_html(const std::vector<AccuracyResult>& results);
/// One scene's work-precision diagram in a light theme, .png or .svg.
convert::Error draw_accuracy(const AccuracyResult& result, const std::string& file);

}  // namespace sinew::study
