// Which edges of two solids may touch.
#include "sinew/effects/crossing_edges.h"

#include <gtest/gtest.h>

namespace sinew {
namespace {

using Solid = PlacedShape<double>;

Solid box(const Vec3<double>& half, const Vec3<double>& at,
          const Quat<double>& turned = Quat<double>::Identity()) {
  return {Shape::kBox, half, {turned, at}, 1};
}
int pairs(const Solid& a, const Solid& b) {
  CrossingEdges<double> found;
  found.find(a, b);
  for (int n = 0; n < found.count; ++n) {
    const EdgePair<double>& pair = found.pairs[n];
    const Vec3<double> normal = pair.side * pair.a.half_axis.cross(pair.b.half_axis);
    EXPECT_GT(normal.dot(a.center - b.center), 0) << "from b to a";
  }
  return found.count;
}

const Solid kTable = box({1, 0.5, 0.1}, {0, 0, 0});

TEST(CrossingEdges, OfCrossedPlanksAreTheCornersOfWhatTheyShare) {
  EXPECT_EQ(pairs(box({0.1, 2, 0.02}, {0, 0, 0.1199}), kTable), 4);
}

TEST(CrossingEdges, OfAStaffOverATableAreItsTwoRims) {
  const Quat<double> along_y(Eigen::AngleAxisd(M_PI / 2, Vec3<double>::UnitX()));
  const Solid staff(Shape::kCapsule, {0.02, 0.02, 2}, {along_y, {0, 0, 0.119}}, 1);
  EXPECT_EQ(pairs(staff, kTable), 2);
}

TEST(CrossingEdges, AreNoneWhereOneStandsWithinTheOther) {
  EXPECT_EQ(pairs(box({0.1, 0.1, 0.1}, {0, 0, 0.1999}), kTable), 0);
}

TEST(CrossingEdges, AreTwoWhereOneStandsOverTheRim) {
  EXPECT_EQ(pairs(box({0.1, 0.1, 0.1}, {1, 0, 0.1999}), kTable), 2);
}

TEST(CrossingEdges, HaveTheirNumbersToBeFoundAgain) {
  const Solid above = box({0.1, 2, 0.02}, {0, 0, 0.1199});
  CrossingEdges<double> found;
  found.find(above, kTable);
  for (int n = 0; n < found.count; ++n) {
    EXPECT_EQ(edge_of(above, found.pairs[n].a.number).center, found.pairs[n].a.center);
    EXPECT_EQ(edge_of(kTable, found.pairs[n].b.number).half_axis, found.pairs[n].b.half_axis);
  }
  EXPECT_NEAR(found.apart, -1e-4, 1e-12);
}

TEST(CrossingEdges, OfACubeOnItsEdgeMeetTheRim) {
  const Quat<double> on_edge(Eigen::AngleAxisd(M_PI / 4, Vec3<double>::UnitY()));
  const double corner = 0.1 * std::sqrt(2.0);
  EXPECT_EQ(pairs(box({0.1, 0.1, 0.1}, {0, 0.5, 0.1 + corner - 1e-4}, on_edge), kTable), 1);
}

}  // namespace
}  // namespace sinew
