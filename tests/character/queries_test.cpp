// Rays, balls and capsules that are cast through a world, and what they overlap.
#include "sinew/character/queries.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <random>

#include "character/scenes.h"
#include "fixtures/counting_new.h"
#include "sinew/effects/static_shape.h"

namespace sinew {
namespace {

constexpr double kExact = 1e-7;  ///< m; the header promises 1e-8, which distances at 10 m round to tenfold

Cast ray(const Vec3<double>& from, const Vec3<double>& motion) {
  Cast c;
  c.from = from;
  c.motion = motion;
  return c;
}

template <class T>
std::vector<QueryHit> all_hits(const World<T>& world, const Cast& query, std::size_t most = 64) {
  std::vector<QueryHit> hits(most);
  int count = -1;
  const Status status = cast(world, query, hits, count);
  EXPECT_TRUE(status.ok()) << status.reason;
  hits.resize(static_cast<std::size_t>(count));
  return hits;
}

template <class T>
std::optional<QueryHit> nearest(const World<T>& world, const Cast& query) {
  const std::vector<QueryHit> hits = all_hits(world, query, 1);
  return hits.empty() ? std::nullopt : std::optional(hits[0]);
}

template <class T>
std::vector<QueryHit> overlaps(const World<T>& world, const Cast& query) {
  std::vector<QueryHit> hits(64);
  int count = -1;
  const Status status = overlap(world, query, hits, count);
  EXPECT_TRUE(status.ok()) << status.reason;
  hits.resize(static_cast<std::size_t>(count));
  return hits;
}

WorldSettings empty() {
  WorldSettings s;
  s.ground = false;
  return s;
}

TEST(Queries, RayMeetsTheGroundWhereItIs) {
  WorldSettings settings;
  settings.ground_height = 0.25;
  const World<float> world(settings);
  const auto hit = nearest(world, ray({1, 2, 3.25}, {0, 4, -4}));
  ASSERT_TRUE(hit);
  EXPECT_EQ(hit->body, BodyRef{});
  EXPECT_NEAR(hit->distance, 3 * std::sqrt(2.0), kExact);
  EXPECT_NEAR((hit->position - Vec3<double>(1, 5, 0.25)).norm(), 0, kExact);
  EXPECT_EQ(hit->normal, Vec3<double>::UnitZ());
  EXPECT_FALSE(nearest(world, ray({1, 2, 3.25}, {0, 2, -2})));
  EXPECT_FALSE(nearest(world, ray({1, 2, 3.25}, {0, 0, 5})));
  EXPECT_FALSE(nearest(world, ray({1, 2, 0.25}, {0, 1, 1}))) << "it begins there and leaves";
}

TEST(Queries, BallAndCapsuleMeetTheGroundByWhatIsLowest) {
  const World<float> world({});
  Cast ball = ray({0, 0, 2}, {0, 0, -10});
  ball.radius = 0.3;
  EXPECT_NEAR(nearest(world, ball)->distance, 1.7, kExact);
  Cast capsule = ball;
  capsule.half_axis = {0.3, 0, 0.4};
  const auto hit = nearest(world, capsule);
  ASSERT_TRUE(hit);
  EXPECT_NEAR(hit->distance, 1.3, kExact);
  EXPECT_NEAR((hit->position - Vec3<double>(-0.3, 0, 0)).norm(), 0, kExact);
}

/// A shape somewhere, turned somehow, and a cast towards it, or past it.
struct Thrown {
  std::mt19937 random;
  std::normal_distribution<double> normal{0, 1};
  Collider shape;
  Cast query;

