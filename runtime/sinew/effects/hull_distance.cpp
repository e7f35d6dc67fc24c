#include "sinew/effects/hull_distance.h"

#include <algorithm>
#include <limits>

namespace sinew {
namespace {

using Corners = std::span<const Vec3<double>>;

const Vec3<double>& at(Corners corners, int n) {
  return corners[static_cast<std::size_t>(n)];
}

double above(const ConvexHull::Face& face, const Vec3<double>& point) {
  return face.normal.dot(point) - face.offset;
}

/// Whether a point lies over a face's inside, seen from along its normal.
bool is_over(const ConvexHull& hull, const ConvexHull::Face& face, const Vec3<double>& point) {
  const std::span<const int> rim = hull.boundary(face);
  Vec3<double> from = at(hull.corners(), rim.back());
  for (const int n : rim) {
    const Vec3<double>& to = at(hull.corners(), n);
    if ((to - from).cross(face.normal).dot(point - from) > 0) return false;
    from = to;
  }
  return true;
}

/// The nearest of an edge or corner.
SignedDistance<double> to_edges(const ConvexHull& hull, const Vec3<double>& point) {
  double nearest = std::numeric_limits<double>::infinity();
  SignedDistance<double> d;
  Vec3<double> offset = Vec3<double>::UnitZ();
  for (const ConvexHull::Edge& edge : hull.edges()) {
    const Vec3<double>& from = at(hull.corners(), edge.from);
    const Vec3<double> along = at(hull.corners(), edge.to) - from, to_point = point - from;
    const double t = along.dot(to_point) / along.squaredNorm();
    const Vec3<double> off = to_point - std::clamp(t, 0.0, 1.0) * along;
    if (!(off.squaredNorm() < nearest)) continue;
    nearest = off.squaredNorm();
    offset = off;
    d.straight = t > 0 && t < 1 ? Vec3<double>(along.normalized()) : Vec3<double>(Vec3<double>::Zero());
  }
  d.distance = std::sqrt(nearest);
  d.normal = offset / d.distance;
  d.curvature = 1 / d.distance;
  return d;
}

constexpr double kTouching = 1e-9;  ///< m: nearer to an edge the face's normal is taken

}  // namespace

SignedDistance<double> hull_distance(const ConvexHull& hull, const Vec3<double>& point) {
  SignedDistance<double> inside{-std::numeric_limits<double>::infinity(), Vec3<double>::UnitZ(), 0,
                                Vec3<double>::Zero()};
  for (const ConvexHull::Face& face : hull.faces())
    if (const double beyond = above(face, point); beyond > inside.distance) {
      inside.distance = beyond;
      inside.normal = face.normal;
    }
  if (!(inside.distance > kTouching)) return inside;
  for (const ConvexHull::Face& face : hull.faces())
    if (const double beyond = above(face, point); beyond > 0 && is_over(hull, face, point))
      return {beyond, face.normal, 0, Vec3<double>::Zero()};
  return to_edges(hull, point);
}

std::vector<RoundedCorner> rounded_corners(const ConvexHull& hull, double rounding) {
  std::vector<RoundedCorner> rounded;
  for (std::size_t n = 0; n < hull.corners().size(); ++n) {
    // What leaves all of its faces as fast, by least squares where more than three meet.
    Mat3<double> square = Mat3<double>::Zero();
    Vec3<double> sum = Vec3<double>::Zero();
    for (const ConvexHull::Face& face : hull.faces()) {
      const std::span<const int> rim = hull.boundary(face);
      if (std::find(rim.begin(), rim.end(), static_cast<int>(n)) == rim.end()) continue;
      square += face.normal * face.normal.transpose();
      sum += face.normal;
    }
    RoundedCorner corner;
    corner.center = hull.corners()[n] - rounding * square.ldlt().solve(sum).normalized();
    corner.radius = std::numeric_limits<double>::infinity();
    for (const ConvexHull::Face& face : hull.faces())
      corner.radius = std::min(corner.radius, -above(face, corner.center));
    corner.radius = std::max(corner.radius, 0.0);
    rounded.push_back(corner);
  }
  return rounded;
}

}  // namespace sinew
