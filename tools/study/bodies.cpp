#include "study/bodies.h"

#include <cmath>
#include <random>

#include "sinew/skeleton/rotation.h"
#include "study/humanoid.h"

namespace sinew::study {

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

CharacterSettings limp() {
  CharacterSettings settings;
  settings.root = RootDrive::kFree;
  settings.strength = 0;
  return settings;
}

WorldSettings weightless() {
  WorldSettings settings;
  settings.gravity.setZero();
  settings.ground = false;
  return settings;
}

template <class T>
void bend(const Skeleton& skeleton, std::vector<JointJet<T>>& jets, int joint, const Vec3<double>& rotation) {
  jets[joint].rotation =
      (skeleton.joints[joint].rest.rotation * rotation_exp<double>(rotation)).template cast<T>();
}

template <class T>
void randomise_speeds(const Skeleton& skeleton, std::vector<JointJet<T>>& jets, double rms, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal(0, rms);
  for (std::size_t i = 0; i < jets.size(); ++i) {
    const Joint& joint = skeleton.joints[i];
    const Vec3<double> spin(normal(random), normal(random), normal(random));
    if (joint.type == JointType::kRevolute)
      jets[i].omega = (joint.axis * spin.dot(joint.axis)).template cast<T>();
    if (joint.type == JointType::kBall || joint.type == JointType::kFree)
      jets[i].omega = spin.template cast<T>();
  }
}

template <class T>
int add_thrown_humanoid(Stage<T>& stage, double height, double rms, unsigned seed) {
  Skeleton body = humanoid();
  make_frictionless(body);
  std::vector<JointJet<T>> jets = rest_jets<T>(body);
  jets[0].translation.z() += T(height);
  randomise_speeds(body, jets, rms, seed);
  return stage.add(body, limp(), jets);
}

Collider obstacle_box(const Vec3<double>& center, const Vec3<double>& half, double friction) {
  Collider c;
  c.shape = Shape::kBox;
  c.local.translation = center;
  c.size = half;
  c.friction = friction;
  return c;
}

#define SINEW_STUDY_BODIES(T)                                                                      \
  template void bend<T>(const Skeleton&, std::vector<JointJet<T>>&, int, const Vec3<double>&);     \
  template void randomise_speeds<T>(const Skeleton&, std::vector<JointJet<T>>&, double, unsigned); \
  template int add_thrown_humanoid<T>(Stage<T>&, double, double, unsigned);
SINEW_STUDY_BODIES(float)
SINEW_STUDY_BODIES(double)

}  // namespace sinew::study
