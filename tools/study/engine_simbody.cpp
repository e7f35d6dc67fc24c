// Simbody (Debian's libsimbody-dev) on the study's scenes: reduced coordinates with quaternions; its
// semi-explicit Euler and Runge–Kutta methods in steps of given size, and (simbody_controlled_options) those
// that choose their steps to keep an accuracy, CPodes' BDF among them. Contacts are its compliant ones:
// spheres and bricks on a half space by Hertz and penalty, as soft as ours and with our stick speed; boxes
// that meet each other are meshes on elastic foundations. Capsules are the spheres at their ends. It has no
// motor with a force limit: muscles are its inverse dynamics cut off at their limits (simbody_muscle.h); a
// driven root is a prescribed motion.
#include <dlfcn.h>

#include "study/engine.h"
#include "study/tables/peers/simbody_world.h"

namespace sinew::study {
namespace {

/// The module, loaded once; `make` is null where it cannot be.
struct Module {
  decltype(&sinew_simbody_world) make = nullptr;
  std::string fault;
  Module() {
    if (void* module = dlopen(SINEW_SIMBODY_MODULE, RTLD_NOW | RTLD_LOCAL | RTLD_DEEPBIND))
      make = reinterpret_cast<decltype(make)>(dlsym(module, "sinew_simbody_world"));
    if (!make) fault = std::string("it cannot be loaded: ") + dlerror();
  }
};

SimbodyPlace place(const Transform<double>& t) {
  return {t.rotation, t.translation};
}
SimbodyJet jet_of(const JointJet<double>& j) {
  return {{j.rotation, j.translation}, j.omega, j.alpha, j.velocity, j.acceleration};
}

SimbodyBody body_of(const Joint& joint, const JointJet<double>& start) {
  SimbodyBody b;
  b.parent = joint.parent;
  b.type = joint.type;
  b.rest = place(joint.rest);
  b.axis = joint.axis;
  b.mass = joint.mass;
  b.center_of_mass = joint.center_of_mass;
  b.inertia = joint.inertia;
  for (int k = 0; k < dof_count(joint.type) && k < 3; ++k) {
    b.torque_minus[k] = joint.dofs[k].torque_minus;
    b.torque_plus[k] = joint.dofs[k].torque_plus;
  }
  b.start = jet_of(start);
  return b;
}

void add_shapes(SimbodyFigure& to, const Collider& c) {
  SimbodyShape& shape = to.shapes.emplace_back();
  shape.body = c.joint;
  shape.box = c.shape == Shape::kBox;
  shape.at = place(c.local);
  shape.size = c.size;
  shape.friction = c.friction;
  if (c.shape != Shape::kCapsule || c.size.z() <= 0) return;
  const Vec3<double> half(0, 0, c.size.z());
  shape.at.translation = c.local * half;
  SimbodyShape other = shape;
  other.at.translation = c.local * Vec3<double>(-half);
  to.shapes.push_back(other);
}

SimbodyFigure figure_of(const Figure& f) {
  SimbodyFigure out;
  out.driven = f.driven;
  for (int i = 0; i < f.skeleton.body_count; ++i)
    out.bodies.push_back(body_of(f.skeleton.joints[i], f.jets[i]));
  for (const Collider& c : f.skeleton.colliders)
    if (c.joint < f.skeleton.body_count) add_shapes(out, c);
  return out;
}

class SimbodyEngine : public Engine {
 public:
  SimbodyEngine(const EngineScene& scene, double h, const Accuracy& accuracy, SimbodyIntegrator integrator,
                bool controlled)
      : figures_(scene.figures.size()) {
    static const Module module;
    if (!module.make) {
      refusal_ = module.fault;
      return;
    }
    SimbodyScene out;
    for (const Figure& f : scene.figures) {
      out.figures.push_back(figure_of(f));
      if (f.driven && scene.ground && !f.skeleton.colliders.empty())
        refusal_ = "feet that muscles press to its compliant floor take it steps of microseconds";
    }
    if (!refusal_.empty()) return;
    out.gravity = scene.gravity;
    out.ground = scene.ground;
    out.integrator = integrator;
    out.step = h;
    out.accuracy = controlled ? accuracy.tolerance : 0;
    out.sink_depth = accuracy.sink_depth;
    out.stick_speed = accuracy.stick_speed;
    out.return_time = accuracy.return_time;
    world_.reset(module.make(out, refusal_));
  }

  const std::string& refusal() const override { return refusal_; }
  bool step() override { return world_->step(); }
  void aim(int figure, const std::vector<JointJet<double>>& jets) override {
    std::vector<SimbodyJet> out;
    for (const JointJet<double>& jet : jets) out.push_back(jet_of(jet));
    world_->aim(figure, out);
  }
  void push(int figure, int joint, const Vec3<double>& impulse) override {
    world_->push(figure, joint, impulse);
  }
  double energy() const override { return world_->energy(); }
  std::vector<Transform<double>> pose(int figure) const override {
    std::vector<Transform<double>> out;
    for (const SimbodyPlace& p : world_->pose(figure)) out.push_back({p.rotation, p.translation});
    return out;
  }
  bool angular_momentum(Vec3<double>& out) const override {
    if (figures_ > 1) return false;
    out = world_->angular_momentum();
    return true;
  }

 private:
  std::size_t figures_;
  std::string refusal_;
  std::unique_ptr<SimbodyWorld> world_;
};

template <SimbodyIntegrator integrator, bool controlled>
std::unique_ptr<Engine> make(const EngineScene& scene, double h, const Accuracy& accuracy) {
  return std::make_unique<SimbodyEngine>(scene, h, accuracy, integrator, controlled);
}

}  // namespace

std::vector<EngineOption> simbody_options() {
  return {{"Simbody", "semi-explicit Euler", make<SimbodyIntegrator::kSemiExplicitEuler, false>},
          {"Simbody", "Runge-Kutta 3", make<SimbodyIntegrator::kRungeKutta3, false>},
          {"Simbody", "Runge-Kutta-Merson", make<SimbodyIntegrator::kRungeKuttaMerson, false>}};
}

std::vector<EngineOption> simbody_controlled_options() {
  return {
      {"Simbody", "semi-explicit Euler 2 (steps chosen)", make<SimbodyIntegrator::kSemiExplicitEuler2, true>},
      {"Simbody", "CPodes (steps chosen)", make<SimbodyIntegrator::kCPodes, true>},
      {"Simbody", "Runge-Kutta-Merson (steps chosen)", make<SimbodyIntegrator::kRungeKuttaMerson, true>}};
}

}  // namespace sinew::study
