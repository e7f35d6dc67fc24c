// DART (Debian's libdart-dev) on the study's scenes: semi-implicit Euler in generalised coordinates, its only
// integrator, with both of its solvers for contacts. Its own collision detector; capsules are the spheres at
// their ends, which is all of them that touches a floor. Muscles are its servo joints with their force
// limits; a driven root is a joint of given velocity.
#include <cmath>
#include <dart/collision/dart/DARTCollisionDetector.hpp>
#include <dart/constraint/BoxedLcpConstraintSolver.hpp>
#include <dart/constraint/DantzigBoxedLcpSolver.hpp>
#include <dart/constraint/PgsBoxedLcpSolver.hpp>
#include <dart/dynamics/BallJoint.hpp>
#include <dart/dynamics/BodyNode.hpp>
#include <dart/dynamics/BoxShape.hpp>
#include <dart/dynamics/FreeJoint.hpp>
#include <dart/dynamics/RevoluteJoint.hpp>
#include <dart/dynamics/Skeleton.hpp>
#include <dart/dynamics/SphereShape.hpp>
#include <dart/dynamics/WeldJoint.hpp>
#include <dart/simulation/World.hpp>

#include "study/engine.h"
#include "study/engine_servo.h"

namespace sinew::study {
namespace {

using dart::dynamics::BallJoint;
using dart::dynamics::BodyNode;
using dart::dynamics::FreeJoint;
using dart::dynamics::RevoluteJoint;

Eigen::Isometry3d isometry(const Quat<double>& rotation, const Vec3<double>& translation) {
  Eigen::Isometry3d out = Eigen::Isometry3d::Identity();
  out.linear() = rotation.toRotationMatrix();
  out.translation() = translation;
  return out;
}

template <class Kind>
typename Kind::Properties named(const Joint& joint) {
  typename Kind::Properties properties;
  properties.mName = joint.name;
  return properties;
}

class DartEngine : public Engine {
 public:
  DartEngine(const EngineScene& scene, double h, bool pgs)
      : scene_(scene), world_(dart::simulation::World::create()) {
    using dart::constraint::BoxedLcpConstraintSolver;
    if (pgs)
      world_->setConstraintSolver(std::make_unique<BoxedLcpConstraintSolver>(
          std::make_shared<dart::constraint::PgsBoxedLcpSolver>()));
    else
      world_->setConstraintSolver(std::make_unique<BoxedLcpConstraintSolver>(
          std::make_shared<dart::constraint::DantzigBoxedLcpSolver>()));
    world_->getConstraintSolver()->setCollisionDetector(dart::collision::DARTCollisionDetector::create());
    world_->setTimeStep(h);
    world_->setGravity(scene.gravity);
    if (scene.ground) add_ground();
    for (const Figure& figure : scene.figures) add(figure);
    for (const auto& figure : figures_)
      most_ += 1e4 * (figure->computeKineticEnergy() + 10 * figure->getMass());
  }

  const std::string& refusal() const override { return refusal_; }
  bool step() override {
    // A state that is no number any more ends the whole program in DART's assertions: stop well before.
    if (!(std::abs(energy()) < most_)) return false;
    for (std::size_t f = 0; f < figures_.size(); ++f)
      if (scene_.figures[f].driven) drive(f);
    world_->step();
    return true;
  }
  void aim(int figure, const std::vector<JointJet<double>>& jets) override { servos_[figure].aim(jets); }
  void push(int figure, int joint, const Vec3<double>& impulse) override {
    figures_[figure]->getBodyNode(joint)->addExtForce(
        impulse / world_->getTimeStep(), scene_.figures[figure].skeleton.joints[joint].center_of_mass);
  }
  double energy() const override {
    double sum = 0;
    for (const auto& figure : figures_)
      sum += figure->computeKineticEnergy() - figure->getMass() * world_->getGravity().dot(figure->getCOM());
    return sum;
  }
  std::vector<Transform<double>> pose(int figure) const override {
    std::vector<Transform<double>> out;
    for (const BodyNode* body : figures_[figure]->getBodyNodes())
      out.push_back({Quat<double>(body->getTransform().linear()), body->getTransform().translation()});
    return out;
  }

 private:
  static void add_shape(BodyNode* body, const dart::dynamics::ShapePtr& shape, const Transform<double>& at,
                        double friction) {
    auto* node =
        body->createShapeNodeWith<dart::dynamics::CollisionAspect, dart::dynamics::DynamicsAspect>(shape);
    node->setRelativeTransform(isometry(at.rotation, at.translation));
    node->getDynamicsAspect()->setFrictionCoeff(friction);
  }
  void add_ground() {
    const auto skeleton = dart::dynamics::Skeleton::create("ground");
    BodyNode* body = skeleton->createJointAndBodyNodePair<dart::dynamics::WeldJoint>().second;
    const Vec3<double> size(100, 100, 10);  // m
    add_shape(body, std::make_shared<dart::dynamics::BoxShape>(size),
              {Quat<double>::Identity(), {0, 0, -size.z() / 2}}, 1);  // of two surfaces the smoother counts
    world_->addSkeleton(skeleton);
  }
  static void add_collider(BodyNode* body, const Collider& c) {
    if (c.shape == Shape::kBox) {
      add_shape(body, std::make_shared<dart::dynamics::BoxShape>(2 * c.size), c.local, c.friction);
      return;
    }
    const auto ball = std::make_shared<dart::dynamics::SphereShape>(c.size.x());
    const double half = c.shape == Shape::kCapsule ? c.size.z() : 0;
    add_shape(body, ball, {c.local.rotation, c.local * Vec3<double>(0, 0, half)}, c.friction);
    if (half > 0) add_shape(body, ball, {c.local.rotation, c.local * Vec3<double>(0, 0, -half)}, c.friction);
  }

