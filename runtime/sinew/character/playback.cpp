#include "sinew/character/playback.h"

#include <cmath>

#include "sinew/effects/support.h"

namespace sinew {

template <class T>
bool play(CharacterState<T>& s, const WorldSettings& world, T h) {
  TreeProblem<T>& p = s.problem;
  const Vec3<T> origin = s.model[0].translation;
  inertial_wrenches<T>(s.tree, s.target, world.gravity.template cast<T>(), origin, p.kinematics, s.motion,
                       p.force, p.moment);
  for (const ExternalForce<T>& j : s.impulses) {
    const Vec3<T> x = p.kinematics.origin[j.body] + p.kinematics.rotation[j.body] * j.local;
    p.force[j.body] -= j.force / h;
    p.moment[j.body] -= x.cross(j.force / h);
  }
  if (world.ground && s.settings.ground_contact)
    share_support<T>(s.tree, p.kinematics, s.points, T(world.ground_height) - origin.z(), {}, p.force,
                     p.moment);
  project_wrenches<T>(s.tree, p.kinematics, p.force, p.moment, p.gradient);
  const int root_dofs = s.tree.type[0] == JointType::kFree ? s.tree.dof_count(0) : 0;
  for (int dof = s.root_is_kinematic() ? root_dofs : 0; dof < s.tree.dofs; ++dof) {
    const T torque = p.gradient[dof];
    const T limit = torque >= T(0) ? p.law.torque_plus[dof] : p.law.torque_minus[dof];
    if (std::abs(torque) > limit) return false;
  }
  for (int dof = 0; dof < s.tree.dofs; ++dof) {
    const T torque = p.gradient[dof];
    s.torque[dof] = torque;
    s.limit[dof] = torque >= T(0) ? p.law.torque_plus[dof] : p.law.torque_minus[dof];
    s.load[dof] = s.limit[dof] > T(0) && std::isfinite(s.limit[dof]) ? std::abs(torque) / s.limit[dof] : T(0);
    s.unknown[dof] = 0;
  }
  for (int i = 0; i < s.tree.bodies; ++i) {
    const Transform<T> before = s.local[i];
    s.local[i] = {s.target[i].rotation, s.target[i].translation};
    s.rate[i] = joint_offset_value<T>(s.tree, i, before, s.local[i]);
    for (T& r : s.rate[i]) r /= h;
  }
  for (std::size_t i = s.tree.bodies; i < s.local.size(); ++i)
    s.local[i] = {s.target[i].rotation, s.target[i].translation};
  s.update_model();
  advance_exactly<T>(s.tree, p.kinematics, s.motion, h, origin, s.history);
  s.rate_step = T(0);
  s.contact_signature = s.limit_signature = 0;
  s.steps_unchanged = 0;
  s.energy_ceiling = std::numeric_limits<double>::infinity();
  s.report = {};
  s.report.dofs = s.tree.dofs;
  s.report_totals(world.gravity);
  return true;
}

template bool play<float>(CharacterState<float>&, const WorldSettings&, float);
template bool play<double>(CharacterState<double>&, const WorldSettings&, double);

}  // namespace sinew
