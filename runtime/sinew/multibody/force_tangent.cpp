// Derivatives of the force elements, assembled in coordinate space as Rᵀ·(∂force/∂…)·R (equations 78–85).
#include <cmath>

#include "sinew/multibody/force_elements.h"

namespace sinew::multibody {
namespace {

/// How the relative position and velocity of two points change with the coordinates between their bodies.
/// Coordinates that move both only turn the picture as a whole: they leave Q as it is and are left out.
struct Sensitivity {
  std::vector<int> coordinate;
  Eigen::Matrix3Xd position, velocity;  ///< 3×n: ∂(b − a)/∂q, ∂(b' − a')/∂q
  Eigen::Matrix3Xd turn;                ///< 3×n: motion axis w, of the b-side (+) or a-side (−)

  Sensitivity(const Model& model, const BodyMotion& m, const Path& path, const Vec3<double>& a, int body_a,
              const Vec3<double>& b, int body_b) {
    const Eigen::Index n = static_cast<Eigen::Index>(path.of_a.size() + path.of_b.size());
    position.resize(3, n);
    velocity.resize(3, n);
    turn.resize(3, n);
    const auto add = [&](int k, const Vec3<double>& at, int body, double sign) {
      const Eigen::Index column = static_cast<Eigen::Index>(coordinate.size());
      coordinate.push_back(k);
      position.col(column) = sign * moved_by(m, k, at);
      velocity.col(column) = sign * velocity_moved_by(model, m, k, at, velocity_at(m, body, at));
      turn.col(column) = sign * m.pose.w[k];
    };
    for (const int k : path.of_a) add(k, a, body_a, -1);
    for (const int k : path.of_b) add(k, b, body_b, 1);
  }

