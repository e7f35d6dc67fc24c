// A standing body that is pushed: it presses, steps, puts the foot back, or falls.
#include <array>
#include <cstdlib>

#include "fixtures/platform.h"
#include "pushed.h"
#include "sinew/skeleton/rotation.h"

namespace sinew {
namespace {

using fixtures::Pushed;

constexpr double kBack = 3.14159265358979323846, kLeft = kBack / 2;

struct Balancing : Pushed {
  Status status;
  Behaviour<float> behaviour;
  int steps = 0;    ///< most that were counted
  double slip = 0;  ///< m, of a foot that stands, furthest in a frame
  double help = 0;  ///< N·m, largest

  explicit Balancing(const BehaviourSettings& settings = {})
      : Pushed("stand"), behaviour(asset.skeleton, settings, status) {
    EXPECT_TRUE(status) << status.reason;
    behave = [this](std::span<JointJet<float>> wanted) {
      EXPECT_TRUE(behaviour.update(character(), wanted, h));
      steps = std::max(steps, behaviour.report().steps);
    };
  }
  BehaviourState pushed(double impulse, double direction, double seconds = 7) {
    run(0.3);
    push(impulse, direction);
    run(seconds);
    return behaviour.state();
  }
};

TEST(Behaviour, NothingHappensWhileNothingDisturbs) {
  Balancing body;
  Pushed plain("stand");
  for (int n = 0; n < 120; ++n) {
    body.step();
    plain.step();
    ASSERT_EQ(body.character().model()[5].translation, plain.character().model()[5].translation);
  }
  EXPECT_EQ(body.solved, 0);
  EXPECT_EQ(body.behaviour.state(), BehaviourState::kClip);
}

TEST(Behaviour, ASmallPushIsPressedBackWithoutAStep) {
  for (const double direction : {0.0, kBack, kLeft}) {
    Balancing body;
    EXPECT_EQ(body.pushed(15, direction), BehaviourState::kClip) << direction;
    EXPECT_EQ(body.steps, 0) << direction;
  }
}

/// People step from 23 N·s ahead, 19 to the side and 17 backwards, though their feet could press it back
/// (tools/study/behaviour/push_map.h).
TEST(Behaviour, APushThatFeetCouldHoldIsCaughtByAStepAsPeopleDo) {
  for (const double direction : {0.0, kBack, kLeft, -kLeft}) {
    Balancing body;
    EXPECT_EQ(body.pushed(27, direction), BehaviourState::kClip) << direction;
    EXPECT_GE(body.steps, 1) << direction;
  }
}

/// Pushed to the left it tips over its left foot, which bears it all and can't be lifted.
TEST(Behaviour, TheFootThatBearsNothingComesBesideTheOtherFirst) {
  for (const double side : {kLeft, -kLeft}) {
    Balancing body;
    const auto height = [&](Role role) {
      const auto foot = static_cast<std::size_t>(body.asset.skeleton.find(role));
      return body.character().model()[foot].translation.z();
    };
    const Role bears = side > 0 ? Role::kFootL : Role::kFootR, free = side > 0 ? Role::kFootR : Role::kFootL;
    body.run(0.3);
    const float down = height(free);
    body.push(38, side);
    float lifted = 0;
    while (body.behaviour.report().steps < 2 && body.behaviour.report().time < 1) {
      body.step();
      EXPECT_LT(height(bears), down + 0.02f) << side;
      lifted = std::max(lifted, height(free) - down);
    }
    EXPECT_EQ(body.behaviour.report().steps, 2) << side;
    EXPECT_GT(lifted, 0.02f) << side;
    body.run(8);
    EXPECT_EQ(body.behaviour.state(), BehaviourState::kClip) << side;
  }
}

TEST(Behaviour, APushThatFeetCannotHoldIsCaughtByAStepAndTheFootIsPutBack) {
  Balancing body;
  EXPECT_EQ(body.pushed(40, 0), BehaviourState::kClip);
  EXPECT_GE(body.steps, 1);
  EXPECT_LE(body.steps, 2);
  EXPECT_GT(body.character().displacement().x, 0.05);
  // Back on its animation, from where it stands.
  const int before = body.solved;
  body.run(1);
  EXPECT_EQ(body.solved, before);
  Balancing behind;
  EXPECT_EQ(behind.pushed(40, kBack), BehaviourState::kClip);
  EXPECT_GE(behind.steps, 1);
  EXPECT_LT(behind.character().displacement().x, -0.05);
}

TEST(Behaviour, WhatNoStepCatchesIsAFallAndItLiesStill) {
  Balancing body;
  EXPECT_EQ(body.pushed(150, 0, 6), BehaviourState::kDown);
  EXPECT_LT(body.root_height(), 0.3);
  // The host takes over: as strong as before.
  body.behaviour.stand(body.character());
  EXPECT_EQ(body.behaviour.state(), BehaviourState::kClip);
  EXPECT_EQ(body.character().strength(), 1.f);
}

TEST(Behaviour, IsKnockedDownWhenAsked) {
  Balancing body;
  body.run(0.3);
  body.behaviour.knock_down(body.character());
  body.run(4);
  EXPECT_EQ(body.behaviour.state(), BehaviourState::kDown);
  EXPECT_LT(body.root_height(), 0.3);
}

/// Walks or runs, and is pushed in a phase of its stride.
struct Walking : Pushed {
  Status status;
  Behaviour<float> behaviour;
  bool fell = false;
  double phases = 0.14;  ///< s, from one to the next
  double helped = 0;     ///< N, at most, while its steps caught it

