#include "sinew/character/state.h"

#include <algorithm>
#include <cmath>

namespace sinew {

template <class T>
CharacterState<T>::CharacterState(const Skeleton& s, const CharacterSettings& c)
    : skeleton(s),
      tree(skeleton),
      settings(c),
      target(s.joints.size()),
      target_before(s.joints.size()),
      local(s.joints.size()),
      model(s.joints.size()),
      rate(s.body_count),
      deviation(s.body_count),
      joint_strength(s.body_count, T(1)),
      torque(tree.dofs, T(0)),
      load(tree.dofs, T(0)),
      limit(tree.dofs, T(0)),
      unknown(tree.dofs, 0),
      problem(tree, skeleton),
      history(tree.bodies),
      motion(tree),
      wanted(tree.bodies) {
  impulses.reserve(64);
  for (std::size_t i = 0; i < skeleton.joints.size(); ++i) {
    const Transform<T> rest = skeleton.joints[i].rest.template cast<T>();
    target[i].rotation = rest.rotation;
    target[i].translation = rest.translation;
  }
  target_before = target;
  for (const Collider& collider : skeleton.colliders) {
    Collider on_body = collider;
    while (on_body.joint >= skeleton.body_count) {
      on_body.local = skeleton.joints[on_body.joint].rest * on_body.local;
      on_body.joint = skeleton.joints[on_body.joint].parent;
    }
    append_contact_points<T>(on_body, points);
  }
  report.dofs = tree.dofs;
  refresh_limits();
  reset_to_target(Vec3<T>::Zero());
  radius = T(0.1);
  for (const ContactPoint<T>& p : points)
    radius = std::max(radius, (model[p.body] * p.local - model[0].translation).norm() + p.radius);
}

template <class T>
void CharacterState<T>::refresh_limits() {
  const auto scaled = [](double limit_at_rest, T strength) {
    return limit_at_rest > 0 ? T(limit_at_rest) * strength : T(0);
  };
  for (int i = 0; i < tree.bodies; ++i) {
    const Joint& joint = skeleton.joints[i];
    const bool root = joint.type == JointType::kFree;
    const T strength = T(settings.strength) * joint_strength[i];
    for (int k = 0; k < tree.dof_count(i); ++k) {
      const int dof = tree.first_dof[i] + k;
      T minus = scaled(joint.dofs[k].torque_minus, strength),
        plus = scaled(joint.dofs[k].torque_plus, strength);
      if (root) {
        const bool assisted = settings.root == RootDrive::kAssisted && !is_prop;
        minus = plus = assisted ? T(k < 3 ? settings.root_force : settings.root_torque) : T(0);
      }
      problem.law.torque_minus[dof] = minus;
      problem.law.torque_plus[dof] = plus;
    }
  }
}

template <class T>
void CharacterState<T>::update_model() {
  for (std::size_t i = 0; i < local.size(); ++i) {
    const int parent = skeleton.joints[i].parent;
    model[i] = parent < 0 ? local[i] : model[parent] * local[i];
    model[i].rotation.normalize();
  }
}

template <class T>
void CharacterState<T>::reset_to_target(const Vec3<T>& gravity) {
  for (std::size_t i = 0; i < local.size(); ++i) local[i] = {target[i].rotation, target[i].translation};
  target_before = target;
  update_model();
  inertial_wrenches<T>(tree, target, gravity, Vec3<T>::Zero(), problem.kinematics, motion, problem.force,
                       problem.moment);
  advance_exactly<T>(tree, problem.kinematics, motion, T(0), Vec3<T>::Zero(), history);
  history.step_before = T(0);
  for (int i = 0; i < tree.bodies; ++i) {
    deviation[i] = {};
    const Vec3<T>& w = target[i].omega;
    const Vec3<T>& v = target[i].velocity;
    rate[i] = {};
    switch (tree.type[i]) {
      case JointType::kRevolute:
        rate[i][0] = tree.axis[i].dot(w);
        break;
      case JointType::kBall:
        rate[i] = {w.x(), w.y(), w.z()};
        break;
      case JointType::kFree:
        rate[i] = {v.x(), v.y(), v.z(), w.x(), w.y(), w.z()};
        break;
      default:
        break;  // starts from rest: only the first guess of the first step
    }
  }
  contact_signature = limit_signature = 0;
  steps_unchanged = 0;
  std::fill(unknown.begin(), unknown.end(), std::uint8_t{0});
}

template <class T>
bool CharacterState<T>::undisturbed() const {
  if (is_prop) return false;
  return std::all_of(deviation.begin(), deviation.end(),
                     [](const Deviation<T>& d) { return d.on_animation && !d.released; });
}

template <class T>
int CharacterState<T>::body_of(int joint) const {
  while (joint >= skeleton.body_count) joint = skeleton.joints[joint].parent;
  return joint;
}

template struct CharacterState<float>;
template struct CharacterState<double>;

}  // namespace sinew
