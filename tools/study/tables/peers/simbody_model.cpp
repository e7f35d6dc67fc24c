#include "study/tables/peers/simbody_model.h"

#include <cmath>

namespace sinew::study {
namespace {

using multibody::Force;
using multibody::ForceType;
using multibody::JointForce;
using multibody::kGround;
using SimTK::MobilizedBody;
using SimTK::State;

/// The schema's ramp s(d), and the one-sided force k·s(d) + c·s'(d)·d'.
double one_sided(const Force& f, double d, double rate) {
  const double root = std::sqrt(d * d + f.eps * f.eps);
  return f.k * 0.5 * (d + root) + f.c * 0.5 * (1 + d / root) * rate;
}

double pull_of_spring(const Force& f, double length, double rate) {
  if (f.mode == multibody::SpringMode::kTension) return one_sided(f, length - f.rest_length, rate);
  if (f.mode == multibody::SpringMode::kCompression) return -one_sided(f, f.rest_length - length, -rate);
  return f.k * (length - f.rest_length) + f.c * rate;
}

SimTK::Vec3 vec(const Vec3<double>& v) {
  return {v.x(), v.y(), v.z()};
}

/// All force laws of the file. Stations are in body frames, whose axes are the world's in the reference
/// configuration.
class Forces : public SimTK::Force::Custom::Implementation {
 public:
  Forces(const multibody::Mechanism& mechanism, const SimTK::SimbodyMatterSubsystem& matter,
         const std::vector<MobilizedBody>& bodies, const std::vector<int>& joint_of)
      : mechanism_(mechanism), matter_(matter), bodies_(bodies), joint_of_(joint_of) {}

  bool dependsOnlyOnPositions() const override { return false; }
  SimTK::Real calcPotentialEnergy(const State&) const override { return 0; }

  void calcForce(const State& state, SimTK::Vector_<SimTK::SpatialVec>& on_bodies,
                 SimTK::Vector_<SimTK::Vec3>&, SimTK::Vector& on_mobilities) const override {
    const double t = state.getTime();
    for (std::size_t i = 0; i < mechanism_.joints.size(); ++i) {
      const JointForce& f = mechanism_.joints[i].force;
      const double q = bodies_[i].getOneQ(state, 0), u = bodies_[i].getOneU(state, 0);
      const double x = q - f.rest - multibody::pulses_at(f.rest_profile, t);
      const double pull = -f.stiffness * x - f.stiffness_cubic * x * x * x - f.damping * u -
                          f.friction_force * std::tanh(u / f.friction_speed);
      bodies_[i].applyOneMobilityForce(state, 0, pull, on_mobilities);
    }
    for (const Force& f : mechanism_.forces) apply(f, t, state, on_bodies);
  }

 private:
  struct End {
    const MobilizedBody& body;
    SimTK::Vec3 station;
  };

  End end(int file_body, const Vec3<double>& point) const {
    if (file_body == kGround) return {matter_.getGround(), vec(point)};
    const int joint = joint_of_[file_body];
    return {bodies_[joint], vec(Vec3<double>(point - mechanism_.joints[joint].anchor))};
  }

  void apply(const Force& f, double t, const State& s, SimTK::Vector_<SimTK::SpatialVec>& on) const {
    const auto [a, at] = end(f.body_a, f.point_a);
    const SimTK::Vec3 p = a.findStationLocationInGround(s, at), v = a.findStationVelocityInGround(s, at);
    switch (f.type) {
      case ForceType::kSpringDamper: {
        const auto [b, bt] = end(f.body_b, f.point_b);
        const SimTK::Vec3 apart = b.findStationLocationInGround(s, bt) - p;
        const double length = apart.norm();
        const SimTK::Vec3 line = apart / length;
        const double rate = dot(line, b.findStationVelocityInGround(s, bt) - v);
        const SimTK::Vec3 pull = pull_of_spring(f, length, rate) * line;
        a.applyForceToBodyPoint(s, at, pull, on);
        b.applyForceToBodyPoint(s, bt, -pull, on);
        break;
      }
      case ForceType::kAnchorSpring:
        a.applyForceToBodyPoint(s, at, -f.k * (p - vec(f.point_b)) - f.c * v, on);
        break;
      case ForceType::kContactPlane: {
        const auto [plane, pt] = end(f.body_b, f.point_b);
        const SimTK::Vec3 n = plane.expressVectorInGroundFrame(s, vec(f.direction));
        const SimTK::Vec3 there = plane.findStationAtGroundPoint(s, p);
        const double depth = -dot(n, p - plane.findStationLocationInGround(s, pt));
        const double rate = -dot(n, v - plane.findStationVelocityInGround(s, there));
        const SimTK::Vec3 push = one_sided(f, depth, rate) * n;
        a.applyForceToBodyPoint(s, at, push, on);
        plane.applyForceToBodyPoint(s, there, -push, on);
        break;
      }
      case ForceType::kTyre: {
        const double depth = f.radius + multibody::pulses_at(f.road, t) - p[2];
        const double rate = multibody::pulses_rate(f.road, t) - v[2];
        a.applyForceToBodyPoint(s, at, SimTK::Vec3(0, 0, one_sided(f, depth, rate)), on);
        if (f.c_lateral == 0) break;
        const SimTK::Vec3 patch = a.findStationAtGroundPoint(s, p - SimTK::Vec3(0, 0, f.radius));
        const SimTK::Vec3 e = a.expressVectorInGroundFrame(s, vec(f.direction));
        const double slip = dot(a.findStationVelocityInGround(s, patch), e);
        a.applyForceToBodyPoint(s, patch, -f.c_lateral * slip * e, on);
        break;
      }
      case ForceType::kTorque:
        a.applyBodyTorque(s, vec(f.direction), on);
        break;
    }
  }

