// What every engine on the diagrams can do: ours and, with SINEW_PEERS, the peers. One description of a scene
// serves all of them.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "sinew/animation/clip.h"
#include "sinew/optimizer/accuracy.h"
#include "sinew/skeleton/skeleton.h"

namespace sinew::study {

/// One body or figure. Joints free (root), ball and revolute; colliders sphere, capsule and box.
struct Figure {
  Skeleton skeleton;
  std::vector<JointJet<double>> jets;  ///< start: local placements and velocities
  bool driven = false;                 ///< muscles follow `Engine::aim`, the root too; else limp
};

struct EngineScene {
  std::vector<Figure> figures;
  Vec3<double> gravity{0, 0, -9.81};
  bool ground = true;  ///< z = 0
};

class Engine {
 public:
  virtual ~Engine() = default;
  virtual const std::string& refusal() const = 0;  ///< why the scene could not be built, or empty
  /// Advances by the step the engine was made with; false when it gives up.
  virtual bool step() = 0;
  /// Where a driven figure shall be at the end of the next step.
  virtual void aim(int figure, const std::vector<JointJet<double>>& jets) = 0;
  /// Impulse (N·s, world axes) on the centre of mass of a joint's body, spread over the next step.
  virtual void push(int figure, int joint, const Vec3<double>& impulse) = 0;
  virtual double energy() const = 0;  ///< kinetic, potential and what contacts store where reported, J
  /// Joint frames in the world; `figure`'s, in the order of its skeleton.
  virtual std::vector<Transform<double>> pose(int figure) const = 0;
  /// Of the first figure, about its centre of mass (kg·m²/s); false where the engine does not tell it.
  virtual bool angular_momentum(Vec3<double>&) const { return false; }
  /// Copies that a step advances together, as batches do; its time is shared among them.
  virtual int copies() const { return 1; }
  virtual double passes() const { return 0; }  ///< mean solver passes per step so far
  /// Mean rms over figures of what the last step itself reckons it went astray (m); negative: it does not
  /// say.
  virtual double estimated_error() const { return -1; }
  /// Takes over the state of an engine of the same kind and scene; false where that is not possible.
  virtual bool take_state(const Engine&) { return false; }
};

/// A way to step: an engine and one of its documented settings.
struct EngineOption {
  std::string engine;  ///< "Sinew", "MuJoCo" …
  std::string option;  ///< "bdf2 float", "RK4" …
  std::unique_ptr<Engine> (*make)(const EngineScene&, double h, const Accuracy& accuracy);
  double step = 0;  ///< s, the only one at which it is run; 0: any
  std::string label() const { return engine + " " + option; }
};

/// Sinew's scheme, and those that it is compared with, in float and double.
std::vector<EngineOption> sinew_options();
/// Of these, the one whose finest steps the others are judged by.
EngineOption most_accurate_option();
/// Ours at rising distance: every frame, every second and fourth, residual only (alone and in batches of 8
/// and 16), playback only.
std::vector<EngineOption> policy_options();
/// Peers that this build was linked with.
std::vector<EngineOption> peer_options();
/// Those of them that choose their steps: `Accuracy::tolerance` is the accuracy asked of them (relative), h
/// only how often targets and poses change hands. Simbody's alone, its last the most accurate.
std::vector<EngineOption> controlled_options();
std::vector<EngineOption> mujoco_options();
std::vector<EngineOption> bullet_options();
std::vector<EngineOption> dart_options();
std::vector<EngineOption> ode_options();
std::vector<EngineOption> simbody_options();
std::vector<EngineOption> simbody_controlled_options();

/// The rest pose at rest, in double.
Figure resting(const Skeleton& skeleton);

}  // namespace sinew::study
