#include "sinew/residual/scale.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace sinew {
namespace {

/// Of the 37-DOF humanoid, as scale_of measures it: m, kg, kg·m.
constexpr double kHumanLength = 0.9543741226622547, kHumanMass = 75.4, kHumanLoad = 16.295624051978606;
constexpr double kLargeThing = 2, kSmallThing = 1.0 / 32;  ///< of a human's length: see scale_of
constexpr int kDigits = 30;  ///< binary ones that are kept: what compilers round differently is no size

/// To so many digits.
double rounded(double x) {
  int exponent = 0;
  const double digits = std::frexp(x, &exponent);
  return std::ldexp(std::round(std::ldexp(digits, kDigits)), exponent - kDigits);
}

/// `measured` by what it is of the human; 1 where there is nothing to measure.
double share_of(double measured, double of_human) {
  return measured > 0 && std::isfinite(measured) ? rounded(measured / of_human) : 1;
}

bool turns(JointType type) {
  return type == JointType::kRevolute || type == JointType::kUniversal || type == JointType::kBall ||
         type == JointType::kPlanar;
}

}  // namespace

Scale<double> scale_of(const Skeleton& skeleton) {
  const int bodies = skeleton.body_count;
  std::vector<Transform<double>> at_rest;
  std::vector<Vec3<double>> center;
  Vec3<double> middle = Vec3<double>::Zero();
  double mass = 0;
  bool bends = false;
  for (int i = 0; i < bodies; ++i) {
    const Joint& joint = skeleton.joints[i];
    at_rest.push_back(joint.parent < 0 ? joint.rest : at_rest[joint.parent] * joint.rest);
    center.push_back(at_rest[i] * joint.center_of_mass);
    middle += joint.mass * center[i];
    mass += joint.mass;
    bends = bends || turns(joint.type) || (joint.type == JointType::kFree && joint.parent >= 0);
  }
  if (!(mass > 0)) return {};
  middle /= mass;
  double length = 0, load = 0;
  std::vector<double> hanging(bodies, 0.0);
  for (int i = 0; i < bodies; ++i) {
    const Joint& joint = skeleton.joints[i];
    if (joint.mass > 0)
      length =
          std::max(length, (center[i] - middle).norm() + std::sqrt(joint.inertia.trace() / 2 / joint.mass));
    for (int above = i; above >= 0; above = skeleton.joints[above].parent)
      hanging[above] += joint.mass * (center[i] - at_rest[above].translation).norm();
  }
  for (int i = 0; i < bodies; ++i)
    if (turns(skeleton.joints[i].type)) load = std::max(load, hanging[i]);
  Scale<double> scale;
  scale.length = share_of(length, kHumanLength);
  if (!bends) scale.length = std::clamp(1.0, scale.length / kLargeThing, scale.length / kSmallThing);
  scale.time = std::sqrt(scale.length);
  // What is lighter for its length, as a chain, rounds its energy no finer.
  const double of_length = scale.length * scale.length * scale.length * scale.length;
  scale.energy = bends ? std::max(share_of(mass, kHumanMass) * scale.length, of_length) : scale.length;
  scale.load = share_of(load, kHumanLoad);
  return scale;
}

}  // namespace sinew
