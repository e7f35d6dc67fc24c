#include "study/audit/solid.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace sinew::audit {
namespace {

using Eigen::Isometry3d, Eigen::Matrix3d, Eigen::Vector3d;

Vector3d end(const Solid& capsule, double along) {
  return capsule.pose * Vector3d(0, 0, along * capsule.half.z());
}

/// Distance of a point from a box, negative inside; convex in the point.
double distance(const Solid& box, const Vector3d& point) {
  const Vector3d out = (box.pose.inverse() * point).cwiseAbs() - box.half;
  return out.cwiseMax(0).norm() + std::min(out.maxCoeff(), 0.0);
}

/// The least distance from a box along a segment, by golden sections: distance is convex along it.
double distance(const Solid& box, const Vector3d& from, const Vector3d& to) {
  const double golden = (std::sqrt(5.0) - 1) / 2;
  double low = 0, high = 1;
  const auto at = [&](double t) { return distance(box, from + t * (to - from)); };
  while (high - low > 1e-6) {
    const double a = high - golden * (high - low), b = low + golden * (high - low);
    if (at(a) < at(b))
      high = b;
    else
      low = a;
  }
  return std::min({at(0), at(1), at((low + high) / 2)});
}

double distance(const Vector3d& p1, const Vector3d& q1, const Vector3d& p2, const Vector3d& q2) {
  const Vector3d d1 = q1 - p1, d2 = q2 - p2, r = p1 - p2;
  const auto to_segment = [](const Vector3d& p, const Vector3d& a, const Vector3d& d) {
    const double t = d.squaredNorm() > 0 ? std::clamp((p - a).dot(d) / d.squaredNorm(), 0.0, 1.0) : 0;
    return (p - a - t * d).norm();
  };
  double least = std::min(
      {to_segment(p1, p2, d2), to_segment(q1, p2, d2), to_segment(p2, p1, d1), to_segment(q2, p1, d1)});
  const double a = d1.squaredNorm(), b = d1.dot(d2), c = d2.squaredNorm(), det = a * c - b * b;
  if (det > 1e-12 * a * c) {
    const double s = (b * d2.dot(r) - c * d1.dot(r)) / det, t = (a * d2.dot(r) - b * d1.dot(r)) / det;
    if (s >= 0 && s <= 1 && t >= 0 && t <= 1) least = std::min(least, (r + s * d1 - t * d2).norm());
  }
  return least;
}

/// Separating axes: faces of both, and crossed edges.
double box_overlap(const Solid& a, const Solid& b) {
  const Matrix3d ra = a.pose.linear(), rb = b.pose.linear();
  const Vector3d between = b.pose.translation() - a.pose.translation();
  double least = std::numeric_limits<double>::infinity();
  const auto try_axis = [&](const Vector3d& axis) {
    const double length = axis.norm();
    if (length < 1e-6) return;
    const double reach =
        (ra.transpose() * axis).cwiseAbs().dot(a.half) + (rb.transpose() * axis).cwiseAbs().dot(b.half);
    least = std::min(least, (reach - std::abs(between.dot(axis))) / length);
  };
  for (int i = 0; i < 3; ++i) {
    try_axis(ra.col(i));
    try_axis(rb.col(i));
    for (int k = 0; k < 3; ++k) try_axis(ra.col(i).cross(rb.col(k)));
  }
  return least;
}

/// m, how far a solid reaches in a unit direction.
double reach_along(const Solid& s, const Vector3d& direction) {
  const Vector3d own = s.pose.linear().transpose() * direction;
  double most = own.cwiseAbs().dot(s.half) + s.radius;
  if (!s.corners.empty()) {
    most = -std::numeric_limits<double>::infinity();
    for (const Vector3d& c : s.corners) most = std::max(most, own.dot(c));
  }
  return s.pose.translation().dot(direction) + most;
}

/// By the way out along each of many directions about a sphere, the best ones refined.
double overlap_by_directions(const Solid& a, const Solid& b) {
  const auto along = [&](const Vector3d& d) { return reach_along(a, d) + reach_along(b, -d); };
  constexpr int kDirections = 256, kRefined = 8;
  std::vector<std::pair<double, Vector3d>> tried;
  for (int n = 0; n < kDirections; ++n) {  // golden spiral
    const double z = 1 - (2 * n + 1.0) / kDirections, turn = n * 2.399963229728653;
    const Vector3d d(std::sqrt(1 - z * z) * std::cos(turn), std::sqrt(1 - z * z) * std::sin(turn), z);
    tried.emplace_back(along(d), d);
  }
  std::partial_sort(tried.begin(), tried.begin() + kRefined, tried.end(),
                    [](const auto& p, const auto& q) { return p.first < q.first; });
  double least = tried[0].first;
  for (int n = 0; n < kRefined; ++n) {
    auto [best, d] = tried[static_cast<std::size_t>(n)];
    for (double step = 0.1; step > 1e-5;) {
      const Vector3d one = d.unitOrthogonal(), two = d.cross(one);
      bool better = false;
      for (int k = 0; k < 8; ++k) {
        const Vector3d next =
            (d + step * (std::cos(k * M_PI / 4) * one + std::sin(k * M_PI / 4) * two)).normalized();
        if (const double out = along(next); out < best) best = out, d = next, better = true;
      }
      if (!better) step /= 2;
    }
    least = std::min(least, best);
  }
  return least;
}

}  // namespace

