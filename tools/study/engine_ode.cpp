// ODE (Debian's libode-dev) on the study's scenes without contact: every body with six coordinates, joints as
// constraints; its exact solver and its iterative one (50 iterations), gyroscopic term on, no softness added.
#include <ode/ode.h>

#include <cmath>

#include "study/engine.h"

namespace sinew::study {
namespace {

class OdeEngine : public Engine {
 public:
  OdeEngine(const EngineScene& scene, double h, bool quick) : scene_(scene), h_(h), quick_(quick) {
    static const int initialised = dInitODE2(0);
    (void)initialised;
    world_ = dWorldCreate();
    dWorldSetGravity(world_, dReal(scene.gravity.x()), dReal(scene.gravity.y()), dReal(scene.gravity.z()));
    dWorldSetCFM(world_, 0);
    dWorldSetQuickStepNumIterations(world_, 50);
    refusal_ = needs_contacts_or_muscles(scene);
    for (std::size_t f = 0; refusal_.empty() && f < scene.figures.size(); ++f) add(scene.figures[f]);
  }
  ~OdeEngine() override { dWorldDestroy(world_); }

  const std::string& refusal() const override { return refusal_; }
  bool step() override {
    const bool stepped = quick_ ? dWorldQuickStep(world_, dReal(h_)) : dWorldStep(world_, dReal(h_));
    return stepped && std::isfinite(energy());
  }
  void aim(int, const std::vector<JointJet<double>>&) override {}
  void push(int figure, int joint, const Vec3<double>& impulse) override {
    const Vec3<double> f = impulse / h_;
    dBodyAddForce(bodies_[figure][joint], dReal(f.x()), dReal(f.y()), dReal(f.z()));
  }

  double energy() const override {
    double sum = 0;
    for (std::size_t f = 0; f < bodies_.size(); ++f)
      for (int i = 0; i < scene_.figures[f].skeleton.body_count; ++i) {
        const Joint& joint = scene_.figures[f].skeleton.joints[i];
        const Vec3<double> v = vector(dBodyGetLinearVel(bodies_[f][i]));
        const Vec3<double> w = axes(bodies_[f][i]).transpose() * vector(dBodyGetAngularVel(bodies_[f][i]));
        sum += 0.5 * joint.mass * v.squaredNorm() + 0.5 * w.dot(joint.inertia * w) -
               joint.mass * scene_.gravity.dot(vector(dBodyGetPosition(bodies_[f][i])));
      }
    return sum;
  }

  std::vector<Transform<double>> pose(int figure) const override {
    std::vector<Transform<double>> out;
    for (int i = 0; i < scene_.figures[figure].skeleton.body_count; ++i) {
      const Mat3<double> turn = axes(bodies_[figure][i]);
      out.push_back(
          {Quat<double>(turn), vector(dBodyGetPosition(bodies_[figure][i])) -
                                   turn * scene_.figures[figure].skeleton.joints[i].center_of_mass});
    }
    return out;
  }

 private:
  static Vec3<double> vector(const dReal* v) { return {double(v[0]), double(v[1]), double(v[2])}; }
  static Mat3<double> axes(dBodyID body) {
    const dReal* r = dBodyGetRotation(body);  // 3×4, row by row
    Mat3<double> out;
    for (int i = 0; i < 3; ++i)
      for (int k = 0; k < 3; ++k) out(i, k) = double(r[4 * i + k]);
    return out;
  }

  void add(const Figure& figure) {
    const Skeleton& s = figure.skeleton;
    std::vector<Transform<double>> model(s.body_count);
    std::vector<Vec3<double>> omega(s.body_count), velocity(s.body_count);  // of joint frames, world
    std::vector<dBodyID> bodies(s.body_count);
    for (int i = 0; i < s.body_count; ++i) {
      const Joint& joint = s.joints[i];
      const JointJet<double>& jet = figure.jets[i];
      const Transform<double> local{jet.rotation, jet.translation};
      const bool root = joint.parent < 0;
      model[i] = root ? local : model[joint.parent] * local;
      omega[i] = model[i].rotation * jet.omega;
      velocity[i] = jet.velocity;
      if (!root) {
        const Vec3<double> arm = model[i].translation - model[joint.parent].translation;
        velocity[i] = velocity[joint.parent] + omega[joint.parent].cross(arm);
        omega[i] += omega[joint.parent];
      }
      bodies[i] = add_body(joint, model[i], omega[i], velocity[i]);
      if (joint.type != JointType::kFree)
        add_joint(joint, model[i], bodies[i], root ? nullptr : bodies[joint.parent]);
    }
    bodies_.push_back(bodies);
  }

  dBodyID add_body(const Joint& joint, const Transform<double>& model, const Vec3<double>& omega,
                   const Vec3<double>& velocity) {
    const dBodyID body = dBodyCreate(world_);
    const Mat3<double>& inertia = joint.inertia;
    dMass mass;
    dMassSetParameters(&mass, dReal(joint.mass), 0, 0, 0, dReal(inertia(0, 0)), dReal(inertia(1, 1)),
                       dReal(inertia(2, 2)), dReal(inertia(0, 1)), dReal(inertia(0, 2)),
                       dReal(inertia(1, 2)));
    dBodySetMass(body, &mass);
    const Vec3<double> center = model * joint.center_of_mass,
                       speed = velocity + omega.cross(center - model.translation);
    const Quat<double>& q = model.rotation;
    const dQuaternion turn = {dReal(q.w()), dReal(q.x()), dReal(q.y()), dReal(q.z())};
    dBodySetPosition(body, dReal(center.x()), dReal(center.y()), dReal(center.z()));
    dBodySetQuaternion(body, turn);
    dBodySetLinearVel(body, dReal(speed.x()), dReal(speed.y()), dReal(speed.z()));
    dBodySetAngularVel(body, dReal(omega.x()), dReal(omega.y()), dReal(omega.z()));
    dBodySetGyroscopicMode(body, 1);
    return body;
  }

  void add_joint(const Joint& joint, const Transform<double>& model, dBodyID body, dBodyID parent) {
    const Vec3<double>& at = model.translation;
    if (joint.type == JointType::kBall) {
      const dJointID ball = dJointCreateBall(world_, nullptr);
      dJointAttach(ball, body, parent);
      dJointSetBallAnchor(ball, dReal(at.x()), dReal(at.y()), dReal(at.z()));
      return;
    }
    const Vec3<double> axis = model.rotation * joint.axis;
    const dJointID hinge = dJointCreateHinge(world_, nullptr);
    dJointAttach(hinge, body, parent);
    dJointSetHingeAnchor(hinge, dReal(at.x()), dReal(at.y()), dReal(at.z()));
    dJointSetHingeAxis(hinge, dReal(axis.x()), dReal(axis.y()), dReal(axis.z()));
  }

  EngineScene scene_;
  double h_;
  bool quick_;
  std::string refusal_;
  dWorldID world_;
  std::vector<std::vector<dBodyID>> bodies_;
};

template <bool quick>
std::unique_ptr<Engine> make(const EngineScene& scene, double h, const Accuracy&) {
  return std::make_unique<OdeEngine>(scene, h, quick);
}

}  // namespace

std::vector<EngineOption> ode_options() {
  return {{"ODE", "Step", make<false>}, {"ODE", "QuickStep 50", make<true>}};
}

}  // namespace sinew::study