  /// Servos and the root's velocity for the next step.
  void drive(std::size_t f) {
    const double h = world_->getTimeStep();
    const Skeleton& s = scene_.figures[f].skeleton;
    const std::vector<Transform<double>> model = pose(static_cast<int>(f));
    const Eigen::Isometry3d move = isometry(model[0].rotation, model[0].translation).inverse() *
                                   isometry(servos_[f].target(0).rotation, servos_[f].target(0).translation);
    Eigen::Matrix<double, 6, 1> root;  // body axes, angular first; turned and moved one by one
    root << dart::math::logMap(move.linear()), move.translation();
    figures_[f]->getJoint(0)->setCommands(root / h);
    for (int i = 1; i < s.body_count; ++i) {
      const Joint& joint = s.joints[i];
      dart::dynamics::Joint* servo = figures_[f]->getJoint(i);
      const bool hinge = joint.type == JointType::kRevolute;
      const Vec3<double> wanted =
          servos_[f].rate(i, model[joint.parent].rotation.conjugate() * model[i].rotation, h);
      if (hinge)
        servo->setCommand(0, wanted.dot(joint.axis));
      else
        servo->setCommands(wanted);
    }
    servos_[f].advance();
  }

  static void motorise(dart::dynamics::Joint* servo, const Joint& joint) {
    if (joint.parent < 0) {
      servo->setActuatorType(dart::dynamics::Joint::VELOCITY);
      return;
    }
    servo->setActuatorType(dart::dynamics::Joint::SERVO);
    for (int k = 0; k < dof_count(joint.type); ++k) {
      servo->setForceLowerLimit(k, -joint.dofs[k].torque_minus);
      servo->setForceUpperLimit(k, joint.dofs[k].torque_plus);
    }
  }

  void add(const Figure& figure) {
    const auto skeleton = dart::dynamics::Skeleton::create("figure" + std::to_string(figures_.size()));
    std::vector<BodyNode*> bodies;
    for (int i = 0; i < figure.skeleton.body_count; ++i) {
      const Joint& joint = figure.skeleton.joints[i];
      const JointJet<double>& jet = figure.jets[i];
      const BodyNode::AspectProperties body(
          joint.name);  // names of its own: it speaks when it must make them up
      BodyNode* parent = joint.parent < 0 ? nullptr : bodies[joint.parent];
      const Eigen::Isometry3d rest = isometry(joint.rest.rotation, joint.rest.translation);
      const Quat<double> turn = joint.rest.rotation.conjugate() * jet.rotation;
      if (joint.type == JointType::kFree) {
        const auto made =
            skeleton->createJointAndBodyNodePair<FreeJoint>(parent, named<FreeJoint>(joint), body);
        made.first->setPositions(FreeJoint::convertToPositions(isometry(jet.rotation, jet.translation)));
        Eigen::Matrix<double, 6, 1> velocity;  // body axes, angular first
        velocity << jet.omega, jet.rotation.conjugate() * jet.velocity;
        made.first->setVelocities(velocity);
        bodies.push_back(made.second);
      } else if (joint.type == JointType::kBall) {
        const auto made =
            skeleton->createJointAndBodyNodePair<BallJoint>(parent, named<BallJoint>(joint), body);
        made.first->setTransformFromParentBodyNode(rest);
        made.first->setPositions(BallJoint::convertToPositions(turn.toRotationMatrix()));
        made.first->setVelocities(jet.omega);
        bodies.push_back(made.second);
      } else {
        const auto made =
            skeleton->createJointAndBodyNodePair<RevoluteJoint>(parent, named<RevoluteJoint>(joint), body);
        made.first->setTransformFromParentBodyNode(rest);
        made.first->setAxis(joint.axis);
        made.first->setPosition(0, 2 * std::atan2(turn.vec().dot(joint.axis), turn.w()));
        made.first->setVelocity(0, jet.omega.dot(joint.axis));
        bodies.push_back(made.second);
      }
      bodies.back()->setInertia(dart::dynamics::Inertia(joint.mass, joint.center_of_mass, joint.inertia));
      if (figure.driven) motorise(bodies.back()->getParentJoint(), joint);
    }
    for (const Collider& c : figure.skeleton.colliders)
      if (scene_.ground && c.joint < figure.skeleton.body_count) add_collider(bodies[c.joint], c);
    figures_.push_back(skeleton);
    servos_.emplace_back(figure);
    world_->addSkeleton(skeleton);
  }

  std::string refusal_;
  double most_ = 0;  ///< J, far beyond what the scene can hold
  EngineScene scene_;
  dart::simulation::WorldPtr world_;
  std::vector<dart::dynamics::SkeletonPtr> figures_;
  std::vector<Servo> servos_;
};

template <bool pgs>
std::unique_ptr<Engine> make(const EngineScene& scene, double h, const Accuracy&) {
  return std::make_unique<DartEngine>(scene, h, pgs);
}

}  // namespace

std::vector<EngineOption> dart_options() {
  return {{"DART", "Euler PGS", make<true>}, {"DART", "Euler Dantzig", make<false>}};
}

}  // namespace sinew::study
