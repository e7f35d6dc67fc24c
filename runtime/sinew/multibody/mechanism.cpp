#include "sinew/multibody/mechanism.h"

#include <cmath>

#include "sinew/skeleton/principal_axes.h"

namespace sinew::multibody {

double pulses_at(const std::vector<Pulse>& pulses, double t) {
  double sum = 0;
  for (const Pulse& p : pulses) {
    const double x = (t - p.center) / p.width;
    sum += p.amplitude * std::exp(-x * x);
  }
  return sum;
}

double pulses_rate(const std::vector<Pulse>& pulses, double t) {
  double sum = 0;
  for (const Pulse& p : pulses) {
    const double x = (t - p.center) / p.width;
    sum -= 2 * x / p.width * p.amplitude * std::exp(-x * x);
  }
  return sum;
}

namespace {

std::string quoted(const std::string& kind, const std::string& name) {
  return kind + " '" + name + "'";
}

bool finite(const Vec3<double>& v) {
  return v.allFinite();
}

bool is_unit(const Vec3<double>& v) {
  return std::abs(v.norm() - 1) < 1e-6;
}

std::string body_fault(const Body& b) {
  const std::string who = quoted("body", b.name);
  if (!std::isfinite(b.mass) || !finite(b.center_of_mass) || !b.inertia.allFinite())
    return who + " has a number that is not finite";
  if (b.mass < 0) return who + " has negative mass";
  if (b.mass == 0 && b.inertia.norm() > 0) return who + " has inertia but no mass";
  const Vec3<double> moments = principal_axes(b.inertia).values;
  const double slack = 1e-9 * std::abs(moments[2]);
  if (moments[0] < -slack) return who + " has a negative principal moment of inertia";
  if (moments[2] > moments[0] + moments[1] + 1e-6 * moments[2])
    return who + " has an inertia that breaks the triangle inequality";
  return {};
}

std::string tree_fault(const Mechanism& m) {
  const int n = static_cast<int>(m.bodies.size());
  std::vector<const HingeOrSlider*> moved_by(n, nullptr);
  for (const HingeOrSlider& j : m.joints) {
    const std::string who = quoted("joint", j.name);
    if (j.type != JointType::kRevolute && j.type != JointType::kPrismatic)
      return who + " has a type other than revolute and prismatic";
    if (j.child < 0 || j.child >= n || j.parent >= n) return who + " refers to a body that does not exist";
    if (moved_by[j.child])
      return quoted("body", m.bodies[j.child].name) + " is the child of two joints ('" +
             moved_by[j.child]->name + "' and '" + j.name + "'): a closed chain is declared under loops";
    moved_by[j.child] = &j;
    if (!finite(j.anchor) || !finite(j.axis) || !std::isfinite(j.q0) || !std::isfinite(j.qd0))
      return who + " has a number that is not finite";
    if (!is_unit(j.axis)) return who + " has an axis that is not of length 1";
    if (!(j.force.friction_speed > 0)) return who + " has a friction_v0 that is not positive";
    for (const Pulse& p : j.force.rest_profile)
      if (!(p.width > 0)) return who + " has a rest_profile width that is not positive";
  }
  for (int i = 0; i < n; ++i)
    if (!moved_by[i]) return quoted("body", m.bodies[i].name) + " has no joint";
  for (const HingeOrSlider& first : m.joints) {
    const HingeOrSlider* j = &first;
    for (int steps = 0; j->parent != kGround; ++steps, j = moved_by[j->parent])
      if (steps > n)
        return quoted("joint", first.name) + " is part of a cycle of joints that is not declared as a loop";
  }
  std::vector<bool> seen(n, false);
  for (const HingeOrSlider& j : m.joints) {
    if (j.parent != kGround && !seen[j.parent])
      return quoted("joint", j.name) + " is listed before the joint that moves its parent";
    seen[j.child] = true;
  }
  return {};
}

/// Every joint must move inertia about or along its axis, or its acceleration would be undefined.
std::string inertia_fault(const Mechanism& m) {
  const int n = static_cast<int>(m.bodies.size());
  std::vector<int> children(n, 0);
  for (const HingeOrSlider& j : m.joints)
    if (j.parent != kGround) ++children[j.parent];
  for (int i = 0; i < n; ++i)
    if (children[i] == 0 && m.bodies[i].mass == 0)
      return quoted("body", m.bodies[i].name) + " is a leaf without mass";
  for (std::size_t i = 0; i < m.joints.size(); ++i) {
    const HingeOrSlider& joint = m.joints[i];
    std::vector<bool> moved(n, false);
    moved[joint.child] = true;
    double inertia = 0, scale = 0;
    for (std::size_t k = i; k < m.joints.size(); ++k) {
      const HingeOrSlider& j = m.joints[k];
      if (j.parent != kGround && moved[j.parent]) moved[j.child] = true;
      if (!moved[j.child]) continue;
      const Body& b = m.bodies[j.child];
      scale += b.mass;
      if (joint.type == JointType::kPrismatic)
        inertia += b.mass;
      else
        inertia += joint.axis.dot(b.inertia * joint.axis) +
                   b.mass * joint.axis.cross(b.center_of_mass - joint.anchor).squaredNorm();
    }
    if (!(inertia > 1e-12 * scale)) return quoted("joint", joint.name) + " moves no inertia about its axis";
  }
  return {};
}

std::string loop_fault(const Mechanism& m, const Loop& l) {
  const std::string who = quoted("loop", l.name);
  const int n = static_cast<int>(m.bodies.size());
  if (l.body_a >= n || l.body_b >= n) return who + " refers to a body that does not exist";
  if (l.body_a == l.body_b) return who + " joins a body to itself";
  if (!finite(l.point_a) || !finite(l.point_b)) return who + " has a number that is not finite";
  if (l.type == LoopType::kRevolute && !is_unit(l.axis)) return who + " has an axis that is not of length 1";
  if (l.type == LoopType::kDistance && (l.point_b - l.point_a).norm() < 1e-9)
    return who + " has points that coincide: use a point loop";
  return {};
}

std::string force_fault(const Mechanism& m, const Force& f) {
  const std::string who = quoted("force", f.name);
  const int n = static_cast<int>(m.bodies.size());
  if (f.body_a >= n || f.body_b >= n) return who + " refers to a body that does not exist";
  if (!finite(f.point_a) || !finite(f.point_b) || !finite(f.direction) || !std::isfinite(f.k) ||
      !std::isfinite(f.c) || !std::isfinite(f.rest_length))
    return who + " has a number that is not finite";
  if (f.type == ForceType::kSpringDamper && f.body_a == f.body_b) return who + " joins a body to itself";
  if (f.type == ForceType::kSpringDamper && (f.point_b - f.point_a).norm() < 1e-9)
    return who + " has points that coincide: its direction is undefined";
  const bool directed =
      f.type == ForceType::kContactPlane || (f.type == ForceType::kTyre && f.c_lateral != 0);
  if (directed && !is_unit(f.direction)) return who + " has a direction that is not of length 1";
  if (!(f.eps > 0)) return who + " has an eps that is not positive";
  for (const Pulse& p : f.road)
    if (!(p.width > 0)) return who + " has a road width that is not positive";
  return {};
}

}  // namespace

std::string fault_of(const Mechanism& m) {
  if (m.bodies.empty()) return "no bodies";
  if (!finite(m.gravity)) return "gravity is not finite";
  if (!(m.t_end > 0) || !std::isfinite(m.t_end)) return "t_end is not positive";
  for (const Body& b : m.bodies)
    if (std::string fault = body_fault(b); !fault.empty()) return fault;
  if (std::string fault = tree_fault(m); !fault.empty()) return fault;
  if (std::string fault = inertia_fault(m); !fault.empty()) return fault;
  for (const Loop& l : m.loops)
    if (std::string fault = loop_fault(m, l); !fault.empty()) return fault;
  for (const Force& f : m.forces)
    if (std::string fault = force_fault(m, f); !fault.empty()) return fault;
  for (const OutputPoint& p : m.points)
    if (p.body >= static_cast<int>(m.bodies.size()) || !finite(p.point))
      return quoted("point", p.name) + " refers to a body that does not exist";
  return {};
}

}  // namespace sinew::multibody
