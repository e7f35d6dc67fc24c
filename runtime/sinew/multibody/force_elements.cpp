#include "sinew/multibody/force_elements.h"

#include <cmath>

namespace sinew::multibody {

Law contact_law(const Force& f, double d, double rate) {
  const double root = std::sqrt(d * d + f.eps * f.eps);
  const double ramp = 0.5 * (d + root), slope = 0.5 * (1 + d / root);
  const double bend = 0.5 * f.eps * f.eps / (root * root * root);
  return {f.k * ramp + f.c * slope * rate, f.k * slope + f.c * bend * rate, f.c * slope};
}

Law spring_damper_law(const Force& f, double length, double rate) {
  switch (f.mode) {
    case SpringMode::kTension:
      return contact_law(f, length - f.rest_length, rate);
    case SpringMode::kCompression: {
      // f = −k·s(d) + c·s'(d)·l' with d = l0 − l, so −f is the push at rate d' = −l'.
      const Law push = contact_law(f, f.rest_length - length, -rate);
      return {-push.force, push.by_length, push.by_rate};
    }
    case SpringMode::kBoth:
      break;
  }
  return {f.k * (length - f.rest_length) + f.c * rate, f.k, f.c};
}

namespace {

void push(AppliedForces& out, int body, const Vec3<double>& at, const Vec3<double>& force) {
  if (body == kGround) return;
  out.force[body] += force;
  out.moment[body] += at.cross(force);
}

Vec3<double> turned_with(const BodyMotion& m, int body, const Vec3<double>& direction) {
  return body == kGround ? direction : Vec3<double>(m.pose.rotation[body] * direction);
}

/// Force on point a (and its opposite on b where the law has two ends), with the places where they act.
struct Action {
  Vec3<double> at, force;
};

Action spring_damper(const ForceModel& f, const BodyMotion& m) {
  const Vec3<double> a = position_of(m, f.a), b = position_of(m, f.b);
  const Vec3<double> apart = b - a;
  const double length = apart.norm();
  const Vec3<double> line = apart / length;
  const double rate = line.dot(velocity_at(m, f.b.body, b) - velocity_at(m, f.a.body, a));
  return {a, line * spring_damper_law(f.law, length, rate).force};
}

Action anchor_spring(const ForceModel& f, const BodyMotion& m) {
  const Vec3<double> p = position_of(m, f.a);
  return {p, -f.law.k * (p - f.b.local) - f.law.c * velocity_at(m, f.a.body, p)};
}

Action contact_plane(const ForceModel& f, const BodyMotion& m) {
  const Vec3<double> p = position_of(m, f.a), n = turned_with(m, f.b.body, f.direction);
  const double depth = -n.dot(p - position_of(m, f.b));
  const double rate = -n.dot(velocity_at(m, f.a.body, p) - velocity_at(m, f.b.body, p));
  return {p, n * contact_law(f.law, depth, rate).force};
}

Action tyre_vertical(const ForceModel& f, double t, const BodyMotion& m) {
  const Vec3<double> p = position_of(m, f.a);
  const double depth = f.law.radius + pulses_at(f.law.road, t) - p.z();
  const double rate = pulses_rate(f.law.road, t) - velocity_at(m, f.a.body, p).z();
  return {p, Vec3<double>(0, 0, contact_law(f.law, depth, rate).force)};
}

Action tyre_lateral(const ForceModel& f, const BodyMotion& m) {
  const Vec3<double> patch = position_of(m, f.a) - Vec3<double>(0, 0, f.law.radius);
  const Vec3<double> e = turned_with(m, f.a.body, f.direction);
  return {patch, -f.law.c_lateral * velocity_at(m, f.a.body, patch).dot(e) * e};
}

double joint_deflection(const JointForce& f, double t, double q) {
  return f.rest_profile.empty() ? q - f.rest : q - f.rest - pulses_at(f.rest_profile, t);
}

double joint_spring(const JointForce& f, double deflection) {
  return -(f.stiffness + f.stiffness_cubic * deflection * deflection) * deflection;
}

double joint_loss(const JointForce& f, double qd) {
  const double dry = f.friction_force == 0 ? 0 : f.friction_force * std::tanh(qd / f.friction_speed);
  return -f.damping * qd - dry;
}

}  // namespace

void apply_forces(const Model& model, double t, const ConstVector& q, const ConstVector& qd,
                  const BodyMotion& m, AppliedForces& out) {
  for (int i = 0; i < model.size(); ++i) {
    out.force[i].setZero();
    out.moment[i].setZero();
    const JointForce& f = model.joint_force[i];
    out.joint[i] = joint_spring(f, joint_deflection(f, t, q[i])) + joint_loss(f, qd[i]);
  }
  for (const ForceModel& f : model.forces) {
    switch (f.law.type) {
      case ForceType::kSpringDamper: {
        const Action pull = spring_damper(f, m);
        push(out, f.a.body, pull.at, pull.force);
        push(out, f.b.body, pull.at, -pull.force);  // any point of the common line serves
        break;
      }
      case ForceType::kAnchorSpring: {
        const Action pull = anchor_spring(f, m);
        push(out, f.a.body, pull.at, pull.force);
        break;
      }
      case ForceType::kContactPlane: {
        const Action contact = contact_plane(f, m);
        push(out, f.a.body, contact.at, contact.force);
        push(out, f.b.body, contact.at, -contact.force);
        break;
      }
      case ForceType::kTyre: {
        const Action up = tyre_vertical(f, t, m);
        push(out, f.a.body, up.at, up.force);
        if (f.law.c_lateral != 0) {
          const Action side = tyre_lateral(f, m);
          push(out, f.a.body, side.at, side.force);
        }
        break;
      }
      case ForceType::kTorque:
        if (f.a.body != kGround) out.moment[f.a.body] += f.law.direction;
        break;
    }
  }
}

double kinetic_energy(const Model& model, const BodyMotion& m) {
  double sum = 0;
  for (int i = 0; i < model.size(); ++i) {
    const Vec3<double> local = m.pose.rotation[i].transpose() * m.omega[i];
    sum += 0.5 * model.tree.mass[i] * velocity_at(m, i, m.pose.center[i]).squaredNorm() +
           0.5 * local.dot(model.tree.inertia[i] * local);
  }
  return sum;
}

double potential_energy(const Model& model, double t, const ConstVector& q, const BodyMotion& m) {
  double sum = 0;
  for (int i = 0; i < model.size(); ++i) {
    const JointForce& f = model.joint_force[i];
    const double x = joint_deflection(f, t, q[i]);
    sum += (0.5 * f.stiffness + 0.25 * f.stiffness_cubic * x * x) * x * x;
    sum -= model.tree.mass[i] * model.mechanism().gravity.dot(m.pose.center[i]);
  }
  for (const ForceModel& f : model.forces) {
    if (f.law.type == ForceType::kSpringDamper && f.law.mode == SpringMode::kBoth) {
      const double x = (position_of(m, f.b) - position_of(m, f.a)).norm() - f.law.rest_length;
      sum += 0.5 * f.law.k * x * x;
    } else if (f.law.type == ForceType::kAnchorSpring) {
      sum += 0.5 * f.law.k * (position_of(m, f.a) - f.b.local).squaredNorm();
    }
  }
  return sum;
}

double power_of_others(const Model& model, double t, const ConstVector& q, const ConstVector& qd,
                       const BodyMotion& m) {
  double power = 0;
  for (int i = 0; i < model.size(); ++i) {
    const JointForce& f = model.joint_force[i];
    power += joint_loss(f, qd[i]) * qd[i];
    if (!f.rest_profile.empty())  // a moving rest position does work on the spring
      power += joint_spring(f, joint_deflection(f, t, q[i])) * pulses_rate(f.rest_profile, t);
  }
  for (const ForceModel& f : model.forces) {
    const auto work = [&](const Action& action) {
      return action.force.dot(velocity_at(m, f.a.body, action.at));
    };
    switch (f.law.type) {
      case ForceType::kSpringDamper: {
        const Vec3<double> a = position_of(m, f.a), b = position_of(m, f.b);
        const Vec3<double> line = (b - a).normalized();
        const double length = (b - a).norm();
        const double rate = line.dot(velocity_at(m, f.b.body, b) - velocity_at(m, f.a.body, a));
        power -= spring_damper_law(f.law, length, rate).force * rate;
        if (f.law.mode == SpringMode::kBoth) power += f.law.k * (length - f.law.rest_length) * rate;
        break;
      }
      case ForceType::kAnchorSpring:
        power -= f.law.c * velocity_at(m, f.a.body, position_of(m, f.a)).squaredNorm();
        break;
      case ForceType::kContactPlane: {
        const Action contact = contact_plane(f, m);
        power += work(contact) - contact.force.dot(velocity_at(m, f.b.body, contact.at));
        break;
      }
      case ForceType::kTyre:
        power += work(tyre_vertical(f, t, m));
        if (f.law.c_lateral != 0) power += work(tyre_lateral(f, m));
        break;
      case ForceType::kTorque:
        if (f.a.body != kGround) power += f.law.direction.dot(m.omega[f.a.body]);
        break;
    }
  }
  return power;
}

}  // namespace sinew::multibody
