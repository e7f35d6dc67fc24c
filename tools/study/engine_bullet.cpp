// Bullet's multibody (Debian's libbullet-dev) on the study's scenes: articulated bodies in reduced
// coordinates, without its default damping and speed cap; symplectic Euler or Runge–Kutta, contacts and
// motors by 50 iterations or by Dantzig's solver. Muscles are its joint motors; a driven root is a base too
// heavy to be moved.
#include <BulletDynamics/Featherstone/btMultiBody.h>
#include <BulletDynamics/Featherstone/btMultiBodyConstraintSolver.h>
#include <BulletDynamics/Featherstone/btMultiBodyDynamicsWorld.h>
#include <BulletDynamics/Featherstone/btMultiBodyJointMotor.h>
#include <BulletDynamics/Featherstone/btMultiBodyLinkCollider.h>
#include <BulletDynamics/Featherstone/btMultiBodySphericalJointMotor.h>
#include <btBulletDynamicsCommon.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "sinew/skeleton/rotation.h"
#include "study/engine.h"
#include "study/engine_servo.h"

namespace sinew::study {
namespace {

btVector3 vector(const Vec3<double>& v) {
  return {btScalar(v.x()), btScalar(v.y()), btScalar(v.z())};
}
Vec3<double> vector(const btVector3& v) {
  return {double(v.x()), double(v.y()), double(v.z())};
}
btQuaternion rotation(const Quat<double>& q) {
  return {btScalar(q.x()), btScalar(q.y()), btScalar(q.z()), btScalar(q.w())};
}

/// Principal axes → joint frame: Bullet's links turn with their principal axes.
struct Principal {
  Quat<double> axes = Quat<double>::Identity();
  Vec3<double> inertia;  ///< kg·m², about them
};

Principal principal(const Joint& joint, double heavier) {
  const Mat3<double> inertia = heavier * joint.inertia;
  if (Mat3<double>(inertia.diagonal().asDiagonal()) == inertia)
    return {Quat<double>::Identity(), inertia.diagonal()};
  const Eigen::SelfAdjointEigenSolver<Mat3<double>> solved(inertia);
  Mat3<double> axes = solved.eigenvectors();
  if (axes.determinant() < 0) axes.col(0) *= -1;
  return {Quat<double>(axes), solved.eigenvalues()};
}

constexpr double kDrivenRoot = 1e5;  ///< a driven root weighs so many times as much: nothing moves it

class BulletEngine : public Engine {
 public:
  BulletEngine(const EngineScene& scene, double h, bool runge_kutta)
      : scene_(scene),
        h_(h),
        runge_kutta_(runge_kutta),
        dispatcher_(&configuration_),
        world_(&dispatcher_, &broadphase_, &solver_, &configuration_) {
    world_.setGravity(vector(scene.gravity));
    world_.getSolverInfo().m_numIterations = 50;
    if (scene.ground) add_ground();
    for (std::size_t f = 0; f < scene.figures.size(); ++f) add(scene.figures[f], static_cast<int>(f));
  }
  ~BulletEngine() override {
    for (const Body& body : bodies_) {
      for (const auto& motor : body.motors)
        if (motor) world_.removeMultiBodyConstraint(motor.get());
      for (const auto& collider : body.colliders) world_.removeCollisionObject(collider.get());
      world_.removeMultiBody(body.multibody.get());
    }
    if (floor_) world_.removeRigidBody(floor_.get());
  }

  const std::string& refusal() const override { return refusal_; }
  bool step() override {
    for (std::size_t f = 0; f < bodies_.size(); ++f)
      if (scene_.figures[f].driven) drive(static_cast<int>(f));
    world_.stepSimulation(btScalar(h_), 0);
    return std::isfinite(energy());
  }
  void aim(int figure, const std::vector<JointJet<double>>& jets) override {
    bodies_[figure].servo.aim(jets);
  }
  void push(int figure, int joint, const Vec3<double>& impulse) override {
    const Body& body = bodies_[figure];
    const int link = joint - body.floating;
    if (link < 0)
      body.multibody->addBaseForce(vector(impulse / h_));
    else
      body.multibody->addLinkForce(link, vector(impulse / h_));
  }

