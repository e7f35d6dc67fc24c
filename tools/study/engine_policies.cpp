// Levels of detail of a character that follows its clip: what is left out as it goes further away.
#include <cmath>
#include <limits>

#include "sinew/crowd/crowd.h"
#include "study/engine.h"

namespace sinew::study {
namespace {

/// The animation and nothing else; pushes are not felt.
class PlaybackEngine : public Engine {
 public:
  explicit PlaybackEngine(const EngineScene& scene) : scene_(scene) {
    for (const Figure& figure : scene.figures) {
      if (!figure.driven) refusal_ = "there is nothing to play";
      poses_.emplace_back(figure.skeleton.joints.size());
      aim(static_cast<int>(poses_.size()) - 1, figure.jets);
    }
  }
  const std::string& refusal() const override { return refusal_; }
  bool step() override {
    for (std::size_t f = 0; f < poses_.size(); ++f)
      for (std::size_t i = 0; i < poses_[f].size(); ++i) {
        const Transform<double> local{jets_[f][i].rotation, jets_[f][i].translation};
        const int parent = scene_.figures[f].skeleton.joints[i].parent;
        poses_[f][i] = parent < 0 ? local : poses_[f][parent] * local;
      }
    return true;
  }
  void aim(int figure, const std::vector<JointJet<double>>& jets) override {
    jets_.resize(std::max(jets_.size(), std::size_t(figure) + 1));
    jets_[figure] = jets;
  }
  void push(int, int, const Vec3<double>&) override {}
  double energy() const override { return 0; }
  std::vector<Transform<double>> pose(int figure) const override { return poses_[figure]; }

 private:
  EngineScene scene_;
  std::string refusal_;
  std::vector<std::vector<JointJet<double>>> jets_;
  std::vector<std::vector<Transform<double>>> poses_;
};

std::unique_ptr<Engine> play(const EngineScene& scene, double, const Accuracy&) {
  return std::make_unique<PlaybackEngine>(scene);
}

/// Muscles of any strength: the residual is computed and shown, never acted on.
std::unique_ptr<Engine> show_residual(const EngineScene& scene, double h, const Accuracy& accuracy) {
  EngineScene strong = scene;
  for (Figure& figure : strong.figures)
    for (Joint& joint : figure.skeleton.joints)
      for (DofLimits& dof : joint.dofs)
        dof.torque_minus = dof.torque_plus = std::numeric_limits<double>::infinity();
  return sinew_options()[0].make(strong, h, accuracy);
}

/// The crowd's batches: the residual of many copies at once, shown and never acted on.
class BatchEngine : public Engine {
 public:
  BatchEngine(const EngineScene& scene, double h, int lanes) : h_(h) {
    Status status;
    CrowdSettings settings;
    settings.capacity = kCopies;
    settings.lanes = lanes;
    settings.gravity = scene.gravity;
    settings.ground = scene.ground;
    if (scene.figures.size() == 1) crowd_ = Crowd::create(scene.figures[0].skeleton, settings, status);
    for (int i = 0; crowd_ && i < kCopies; ++i) status = crowd_->play(i, {});
    refusal_ = crowd_ ? status.reason : "the crowd takes one figure at a time";
    if (refusal_.empty()) aim(0, scene.figures[0].jets);
  }
  const std::string& refusal() const override { return refusal_; }
  bool step() override { return bool(crowd_->step(h_)); }
  void aim(int, const std::vector<JointJet<double>>& jets) override {
    for (int i = 0; i < kCopies; ++i) {
      const std::span<JointJet<float>> to = crowd_->jets(i);
      for (std::size_t k = 0; k < to.size(); ++k) to[k] = cast(jets[k]);
    }
  }
  void push(int, int, const Vec3<double>&) override {}
  double energy() const override { return 0; }
  int copies() const override { return kCopies; }
  std::vector<Transform<double>> pose(int) const override {
    std::vector<Transform<double>> out;
    for (const Transform<float>& joint : crowd_->model(0)) out.push_back(joint.cast<double>());
    return out;
  }

 private:
  static constexpr int kCopies = 64;  ///< whole batches of either width
  static JointJet<float> cast(const JointJet<double>& jet) {
    return {jet.rotation.cast<float>(),    jet.omega.cast<float>(),    jet.alpha.cast<float>(),
            jet.translation.cast<float>(), jet.velocity.cast<float>(), jet.acceleration.cast<float>()};
  }

  double h_;
  std::string refusal_;
  std::unique_ptr<Crowd> crowd_;
};

template <int lanes>
std::unique_ptr<Engine> batch(const EngineScene& scene, double h, const Accuracy&) {
  return std::make_unique<BatchEngine>(scene, h, lanes);
}

}  // namespace

std::vector<EngineOption> policy_options() {
  const auto full = sinew_options()[0].make;
  return {{"Sinew", "every frame", full, 1.0 / 60},
          {"Sinew", "every 2nd frame", full, 1.0 / 30},
          {"Sinew", "every 4th frame", full, 1.0 / 15},
          {"Sinew", "residual only", show_residual, 1.0 / 60},
          {"Sinew", "residual in batches of 8", batch<8>, 1.0 / 60},
          {"Sinew", "residual in batches of 16", batch<16>, 1.0 / 60},
          {"Sinew", "playback only", play, 1.0 / 60}};
}

}  // namespace sinew::study
