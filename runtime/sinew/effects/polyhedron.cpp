#include "sinew/effects/polyhedron.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "sinew/effects/hull_distance.h"

namespace sinew {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kEdgesBetter = 1e-3;  ///< of both thicknesses: so much better edges must be than faces
constexpr double kOnEdge = 1e-9;       ///< sine, see beyond_support()
constexpr int kHalvings = 12;          ///< of a capsule's axis
constexpr double kTouches = 1e-3;      ///< of its radius: nearer to the axis there is no direction

/// Of a box: corner n has the sides of n's bits, face 2 · axis + 1 is the one below.
constexpr int face_of(int corner, int axis) {
  return 2 * axis + (corner & (1 << axis) ? 0 : 1);
}
constexpr std::array<ConvexHull::Edge, 12> edges_of_box() {
  std::array<ConvexHull::Edge, 12> edges{};
  std::size_t n = 0;
  for (int along = 0; along < 3; ++along)
    for (int corner = 0; corner < 8; ++corner) {
      if (corner & (1 << along)) continue;
      const int one = (along + 1) % 3, two = (along + 2) % 3;
      // From outside, on the way along an edge at +one, +two: face one is on the left, two on the right.
      const bool swapped = ((corner >> one) & 1) != ((corner >> two) & 1);
      const int a = face_of(corner, one), b = face_of(corner, two);
      edges[n++] = {corner, corner | (1 << along), swapped ? b : a, swapped ? a : b};
    }
  return edges;
}
constexpr std::array<ConvexHull::Edge, 12> kBoxEdges = edges_of_box();
constexpr std::array<ConvexHull::Edge, 1> kAxis = {{{0, 1, -1, -1}}};

}  // namespace

Polyhedron::Polyhedron(const PlacedShape<double>& s) : thinnest_(s.size.x()) {
  if (s.shape == Shape::kConvex) {
    for (const Vec3<double>& c : s.hull->corners()) corners_[corner_count_++] = s.center + s.rotation * c;
    for (const ConvexHull::Face& f : s.hull->faces()) {
      normals_[face_count_] = s.rotation * f.normal;
      offsets_[face_count_] = f.offset + normals_[face_count_].dot(s.center);
      ++face_count_;
    }
    edges_ = s.hull->edges();
  } else if (s.shape == Shape::kBox) {
    for (int n = 0; n < 8; ++n) {
      const Vec3<double> side(n & 1 ? 1 : -1, n & 2 ? 1 : -1, n & 4 ? 1 : -1);
      corners_[corner_count_++] = s.center + s.rotation * s.size.cwiseProduct(side);
    }
    for (int n = 0; n < 6; ++n) {
      normals_[face_count_] = (n % 2 ? -1 : 1) * s.rotation.col(n / 2);
      offsets_[face_count_] = s.size[n / 2] + normals_[face_count_].dot(s.center);
      ++face_count_;
    }
    edges_ = kBoxEdges;
    thinnest_ = s.size.minCoeff();
  } else {
    const double half = s.shape == Shape::kCapsule ? s.size.z() : 0;
    for (const double end : {-half, half}) corners_[corner_count_++] = s.center + end * s.rotation.col(2);
    edges_ = kAxis;
    radius_ = s.size.x();
  }
}

Vec3<double> Polyhedron::outwards(const ConvexHull::Edge& e) const {
  if (e.left < 0) return Vec3<double>::Zero();
  return normals_[static_cast<std::size_t>(e.left)] + normals_[static_cast<std::size_t>(e.right)];
}

double Polyhedron::beyond_support(const ConvexHull::Edge& e, const Vec3<double>& direction) const {
  if (e.left < 0) return -1;
  const Vec3<double> along = half_axis(e).normalized(), across = along.cross(direction);
  // Against the ways from the edge into its two faces.
  return std::max(normals_[static_cast<std::size_t>(e.left)].dot(across),
                  -normals_[static_cast<std::size_t>(e.right)].dot(across));
}

double Polyhedron::support(const Vec3<double>& direction) const {
  double most = -kInfinity;
  for (const Vec3<double>& c : corners()) most = std::max(most, c.dot(direction));
  return most;
}

