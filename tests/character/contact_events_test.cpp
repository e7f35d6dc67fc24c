// Events of contacts: who touches whom, from when to when, and by what impulse.
#include "sinew/character/contact_events.h"

#include <algorithm>
#include <numeric>
#include <random>

#include "character/scenes.h"
#include "fixtures/counting_new.h"
#include "fixtures/threads.h"
#include "sinew/effects/restitution.h"
#include "sinew/effects/static_shape.h"

namespace sinew {
namespace {

using fixtures::Playing;

constexpr ContactReportSettings kAll{true, true, true, true, 0.01};
constexpr double kOff = 0.01;  ///< of an impulse: what the scheme's weights leave between forces and momentum

bool same(const ContactEvent& a, const ContactEvent& b) {
  const auto point = [](const TouchPoint& p, const TouchPoint& q) {
    return p.position == q.position && p.normal == q.normal && p.friction == q.friction &&
           p.impulse == q.impulse && p.force == q.force && p.depth == q.depth;
  };
  return a.phase == b.phase && a.solved == b.solved && a.a == b.a && a.b == b.b && a.impulse == b.impulse &&
         a.normal == b.normal && a.points == b.points && a.kept == b.kept &&
         std::equal(a.point.begin(), a.point.begin() + a.kept, b.point.begin(), point);
}

/// A world that reports all events.
template <class T>
struct Reported {
  World<T> world;
  std::vector<ContactEvent> room = std::vector<ContactEvent>(4096);
  ContactRing ring{room};

