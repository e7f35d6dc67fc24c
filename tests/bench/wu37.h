// The seed talk's 37-DOF humanoid from ../shared/models/wu37.xml, read by MuJoCo and handed to both engines:
// one file, one model.
#pragma once

#include <mujoco/mujoco.h>

#include <memory>
#include <stdexcept>
#include <string>

#include "sinew/skeleton/skeleton.h"

namespace sinew::bench {

struct FreeMujoco {
  void operator()(mjModel* m) const { mj_deleteModel(m); }
  void operator()(mjData* d) const { mj_deleteData(d); }
};
using ModelPointer = std::unique_ptr<mjModel, FreeMujoco>;
using DataPointer = std::unique_ptr<mjData, FreeMujoco>;

inline ModelPointer load_wu37() {
  mju_user_warning = [](const char*) {};  // counted by the caller; else printed and logged to a file
  char why[500] = "";
  ModelPointer model(mj_loadXML(SINEW_SHARED_DIR "/models/wu37.xml", nullptr, why, sizeof why));
  if (!model) throw std::runtime_error(why);
  return model;
}

/// MuJoCo's model as a skeleton. Muscles bear `torque` N·m per degree of freedom; no damping, no dry
/// friction.
inline Skeleton skeleton_of(const mjModel& m, double torque) {
  const auto vector = [](const mjtNum* x) { return Vec3<double>(x[0], x[1], x[2]); };
  const auto rotation = [](const mjtNum* q) { return Quat<double>(q[0], q[1], q[2], q[3]); };
  Skeleton s;
  s.name = "wu37";
  s.body_count = m.nbody - 1;  // without the world
  for (int b = 1; b < m.nbody; ++b) {
    Joint& joint = s.joints.emplace_back();
    joint.name = mj_id2name(&m, mjOBJ_BODY, b);
    joint.parent = m.body_parentid[b] - 1;
    joint.rest = {rotation(m.body_quat + 4 * b), vector(m.body_pos + 3 * b)};
    joint.mass = m.body_mass[b];
    joint.center_of_mass = vector(m.body_ipos + 3 * b);
    const Mat3<double> axes = rotation(m.body_iquat + 4 * b).toRotationMatrix();
    joint.inertia = axes * vector(m.body_inertia + 3 * b).asDiagonal() * axes.transpose();
    const int type = m.jnt_type[m.body_jntadr[b]];
    joint.type = type == mjJNT_FREE   ? JointType::kFree
                 : type == mjJNT_BALL ? JointType::kBall
                                      : JointType::kRevolute;
    if (type == mjJNT_HINGE) joint.axis = vector(m.jnt_axis + 3 * m.body_jntadr[b]);
    for (DofLimits& dof : joint.dofs) {
      dof.damping = dof.dry_friction = 0;
      dof.torque_minus = dof.torque_plus = type == mjJNT_FREE ? 0 : torque;
    }
  }
  for (int g = 0; g < m.ngeom; ++g) {
    if (m.geom_bodyid[g] == 0) continue;
    Collider& c = s.colliders.emplace_back();
    c.joint = m.geom_bodyid[g] - 1;
    c.shape = m.geom_type[g] == mjGEOM_SPHERE    ? Shape::kSphere
              : m.geom_type[g] == mjGEOM_CAPSULE ? Shape::kCapsule
                                                 : Shape::kBox;
    c.local = {rotation(m.geom_quat + 4 * g), vector(m.geom_pos + 3 * g)};
    c.size = vector(m.geom_size + 3 * g);
    if (c.shape == Shape::kCapsule) c.size = {m.geom_size[3 * g], m.geom_size[3 * g], m.geom_size[3 * g + 1]};
    c.friction = m.geom_friction[3 * g];
  }
  return s;
}

}  // namespace sinew::bench
