#include "scene/bodies.h"

#include <cmath>
#include <string>

#include "scene/humanoid.h"

namespace sinew::scene {

Vec3<double> box_inertia(double mass, const Vec3<double>& size) {
  const Vec3<double> square = size.cwiseProduct(size) * (mass / 12);
  return {square.y() + square.z(), square.x() + square.z(), square.x() + square.y()};
}

Skeleton free_body(double mass, const Vec3<double>& inertia) {
  Skeleton s;
  s.name = "body";
  s.body_count = 1;
  Joint& joint = s.joints.emplace_back();
  joint.name = "body";
  joint.type = JointType::kFree;
  joint.mass = mass;
  joint.inertia = inertia.asDiagonal();
  make_frictionless(s);
  return s;
}

Skeleton box_body(double mass, const Vec3<double>& size, double friction) {
  Skeleton s = free_body(mass, box_inertia(mass, size));
  Collider& c = s.colliders.emplace_back();
  c.shape = Shape::kBox;
  c.size = size / 2;
  c.friction = friction;
  return s;
}

Skeleton ball_body(double mass, double radius, double friction) {
  Skeleton s = free_body(mass, Vec3<double>::Constant(0.4 * mass * radius * radius));
  Collider& c = s.colliders.emplace_back();
  c.shape = Shape::kSphere;
  c.size = Vec3<double>::Constant(radius);
  c.friction = friction;
  return s;
}

Skeleton chain(const ChainShape& shape) {
  Skeleton s;
  s.name = "chain";
  for (int i = 0; i < shape.links; ++i) {
    const double share = shape.links > 1 ? double(i) / (shape.links - 1) : 0;
    const double mass = shape.first_mass * std::pow(shape.last_mass / shape.first_mass, share);
    add_capsule_body(s, ("link" + std::to_string(i)).c_str(), i - 1, i == 0 ? shape.root : shape.joint,
                     {0, 0, i == 0 ? 0 : -shape.length}, mass, shape.length, shape.radius, 0);
  }
  s.body_count = shape.links;
  if (!shape.colliders) s.colliders.clear();
  make_frictionless(s);
  return s;
}

void make_frictionless(Skeleton& skeleton) {
  for (Joint& joint : skeleton.joints)
    for (DofLimits& dof : joint.dofs) dof.dry_friction = dof.damping = 0;
}

}  // namespace sinew::scene
