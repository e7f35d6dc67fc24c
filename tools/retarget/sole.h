// The part of a limb that touches the floor, and clips as frames.
#pragma once

#include <span>
#include <vector>

#include "sinew/animation/clip.h"
#include "sinew/effects/contact.h"
#include "sinew/skeleton/skeleton.h"

namespace sinew::retarget {

/// A clip, sampled evenly. The last frame of a loop is its first, one root step on.
struct Motion {
  double rate = 30;  ///< frames a second
  bool loops = false;
  std::vector<std::vector<Transform<double>>> local, model;  ///< [frame][joint]

  int intervals() const { return static_cast<int>(local.size()) - 1; }
};

/// At twice the rate of the clip's knots, at least `least_rate` and at most 240 Hz (or that). Empty where the
/// clip cannot be sampled.
Motion sample_motion(const Clip& clip, const Skeleton& skeleton, double least_rate = 120);

/// Points that may touch the floor, of a joint and all below it; the joint's own origin where there are no
/// colliders.
struct Sole {
  Sole(const Skeleton& skeleton, int joint);
  int joint;
  std::vector<ContactPoint<double>> points;
};

/// What of a sole is lowest, as weights: exp(−height / width), so that a foot that rolls from heel to toe
/// moves smoothly. Its height is a mean with sharper weights: a fraction of a millimetre above the lowest
/// point.
struct Patch {
  double low = 0;                ///< m, relative to the joint's origin
  std::vector<Vec3<double>> at;  ///< [point] the same, model axes
  std::vector<double> share;     ///< [point] sum 1
};
Patch patch_of(const Sole& sole, std::span<const Transform<double>> model, double width);

/// How far the sole's material moves over the floor from one frame to the next, m, if its joint moves by
/// `travel`: rolling is no slip.
Vec3<double> slip(const Patch& before, const Patch& after, const Vec3<double>& travel);

}  // namespace sinew::retarget