  const multibody::Mechanism& mechanism_;
  const SimTK::SimbodyMatterSubsystem& matter_;
  const std::vector<MobilizedBody>& bodies_;
  std::vector<int> joint_of_;
};

}  // namespace

SimbodyModel::SimbodyModel(const multibody::Mechanism& m, const std::vector<bool>& one_angle)
    : matter(system), forces(system), mechanism_(m) {
  system.setUseUniformBackground(true);
  SimTK::Force::UniformGravity(forces, matter, vec(m.gravity));
  std::vector<int> joint_of(m.bodies.size());
  for (std::size_t i = 0; i < m.joints.size(); ++i) joint_of[m.joints[i].child] = static_cast<int>(i);
  for (const multibody::HingeOrSlider& j : m.joints) {
    const multibody::Body& b = m.bodies[j.child];
    const SimTK::Vec3 center = vec(Vec3<double>(b.center_of_mass - j.anchor));
    const SimTK::Inertia central(b.inertia(0, 0), b.inertia(1, 1), b.inertia(2, 2), b.inertia(0, 1),
                                 b.inertia(0, 2), b.inertia(1, 2));
    const SimTK::MassProperties mass(b.mass, center, central.shiftFromMassCenter(center, b.mass));
    const int parent = j.parent == kGround ? -1 : joint_of[j.parent];
    MobilizedBody& above = parent < 0 ? static_cast<MobilizedBody&>(matter.updGround()) : bodies[parent];
    const Vec3<double> from =
        parent < 0 ? Vec3<double>(j.anchor) : Vec3<double>(j.anchor - m.joints[parent].anchor);
    const bool turns = j.type == JointType::kRevolute;
    const SimTK::Rotation frame(SimTK::UnitVec3(vec(j.axis)),
                                turns ? SimTK::CoordinateAxis(2) : SimTK::CoordinateAxis(0));
    const SimTK::Transform in_parent(frame, vec(from)), in_child(frame);
    if (turns)
      bodies.push_back(MobilizedBody::Pin(above, in_parent, SimTK::Body::Rigid(mass), in_child));
    else
      bodies.push_back(MobilizedBody::Slider(above, in_parent, SimTK::Body::Rigid(mass), in_child));
  }
  const auto station = [&](int file_body, const Vec3<double>& point) {
    return file_body == kGround ? vec(point)
                                : vec(Vec3<double>(point - m.joints[joint_of[file_body]].anchor));
  };
  for (std::size_t i = 0; i < m.loops.size(); ++i) {
    const multibody::Loop& l = m.loops[i];
    MobilizedBody& a =
        l.body_a == kGround ? static_cast<MobilizedBody&>(matter.updGround()) : bodies[joint_of[l.body_a]];
    MobilizedBody& b =
        l.body_b == kGround ? static_cast<MobilizedBody&>(matter.updGround()) : bodies[joint_of[l.body_b]];
    const SimTK::Vec3 pa = station(l.body_a, l.point_a), pb = station(l.body_b, l.point_b);
    if (l.type == multibody::LoopType::kDistance) {
      SimTK::Constraint::Rod(a, pa, b, pb, (l.point_b - l.point_a).norm());
      continue;
    }
    SimTK::Constraint::Ball(a, pa, b, pb);
    if (l.type != multibody::LoopType::kRevolute) continue;
    const Vec3<double> one = l.axis.unitOrthogonal(), two = l.axis.cross(one);
    const auto keep_normal = [&](const Vec3<double>& normal) {
      SimTK::Constraint::ConstantAngle(a, SimTK::UnitVec3(vec(normal)), b, SimTK::UnitVec3(vec(l.axis)),
                                       SimTK::Pi / 2);
    };
    keep_normal(one);
    if (!one_angle[i]) keep_normal(two);
  }
  SimTK::Force::Custom(forces, new Forces(m, matter, bodies, joint_of));  // the subsystem takes ownership
}

SimTK::State SimbodyModel::start() const {
  SimTK::State state = system.realizeTopology();
  system.realizeModel(state);
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    bodies[i].setOneQ(state, 0, mechanism_.joints[i].q0);
    bodies[i].setOneU(state, 0, mechanism_.joints[i].qd0);
  }
  return state;
}

}  // namespace sinew::study
