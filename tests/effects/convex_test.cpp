// Convex solids: hulls of points, distances of points to them, and of solids from each other. Distances are
// judged by what proves them: a plane that parts what is apart, and a way that takes it there.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "sinew/effects/hull_distance.h"
#include "sinew/effects/polyhedron.h"
#include "sinew/effects/solid_gap.h"
#include "sinew/skeleton/convex_hull.h"
#include "sinew/skeleton/skeleton.h"

namespace sinew {
namespace {

using V = Vec3<double>;
using Points = std::vector<V>;

ConvexHull hull_of(const Points& points) {
  ConvexHull hull;
  const Status status = ConvexHull::make(points, hull);
  EXPECT_TRUE(status.ok()) << status.reason;
  return hull;
}

Points cuboid(const V& half, const V& at = V::Zero()) {
  Points points;
  for (int n = 0; n < 8; ++n)
    points.emplace_back(at + half.cwiseProduct(V(n & 1 ? 1 : -1, n & 2 ? 1 : -1, n & 4 ? 1 : -1)));
  return points;
}

/// Upright, about the origin; `top`: radius there.
Points barrel(int sides, double radius, double half, double top) {
  Points points;
  for (int n = 0; n < sides; ++n) {
    const double angle = 2 * M_PI * n / sides;
    points.emplace_back(radius * std::cos(angle), radius * std::sin(angle), -half);
    points.emplace_back(top * std::cos(angle), top * std::sin(angle), half);
  }
  return points;
}

Points rock(unsigned seed, int points) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  Points all;
  for (int n = 0; n < points; ++n) {
    const V way(normal(random), normal(random), normal(random));
    all.emplace_back(0.3 * way.normalized().cwiseProduct(V(1, 0.7, 0.5)));
  }
  return all;
}

Quat<double> any_turn(std::mt19937& random) {
  std::normal_distribution<double> normal;
  return Quat<double>(normal(random), normal(random), normal(random), normal(random)).normalized();
}

/// Every edge between two faces, all corners below all faces.
void expect_closed(const ConvexHull& hull) {
  EXPECT_EQ(hull.corners().size() + hull.faces().size(), hull.edges().size() + 2) << "Euler";
  for (const ConvexHull::Face& face : hull.faces()) {
    for (const V& corner : hull.corners()) EXPECT_LE(face.normal.dot(corner), face.offset + 1e-12);
    V around = V::Zero();
    const auto rim = hull.boundary(face);
    for (std::size_t n = 0; n < rim.size(); ++n) {
      const V &from = hull.corners()[rim[n]], &to = hull.corners()[rim[(n + 1) % rim.size()]];
      around += from.cross(to);
      EXPECT_NEAR(face.normal.dot(from), face.offset, 1e-4);
    }
    EXPECT_GT(around.normalized().dot(face.normal), 0.999) << "anticlockwise from outside";
  }
  for (const ConvexHull::Edge& e : hull.edges()) {
    const V along = hull.corners()[e.to] - hull.corners()[e.from];
    const V &left = hull.faces()[e.left].normal, &right = hull.faces()[e.right].normal;
    EXPECT_GT(left.cross(right).dot(along), -1e-9) << "the left face is on the left of the way";
  }
}

TEST(ConvexHull, OfABoxHasItsFacesMassAndInertia) {
  Points points = cuboid({0.5, 0.3, 0.2}, {1, 2, 3});
  points.emplace_back(1.1, 2.1, 3);    // inside
  points.emplace_back(1.5, 2.1, 3);    // in a face
  points.emplace_back(1.5, 2.3, 3.1);  // on an edge
  const ConvexHull hull = hull_of(points);
  expect_closed(hull);
  EXPECT_EQ(hull.corners().size(), 8u);
  EXPECT_EQ(hull.faces().size(), 6u);
  EXPECT_EQ(hull.edges().size(), 12u);
  EXPECT_NEAR(hull.volume(), 0.24, 1e-12);
  EXPECT_LT((hull.center_of_mass() - V(1, 2, 3)).norm(), 1e-12);
  const V expected = V(0.09 + 0.04, 0.25 + 0.04, 0.25 + 0.09) / 3;
  EXPECT_LT((hull.inertia_by_mass() - Mat3<double>(expected.asDiagonal())).norm(), 1e-12);
  EXPECT_NEAR(hull.inner_radius(), 0.2, 1e-12);
  EXPECT_LT((hull.shadow() - V(4 * 0.3 * 0.2, 4 * 0.5 * 0.2, 4 * 0.5 * 0.3)).norm(), 1e-12);
}

TEST(ConvexHull, OfAWedgeHasItsCentreOfMass) {
  // A right triangle with legs of 0.6 and 0.3 m, 1 m deep.
  const ConvexHull wedge =
      hull_of({{0, 0, 0}, {0.6, 0, 0}, {0, 0, 0.3}, {0, 1, 0}, {0.6, 1, 0}, {0, 1, 0.3}});
  expect_closed(wedge);
  EXPECT_EQ(wedge.faces().size(), 5u);
  EXPECT_LT((wedge.center_of_mass() - V(0.2, 0.5, 0.1)).norm(), 1e-12);
  const Mat3<double>& inertia = wedge.inertia_by_mass();
  EXPECT_NEAR(inertia(1, 1), (0.6 * 0.6 + 0.3 * 0.3) / 18, 1e-12);
}

TEST(ConvexHull, OfManyPointsIsClosedAndHoldsThemAll) {
  for (unsigned seed = 0; seed < 40; ++seed) {
    const Points points = rock(seed, 5 + static_cast<int>(seed) % 27);
    const ConvexHull hull = hull_of(points);
    expect_closed(hull);
    EXPECT_EQ(hull.left_out(), 0);
    EXPECT_EQ(hull.corners().size(), points.size()) << "all lie on an ellipsoid";
    for (const V& p : points) EXPECT_LT(hull_distance(hull, p).distance, 1e-5);
  }
}

TEST(ConvexHull, OfTooManyPointsIsSmallerByWhatItSays) {
  const Points points = rock(7, 4000);
  const ConvexHull hull = hull_of(points);
  expect_closed(hull);
  EXPECT_EQ(hull.corners().size(), std::size_t(ConvexHull::kMostCorners));
  double outside = 0;
  for (const V& p : points) outside = std::max(outside, hull_distance(hull, p).distance);
  EXPECT_GT(hull.left_out(), 0.003);
  EXPECT_LT(hull.left_out(), 0.04);
  EXPECT_NEAR(outside, hull.left_out(), 1e-12);
}

TEST(ConvexHull, OfPointsWithTheDigitsOfFloatsHasTheFacesThatAreMeant) {
  const Eigen::AngleAxisd turned(0.7, V(1, 2, 3).normalized());
  for (const int sides : {5, 8, 12, 16}) {
    Points points;
    for (const V& p : barrel(sides, 0.3, 0.45, 0.3))
      points.emplace_back((turned * p).cast<float>().cast<double>());
    const ConvexHull hull = hull_of(points);
    expect_closed(hull);
    EXPECT_EQ(hull.faces().size(), std::size_t(sides + 2));
    EXPECT_EQ(hull.corners().size(), std::size_t(2 * sides));
  }
}

TEST(ConvexHull, RefusesWhatHasNoInside) {
  ConvexHull hull;
  const auto reason = [&](const Points& points) {
    const Status status = ConvexHull::make(points, hull);
    EXPECT_FALSE(status.ok());
    return std::string(status.reason);
  };
  EXPECT_EQ(reason({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}), "a hull needs four points");
  EXPECT_EQ(reason({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}}), "points of a hull lie in a plane");
  EXPECT_EQ(reason(Points(10, V(1, 2, 3))), "points of a hull lie in a plane");
  EXPECT_EQ(reason({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}}), "points of a hull lie in a plane");
  Points bad = cuboid({1, 1, 1});
  bad[5].y() = NAN;
  const Status status = ConvexHull::make(bad, hull);
  EXPECT_EQ(status.index, 5);
  EXPECT_EQ(std::string(status.reason), "point of a hull is not finite or further than 1e6 m");
  EXPECT_TRUE(hull.corners().empty()) << "left as it was";
  Collider none;
  none.shape = Shape::kConvex;
  EXPECT_FALSE(validate(none).ok());
}

