#include "sinew/skeleton/convex_hull.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "sinew/skeleton/skeleton.h"

namespace sinew {
namespace {

constexpr double kOnIt = 1e-5;      ///< of its size: nearer points lie on it
constexpr double kRounding = 1e-9;  ///< of its size
constexpr double kOnePlane = 1e-4;  ///< rad, between faces that are one
constexpr double kFurthest = 1e6;   ///< m

using Triangle = std::array<int, 3>;
using Points = std::span<const Vec3<double>>;

struct Plane {
  Vec3<double> normal;
  double offset;

  double above(const Vec3<double>& point) const { return normal.dot(point) - offset; }
};

Plane plane_of(Points points, const Triangle& t) {
  const Vec3<double>&a = points[t[0]], &b = points[t[1]], &c = points[t[2]];
  const Vec3<double> normal = (b - a).cross(c - a).normalized();
  return {normal, normal.dot(a + b + c) / 3};
}

/// Which of the points is furthest by a measure, and by how much.
template <class Measure>
std::pair<int, double> furthest(Points points, const Measure& measure) {
  std::pair<int, double> best(0, -std::numeric_limits<double>::infinity());
  for (std::size_t n = 0; n < points.size(); ++n)
    if (const double far = measure(points[n]); far > best.second) best = {static_cast<int>(n), far};
  return best;
}

/// Hull of points, which grows by whatever is furthest outside (Barber, Dobkin and Huhdanpaa, "The Quickhull
/// algorithm for convex hulls", 1996), all points looked at each time.
class Quickhull {
 public:
  Quickhull(Points points, double size) : points_(points), size_(size) {}

  /// A tetrahedron of four that are far from each other. Where it is flat, so are all points.
  bool begin() {
    const auto apart = [&](int from) {
      return furthest(points_, [&](const Vec3<double>& p) { return (p - points_[from]).squaredNorm(); });
    };
    const int a = apart(0).first, b = apart(a).first;
    const Vec3<double> along = (points_[b] - points_[a]).normalized();
    const auto [c, beside] =
        furthest(points_, [&](const Vec3<double>& p) { return along.cross(p - points_[a]).norm(); });
    if (!(beside > kOnIt * size_)) return false;
    const Plane base = plane_of(points_, {a, b, c});
    const auto [d, height] =
        furthest(points_, [&](const Vec3<double>& p) { return std::abs(base.above(p)); });
    if (!(height > kOnIt * size_)) return false;
    const bool over = base.above(points_[d]) > 0;
    const int first = over ? c : b, second = over ? b : c;
    for (const Triangle& t : {Triangle{a, first, second}, Triangle{a, second, d}, Triangle{second, first, d},
                              Triangle{first, a, d}})
      triangles_.push_back(t), planes_.push_back(plane_of(points_, t));
    return true;
  }

  /// Until `most` corners; returns how far the next would have been outside, m.
  double grow(int most) {
    for (int corners = 4;; ++corners) {
      double far = kOnIt * size_;
      int next = -1;
      for (std::size_t p = 0; p < points_.size(); ++p)
        if (const double outside = outside_of(points_[p]); outside > far) far = outside, next = int(p);
      if (next < 0) return 0;
      if (corners == most) return far;
      add(next);
    }
  }

  std::span<const Triangle> triangles() const { return triangles_; }

 private:
  double outside_of(const Vec3<double>& point) const {
    double most = -std::numeric_limits<double>::infinity();
    for (const Plane& p : planes_) most = std::max(most, p.above(point));
    return most;
  }

