#include "sinew/multibody/motion.h"

#include <cmath>

namespace sinew::multibody {
namespace {

Mat3<double> turn_about(const Vec3<double>& axis, double angle) {
  const double c = std::cos(angle), s = std::sin(angle);
  const Vec3<double> a = (1 - c) * axis, b = s * axis;
  Mat3<double> r;
  r << a.x() * axis.x() + c, a.x() * axis.y() - b.z(), a.x() * axis.z() + b.y(),  //
      a.y() * axis.x() + b.z(), a.y() * axis.y() + c, a.y() * axis.z() - b.x(),   //
      a.z() * axis.x() - b.y(), a.z() * axis.y() + b.x(), a.z() * axis.z() + c;
  return r;
}

}  // namespace

BodyMotion::BodyMotion(const Model& model) : pose(model.tree) {
  for (auto* field : {&omega, &velocity, &drift_w, &drift_v, &alpha, &acceleration})
    field->assign(model.size(), Vec3<double>::Zero());
}

void move_to(const Model& model, const ConstVector& q, BodyMotion& motion) {
  const Tree<double>& tree = model.tree;
  Kinematics<double>& pose = motion.pose;
  for (int i = 0; i < tree.bodies; ++i) {
    const int p = tree.parent[i];
    const bool turns = tree.type[i] == JointType::kRevolute;
    if (p < 0) {
      pose.origin[i] = tree.rest[i].translation;
      pose.rotation[i] = turns ? turn_about(tree.axis[i], q[i]) : Mat3<double>(Mat3<double>::Identity());
    } else {
      pose.origin[i].noalias() = pose.origin[p] + pose.rotation[p] * tree.rest[i].translation;
      if (turns)
        pose.rotation[i].noalias() = pose.rotation[p] * turn_about(tree.axis[i], q[i]);
      else
        pose.rotation[i] = pose.rotation[p];
    }
    const Vec3<double> axis = pose.rotation[i] * tree.axis[i];
    if (turns) {
      pose.w[i] = axis;
      pose.v[i] = pose.origin[i].cross(axis);
    } else {
      pose.w[i].setZero();
      pose.v[i] = axis;
      pose.origin[i] += axis * q[i];
    }
    pose.center[i].noalias() = pose.origin[i] + pose.rotation[i] * tree.center_of_mass[i];
  }
}

void set_rates(const Model& model, const ConstVector& qd, BodyMotion& m) {
  const Tree<double>& tree = model.tree;
  for (int i = 0; i < tree.bodies; ++i) {
    const int p = tree.parent[i];
    const Vec3<double> w = m.pose.w[i] * qd[i], v = m.pose.v[i] * qd[i];
    if (p < 0) {
      m.omega[i] = w;
      m.velocity[i] = v;
      m.drift_w[i].setZero();
      m.drift_v[i].setZero();
    } else {
      m.drift_w[i] = m.omega[p].cross(w);
      m.drift_v[i] = m.omega[p].cross(v) + m.velocity[p].cross(w);
      m.omega[i] = m.omega[p] + w;
      m.velocity[i] = m.velocity[p] + v;
    }
  }
}

void accelerate(const Model& model, const ConstVector& qdd, BodyMotion& m) {
  const Tree<double>& tree = model.tree;
  for (int i = 0; i < tree.bodies; ++i) {
    const int p = tree.parent[i];
    m.alpha[i] = m.drift_w[i] + m.pose.w[i] * qdd[i];
    m.acceleration[i] = m.drift_v[i] + m.pose.v[i] * qdd[i];
    if (p >= 0) {
      m.alpha[i] += m.alpha[p];
      m.acceleration[i] += m.acceleration[p];
    }
  }
}

Vec3<double> position_of(const BodyMotion& m, const BodyPoint& point) {
  if (point.body == kGround) return point.local;
  return m.pose.origin[point.body] + m.pose.rotation[point.body] * point.local;
}

Vec3<double> velocity_at(const BodyMotion& m, int body, const Vec3<double>& position) {
  if (body == kGround) return Vec3<double>::Zero();
  return m.velocity[body] + m.omega[body].cross(position);
}

Vec3<double> acceleration_at(const BodyMotion& m, int body, const Vec3<double>& position) {
  if (body == kGround) return Vec3<double>::Zero();
  return m.acceleration[body] + m.alpha[body].cross(position) +
         m.omega[body].cross(velocity_at(m, body, position));
}

Vec3<double> velocity_moved_by(const Model& model, const BodyMotion& m, int k, const Vec3<double>& position,
                               const Vec3<double>& velocity) {
  // Turning coordinate k carries the point into another place of the parent's velocity field, and turns what
  // the point moves relative to the parent.
  const int p = model.tree.parent[k];
  const Vec3<double> relative = velocity - velocity_at(m, p, position);
  const Vec3<double> turned = m.pose.w[k].cross(relative);
  return p < 0 ? turned : Vec3<double>(turned + m.omega[p].cross(moved_by(m, k, position)));
}

}  // namespace sinew::multibody