Isometry3d isometry(const Transform<double>& from) {
  Isometry3d to = Isometry3d::Identity();
  to.linear() = from.rotation.normalized().toRotationMatrix();
  to.translation() = from.translation;
  return to;
}

Solid solid_of(Shape shape, const Vector3d& size, const Isometry3d& pose) {
  Solid s;
  s.shape = shape;
  s.pose = pose;
  if (shape == Shape::kBox)
    s.half = size;
  else
    s.radius = size.x();
  if (shape == Shape::kCapsule) s.half.z() = size.z();
  return s;
}

Solid solid_of(const ConvexHull& hull, const Isometry3d& pose) {
  Solid s;
  s.shape = Shape::kConvex;
  s.pose = pose;
  s.corners.assign(hull.corners().begin(), hull.corners().end());
  return s;
}

Solid solid_of(const Collider& c) {
  if (c.hull) return solid_of(*c.hull, isometry(c.local));
  return solid_of(c.shape, c.size, isometry(c.local));
}

double overlap(const Solid& a, const Solid& b) {
  if (!a.corners.empty() || !b.corners.empty()) return overlap_by_directions(a, b);
  if (a.shape == Shape::kBox && b.shape == Shape::kBox) return box_overlap(a, b);
  if (b.shape == Shape::kBox) return overlap(b, a);
  if (a.shape == Shape::kBox) return b.radius - distance(a, end(b, -1), end(b, 1));
  return a.radius + b.radius - distance(end(a, -1), end(a, 1), end(b, -1), end(b, 1));
}

double below(const Solid& s, double height) {
  return height + reach_along(s, -Vector3d::UnitZ());
}

double reach(const Solid& s) {
  double furthest = 0;
  for (const Vector3d& c : s.corners) furthest = std::max(furthest, c.norm());
  if (!s.corners.empty()) return furthest;
  return s.half.norm() + s.radius;
}

Matrix3d inertia_of(const Solid& s, double mass) {
  const double r = s.radius, l = 2 * s.half.z();
  Vector3d moments = Vector3d::Constant(0.4 * mass * r * r);
  if (s.shape == Shape::kBox) {
    const Vector3d square = s.half.cwiseAbs2() * (mass / 3);
    moments = {square.y() + square.z(), square.z() + square.x(), square.x() + square.y()};
  } else if (s.shape == Shape::kCapsule) {
    // A cylinder, and two half balls whose middles of mass are 3/8 of the radius beyond its ends.
    const double ball = mass * (4 * r / 3) / (l + 4 * r / 3), cylinder = mass - ball, out = l / 2 + 0.375 * r;
    const double own = (0.4 - 0.375 * 0.375) * ball * r * r;
    const double across = cylinder * (r * r / 4 + l * l / 12) + own + ball * out * out;
    moments = {across, across, cylinder * r * r / 2 + 0.4 * ball * r * r};
  }
  return moments.asDiagonal();
}

Matrix3d inertia_of(const ConvexHull& hull, double mass, Vector3d& middle) {
  // Gauss: volume, first and second moments are fluxes of x/3, x·xᵢ/4 and x·xᵢxⱼ/5. Over a triangle a
  // polynomial of second order is met by the middles of its sides.
  double volume = 0;
  Vector3d first = Vector3d::Zero();
  Matrix3d second = Matrix3d::Zero();
  for (const ConvexHull::Face& face : hull.faces()) {
    const auto rim = hull.boundary(face);
    const auto corner = [&](std::size_t n) { return hull.corners()[static_cast<std::size_t>(rim[n])]; };
    for (std::size_t n = 2; n < rim.size(); ++n) {
      const Vector3d a = corner(0), b = corner(n - 1), c = corner(n);
      const double flux = (b - a).cross(c - a).dot(a) / 2;  // of x, through the triangle
      volume += flux / 3;
      for (const Vector3d& at : {Vector3d((a + b) / 2), Vector3d((b + c) / 2), Vector3d((c + a) / 2)}) {
        first += flux / 3 / 4 * at;
        second += flux / 3 / 5 * at * at.transpose();
      }
    }
  }
  middle = first / volume;
  second = mass * (second / volume - middle * middle.transpose());
  return second.trace() * Matrix3d::Identity() - second;
}

}  // namespace sinew::audit
