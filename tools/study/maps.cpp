#include "study/maps.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "scene/humanoid.h"
#include "study/bodies.h"

namespace sinew::study {
namespace {

constexpr double kPi = 3.14159265358979323846;

/// Energy over the run, in J.
struct Run {
  double start = 0, end = 0, most = 0;
  bool built = true, survived = true;
};

Run fly(const EngineOption& with, const EngineScene& scene, double h, double seconds) {
  Run run;
  const std::unique_ptr<Engine> engine = with.make(scene, h, Accuracy{});
  if (!engine->refusal().empty()) return {0, 0, 0, false, false};
  run.start = run.end = run.most = engine->energy();
  const int count = static_cast<int>(std::lround(seconds / h));
  for (int n = 0; n < count && run.survived; ++n) {
    run.survived = engine->step();
    run.end = engine->energy();
    run.survived = run.survived && std::isfinite(run.end);
    if (run.survived) run.most = std::max(run.most, run.end);
  }
  return run;
}

/// `scale` is the energy that moves in the scene (J). The bounds are what an eye accepts: a tenth of the
/// energy is 5 % of speed.
MapCell judged(const Run& run, double scale) {
  MapCell cell;
  const double gain = (run.most - run.start) / scale;
  cell.energy = run.survived ? (run.end - run.start) / scale : INFINITY;
  if (!run.built)
    cell.fate = Fate::kCannot;
  else if (!run.survived || gain > 10)
    cell.fate = Fate::kExplodes;
  else if (gain > 0.01)
    cell.fate = Fate::kGains;
  if (run.survived && cell.fate > Fate::kLoses) cell.energy = gain;
  if (cell.fate > Fate::kLoses) return cell;
  if (cell.energy < -0.1) cell.fate = Fate::kLoses;
  return cell;
}

MapCell worse(const MapCell& a, const MapCell& b) {
  if (a.fate != b.fate) return a.fate > b.fate ? a : b;
  return std::abs(a.energy) > std::abs(b.energy) ? a : b;
}

std::vector<EngineOption> all_options() {
  std::vector<EngineOption> all = sinew_options();
  const std::vector<EngineOption> peers = peer_options();
  all.insert(all.end(), peers.begin(), peers.end());
  return all;
}

/// Fills the cells; cell(engine, h, column) runs one.
template <class Cell>
void fill(FailureMap& map, const std::function<void(int, int)>& progress, const Cell& cell) {
  const int total = static_cast<int>(map.engines.size() * map.steps.size());
  for (const EngineOption& engine : map.engines)
    for (const double h : map.steps) {
      for (const double column : map.columns) map.cells.push_back(cell(engine, h, column));
      if (progress) progress(static_cast<int>(map.cells.size() / map.columns.size()), total);
    }
}

}  // namespace

MapCell fate_of_flight(const EngineOption& engine, double h, double speed, int seeds) {
  MapCell cell;
  for (int seed = 1; seed <= seeds; ++seed) {
    EngineScene scene;
    scene.gravity.setZero();
    scene.ground = false;
    scene.figures.push_back(resting(humanoid()));
    Figure& figure = scene.figures[0];
    make_frictionless(figure.skeleton);
    figure.skeleton.colliders.clear();
    randomise_speeds(figure.skeleton, figure.jets, speed, static_cast<unsigned>(seed));
    const Run run = fly(engine, scene, h, 1);
    cell = seed == 1 ? judged(run, run.start) : worse(cell, judged(run, run.start));
  }
  return cell;
}

MapCell fate_of_chain(const EngineOption& engine, double h, double ratio, double seconds) {
  EngineScene scene;
  scene.ground = false;
  ChainShape shape;
  shape.links = 5;
  shape.length = 0.4;
  shape.last_mass = ratio;
  scene.figures.push_back(resting(chain(shape)));
  Figure& figure = scene.figures[0];
  bend(figure.skeleton, figure.jets, 0, {0, -kPi / 2, 0});
  double fall = 0;  // J, from horizontal to hanging
  for (int i = 0; i < shape.links; ++i)
    fall += 9.81 * figure.skeleton.joints[i].mass * shape.length * (i + 0.5);
  return judged(fly(engine, scene, h, seconds), fall);
}

FailureMap map_of_speeds(bool quick, const std::function<void(int, int)>& progress) {
  FailureMap map{"Free flight of a limp 37-DOF figure: time step x joint speed",
                 "rms joint speed at the start, rad/s", "in 1 s, over the kinetic energy at the start"};
  map.columns = {1, 3, 10, 30, 100};
  map.engines = all_options();
  fill(map, progress, [&](const EngineOption& engine, double h, double speed) {
    return fate_of_flight(engine, h, speed, quick ? 1 : 3);
  });
  return map;
}

FailureMap map_of_masses(bool quick, const std::function<void(int, int)>& progress) {
  FailureMap map{"Five hinged links swinging from horizontal: time step x mass ratio",
                 "mass of the last link over the first", "in 2 s, over the most that gravity can give"};
  map.columns = {1e-6, 1e-3, 1, 1e3, 1e6};
  map.engines = all_options();
  fill(map, progress, [&](const EngineOption& engine, double h, double ratio) {
    return fate_of_chain(engine, h, ratio, quick ? 1 : 2);
  });
  return map;
}

std::string map_csv(const FailureMap& map) {
  static constexpr const char* names[] = {"faithful", "loses", "gains", "explodes", "cannot"};
  std::string csv = "engine,option,h_s,column,fate,energy\n";
  char line[160];
  for (std::size_t e = 0; e < map.engines.size(); ++e)
    for (std::size_t s = 0; s < map.steps.size(); ++s)
      for (std::size_t c = 0; c < map.columns.size(); ++c) {
        const MapCell& cell = map.cell(e, s, c);
        std::snprintf(line, sizeof line, "%s,%s,%.9g,%.9g,%s,%.4g\n", map.engines[e].engine.c_str(),
                      map.engines[e].option.c_str(), map.steps[s], map.columns[c],
                      names[static_cast<int>(cell.fate)], cell.energy);
        csv += line;
      }
  return csv;
}

}  // namespace sinew::study