TEST(HullDistance, IsWhatAPlaneAndAWayProve) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> place(-0.8, 0.8);
  for (unsigned seed = 0; seed < 20; ++seed) {
    const ConvexHull hull = hull_of(seed % 2 ? rock(seed, 18) : barrel(7, 0.3, 0.4, 0.02 * seed));
    for (int n = 0; n < 400; ++n) {
      const V point(place(random), place(random), place(random));
      const SignedDistance<double> d = hull_distance(hull, point);
      ASSERT_NEAR(d.normal.norm(), 1, 1e-12);
      for (const V& corner : hull.corners())
        ASSERT_GE(d.normal.dot(point - corner), d.distance - 1e-9) << "parts the point from all of it";
      const V surface = point - d.distance * d.normal;
      double outside = -1;
      for (const auto& face : hull.faces())
        outside = std::max(outside, face.normal.dot(surface) - face.offset);
      ASSERT_NEAR(outside, 0, 1e-9) << "leads to the surface";
      // How its surface bends, by differences.
      const V step = 1e-6 * V(0.3, -0.7, 0.5);
      const V turned =
          (hull_distance(hull, point + step).normal - hull_distance(hull, point - step).normal) / 2;
      const V flat = step - d.normal.dot(step) * d.normal - d.straight.dot(step) * d.straight;
      if (turned.norm() < 1e-3) {  // the same edge or face on both sides
        ASSERT_LT((turned - d.curvature * flat).norm(), 2e-8);
      }
    }
  }
}

