#include "study/ensembles.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "scene/humanoid.h"
#include "study/bodies.h"
#include "study/on_all_processors.h"

namespace sinew::study {
namespace {

using Pose = std::vector<Transform<double>>;

constexpr double kSeconds = 1.5;
constexpr double kInstants[] = {0.5, 0.75, 1, 1.5};  // s, of the table

EngineScene fall(unsigned seed) {
  EngineScene scene;
  Figure figure = resting(humanoid());
  figure.jets[0].translation.z() += 0.3;
  randomise_speeds(figure.skeleton, figure.jets, 3, seed);
  scene.figures.push_back(figure);
  return scene;
}

EngineScene tumbling_fall(unsigned seed) {
  EngineScene scene;
  Figure figure = resting(humanoid());
  figure.jets[0].translation.z() += 0.8;
  randomise_speeds(figure.skeleton, figure.jets, 0.5, seed);
  const double around = 0.7 * seed;  // rad: another axis for every seed
  figure.jets[0].omega += 10 * Vec3<double>(std::cos(around), std::sin(around), 0.3).normalized();
  scene.figures.push_back(figure);
  return scene;
}

/// Poses at multiples of 1/hz s up to `count`; fewer where the engine gives up. Steps of 1/finest s.
std::vector<Pose> poses(const EngineScene& scene, const EngineOption& with, double hz, double finest,
                        int count, const Accuracy& accuracy) {
  const std::unique_ptr<Engine> engine = with.make(scene, 1 / finest, accuracy);
  std::vector<Pose> track;
  if (!engine->refusal().empty()) return track;
  track.push_back(engine->pose(0));
  const int every = static_cast<int>(std::lround(finest / hz));
  for (int n = 1; n <= count; ++n) {
    for (int k = 0; k < every; ++k)
      if (!engine->step()) return track;
    track.push_back(engine->pose(0));
  }
  return track;
}

/// At every pose but the first and the last; empty where there are not `count` steps.
std::vector<double> energies(const Skeleton& skeleton, const std::vector<Pose>& track, double hz, int count) {
  std::vector<double> out;
  if (static_cast<int>(track.size()) <= count) return out;
  for (std::size_t n = 1; n + 1 < track.size(); ++n)
    out.push_back(kinetic_energy(skeleton, track[n - 1], track[n + 1], 2 / hz));
  const bool finite = std::all_of(out.begin(), out.end(), [](double e) { return std::isfinite(e); });
  return finite ? out : std::vector<double>{};
}

EnergyCurve curve_of(const std::vector<std::vector<double>>& runs) {
  EnergyCurve curve;
  if (runs.empty()) return curve;
  const auto count = double(runs.size());
  for (std::size_t n = 0; n < runs[0].size(); ++n) {
    double sum = 0, squares = 0;
    for (const std::vector<double>& run : runs) sum += run[n];
    for (const std::vector<double>& run : runs) squares += std::pow(run[n] - sum / count, 2);
    curve.mean.push_back(sum / count);
    curve.deviation.push_back(std::sqrt(squares / std::max(1.0, count - 1)));
  }
  return curve;
}

/// "bdf2 float": the last word where it is a scalar.
std::pair<std::string, std::string> scheme_and_scalar(const std::string& option) {
  for (const char* scalar : {"float", "double"}) {
    const std::string ending = std::string(" ") + scalar;
    if (option.ends_with(ending)) return {option.substr(0, option.size() - ending.size()), scalar};
  }
  return {option, "double"};
}

}  // namespace

const std::vector<EnsembleScene>& ensemble_scenes() {
  static const std::vector<EnsembleScene> scenes{
      {"fall", "Limp figures fall, joints at 3 rad/s", fall},
      {"tumbling_fall", "Limp figures fall, tumbling at 10 rad/s", tumbling_fall}};
  return scenes;
}

std::size_t Ensemble::sample(double time) const {
  const auto next = std::lower_bound(t.begin(), t.end(), time - 0.5 / hz);
  return static_cast<std::size_t>(std::min(next, t.end() - 1) - t.begin());
}

double Ensemble::share(double time) const {
  if (t.empty()) return 0;
  const std::size_t n = sample(time);
  return energy.mean[n] / truth.mean[n];
}

double Ensemble::uncertainty(double time) const {
  if (t.empty()) return 0;
  const std::size_t n = sample(time);
  const auto squared = [&](const EnergyCurve& c) { return std::pow(c.deviation[n] / c.mean[n], 2); };
  return share(time) * std::sqrt((squared(energy) + squared(truth)) / seeds);
}

double kinetic_energy(const Skeleton& skeleton, const Pose& before, const Pose& after, double span) {
  double sum = 0;
  for (int i = 0; i < skeleton.body_count; ++i) {
    const Joint& joint = skeleton.joints[i];
    const Vec3<double> velocity = (after[i] * joint.center_of_mass - before[i] * joint.center_of_mass) / span;
    const Quat<double> turn = before[i].rotation.conjugate() * after[i].rotation;
    const Vec3<double> spin = rotation_log<double>(turn) / span;  // body axes
    sum += 0.5 * (joint.mass * velocity.squaredNorm() + spin.dot(joint.inertia * spin));
  }
  return sum;
}

TrueFalls true_falls(const EnsembleScene& scene, const EngineOption& with, double finest, int seeds,
                     double seconds) {
  TrueFalls out;
  out.seconds = seconds;
  out.poses.resize(seeds);
  const int count = static_cast<int>(std::lround(seconds * kTrueHz)) + 2;  // a pose more than 30 Hz asks for
  Accuracy tight;
  tight.tolerance = 1e-7;
  on_all_processors(seeds, [&](int n) {
    out.poses[n] = poses(scene.start(static_cast<unsigned>(n) + 1), with, kTrueHz, finest, count, tight);
  });
  return out;
}

Ensemble run_ensemble(const EnsembleScene& scene, const EngineOption& with, double hz,
                      const TrueFalls& truth) {
  const int count = static_cast<int>(std::lround(truth.seconds * hz)) + 1;
  const int seeds = static_cast<int>(truth.poses.size());
  const auto every = static_cast<std::size_t>(std::lround(kTrueHz / hz));
  std::vector<std::vector<double>> coarse(seeds), fine(seeds);
  on_all_processors(seeds, [&](int n) {
    const EngineScene start = scene.start(static_cast<unsigned>(n) + 1);
    const Skeleton& skeleton = start.figures[0].skeleton;
    coarse[n] = energies(skeleton, poses(start, with, hz, hz, count, {}), hz, count);
    std::vector<Pose> thinned;
    for (std::size_t k = 0; k < truth.poses[n].size() && static_cast<int>(thinned.size()) <= count;
         k += every)
      thinned.push_back(truth.poses[n][k]);
    fine[n] = energies(skeleton, thinned, hz, count);
  });
  Ensemble out;
  out.engine = with.engine;
  out.option = with.option;
  out.scene = scene.name;
  out.hz = hz;
  std::vector<std::vector<double>> kept, true_ones;
  for (int n = 0; n < seeds; ++n) {
    if (coarse[n].empty() || fine[n].empty()) continue;
    kept.push_back(coarse[n]);
    true_ones.push_back(fine[n]);
  }
  out.seeds = static_cast<int>(kept.size());
  out.lost = seeds - out.seeds;
  out.energy = curve_of(kept);
  out.truth = curve_of(true_ones);
  for (std::size_t n = 0; n < out.energy.mean.size(); ++n) out.t.push_back(double(n + 1) / hz);
  return out;
}

std::vector<Ensemble> run_ensembles(bool quick, const std::function<void(int, int)>& progress, int seeds) {
  const double finest = quick ? 1920 : 3840;
  if (seeds == 0) seeds = quick ? 96 : 384;
  std::vector<EngineOption> ours, peers;
  for (const EngineOption& option : sinew_options())
    if (!option.option.starts_with("momentum")) ours.push_back(option);  // no energy, and it explodes
  for (const EngineOption& option : peer_options())
    if (option.step == 0) peers.push_back(option);
  std::vector<Ensemble> all;
  const int total = static_cast<int>(2 * ensemble_scenes().size() * (ours.size() + peers.size()));
  for (const EnsembleScene& scene : ensemble_scenes()) {
    const auto run = [&](const EngineOption& with, const TrueFalls& truth) {
      for (const double hz : {60.0, 30.0}) {
        all.push_back(run_ensemble(scene, with, hz, truth));
        if (progress) progress(static_cast<int>(all.size()), total);
      }
    };
    const TrueFalls truth = true_falls(scene, most_accurate_option(), finest, seeds, kSeconds);
    for (const EngineOption& option : ours) run(option, truth);
    for (const EngineOption& option : peers) run(option, true_falls(scene, option, finest, seeds, kSeconds));
  }
  return all;
}

nlohmann::json ensembles_json(const std::vector<Ensemble>& all) {
  nlohmann::json list = nlohmann::json::array();
  for (const Ensemble& e : all) {
    const auto [scheme, scalar] = scheme_and_scalar(e.option);
    list.push_back({{"engine", e.engine == "Sinew" ? "sinew" : e.engine},
                    {"scene", e.scene},
                    {"hz", e.hz},
                    {"scheme", scheme},
                    {"scalar", scalar},
                    {"seeds", e.seeds},
                    {"lost", e.lost},
                    {"t", e.t},
                    {"energy", e.energy.mean},
                    {"energy_deviation", e.energy.deviation},
                    {"truth", e.truth.mean},
                    {"truth_deviation", e.truth.deviation}});
  }
  return {{"ensembles", list}};
}

std::string ensembles_table(const std::vector<Ensemble>& all) {
  std::string text = fmt::format("{:<16}{:<24}{:>4} {:>6}", "scene", "engine", "Hz", "seeds") +
                     "   share of the true energy after\n" + fmt::format("{:52}", "");
  for (const double at : kInstants) text += fmt::format("{:>9.2f} s", at);
  text += '\n';
  for (const Ensemble& e : all) {
    text += fmt::format("{:<16}{:<24}{:>4.0f} {:>6}", e.scene, e.engine + " " + e.option, e.hz, e.seeds);
    for (const double at : kInstants)
      text += fmt::format("{:>5.0f} ±{:>2.0f} %", 100 * e.share(at), 100 * e.uncertainty(at));
    text += '\n';
  }
  return text;
}

}  // namespace sinew::study
