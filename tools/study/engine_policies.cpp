// Levels of detail of a character that follows its clip: what is left out as it goes further away.
#include <cmath>
#include <limits>

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

}  // namespace

std::vector<EngineOption> policy_options() {
  const auto full = sinew_options()[0].make;
  return {{"Sinew", "every frame", full, 1.0 / 60},
          {"Sinew", "every 2nd frame", full, 1.0 / 30},
          {"Sinew", "every 4th frame", full, 1.0 / 15},
          {"Sinew", "residual only", show_residual, 1.0 / 60},
          {"Sinew", "playback only", play, 1.0 / 60}};
}

}  // namespace sinew::study