TEST(HullDistance, OfABoxIsThatOfTheBox) {
  const V half(0.3, 0.2, 0.1);
  const ConvexHull hull = hull_of(cuboid(half));
  std::mt19937 random(2);
  std::uniform_real_distribution<double> place(-0.5, 0.5);
  for (int n = 0; n < 2000; ++n) {
    const V point(place(random), place(random), place(random));
    const SignedDistance<double> wanted = signed_distance<double>(Shape::kBox, half, point),
                                 d = hull_distance(hull, point);
    ASSERT_NEAR(d.distance, wanted.distance, 1e-12);
    ASSERT_LT((d.normal - wanted.normal).norm(), 1e-9);
  }
}

TEST(RoundedCorners, LieWithinAndTouchTheFaces) {
  for (const Points& points : {cuboid({0.3, 0.2, 0.1}), barrel(16, 0.3, 0.4, 0), rock(3, 14)}) {
    const ConvexHull hull = hull_of(points);
    const std::vector<RoundedCorner> corners = rounded_corners(hull, 0.003);
    ASSERT_EQ(corners.size(), hull.corners().size());
    for (std::size_t n = 0; n < corners.size(); ++n) {
      EXPECT_NEAR(hull_distance(hull, corners[n].center).distance, -corners[n].radius, 1e-12);
      EXPECT_NEAR((corners[n].center - hull.corners()[n]).norm(), 0.003, 1e-12);
    }
  }
}

using Solid = PlacedShape<double>;

Points core_of(const Solid& s) {
  Points points;
  if (s.shape == Shape::kCapsule)
    return {s.center + s.size.z() * s.rotation.col(2), s.center - s.size.z() * s.rotation.col(2)};
  for (const V& c :
       s.shape == Shape::kBox ? cuboid(s.size) : Points(s.hull->corners().begin(), s.hull->corners().end()))
    points.emplace_back(s.center + s.rotation * c);
  return points;
}

/// How far a has to go along a direction until it has left b, m; negative: how far it is from there.
double way_out(const Solid& a, const Solid& b, const V& direction) {
  double least = INFINITY, most = -INFINITY;
  for (const V& p : core_of(a)) least = std::min(least, direction.dot(p));
  for (const V& p : core_of(b)) most = std::max(most, direction.dot(p));
  const auto radius = [](const Solid& s) { return s.shape == Shape::kCapsule ? s.size.x() : 0.0; };
  return most - least + radius(a) + radius(b);
}