  double energy() const override {
    double sum = 0;
    for (const Body& body : bodies_) {
      const btMultiBody& b = *body.multibody;
      std::vector<btVector3> omega(b.getNumLinks() + 1),
          velocity(b.getNumLinks() + 1);  // base first, own axes
      b.compTreeLinkVelocities(omega.data(), velocity.data());
      for (int i = -1; i < b.getNumLinks(); ++i) {
        if (i < 0 && !body.floating) continue;
        const double mass = i < 0 ? double(b.getBaseMass()) : double(b.getLinkMass(i));
        const Vec3<double> inertia = vector(i < 0 ? b.getBaseInertia() : b.getLinkInertia(i));
        const Vec3<double> v = vector(velocity[i + 1]), w = vector(omega[i + 1]);
        const btVector3 at = i < 0 ? b.getBasePos() : b.localPosToWorld(i, btVector3(0, 0, 0));
        sum += 0.5 * mass * v.squaredNorm() + 0.5 * inertia.dot(w.cwiseProduct(w)) -
               mass * scene_.gravity.dot(vector(at));
      }
    }
    return sum;
  }

  std::vector<Transform<double>> pose(int figure) const override {
    const Body& body = bodies_[figure];
    std::vector<Transform<double>> out;
    for (int i = 0; i < body.skeleton.body_count; ++i) {
      const int link = i - body.floating;
      const btMatrix3x3 axes = link < 0 ? btMatrix3x3(body.multibody->getWorldToBaseRot().inverse())
                                        : body.multibody->localFrameToWorld(link, btMatrix3x3::getIdentity());
      const btVector3 center =
          link < 0 ? body.multibody->getBasePos() : body.multibody->localPosToWorld(link, btVector3(0, 0, 0));
      Mat3<double> turn;
      for (int r = 0; r < 3; ++r)
        for (int c = 0; c < 3; ++c) turn(r, c) = double(axes[r][c]);
      turn = turn * body.principal[i].axes.conjugate().toRotationMatrix();
      out.push_back({Quat<double>(turn), vector(center) - turn * body.skeleton.joints[i].center_of_mass});
    }
    return out;
  }

 private:
  struct Body {
    Skeleton skeleton;
    bool floating;  ///< the root is Bullet's base; else the base is a fixed point of the world
    std::unique_ptr<btMultiBody> multibody;
    std::vector<Principal> principal;  ///< [joint]
    Servo servo;
    std::vector<std::unique_ptr<btMultiBodyConstraint>> motors = {};  ///< [joint]
    std::vector<std::unique_ptr<btMultiBodyLinkCollider>> colliders = {};
  };

  void add(const Figure& figure, int index) {
    const Skeleton& s = figure.skeleton;
    const bool floating = s.joints[0].type == JointType::kFree;
    const Joint& root = s.joints[0];
    const double heavier = figure.driven ? kDrivenRoot : 1;
    std::vector<Principal> axes;
    for (int i = 0; i < s.body_count; ++i) axes.push_back(principal(s.joints[i], i == 0 ? heavier : 1));
    auto b = std::make_unique<btMultiBody>(
        s.body_count - floating, btScalar(floating ? heavier * root.mass : 0),
        floating ? vector(axes[0].inertia) : btVector3(0, 0, 0), !floating, false);
    for (int i = floating; i < s.body_count; ++i) {
      const Joint& joint = s.joints[i];
      const bool grounded = joint.parent < 0;
      const Quat<double> of_parent = grounded ? Quat<double>::Identity() : axes[joint.parent].axes,
                         own = axes[i].axes.conjugate();
      const Vec3<double> parent = grounded ? Vec3<double>::Zero() : s.joints[joint.parent].center_of_mass;
      const btQuaternion turn =
          rotation((of_parent.conjugate() * joint.rest.rotation * axes[i].axes).conjugate());
      const btVector3 pivot = vector(of_parent.conjugate() * (joint.rest.translation - parent)),
                      center = vector(own * joint.center_of_mass), inertia = vector(axes[i].inertia);
      const btScalar mass = btScalar(joint.mass);
      if (joint.type == JointType::kBall)
        b->setupSpherical(i - floating, mass, inertia, joint.parent - floating, turn, pivot, center);
      else
        b->setupRevolute(i - floating, mass, inertia, joint.parent - floating, turn, vector(own * joint.axis),
                         pivot, center);
    }
    b->finalizeMultiDof();
    b->setLinearDamping(0);
    b->setAngularDamping(0);
    b->setMaxCoordinateVelocity(btScalar(1e9));
    b->setUseGyroTerm(true);
    b->useRK4Integration(runge_kutta_);
    b->setHasSelfCollision(false);
    place(*b, figure, axes, floating);
    world_.addMultiBody(b.get());
    Body& body = bodies_.emplace_back(Body{s, floating, std::move(b), axes, Servo(figure)});
    if (scene_.ground || figure.driven) add_colliders(body, index);  // what has none, no motor moves
    if (figure.driven) add_motors(body);
  }

