// A body that lies gets up by itself: which clip it chooses, that it stands again, when it may not, and what
// becomes of one that is pushed while it rises.
#include <algorithm>
#include <array>

#include "fixtures/counting_new.h"
#include "fixtures/known_failure.h"
#include "pushed.h"
#include "sinew/behaviour/get_up_clips.h"
#include "sinew/behaviour/stance.h"

namespace sinew {
namespace {

using fixtures::Pushed;

constexpr double kPi = 3.14159265358979323846;

/// Falls when it is told, after 0.3 s.
struct Fallen : Pushed {
  Status status;
  Behaviour<float> behaviour;
  std::vector<BehaviourEvent> told;
  double decided = -1, stood = -1;  ///< s

  explicit Fallen(const BehaviourSettings& settings = {}, float ground_height = 0,
                  const char* plays = "stand", bool self_collision = false)
      : Pushed(plays, RootDrive::kGrounded, ground_height, self_collision),
        behaviour(asset.skeleton, settings, status) {
    EXPECT_TRUE(status) << status.reason;
    EXPECT_TRUE(behaviour.use_get_ups(asset.skeleton, asset.clips));
    behave = [this](std::span<JointJet<float>> wanted) {
      EXPECT_TRUE(behaviour.update(character(), wanted, h));
      for (const BehaviourEvent& event : behaviour.events()) {
        told.push_back(event);
        if (event.kind == BehaviourEventKind::kRising && decided < 0) decided = time();
        if (event.kind == BehaviourEventKind::kStanding) stood = time();
      }
    };
  }
  void falls(double impulse, double direction) {
    run(0.3);
    behaviour.knock_down(character());
    push(impulse, direction);
  }
  /// At most so many seconds.
  void run_until_it_stands(double seconds) {
    for (int n = 0; n < std::lround(seconds / double(h)) && stood < 0; ++n) step();
  }
  int count(BehaviourEventKind kind) const {
    return static_cast<int>(
        std::count_if(told.begin(), told.end(), [&](const BehaviourEvent& e) { return e.kind == kind; }));
  }
};

/// The clips of the sample character and what they begin with.
struct Choosing : ::testing::Test {
  Asset asset;
  GetUpClips<float> clips;
  std::vector<JointJet<float>> jets;
  std::vector<Transform<float>> model;
  std::vector<Vec3<double>> points;

