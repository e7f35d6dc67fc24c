// ODE (Debian's libode-dev) on the study's scenes: every body with six coordinates, joints as constraints;
// its exact solver and its iterative one (50 iterations), gyroscopic term on. No softness is added but ODE's
// own default of 1e-10 where contacts make constraints redundant. Muscles are its hinge and angular motors,
// which its manual recommends over torques; a driven root is a kinematic body.
#include <ode/ode.h>
#include <ode/threading_impl.h>

#include <algorithm>
#include <cmath>

#include "sinew/skeleton/rotation.h"
#include "study/engine.h"
#include "study/engine_servo.h"

namespace sinew::study {
namespace {

class OdeEngine : public Engine {
 public:
  OdeEngine(const EngineScene& scene, double h, bool quick) : scene_(scene), h_(h), quick_(quick) {
    static const int initialised = dInitODE2(0);
    (void)initialised;
    dAllocateODEDataForThread(dAllocateMaskAll);
    world_ = dWorldCreate();
    dWorldSetStepThreadingImplementation(world_, dThreadingImplementationGetFunctions(jobs_), jobs_);
    dWorldSetGravity(world_, dReal(scene.gravity.x()), dReal(scene.gravity.y()), dReal(scene.gravity.z()));
    dWorldSetCFM(world_, scene.ground ? dReal(1e-10) : 0);
    dWorldSetQuickStepNumIterations(world_, 50);
    space_ = dSimpleSpaceCreate(nullptr);
    touching_ = dJointGroupCreate(0);
    if (scene.ground) dCreatePlane(space_, 0, 0, 1, 0);
    for (std::size_t f = 0; f < scene.figures.size(); ++f) {
      add(scene.figures[f], static_cast<int>(f));
      if (quick_ && scene.figures[f].driven)
        refusal_ = "QuickStep's iterations do not hold a figure by motors about a constant torque";
    }
  }
  ~OdeEngine() override {
    dJointGroupDestroy(touching_);
    dSpaceDestroy(space_);
    dWorldDestroy(world_);
    dThreadingFreeImplementation(jobs_);
  }

  const std::string& refusal() const override { return refusal_; }
  bool step() override {
    dAllocateODEDataForThread(dAllocateMaskAll);  // of whoever steps
    for (std::size_t f = 0; f < servos_.size(); ++f)
      if (scene_.figures[f].driven) drive(static_cast<int>(f));
    dSpaceCollide(space_, this,
                  [](void* self, dGeomID a, dGeomID b) { static_cast<OdeEngine*>(self)->touch(a, b); });
    const bool stepped = quick_ ? dWorldQuickStep(world_, dReal(h_)) : dWorldStep(world_, dReal(h_));
    dJointGroupEmpty(touching_);
    return stepped && std::isfinite(energy());
  }
  void aim(int figure, const std::vector<JointJet<double>>& jets) override { servos_[figure].aim(jets); }
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

  /// What a geometry belongs to and how rough it is.
  struct Surface {
    int figure;
    double friction;
  };

  void touch(dGeomID a, dGeomID b) {
    const auto *on_a = static_cast<const Surface*>(dGeomGetData(a)),
               *on_b = static_cast<const Surface*>(dGeomGetData(b));
    if (on_a && on_b && on_a->figure == on_b->figure) return;  // a figure touches the floor and others
    constexpr int kMost = 8;                                   // points of a pair
    dContact contacts[kMost] = {};
    const int count = dCollide(a, b, kMost, &contacts[0].geom, sizeof(dContact));
    for (int n = 0; n < count; ++n) {
      contacts[n].surface.mode = dContactApprox1;
      contacts[n].surface.mu = dReal(std::max(on_a ? on_a->friction : 0, on_b ? on_b->friction : 0));
      dJointAttach(dJointCreateContact(world_, touching_, &contacts[n]), dGeomGetBody(a), dGeomGetBody(b));
    }
  }

  /// Motors and the root's velocity for the next step.
  void drive(int f) {
    const Skeleton& s = scene_.figures[f].skeleton;
    const std::vector<dBodyID>& bodies = bodies_[f];
    const std::vector<Transform<double>> model = pose(f);
    const Servo::Travel root = servos_[f].travel(model[0], h_);
    const Vec3<double> center = model[0].rotation * s.joints[0].center_of_mass,
                       arm = servos_[f].target(0).rotation * s.joints[0].center_of_mass,
                       spin = model[0].rotation * root.rate, velocity = root.velocity + (arm - center) / h_;
    // ODE turns each body by its own velocity: relative ones lead where they should if each body goes where
    // the joints above it take it.
    std::vector<Quat<double>> there{servos_[f].target(0).rotation};
    std::vector<Vec3<double>> turning{spin};
    for (int i = 1; i < s.body_count; ++i) {
      const Joint& joint = s.joints[i];
      const Quat<double> now = model[joint.parent].rotation.conjugate() * model[i].rotation;
      there.emplace_back(there[joint.parent] * now * rotation_exp<double>(h_ * servos_[f].rate(i, now, h_)));
      turning.emplace_back(rotation_log<double>(there[i] * model[i].rotation.conjugate()) / h_);
      const Vec3<double> rate = model[i].rotation.conjugate() * (turning[i] - turning[joint.parent]);
      const Motor muscle = motor_of(joint);
      const dJointID motor = motors_[f][i];
      if (joint.type == JointType::kRevolute) {
        dJointSetHingeParam(motor, dParamVel, dReal(rate.dot(joint.axis)));
        dJointSetHingeParam(motor, dParamFMax, dReal(muscle.most[0]));
        dJointAddHingeTorque(motor, dReal(muscle.bias[0]));
        continue;
      }
      constexpr int kRates[] = {dParamVel1, dParamVel2, dParamVel3},
                    kLimits[] = {dParamFMax1, dParamFMax2, dParamFMax3};
      for (int k = 0; k < 3; ++k) {
        const Vec3<double> axis = model[i].rotation * Vec3<double>::Unit(k);
        dJointSetAMotorAxis(motor, k, 1, dReal(axis.x()), dReal(axis.y()), dReal(axis.z()));
        dJointSetAMotorParam(motor, kRates[k], dReal(rate[k]));
        dJointSetAMotorParam(motor, kLimits[k], dReal(muscle.most[k]));
      }
      dJointAddAMotorTorques(motor, dReal(muscle.bias[0]), dReal(muscle.bias[1]), dReal(muscle.bias[2]));
    }
    dBodySetAngularVel(bodies[0], dReal(spin.x()), dReal(spin.y()), dReal(spin.z()));
    dBodySetLinearVel(bodies[0], dReal(velocity.x()), dReal(velocity.y()), dReal(velocity.z()));
    servos_[f].advance();
  }