  explicit Walking(double hz = 60, const char* gait = "walk", const BehaviourSettings& settings = {})
      : Pushed(gait), behaviour(asset.skeleton, settings, status) {
    h = float(1 / hz);
    behave = [this](std::span<JointJet<float>> wanted) {
      EXPECT_TRUE(behaviour.update(character(), wanted, h));
      for (const BehaviourEvent& event : behaviour.events())
        fell |= event.kind == BehaviourEventKind::kFallen;
      if (behaviour.state() == BehaviourState::kStep)
        helped = std::max(helped, double(character().report().help_force));
    };
  }
  /// Whether it walks on, as its clip does, so many seconds later.
  bool walks_on(double impulse, double direction, int phase, double seconds = 5) {
    run(2 + phases * phase);
    push(impulse, direction);
    run(seconds);
    return !fell && behaviour.state() == BehaviourState::kClip && character().report().unknown_dofs == 0;
  }
};

/// Does so on a box that is led by its velocity and a turn rate.
template <class Body>
struct Riding : Body {
  using Body::behave, Body::world, Body::status, Body::character, Body::jets, Body::time;
  Vec3<double> velocity = Vec3<double>::Zero();
  double turn_rate = 0;
  bool led_by_host = false;  ///< the host has the animation go along
  double sets_off = 0;       ///< s, in which it gathers its velocity and turn rate
  bool tells = true;         ///< how fast it is
  Vec3<double> middle;       ///< m, of the box, where it begins

