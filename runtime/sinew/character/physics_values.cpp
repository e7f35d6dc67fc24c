#include "sinew/character/physics_values.h"

#include <algorithm>
#include <cmath>

#include "sinew/animation/moving_transform.h"
#include "sinew/character/playback.h"
#include "sinew/character/state.h"
#include "sinew/skeleton/portable_math.h"

namespace sinew {
namespace {

constexpr double kEarth = 9.81;  ///< m/s²

template <class T>
T greatest_load(const CharacterState<T>& s, int joint) {
  T most = T(0);
  for (int dof = s.tree.first_dof[joint]; dof < s.tree.first_dof[joint + 1]; ++dof)
    most = std::max(most, s.load[dof]);
  return most;
}

/// Where a body's centre of mass would be in the pose that the animation wanted.
template <class T>
Vec3<double> wanted_center(const CharacterState<T>& s, int body) {
  Vec3<double> at = s.tree.center_of_mass[body].template cast<double>();
  for (int j = body; j >= 0; j = s.tree.parent[j]) {
    const JointJet<T>& jet = s.last_target()[j];
    at = jet.rotation.template cast<double>() * at + jet.translation.template cast<double>();
  }
  return at;
}

template <class T>
double off_animation(CharacterState<T>& s) {
  if (s.undisturbed() || s.parked) return 0;
  const std::vector<Transform<T>>& model = s.model();
  double sum = 0;
  for (int i = 0; i < s.tree.bodies; ++i) {
    const Vec3<T> center = model[i] * s.tree.center_of_mass[i];
    sum += double(s.tree.mass[i]) * (center.template cast<double>() - wanted_center(s, i)).squaredNorm();
  }
  return std::sqrt(sum / s.total_mass);
}

/// A body's joint frame in the world, as its history has it.
template <class T>
JointJet<T> motion_of(const CharacterState<T>& s, int body) {
  const History<T>& h = s.history;
  const Mat3<T>& r = h.rotation[body];
  const Vec3<T> omega = angular_velocity(h, body);
  Vec3<T> alpha = Vec3<T>::Zero(), acceleration = Vec3<T>::Zero();
  const Vec3<T> lever = r * s.tree.center_of_mass[body];
  if (h.accelerates) {
    const Vec3<T> couple = h.torque[body] - omega.cross(h.momentum[body]);
    alpha = r * (s.tree.inverse_inertia[body] * (r.transpose() * couple));
    acceleration = h.acceleration[body] - alpha.cross(lever) - omega.cross(omega.cross(lever));
  }
  JointJet<T> out;
  out.rotation = Quat<T>(r).normalized();
  out.translation = h.center[body] - lever;  // from the root's origin
  out.omega = r.transpose() * omega;
  out.alpha = r.transpose() * alpha;
  out.velocity = h.velocity[body] - omega.cross(lever);
  out.acceleration = acceleration;
  return out;
}

/// What is left of a motion relative to the parent's where the joint's type allows no more.
template <class T>
void keep_to_joint(const Tree<T>& tree, int body, JointJet<T>& jet) {
  const JointType type = tree.type[body];
  if (type == JointType::kRevolute) {
    const Vec3<T>& axis = tree.axis[body];
    jet.omega = axis * axis.dot(jet.omega);
    jet.alpha = axis * axis.dot(jet.alpha);
  }
  if (type == JointType::kFixed || type == JointType::kTranslation || type == JointType::kPrismatic)
    jet.omega.setZero(), jet.alpha.setZero();
  const bool slides = type == JointType::kFree || type == JointType::kTranslation ||
                      type == JointType::kPlanar || type == JointType::kPrismatic;
  if (!slides) jet.velocity.setZero(), jet.acceleration.setZero();
}

}  // namespace

template <class T>
PhysicsValues<T> physics_values(const Character<T>& character, std::span<T> joint_load) {
  PhysicsValues<T> out;
  std::fill(joint_load.begin(), joint_load.end(), T(0));
  out.joint_load = joint_load;
  CharacterState<T>* s = state_of(character);
  if (!s) return out;
  s->keep_loads();
  for (int j = 0; j < s->tree.bodies; ++j) {
    const T load = greatest_load(*s, j);
    out.load = std::max(out.load, load);
    if (std::size_t(j) < joint_load.size()) joint_load[std::size_t(j)] = load;
  }
  const Transform<double>& rest = s->skeleton.joints[0].rest;
  const Quat<double> turned = s->local[0].rotation.template cast<double>() * rest.rotation.conjugate();
  const Vec3<double> up =
      turned.conjugate() * Vec3<double>::UnitZ();  // in the axes that are the world's at rest
  out.tilt = T(portable::atan2(portable::hypot(up.x(), up.y()), up.z()));
  out.face_up = T(up.x());
  const double ground = character.animation_ground().value_or(0) +
                        (character.animation_ground() ? character.displacement().z : 0);
  if (rest.translation.z() > 0) out.height = T((s->history.place.z() - ground) / rest.translation.z());
  out.off_animation = T(off_animation(*s));
  out.contacts = T(s->report.contacts);
  out.contact_force = T(s->report.contact_force / (s->total_mass * kEarth));
  return out;
}

template <class T>
void physical_motion(const Character<T>& character, std::span<JointJet<T>> out) {
  CharacterState<T>* s = state_of(character);
  if (!s) return;
  const std::size_t bodies = std::size_t(s->tree.bodies), joints = std::min(out.size(), s->local.size());
  const bool moves = joints >= bodies && !s->parked;
  if (moves) {
    synchronise(*s, out);
    for (std::size_t j = 0; j < bodies; ++j) out[j] = motion_of(*s, static_cast<int>(j));
    for (std::size_t j = bodies; j-- > 1;) {  // from the leaves: parents are still in the world
      const MovingTransform<T> parent = moving_transform(out[std::size_t(s->tree.parent[j])]);
      out[j] = joint_jet<T>(parent.inverse() * moving_transform(out[j]));
      keep_to_joint(s->tree, static_cast<int>(j), out[j]);
    }
  }
  for (std::size_t j = 0; j < joints; ++j) {
    if (!moves || j >= bodies) out[j] = {};
    out[j].rotation = s->local[j].rotation;
    out[j].translation = s->local[j].translation;
  }
}

SINEW_PHYSICS_VALUES_INSTANCES(, float)
SINEW_PHYSICS_VALUES_INSTANCES(, double)

}  // namespace sinew
