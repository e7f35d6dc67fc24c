// A convex solid with flat faces: rocks, wedges, barrels, ramps. Made of points once, outside a step, and
// named by colliders.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "sinew/skeleton/status.h"
#include "sinew/skeleton/vector.h"

namespace sinew {

struct Collider;

/// The hull of points. Whoever keeps it keeps it where it is while a collider names it; any number of
/// colliders may.
class ConvexHull {
 public:
  static constexpr int kMostCorners = 32;                    ///< that it keeps, see make()
  static constexpr int kMostFaces = 2 * (kMostCorners - 2);  ///< all of them triangles
  static constexpr int kMostEdges = 3 * (kMostCorners - 2);  ///< likewise

  /// A flat face: normal·x ≤ offset inside.
  struct Face {
    Vec3<double> normal = Vec3<double>::UnitZ();  ///< unit, outwards
    double offset = 0;                            ///< m
    int first = 0;                                ///< of its corners in their list, see boundary()
    int count = 0;                                ///< how many there are
  };
  /// Where two faces meet.
  struct Edge {
    int from = 0;   ///< corner
    int to = 0;     ///< corner
    int left = 0;   ///< face, from outside, on the way from one corner to the other
    int right = 0;  ///< face
  };

  /// The hull of at least four points (m, in the axes of the shape) that do not lie in a plane. What lies
  /// nearer to it than 1e-5 of its size is taken to lie on it. Of more than kMostCorners corners those that
  /// reach furthest are kept, one after the other: the solid is then smaller by up to left_out().
  /// kInvalidArgument (`index`: the point): too few, not finite, flat, or further than 1e6 m.
  /// O(points · corners).
  static Status make(std::span<const Vec3<double>> points, ConvexHull& out);

  /// Its corners, m, in the axes of the shape.
  std::span<const Vec3<double>> corners() const { return corners_; }
  /// Its faces; those in one plane are one.
  std::span<const Face> faces() const { return faces_; }
  /// Its edges, each once.
  std::span<const Edge> edges() const { return edges_; }
  /// The corners of a face, anticlockwise from outside.
  std::span<const int> boundary(const Face& face) const {
    return std::span(boundary_).subspan(static_cast<std::size_t>(face.first),
                                        static_cast<std::size_t>(face.count));
  }
  /// m, how far the point furthest outside lies that had no room.
  double left_out() const { return left_out_; }
  /// m, of the ball about the centre of mass that fits inside.
  double inner_radius() const { return inner_radius_; }
  /// m, about the origin of the shape: of the ball that holds it.
  double bounding_radius() const { return bounding_radius_; }
  /// m², what of it is seen along each axis of the shape.
  const Vec3<double>& shadow() const { return shadow_; }
  /// m³.
  double volume() const { return volume_; }
  /// m, of uniform density.
  const Vec3<double>& center_of_mass() const { return center_of_mass_; }
  /// kg·m² by kg, about the centre of mass, in the axes of the shape.
  const Mat3<double>& inertia_by_mass() const { return inertia_by_mass_; }

 private:
  bool take_triangles(std::span<const Vec3<double>> points, std::span<const std::array<int, 3>> triangles,
                      double flat);
  void measure();

  std::vector<Vec3<double>> corners_;
  std::vector<Face> faces_;
  std::vector<Edge> edges_;
  std::vector<int> boundary_;
  double left_out_ = 0, inner_radius_ = 0, bounding_radius_ = 0, volume_ = 0;
  Vec3<double> center_of_mass_ = Vec3<double>::Zero(), shadow_ = Vec3<double>::Zero();
  Mat3<double> inertia_by_mass_ = Mat3<double>::Zero();
};

/// A collider of a joint's that has the shape of a hull, whose axes are the joint's.
Collider convex_collider(const ConvexHull& hull, int joint = 0);

}  // namespace sinew
