// Bullet's multibody (Debian's libbullet-dev) on the study's scenes without contact: articulated bodies in
// reduced coordinates, without its default damping and speed cap; symplectic Euler or Runge–Kutta.
#include <BulletDynamics/Featherstone/btMultiBody.h>
#include <BulletDynamics/Featherstone/btMultiBodyConstraintSolver.h>
#include <BulletDynamics/Featherstone/btMultiBodyDynamicsWorld.h>
#include <btBulletDynamicsCommon.h>

#include <cmath>

#include "study/engine.h"

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

class BulletEngine : public Engine {
 public:
  BulletEngine(const EngineScene& scene, double h, bool runge_kutta)
      : h_(h),
        runge_kutta_(runge_kutta),
        gravity_(scene.gravity),
        dispatcher_(&configuration_),
        world_(&dispatcher_, &broadphase_, &solver_, &configuration_) {
    refusal_ = needs_contacts_or_muscles(scene);
    world_.setGravity(vector(scene.gravity));
    for (const Figure& figure : scene.figures)
      for (const Joint& joint : figure.skeleton.joints)
        if (Mat3<double>(joint.inertia.diagonal().asDiagonal()) != joint.inertia)
          refusal_ = "principal axes of a body are not its joint's: not written for Bullet";
    for (std::size_t f = 0; refusal_.empty() && f < scene.figures.size(); ++f) add(scene.figures[f]);
  }
  ~BulletEngine() override {
    for (const Body& body : bodies_) world_.removeMultiBody(body.multibody.get());
  }

  const std::string& refusal() const override { return refusal_; }
  bool step() override {
    world_.stepSimulation(btScalar(h_), 0);
    return std::isfinite(energy());
  }
  void aim(int, const std::vector<JointJet<double>>&) override {}
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
               mass * gravity_.dot(vector(at));
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
      out.push_back({Quat<double>(turn), vector(center) - turn * body.skeleton.joints[i].center_of_mass});
    }
    return out;
  }

 private:
  struct Body {
    Skeleton skeleton;
    bool floating;  ///< the root is Bullet's base; else the base is a fixed point of the world
    std::unique_ptr<btMultiBody> multibody;
  };

  void add(const Figure& figure) {
    const Skeleton& s = figure.skeleton;
    const bool floating = s.joints[0].type == JointType::kFree;
    const Joint& root = s.joints[0];
    auto b = std::make_unique<btMultiBody>(s.body_count - floating, btScalar(floating ? root.mass : 0),
                                           floating ? vector(root.inertia.diagonal()) : btVector3(0, 0, 0),
                                           !floating, false);
    for (int i = floating; i < s.body_count; ++i) {
      const Joint& joint = s.joints[i];
      const Vec3<double> parent =
          joint.parent < 0 ? Vec3<double>::Zero() : s.joints[joint.parent].center_of_mass;
      const btQuaternion turn = rotation(joint.rest.rotation.conjugate());
      const btVector3 pivot = vector(joint.rest.translation - parent), center = vector(joint.center_of_mass);
      const btScalar mass = btScalar(joint.mass);
      const btVector3 inertia = vector(joint.inertia.diagonal());
      if (joint.type == JointType::kBall)
        b->setupSpherical(i - floating, mass, inertia, joint.parent - floating, turn, pivot, center);
      else
        b->setupRevolute(i - floating, mass, inertia, joint.parent - floating, turn, vector(joint.axis),
                         pivot, center);
    }
    b->finalizeMultiDof();
    b->setLinearDamping(0);
    b->setAngularDamping(0);
    b->setMaxCoordinateVelocity(btScalar(1e9));
    b->setUseGyroTerm(true);
    b->useRK4Integration(runge_kutta_);
    place(*b, figure, floating);
    world_.addMultiBody(b.get());
    bodies_.push_back({s, floating, std::move(b)});
  }

  static void place(btMultiBody& b, const Figure& figure, bool floating) {
    const Skeleton& s = figure.skeleton;
    for (int i = 0; i < s.body_count; ++i) {
      const Joint& joint = s.joints[i];
      const JointJet<double>& jet = figure.jets[i];
      const Vec3<double> omega = jet.rotation * jet.omega, arm = jet.rotation * joint.center_of_mass;
      const Quat<double> turn = joint.rest.rotation.conjugate() * jet.rotation;
      if (i == 0 && floating) {
        b.setBasePos(vector(jet.translation + arm));
        b.setWorldToBaseRot(rotation(jet.rotation.conjugate()));
        b.setBaseVel(vector(jet.velocity + omega.cross(arm)));
        b.setBaseOmega(vector(omega));
      } else if (joint.type == JointType::kBall) {
        const btScalar q[4] = {btScalar(turn.x()), btScalar(turn.y()), btScalar(turn.z()),
                               btScalar(turn.w())};
        const btScalar v[3] = {btScalar(jet.omega.x()), btScalar(jet.omega.y()), btScalar(jet.omega.z())};
        b.setJointPosMultiDof(i - floating, q);
        b.setJointVelMultiDof(i - floating, v);
      } else {
        b.setJointPos(i - floating, btScalar(2 * std::atan2(turn.vec().dot(joint.axis), turn.w())));
        b.setJointVel(i - floating, btScalar(jet.omega.dot(joint.axis)));
      }
    }
  }

  std::string refusal_;
  double h_;
  bool runge_kutta_;
  Vec3<double> gravity_;
  btDefaultCollisionConfiguration configuration_;
  btCollisionDispatcher dispatcher_;
  btDbvtBroadphase broadphase_;
  btMultiBodyConstraintSolver solver_;
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