  Riding(const Vec3<double>& v, double turns, bool host = false, double gathers = 0, double back = 0)
      : velocity(v), turn_rate(turns), led_by_host(host), sets_off(gathers), middle(-back, 0, 0.5) {
    platform = world.add_character(fixtures::platform({20, 20, 0.15}), {}, status);
    EXPECT_TRUE(status) << status.reason;
    Body::ground = 0.65f;
    lead(0);
    (void)world.character(platform).reset();
    Body::sample();
    for (JointJet<float>& jet : std::span(jets).first(1))
      jet.velocity += share_at(0) * velocity.template cast<float>();
    (void)character().set_target(jets);
    (void)character().reset();
    behave = [this, balance = behave](std::span<JointJet<float>> wanted) {
      lead(time());
      if (led_by_host) {
        wanted[0].translation += (time() * velocity).template cast<float>();
        wanted[0].velocity += velocity.template cast<float>();
      }
      balance(wanted);
    };
  }
  float share_at(double at_time) const {
    return sets_off > 0 ? float(std::min(at_time / sets_off, 1.0)) : 1.f;
  }
  void lead(double at_time) {
    JointJet<float> at;
    const double way = at_time < sets_off ? at_time * at_time / (2 * sets_off) : at_time - sets_off / 2;
    at.rotation = rotation_exp<double>(Vec3<double>(0, 0, way * turn_rate)).cast<float>();
    at.omega = Vec3<float>(0, 0, share_at(at_time) * float(turn_rate));
    at.translation = (middle + way * velocity).cast<float>();
    if (tells) at.velocity = share_at(at_time) * velocity.template cast<float>();
    (void)world.character(platform).set_target({&at, 1});
  }
  /// m, of the root from the box's middle, in its axes.
  Vec3<float> on_platform() {
    return world.character(platform).model()[0].inverse() * character().model()[0].translation;
  }
  int platform = -1;
};

TEST(Behaviour, StandsOnGroundThatMoves) {
  struct Ride {
    Vec3<double> velocity;
    double turn_rate;
    bool host;
  };
  for (const Ride& ride :
       {Ride{{0.8, 0, 0}, 0, false}, Ride{{0.8, 0, 0}, 0, true}, Ride{{0, 0, 0.5}, 0, false},
        Ride{{0, 0, -0.05}, 0, true}, Ride{{0, 0, 0}, 0.5, false}}) {
    Riding<Balancing> body(ride.velocity, ride.turn_rate, ride.host);
    const Vec3<float> stood = body.on_platform();
    body.run(4);
    EXPECT_LT((body.on_platform() - stood).norm(), 0.03f)
        << ride.velocity.transpose() << ", host " << ride.host;
    body.push(15, kLeft);
    body.run(5);
    const Vec3<float> now = body.on_platform() - stood;
    EXPECT_LT(now.norm(), 0.5f) << ride.velocity.transpose() << ", host " << ride.host;
    EXPECT_LT(std::abs(now.z()), 0.03f) << ride.velocity.transpose() << ", host " << ride.host;
  }
}

TEST(Behaviour, WhoStandsOnATurntableStaysWhereHeStands) {
  for (const float hz : {15.f, 30.f, 60.f, 120.f}) {
    Riding<Balancing> body(Vec3<double>::Zero(), 0.5, false, 2, 1.5);
    body.h = 1 / hz;
    body.run(3);
    const float before = body.on_platform().head<2>().norm();
    body.run(9);
    // Along the tangent it were r ω² h/2 each second: 112 mm at 15 Hz, 14 at 120.
    EXPECT_NEAR(body.on_platform().head<2>().norm(), before, 2e-3f) << hz << " Hz";
  }
}

TEST(Behaviour, WalksOnGroundThatMovesAsOnTheFloor) {
  constexpr double kSeconds = 10;
  Walking plain;
  const Vec3<float> began = plain.character().model()[0].translation;
  plain.run(kSeconds);
  const Vec3<float> way = plain.character().model()[0].translation - began;
  for (const Vec3<double>& velocity :
       {Vec3<double>(-0.8, 0, 0), Vec3<double>(0, 0.5, 0), Vec3<double>(0, -0.5, 0),
        Vec3<double>(-0.3, 0.3, 0.2), Vec3<double>(0, 0, 0.5), Vec3<double>(0, 0, -0.05)}) {
    Riding<Walking> body(velocity, 0, false, 4);
    const Vec3<float> stood = body.on_platform();
    body.run(kSeconds);
    EXPECT_EQ(body.solved, 0) << velocity.transpose();
    EXPECT_LT((body.on_platform() - stood - way).norm(), 1e-3f) << velocity.transpose();
  }
}

TEST(Behaviour, WhoWalksOnGroundThatGathersSpeedForwardsIsPlayed) {
  // In one phase of its stride no ground can give what that asks of it: not even 0.08 m/s².
  Riding<Walking> body({0.8, 0, 0}, 0, false, 8);
  body.run(10);
  EXPECT_FALSE(body.fell);
  EXPECT_EQ(body.solved, 0);
}

TEST(Behaviour, WhoStandsOnGroundThatMovesIsPlayed) {
  Balancing plain;
  const Vec3<float> began = plain.character().model()[0].translation;
  plain.run(6);
  const Vec3<float> sways = plain.character().model()[0].translation - began;
  for (const Vec3<double>& velocity :
       {Vec3<double>(-0.8, 0, 0), Vec3<double>(0, 0.8, 0), Vec3<double>(0, 0, 1), Vec3<double>(0, 0, -0.1)}) {
    Riding<Balancing> body(velocity, 0, false, 4);
    const Vec3<float> stood = body.on_platform();
    body.run(6);
    EXPECT_EQ(body.solved, 0) << velocity.transpose();
    EXPECT_LT((body.on_platform() - stood - sways).norm(), 1e-3f) << velocity.transpose();
  }
  // Of what is moved without being told how fast, the way tells.
  Riding<Balancing> body({0, 0.8, 0}, 0, false, 4);
  body.tells = false;
  const Vec3<float> stood = body.on_platform();
  body.run(6);
  EXPECT_EQ(body.solved, 0);
  EXPECT_LT((body.on_platform() - stood - sways).norm(), 1e-2f);  // half a step's way
}

/// Walks on boards that lie on the floor, each of so many kg.
struct WalkingOnBoards : Walking {
  std::vector<int> boards;