  static void place(btMultiBody& b, const Figure& figure, const std::vector<Principal>& axes, bool floating) {
    const Skeleton& s = figure.skeleton;
    for (int i = 0; i < s.body_count; ++i) {
      const Joint& joint = s.joints[i];
      const JointJet<double>& jet = figure.jets[i];
      const Quat<double>& own = axes[i].axes;
      const Vec3<double> omega = jet.rotation * jet.omega, arm = jet.rotation * joint.center_of_mass;
      const Quat<double> turn = joint.rest.rotation.conjugate() * jet.rotation;
      if (i == 0 && floating) {
        b.setBasePos(vector(jet.translation + arm));
        b.setWorldToBaseRot(rotation((jet.rotation * own).conjugate()));
        b.setBaseVel(vector(jet.velocity + omega.cross(arm)));
        b.setBaseOmega(vector(omega));
      } else if (joint.type == JointType::kBall) {
        const Quat<double> t = own.conjugate() * turn * own;
        const Vec3<double> w = own.conjugate() * jet.omega;
        const btScalar q[4] = {btScalar(t.x()), btScalar(t.y()), btScalar(t.z()), btScalar(t.w())};
        const btScalar v[3] = {btScalar(w.x()), btScalar(w.y()), btScalar(w.z())};
        b.setJointPosMultiDof(i - floating, q);
        b.setJointVelMultiDof(i - floating, v);
      } else {
        b.setJointPos(i - floating, btScalar(2 * std::atan2(turn.vec().dot(joint.axis), turn.w())));
        b.setJointVel(i - floating, btScalar(jet.omega.dot(joint.axis)));
      }
    }
  }

  void add_ground() {
    shapes_.push_back(std::make_unique<btStaticPlaneShape>(btVector3(0, 0, 1), btScalar(0)));
    floor_ = std::make_unique<btRigidBody>(
        btRigidBody::btRigidBodyConstructionInfo(0, nullptr, shapes_.back().get()));
    floor_->setFriction(1);  // Bullet multiplies the two
    world_.addRigidBody(floor_.get(), 1, -1);
  }

  btCollisionShape* shape_of(const Collider& c) {
    const btScalar x = btScalar(c.size.x()), z = btScalar(c.size.z());
    if (c.shape == Shape::kBox)
      shapes_.push_back(std::make_unique<btBoxShape>(vector(c.size)));
    else if (c.shape == Shape::kCapsule && z > 0)
      shapes_.push_back(std::make_unique<btCapsuleShapeZ>(x, 2 * z));
    else
      shapes_.push_back(std::make_unique<btSphereShape>(x));
    return shapes_.back().get();
  }

  /// A figure touches the floor and others.
  void add_colliders(Body& body, int figure) {
    for (int i = 0; i < body.skeleton.body_count; ++i) {
      auto whole = std::make_unique<btCompoundShape>();
      double friction = 0;
      for (const Collider& c : body.skeleton.colliders) {
        if (c.joint != i) continue;
        const Quat<double> own = body.principal[i].axes.conjugate();
        const Vec3<double> at = own * (c.local.translation - body.skeleton.joints[i].center_of_mass);
        whole->addChildShape(btTransform(rotation(own * c.local.rotation), vector(at)), shape_of(c));
        friction = std::max(friction, c.friction);
      }
      if (whole->getNumChildShapes() == 0) continue;
      const int link = i - body.floating;
      auto collider = std::make_unique<btMultiBodyLinkCollider>(body.multibody.get(), link);
      collider->setCollisionShape(whole.get());
      collider->setFriction(btScalar(friction));
      shapes_.push_back(std::move(whole));
      if (link < 0)
        body.multibody->setBaseCollider(collider.get());
      else
        body.multibody->getLink(link).m_collider = collider.get();
      const int group = 1 << (figure + 1);
      world_.addCollisionObject(collider.get(), group, ~group);
      body.colliders.push_back(std::move(collider));
    }
    btAlignedObjectArray<btQuaternion> turns;
    btAlignedObjectArray<btVector3> places;
    body.multibody->forwardKinematics(turns, places);
    body.multibody->updateCollisionObjectWorldTransforms(turns, places);
  }

