// Skeletons made in code: single bodies, chains, ropes. Scene files ask for them by `figure`.
#pragma once

#include "sinew/skeleton/skeleton.h"

namespace sinew::scene {

/// Diagonal of a solid box's inertia, kg·m²; `size` are full edge lengths (m).
Vec3<double> box_inertia(double mass, const Vec3<double>& size);

/// Of a uniform round rod from the joint at 0 to `along`, m, about its middle, kg·m²; slender ones (radius 0)
/// do not resist turning about themselves.
inline Mat3<double> rod_inertia(double mass, const Vec3<double>& along, double radius) {
  const Vec3<double> unit = along.normalized();
  const Mat3<double> across = Mat3<double>::Identity() - unit * unit.transpose();
  return mass * ((along.squaredNorm() / 12 + radius * radius / 4) * across +
                 radius * radius / 2 * (unit * unit.transpose()));
}

/// One free body without colliders.
Skeleton free_body(double mass, const Vec3<double>& inertia);

/// One free box with a box collider; `size` are full edge lengths (m).
Skeleton box_body(double mass, const Vec3<double>& size, double friction = 0.8);

Skeleton ball_body(double mass, double radius, double friction = 0.8);

/// Links hanging down from the world (or from a free root link), each a rod along −z.
struct ChainShape {
  int links = 5;
  JointType joint = JointType::kRevolute;  ///< between links
  JointType root = JointType::kRevolute;   ///< of the first link
  double length = 1;                       ///< m, of one link
  double first_mass = 1, last_mass = 1;    ///< kg; geometric in between
  double radius = 0.02;                    ///< m
  bool colliders = false;
};
/// Joint types only; no muscles, damping or dry friction.
Skeleton chain(const ChainShape& shape);

/// No muscles, damping or dry friction in any joint.
void make_frictionless(Skeleton& skeleton);

}  // namespace sinew::scene
