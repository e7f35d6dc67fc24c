#include "study/tables/global/cartesian_motion.h"

#include <cmath>
#include <numbers>

namespace sinew::study {

using multibody::ConstVector;
using multibody::Vector;

namespace {

Eigen::Quaterniond parameters_of(const Vector& state, int body) {
  return {state[7 * body + 3], state[7 * body + 4], state[7 * body + 5], state[7 * body + 6]};
}

}  // namespace

CartesianMotion::CartesianMotion(const multibody::Model& model)
    : model_(&model),
      motion_(model),
      speed_(model.size(), Vec3<double>::Zero()),
      applied_(model),
      q_(Vector::Zero(model.size())),
      qd_(Vector::Zero(model.size())) {}

Vector CartesianMotion::from_joints(const Vector& y) {
  const int n = bodies();
  q_ = y.head(n);
  qd_ = y.tail(n);
  move_to(*model_, q_, motion_);
  set_rates(*model_, qd_, motion_);
  Vector state(13 * n);
  for (int i = 0; i < n; ++i) {
    const Eigen::Quaterniond p(motion_.pose.rotation[i]);
    state.segment<3>(7 * i) = motion_.pose.center[i];
    state.segment<4>(7 * i + 3) << p.w(), p.x(), p.y(), p.z();
    state.segment<3>(7 * n + 6 * i) = velocity_at(motion_, i, motion_.pose.center[i]);
    state.segment<3>(7 * n + 6 * i + 3) = motion_.omega[i];
  }
  return state;
}

void CartesianMotion::derive(int i) {
  const Tree<double>& tree = model_->tree;
  const Mat3<double>& r = motion_.pose.rotation[i];
  motion_.pose.origin[i] = motion_.pose.center[i] - r * tree.center_of_mass[i];
  motion_.velocity[i] = speed_[i] - motion_.omega[i].cross(motion_.pose.center[i]);
  const Vec3<double> axis = r * tree.axis[i];
  const bool turns = tree.type[i] == JointType::kRevolute;
  motion_.pose.w[i] = turns ? axis : Vec3<double>(Vec3<double>::Zero());
  motion_.pose.v[i] = turns ? Vec3<double>(motion_.pose.origin[i].cross(axis)) : axis;
}

bool CartesianMotion::set(const Vector& state) {
  if (!state.allFinite()) return false;
  const int n = bodies();
  for (int i = 0; i < n; ++i) {
    motion_.pose.center[i] = state.segment<3>(7 * i);
    motion_.pose.rotation[i] = parameters_of(state, i).normalized().toRotationMatrix();
    speed_[i] = state.segment<3>(7 * n + 6 * i);
    motion_.omega[i] = state.segment<3>(7 * n + 6 * i + 3);
    derive(i);
  }
  refresh_joints();
  return true;
}

void CartesianMotion::move(int body, int coordinate, double by) {
  if (coordinate < 3) {
    motion_.pose.center[body][coordinate] += by;
  } else {
    const Mat3<double> turn = Eigen::AngleAxisd(by, Vec3<double>::Unit(coordinate - 3)).toRotationMatrix();
    motion_.pose.rotation[body] = (turn * motion_.pose.rotation[body]).eval();
  }
  derive(body);
}

void CartesianMotion::speed_up(int body, int coordinate, double by) {
  if (coordinate < 3)
    speed_[body][coordinate] += by;
  else
    motion_.omega[body][coordinate - 3] += by;
  derive(body);
}

void CartesianMotion::refresh_joints() {
  const Tree<double>& tree = model_->tree;
  for (int i = 0; i < bodies(); ++i) {
    const int p = tree.parent[i];
    const Mat3<double> parent = p < 0 ? Mat3<double>(Mat3<double>::Identity()) : motion_.pose.rotation[p];
    const Vec3<double> axis = motion_.pose.rotation[i] * tree.axis[i];
    const Vec3<double> turning = p < 0 ? motion_.omega[i] : Vec3<double>(motion_.omega[i] - motion_.omega[p]);
    if (tree.type[i] == JointType::kRevolute) {
      const Eigen::Quaterniond turn(Mat3<double>(parent.transpose() * motion_.pose.rotation[i]));
      const double angle = 2 * std::atan2(turn.vec().dot(tree.axis[i]), turn.w());
      const double whole = 2 * std::numbers::pi;
      q_[i] = angle + whole * std::round((q_[i] - angle) / whole);
      qd_[i] = axis.dot(turning);
    } else {
      const Vec3<double> rest = position_of(motion_, {p, tree.rest[i].translation});
      const Vec3<double> from = motion_.pose.origin[i];
      q_[i] = axis.dot(from - rest);
      qd_[i] = axis.dot(velocity_at(motion_, i, from) - velocity_at(motion_, p, from));
    }
  }
}

void CartesianMotion::position_rates(const Vector& state, const ConstVector& v,
                                     Eigen::Ref<Vector> out) const {
  for (int i = 0; i < bodies(); ++i) {
    out.segment<3>(7 * i) = v.segment<3>(6 * i);
    const Vec3<double> half = 0.5 * v.segment<3>(6 * i + 3);
    const Eigen::Quaterniond rate =
        Eigen::Quaterniond(0, half.x(), half.y(), half.z()) * parameters_of(state, i);
    out.segment<4>(7 * i + 3) << rate.w(), rate.x(), rate.y(), rate.z();
  }
}

Vector CartesianMotion::turns_of(const Vector& state, const ConstVector& change) const {
  Vector out(6 * bodies());
  for (int i = 0; i < bodies(); ++i) {
    out.segment<3>(6 * i) = change.segment<3>(7 * i);
    const Eigen::Quaterniond by(change[7 * i + 3], change[7 * i + 4], change[7 * i + 5], change[7 * i + 6]);
    out.segment<3>(6 * i + 3) = 2 * (by * parameters_of(state, i).inverse()).vec();
  }
  return out;
}

Mat3<double> CartesianMotion::inertia(int body) const {
  const Mat3<double>& r = motion_.pose.rotation[body];
  return r * model_->tree.inertia[body] * r.transpose();
}

void CartesianMotion::wrenches(double t, Wrenches& out) {
  const Tree<double>& tree = model_->tree;
  apply_forces(*model_, t, q_, qd_, motion_, applied_);
  // A joint's own force is one on its body and the opposite on the parent.
  for (int i = 0; i < bodies(); ++i) {
    const bool turns = tree.type[i] == JointType::kRevolute;
    const Vec3<double> along = applied_.joint[i] * (turns ? motion_.pose.w[i] : motion_.pose.v[i]);
    const Vec3<double> force = turns ? Vec3<double>(Vec3<double>::Zero()) : along;
    const Vec3<double> moment = turns ? along : Vec3<double>(motion_.pose.origin[i].cross(along));
    applied_.force[i] += force;
    applied_.moment[i] += moment;
    if (const int p = tree.parent[i]; p >= 0) {
      applied_.force[p] -= force;
      applied_.moment[p] -= moment;
    }
  }
  for (int i = 0; i < bodies(); ++i) {
    const Mat3<double>& r = motion_.pose.rotation[i];
    const Vec3<double> omega = r.transpose() * motion_.omega[i];
    out.segment<3>(6 * i) = applied_.force[i] + tree.mass[i] * model_->mechanism().gravity;
    out.segment<3>(6 * i + 3) = applied_.moment[i] - motion_.pose.center[i].cross(applied_.force[i]) -
                                r * omega.cross(tree.inertia[i] * omega);
  }
}

}  // namespace sinew::study