  void add_collider(const Collider& c, const Joint& joint, dBodyID body, int figure) {
    const dReal x = dReal(c.size.x()), z = dReal(c.size.z());
    const dGeomID geom = c.shape == Shape::kBox ? dCreateBox(space_, 2 * x, dReal(2 * c.size.y()), 2 * z)
                         : c.shape == Shape::kCapsule && z > 0 ? dCreateCapsule(space_, x, 2 * z)
                                                               : dCreateSphere(space_, x);
    const Vec3<double> at = c.local.translation - joint.center_of_mass;
    const Quat<double>& q = c.local.rotation;
    const dQuaternion turn = {dReal(q.w()), dReal(q.x()), dReal(q.y()), dReal(q.z())};
    dGeomSetBody(geom, body);
    dGeomSetOffsetPosition(geom, dReal(at.x()), dReal(at.y()), dReal(at.z()));
    dGeomSetOffsetQuaternion(geom, turn);
    surfaces_.push_back(std::make_unique<Surface>(Surface{figure, c.friction}));
    dGeomSetData(geom, surfaces_.back().get());
  }

  void add(const Figure& figure, int index) {
    const Skeleton& s = figure.skeleton;
    std::vector<dJointID> motors(s.body_count);
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
        motors[i] =
            add_joint(joint, model[i], bodies[i], root ? nullptr : bodies[joint.parent], figure.driven);
    }
    for (const Collider& c : s.colliders)
      if (scene_.ground && c.joint < s.body_count) add_collider(c, s.joints[c.joint], bodies[c.joint], index);
    if (figure.driven) dBodySetKinematic(bodies[0]);
    for (const dBodyID body : bodies)
      if (figure.driven) dBodySetFiniteRotationMode(body, 1);  // turns as far as its velocity says
    bodies_.push_back(bodies);
    motors_.push_back(motors);
    servos_.emplace_back(figure);
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

  /// Returns what drives it, where it is driven.
  dJointID add_joint(const Joint& joint, const Transform<double>& model, dBodyID body, dBodyID parent,
                     bool driven) {
    const Vec3<double>& at = model.translation;
    if (joint.type == JointType::kBall) {
      const dJointID ball = dJointCreateBall(world_, nullptr);
      dJointAttach(ball, body, parent);
      dJointSetBallAnchor(ball, dReal(at.x()), dReal(at.y()), dReal(at.z()));
      if (!driven) return nullptr;
      const dJointID motor = dJointCreateAMotor(world_, nullptr);
      dJointAttach(motor, body, parent);
      dJointSetAMotorMode(motor, dAMotorUser);
      dJointSetAMotorNumAxes(motor, 3);
      return motor;
    }
    const Vec3<double> axis = model.rotation * joint.axis;
    const dJointID hinge = dJointCreateHinge(world_, nullptr);
    dJointAttach(hinge, body, parent);
    dJointSetHingeAnchor(hinge, dReal(at.x()), dReal(at.y()), dReal(at.z()));
    dJointSetHingeAxis(hinge, dReal(axis.x()), dReal(axis.y()), dReal(axis.z()));
    return hinge;
  }

  EngineScene scene_;
  double h_;
  bool quick_;
  std::string refusal_;
  /// Worlds share one list of jobs unless they have their own, and it must not be used by two threads.
  dThreadingImplementationID jobs_ = dThreadingAllocateSelfThreadedImplementation();
  dWorldID world_;
  dSpaceID space_;
  dJointGroupID touching_;
  std::vector<std::vector<dBodyID>> bodies_;
  std::vector<std::vector<dJointID>> motors_;  ///< [figure][joint]
  std::vector<Servo> servos_;
  std::vector<std::unique_ptr<Surface>> surfaces_;  ///< geometries point at them
};

template <bool quick>
std::unique_ptr<Engine> make(const EngineScene& scene, double h, const Accuracy&) {
  return std::make_unique<OdeEngine>(scene, h, quick);
}

}  // namespace

std::vector<EngineOption> ode_options() {
  return {{"ODE", "QuickStep 50", make<true>}, {"ODE", "Step", make<false>}};
}

}  // namespace sinew::study
