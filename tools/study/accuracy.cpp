#include "study/accuracy.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "study/accuracy_store.h"
#include "study/accuracy_trip.h"

namespace sinew::study {
namespace {

constexpr double kFrame = 1.0 / 60;  // s
constexpr double kLost = 10;         // m off: what flies so far did not survive

/// What is swept beside the step, on our default scheme at 1/60 s.
std::vector<std::pair<std::string, Accuracy>> settings() {
  std::vector<std::pair<std::string, Accuracy>> out;
  for (const double tolerance : {1e-3, 3e-4, 1e-4, 3e-6})
    out.emplace_back("tolerance", Accuracy{}).second.tolerance = tolerance;
  for (const int substeps : {2, 4}) out.emplace_back("substeps", Accuracy{}).second.substeps = substeps;
  for (const double sink : {1e-4, 2e-3}) out.emplace_back("sink depth", Accuracy{}).second.sink_depth = sink;
  for (const double speed : {1e-3, 2e-2})
    out.emplace_back("stick speed", Accuracy{}).second.stick_speed = speed;
  for (const int cap : {1, 2, 4, 8}) {
    Accuracy& a = out.emplace_back("iteration cap", Accuracy{}).second;
    a.max_iterations = cap;
    a.max_splits = 0;  // parts of a step would have the cap anew
    a.max_rotation = 0;
  }
  return out;
}

class Sweep {
 public:
  Sweep(const AccuracyScene& scene, bool quick, ResultStore& store, const std::function<void()>& done)
      : scene_(scene), runs_(quick ? 5 : 21), quick_(quick), store_(store), done_(done) {}

  AccuracyResult run() {
    AccuracyResult result{scene_, {}, {}, -1, -1, {}};
    const double last = quick_ ? 1.0 / 240 : 1.0 / 960;
    for (const EngineOption& option : options_of(scene_)) {
      if (option.step > 0) result.points.push_back(point(option, "policy", option.step, Accuracy{}));
      for (double h = 1.0 / 30; option.step <= 0 && h > 0.99 * last; h /= 2)
        result.points.push_back(point(option, "step", h, Accuracy{}));
      done_();
    }
    if (scene_.options.empty()) {
      for (const auto& [what, accuracy] : settings())
        result.points.push_back(point(sinew_options()[0], what, kFrame, accuracy));
      slopes(result);
      estimates(result);
    }
    if (scene_.options.empty()) add_controlled(result);
    count_cheapest(result);
    compare_references(result);
    done_();
    mark_pareto(result.points);
    return result;
  }

  static std::vector<EngineOption> options_of(const AccuracyScene& scene) {
    if (!scene.options.empty()) return scene.options;
    std::vector<EngineOption> all = sinew_options();
    for (const EngineOption& peer : peer_options()) all.push_back(peer);
    return all;
  }
  static int parts(const AccuracyScene& scene) { return static_cast<int>(options_of(scene).size()) + 1; }

 private:
  std::string key(const std::string& what) const {
    return scene_.name + "|" + what + "|" + std::to_string(runs_);
  }

  /// Of our scheme in double, of a peer's last option (its most accurate).
  const Track& reference(const std::string& engine) {
    const auto found = references_.find(engine);
    if (found != references_.end()) return found->second;
    EngineOption best = most_accurate_option();
    for (const auto& peers : {peer_options(), controlled_options()})
      for (const EngineOption& peer : peers)
        if (peer.engine == engine) best = peer;
    return references_[engine] = converged(scene_, best, quick_);
  }

  AccuracyPoint point(const EngineOption& option, const std::string& varied, double h,
                      const Accuracy& accuracy) {
    AccuracyPoint p;
    p.engine = option.engine;
    p.option = option.option;
    p.varied = varied;
    p.h = h;
    p.accuracy = accuracy;
    const std::string name = key(point_json(p).dump());
    if (const nlohmann::json* kept = store_.find(name)) return point_from(*kept);
    measure(option, p);
    store_.keep(name, point_json(p));
    return p;
  }

  void measure(const EngineOption& option, AccuracyPoint& p) {
    const Trip trip = travel(scene_, option, p.h, p.accuracy, true);  // also warms up
    p.survived = trip.survived;
    p.refusal = trip.refusal;
    if (!p.survived) return;
    p.error = apart(scene_, trip.track, reference(option.engine));
    p.survived = p.error < kLost;  // false for what is no number, too
    if (!p.survived) return;
    p.degrees = degrees_apart(scene_, trip.track, reference(option.engine));
    p.energy = trip.energy;
    p.momentum = trip.momentum;
    p.passes = trip.passes;
    const bool counted = p.varied == "step" && std::abs(p.h - kFrame) < 1e-9 &&
                         (!quick_ || option.label() == "Sinew bossak float");
    if (counted && can_count_instructions()) p.instructions = instructions_of(scene_, option, p.h);
    time(option, p);
  }

