#include "sinew/behaviour/sole.h"

#include <algorithm>
#include <limits>

namespace sinew {
namespace {

double cross(const Vec2& a, const Vec2& b) {
  return a.x() * b.y() - a.y() * b.x();
}

}  // namespace

void Sole::close() {
  const std::span<Vec2> all(corners_.data(), count_);
  std::sort(all.begin(), all.end(),
            [](const Vec2& a, const Vec2& b) { return a.x() != b.x() ? a.x() < b.x() : a.y() < b.y(); });
  std::array<Vec2, 2 * kMostCorners> hull;
  std::size_t size = 0;
  const auto turn = [&](const Vec2& next, std::size_t least) {
    while (size >= least && cross(hull[size - 1] - hull[size - 2], next - hull[size - 2]) <= 0) --size;
    hull[size++] = next;
  };
  for (const Vec2& p : all) turn(p, 2);
  const std::size_t lower = size + 1;
  for (std::size_t n = count_; n-- > 1;) turn(all[n - 1], lower);
  count_ = count_ > 1 ? size - 1 : count_;
  std::copy_n(hull.begin(), count_, corners_.begin());
}

Vec2 Sole::middle() const {
  Vec2 sum = Vec2::Zero();
  for (const Vec2& c : corners()) sum += c;
  return empty() ? sum : Vec2(sum / double(count_));
}

double Sole::depth(const Vec2& point) const {
  if (count_ < 3) return -(point - middle()).norm();
  double depth = std::numeric_limits<double>::infinity();
  for (std::size_t n = 0; n < count_; ++n) {
    const Vec2 &a = corners_[n], &b = corners_[(n + 1) % count_];
    const Vec2 edge = b - a;
    if (const double length = edge.norm(); length > 0)
      depth = std::min(depth, cross(edge, point - a) / length);
  }
  return depth;
}

Vec2 Sole::nearest(const Vec2& point, double margin) const {
  if (depth(point) >= margin) return point;
  // Corners moved towards the middle until they are `margin` inside; then the nearest point of the edges.
  const Vec2 center = middle();
  const double inside = depth(center);
  if (count_ < 3 || inside <= margin) return center;
  const double keep = 1 - margin / inside;
  Vec2 best = center;
  double nearest = std::numeric_limits<double>::infinity();
  for (std::size_t n = 0; n < count_; ++n) {
    const Vec2 a = center + keep * (corners_[n] - center),
               b = center + keep * (corners_[(n + 1) % count_] - center), edge = b - a;
    const double square = edge.squaredNorm();
    const double share = square > 0 ? std::clamp(edge.dot(point - a) / square, 0.0, 1.0) : 0;
    const Vec2 at = a + share * edge;
    if (const double distance = (at - point).squaredNorm(); distance < nearest) {
      nearest = distance;
      best = at;
    }
  }
  return best;
}

}  // namespace sinew