  void SetUp() override {
    ASSERT_TRUE(load_asset((binary_dir() + "/sample.sinew").c_str(), asset));
    clips.prepare(asset.skeleton, asset.clips, 1);
    jets.resize(asset.skeleton.joints.size());
    model.resize(jets.size());
    points.resize(clips.points().count());
  }
  /// The pose in which a variant begins, elsewhere and turned.
  GetUpChoice choose(int variant, double yaw, double x, double y) {
    clips.sample(variant, ClipTime{0, 0, 0}, jets);
    clips.place(jets, model, points);
    const Displacement by{x, y, yaw};
    for (Vec3<double>& p : points) p = by.turn() * p + Vec3<double>(x, y, 0);
    return clips.choose(points, 0);
  }
};

TEST_F(Choosing, AClipIsChosenInThePoseInWhichItBeginsWhereverThatLies) {
  ASSERT_EQ(clips.variants().size(), 6u);  // from the back, the front, over; and their mirror images
  for (int variant = 0; variant < 6; ++variant) {
    if (clips.variants()[static_cast<std::size_t>(variant)].rolls) continue;
    for (const double yaw : {0.0, 0.7, 2.5, -3.0}) {
      const GetUpChoice found = choose(variant, yaw, 3, -2);
      ASSERT_GE(found.entry, 0);
      EXPECT_EQ(clips.entry(found.entry).variant, variant) << yaw;
      EXPECT_LT(found.fit.off, 1e-5) << yaw;  // m: rounding of float
      EXPECT_NEAR(std::remainder(found.fit.place.yaw - yaw, 2 * kPi), 0, 1e-5);
      EXPECT_NEAR(found.fit.place.x, 3, 1e-5);
      EXPECT_NEAR(found.fit.place.y, -2, 1e-5);
    }
  }
}

TEST_F(Choosing, WhatFailedIsLeftOut) {
  const GetUpChoice first = choose(0, 0, 0, 0);
  const int variant = clips.entry(first.entry).variant;
  const GetUpChoice second = clips.choose(points, 1u << variant);
  EXPECT_NE(clips.entry(second.entry).variant, variant);
  EXPECT_GT(second.fit.off, first.fit.off);
  EXPECT_EQ(clips.choose(points, 0xffffffffu).entry, -1);
}

TEST_F(Choosing, WhoCannotGetUpFromTheBackRollsOver) {
  std::uint32_t from_back = 0;
  for (std::size_t n = 0; n < clips.variants().size(); ++n)
    if (clips.variants()[n].clip->name == "get_up_supine") from_back |= 1u << n;
  const int supine = from_back & 1u ? 0 : from_back & 4u ? 2 : 4;
  choose(supine, 0.4, 0, 0);
  const GetUpChoice found = clips.choose(points, from_back);
  ASSERT_GE(found.entry, 0);
  EXPECT_TRUE(clips.variants()[static_cast<std::size_t>(clips.entry(found.entry).variant)].rolls);
}

TEST(GetUp, ItsClipsAskTheGroundForNoMoreThanItCanGive) {
  constexpr double kHelp = 8;      // N and N·m: what a grounded root may have unless it is asked
  constexpr double kRises = 0.93;  // of the clip: from there on balance may take over
  int solved = 0;
  double torque = 0;
  for (const char* name : {"get_up_supine", "get_up_prone"}) {
    Pushed body(name);
    ASSERT_TRUE(body.character().set_help(2000, 600));  // whatever it takes is metered
    while (body.time() < kRises * double(body.clip->duration)) {
      body.step();
      const CharacterReport& report = body.character().report();
      if (report.substeps > 0) {
        ++solved;
        continue;
      }
      EXPECT_LE(report.help_force, kHelp) << name << " at " << body.time() << " s";
      torque = std::max(torque, report.help_torque);
    }
  }
  SINEW_FAILS_TODAY(
      solved == 0 && torque <= kHelp,
      "some frames are solved, and 12 N m are missing 2.08 s into the clip from the back, where "
      "the seat leaves the floor");
}

TEST(GetUp, WhoFellSeveralTimesIsOnItsAnimationWhereverItStands) {
  Fallen body;
  for (const double direction : {0.5 * kPi, 1.2 * kPi, 0.8 * kPi}) {
    body.stood = -1;
    body.falls(150, direction);
    body.run_until_it_stands(30);
    ASSERT_GT(body.stood, 0) << direction;
    for (int n = 0; n < 10 * 60 && body.behaviour.state() != BehaviourState::kClip; ++n) body.step();
    ASSERT_EQ(body.behaviour.state(), BehaviourState::kClip) << direction;
    body.run(2);
    EXPECT_EQ(body.behaviour.state(), BehaviourState::kClip) << direction;
    // The animation, displaced, is where the body stands.
    const Displacement by = body.character().displacement();
    const Vec3<double> root = body.jets[0].translation.cast<double>(),
                       wanted = by.turn() * root + Vec3<double>(by.x, by.y, 0),
                       is = body.character().model()[0].translation.cast<double>();
    EXPECT_LT((wanted - is).norm(), 0.005) << direction << ", " << by.x << " " << by.y << " " << by.yaw;
  }
}

TEST(GetUp, WhoFellStandsAgainOnItsAnimation) {
  for (const double direction : {0.0, kPi, 0.5 * kPi}) {
    Fallen body;
    body.falls(150, direction);
    body.run_until_it_stands(25);
    EXPECT_GE(body.count(BehaviourEventKind::kFallen), 1);
    EXPECT_EQ(body.count(BehaviourEventKind::kStanding), 1) << direction;
    for (int n = 0; n < 8 * 60 && body.behaviour.state() != BehaviourState::kClip; ++n) body.step();
    EXPECT_EQ(body.behaviour.state(), BehaviourState::kClip) << direction;
    EXPECT_GT(body.root_height(), 0.9);
    EXPECT_EQ(body.character().strength(), 1.f);
    body.run(6);
    EXPECT_GT(body.root_height(), 0.9);
  }
}

TEST(GetUp, StandsAgainOnGroundOfAnyHeight) {
  for (const float height : {0.65f, 3.f}) {
    Fallen body({}, height);
    body.falls(150, 0);
    body.run_until_it_stands(25);
    EXPECT_EQ(body.count(BehaviourEventKind::kStanding), 1) << height;
    body.run(2);
    EXPECT_GT(body.root_height(), 0.9) << height;
  }
}

TEST(GetUp, APushIsStoodOnGroundOfAnyHeight) {
  for (const float height : {0.f, 0.65f, 10.f}) {
    Fallen body({}, height);
    body.run(0.3);
    body.push(20, kPi);
    body.run(4);
    EXPECT_EQ(body.count(BehaviourEventKind::kFallen), 0) << height;
    EXPECT_GT(body.root_height(), 0.85) << height;
  }
}

TEST(GetUp, WhoStandsAgainIsPlayedAgain) {
  for (const double direction : {0.0, kPi, 0.5 * kPi, 0.8, 2.2, 3.9, 5.2}) {
    Fallen body;
    body.falls(150, direction);
    body.run_until_it_stands(25);
    body.run(12);
    EXPECT_EQ(body.character().report().unknown_dofs, 0) << direction;
  }
}

/// Its clip walks on while it lies, and while it stands up.
TEST(GetUp, WhoFellInAWalkWalksOn) {
  for (const double hz : {30.0, 60.0, 120.0, 240.0}) {
    Fallen body({}, 0, "walk");
    body.h = float(1 / hz);
    body.falls(80, 0);
    body.run_until_it_stands(25);
    ASSERT_GT(body.stood, 0) << hz;
    body.run(4);
    const Vec3<double> place = body.character().position();
    body.run(4);
    EXPECT_EQ(body.count(BehaviourEventKind::kFallen), 1) << hz;
    EXPECT_EQ(body.behaviour.state(), BehaviourState::kClip) << hz;
    EXPECT_GT((body.character().position() - place).norm(), 4) << "m in 4 s, at " << hz;
    EXPECT_NEAR(body.character().displacement().z, 0, 0.005) << "m, at " << hz;
  }
}

/// Limbs that cross on the way do not catch each other: it rises as who never meets itself does.
TEST(GetUp, PassesThroughItselfWhateverItsHostAsksFor) {
  Fallen asked({}, 0, "stand", true), never;
  for (Fallen* body : {&asked, &never}) {
    body->falls(120, 1);
    while (!body->behaviour.is_rising() && body->time() < 8) body->step();
    while (body->behaviour.is_rising() && body->time() < 16) body->step();
  }
  EXPECT_GT(asked.decided, 0);
  EXPECT_EQ(asked.time(), never.time());
  for (std::size_t joint = 0; joint < asked.character().model().size(); ++joint)
    EXPECT_EQ(asked.character().model()[joint].translation, never.character().model()[joint].translation);
}

/// Without a clip that rises from the back: a body that lies there turns over with the help of who rises.
TEST(GetUp, WhoLiesOnHisBackRollsOverAndRisesFromHisHands) {
  for (const double hz : {30.0, 60.0, 120.0})
    for (const double direction : {0.9 * kPi, kPi, 1.1 * kPi}) {
      Fallen body;
      body.h = float(1 / hz);
      for (Clip& clip : body.asset.clips)
        if (clip.name == "get_up_supine") clip.name = "none";
      ASSERT_TRUE(body.behaviour.use_get_ups(body.asset.skeleton, body.asset.clips));
      body.falls(80, direction);
      body.run_until_it_stands(16);
      EXPECT_GT(body.stood, 0) << hz << " Hz, " << direction;
    }
}

/// The walk itself has its toes 1 cm deep. Who comes to 1.2 m/s evenly in 0.45 s gathers 5 m/s² at most, and
/// as much again as legs take his hips up and down: 0.4 m/s in a frame at 30 Hz.
TEST(GetUp, WhoSetsOffWithAWalkStepsOffWithoutALeapAndPressesNoToesIn) {
  for (const double hz : {30.0, 60.0, 120.0, 240.0})
    for (const double direction : {0.0, 0.5 * kPi, kPi, 1.5 * kPi})
      for (const double begins : {0.3, 0.6}) {
        Fallen body({}, 0, "walk");
        body.h = float(1 / hz);
        body.run(begins);
        body.falls(80, direction);
        body.run_until_it_stands(25);
        ASSERT_GT(body.stood, 0) << hz << " Hz, " << direction;
        StandingBody<float> soles;
        ASSERT_TRUE(soles.find(body.asset.skeleton));
        Vec3<double> before = body.character().position(), way = Vec3<double>::Zero();
        double deepest = 0, leap = 0;  // m, m/s
        int played = 0;                // frames, one after the other
        const double stood = body.time();
        body.told.clear();
        while (body.time() < stood + 6) {
          body.step();
          const Vec3<double> now = body.character().position() - before;
          before += now;
          played = body.character().report().unknown_dofs == 0 ? played + 1 : 0;
          if (played > 2) leap = std::max(leap, (now - way).norm() * hz);
          way = now;
          if (played == 0) continue;
          for (std::size_t side = 0; side < 2; ++side)
            deepest = std::max(deepest, -soles.lowest_of(side, body.character().model()));
        }
        EXPECT_LT(deepest, 0.02) << "m; " << hz << " Hz, " << direction << ", " << begins;
        EXPECT_LT(leap, 0.4) << "m/s; " << hz << " Hz, " << direction << ", " << begins;
        EXPECT_EQ(body.count(BehaviourEventKind::kFallen), 0) << hz << " Hz, " << direction << ", " << begins;
        EXPECT_EQ(body.behaviour.state(), BehaviourState::kClip)
            << hz << " Hz, " << direction << ", " << begins;
      }
}

/// What a body does frame by frame, and what was saved of it on the way.
struct Saved {
  int frame = 0;
  std::vector<std::byte> world, behaviour;
};

/// Falls at 0.3 s, gets up, and is saved every now and then.
void goes_on_to_the_bit(const char* plays) {
  constexpr int kFrames = 15 * 60, kEvery = 41, kFollowed = 45;
  const auto falls = [](Fallen& body) {  // at 0.3 s
    if (body.frame == 18) body.behaviour.knock_down(body.character());
    body.step(body.frame >= 18 && body.frame < 24 ? Vec3<float>(900, 500, 0) : Vec3<float>::Zero());
  };
  std::vector<std::vector<Transform<float>>> poses;
  std::vector<Saved> saved;
  std::array<bool, 8> states{};
  Fallen body({}, 0, plays);
  for (int n = 0; n < kFrames; ++n) {
    falls(body);
    const auto model = body.character().model();
    poses.emplace_back(model.begin(), model.end());
    if (n % kEvery != 0) continue;
    Saved& now = saved.emplace_back();
    now.frame = body.frame;
    now.world.resize(body.world.snapshot_capacity());
    now.world.resize(body.world.save(now.world));
    now.behaviour.resize(body.behaviour.saved_bytes());
    EXPECT_EQ(body.behaviour.save(body.character(), now.behaviour), now.behaviour.size());
    states[static_cast<std::size_t>(body.behaviour.state())] = true;
  }
  for (const BehaviourState state : {BehaviourState::kClip, BehaviourState::kBalance, BehaviourState::kFall,
                                     BehaviourState::kGather, BehaviourState::kRise})
    EXPECT_TRUE(states[static_cast<std::size_t>(state)]) << int(state);
  for (const Saved& from : saved) {
    Fallen again({}, 0, plays);
    ASSERT_TRUE(again.world.restore(from.world));
    ASSERT_TRUE(again.behaviour.restore(from.behaviour));
    for (again.frame = from.frame; again.frame < std::min(from.frame + kFollowed, kFrames);) {
      falls(again);
      const auto& wanted = poses[static_cast<std::size_t>(again.frame - 1)];
      for (std::size_t i = 0; i < wanted.size(); ++i)
        ASSERT_EQ(again.character().model()[i].translation, wanted[i].translation)
            << "saved at " << from.frame << ", frame " << again.frame;
    }
  }
}

TEST(GetUp, WhatWasSavedGoesOnToTheBit) {
  goes_on_to_the_bit("stand");
}

TEST(GetUp, WhatWasSavedAsItSetOffGoesOnToTheBit) {
  goes_on_to_the_bit("walk");
}

TEST(GetUp, RefusesWhatNoSuchBehaviourSaved) {
  Fallen body;
  std::vector<std::byte> saved(body.behaviour.saved_bytes());
  EXPECT_EQ(body.behaviour.save(body.character(), std::span(saved).first(saved.size() - 1)), 0u);
  ASSERT_EQ(body.behaviour.save(body.character(), saved), saved.size());
  EXPECT_TRUE(body.behaviour.restore(saved));
  saved[saved.size() / 2] ^= std::byte{1};
  EXPECT_EQ(body.behaviour.restore(saved).code, Code::kBadFile);
  saved[saved.size() / 2] ^= std::byte{1};
  EXPECT_FALSE(body.behaviour.restore(std::span(saved).first(8)));
  Status status;
  Behaviour<float> other(body.asset.skeleton, {}, status);  // has no clips
  EXPECT_FALSE(other.restore(saved));
}

TEST(GetUp, NeverMeansNever) {
  BehaviourSettings settings;
  settings.get_up = GetUpPolicy::kNever;
  Fallen body(settings);
  body.falls(150, 0);
  body.run(6);
  EXPECT_EQ(body.behaviour.state(), BehaviourState::kDown);
  EXPECT_FALSE(body.behaviour.get_up());
  body.run(2);
  EXPECT_EQ(body.behaviour.state(), BehaviourState::kDown);
  EXPECT_EQ(body.count(BehaviourEventKind::kRising), 0);
}

TEST(GetUp, WaitsUntilItMay) {
  BehaviourSettings settings;
  settings.get_up = GetUpPolicy::kWhenAllowed;
  Fallen body(settings);
  body.falls(150, kPi);
  body.run(6);
  EXPECT_EQ(body.behaviour.state(), BehaviourState::kDown);
  EXPECT_TRUE(body.behaviour.fallen());
  EXPECT_TRUE(body.behaviour.get_up());
  body.step();
  EXPECT_EQ(body.behaviour.state(), BehaviourState::kGather);
  ASSERT_EQ(body.count(BehaviourEventKind::kRising), 1);
  EXPECT_EQ(body.told.back().reason, BehaviourReason::kAsked);
}

TEST(GetUp, WhoIsPushedWhileItRisesStandsInTheEnd) {
  Fallen body;
  body.falls(150, kPi);
  while (body.decided < 0 && body.time() < 10) body.step();
  body.run(2);
  body.push(60, 0.3);
  body.stood = -1;
  body.run_until_it_stands(40);
  EXPECT_GT(body.stood, 0);
}

TEST(GetUp, RepeatsToTheBit) {
  const auto run = [] {
    Fallen body;
    body.falls(150, 0.4);
    body.run(5);
    return Vec3<float>(body.character().model()[5].translation);
  };
  EXPECT_EQ(run(), run());
}

TEST(GetUp, AllocatesNothing) {
  Fallen body;
  body.falls(150, kPi);
  body.run(1);
  // Every vector that the fixture itself fills is filled by now.
  body.told.reserve(64);
  std::vector<JointJet<float>> wanted(body.jets);
  const long before = fixtures::allocations;
  while (body.behaviour.state() != BehaviourState::kRise && body.time() < 10) {
    ++body.frame;
    body.sample();
    std::copy(body.jets.begin(), body.jets.end(), wanted.begin());
    (void)body.behaviour.update(body.character(), wanted, body.h);
    (void)body.character().set_target(wanted);
    (void)body.world.step(body.h);
  }
  EXPECT_EQ(fixtures::allocations, before);
  EXPECT_EQ(body.behaviour.state(), BehaviourState::kRise);
}

TEST(GetUp, NeedsAClip) {
  Fallen body;
  EXPECT_FALSE(body.behaviour.use_get_ups(body.asset.skeleton, {}));
  EXPECT_FALSE(body.behaviour.get_up());
}

}  // namespace
}  // namespace sinew
