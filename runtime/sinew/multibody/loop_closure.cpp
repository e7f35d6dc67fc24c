#include "sinew/multibody/loop_closure.h"

namespace sinew::multibody {
namespace {

/// Directions of a revolute loop: two normals to the axis carried by a, the axis carried by b.
struct Directions {
  Vec3<double> normal[2], axis;
};

Mat3<double> rotation_of(const BodyMotion& m, int body) {
  return body == kGround ? Mat3<double>(Mat3<double>::Identity()) : m.pose.rotation[body];
}
Vec3<double> omega_of(const BodyMotion& m, int body) {
  return body == kGround ? Vec3<double>(Vec3<double>::Zero()) : m.omega[body];
}
Vec3<double> alpha_of(const BodyMotion& m, int body) {
  return body == kGround ? Vec3<double>(Vec3<double>::Zero()) : m.alpha[body];
}

Directions directions(const LoopModel& l, const BodyMotion& m) {
  const Mat3<double> a = rotation_of(m, l.a.body);
  return {{a * l.normal_a[0], a * l.normal_a[1]}, rotation_of(m, l.b.body) * l.axis_b};
}

}  // namespace

void closure(const Model& model, const BodyMotion& m, Eigen::Ref<Vector> phi) {
  for (const LoopModel& l : model.loops) {
    const Vec3<double> apart = position_of(m, l.b) - position_of(m, l.a);
    if (l.type == LoopType::kDistance) {
      phi[l.first_row] = (apart.squaredNorm() - l.length * l.length) / (2 * l.length);
      continue;
    }
    phi.segment<3>(l.first_row) = apart;
    if (l.type == LoopType::kRevolute) {
      const Directions d = directions(l, m);
      for (int k = 0; k < 2; ++k) phi[l.first_row + 3 + k] = d.normal[k].dot(d.axis);
    }
  }
}

void closure_jacobian(const Model& model, const BodyMotion& m, Matrix& jacobian) {
  jacobian.setZero();
  for (const LoopModel& l : model.loops) {
    const Vec3<double> a = position_of(m, l.a), b = position_of(m, l.b);
    const Directions d = l.type == LoopType::kRevolute ? directions(l, m) : Directions{};
    const auto column = [&](int k, const Vec3<double>& at, double sign) {
      const Vec3<double> moved = sign * moved_by(m, k, at);
      if (l.type == LoopType::kDistance) {
        jacobian(l.first_row, k) = (b - a).dot(moved) / l.length;
        return;
      }
      jacobian.col(k).segment<3>(l.first_row) = moved;
      if (l.type == LoopType::kRevolute)
        for (int r = 0; r < 2; ++r)
          jacobian(l.first_row + 3 + r, k) = sign * m.pose.w[k].dot(d.axis.cross(d.normal[r]));
    };
    for (const int k : l.path.of_a) column(k, a, -1);
    for (const int k : l.path.of_b) column(k, b, 1);
  }
}

void closure_acceleration(const Model& model, const BodyMotion& m, Eigen::Ref<Vector> out) {
  for (const LoopModel& l : model.loops) {
    const Vec3<double> a = position_of(m, l.a), b = position_of(m, l.b);
    const Vec3<double> acceleration = acceleration_at(m, l.b.body, b) - acceleration_at(m, l.a.body, a);
    if (l.type == LoopType::kDistance) {
      const Vec3<double> rate = velocity_at(m, l.b.body, b) - velocity_at(m, l.a.body, a);
      out[l.first_row] = (rate.squaredNorm() + (b - a).dot(acceleration)) / l.length;
      continue;
    }
    out.segment<3>(l.first_row) = acceleration;
    if (l.type == LoopType::kRevolute) {
      const Directions d = directions(l, m);
      const Vec3<double> wa = omega_of(m, l.a.body), wb = omega_of(m, l.b.body);
      const Vec3<double> axis_rate = wb.cross(d.axis);
      const Vec3<double> axis_bend = alpha_of(m, l.b.body).cross(d.axis) + wb.cross(axis_rate);
      for (int k = 0; k < 2; ++k) {
        const Vec3<double> rate = wa.cross(d.normal[k]);
        const Vec3<double> bend = alpha_of(m, l.a.body).cross(d.normal[k]) + wa.cross(rate);
        out[l.first_row + 3 + k] = bend.dot(d.axis) + 2 * rate.dot(axis_rate) + d.normal[k].dot(axis_bend);
      }
    }
  }
}

Gap worst_gap(const Model& model, const Vector& phi) {
  Gap worst;
  for (std::size_t i = 0; i < model.loops.size(); ++i) {
    const LoopModel& l = model.loops[i];
    const double size = phi.segment(l.first_row, equation_count(l.type)).cwiseAbs().maxCoeff();
    if (worst.loop < 0 || size > worst.size || !(size == size)) worst = {static_cast<int>(i), size};
  }
  return worst;
}

}  // namespace sinew::multibody
