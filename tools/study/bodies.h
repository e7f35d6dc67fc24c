// Characters made in code for hard cases: single bodies, chains, ropes.
#pragma once

#include "sinew/skeleton/skeleton.h"
#include "study/stage.h"

namespace sinew::study {

/// Diagonal of a solid box's inertia, kg·m²; `size` are full edge lengths (m).
Vec3<double> box_inertia(double mass, const Vec3<double>& size);

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

CharacterSettings limp();
WorldSettings weightless();
/// Bends joint `joint` from rest by the rotation vector (child axes).
template <class T>
void bend(const Skeleton& skeleton, std::vector<JointJet<T>>& jets, int joint, const Vec3<double>& rotation);

/// Joint speeds drawn from a normal distribution of the given rms (rad/s), in the joints' own freedoms.
template <class T>
void randomise_speeds(const Skeleton& skeleton, std::vector<JointJet<T>>& jets, double rms, unsigned seed);

/// A frictionless limp humanoid in the air, random joint speeds.
template <class T>
int add_thrown_humanoid(Stage<T>& stage, double height, double rms, unsigned seed);

Collider obstacle_box(const Vec3<double>& center, const Vec3<double>& half, double friction = 0.8);

}  // namespace sinew::study
