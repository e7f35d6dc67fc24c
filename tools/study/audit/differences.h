// Velocities of a rigid body from nothing but where it was: differences of its recorded poses.
#pragma once

#include <array>
#include <span>

#include "study/audit/member.h"

namespace sinew::audit {

/// Weights of values at `times` in the first and the second derivative at `at` of the polynomial through
/// them; times may be spaced as they like. Source: Fornberg, "Generation of finite difference formulas on
/// arbitrarily spaced grids", 1988. At most 9 points.
struct Weights {
  std::array<double, 9> first{}, second{};

  Weights() = default;
  Weights(std::span<const double> times, double at);
};

/// Central differences about one of several instants, of order 2, 4, 6 and 8 as far as there are so many.
struct Stencils {
  static constexpr int kMostAside = 4;

  int node = 0;                                ///< index of the instant
  int aside = 0;                               ///< instants on either side of it
  std::array<double, 2 * kMostAside> steps{};  ///< s, one after the other; the node is in their middle
  int even = 0;  ///< of these, those to which no step is ten times as long as another: others tell nothing
  std::array<Weights, kMostAside> weights;  ///< [instants on either side that count − 1]

  Stencils(std::span<const double> times, int node);
};

/// A vector and how far it may be off.
struct Estimate {
  Eigen::Vector3d value = Eigen::Vector3d::Zero();
  double error = 0;  ///< length; infinite where nothing is known
  /// By how much it may be longer: more than `error` where an impact is within four steps, for steps beside
  /// one may hide others.
  double longer = 0;
};

struct Velocity {
  Estimate linear;      ///< of the centre of mass, world, m/s
  Estimate angular;     ///< rad/s, in the body's own axes
  bool smooth = false;  ///< differences of both converge: no impact is near
  double turn = 0;      ///< rad, the larger of the two steps' that meet at the instant
};

/// Velocity of a body at an instant from its poses (body → world) around it. Differences are believed where
/// both those of the positions' first and of their second derivatives converge, each order's correction below
/// 0.15 of the one before: the eighth order then, with four times the sixth's correction as its error. A jump
/// within reach makes them diverge, wherever in a step it lies; then only the steps beside the instant count,
/// and the error is half of what the mean velocities of neighbouring ones differ by; how much longer it may
/// be, half of the most that any two neighbours within four steps differ by. `precision`: what coordinates
/// and rotations are rounded to, of their size. A body that turns by more than 2.5 rad between two poses
/// cannot be followed: infinite error.
Velocity velocity_at(const Body& body, std::span<const Transform<double>> poses, const Stencils& stencils,
                     double precision);

/// Mean velocity over a step of `h` seconds between two poses. Errors: rounding, and of the angular part axes
/// that turn within the step, (hω)²/12.
Velocity chord(const Body& body, const Transform<double>& before, const Transform<double>& after, double h,
               double precision);

/// Velocity of a point (in body axes) at the last of the poses, from them alone: one-sided differences, as
/// many points as agree best.
Estimate arriving_velocity(const Eigen::Vector3d& point, std::span<const Transform<double>> poses,
                           std::span<const double> times);

}  // namespace sinew::audit
