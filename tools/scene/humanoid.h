// A 14-body, 37-DOF humanoid built in code: the seed talk's breakdown, simple shapes, 75 kg. Standing, Z up,
// X forward.
#pragma once

#include <string>

#include "sinew/skeleton/skeleton.h"

namespace sinew::scene {

/// Solid capsule along −z below the joint: mass, length and radius in kg and m.
inline void add_capsule_body(Skeleton& s, const char* name, int parent, JointType type,
                             const Vec3<double>& at, double mass, double length, double radius,
                             double torque) {
  Joint joint;
  joint.name = name;
  joint.parent = parent;
  joint.type = type;
  joint.rest.translation = at;
  joint.axis = Vec3<double>::UnitY();
  joint.mass = mass;
  joint.center_of_mass = {0, 0, -length / 2};
  const double across = mass * (3 * radius * radius + length * length) / 12,
               along = mass * radius * radius / 2;
  joint.inertia = Vec3<double>(across, across, along).asDiagonal();
  for (DofLimits& dof : joint.dofs) {
    dof.torque_minus = dof.torque_plus = torque;
    dof.damping = 0;
  }
  s.joints.push_back(joint);
  Collider c;
  c.joint = static_cast<int>(s.joints.size()) - 1;
  c.shape = Shape::kCapsule;
  c.local.translation = {0, 0, -length / 2};
  c.size = {radius, radius, std::max(0.0, length / 2 - radius)};
  s.colliders.push_back(c);
}

inline Skeleton humanoid() {
  Skeleton s;
  s.name = "humanoid";
  add_capsule_body(s, "chest", -1, JointType::kFree, {0, 0, 1.42}, 26, 0.36, 0.13, 0);
  add_capsule_body(s, "pelvis", 0, JointType::kBall, {0, 0, -0.36}, 12, 0.2, 0.11, 250);
  for (const double side : {1.0, -1.0}) {
    const std::string tail = side > 0 ? "_l" : "_r";
    const int pelvis = 1;
    add_capsule_body(s, ("thigh" + tail).c_str(), pelvis, JointType::kBall, {0, side * 0.09, -0.14}, 10.5,
                     0.43, 0.075, 220);
    const int thigh = static_cast<int>(s.joints.size()) - 1;
    add_capsule_body(s, ("shin" + tail).c_str(), thigh, JointType::kRevolute, {0, 0, -0.43}, 3.3, 0.41, 0.05,
                     240);
    add_capsule_body(s, ("foot" + tail).c_str(), thigh + 1, JointType::kBall, {0, 0, -0.41}, 1.1, 0.08, 0.04,
                     180);
    Joint& foot = s.joints.back();
    foot.center_of_mass = {0.05, 0, -0.04};
    foot.inertia = Vec3<double>(0.001, 0.006, 0.006).asDiagonal();
    Collider& box = s.colliders.back();
    box.shape = Shape::kBox;
    box.local.translation = {0.06, 0, -0.05};
    box.size = {0.13, 0.045, 0.03};
  }
  for (const double side : {1.0, -1.0}) {
    const std::string tail = side > 0 ? "_l" : "_r";
    add_capsule_body(s, ("upperarm" + tail).c_str(), 0, JointType::kBall, {0, side * 0.2, -0.05}, 2.1, 0.29,
                     0.045, 70);
    const int arm = static_cast<int>(s.joints.size()) - 1;
    add_capsule_body(s, ("forearm" + tail).c_str(), arm, JointType::kRevolute, {0, 0, -0.29}, 1.25, 0.26,
                     0.038, 60);
    add_capsule_body(s, ("hand" + tail).c_str(), arm + 1, JointType::kBall, {0, 0, -0.26}, 0.45, 0.14, 0.03,
                     12);
  }
  s.body_count = static_cast<int>(s.joints.size());
  return s;
}

}  // namespace sinew::scene
