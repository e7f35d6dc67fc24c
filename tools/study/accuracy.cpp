#include "study/accuracy.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <map>

#include "study/bodies.h"

namespace sinew::study {
namespace {

constexpr double kFrame = 1.0 / 60;     // s
constexpr double kSample = 1.0 / 30;    // s, between compared poses; every step of the sweep divides it
constexpr double kFinest = 1.0 / 7680;  // s, of converged runs
constexpr double kAtRest = 6;           // s after which a scene that settles has settled

/// Poses of all figures at multiples of kSample.
using Track = std::vector<std::vector<std::vector<Transform<double>>>>;

struct Trip {
  bool survived = false;
  std::string refusal;
  Track track;
  double seconds = 0;  ///< spent in steps
  double energy = 0;   ///< change over the largest kinetic energy met
  double passes = 0;
};

Trip travel(const AccuracyScene& s, const EngineOption& with, double h, const Accuracy& accuracy,
            bool observe) {
  Trip trip;
  const std::unique_ptr<Engine> engine = with.make(s.scene, h, accuracy);
  trip.refusal = engine->refusal();
  if (!trip.refusal.empty()) return trip;
  const int steps = static_cast<int>(std::lround(s.seconds / h)),
            every = static_cast<int>(std::lround(kSample / h));
  const double start = engine->energy();
  double kinetic = 0;
  for (const Figure& f : s.scene.figures)
    kinetic += energy_of(f.skeleton, f.jets, Vec3<double>(0, 0, 0)).kinetic;
  for (int n = 0; n < steps; ++n) {
    if (s.drive) s.drive(*engine, n * h, h);
    const auto begin = std::chrono::steady_clock::now();
    const bool alive = engine->step();
    trip.seconds += std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    if (!alive) return trip;
    const bool compared = s.settles ? n + 1 == steps : (n + 1) % every == 0;
    if (!observe || !compared) continue;
    trip.track.emplace_back();
    for (std::size_t f = 0; f < s.scene.figures.size(); ++f)
      trip.track.back().push_back(engine->pose(static_cast<int>(f)));
  }
  trip.energy = kinetic > 0 ? (engine->energy() - start) / kinetic : 0;
  trip.passes = engine->passes();
  trip.survived = true;
  return trip;
}

/// Largest rms displacement of all mass over the poses, m.
double apart(const AccuracyScene& s, const Track& a, const Track& b) {
  double most = 0;
  for (std::size_t n = 0; n < std::min(a.size(), b.size()); ++n) {
    double sum = 0, mass = 0;
    for (std::size_t f = 0; f < s.scene.figures.size(); ++f) {
      const Skeleton& skeleton = s.scene.figures[f].skeleton;
      sum += skeleton.total_mass() * std::pow(displacement(skeleton, a[n][f], b[n][f]), 2);
      mass += skeleton.total_mass();
    }
    most = std::max(most, std::sqrt(sum / mass));
  }
  return most;
}

Accuracy tight() {
  Accuracy a;
  a.tolerance = 1e-9;
  return a;
}

/// What is swept beside the step, on our default scheme at 1/60 s.
std::vector<std::pair<std::string, Accuracy>> settings() {
  std::vector<std::pair<std::string, Accuracy>> out;
  for (const double tolerance : {1e-3, 3e-4, 1e-4, 3e-6})
    out.emplace_back("tolerance", Accuracy{}).second.tolerance = tolerance;
  for (const int substeps : {2, 4}) out.emplace_back("substeps", Accuracy{}).second.substeps = substeps;
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
  /// Converged: our bdf2 in double, a peer's last option (its most accurate), at the finest step.
  const Track& reference(const std::string& engine) {
    const auto found = references_.find(engine);
    if (found != references_.end()) return found->second;
    EngineOption best = sinew_options()[3];
    for (const EngineOption& peer : peer_options())
      if (peer.engine == engine) best = peer;
    if (!scene_.settles)
      return references_[engine] = travel(scene_, best, quick_ ? 2 * kFinest : kFinest, tight(), true).track;
    AccuracyScene resting = scene_;
    resting.seconds = kAtRest;
    return references_[engine] = travel(resting, best, 1.0 / 240, tight(), true).track;
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
    p.energy = trip.energy;
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
    for (const EngineOption& option : scene_.settles ? std::vector<EngineOption>() : sinew_options()) {
      if (option.option.find("double") == std::string::npos) continue;
      std::vector<AccuracyPoint> fine;
      for (const double h : {1.0 / 240, 1.0 / 480, 1.0 / 960}) {
        AccuracyPoint& p = fine.emplace_back();
        p.h = h;
        const Trip trip = travel(scene_, option, h, tight(), true);
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

double displacement(const Skeleton& skeleton, const std::vector<Transform<double>>& a,
                    const std::vector<Transform<double>>& b) {
  double sum = 0;
  for (int i = 0; i < skeleton.body_count; ++i) {
    const Joint& joint = skeleton.joints[i];
    const Mat3<double> second = 0.5 * joint.inertia.trace() * Mat3<double>::Identity() - joint.inertia;
    const Mat3<double> turned = a[i].rotation.toRotationMatrix() - b[i].rotation.toRotationMatrix();
    sum += joint.mass * (a[i] * joint.center_of_mass - b[i] * joint.center_of_mass).squaredNorm() +
           (turned * second * turned.transpose()).trace();
  }
  return std::sqrt(std::max(0.0, sum) / skeleton.total_mass());
}

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