TEST(SolidGap, OfConvexSolidsIsTheShortestWayOut) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> place(-0.45, 0.45);
  std::normal_distribution<double> normal;
  const ConvexHull first = hull_of(rock(11, 16)), second = hull_of(barrel(8, 0.2, 0.3, 0.1));
  int overlapping = 0;
  for (int n = 0; n < 600; ++n) {
    const auto pose = [&] {
      return Transform<double>{any_turn(random), {place(random), place(random), place(random)}};
    };
    const V thin = V::Constant(first.inner_radius()), wide = V::Constant(second.inner_radius());
    const Solid rock_here(Shape::kConvex, thin, pose(), 1, &first);
    const Solid others[] = {Solid(Shape::kConvex, wide, pose(), 1, &second),
                            Solid(Shape::kBox, {0.3, 0.2, 0.1}, pose(), 1),
                            Solid(Shape::kCapsule, {0.08, 0.08, 0.3}, pose(), 1)};
    for (const Solid& other : others)
      for (const bool turned : {false, true}) {
        const Solid &a = turned ? other : rock_here, &b = turned ? rock_here : other;
        const SolidGap<double> gap = solid_gap<double>(a, b, V::Zero());
        ASSERT_NEAR(gap.normal.norm(), 1, 1e-9);
        // A capsule that lies nearly level is met nearer to its middle than to its end.
        ASSERT_NEAR(way_out(a, b, gap.normal), -gap.distance, other.shape == Shape::kCapsule ? 3e-3 : 1e-12);
        overlapping += gap.distance < 0;
        double best = INFINITY;
        for (int k = 0; k < 200; ++k)
          best =
              std::min(best, way_out(a, b, V(normal(random), normal(random), normal(random)).normalized()));
        // Polyhedra that are apart may be further than their best axis says.
        if (gap.distance < 0 || other.shape == Shape::kCapsule) {
          ASSERT_LE(-gap.distance, best + 3e-3)
              << "no way is shorter, but for what edges must better faces by";
        }
        // Where they only just overlap, it acts where they do.
        if (a.shape != Shape::kCapsule && b.shape != Shape::kCapsule &&
            std::abs(gap.distance + 0.015) < 0.015) {
          const auto to_hull = [](const Solid& s, const V& at) {
            return V(s.rotation.transpose() * (at - s.center));
          };
          ASSERT_LT(hull_distance(first, to_hull(rock_here, gap.point)).distance, 0.05);
        }
      }
  }
  EXPECT_GT(overlapping, 500);
  EXPECT_LT(overlapping, 3000);
}

TEST(SolidGap, OfBoxesAsHullsIsThatOfBoxes) {
  std::mt19937 random(4);
  std::uniform_real_distribution<double> place(-0.35, 0.35);
  const V one(0.3, 0.2, 0.1), two(0.1, 0.4, 0.2);
  const ConvexHull hull = hull_of(cuboid(one));
  for (int n = 0; n < 500; ++n) {
    const Transform<double> pose{any_turn(random), {place(random), place(random), place(random)}};
    const Solid box(Shape::kBox, one, {}, 1), convex(Shape::kConvex, V::Constant(0.1), {}, 1, &hull),
        other(Shape::kBox, two, pose, 1);
    const SolidGap<double> wanted = solid_gap<double>(box, other, V::Zero()),
                           gap = solid_gap<double>(convex, other, V::Zero());
    ASSERT_NEAR(gap.distance, wanted.distance, 2e-3);
    if (std::abs(gap.distance - wanted.distance) < 1e-9) {
      ASSERT_LT((gap.normal - wanted.normal).norm(), 1e-6);
    }
  }
}

TEST(CrossingEdges, OfHullsAreThoseOfBoxes) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> place(-0.3, 0.3);
  const V one(0.3, 0.2, 0.1), two(0.1, 0.4, 0.2);
  const ConvexHull hull = hull_of(cuboid(one));
  int crossing = 0;
  for (int n = 0; n < 500; ++n) {
    const Transform<double> pose{any_turn(random), {place(random), place(random), place(random)}};
    const Solid box(Shape::kBox, one, {}, 1), convex(Shape::kConvex, V::Constant(0.1), {}, 1, &hull),
        other(Shape::kBox, two, pose, 1);
    CrossingEdges<double> wanted, found;
    wanted.find(box, other);
    found.find(convex, other);
    ASSERT_NEAR(found.apart, wanted.apart, 1e-3) << "but for what edges must better faces by";
    // Near supports are taken by tolerances that differ a little; those that bear are the same.
    for (int k = 0; k < found.count; ++k) {
      const EdgePair<double>& p = found.pairs[k];
      EXPECT_LT(p.side * p.a.half_axis.cross(p.b.half_axis).dot(p.a.center), 0)
          << "into the box about the origin";
      crossing += 1;
    }
  }
  EXPECT_GT(crossing, 200);
}

}  // namespace
}  // namespace sinew
