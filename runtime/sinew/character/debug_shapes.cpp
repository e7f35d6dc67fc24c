#include "sinew/character/debug_shapes.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "sinew/skeleton/convex_hull.h"

namespace sinew {
namespace {

constexpr int kSides = 16;  ///< of a circle

/// An arc about a centre, from one radius towards another, by so many times a whole turn.
void draw_arc(const Vec3<double>& center, const Vec3<double>& from, const Vec3<double>& towards, double turns,
              DebugColor color, DebugRenderer& renderer) {
  const int sides = static_cast<int>(kSides * turns);
  Vec3<double> last = center + from;
  for (int n = 1; n <= sides; ++n) {
    const double angle = 2 * std::numbers::pi * n / kSides;
    const Vec3<double> next = center + std::cos(angle) * from + std::sin(angle) * towards;
    renderer.line(last, next, color);
    last = next;
  }
}

void draw_box(const Vec3<double>& size, const Transform<double>& pose, DebugColor color,
              DebugRenderer& renderer) {
  const auto corner = [&](int n) {
    return pose * Vec3<double>(n & 1 ? size.x() : -size.x(), n & 2 ? size.y() : -size.y(),
                               n & 4 ? size.z() : -size.z());
  };
  for (int n = 0; n < 8; ++n)
    for (const int side : {1, 2, 4})
      if (!(n & side)) renderer.line(corner(n), corner(n | side), color);
}

void draw_edges(const ConvexHull& hull, const Transform<double>& pose, DebugColor color,
                DebugRenderer& renderer) {
  for (const ConvexHull::Edge& e : hull.edges())
    renderer.line(pose * hull.corners()[static_cast<std::size_t>(e.from)],
                  pose * hull.corners()[static_cast<std::size_t>(e.to)], color);
}

/// Left of the way from a to b, seen from above.
bool is_left(const Vec3<double>& a, const Vec3<double>& b, const Vec3<double>& c) {
  return (b.x() - a.x()) * (c.y() - a.y()) - (b.y() - a.y()) * (c.x() - a.x()) > 0;
}

}  // namespace

void draw_shape(const Collider& shape, const Transform<double>& pose, DebugColor color,
                DebugRenderer& renderer) {
  if (shape.shape == Shape::kBox) return draw_box(shape.size, pose, color, renderer);
  if (shape.shape == Shape::kConvex) return draw_edges(*shape.hull, pose, color, renderer);
  const double radius = shape.size.x(), half = shape.shape == Shape::kCapsule ? shape.size.z() : 0;
  const Mat3<double> axes = radius * pose.rotation.toRotationMatrix();
  const Vec3<double> x = axes.col(0), y = axes.col(1), z = axes.col(2);
  const Vec3<double> top = pose * Vec3<double>(0, 0, half), bottom = pose * Vec3<double>(0, 0, -half);
  draw_arc(top, x, y, 1, color, renderer);
  if (half > 0) draw_arc(bottom, x, y, 1, color, renderer);
  for (const Vec3<double>& side : {x, y}) {
    draw_arc(top, side, z, 0.5, color, renderer);
    draw_arc(bottom, side, -z, 0.5, color, renderer);
    if (!(half > 0)) continue;
    renderer.line(top + side, bottom + side, color);
    renderer.line(top - side, bottom - side, color);
  }
}

void draw_cross(const Vec3<double>& at, double size, DebugColor color, DebugRenderer& renderer) {
  for (int k = 0; k < 3; ++k) {
    const Vec3<double> arm = size * Vec3<double>::Unit(k);
    renderer.line(at - arm, at + arm, color);
  }
}

void draw_mark(const Vec3<double>& at, double size, DebugColor color, DebugRenderer& renderer) {
  for (int n = 0; n < 8; ++n) {
    const auto corner = [&](int k) {
      return Vec3<double>(at + (n & (1 << k) ? size : -size) * Vec3<double>::Unit(k));
    };
    renderer.triangle(corner(0), corner(1), corner(2), color);
  }
}

void draw_hull(std::span<Vec3<double>> points, DebugColor color, DebugRenderer& renderer) {
  std::sort(points.begin(), points.end(), [](const Vec3<double>& a, const Vec3<double>& b) {
    return a.x() != b.x() ? a.x() < b.x() : a.y() < b.y();
  });
  // Andrew's monotone chain: below from left to right, above back again.
  std::vector<Vec3<double>> hull;
  const auto extend = [&](const Vec3<double>& p, std::size_t first) {
    while (hull.size() > first + 1 && !is_left(hull[hull.size() - 2], hull.back(), p)) hull.pop_back();
    hull.push_back(p);
  };
  for (const Vec3<double>& p : points) extend(p, 0);
  const std::size_t below = hull.empty() ? 0 : hull.size() - 1;
  for (auto p = points.rbegin(); p != points.rend(); ++p)
    if (p != points.rbegin()) extend(*p, below);
  if (hull.size() > 1) hull.pop_back();  // the first again
  for (std::size_t n = 0; n < hull.size() && hull.size() > 1; ++n)
    renderer.line(hull[n], hull[(n + 1) % hull.size()], color);
  for (std::size_t n = 2; n < hull.size(); ++n) renderer.triangle(hull[0], hull[n - 1], hull[n], color);
}

}  // namespace sinew