  explicit Thrown(unsigned seed) : random(seed) {
    const auto vector = [&] { return Vec3<double>(normal(random), normal(random), normal(random)); };
    const auto size = [&] { return 0.05 + 0.5 * std::abs(normal(random)); };
    shape.shape = static_cast<Shape>(seed % 3);
    shape.size = {size(), size(), size()};
    shape.local.translation = 3 * vector();
    shape.local.rotation =
        Quat<double>(normal(random), normal(random), normal(random), normal(random)).normalized();
    query.from = shape.local.translation + 3 * vector();
    const Vec3<double> aim = shape.local.translation + 0.5 * vector();
    query.motion = (aim - query.from) * (0.5 + std::abs(normal(random)));
    if (seed / 3 % 3 > 0) query.radius = 0.2 * std::abs(normal(random));
    if (seed / 3 % 3 > 1) query.half_axis = 0.4 * vector();
  }
  /// Of the query at a part of its way to the shape, looked at in many points of its axis.
  double distance(double share) const {
    double least = 1e9;
    const int points = query.half_axis.norm() > 0 ? 400 : 0;
    for (int n = 0; n <= points; ++n) {
      const double along = points ? 2.0 * n / points - 1 : 0;
      const Vec3<double> at = query.from + share * query.motion + along * query.half_axis;
      least = std::min(least,
                       signed_distance<double>(shape.shape, shape.size, shape.local.inverse() * at).distance);
    }
    return least - query.radius;
  }
};

/// A hit is on the shape's surface with its normal there, and nowhere before does the cast touch it; where it
/// is said to miss, it does so all along the way.
TEST(Queries, CastsMeetAllShapesWhereTheyFirstTouchThem) {
  int hits = 0, misses = 0;
  for (unsigned seed = 1; seed <= 600; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    const Thrown thrown(seed);
    World<float> world(empty());
    ASSERT_TRUE(world.add_obstacle(thrown.shape).ok());
    const auto hit = nearest(world, thrown.query);
    const double length = thrown.query.motion.norm(), until = hit ? hit->distance / length : 1;
    const double sampled = thrown.query.half_axis.norm() / 400;  // that the test's own look may be off
    for (int n = 0; n < 50; ++n) ASSERT_GT(thrown.distance(until * n / 50), -kExact - (hit ? hit->depth : 0));
    (hit ? hits : misses)++;
    if (!hit) continue;
    EXPECT_EQ(hit->body, (BodyRef{BodyKind::kObstacle, 0, 0}));
    const Vec3<double> local = thrown.shape.local.inverse() * hit->position;
    const SignedDistance<double> there =
        signed_distance<double>(thrown.shape.shape, thrown.shape.size, local);
    EXPECT_NEAR(there.distance, 0, kExact);
    if (hit->distance == 0) continue;
    EXPECT_NEAR(thrown.distance(until), 0, kExact + sampled);
    // Back along the normal lies the query's own surface: the point of its axis that touches.
    const Vec3<double> middle = thrown.query.from + until * thrown.query.motion;
    const Vec3<double> axis = thrown.query.half_axis;
    const Vec3<double> center = hit->position + thrown.query.radius * hit->normal;
    const double along =
        axis.norm() > 0 ? std::clamp(axis.dot(center - middle) / axis.squaredNorm(), -1.0, 1.0) : 0;
    // Where on its axis: as well as distances tell, which hardly change there.
    EXPECT_NEAR((middle + along * axis - center).norm(), 0, 1e-5);
    EXPECT_NEAR(hit->normal.norm(), 1, 1e-9);
    EXPECT_LT(hit->normal.dot(thrown.query.motion), 0);
  }
  EXPECT_GT(hits, 150);
  EXPECT_GT(misses, 100);
}

TEST(Queries, CastThatBeginsInsideHitsAtOnceAndSaysHowDeep) {
  World<double> world(empty());
  Collider ball;
  ball.size.x() = 1;
  ball.local.translation = {2, 0, 0};
  ASSERT_TRUE(world.add_obstacle(ball).ok());
  const auto hit = nearest(world, ray({1.25, 0, 0}, {5, 0, 0}));
  ASSERT_TRUE(hit);
  EXPECT_EQ(hit->distance, 0);
  EXPECT_NEAR(hit->depth, 0.25, kExact);
  EXPECT_NEAR((hit->position - Vec3<double>(1, 0, 0)).norm(), 0, kExact);
  EXPECT_NEAR((hit->normal - Vec3<double>(-1, 0, 0)).norm(), 0, kExact);
}

TEST(Queries, HeightFieldIsMetWhereItsHeightIs) {
  std::vector<double> heights;
  for (int row = 0; row < 20; ++row)
    for (int column = 0; column < 20; ++column)
      heights.push_back(0.6 * std::sin(0.7 * column) + 0.4 * std::cos(row));
  const HeightField hills(heights, 20, {-5, -5, 0}, 0.5);
  World<float> world(empty());
  ASSERT_TRUE(world.add_obstacle(hills).ok());
  std::mt19937 random(11);
  std::uniform_real_distribution<double> place(-4, 4);
  int met = 0;
  for (int n = 0; n < 200; ++n) {
    const Vec3<double> from(place(random), place(random), 2.5), to(place(random), place(random), -1.5);
    const auto hit = nearest(world, ray(from, to - from));
    ASSERT_TRUE(hit) << n;
    EXPECT_EQ(hit->body, (BodyRef{BodyKind::kShape, 0, 0}));
    double by_x = 0, by_y = 0;
    const Vec3<double> at = from + hit->distance * (to - from).normalized();
    const double height = hills.height(at.x(), at.y(), by_x, by_y);
    EXPECT_NEAR(at.z(), height, 1e-6) << n;
    EXPECT_NEAR((hit->normal - Vec3<double>(-by_x, -by_y, 1).normalized()).norm(), 0, 1e-6);
    // What the way is within for less than the step near a surface, 2 cm, may be passed over.
    for (double t = 0; t < hit->distance; t += 0.005) {
      const Vec3<double> before = from + t * (to - from).normalized();
      ASSERT_GT(before.z() - hills.height(before.x(), before.y(), by_x, by_y), -0.005) << n;
    }
    ++met;
  }
  EXPECT_EQ(met, 200);
}

/// Distance along a ray at which it enters an upright box.
std::optional<double> enters(const Vec3<double>& from, const Vec3<double>& direction, const Collider& box) {
  double first = 0, last = 1e9;
  for (int k = 0; k < 3; ++k) {
    double a = (box.local.translation[k] - box.size[k] - from[k]) / direction[k];
    double b = (box.local.translation[k] + box.size[k] - from[k]) / direction[k];
    if (a > b) std::swap(a, b);
    first = std::max(first, a);
    last = std::min(last, b);
  }
  return first <= last ? std::optional(first) : std::nullopt;
}

TEST(Queries, RaysFindTheirBoxesAmongThousandsInOrder) {
  World<float> world(empty());
  std::vector<Collider> boxes;
  std::mt19937 random(3);
  std::uniform_real_distribution<double> place(-40, 40), height(0, 4), size(0.1, 0.8);
  for (int n = 0; n < 3000; ++n) {
    Collider box;
    box.shape = Shape::kBox;
    box.size = {size(random), size(random), size(random)};
    if (n % 500 == 0) box.size.y() = 6;  // larger than the grid's cells
    box.local.translation = {place(random), place(random), height(random)};
    boxes.push_back(box);
    ASSERT_TRUE(world.add_obstacle(box).ok());
  }
  int found = 0;
  for (int n = 0; n < 100; ++n) {
    const Vec3<double> from(place(random), place(random), height(random)),
        motion(place(random), place(random), height(random) - 2);
    std::vector<std::pair<double, int>> wanted;
    for (std::size_t b = 0; b < boxes.size(); ++b)
      if (const auto t = enters(from, motion.normalized(), boxes[b]); t && *t <= motion.norm())
        wanted.emplace_back(*t, static_cast<int>(b));
    std::sort(wanted.begin(), wanted.end());
    const std::vector<QueryHit> hits = all_hits(world, ray(from, motion), 256);
    ASSERT_EQ(hits.size(), wanted.size()) << "ray " << n;
    for (std::size_t k = 0; k < hits.size(); ++k) EXPECT_NEAR(hits[k].distance, wanted[k].first, 1e-6);
    const auto first = nearest(world, ray(from, motion));
    EXPECT_EQ(first.has_value(), !wanted.empty());
    if (first) {
      EXPECT_NEAR(first->distance, wanted[0].first, 1e-6);
    }
    found += static_cast<int>(hits.size());
  }
  EXPECT_GT(found, 200);
}

TEST(Queries, CharacterIsMetAtTheJointThatCarriesTheCollider) {
  fixtures::Playing<float> scene;
  const int hand = scene.skeleton.find("hand_r");
  ASSERT_GE(hand, 0);
  const auto on_hand = std::find_if(scene.skeleton.colliders.begin(), scene.skeleton.colliders.end(),
                                    [&](const Collider& c) { return c.joint == hand; });
  ASSERT_NE(on_hand, scene.skeleton.colliders.end());
  scene.step();
  const Vec3<double> at =
      scene.character().model()[static_cast<std::size_t>(hand)].cast<double>() * on_hand->local.translation;
  const auto hit = nearest(scene.world, ray(at + Vec3<double>(0, -3, 0), {0, 6, 0}));
  ASSERT_TRUE(hit);
  EXPECT_EQ(hit->body, (BodyRef{BodyKind::kCharacter, 0, hand}));
  EXPECT_EQ(hit->collider, static_cast<int>(on_hand - scene.skeleton.colliders.begin()));
  Cast without = ray(at + Vec3<double>(0, -3, 0), {0, 6, 0});
  without.filter.without_character = 0;
  EXPECT_FALSE(nearest(scene.world, without));
  ASSERT_TRUE(scene.world.park_character(0).ok());
  EXPECT_FALSE(nearest(scene.world, ray(at + Vec3<double>(0, -3, 0), {0, 6, 0})));
}

struct Filtered : testing::Test {
  World<float> world{WorldSettings{}};
  Cast down = ray({0, 0, 5}, {0, 0, -5.5});
  Filtered() {
    Status status;
    PropSettings ball;
    ball.pose.translation = {0, 0, 3};
    ball.layers = 2;
    EXPECT_EQ(world.add_prop(ball, status), 0);
    ball.pose.translation.z() = 2;
    ball.layers = 4;
    EXPECT_EQ(world.add_prop(ball, status), 1);
    Collider shelf;
    shelf.shape = Shape::kBox;
    shelf.size = {1, 1, 0.05};
    shelf.local.translation.z() = 1;
    EXPECT_TRUE(world.add_obstacle(shelf, 8).ok());
  }
  std::vector<BodyRef> met() const {
    std::vector<BodyRef> bodies;
    for (const QueryHit& hit : all_hits(world, down)) bodies.push_back(hit.body);
    return bodies;
  }
};

constexpr BodyRef kFirst{BodyKind::kProp, 0, 0}, kSecond{BodyKind::kProp, 1, 0},
    kShelf{BodyKind::kObstacle, 0, 0};
using Bodies = std::vector<BodyRef>;

TEST_F(Filtered, AllAreMetInTheOrderOfTheirDistance) {
  EXPECT_EQ(met(), (Bodies{kFirst, kSecond, kShelf, BodyRef{}}));
}

TEST_F(Filtered, LayersChoose) {
  down.filter.layers = 2 | 8;
  EXPECT_EQ(met(), (Bodies{kFirst, kShelf}));
  down.filter.layers = 1;
  EXPECT_EQ(met(), Bodies{BodyRef{}});
}

TEST_F(Filtered, KindsOnesOwnAndTheHostsAnswerChoose) {
  down.filter.ground = false;
  EXPECT_EQ(met(), (Bodies{kFirst, kSecond, kShelf}));
  down.filter.without_prop = 0;
  EXPECT_EQ(met(), (Bodies{kSecond, kShelf}));
  down.filter.obstacles = false;
  EXPECT_EQ(met(), Bodies{kSecond});
  down.filter = {};
  BodyRef passes = kSecond;
  down.filter.context = &passes;
  down.filter.accept = [](void* context, const BodyRef& body) {
    return !(body == *static_cast<BodyRef*>(context));
  };
  EXPECT_EQ(met(), (Bodies{kFirst, kShelf, BodyRef{}}));
}

TEST_F(Filtered, ShortRoomKeepsTheNearest) {
  const std::vector<QueryHit> two = all_hits(world, down, 2);
  ASSERT_EQ(two.size(), 2u);
  EXPECT_EQ(two[0].body, kFirst);
  EXPECT_EQ(two[1].body, kSecond);
  std::vector<QueryHit> none;
  int count = 5;
  EXPECT_TRUE(cast(world, down, none, count).ok());
  EXPECT_EQ(count, 0);
}

TEST_F(Filtered, OverlapNamesAllThatABallTouchesDeepestFirst) {
  Cast ball;
  ball.from = {0, 0, 2.5};
  ball.radius = 0.45;
  std::vector<QueryHit> hits = overlaps(world, ball);
  ASSERT_EQ(hits.size(), 2u);
  ball.from.z() = 2.42;
  hits = overlaps(world, ball);
  ASSERT_EQ(hits.size(), 1u);
  EXPECT_EQ(hits[0].body, kSecond);
  EXPECT_NEAR(hits[0].depth, 0.13, 1e-6);  // the prop's pose is float
  EXPECT_NEAR((hits[0].normal - Vec3<double>::UnitZ()).norm(), 0, 1e-6);
  ball.radius = 1.5;
  hits = overlaps(world, ball);
  ASSERT_EQ(hits.size(), 3u);
  EXPECT_TRUE(std::is_sorted(hits.begin(), hits.end(),
                             [](const QueryHit& a, const QueryHit& b) { return a.depth > b.depth; }));
  Cast rod;
  rod.from = {0.9, 0, 3};
  rod.half_axis = {0.3, 0, 2.5};
  rod.radius = 0.01;
  hits = overlaps(world, rod);
  ASSERT_EQ(hits.size(), 1u);
  EXPECT_EQ(hits[0].body, kShelf);
}

TEST_F(Filtered, WhatMeansNothingIsRefused) {
  std::vector<QueryHit> hits(4);
  int count = 7;
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto refused = [&](const Cast& query) {
    count = 7;
    const Status status = cast(world, query, hits, count);
    EXPECT_EQ(count, 0);
    return status.code;
  };
  Cast wrong = down;
  wrong.from.x() = nan;
  EXPECT_EQ(refused(wrong), Code::kNotFinite);
  wrong = down;
  wrong.motion.y() = std::numeric_limits<double>::infinity();
  EXPECT_EQ(refused(wrong), Code::kNotFinite);
  wrong = down;
  wrong.radius = -1;
  EXPECT_EQ(refused(wrong), Code::kInvalidArgument);
  wrong.radius = nan;
  EXPECT_EQ(refused(wrong), Code::kNotFinite);
  wrong = down;
  wrong.motion.setZero();
  EXPECT_EQ(refused(wrong), Code::kInvalidArgument);
  wrong.motion.x() = 1e9;
  EXPECT_EQ(refused(wrong), Code::kOutOfRange);
}

TEST_F(Filtered, TakeNoMemoryFromTheHeap) {
  std::array<QueryHit, 8> hits;
  int count = 0;
  const long before = fixtures::allocations;
  (void)cast(world, down, hits, count);
  (void)overlap(world, down, hits, count);
  EXPECT_EQ(fixtures::allocations - before, 0);
}

}  // namespace
}  // namespace sinew
