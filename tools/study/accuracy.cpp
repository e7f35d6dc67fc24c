#include "study/accuracy.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "study/accuracy_trip.h"

namespace sinew::study {
namespace {

constexpr double kFrame = 1.0 / 60;  // s

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
    a.max_splits = 0;  // a halved step would have the cap anew
  }
  return out;
}

class Sweep {
 public:
  Sweep(const AccuracyScene& scene, bool quick) : scene_(scene), runs_(quick ? 5 : 21), quick_(quick) {}

  AccuracyResult run(const std::function<void()>& done) {
    AccuracyResult result{scene_, {}, {}, -1};
    const std::vector<EngineOption> peers = peer_options();
    std::vector<EngineOption> all = sinew_options();
    all.insert(all.end(), peers.begin(), peers.end());
    const double last = quick_ ? 1.0 / 240 : 1.0 / 960;
    for (const EngineOption& option : all) {
      for (double h = 1.0 / 30; h > 0.99 * last; h /= 2)
        result.points.push_back(point(option, "step", h, Accuracy{}));
      done();
    }
    for (const auto& [what, accuracy] : settings())
      for (const EngineOption& option : sinew_options())
        if (option.option == "bdf2 float") result.points.push_back(point(option, what, kFrame, accuracy));
    done();
    mark_pareto(result.points);
    slopes(result);
    if (!scene_.contacts && !scene_.drive && !peers.empty())
      result.references_apart = apart(scene_, reference("Sinew"), reference(peers[0].engine));
    return result;
  }

  static int parts() { return static_cast<int>(sinew_options().size() + peer_options().size()) + 1; }

 private:
  /// Of our bdf2 in double, of a peer's last option (its most accurate).
  const Track& reference(const std::string& engine) {
    const auto found = references_.find(engine);
    if (found != references_.end()) return found->second;
    EngineOption best = sinew_options()[3];
    for (const EngineOption& peer : peer_options())
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
    const Trip trip = travel(scene_, option, h, accuracy, true);  // also warms up
    p.survived = trip.survived;
    p.refusal = trip.refusal;
    if (!p.survived) return p;
    p.error = apart(scene_, trip.track, reference(option.engine));
    p.survived = std::isfinite(p.error);
    p.degrees = degrees_apart(scene_, trip.track, reference(option.engine));
    p.energy = trip.energy;
    p.momentum = trip.momentum;
    p.passes = trip.passes;
    std::vector<double> times;
    for (int n = 0; n < runs_; ++n) times.push_back(travel(scene_, option, h, accuracy, false).seconds);
    std::sort(times.begin(), times.end());
    const double frames = scene_.seconds / kFrame;
    p.us = 1e6 * times[times.size() / 2] / frames;
    p.us_low = 1e6 * times[times.size() / 4] / frames;
    p.us_high = 1e6 * times[times.size() * 3 / 4] / frames;
    return p;
  }

  /// Orders of the step sweeps, from runs whose solver tolerance does not show.
  void slopes(AccuracyResult& result) {
    Accuracy solved;
    solved.tolerance = 1e-9;  // m
    for (const EngineOption& option : scene_.settles ? std::vector<EngineOption>() : sinew_options()) {
      if (option.option.find("double") == std::string::npos) continue;
      std::vector<AccuracyPoint> fine;
      for (const double h : {1.0 / 240, 1.0 / 480, 1.0 / 960}) {
        AccuracyPoint& p = fine.emplace_back();
        p.h = h;
        const Trip trip = travel(scene_, option, h, solved, true);
        p.survived = trip.survived;
        if (p.survived) p.error = apart(scene_, trip.track, reference("Sinew"));
      }
      const bool smooth = !scene_.contacts && !scene_.drive;
      const double expected = !smooth ? 0 : option.option.starts_with("bdf2") ? 2 : 1;
      result.slopes.push_back({option.engine, option.option, order_of(fine), expected});
    }
  }

  AccuracyScene scene_;
  int runs_;
  bool quick_;
  std::map<std::string, Track> references_;
};

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

double price_of(const std::vector<AccuracyPoint>& points, const std::string& engine, double error) {
  double least = -1;
  for (const AccuracyPoint& p : points)
    if (p.survived && p.engine == engine && p.error <= error && (least < 0 || p.us < least)) least = p.us;
  return least;
}

std::vector<AccuracyResult> run_accuracy(const AccuracyOptions& options,
                                         const std::function<void(int, int)>& progress) {
  std::vector<AccuracyScene> scenes = accuracy_scenes();
  if (!options.only.empty())
    std::erase_if(scenes, [&](const AccuracyScene& s) { return s.name != options.only; });
  std::erase_if(scenes, [](const AccuracyScene& s) { return s.scene.figures.empty(); });
  const int total = static_cast<int>(scenes.size()) * Sweep::parts();
  int done = 0;
  std::vector<AccuracyResult> results;
  for (const AccuracyScene& scene : scenes)
    results.push_back(Sweep(scene, options.quick).run([&] {
      if (progress) progress(++done, total);
    }));
  return results;
}

}  // namespace sinew::study