  explicit Reported(const WorldSettings& settings = {}, const ContactReportSettings& wanted = kAll)
      : world(settings) {
    const Status status = report_contacts(world, &ring, wanted);
    EXPECT_TRUE(status.ok()) << status.reason;
  }
  int add(const PropSettings& prop) {
    Status status;
    const int index = world.add_prop(prop, status);
    EXPECT_TRUE(status.ok()) << status.reason;
    return index;
  }
  std::vector<ContactEvent> step(T h = T(1) / 60, const ParallelFor& parallel_for = {}) {
    EXPECT_TRUE(world.step(h, parallel_for).ok());
    return take();
  }
  std::vector<ContactEvent> take() {
    std::vector<ContactEvent> events;
    for (ContactEvent event; ring.take(event);) events.push_back(event);
    EXPECT_EQ(ring.dropped(), 0u);
    return events;
  }
};

PropSettings ball_at(const Vec3<double>& place) {
  PropSettings ball;
  ball.pose.translation = place;
  return ball;
}

PropSettings box_at(const Vec3<double>& place, double half = 0.1) {
  PropSettings box = ball_at(place);
  box.shape = Shape::kBox;
  box.size = Vec3<double>::Constant(half);
  return box;
}

constexpr BodyRef kGroundRef{BodyKind::kGround, 0, 0};
constexpr BodyRef prop_ref(int index) {
  return {BodyKind::kProp, index, 0};
}

int count(const std::vector<ContactEvent>& events, ContactPhase phase) {
  return static_cast<int>(
      std::count_if(events.begin(), events.end(), [&](const ContactEvent& e) { return e.phase == phase; }));
}

double sum_of_impulses(const std::vector<ContactEvent>& events) {
  return std::accumulate(events.begin(), events.end(), 0.0,
                         [](double sum, const ContactEvent& e) { return sum + e.impulse; });
}

template <class T>
class ContactEvents : public testing::Test {};
using Scalars = testing::Types<float, double>;
TYPED_TEST_SUITE(ContactEvents, Scalars);

TYPED_TEST(ContactEvents, BallThatRestsIsBorneByItsWeightAtItsLowestPoint) {
  Reported<TypeParam> scene;
  scene.add(ball_at({0.3, -0.2, 0.1}));
  for (int n = 0; n < 120; ++n) (void)scene.step();
  const std::vector<ContactEvent> events = scene.step();
  ASSERT_EQ(events.size(), 1u);
  const ContactEvent& e = events[0];
  EXPECT_EQ(e.phase, ContactPhase::kStay);
  EXPECT_TRUE(e.solved);
  EXPECT_EQ(e.a, prop_ref(0));
  EXPECT_EQ(e.b, kGroundRef);
  EXPECT_EQ(e.points, 1);
  ASSERT_EQ(e.kept, 1);
  EXPECT_NEAR(e.impulse, 9.81 / 60, 1e-3 * 9.81 / 60);
  EXPECT_NEAR(e.point[0].force, 9.81, 1e-3 * 9.81);
  EXPECT_NEAR((e.normal - Vec3<double>::UnitZ()).norm(), 0, 1e-6);
  // It sinks by WorldSettings' sink depth, 0.1 mm under its weight, and was dropped on the spot.
  EXPECT_NEAR((e.point[0].position - Vec3<double>(0.3, -0.2, 0)).norm(), 0, 1e-3);
  EXPECT_GT(e.point[0].depth, 0);
  EXPECT_LT(e.point[0].depth, 1e-3);
}

TYPED_TEST(ContactEvents, ImpulsesOfAnImpactAreTheMomentumThatItTakes) {
  for (const double height : {0.02, 0.5, 3.0})
    for (const double h : {1 / 120.0, 1 / 60.0, 1 / 30.0}) {
      Reported<TypeParam> scene;
      scene.add(ball_at({0, 0, 0.1 + height}));
      double impulse = 0;
      int begins = 0, ends = 0;
      const int steps = static_cast<int>(2.5 / h);
      for (int n = 0; n < steps; ++n) {
        const auto events = scene.step(TypeParam(h));
        impulse += sum_of_impulses(events);
        begins += count(events, ContactPhase::kBegin);
        ends += count(events, ContactPhase::kEnd);
      }
      const double speed = double(scene.world.prop_velocity(0).norm());
      const double wanted = 9.81 * steps * h;
      EXPECT_LT(speed, 1e-3);
      EXPECT_NEAR(impulse, wanted, kOff * wanted) << height << " m, " << h << " s";
      EXPECT_EQ(begins, 1 + ends);
      EXPECT_LE(ends, 1) << height << " m, " << h << " s";
    }
}

TYPED_TEST(ContactEvents, BounceGivesTheImpulseOfBothItsHalves) {
  Reported<TypeParam> scene;
  ASSERT_TRUE(scene.world.template declare<Restitution>().ok());
  PropSettings ball = ball_at({0, 0, 1.1});
  ball.restitution = 0.8;
  scene.add(ball);
  double before = 0, after = 0, impulse = 0;
  for (int n = 0; n < 60 && after <= 0; ++n) {
    before = std::min(before, double(scene.world.prop_velocity(0).z()));
    impulse += sum_of_impulses(scene.step());
    after = double(scene.world.prop_velocity(0).z());
  }
  ASSERT_GT(after, 0.5 * -before);
  const double taken = after - before + 9.81 / 60;  // and its weight in the step
  EXPECT_NEAR(impulse, taken, kOff * taken);
}

TYPED_TEST(ContactEvents, BallThatRollsOffABoxEndsThereAndBeginsOnTheGround) {
  Reported<TypeParam> scene;
  Collider table;
  table.shape = Shape::kBox;
  table.size = {0.5, 0.5, 0.25};
  table.local.translation = {0, 0, 0.25};
  Collider far = table;
  far.local.translation.x() = 30;
  ASSERT_TRUE(scene.world.add_obstacle(far).ok());
  ASSERT_TRUE(scene.world.add_obstacle(table).ok());
  PropSettings ball = ball_at({0.2, 0, 0.6});
  ball.velocity = {1, 0, 0};
  scene.add(ball);
  std::vector<std::pair<ContactPhase, BodyRef>> story;
  for (int n = 0; n < 90; ++n)
    for (const ContactEvent& e : scene.step())
      if (e.phase != ContactPhase::kStay) story.emplace_back(e.phase, e.b);
  const BodyRef on{BodyKind::kObstacle, 1, 0};
  const std::vector<std::pair<ContactPhase, BodyRef>> wanted{
      {ContactPhase::kBegin, on}, {ContactPhase::kEnd, on}, {ContactPhase::kBegin, kGroundRef}};
  EXPECT_EQ(story, wanted);
}

TYPED_TEST(ContactEvents, ShapesOfTheHostsAreNamedInTheirOrder) {
  Reported<TypeParam> scene;
  const ConvexSolid::Face top{{0, 0, 1}, 0.5};
  const ConvexSolid below(std::span(&top, 1), 1), other(std::span(&top, 1), 1);
  (void)other;
  const ConvexSolid::Face low{{0, 0, 1}, -5};
  const ConvexSolid cellar(std::span(&low, 1), 1);
  ASSERT_TRUE(scene.world.add_obstacle(cellar).ok());
  ASSERT_TRUE(scene.world.add_obstacle(below).ok());
  scene.add(ball_at({0, 0, 0.61}));
  std::vector<ContactEvent> all;
  for (int n = 0; n < 30; ++n)
    for (const ContactEvent& e : scene.step()) all.push_back(e);
  ASSERT_FALSE(all.empty());
  const BodyRef shape{BodyKind::kShape, 1, 0};
  for (const ContactEvent& e : all) EXPECT_EQ(e.b, shape);
}

TYPED_TEST(ContactEvents, TwoPropsComeInTheOrderInWhichTheyWereAdded) {
  for (const bool first_left : {true, false}) {
    WorldSettings settings;
    settings.gravity.setZero();
    settings.ground = false;
    Reported<TypeParam> scene(settings);
    PropSettings left = ball_at({-0.3, 0, 1}), right = ball_at({0.3, 0, 1});
    left.velocity = {2, 0, 0};
    right.velocity = {-2, 0, 0};
    scene.add(first_left ? left : right);
    scene.add(first_left ? right : left);
    double impulse = 0;
    int begins = 0;
    for (int n = 0; n < 30; ++n)
      for (const ContactEvent& e : scene.step()) {
        EXPECT_EQ(e.a, prop_ref(0));
        EXPECT_EQ(e.b, prop_ref(1));
        if (e.phase == ContactPhase::kEnd) continue;
        EXPECT_NEAR(e.normal.x(), first_left ? -1 : 1, 1e-3) << "from b to a";
        begins += e.phase == ContactPhase::kBegin;
        impulse += e.impulse;
      }
    EXPECT_EQ(begins, 1);
    const double taken = std::abs(double(scene.world.prop_velocity(0).x())) + 2;
    EXPECT_NEAR(impulse, taken, kOff * taken);
  }
}

/// All that holds a limp figure up is the floor: its weight and its fall.
TYPED_TEST(ContactEvents, ImpulsesOfAFallAreTheMomentumThatItTakes) {
  for (unsigned seed = 1; seed <= 5; ++seed) {
    fixtures::Limp<TypeParam> fall({}, 0.8, 3, seed);
    std::vector<ContactEvent> room(4096);
    ContactRing ring(room);
    ASSERT_TRUE(report_contacts(fall.world, &ring, kAll).ok());
    const double mass = fall.world.character(0).skeleton().total_mass();
    const double before = fall.world.character(0).report().momentum.z();
    double impulse = 0;
    for (int n = 0; n < 180; ++n) {
      ASSERT_TRUE(fall.world.step(TypeParam(1) / 60).ok());
      for (ContactEvent e; ring.take(e);) {
        EXPECT_EQ(e.b, kGroundRef);
        EXPECT_EQ(e.a.kind, BodyKind::kCharacter);
        EXPECT_EQ(e.a.index, 0);
        impulse += e.impulse;
      }
    }
    const double taken = fall.world.character(0).report().momentum.z() - before + mass * 9.81 * 3;
    EXPECT_NEAR(impulse, taken, kOff * taken) << "seed " << seed;
  }
}

TYPED_TEST(ContactEvents, SleepersKeepTheirPairsWithoutAWord) {
  WorldSettings settings;
  settings.detail.sleep_after = 0.3;
  Reported<TypeParam> scene(settings);
  scene.add(box_at({0, 0, 0.1}));
  scene.add(box_at({0, 0, 0.3}));
  int begins = 0, ends = 0, silent = 0;
  for (int n = 0; n < 240; ++n) {
    const auto events = scene.step();
    begins += count(events, ContactPhase::kBegin);
    ends += count(events, ContactPhase::kEnd);
    silent += events.empty();
  }
  ASSERT_EQ(scene.world.prop_report(0).level, Level::kAsleep);
  EXPECT_EQ(begins, 2);
  EXPECT_EQ(ends, 0);
  EXPECT_GT(silent, 60);
  // Woken, the upper one goes; the lower one, which wakes with it, stays as it was.
  ASSERT_TRUE(scene.world.set_prop(1, {Quat<TypeParam>::Identity(), {5, 0, 2}}, {0, 0, 0}, {0, 0, 0}).ok());
  std::vector<ContactEvent> woken;
  for (int n = 0; n < 10; ++n)
    for (const ContactEvent& e : scene.step())
      if (e.phase != ContactPhase::kStay) woken.push_back(e);
  ASSERT_EQ(woken.size(), 1u);
  EXPECT_EQ(woken[0].phase, ContactPhase::kEnd);
  EXPECT_EQ(woken[0].a, prop_ref(0));
  EXPECT_EQ(woken[0].b, prop_ref(1));
}

TYPED_TEST(ContactEvents, ParticlesAreNamedByTheirNodes) {
  Reported<TypeParam> scene;
  ParticleBody beads;  // the first is fixed in the air, and so never touches anything
  beads.radius = 0.02;
  for (int n = 0; n < 3; ++n) {
    beads.nodes.push_back({});
    beads.nodes.back().position = {0.5 * n, 0, 0.1 + 0.1 * n};
    beads.nodes.back().fixed = n == 0;
  }
  Status status;
  ASSERT_EQ(scene.world.add_particles(beads, status), 0) << status.reason;
  std::vector<BodyRef> begun;
  for (int n = 0; n < 60; ++n)
    for (const ContactEvent& e : scene.step())
      if (e.phase == ContactPhase::kBegin) begun.push_back(e.a);
  EXPECT_EQ(begun, (std::vector<BodyRef>{{BodyKind::kParticles, 0, 1}, {BodyKind::kParticles, 0, 2}}));
}

/// An arm that is thrown against its own body.
TYPED_TEST(ContactEvents, WhatTouchesItselfIsAPairOfItsJoints) {
  WorldSettings settings;
  settings.ground = false;
  settings.gravity.setZero();
  Reported<TypeParam> scene(settings);
  CharacterSettings limp;
  limp.root = RootDrive::kFree;
  limp.strength = 0;
  limp.self_collision = true;
  Status status;
  const Skeleton skeleton = fixtures::humanoid();
  ASSERT_EQ(scene.world.add_character(skeleton, limp, status), 0) << status.reason;
  std::vector<JointJet<TypeParam>> jets = fixtures::idle<TypeParam>(skeleton, 0);
  for (std::size_t i = 0; i < jets.size(); ++i)
    if (skeleton.joints[i].name.find("thigh") != std::string::npos)
      jets[i].omega = Vec3<TypeParam>(skeleton.joints[i].name.back() == 'l' ? 6 : -6, 0, 0);
  ASSERT_TRUE(scene.world.character(0).set_target(jets).ok());
  ASSERT_TRUE(scene.world.character(0).reset().ok());
  int begins = 0;
  for (int n = 0; n < 90; ++n)
    for (const ContactEvent& e : scene.step()) {
      EXPECT_EQ(e.a.kind, BodyKind::kCharacter);
      EXPECT_EQ(e.b.kind, BodyKind::kCharacter);
      EXPECT_LT(e.a.joint, e.b.joint);
      begins += e.phase == ContactPhase::kBegin;
    }
  EXPECT_GT(begins, 0) << "the legs were to meet";
}

TYPED_TEST(ContactEvents, WhatIsParkedEndsItsPairs) {
  Reported<TypeParam> scene;
  scene.add(box_at({0, 0, 0.1}));
  for (int n = 0; n < 20; ++n) (void)scene.step();
  ASSERT_TRUE(scene.world.park_prop(0).ok());
  const auto events = scene.step();
  ASSERT_EQ(events.size(), 1u);
  EXPECT_EQ(events[0].phase, ContactPhase::kEnd);
  EXPECT_EQ(events[0].a, prop_ref(0));
  EXPECT_TRUE(scene.step().empty());
}

/// What is put inside something touches it until it is out: on its way no step leaves it without the pair.
TYPED_TEST(ContactEvents, WhatBeginsInsideSomethingTouchesItUntilItIsOut) {
  Reported<TypeParam> scene;
  Collider table;
  table.shape = Shape::kBox;
  table.size = {0.5, 0.5, 0.25};
  table.local.translation = {0, 0, 0.25};
  ASSERT_TRUE(scene.world.add_obstacle(table).ok());
  scene.add(ball_at({0, 0, 0.5}));
  int begins = 0, ends = 0;
  for (int n = 0; n < 120; ++n) {
    const auto events = scene.step();
    begins += count(events, ContactPhase::kBegin);
    ends += count(events, ContactPhase::kEnd);
    ASSERT_FALSE(events.empty()) << "step " << n;
  }
  EXPECT_EQ(begins, 1 + ends);
  EXPECT_LE(ends, 1);
}

/// A clip's feet on the ground touch it, though nothing is solved; a leap lifts them off.
TYPED_TEST(ContactEvents, PlayedFeetTouchTheGroundWithoutAnImpulse) {
  Playing<TypeParam> scene;
  std::vector<ContactEvent> room(256);
  ContactRing ring(room);
  ASSERT_TRUE(report_contacts(scene.world, &ring, kAll).ok());
  std::vector<JointJet<TypeParam>> jets = fixtures::idle<TypeParam>(scene.skeleton, 0);
  const auto stand = [&](double height) {
    std::vector<JointJet<TypeParam>> lifted = jets;
    lifted[0].translation.z() += TypeParam(height);
    EXPECT_TRUE(scene.character().set_target(lifted).ok());
    (void)scene.character().reset();
    EXPECT_TRUE(scene.world.step(TypeParam(1) / 60).ok());
    std::vector<ContactEvent> events;
    for (ContactEvent e; ring.take(e);) events.push_back(e);
    return events;
  };
  // The fixture's feet hang above the floor or in it: find where their lowest point is at the floor.
  double lowest = 1e9;
  (void)stand(0);
  const Character<TypeParam> c = scene.character();
  for (const Collider& collider : scene.skeleton.colliders) {
    const auto body = static_cast<std::size_t>(collider.joint);
    const Transform<double> at = c.model()[body].template cast<double>() * collider.local;
    const Mat3<double> r = at.rotation.toRotationMatrix();
    const double reach = collider.shape == Shape::kBox ? r.row(2).cwiseAbs().dot(collider.size)
                         : collider.shape == Shape::kCapsule
                             ? std::abs(r(2, 2)) * collider.size.z() + collider.size.x()
                             : collider.size.x();
    lowest = std::min(lowest, at.translation.z() - reach);
  }
  (void)stand(-lowest + 0.5);
  std::vector<ContactEvent> events = stand(-lowest + 0.005);
  ASSERT_FALSE(events.empty());
  for (const ContactEvent& e : events) {
    EXPECT_EQ(e.phase, ContactPhase::kBegin);
    EXPECT_FALSE(e.solved);
    EXPECT_EQ(e.impulse, 0);
    EXPECT_EQ(e.b, kGroundRef);
    ASSERT_EQ(e.kept, 1);
    EXPECT_LT(e.point[0].position.z(), 0.01);
    EXPECT_EQ(e.point[0].depth, 0);
  }
  const std::size_t feet = events.size();
  EXPECT_TRUE(scene.character().on_animation());
  events = stand(-lowest + 0.02);
  EXPECT_EQ(count(events, ContactPhase::kEnd), static_cast<int>(feet));
  ContactReportSettings solved = kAll;
  solved.animated = false;
  ASSERT_TRUE(report_contacts(scene.world, &ring, solved).ok());
  EXPECT_TRUE(stand(-lowest).empty());
}

/// Pairs begin, stay and end in turn, whatever happens: boxes and figures that are thrown on a heap, sleep,
/// are woken, parked and put back.
struct Turmoil : Reported<float> {
  std::mt19937 random;
  explicit Turmoil(unsigned seed, int workers = 1) : Reported(settings(workers)), random(seed) {
    Status status;
    for (int n = 0; n < 3; ++n) {
      CharacterSettings limp;
      limp.root = RootDrive::kFree;
      limp.strength = n == 0 ? 1 : 0;
      if (n == 0) limp.root = RootDrive::kKinematic;
      EXPECT_EQ(world.add_character(fixtures::humanoid(), limp, status), n) << status.reason;
      std::vector<JointJet<float>> jets = fixtures::idle<float>(world.character(n).skeleton(), 0);
      jets[0].translation += Vec3<float>(0.5f * float(n), 0, n == 0 ? 0.f : 0.3f);
      EXPECT_TRUE(world.character(n).set_target(jets).ok());
      EXPECT_TRUE(world.character(n).reset().ok());
    }
    for (int n = 0; n < 8; ++n)
      add(n % 2 ? box_at({0.4 * n - 1, 0.3, 1.0 + 0.3 * n}) : ball_at({0.4 * n - 1, -0.2, 1.0 + 0.3 * n}));
  }
  static WorldSettings settings(int workers) {
    WorldSettings s;
    s.detail.sleep_after = 0.2;
    s.workers = workers;
    return s;
  }
  std::vector<ContactEvent> turn(int frame, const ParallelFor& parallel_for = {}) {
    if (frame % 40 == 39) {
      const int prop = static_cast<int>(random() % 8);
      if (random() % 2)
        EXPECT_TRUE(world.park_prop(prop).ok());
      else
        EXPECT_TRUE(world
                        .set_prop(prop, {Quat<float>::Identity(), {0.3f, 0.1f * float(prop), 2.f}},
                                  {0, 0, -3}, {1, 2, 3})
                        .ok());
    }
    return step(1 / 60.f, parallel_for);
  }
};

/// Follows events and says where one is out of turn.
struct Turns {
  std::vector<std::pair<BodyRef, BodyRef>> touching;
  int begins = 0, ends = 0;