  void add_motors(Body& body) {
    body.motors.resize(body.skeleton.joints.size());
    for (int i = 1; i < body.skeleton.body_count; ++i) {
      if (body.skeleton.joints[i].type == JointType::kBall)  // with a limit of 0 it would be skipped
        body.motors[i] = std::make_unique<btMultiBodySphericalJointMotor>(body.multibody.get(), i - 1, 1);
      else
        body.motors[i] = std::make_unique<btMultiBodyJointMotor>(body.multibody.get(), i - 1, 0, 0);
      world_.addMultiBodyConstraint(body.motors[i].get());
      body.motors[i]->finalizeMultiDof();
    }
  }

  /// Motors and the root's velocity for the next step.
  void drive(int f) {
    Body& body = bodies_[f];
    btMultiBody& b = *body.multibody;
    const Skeleton& s = body.skeleton;
    const std::vector<Transform<double>> model = pose(f);
    const Servo::Travel root = body.servo.travel(model[0], h_);
    const Vec3<double> center = model[0].rotation * s.joints[0].center_of_mass,
                       there = body.servo.target(0).rotation * s.joints[0].center_of_mass;
    b.setBaseOmega(vector(model[0].rotation * root.rate));
    b.setBaseVel(vector(root.velocity + (there - center) / h_));
    b.addBaseForce(vector(-b.getBaseMass() * scene_.gravity));  // what holds the root up
    for (int i = 1; i < s.body_count; ++i) {
      const Joint& joint = s.joints[i];
      const Quat<double>& own = body.principal[i].axes;
      const bool hinge = joint.type == JointType::kRevolute;
      const Vec3<double> rate =
          body.servo.rate(i, model[joint.parent].rotation.conjugate() * model[i].rotation, h_);
      const Motor muscle = motor_of(joint);
      if (hinge) {
        auto* motor = static_cast<btMultiBodyJointMotor*>(body.motors[i].get());
        motor->setVelocityTarget(btScalar(rate.dot(joint.axis)));
        motor->setMaxAppliedImpulse(btScalar(h_ * muscle.most[0]));
        continue;
      }
      // Bullet's motor works about the principal axes, the limits are about the joint's: an axis has the
      // limits of those it lies between, in proportion.
      auto* motor = static_cast<btMultiBodySphericalJointMotor*>(body.motors[i].get());
      const Quat<double> led = joint.rest.rotation.conjugate() * model[joint.parent].rotation.conjugate() *
                               model[i].rotation * rotation_exp<double>(h_ * rate);
      const btScalar pull = 1 / world_.getSolverInfo().m_erp;  // all of the way in one step
      motor->setPositionTargetMultiDof(rotation(own.conjugate() * led * own), {pull, pull, pull});
      const Mat3<double> turn = own.toRotationMatrix().transpose();
      motor->setMaxAppliedImpulseMultiDof(vector(h_ * (turn.cwiseAbs2() * muscle.most)));
    }
    body.servo.advance();
  }

  EngineScene scene_;
  std::string refusal_;
  double h_;
  bool runge_kutta_;
  btDefaultCollisionConfiguration configuration_;
  btCollisionDispatcher dispatcher_;
  btDbvtBroadphase broadphase_;
  btMultiBodyConstraintSolver solver_;
  std::vector<std::unique_ptr<btCollisionShape>> shapes_;
  std::unique_ptr<btRigidBody> floor_;
  btMultiBodyDynamicsWorld world_;
  std::vector<Body> bodies_;
};

template <bool runge_kutta>
std::unique_ptr<Engine> make(const EngineScene& scene, double h, const Accuracy&) {
  return std::make_unique<BulletEngine>(scene, h, runge_kutta);
}

}  // namespace

std::vector<EngineOption> bullet_options() {
  return {{"Bullet", "Euler", make<false>}, {"Bullet", "RK4", make<true>}};
}

}  // namespace sinew::study
