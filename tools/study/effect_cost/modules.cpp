#include "study/effect_cost/modules.h"

#include "sinew/effects/buoyancy.h"
#include "sinew/effects/force_field.h"
#include "sinew/effects/joint_spring.h"
#include "sinew/effects/wind.h"

namespace sinew::study {

std::unique_ptr<Effect<float>> make_module(const std::string& name, const std::vector<std::string>& joints) {
  if (name == "wind") {
    WindSettings breeze;
    breeze.velocity = {5, 1, 0};
    breeze.joints = joints;
    return std::make_unique<Wind<float>>(breeze);
  }
  if (name == "buoyancy") {
    BuoyancySettings sea;
    sea.level = 100;
    sea.flow = {0.5, 0.1, 0};
    sea.joints = joints;
    return std::make_unique<Buoyancy<float>>(sea);
  }
  if (name == "joint_spring") {
    JointSpringSettings spring;
    spring.damping = 1;
    spring.joints = joints;
    return std::make_unique<JointSpring<float>>(spring);
  }
  if (name == "force_field") {
    ForceFieldSettings pull;
    pull.center = {3, 2, 1};
    pull.acceleration = 2;
    pull.joints = joints;
    return std::make_unique<ForceField<float>>(pull);
  }
  return nullptr;
}

}  // namespace sinew::study