  explicit WalkingOnBoards(double mass) {
    ground = 0.1f;
    for (int n = 0; n < 5; ++n) {
      PropSettings board;
      board.shape = Shape::kBox;
      board.size = {0.8, 0.5, 0.05};
      board.mass = mass;
      board.pose.translation = {1.65 * n, 0, 0.05};
      boards.push_back(world.add_prop(board, status));
      EXPECT_TRUE(status) << status.reason;
    }
    sample();
    (void)character().set_target(jets);
    (void)character().reset();
  }
};

TEST(Behaviour, WalksOnPropsAsOnTheFloor) {
  constexpr double kSeconds = 4;
  Walking plain;
  plain.run(kSeconds);
  for (const double mass : {10.0, 40.0, 500.0}) {
    WalkingOnBoards body(mass);
    body.run(kSeconds);
    EXPECT_EQ(body.solved, 0) << mass;
    const Vec3<float> off =
        body.character().model()[0].translation - plain.character().model()[0].translation;
    EXPECT_LT((off - Vec3<float>(0, 0, body.ground)).norm(), 1e-5f) << mass;
    for (std::size_t n = 0; n < body.boards.size(); ++n) {
      const Transform<float> board = body.world.prop_pose(body.boards[n]);
      EXPECT_LT((board.translation - Vec3<float>(1.65f * float(n), 0, 0.05f)).norm(), 0.02f) << mass;
    }
  }
}

TEST(Behaviour, TwoWalkOnOneBoard) {
  constexpr float kBeside = 1.2f;
  Pushed body("walk");
  Status status;
  PropSettings board;
  board.shape = Shape::kBox;
  board.size = {8, 2, 0.05};
  board.mass = 60;
  board.pose.translation = {4, 0, 0.05};
  body.world.add_prop(board, status);
  body.ground = 0.1f;
  CharacterSettings grounded;
  grounded.root = RootDrive::kGrounded;
  const int second = body.world.add_character(body.asset.skeleton, grounded, status);
  ASSERT_TRUE(status) << status.reason;
  const auto lead = [&](std::span<JointJet<float>> wanted) {
    wanted[0].translation.y() += kBeside;
    EXPECT_TRUE(body.world.character(second).set_target(wanted));
    wanted[0].translation.y() -= kBeside;
  };
  body.sample();
  lead(body.jets);
  (void)body.world.character(second).reset();
  (void)body.character().set_target(body.jets);
  (void)body.character().reset();
  body.behave = lead;
  body.run(4);
  EXPECT_EQ(body.solved, 0);
  EXPECT_EQ(body.world.character(second).report().unknown_dofs, 0);
  EXPECT_LT(std::abs(body.root_height() - double(body.jets[0].translation.z() - body.ground)), 1e-5);
}

TEST(Behaviour, WhatOneStandsOnFeelsTheWeight) {
  for (const bool stands : {false, true}) {
    Balancing body;
    Collider beam;
    beam.shape = Shape::kBox;
    beam.size = {0.1, 1, 0.2};
    beam.local.translation = {-0.5, 0, 0.2};
    ASSERT_TRUE(body.world.add_obstacle(beam));
    PropSettings board;
    board.shape = Shape::kBox;
    board.size = {0.9, 0.5, 0.05};
    board.mass = 30;
    board.pose.translation = {-0.5, 0, 0.45};
    const int tips = body.world.add_prop(board, body.status);
    body.ground = stands ? 0.5f : 0.f;
    body.sample();
    (void)body.character().set_target(body.jets);
    (void)body.character().reset();
    if (!stands) (void)body.world.park_character(body.hero);
    for (int n = 0; n < 60; ++n) body.step();
    const float upright = (body.world.prop_pose(tips).rotation * Vec3<float>::UnitZ()).z();
    EXPECT_EQ(upright > 0.99f, !stands) << upright;
  }
}

/// Somebody who is driven walks into it: his limbs are no ground that would take it along.
TEST(Behaviour, LimbsOfOthersAreNoGround) {
  for (const double hz : {30.0, 60.0, 120.0, 240.0}) {
    Balancing body;
    body.h = float(1 / hz);
    const int walker = body.world.add_character(body.asset.skeleton, {}, body.status);
    const Clip& walk = body.asset.clips[static_cast<std::size_t>(body.asset.find_clip("walk"))];
    std::vector<JointJet<float>> jets(body.jets.size());
    const auto walks = [&] {
      (void)SamplingJob<float>{&walk, body.time(), jets}.Run();
      jets[0].translation += Vec3<float>(-1.2f, 0.25f, 0);
      (void)body.world.character(walker).set_target(jets);
    };
    walks();
    (void)body.world.character(walker).reset();
    double highest = 0, raised = 0;  // m
    while (body.time() < 2) {
      walks();
      body.step();
      const CharacterReport& report = body.character().report();
      if (report.ground.force > 0) highest = std::max(highest, report.ground.place.z());
      raised = std::max(raised, std::abs(body.character().displacement().z));
    }
    EXPECT_GT(body.solved, 10) << "touched, at " << hz;
    EXPECT_LT(highest, 0.05) << "m, at " << hz;
    EXPECT_LT(raised, 0.005) << "m, at " << hz;
  }
}

struct Caught {
  double impulse;  ///< N·s
  int of_32;       ///< but for two
};

/// In 8 phases, `apart` s from each other, and from four sides. SINEW_HZ=240 counts at another rate.
void expect_caught(const char* gait, double apart, std::initializer_list<Caught> pushes) {
  const char* asked = std::getenv("SINEW_HZ");
  const double hz = asked ? std::atof(asked) : 60;
  for (const auto& [impulse, most] : pushes) {
    int caught = 0;
    for (const double direction : {0.0, kLeft, kBack, -kLeft})
      for (int phase = 0; phase < 8; ++phase) {
        Walking body(hz, gait);
        body.phases = apart;
        (void)body.walks_on(impulse, direction, phase, 3);
        caught += !body.fell;
      }
    GTEST_LOG_(INFO) << impulse << " N s: " << caught << " of 32 are caught at " << hz << " Hz";
    if (asked) continue;  // that is for the table of figures
    EXPECT_GE(caught, most - 2);
  }
}

/// His walk by itself asks for next to nothing.
TEST(Behaviour, WhoWalksIsHelpedByATenthOfHisWeight) {
  for (const double allowed : {75.0, 0.0}) {
    double helped = 0;
    for (const double direction : {0.0, kLeft, kBack, -kLeft})
      for (int phase = 0; phase < 8; ++phase) {
        Walking body(60, "walk", {.walk_force = allowed});
        (void)body.walks_on(20, direction, phase, 1);
        helped = std::max(helped, body.helped);
      }
    EXPECT_LT(helped, std::sqrt(3) * allowed + 30) << "N, in all directions together";
  }
}

TEST(Behaviour, WhoWalksCatchesItselfByItsNextSteps) {
  expect_caught("walk", 0.14, {{10, 32}, {20, 32}, {30, 31}, {45, 21}});
}

TEST(Behaviour, WhoRunsCatchesItselfByItsNextSteps) {
  expect_caught("run", 0.7 / 8, {{10, 28}, {20, 25}, {30, 22}, {45, 14}});
}

/// rad/s, by which legs of who is pushed are asked to arrive faster than three times as fast as they went.
double arrive_faster(const char* gait, double hz) {
  double faster = 0;
  for (const double impulse : {30.0, 45.0})
    for (const double direction : {0.0, kLeft, kBack, -kLeft})
      for (int phase = 0; phase < 8; ++phase) {
        Walking body(hz, gait);
        const auto behave = body.behave;
        std::vector<JointJet<float>> before;
        body.behave = [&](std::span<JointJet<float>> wanted) {
          behave(wanted);
          if (!before.empty() && body.behaviour.state() == BehaviourState::kStep)
            for (const Role role :
                 {Role::kThighL, Role::kShinL, Role::kFootL, Role::kThighR, Role::kShinR, Role::kFootR}) {
              const auto joint = static_cast<std::size_t>(body.asset.skeleton.find(role));
              const double turned = double(before[joint].rotation.angularDistance(wanted[joint].rotation));
              faster = std::max(faster, double(wanted[joint].omega.norm()) - 3 * turned * hz);
            }
          before.assign(wanted.begin(), wanted.end());
        };
        (void)body.walks_on(impulse, direction, phase, 1);
      }
  return faster;
}

/// A knee that is all but straight passes through any rate, and would be let go with it.
TEST(Behaviour, LegsAreAskedToArriveAsTheyGo) {
  EXPECT_LT(arrive_faster("walk", 30), 8);
  EXPECT_LT(arrive_faster("walk", 60), 8);
  EXPECT_LT(arrive_faster("run", 30), 25);
  EXPECT_LT(arrive_faster("run", 60), 12);
}

TEST(Behaviour, WhoRunsIsOnItsAnimationAgain) {
  int back = 0;
  for (const double direction : {0.0, kLeft, kBack, -kLeft})
    for (int phase = 0; phase < 4; ++phase) {
      Walking body(60, "run");
      body.phases = 0.7 / 4;
      back += body.walks_on(10, direction, phase, 3);
    }
  EXPECT_GE(back, 14) << "of 16";
}

TEST(Behaviour, WhoWalkedOnIsOnItsAnimationWhereItWalks) {
  for (const auto& [impulse, least] : {std::pair(10.0, -0.01), std::pair(20.0, 0.02)}) {
    Walking body;
    ASSERT_TRUE(body.walks_on(impulse, kLeft, 0));
    const Displacement by = body.character().displacement();
    EXPECT_GT(by.y, least)
        << "m to the left, where it was pushed; by little, the foot that stands presses that back";
    const Vec3<double> root = body.jets[0].translation.cast<double>();
    EXPECT_LT((by.turn() * root + Vec3<double>(by.x, by.y, by.z) - body.character().position()).norm(), 1e-4);
    EXPECT_GE(body.root_height(), 0.85);
  }
}

/// A curb keeps a foot from landing where it should.
TEST(Behaviour, WhatLegsOfAWalkerAreAskedDoesNotLeap) {
  for (const double hz : {60.0, 120.0, 240.0})
    for (const double ahead : {1.2, 1.5, 1.8}) {
      Walking body(hz);
      Collider curb;
      curb.shape = Shape::kBox;
      curb.size = {0.05, 1, 0.05};
      curb.local.translation = {ahead, 0, 0.05};
      ASSERT_TRUE(body.world.add_obstacle(curb));
      const Skeleton& skeleton = body.asset.skeleton;
      const auto behave = body.behave;
      std::vector<JointJet<float>> before = body.jets;
      double fastest = 0;  // rad/s
      body.behave = [&](std::span<JointJet<float>> wanted) {
        behave(wanted);
        for (const Role role :
             {Role::kThighL, Role::kShinL, Role::kFootL, Role::kThighR, Role::kShinR, Role::kFootR}) {
          const auto joint = static_cast<std::size_t>(skeleton.find(role));
          const double turned = double(before[joint].rotation.angularDistance(wanted[joint].rotation));
          fastest = std::max(fastest, turned * hz);
        }
        std::copy(wanted.begin(), wanted.end(), before.begin());
      };
      body.run(4);
      EXPECT_LT(fastest, 20) << hz << " Hz, a curb at " << ahead;
    }
}

/// The way of a frame is compared with those before and after it: half as much again is no leap.
TEST(Behaviour, WhoWalksOnComesBackToItsAnimationWithoutALeap) {
  for (const double hz : {30.0, 60.0, 120.0, 240.0})
    for (const double impulse : {8.0, 15.0, -15.0})
      for (const int phase : {0, 3, 6}) {
        Walking body(hz);
        body.run(1 + 0.14 * phase);
        body.push(std::abs(impulse), impulse > 0 ? 0 : kBack);
        const auto chest = static_cast<std::size_t>(body.asset.skeleton.find(Role::kChest));
        Vec3<float> before = body.character().model()[chest].translation;
        std::array<float, 3> way{};  // m, of the last frames
        float leap = 0;              // m
        for (int n = 0; n < std::lround(4.5 * hz) && !body.fell; ++n) {
          body.step();
          const Vec3<float> now = body.character().model()[chest].translation;
          way = {way[1], way[2], (now - before).norm()};
          before = now;
          if (n > 1) leap = std::max(leap, way[1] - 1.5f * std::max(way[0], way[2]));
        }
        EXPECT_LT(leap, 0.02) << hz << " Hz, " << impulse << " N s, phase " << phase;
      }
}

/// A body that tilts may ask its soles to lie level further than ankles go: they are not asked to.
TEST(Behaviour, FeetTurnNoFurtherThanAnklesDo) {
  for (const double hz : {30.0, 60.0, 120.0})
    for (const double impulse : {80.0, 100.0}) {
      Walking body(hz);
      const auto behave = body.behave;
      double furthest = -1;  // rad, beyond the cone
      body.behave = [&](std::span<JointJet<float>> wanted) {
        behave(wanted);
        for (const Role role : {Role::kFootL, Role::kFootR}) {
          const auto joint = static_cast<std::size_t>(body.asset.skeleton.find(role));
          const Joint& foot = body.asset.skeleton.joints[joint];
          const Vec3<double> axis =
              foot.rest.rotation.conjugate() * (wanted[joint].rotation.cast<double>() * foot.swing_axis);
          furthest = std::max(furthest,
                              std::acos(std::clamp(axis.dot(foot.swing_axis), -1.0, 1.0)) - foot.swing_limit);
        }
      };
      (void)body.walks_on(impulse, kBack, 0);
      EXPECT_LT(furthest, 0.02) << hz << " Hz, " << impulse << " N s";
    }
}

/// A push after which it stood again elsewhere, and then leapt to where it had stood first in one frame.
TEST(Behaviour, StandsAgainWithoutALeap) {
  for (const double hz : {60.0, 120.0})
    for (const double direction : {2.094, 0.5, -1.2}) {
      Balancing body;
      body.h = float(1 / hz);
      const int foot = body.asset.skeleton.find(Role::kFootL);
      const auto place = [&](int joint) {
        return Vec3<float>(body.character().model()[static_cast<std::size_t>(joint)].translation);
      };
      for (int n = 0; n < std::lround(hz); ++n) body.step();
      const int chest = body.asset.skeleton.find(Role::kChest);
      const Vec3<float> impulse(30 * std::cos(float(direction)), 30 * std::sin(float(direction)), 0);
      (void)body.character().apply_impulse(chest, place(chest), impulse);
      Vec3<float> root = place(0), sole = place(foot);
      float leap = 0, moved = 0;
      int stands = -1;
      for (int n = 0; n < std::lround(9 * hz); ++n) {
        body.step();
        const bool again = n > 2 * hz && body.behaviour.report().state == BehaviourState::kClip;
        if (again) stands = stands < 0 ? n : stands;
        if (n > 2 * hz && body.character().report().unknown_dofs == 0) {
          leap = std::max(leap, (place(0) - root).norm() * float(hz));
          if (again) moved = std::max(moved, (place(foot) - sole).norm());
        }
        root = place(0);
        if (stands < 0 || n <= stands) sole = place(foot);
      }
      ASSERT_GT(stands, 0) << direction << " at " << hz;
      EXPECT_LT(leap, 0.15) << "m/s, played; " << direction << " at " << hz;
      EXPECT_LT(moved, 0.02) << "m, a foot that stands; " << direction << " at " << hz;
    }
}

TEST(Behaviour, RepeatsToTheBit) {
  const auto run = [] {
    Balancing body;
    body.pushed(45, 0.3, 2);
    return Vec3<float>(body.character().model()[3].translation);
  };
  EXPECT_EQ(run(), run());
}

TEST(Behaviour, RefusesWhatItCannotBalance) {
  Balancing body;
  std::vector<JointJet<float>> few(3);
  EXPECT_FALSE(body.behaviour.update(body.character(), few, body.h));
  Skeleton legless = body.asset.skeleton;
  for (Joint& joint : legless.joints) joint.role = Role::kNone;
  Status status;
  const Behaviour<float> none(legless, {}, status);
  EXPECT_FALSE(status);
}

}  // namespace
}  // namespace sinew
