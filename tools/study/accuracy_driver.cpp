// The stiff driver of the reference family: what implicit integrators of general purpose cost beside ours.
#include <algorithm>
#include <cmath>
#include <filesystem>

#include "study/accuracy.h"
#include "study/tables/measure.h"
#include "study/tables/peers.h"

namespace sinew::study {
namespace {

/// Where the mechanism's file and its reference are; empty: nowhere.
std::string directory() {
  for (const char* place : {SINEW_SOURCE_DIR "/../shared/mechanisms", SINEW_SOURCE_DIR "/assets/mechanisms"})
    if (std::filesystem::exists(std::string(place) + "/driver_stiff.json")) return place;
  return {};
}

/// One integrator at one tolerance; `simulate` runs it once.
AccuracyPoint point(const StudyCase& c, const std::string& engine, const std::string& option,
                    double tolerance, int runs, const std::function<SimulationRun()>& simulate) {
  AccuracyPoint p;
  p.engine = engine;
  p.option = option;
  p.varied = "step";
  p.accuracy.tolerance = tolerance;
  std::vector<double> times;
  for (int n = 0; n < runs; ++n) {
    const SimulationRun m = simulate();
    p.survived = m.stopped.empty() && std::isfinite(m.error.q);
    if (!p.survived) return p;
    p.error = m.error.q;
    p.passes = m.steps > 0 ? double(m.evaluations) / double(m.steps) : 0;
    times.push_back(1e3 * m.milliseconds);
  }
  std::sort(times.begin(), times.end());
  const double frames = 60 * c.reference.t.back();
  p.us = times[times.size() / 2] / frames;
  p.us_low = times[times.size() / 4] / frames;
  p.us_high = times[times.size() * 3 / 4] / frames;
  return p;
}

}  // namespace

AccuracyScene stiff_driver() {
  AccuracyScene s;
  s.name = "driver";
  s.title = "A driver on stiff springs in a frontal crash";
  s.reading =
      "41 degrees of freedom in joint coordinates, springs up to 120 kN·m/rad, no contact that opens: the "
      "stiff driver of the reference family, which integrates residuals. Integrators choose their steps; "
      "points "
      "are tolerances. Error is the largest of all coordinates and instants, in rad or m over one plus the "
      "value, from a run at 10⁻¹² and beyond. Explicit integrators are held back by stability, not by "
      "accuracy: "
      "that is what stiff means.";
  s.beside_peers = "SUNDIALS and Odeint integrate our accelerations, Simbody its own.";
  s.seconds = 0.25;
  return s;
}

std::vector<AccuracyPoint> driver_points(int runs) {
  StudyCase c;
  const std::string place = directory();
  if (place.empty() || !load_case(place, "driver_stiff", c).empty()) return {};
  c.stiff = true;
  std::vector<AccuracyPoint> points;
  for (const double tolerance : {1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-8}) {
    for (const char* integrator : {"ode15sR", "DASSL"})
      points.push_back(point(c, "Sinew", std::string(integrator) + " on residuals", tolerance, runs,
                             [&] { return measure(c, "RR-JF", integrator, tolerance, 1); }));
    for (const Peer& peer : peers()) {
      const std::size_t cut = peer.name.find(" · ");
      const std::string engine = peer.name.substr(0, cut),
                        option = cut == std::string::npos ? "" : peer.name.substr(cut + 4);
      points.push_back(point(c, engine, option, tolerance, peer.stiff_too ? runs : 1,
                             [&] { return peer.measure(c, tolerance, 1); }));
    }
  }
  return points;
}

}  // namespace sinew::study
