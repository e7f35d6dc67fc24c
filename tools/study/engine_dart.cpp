// DART (Debian's libdart-dev) on the study's scenes without contact: semi-implicit Euler in generalised
// coordinates, its only integrator.
#include <cmath>
#include <dart/dynamics/BallJoint.hpp>
#include <dart/dynamics/BodyNode.hpp>
#include <dart/dynamics/FreeJoint.hpp>
#include <dart/dynamics/RevoluteJoint.hpp>
#include <dart/dynamics/Skeleton.hpp>
#include <dart/simulation/World.hpp>

#include "study/engine.h"

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
  DartEngine(const EngineScene& scene, double h) : world_(dart::simulation::World::create()) {
    refusal_ = needs_contacts_or_muscles(scene);
    world_->setTimeStep(h);
    world_->setGravity(scene.gravity);
    for (std::size_t f = 0; refusal_.empty() && f < scene.figures.size(); ++f) add(scene.figures[f]);
    for (const auto& figure : figures_)
      most_ += 1e4 * (figure->computeKineticEnergy() + 10 * figure->getMass());
  }

  const std::string& refusal() const override { return refusal_; }
  bool step() override {
    // A state that is no number any more ends the whole program in DART's assertions: stop well before.
    if (!(std::abs(energy()) < most_)) return false;
    world_->step();
    return true;
  }
  void aim(int, const std::vector<JointJet<double>>&) override {}
  void push(int figure, int joint, const Vec3<double>& impulse) override {
    figures_[figure]->getBodyNode(joint)->addExtForce(impulse / world_->getTimeStep());
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
    }
    figures_.push_back(skeleton);
    world_->addSkeleton(skeleton);
  }

  std::string refusal_;
  double most_ = 0;  ///< J, far beyond what the scene can hold
  dart::simulation::WorldPtr world_;
  std::vector<dart::dynamics::SkeletonPtr> figures_;
};

std::unique_ptr<Engine> make(const EngineScene& scene, double h, const Accuracy&) {
  return std::make_unique<DartEngine>(scene, h);
}

}  // namespace

std::vector<EngineOption> dart_options() {
  return {{"DART", "semi-implicit Euler", make}};
}

}  // namespace sinew::study