  bool in_turn(const ContactEvent& e) {
    const auto found = std::find(touching.begin(), touching.end(), std::pair(e.a, e.b));
    const bool right = (found == touching.end()) == (e.phase == ContactPhase::kBegin);
    begins += e.phase == ContactPhase::kBegin;
    ends += e.phase == ContactPhase::kEnd;
    if (right && e.phase == ContactPhase::kBegin) touching.emplace_back(e.a, e.b);
    if (right && e.phase == ContactPhase::kEnd) touching.erase(found);
    return right;
  }
};

TEST(ContactEventsOfATurmoil, EveryPairBeginsStaysAndEndsInTurn) {
  constexpr unsigned kSeed = 3;
  Turmoil scene(kSeed);
  Turns turns;
  for (int n = 0; n < 400; ++n)
    for (const ContactEvent& e : scene.turn(n)) {
      ASSERT_TRUE(turns.in_turn(e)) << "step " << n << ", seed " << kSeed;
      EXPECT_EQ(e.points == 0, e.phase == ContactPhase::kEnd);
      EXPECT_GE(e.impulse, 0);
      EXPECT_NEAR(e.normal.norm(), 1, 1e-6);
      EXPECT_EQ(e.kept, std::min(e.points, ContactEvent::kMostPoints));
    }
  EXPECT_GT(turns.begins, 40);
  EXPECT_GT(turns.ends, 20);
}

/// Two limp figures in each other: solves that find no pose freeze them where they are, with what they touch.
TEST(ContactEventsOfATurmoil, GoOnInTurnThroughStepsThatAreFrozen) {
  Reported<float> scene;
  CharacterSettings limp;
  limp.root = RootDrive::kFree;
  limp.strength = 0;
  Status status;
  const Skeleton skeleton = fixtures::humanoid();
  for (int n = 0; n < 2; ++n) {
    ASSERT_EQ(scene.world.add_character(skeleton, limp, status), n) << status.reason;
    std::vector<JointJet<float>> jets = fixtures::idle<float>(skeleton, 0);
    jets[0].translation += Vec3<float>(0.05f, 0.02f, 0) * float(n);
    ASSERT_TRUE(scene.world.character(n).set_target(jets).ok());
    ASSERT_TRUE(scene.world.character(n).reset().ok());
  }
  Turns turns;
  int frozen = 0, touching = 0;
  for (int n = 0; n < 120; ++n) {
    const std::vector<ContactEvent> events = scene.step();
    for (const ContactEvent& e : events) ASSERT_TRUE(turns.in_turn(e)) << "step " << n;
    if (scene.world.character(0).report().frozen == 0) continue;
    ++frozen;
    touching += !turns.touching.empty();
  }
  EXPECT_EQ(touching, frozen);
}

TEST(ContactEventsOfATurmoil, GoOnFromWhatWasToldLastAfterASnapshotIsRestored) {
  Turmoil scene(13);
  Turns turns;
  std::vector<std::byte> snapshot(scene.world.snapshot_capacity());
  const auto play = [&](int from, int to) {
    for (int n = from; n < to; ++n)
      for (const ContactEvent& e : scene.turn(n)) ASSERT_TRUE(turns.in_turn(e)) << "step " << n;
  };
  play(0, 60);
  snapshot.resize(scene.world.save(snapshot));
  for (int round = 0; round < 3; ++round) {
    play(60, 140);
    const std::size_t told = turns.touching.size();
    ASSERT_TRUE(scene.world.restore(snapshot).ok());
    EXPECT_TRUE(scene.take().empty()) << "restoring tells nothing by itself";
    EXPECT_EQ(turns.touching.size(), told);
  }
  play(60, 140);
}

TEST(ContactEventsOfATurmoil, AreTheSameForAnyNumberOfWorkers) {
  constexpr unsigned kSeed = 5;
  Turmoil alone(kSeed), together(kSeed, 4);
  int threads = 3;
  for (int n = 0; n < 200; ++n) {
    const auto a = alone.turn(n), b = together.turn(n, {fixtures::run_on_threads, &threads});
    ASSERT_TRUE(std::equal(a.begin(), a.end(), b.begin(), b.end(), same)) << "step " << n;
  }
}

TEST(ContactEventsOfATurmoil, ListeningChangesNoBit) {
  Turmoil heard(7), unheard(7);
  ASSERT_TRUE(report_contacts<float>(unheard.world, nullptr).ok());
  for (int n = 0; n < 150; ++n) {
    (void)heard.turn(n);
    EXPECT_TRUE(unheard.turn(n).empty());
  }
  std::vector<std::byte> a(heard.world.snapshot_capacity()), b(unheard.world.snapshot_capacity());
  a.resize(heard.world.save(a));
  b.resize(unheard.world.save(b));
  EXPECT_EQ(a, b);
}

TEST(ContactEventsOfATurmoil, TakeNoMemoryFromTheHeapInAStep) {
  Turmoil scene(9);
  long taken = 0;
  for (int n = 0; n < 100; ++n) {
    const long before = fixtures::allocations;
    (void)scene.world.step(1 / 60.f);
    taken += fixtures::allocations - before;
    EXPECT_FALSE(scene.take().empty() && n > 60);
  }
  EXPECT_EQ(taken, 0);
}

TEST(ContactRing, KeepsTheFirstOnesAndCountsThoseThatFindItFull) {
  std::vector<ContactEvent> room(3);
  ContactRing ring(room);
  ContactEvent e;
  EXPECT_FALSE(ring.take(e));
  for (int n = 0; n < 5; ++n) {
    e.points = n;
    ring.put(e);
  }
  EXPECT_EQ(ring.size(), 3u);
  EXPECT_EQ(ring.dropped(), 2u);
  ASSERT_TRUE(ring.take(e));
  EXPECT_EQ(e.points, 0);
  e.points = 9;
  ring.put(e);
  for (const int wanted : {1, 2, 9}) {
    ASSERT_TRUE(ring.take(e));
    EXPECT_EQ(e.points, wanted);
  }
  EXPECT_EQ(ring.size(), 0u);
  ContactRing none({});
  none.put(e);
  EXPECT_EQ(none.dropped(), 1u);
}

TEST(ReportContacts, IsRefusedWhereThereAreNoneOrNoMemory) {
  std::vector<ContactEvent> room(3);
  ContactRing ring(room);
  WorldSettings settings;
  settings.ground = false;
  World<float> nothing(settings, DeclareNothing{});
  EXPECT_EQ(report_contacts(nothing, &ring).code, Code::kInvalidArgument);
  Reported<float> scene;
  scene.add(ball_at({0, 0, 1}));
  ContactReportSettings wrong;
  wrong.animated_reach = -1;
  EXPECT_EQ(report_contacts(scene.world, &ring, wrong).code, Code::kInvalidArgument);
  ASSERT_TRUE(report_contacts<float>(scene.world, nullptr).ok());
  const std::size_t without = scene.world.memory().total();
  ASSERT_TRUE(report_contacts(scene.world, &ring).ok());
  EXPECT_GT(scene.world.memory().total(), without);
  WorldSettings small;
  small.memory_cap = without + 64;
  World<float> full(small);
  Status status;
  ASSERT_EQ(full.add_prop(ball_at({0, 0, 1}), status), 0) << status.reason;
  EXPECT_EQ(report_contacts(full, &ring).code, Code::kOutOfRange);
  EXPECT_TRUE(full.step(1 / 60.f).ok());
}

}  // namespace
}  // namespace sinew
