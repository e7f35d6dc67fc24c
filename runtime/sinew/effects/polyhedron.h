// Boxes, capsules and convex solids as what they have in common: corners, faces and edges.
#pragma once

#include <array>
#include <span>

#include "sinew/effects/crossing_edges.h"
#include "sinew/effects/solid_gap.h"
#include "sinew/skeleton/convex_hull.h"

namespace sinew {

/// A solid where it stands, about the common origin; of a capsule its axis. 3 kB; 1000 flops for twenty
/// corners.
class Polyhedron {
 public:
  explicit Polyhedron(const PlacedShape<double>& shape);

  std::span<const Vec3<double>> corners() const { return {corners_.data(), corner_count_}; }
  std::span<const Vec3<double>> normals() const { return {normals_.data(), face_count_}; }  ///< of its faces
  double offset(std::size_t face) const { return offsets_[face]; }                          ///< m
  /// Between corners and faces; an axis has no faces (−1).
  std::span<const ConvexHull::Edge> edges() const { return edges_; }
  double radius() const { return radius_; }      ///< m about it, of a capsule
  double thinnest() const { return thinnest_; }  ///< m: half of where it is thinnest, or less

  const Vec3<double>& corner(int n) const { return corners_[static_cast<std::size_t>(n)]; }
  Vec3<double> half_axis(const ConvexHull::Edge& e) const { return (corner(e.to) - corner(e.from)) / 2; }
  Vec3<double> center(const ConvexHull::Edge& e) const { return (corner(e.to) + corner(e.from)) / 2; }
  /// Some direction out of the solid across an edge; zero where it has no faces.
  Vec3<double> outwards(const ConvexHull::Edge& e) const;
  /// Sine of how far a unit direction, square to the edge, is from those towards which it reaches furthest;
  /// negative within them.
  double beyond_support(const ConvexHull::Edge& e, const Vec3<double>& direction) const;
  /// m, how far it reaches in a direction, without its radius.
  double support(const Vec3<double>& direction) const;

 private:
  std::array<Vec3<double>, ConvexHull::kMostCorners> corners_;
  std::array<Vec3<double>, ConvexHull::kMostFaces> normals_;
  std::array<double, ConvexHull::kMostFaces> offsets_;
  std::size_t corner_count_ = 0, face_count_ = 0;
  std::span<const ConvexHull::Edge> edges_;
  double radius_ = 0, thinnest_ = 0;
};

/// As solid_gap(), of which this is the part for pairs with a convex solid, but that a capsule which is apart
/// from it is as far as it says: by the separating axis test over the faces of both and the edges that meet
/// in the solids' difference (Gregorius, "The Separating Axis Test between Convex Polyhedra", GDC 2013). 5 µs
/// for two barrels of eight sides, half a microsecond for wedges.
SolidGap<double> gap_of_hulls(const PlacedShape<double>& a, const PlacedShape<double>& b,
                              const Vec3<double>& before);

/// As separation(), where one of two polyhedra is a convex solid.
SignedDistance<double> separation_of_hulls(const Polyhedron& a, const Polyhedron& b);

}  // namespace sinew