  /// Takes away what a point sees, and spans new triangles from the rim.
  void add(int point) {
    std::vector<Triangle> seen, kept;
    for (std::size_t t = 0; t < triangles_.size(); ++t)
      (planes_[t].above(points_[point]) > kRounding * size_ ? seen : kept).push_back(triangles_[t]);
    const auto has = [&](int from, int to) {
      return std::any_of(seen.begin(), seen.end(), [&](const Triangle& t) {
        return (t[0] == from && t[1] == to) || (t[1] == from && t[2] == to) || (t[2] == from && t[0] == to);
      });
    };
    for (const Triangle& t : seen)
      for (int k = 0; k < 3; ++k)
        if (const int from = t[k], to = t[(k + 1) % 3]; !has(to, from)) kept.push_back({from, to, point});
    triangles_ = std::move(kept);
    planes_.clear();
    for (const Triangle& t : triangles_) planes_.push_back(plane_of(points_, t));
  }

  Points points_;
  double size_;
  std::vector<Triangle> triangles_;
  std::vector<Plane> planes_;
};

/// An edge of a triangle, as it goes round.
struct HalfEdge {
  int from, to, triangle;
};

std::vector<HalfEdge> half_edges(std::span<const Triangle> triangles) {
  std::vector<HalfEdge> all;
  for (std::size_t t = 0; t < triangles.size(); ++t)
    for (int k = 0; k < 3; ++k) all.push_back({triangles[t][k], triangles[t][(k + 1) % 3], int(t)});
  return all;
}

/// The triangle on the other side; −1: none, and the hull has a hole.
int opposite(std::span<const HalfEdge> edges, const HalfEdge& of) {
  const auto found = std::find_if(edges.begin(), edges.end(),
                                  [&](const HalfEdge& e) { return e.from == of.to && e.to == of.from; });
  return found == edges.end() ? -1 : found->triangle;
}

/// Numbers for triangles: the same for those in one plane that hang together.
std::vector<int> group_by_plane(Points points, std::span<const Triangle> triangles,
                                std::span<const HalfEdge> edges, double flat) {
  std::vector<int> group(triangles.size(), -1);
  int groups = 0;
  for (std::size_t seed = 0; seed < triangles.size(); ++seed) {
    if (group[seed] >= 0) continue;
    const Vec3<double> normal = plane_of(points, triangles[seed]).normal;
    std::vector<int> open{static_cast<int>(seed)};
    group[seed] = groups;
    while (!open.empty()) {
      const int t = open.back();
      open.pop_back();
      for (const HalfEdge& e : edges) {
        if (e.triangle != t) continue;
        const int next = opposite(edges, e);
        if (next < 0 || group[next] >= 0) continue;
        if (!(normal.cross(plane_of(points, triangles[next]).normal).norm() < flat)) continue;
        group[next] = groups;
        open.push_back(next);
      }
    }
    ++groups;
  }
  return group;
}

}  // namespace

/// Faces, edges and corners of triangles of which those in one plane are one. False where they are not the
/// surface of one solid.
bool ConvexHull::take_triangles(Points points, std::span<const Triangle> triangles, double flat) {
  corners_.clear(), faces_.clear(), edges_.clear(), boundary_.clear();
  const std::vector<HalfEdge> all = half_edges(triangles);
  const std::vector<int> group = group_by_plane(points, triangles, all, flat);
  std::vector<int> corner(points.size(), -1);
  const auto corner_of = [&](int point) {
    if (corner[point] < 0) {
      corner[point] = static_cast<int>(corners_.size());
      corners_.push_back(points[point]);
    }
    return corner[point];
  };
  const int groups = 1 + *std::max_element(group.begin(), group.end());
  for (int g = 0; g < groups; ++g) {
    std::vector<HalfEdge> rim;
    Vec3<double> normal = Vec3<double>::Zero();
    for (const HalfEdge& e : all) {
      if (group[e.triangle] != g) continue;
      const int other = opposite(all, e);
      if (other < 0) return false;
      if (group[other] != g) rim.push_back(e);
      normal += points[e.from].cross(points[e.to]);  // twice its area
    }
    if (rim.empty() || !(normal.norm() > 0)) return false;
    Face face;
    face.normal = normal.normalized();
    face.first = static_cast<int>(boundary_.size());
    face.count = static_cast<int>(rim.size());
    std::size_t at = 0;
    for (std::size_t n = 0; n < rim.size(); ++n) {
      const int from = corner_of(rim[at].from), to = corner_of(rim[at].to);
      boundary_.push_back(from);
      const int other = group[opposite(all, rim[at])];
      if (g < other) edges_.push_back({from, to, g, other});
      const auto next =
          std::find_if(rim.begin(), rim.end(), [&](const HalfEdge& e) { return e.from == rim[at].to; });
      if (next == rim.end()) return false;
      at = static_cast<std::size_t>(next - rim.begin());
    }
    if (at != 0) return false;
    faces_.push_back(face);
  }
  for (Face& face : faces_) {
    face.offset = -std::numeric_limits<double>::infinity();
    for (const Vec3<double>& c : corners_) face.offset = std::max(face.offset, face.normal.dot(c));
  }
  return corners_.size() + faces_.size() == edges_.size() + 2;  // Euler
}

/// By tetrahedra from a corner.
void ConvexHull::measure() {
  const Vec3<double> apex = corners_[0];
  Vec3<double> first = Vec3<double>::Zero();
  Mat3<double> second = Mat3<double>::Zero();  // ∫ x·xᵀ about the apex
  volume_ = 0;
  shadow_.setZero();
  for (const Face& face : faces_) {
    const std::span<const int> rim = boundary(face);
    for (std::size_t n = 2; n < rim.size(); ++n) {
      Mat3<double> arms;
      arms << corners_[rim[0]] - apex, corners_[rim[n - 1]] - apex, corners_[rim[n]] - apex;
      const double volume = arms.determinant() / 6;
      const Vec3<double> side = arms.col(1) - arms.col(0), other = arms.col(2) - arms.col(0);
      shadow_ += side.cross(other).cwiseAbs() / 4;  // front and back
      const Vec3<double> sum = arms.rowwise().sum();
      volume_ += volume;
      first += volume / 4 * sum;
      second += volume / 20 * (arms * arms.transpose() + sum * sum.transpose());
    }
  }
  const Vec3<double> center = first / volume_;
  second = second / volume_ - center * center.transpose();
  center_of_mass_ = apex + center;
  inertia_by_mass_ = second.trace() * Mat3<double>::Identity() - second;
  inner_radius_ = std::numeric_limits<double>::infinity();
  for (const Face& face : faces_)
    inner_radius_ = std::min(inner_radius_, face.offset - face.normal.dot(center_of_mass_));
  bounding_radius_ = 0;
  for (const Vec3<double>& c : corners_) bounding_radius_ = std::max(bounding_radius_, c.norm());
}

Status ConvexHull::make(Points points, ConvexHull& out) {
  const auto bad = [](const char* why, int point = -1) {
    return Status::error(Code::kInvalidArgument, why, point);
  };
  for (std::size_t n = 0; n < points.size(); ++n)
    if (!points[n].allFinite() || !(points[n].norm() < kFurthest))
      return bad("point of a hull is not finite or further than 1e6 m", static_cast<int>(n));
  if (points.size() < 4) return bad("a hull needs four points");
  const int most =
      furthest(points, [&](const Vec3<double>& p) { return (p - points[0]).squaredNorm(); }).first;
  const double size = (points[most] - points[0]).norm();
  Quickhull hull(points, size);
  if (!hull.begin()) return bad("points of a hull lie in a plane");
  ConvexHull made;
  made.left_out_ = hull.grow(kMostCorners);
  if (!made.take_triangles(points, hull.triangles(), kOnePlane) &&
      !made.take_triangles(points, hull.triangles(), 0))
    return bad("points of a hull are too close to each other");
  made.measure();
  out = std::move(made);
  return {};
}

Collider convex_collider(const ConvexHull& hull, int joint) {
  Collider collider;
  collider.joint = joint;
  collider.shape = Shape::kConvex;
  collider.hull = &hull;
  collider.size.setConstant(hull.inner_radius());
  return collider;
}

}  // namespace sinew
