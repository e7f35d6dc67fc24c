#include "sinew/character/memory.h"

namespace sinew {
namespace {

template <class... Vectors>
std::size_t held(const Vectors&... v) {
  return (std::size_t{0} + ... + bytes_held(v));
}

template <class T>
std::size_t held_by(const Kinematics<T>& k) {
  return held(k.rotation, k.origin, k.center, k.w, k.v);
}

}  // namespace

template <class T>
std::size_t bytes_of(const Rig<T>& rig) {
  const Tree<T>& t = rig.tree;
  return sizeof rig + held(rig.skeleton.joints, rig.skeleton.colliders, rig.skeleton.muscles) +
         held(t.parent, t.type, t.first_dof, t.dof_body, t.dof_parent, t.rest, t.axis, t.axis2, t.mass,
              t.center_of_mass, t.inertia, t.first_moment, t.inertia_at_joint, t.parent_axes, t.by_depth,
              t.second_moment, t.inverse_inertia) +
         held(rig.colliders, rig.bound_center, rig.bound_radius, rig.points, rig.first_point, rig.may_touch,
              rig.bakes) +
         held(rig.support.points, rig.support.first, rig.support.limb, rig.support.bound);
}

template <class T>
std::size_t bytes_of(const CharacterState<T>& s) {
  const TreeProblem<T>& p = s.problem;
  const JointLaw<T>& law = p.law;
  return sizeof s +
         held(s.target, s.target_before, s.local, s.model_pose, s.played_from, s.rate, s.rate_before,
              s.deviation, s.joint_strength, s.muscle_strength, s.activation, s.torque, s.load, s.limit,
              s.smooth, s.lasting, s.lasting_before, s.unknown, s.impulses, s.forces, s.baked, s.wanted) +
         held(law.torque_minus, law.torque_plus, law.dry_friction, law.damping, law.lower, law.upper,
              law.swing_limit, law.swing_axis, law.twist_lower, law.twist_upper, law.ellipsoidal, law.tone) +
         held(p.prediction.center, p.prediction.rotation, p.prediction.momentum) +
         held(p.local, p.target, p.start, p.free, p.pushes, p.force, p.moment, p.body_force, p.couple,
              p.gradient, p.rows, p.ellipsoids, p.composite, p.joint_curvature) +
         held_by(p.kinematics) + held_by(s.guessed) + bytes_held(s.history) + bytes_held(s.motion);
}

template <class T>
std::size_t bytes_of(const Coupling<T>& c) {
  return sizeof c + held(c.nodes, c.stencils, c.tetrahedra);
}

template std::size_t bytes_of<float>(const Rig<float>&);
template std::size_t bytes_of<double>(const Rig<double>&);
template std::size_t bytes_of<float>(const CharacterState<float>&);
template std::size_t bytes_of<double>(const CharacterState<double>&);
template std::size_t bytes_of<float>(const Coupling<float>&);
template std::size_t bytes_of<double>(const Coupling<double>&);

}  // namespace sinew