namespace {

/// What of a solid reaches furthest in a direction: a corner, or the middle of an edge or face that lies
/// level.
struct Furthest {
  Vec3<double> center = Vec3<double>::Zero();
  double extent = 0;  ///< m², how far about the middle
};
Furthest furthest(const Polyhedron& s, const Vec3<double>& direction) {
  const double top = s.support(direction);
  Vec3<double> middle = Vec3<double>::Zero();
  for (const Vec3<double>& c : s.corners()) middle += c / static_cast<double>(s.corners().size());
  double size = 0, all = 0;
  for (const Vec3<double>& c : s.corners()) size = std::max(size, (c - middle).norm());
  Furthest at;
  const auto weight = [&](const Vec3<double>& c) {
    const double below = (top - c.dot(direction)) / std::max(kLevel * size, 1e-12);
    return below < 1 ? (1 - below) * (1 - below) : 0.0;
  };
  for (const Vec3<double>& c : s.corners()) {
    all += weight(c);
    at.center += weight(c) * c;
  }
  at.center /= all;
  for (const Vec3<double>& c : s.corners()) at.extent += weight(c) / all * (c - at.center).squaredNorm();
  return at;
}

/// The best of the axes that separate two polyhedra.
class Axes {
 public:
  Axes(const Polyhedron& a, const Polyhedron& b, const Vec3<double>& before)
      : a_(a), b_(b), before_(before), radii_(a.radius() + b.radius()) {
    for (std::size_t f = 0; f < b.normals().size(); ++f)
      if (leads_out(b.normals()[f])) take(-a.support(-b.normals()[f]) - b.offset(f) - radii_, b.normals()[f]);
    for (std::size_t f = 0; f < a.normals().size(); ++f)
      if (leads_out(-a.normals()[f]))
        take(-b.support(-a.normals()[f]) - a.offset(f) - radii_, -a.normals()[f]);
    const double better = kEdgesBetter * (a.thinnest() + b.thinnest());
    for (const ConvexHull::Edge& p : a.edges())
      for (const ConvexHull::Edge& q : b.edges()) look_across(p, q, better);
  }
  SolidGap<double> best() const {
    SolidGap<double> gap{distance_, normal_, Vec3<double>::Zero()};
    if (of_a_) {
      const Vec3<double> p = a_.half_axis(*of_a_), q = b_.half_axis(*of_b_);
      const double along = nearest_along<double>(p, q, b_.center(*of_b_) - a_.center(*of_a_))[0];
      gap.point = a_.center(*of_a_) + std::clamp(along, -1.0, 1.0) * p;
    } else {  // where faces of both lie level, nearer to the smaller one's middle
      const Furthest a = furthest(a_, -normal_), b = furthest(b_, normal_);
      const double both = a.extent + b.extent, share = both > 0 ? a.extent / both : 0.5;
      gap.point = a.center + share * (b.center - a.center);
    }
    return gap;
  }
  SignedDistance<double> distance() const { return {distance_, normal_, 0, Vec3<double>::Zero()}; }

 private:
  bool leads_out(const Vec3<double>& normal) const { return normal.dot(before_) > kBack; }
  void take(double apart, const Vec3<double>& normal) {
    if (!(apart > distance_)) return;
    distance_ = apart;
    normal_ = normal;
    of_a_ = of_b_ = nullptr;
  }
  void look_across(const ConvexHull::Edge& p, const ConvexHull::Edge& q, double better) {
    const Vec3<double> along_p = a_.half_axis(p), along_q = b_.half_axis(q);
    Vec3<double> normal = along_p.cross(along_q);
    const double size = normal.squaredNorm();
    if (size <= kParallelEdges * kParallelEdges * along_p.squaredNorm() * along_q.squaredNorm()) return;
    if (normal.dot(b_.outwards(q) - a_.outwards(p)) < 0) normal = -normal;
    normal /= std::sqrt(size);
    if (b_.beyond_support(q, normal) > kOnEdge || a_.beyond_support(p, -normal) > kOnEdge) return;
    const double apart = normal.dot(a_.corner(p.from) - b_.corner(q.from)) - radii_;
    if (!(apart > distance_ + (of_a_ ? 0.0 : better)) || !leads_out(normal)) return;
    take(apart, normal);
    of_a_ = &p;
    of_b_ = &q;
  }

  const Polyhedron &a_, &b_;
  const Vec3<double> before_;
  const double radii_;
  double distance_ = -kInfinity;
  Vec3<double> normal_ = Vec3<double>::UnitZ();
  const ConvexHull::Edge *of_a_ = nullptr, *of_b_ = nullptr;
};

/// Where along a capsule's axis, in [−1, 1], it is nearest to a hull: the zero of the distance's derivative,
/// which grows. Where it lies level with a face in its middle, and not at the end that rounding chooses.
double nearest_to_hull(const Vec3<double>& center, const Vec3<double>& half, const ConvexHull& hull) {
  const auto slope = [&](double t) {
    return half.dot(hull_distance(hull, center + t * half).normal) + kLevel * half.norm() * t;
  };
  double low = -1, high = 1, at_low = slope(low), at_high = slope(high);
  if (!(at_low < 0)) return low;
  if (!(at_high > 0)) return high;
  for (int n = 0; n < kHalvings; ++n) {
    const double middle = (low + high) / 2, here = slope(middle);
    (here < 0 ? low : high) = middle;
    (here < 0 ? at_low : at_high) = here;
  }
  return low - at_low * (high - low) / (at_high - at_low);
}

SolidGap<double> of_capsule(const PlacedShape<double>& capsule, const PlacedShape<double>& convex,
                            const Vec3<double>& before) {
  const Mat3<double> to_hull = convex.rotation.transpose();
  const Vec3<double> center = to_hull * (capsule.center - convex.center),
                     half = capsule.size.z() * (to_hull * capsule.rotation.col(2));
  const Vec3<double> at = center + nearest_to_hull(center, half, *convex.hull) * half;
  const SignedDistance<double> d = hull_distance(*convex.hull, at);
  if (d.distance > kTouches * capsule.size.x()) {
    const Vec3<double> normal = convex.rotation * d.normal;
    if (normal.dot(before) > kBack)
      return {d.distance - capsule.size.x(), normal, convex.center + convex.rotation * at};
  }
  return Axes(Polyhedron(capsule), Polyhedron(convex), before).best();
}

}  // namespace

SolidGap<double> gap_of_hulls(const PlacedShape<double>& a, const PlacedShape<double>& b,
                              const Vec3<double>& before) {
  if (a.shape == Shape::kCapsule) return of_capsule(a, b, before);
  if (b.shape != Shape::kCapsule) return Axes(Polyhedron(a), Polyhedron(b), before).best();
  SolidGap<double> gap = of_capsule(b, a, -before);
  gap.normal = -gap.normal;
  return gap;
}

SignedDistance<double> separation_of_hulls(const Polyhedron& a, const Polyhedron& b) {
  return Axes(a, b, Vec3<double>::Zero()).distance();
}

}  // namespace sinew
