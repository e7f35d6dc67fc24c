// A mechanism as its file describes it: bodies, joints that hang them together as a tree, loops that close
// it, forces. Plain data; `fault_of` says what is wrong with it, `Model` (model.h) is what the formulations
// use.
//
// Positions, directions and inertias are world axes in the assembled (reference) configuration, in which
// every joint coordinate is 0. SI units.
#pragma once

#include <string>
#include <vector>

#include "sinew/skeleton/joint_type.h"
#include "sinew/skeleton/vector.h"

namespace sinew::multibody {

constexpr int kGround = -1;

struct Body {
  std::string name;
  double mass = 0;                                     ///< kg; 0: intermediate body of a multi-axis joint
  Vec3<double> center_of_mass = Vec3<double>::Zero();  ///< m
  Mat3<double> inertia = Mat3<double>::Zero();         ///< about the centre of mass, kg·m²
};

/// One smooth pulse A·exp(−((t − t0)/w)²).
struct Pulse {
  double amplitude = 0, center = 0, width = 1;
};
/// Sum of pulses at time t, and its rate.
double pulses_at(const std::vector<Pulse>& pulses, double t);
double pulses_rate(const std::vector<Pulse>& pulses, double t);

/// −stiffness·(q−r) − stiffness_cubic·(q−r)³ − damping·q' − friction_force·tanh(q'/friction_speed), with
/// r = rest + pulses. N or N·m per m or rad.
struct JointForce {
  double stiffness = 0, stiffness_cubic = 0, damping = 0, friction_force = 0, friction_speed = 1, rest = 0;
  std::vector<Pulse> rest_profile;
};

/// One axis between a parent (body or ground) and a child body. Spherical and cylindrical joints are chains.
struct HingeOrSlider {
  std::string name;
  JointType type = JointType::kRevolute;  ///< kRevolute or kPrismatic
  int parent = kGround;
  int child = 0;
  Vec3<double> anchor = Vec3<double>::Zero();  ///< a point of the axis
  Vec3<double> axis = Vec3<double>::UnitZ();   ///< unit, attached to both bodies
  double q0 = 0, qd0 = 0;                      ///< start, rad or m (and per s)
  JointForce force;
};

enum class LoopType : std::uint8_t {
  kPoint,     ///< two material points coincide: 3 equations
  kDistance,  ///< two points keep the distance of the reference configuration (a removed rod): 1 equation
  kRevolute,  ///< points coincide and axes stay parallel: 5 equations
};
constexpr int equation_count(LoopType type) {
  return type == LoopType::kPoint ? 3 : type == LoopType::kDistance ? 1 : 5;
}

struct Loop {
  std::string name;
  LoopType type = LoopType::kPoint;
  int body_a = kGround, body_b = kGround;
  Vec3<double> point_a = Vec3<double>::Zero(), point_b = Vec3<double>::Zero();
  Vec3<double> axis = Vec3<double>::UnitZ();  ///< revolute
};

enum class ForceType : std::uint8_t { kSpringDamper, kAnchorSpring, kContactPlane, kTyre, kTorque };
enum class SpringMode : std::uint8_t { kBoth, kTension, kCompression };

/// A force between bodies; which members count is said per type. With the smooth ramp
/// s(d) = (d + √(d² + eps²))/2:
/// spring damper  pull along the line a–b: both k(l−l0) + c·l'; tension/compression k·s(d) ± c·s'(d)·l'
/// anchor spring  on point_a of body_a: −k(p − point_b) − c·v, point_b fixed in space
/// contact plane  d = −n·(p − P), n·(k·s(d) + c·s'(d)·d') on body_a at p, opposite on body_b (plane body)
/// tyre           vertical at point_a of body_a, d = radius + road(t) − z; lateral −c_lateral(v·e)e below it
/// torque         constant, world axes, on body_a
struct Force {
  std::string name;
  ForceType type = ForceType::kSpringDamper;
  SpringMode mode = SpringMode::kBoth;
  int body_a = kGround, body_b = kGround;
  Vec3<double> point_a = Vec3<double>::Zero(), point_b = Vec3<double>::Zero();
  Vec3<double> direction = Vec3<double>::UnitZ();  ///< plane normal, lateral axis, or the torque itself
  double k = 0, c = 0;                             ///< N/m, N·s/m
  double rest_length = 0;                          ///< l0, m
  double eps = 1e-3;                               ///< m over which the ramp bends
  double radius = 0, c_lateral = 0;                ///< tyre
  std::vector<Pulse> road;
};

struct OutputPoint {
  std::string name;
  int body = kGround;
  Vec3<double> point = Vec3<double>::Zero();
};

struct Mechanism {
  std::string name;
  Vec3<double> gravity = Vec3<double>(0, 0, -9.81);
  double t_end = 1;
  std::vector<Body> bodies;
  std::vector<HingeOrSlider> joints;  ///< parents first, one per body
  std::vector<Loop> loops;
  std::vector<Force> forces;
  std::vector<OutputPoint> points;
};

/// What is wrong with the description, naming the element, or "" when a Model can be made of it: topology (a
/// tree, declared parent first), masses (every joint moves some inertia), finite numbers, unit axes.
/// Whether the loops can be closed is Equations' business.
std::string fault_of(const Mechanism& mechanism);

}  // namespace sinew::multibody