  void time(const EngineOption& option, AccuracyPoint& p) const {
    std::vector<double> times;
    std::vector<std::vector<double>> frames_of_runs;
    const int runs = p.varied == "accuracy" ? std::min(runs_, 3) : runs_;  // some take a second each
    for (int n = 0; n < runs; ++n) {
      const Trip trip = travel(scene_, option, p.h, p.accuracy, false);
      times.push_back(trip.seconds);
      frames_of_runs.push_back(trip.frames);
    }
    std::sort(times.begin(), times.end());
    const double frames = scene_.seconds / kFrame;
    p.us = 1e6 * times[times.size() / 2] / frames;
    p.us_low = 1e6 * times[times.size() / 4] / frames;
    p.us_high = 1e6 * times[times.size() * 3 / 4] / frames;
    const FrameCosts costs = frame_costs(frames_of_runs);
    p.us_p99 = 1e6 * costs.p99;
    p.us_worst = 1e6 * costs.worst;
  }

  /// Orders of the step sweeps, from runs whose solver tolerance does not show.
  void slopes(AccuracyResult& result) {
    for (const EngineOption& option : scene_.settles ? std::vector<EngineOption>() : sinew_options()) {
      if (option.option.find("double") == std::string::npos) continue;
      const bool smooth = !scene_.contacts && !scene_.drive;
      const bool first = option.option.starts_with("bdf1") || option.option.starts_with("momentum");
      Slope slope{option.engine, option.option, 0, !smooth ? 0.0 : first ? 1.0 : 2.0};
      const std::string name = key("slope " + option.option);
      if (const nlohmann::json* kept = store_.find(name))
        slope.found = kept->get<double>();
      else
        store_.keep(name, slope.found = slope_of(option));
      if (slope.found == 0) slope.expected = 0;
      result.slopes.push_back(slope);
    }
  }
  double slope_of(const EngineOption& option) {
    Accuracy solved;
    solved.tolerance = 1e-9;  // m
    std::vector<AccuracyPoint> fine;
    for (const double h : {1.0 / 240, 1.0 / 480, 1.0 / 960}) {
      AccuracyPoint& p = fine.emplace_back();
      p.h = h;
      const Trip trip = travel(scene_, option, h, solved, true);
      p.survived = trip.survived;
      if (p.survived) p.error = apart(scene_, trip.track, reference("Sinew"));
    }
    const bool exact = std::all_of(fine.begin(), fine.end(),
                                   [](const AccuracyPoint& p) { return p.survived && p.error < kExact; });
    return exact ? 0 : order_of(fine);
  }

  void estimates(AccuracyResult& result) {
    const std::string name = key("estimates");
    if (!store_.find(name)) {
      nlohmann::json frames = nlohmann::json::array();
      for (const EstimatedFrame& f : estimated_frames(scene_, most_accurate_option(), kFrame))
        frames.push_back({f.time, f.estimated, f.truth});
      store_.keep(name, frames);
    }
    for (const nlohmann::json& f : *store_.find(name)) result.estimates.push_back({f[0], f[1], f[2]});
  }

  /// Peers that choose their steps, over accuracies; their AccuracyPoint::h is 0.
  void add_controlled(AccuracyResult& result) {
    const std::vector<double> all = {1e-2, 1e-3, 1e-4, 1e-6}, few = {1e-2, 1e-4};
    for (const EngineOption& option : controlled_options())
      for (const double tolerance : quick_ ? few : all) {
        Accuracy accuracy;
        accuracy.tolerance = tolerance;
        AccuracyPoint& p = result.points.emplace_back(point(option, "accuracy", kFrame, accuracy));
        p.varied = "step";
        p.h = 0;
      }
  }

  /// Instructions of what the first screen of the report shows.
  void count_cheapest(AccuracyResult& result) {
    const bool shown = std::any_of(std::begin(kSummaryScenes), std::end(kSummaryScenes),
                                   [&](const char* name) { return scene_.name == name; });
    for (const double bound : kSummaryErrors) {
      const std::vector<AccuracyPoint> offered = at_60_hz(result.points);
      const AccuracyPoint* best = cheapest(offered, "Sinew", bound);
      if (!shown || !best || best->instructions >= 0 || !can_count_instructions()) continue;
      if (best->varied != "step" && best->varied != "tolerance" && best->varied != "substeps") continue;
      const auto it = std::find_if(result.points.begin(), result.points.end(), [&](const AccuracyPoint& p) {
        return point_json(p) == point_json(*best);
      });
      for (const EngineOption& option : sinew_options())
        if (option.label() == best->label()) it->instructions = counted(option, *it);
    }
  }

  double counted(const EngineOption& option, const AccuracyPoint& p) {
    const std::string name =
        key("instructions " + option.option + p.varied + std::to_string(p.h) + "," +
            std::to_string(1e9 * p.accuracy.tolerance) + "," + std::to_string(p.accuracy.substeps));
    if (!store_.find(name)) store_.keep(name, instructions_of(scene_, option, p.h, p.accuracy));
    return store_.find(name)->get<double>();
  }

