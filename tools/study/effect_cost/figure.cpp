#include "study/effect_cost/figure.h"

#include "sinew/skeleton/rotation.h"

namespace sinew::study {

Collider rod_capsule() {
  Collider capsule;
  capsule.shape = Shape::kCapsule;
  capsule.local = {rotation_between<double>(Vec3<double>::UnitZ(), Vec3<double>::UnitX()), {0.5, 0, 0}};
  capsule.size = {0.05, 0.05, 0.4};
  return capsule;
}

Skeleton wheel(const BuiltIn& on, double height) {
  Skeleton s;
  s.name = "wheel";
  Joint hub;
  hub.name = "hub";
  hub.mass = 1;
  hub.rest.translation = {0, 0, height};
  hub.inertia.setIdentity();
  s.joints.push_back(hub);
  for (int i = 0; i < kRods; ++i) {
    Joint rod;
    rod.name = "rod" + std::to_string(i);
    rod.parent = 0;
    rod.type = JointType::kRevolute;
    rod.rest.rotation = Eigen::AngleAxisd(2 * 3.14159265358979 * i / kRods, Vec3<double>::UnitZ());
    rod.axis = Vec3<double>::UnitY();
    rod.mass = 1;
    rod.center_of_mass = {0.5, 0, 0};
    rod.inertia = Vec3<double>(0.001, 0.08, 0.08).asDiagonal();
    DofLimits& dof = rod.dofs[0];
    dof.torque_minus = dof.torque_plus = i < on.muscles ? 1e6 : 0;
    dof.dry_friction = i < on.dry_friction ? 1 : 0;
    dof.damping = i < on.damping ? 1 : 0;
    if (i < on.limits) dof.lower = 0.1;  // borne at angle 0
    s.joints.push_back(rod);
    if (i >= on.colliders) continue;
    s.colliders.push_back(rod_capsule());
    s.colliders.back().joint = i + 1;
  }
  s.body_count = static_cast<int>(s.joints.size());
  return s;
}

std::vector<std::string> first_rods(int count) {
  std::vector<std::string> names;
  for (int i = 0; i < count; ++i) names.push_back("rod" + std::to_string(i));
  if (count == 0) names.emplace_back("hub");  // declared where there is nothing to act on
  return names;
}

std::vector<JointJet<float>> at_rest(const Skeleton& s) {
  std::vector<JointJet<float>> jets(s.joints.size());
  for (std::size_t i = 0; i < jets.size(); ++i) {
    jets[i].rotation = s.joints[i].rest.rotation.cast<float>();
    jets[i].translation = s.joints[i].rest.translation.cast<float>();
  }
  return jets;
}

}  // namespace sinew::study
