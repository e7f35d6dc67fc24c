#include <cmath>

#include "sinew/effects/continuous_detection.h"
#include "study/bodies.h"
#include "study/engine.h"
#include "study/schemes/schemes.h"

namespace sinew::study {
namespace {

template <class T>
std::vector<JointJet<T>> cast(const std::vector<JointJet<double>>& jets) {
  std::vector<JointJet<T>> out(jets.size());
  for (std::size_t i = 0; i < jets.size(); ++i) {
    out[i].rotation = jets[i].rotation.cast<T>();
    out[i].omega = jets[i].omega.cast<T>();
    out[i].alpha = jets[i].alpha.cast<T>();
    out[i].translation = jets[i].translation.cast<T>();
    out[i].velocity = jets[i].velocity.cast<T>();
    out[i].acceleration = jets[i].acceleration.cast<T>();
  }
  return out;
}

template <class T>
class SinewEngine : public Engine {
 public:
  SinewEngine(const EngineScene& scene, double h, const Accuracy& accuracy, Compared scheme)
      : h_(h), world_(settings(scene, accuracy)) {
    if (const Status status = declare_scheme(scheme, world_); !status) refusal_ = status.reason;
    if (const Status status = world_.template declare<ContinuousDetection>(); !status)
      refusal_ = status.reason;
    for (const Figure& figure : scene.figures) {
      CharacterSettings how = passive();
      if (figure.driven) how = CharacterSettings{};
      Status status;
      const int index = world_.add_character(figure.skeleton, how, status);
      if (index >= 0) status = world_.character(index).set_target(cast<T>(figure.jets));
      if (!status) {
        refusal_ = status.reason;
        return;
      }
      (void)world_.character(index).reset();
    }
    for (const Figure& figure : scene.figures) {
      const Energy e = energy_of<double>(figure.skeleton, figure.jets, scene.gravity);
      energy_ += e.kinetic + e.potential;
    }
  }

  const std::string& refusal() const override { return refusal_; }
  bool step() override {
    if (!world_.step(T(h_))) return false;
    energy_ = 0;
    for (int c = 0; c < world_.character_count(); ++c) {
      const CharacterReport& r = character(c).report();
      energy_ += r.kinetic_energy + r.potential_energy + r.elastic_energy;
      passes_ += r.outer_passes;
      solves_ += r.unknown_dofs > 0;
    }
    return true;
  }
  void aim(int figure, const std::vector<JointJet<double>>& jets) override {
    (void)character(figure).set_target(cast<T>(jets));
  }
  void push(int figure, int joint, const Vec3<double>& impulse) override {
    const Character<T> c = character(figure);
    const Vec3<T> at = c.model()[joint] * c.skeleton().joints[joint].center_of_mass.template cast<T>();
    (void)character(figure).apply_force(joint, at, impulse.cast<T>() / T(h_));
  }
  double energy() const override { return energy_; }
  std::vector<Transform<double>> pose(int figure) const override {
    std::vector<Transform<double>> out;
    for (const Transform<T>& joint : character(figure).model()) out.push_back(joint.template cast<double>());
    return out;
  }
  bool angular_momentum(Vec3<double>& out) const override {
    out = character(0).report().angular_momentum;
    return true;
  }
  double passes() const override { return solves_ ? double(passes_) / double(solves_) : 0; }
  double estimated_error() const override {
    double sum = 0, mass = 0;
    for (int c = 0; c < world_.character_count(); ++c) {
      const double m = character(c).skeleton().total_mass();
      sum += m * std::pow(character(c).report().estimated_error, 2);
      mass += m;
    }
    return std::sqrt(sum / mass);
  }
  bool take_state(const Engine& from) override {
    const auto* other = dynamic_cast<const SinewEngine*>(&from);
    if (!other) return false;
    snapshot_.resize(other->world_.snapshot_capacity());
    snapshot_.resize(other->world_.save(snapshot_));
    return bool(world_.restore(snapshot_));
  }

 private:
  static WorldSettings settings(const EngineScene& scene, const Accuracy& accuracy) {
    WorldSettings s;
    s.accuracy = accuracy;
    s.gravity = scene.gravity;
    s.ground = scene.ground;
    return s;
  }
  Character<T> character(int index) const { return world_.character(index); }

  double h_;
  mutable World<T> world_;  // its handles give access to the state, also for reading
  std::string refusal_;
  double energy_ = 0;
  long passes_ = 0, solves_ = 0;
  std::vector<std::byte> snapshot_;
};

template <class T, Compared scheme>
std::unique_ptr<Engine> make(const EngineScene& scene, double h, const Accuracy& accuracy) {
  return std::make_unique<SinewEngine<T>>(scene, h, accuracy, scheme);
}

}  // namespace

Figure resting(const Skeleton& skeleton) {
  return {skeleton, rest_jets<double>(skeleton), false};
}

std::vector<EngineOption> sinew_options() {
  return {{"Sinew", "bossak float", make<float, Compared::kBossak>},
          {"Sinew", "bdf2 float", make<float, Compared::kBdf2>},
          {"Sinew", "bdf1 float", make<float, Compared::kBdf1>},
          {"Sinew", "momentum float", make<float, Compared::kMomentum>},
          {"Sinew", "bdf2 double", make<double, Compared::kBdf2>},
          {"Sinew", "bdf1 double", make<double, Compared::kBdf1>},
          {"Sinew", "bossak double", make<double, Compared::kBossak>},
          {"Sinew", "momentum double", make<double, Compared::kMomentum>}};
}

EngineOption most_accurate_option() {
  return {"Sinew", "bossak double", make<double, Compared::kBossak>};
}

std::vector<EngineOption> peer_options() {
  std::vector<EngineOption> all;
#ifdef SINEW_PEERS
  for (const auto& of :
       {mujoco_options(), bullet_options(), dart_options(), ode_options(), simbody_options()})
    all.insert(all.end(), of.begin(), of.end());
#endif
  return all;
}

std::vector<EngineOption> controlled_options() {
#ifdef SINEW_PEERS
  return simbody_controlled_options();
#else
  return {};
#endif
}

}  // namespace sinew::study