  void compare_references(AccuracyResult& result) {
    const std::string name = key("references");
    if (!store_.find(name)) {
      const std::vector<EngineOption> peers = peer_options();
      const bool smooth = !scene_.contacts && !scene_.drive;
      double between = -1, uncertain = -1;
      if (smooth && !peers.empty()) between = apart(scene_, reference("Sinew"), reference(peers[0].engine));
      if (!scene_.settles)
        uncertain = apart(scene_, reference("Sinew"),
                          travel(scene_, most_accurate_option(), quick_ ? 1.0 / 1920 : 1.0 / 3840,
                                 {.tolerance = 1e-9}, true)
                              .track);
      store_.keep(name, {between, uncertain});
    }
    result.references_apart = (*store_.find(name))[0];
    result.uncertainty = (*store_.find(name))[1];
  }

  AccuracyScene scene_;
  int runs_;
  bool quick_;
  ResultStore& store_;
  std::function<void()> done_;
  std::map<std::string, Track> references_;
};

/// The stiff driver has no figures to step through: its points come from the reference family.
AccuracyResult driver_result(bool quick, ResultStore& store) {
  AccuracyResult result{stiff_driver(), {}, {}, -1, -1, {}};
  const int runs = quick ? 3 : 21;
  const std::string name = "driver|" + std::to_string(runs);
  if (!store.find(name)) {
    nlohmann::json points = nlohmann::json::array();
    for (const AccuracyPoint& p : driver_points(runs)) points.push_back(point_json(p));
    store.keep(name, points);
  }
  for (const nlohmann::json& p : *store.find(name)) result.points.push_back(point_from(p));
  mark_pareto(result.points);
  return result;
}

}  // namespace

double order_of(const std::vector<AccuracyPoint>& points) {
  double n = 0, x = 0, y = 0, xx = 0, xy = 0;
  for (const AccuracyPoint& p : points) {
    if (!p.survived || p.error <= 0) continue;
    const double lx = std::log(p.h), ly = std::log(p.error);
    n += 1, x += lx, y += ly, xx += lx * lx, xy += lx * ly;
  }
  return n < 2 ? 0 : (n * xy - x * y) / (n * xx - x * x);
}

void mark_pareto(std::vector<AccuracyPoint>& points) {
  for (AccuracyPoint& p : points)
    p.pareto =
        p.survived && std::none_of(points.begin(), points.end(), [&](const AccuracyPoint& o) {
          return o.survived && o.us <= p.us && o.error <= p.error && (o.us < p.us || o.error < p.error);
        });
}

bool for_comparison(const AccuracyPoint& p) {
  if (p.engine != "Sinew" || p.option.starts_with(kDefaultScheme)) return false;
  const std::vector<EngineOption> all = sinew_options();
  return std::any_of(all.begin(), all.end(), [&](const EngineOption& o) { return o.option == p.option; });
}

std::vector<AccuracyPoint> at_60_hz(const std::vector<AccuracyPoint>& points) {
  std::vector<AccuracyPoint> out;
  const auto another_model = [](const AccuracyPoint& p) {
    return p.varied == "sink depth" || p.varied == "stick speed" || p.varied == "iteration cap";
  };
  for (const AccuracyPoint& p : points)
    if (p.h < 1.001 * kFrame && !for_comparison(p) && !another_model(p)) out.push_back(p);
  return out;
}

const AccuracyPoint* cheapest(const std::vector<AccuracyPoint>& points, const std::string& engine,
                              double bound, double AccuracyPoint::*error) {
  const AccuracyPoint* best = nullptr;
  for (const AccuracyPoint& p : points)
    if (p.survived && p.engine == engine && p.*error <= bound && (!best || p.us < best->us)) best = &p;
  return best;
}

std::vector<AccuracyResult> run_accuracy(const AccuracyOptions& options,
                                         const std::function<void(int, int)>& progress) {
  std::vector<AccuracyScene> scenes = accuracy_scenes();
  if (!options.only.empty())
    std::erase_if(scenes, [&](const AccuracyScene& s) { return s.name != options.only; });
  std::erase_if(scenes, [](const AccuracyScene& s) { return s.scene.figures.empty(); });
  int total = 0, done = 0;
  for (const AccuracyScene& scene : scenes) total += Sweep::parts(scene);
  const bool driver = options.only.empty() || options.only == stiff_driver().name;
  total += driver;
  ResultStore store(options.store, running_build());
  std::vector<AccuracyResult> results;
  for (const AccuracyScene& scene : scenes)
    results.push_back(Sweep(scene, options.quick, store, [&] {
                        if (progress) progress(++done, total);
                      }).run());
  if (driver) {
    results.push_back(driver_result(options.quick, store));
    if (progress) progress(++done, total);
    if (results.back().points.empty()) results.pop_back();
  }
  return results;
}

}  // namespace sinew::study