  /// Adds `block` [n×n] at these coordinates.
  template <class Block>
  void scatter(const Block& block, Matrix& into) const {
    for (std::size_t c = 0; c < coordinate.size(); ++c)
      for (std::size_t r = 0; r < coordinate.size(); ++r) into(coordinate[r], coordinate[c]) += block(r, c);
  }
};

void spring_damper(const Model& model, const ForceModel& f, const BodyMotion& m, Matrix& stiffness,
                   Matrix& damping) {
  const Vec3<double> a = position_of(m, f.a), b = position_of(m, f.b);
  const Vec3<double> apart_rate = velocity_at(m, f.b.body, b) - velocity_at(m, f.a.body, a);
  const double length = (b - a).norm();
  const Vec3<double> line = (b - a) / length;
  const Law law = spring_damper_law(f.law, length, line.dot(apart_rate));
  const Sensitivity s(model, m, f.path, a, f.a.body, b, f.b.body);
  const Mat3<double> across = (Mat3<double>::Identity() - line * line.transpose()) / length;
  const Eigen::RowVectorXd length_by = line.transpose() * s.position;
  const Eigen::RowVectorXd rate_by =
      line.transpose() * s.velocity + (across * apart_rate).transpose() * s.position;
  s.scatter((length_by.transpose() * (law.by_length * length_by + law.by_rate * rate_by) +
             law.force * s.position.transpose() * across * s.position)
                .eval(),
            stiffness);
  s.scatter((law.by_rate * length_by.transpose() * length_by).eval(), damping);
}

void anchor_spring(const Model& model, const ForceModel& f, const BodyMotion& m, Matrix& stiffness,
                   Matrix& damping) {
  const Vec3<double> p = position_of(m, f.a);
  const Sensitivity s(model, m, f.path, p, f.a.body, f.b.local, kGround);
  s.scatter((s.position.transpose() * (f.law.k * s.position + f.law.c * s.velocity)).eval(), stiffness);
  s.scatter((f.law.c * s.position.transpose() * s.position).eval(), damping);
}

void contact_plane(const Model& model, const ForceModel& f, const BodyMotion& m, Matrix& stiffness,
                   Matrix& damping) {
  const Vec3<double> p = position_of(m, f.a);
  const Vec3<double> n =
      f.b.body == kGround ? f.direction : Vec3<double>(m.pose.rotation[f.b.body] * f.direction);
  const double depth = -n.dot(p - position_of(m, f.b));
  const double rate = -n.dot(velocity_at(m, f.a.body, p) - velocity_at(m, f.b.body, p));
  const Law law = contact_law(f.law, depth, rate);
  // Both ends at the place of contact: what moves the plane there changes the depth like the point does.
  const Sensitivity s(model, m, f.path, p, f.a.body, p, f.b.body);
  const Eigen::RowVectorXd depth_by = n.transpose() * s.position;
  const Eigen::RowVectorXd rate_by = n.transpose() * s.velocity;
  s.scatter((depth_by.transpose() * (law.by_length * depth_by + law.by_rate * rate_by)).eval(), stiffness);
  s.scatter((law.by_rate * depth_by.transpose() * depth_by).eval(), damping);
}

void tyre(const Model& model, const ForceModel& f, double t, const BodyMotion& m, Matrix& stiffness,
          Matrix& damping) {
  const Vec3<double> p = position_of(m, f.a);
  const double depth = f.law.radius + pulses_at(f.law.road, t) - p.z();
  const Vec3<double> v = velocity_at(m, f.a.body, p);
  const Law law = contact_law(f.law, depth, pulses_rate(f.law.road, t) - v.z());
  const Sensitivity s(model, m, f.path, p, f.a.body, Vec3<double>::Zero(), kGround);
  const Eigen::RowVectorXd depth_by = s.position.row(2), rate_by = s.velocity.row(2);  // of −z: sign +
  s.scatter((depth_by.transpose() * (law.by_length * depth_by + law.by_rate * rate_by)).eval(), stiffness);
  s.scatter((law.by_rate * depth_by.transpose() * depth_by).eval(), damping);
  if (f.law.c_lateral == 0) return;
  const Vec3<double> down(0, 0, -f.law.radius);
  const Vec3<double> slip = v + m.omega[f.a.body].cross(down);
  const Vec3<double> e = m.pose.rotation[f.a.body] * f.direction;
  const Eigen::Index n = s.position.cols();
  Eigen::RowVectorXd along(n), slip_by(n);  // ∂(patch)/∂q·e and ∂(slip·e)/∂q; columns of s carry the sign −
  for (Eigen::Index c = 0; c < n; ++c) {
    const int k = s.coordinate[c], parent = model.tree.parent[k];
    const Vec3<double> w = -s.turn.col(c);
    const Vec3<double> spin =
        parent < 0 ? m.omega[f.a.body] : Vec3<double>(m.omega[f.a.body] - m.omega[parent]);
    along[c] = e.dot(-s.position.col(c) + w.cross(down));
    slip_by[c] = e.dot(-s.velocity.col(c) + w.cross(spin).cross(down)) + slip.dot(w.cross(e));
  }
  s.scatter((f.law.c_lateral * along.transpose() * slip_by).eval(), stiffness);
  s.scatter((f.law.c_lateral * along.transpose() * along).eval(), damping);
}

}  // namespace

void add_force_tangent(const Model& model, double t, const ConstVector& q, const ConstVector& qd,
                       const BodyMotion& m, Matrix& stiffness, Matrix& damping) {
  for (int i = 0; i < model.size(); ++i) {
    const JointForce& f = model.joint_force[i];
    const double x = q[i] - f.rest - pulses_at(f.rest_profile, t);
    stiffness(i, i) += f.stiffness + 3 * f.stiffness_cubic * x * x;
    damping(i, i) += f.damping;
    if (f.friction_force != 0) {
      const double th = std::tanh(qd[i] / f.friction_speed);
      damping(i, i) += f.friction_force / f.friction_speed * (1 - th * th);
    }
  }
  for (const ForceModel& f : model.forces) {
    switch (f.law.type) {
      case ForceType::kSpringDamper:
        spring_damper(model, f, m, stiffness, damping);
        break;
      case ForceType::kAnchorSpring:
        anchor_spring(model, f, m, stiffness, damping);
        break;
      case ForceType::kContactPlane:
        contact_plane(model, f, m, stiffness, damping);
        break;
      case ForceType::kTyre:
        tyre(model, f, t, m, stiffness, damping);
        break;
      case ForceType::kTorque:
        break;
    }
  }
}

}  // namespace sinew::multibody
