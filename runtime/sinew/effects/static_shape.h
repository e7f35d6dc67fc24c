// Static surroundings that are no sphere, capsule or box: height fields, convex solids, and whatever the
// host's own collision world answers.
#pragma once

#include <algorithm>
#include <cstddef>
#include <span>
#include <vector>

#include "sinew/effects/contact.h"

namespace sinew {

/// Answers how far a point is from something that does not move. Implement it to let characters collide with
/// the host's world. Called within steps, often, from the thread that steps: no exceptions, no locks, no
/// allocation, and the same answer to the same point, or runs will not repeat.
class StaticShape {
 public:
  virtual ~StaticShape() = default;
  /// At a world point (m): distance, negative inside, and the outward unit normal, its gradient. Exact near
  /// the surface; further off a lower bound will do. Continuous, or what touches there will jump.
  virtual SignedDistance<double> distance(const Vec3<double>& point) const noexcept = 0;
  /// Half the thickness of its thinnest part, m: what moves further than that in a step is swept.
  virtual double half_thickness() const noexcept { return 1e9; }
};

/// Half the thickness of what a contact meets, m; of edges, of the thinner of the two.
template <class T>
T half_thickness(const Contact<T>& c) {
  if (c.plane) return T(1e9);
  if (c.host) return T(c.host->half_thickness());
  const T half = c.shape == Shape::kBox ? c.size.minCoeff() : c.size.x();
  return c.meeting == Meeting::kEdges ? std::min(half, T(c.solid_a->size.minCoeff())) : half;
}

/// Heights z over a grid in x and y, interpolated by Catmull–Rom patches: smooth, and the samples are met.
/// Solid below; beyond its edges the border's height goes on.
class HeightField final : public StaticShape {
 public:
  /// `heights` [row · columns + column] in m; column c lies at x = corner.x + c·spacing, row r at
  /// y = corner.y + r·spacing; `corner.z` is added to all. At least 1 × 1; copied.
  HeightField(std::span<const double> heights, std::size_t columns, const Vec3<double>& corner,
              double spacing);
  SignedDistance<double> distance(const Vec3<double>& point) const noexcept override;
  /// Height over (x, y), and its derivatives by both.
  double height(double x, double y, double& by_x, double& by_y) const noexcept;

 private:
  double sample(long column, long row) const noexcept;

  std::vector<double> heights_;
  long columns_ = 0, rows_ = 0;
  Vec3<double> corner_;
  double spacing_;
};

/// Intersection of half spaces normal·x ≤ offset, world axes, unit normals: the faces of a convex solid.
/// Exact inside and over faces; over edges and corners a lower bound, as if they were not rounded off.
class ConvexSolid final : public StaticShape {
 public:
  /// One half space.
  struct Face {
    Vec3<double> normal = Vec3<double>::UnitZ();  ///< unit, outwards
    double offset = 0;                            ///< m
  };
  /// `inner_radius`: of a ball that fits inside, m.
  ConvexSolid(std::span<const Face> faces, double inner_radius);
  SignedDistance<double> distance(const Vec3<double>& point) const noexcept override;
  double half_thickness() const noexcept override { return inner_radius_; }

 private:
  std::vector<Face> faces_;
  double inner_radius_;
};

}  // namespace sinew
