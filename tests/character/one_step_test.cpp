// Bossak's scheme in a world: order, pushes, contacts from the start, energy, snapshots.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "character/scenes.h"
#include "fixtures/known_failure.h"
#include "sinew/effects/restitution.h"

namespace sinew {
namespace {

WorldSettings one_step(double tolerance = 3e-5) {
  WorldSettings settings;
  settings.accuracy.tolerance = tolerance;
  return settings;
}

/// Three hinged rods of 0.5 m and 1 kg that hang from a fixed point, let go horizontally.
Skeleton pendulum() {
  Skeleton s;
  s.body_count = 3;
  for (int i = 0; i < 3; ++i) {
    Joint& joint = s.joints.emplace_back();
    joint.parent = i - 1;
    joint.type = JointType::kRevolute;
    joint.axis = Vec3<double>::UnitY();
    joint.mass = 1;
    joint.center_of_mass = {0.25, 0, 0};
    joint.inertia = Vec3<double>(1e-4, 1 / 48.0, 1 / 48.0).asDiagonal();
    if (i > 0) joint.rest.translation = {0.5, 0, 0};
  }
  return s;
}

/// Where its tip is after a time.
Vec3<double> swung(double h, double seconds) {
  WorldSettings settings = one_step(1e-10);
  settings.ground = false;
  World<double> world(settings);
  CharacterSettings limp;
  limp.root = RootDrive::kFree;
  limp.strength = 0;
  Status status;
  EXPECT_EQ(world.add_character(pendulum(), limp, status), 0) << status.reason;
  for (int n = 0; n < std::lround(seconds / h); ++n) EXPECT_TRUE(world.step(h).ok());
  return world.character(0).model()[2] * Vec3<double>(0.5, 0, 0);
}

TEST(OneStep, PendulumConvergesWithTheSquareOfTheStep) {
  const Vec3<double> exact = swung(1 / 3840.0, 0.5);
  const double coarse = (swung(1 / 60.0, 0.5) - exact).norm(), fine = (swung(1 / 120.0, 0.5) - exact).norm();
  EXPECT_LT(coarse, 6e-3);
  EXPECT_GT(std::log2(coarse / fine), 1.7);
}

/// Kinetic energy (J) of a limp figure in free flight after a push (N·s) at its chest within one step of h.
double pushed(double h) {
  WorldSettings settings = one_step(1e-7);
  settings.gravity.setZero();
  settings.ground = false;
  fixtures::Limp<double> limp(settings, 0, 1, 1);
  Character<double> figure = limp.world.character(0);
  const auto run = [&](double seconds) {
    for (int n = 0; n < std::lround(seconds / h); ++n) EXPECT_TRUE(limp.world.step(h).ok());
  };
  run(0.1);
  EXPECT_TRUE(figure.apply_impulse(0, figure.model()[0].translation, Vec3<double>(60, 20, -30)).ok());
  run(0.1);
  return figure.report().kinetic_energy;
}

TEST(OneStep, APushHasItsEffectWhateverTheStep) {
  const double exact = pushed(1 / 2000.0);
  for (const double hz : {60, 120}) EXPECT_NEAR(pushed(1 / hz) / exact, 1, 0.05) << hz << " Hz";
  // Wanted: 5 %. Three steps of flight after it take the rest.
  EXPECT_NEAR(pushed(1 / 30.0) / exact, 1, 0.12);
}

TEST(OneStep, ABoxThatBeginsOnTheFloorStaysThere) {
  World<float> world(one_step());
  PropSettings box;
  box.shape = Shape::kBox;
  box.size = {0.1, 0.1, 0.1};
  box.mass = 20;
  box.pose.translation = {0, 0, 0.1};
  Status status;
  ASSERT_EQ(world.add_prop(box, status), 0) << status.reason;
  float highest = 0, fastest = 0;
  for (int n = 0; n < 120; ++n) {
    ASSERT_TRUE(world.step(1 / 60.0f).ok());
    highest = std::max(highest, world.prop_pose(0).translation.z());
    if (n > 5) fastest = std::max(fastest, world.prop_velocity(0).norm());
  }
  EXPECT_LT(highest, 0.1005f);
  EXPECT_LT(fastest, 1e-3f);
}

PropSettings thrown(Shape shape, double height, double speed) {
  PropSettings prop;
  prop.shape = shape;
  prop.size = shape == Shape::kBox ? Vec3<double>(0.15, 0.15, 0.05) : Vec3<double>(0.1, 0, 0);
  prop.mass = 5;
  prop.pose.translation = {0, 0, height};
  prop.velocity = {speed, 0, -speed};
  return prop;
}

/// m: how far a crate slides that comes down on the floor at 45 degrees, over heights that it falls from.
double slid(double h) {
  constexpr int kHeights = 16;  // so that steps fall differently on the impact
  double sum = 0;
  for (int n = 0; n < kHeights; ++n) {
    World<double> world(one_step());
    Status status;
    EXPECT_EQ(world.add_prop(thrown(Shape::kBox, 0.25 + 0.004 * n, 3.5), status), 0) << status.reason;
    for (int k = 0; k < std::lround(1 / h); ++k) EXPECT_TRUE(world.step(h).ok());
    sum += world.prop_pose(0).translation.x() / kHeights;
  }
  return sum;
}

/// N·s: what the floor gives a nearly straight limb of two rods that falls on its end at 4 m/s, within 0.1 s,
/// over heights that it falls from. It folds within the step.
double landed(double h) {
  constexpr int kHeights = 16;
  Skeleton limb;
  limb.body_count = 2;
  for (const double mass : {20.0, 5.0}) {
    Joint& rod = limb.joints.emplace_back();
    rod.parent = static_cast<int>(limb.joints.size()) - 2;
    rod.type = rod.parent < 0 ? JointType::kFree : JointType::kRevolute;
    rod.axis = Vec3<double>::UnitY();
    rod.mass = mass;
    rod.center_of_mass = {0, 0, -0.25};
    rod.inertia = mass * Vec3<double>(1 / 48.0, 1 / 48.0, 1e-3).asDiagonal();
    if (rod.parent >= 0) rod.rest.translation = {0, 0, -0.5};
  }
  Collider foot;
  foot.joint = 1;
  foot.local.translation = {0, 0, -0.5};
  limb.colliders.push_back(foot);
  CharacterSettings limp;
  limp.root = RootDrive::kFree;
  limp.strength = 0;
  double sum = 0;
  for (int n = 0; n < kHeights; ++n) {
    World<double> world(one_step());
    Status status;
    EXPECT_EQ(world.add_character(limb, limp, status), 0) << status.reason;
    std::vector<JointJet<double>> jets(2);
    jets[1].translation = limb.joints[1].rest.translation;
    jets[0].rotation = Quat<double>(Eigen::AngleAxisd(0.1, Vec3<double>::UnitY()));
    jets[1].rotation = Quat<double>(Eigen::AngleAxisd(0.1, Vec3<double>::UnitY()));
    jets[0].translation.z() = 1.05 + 0.004 * n;
    jets[0].velocity.z() = -4;
    EXPECT_TRUE(world.character(0).set_target(jets).ok());
    (void)world.character(0).reset();
    for (int k = 0; k < std::lround(0.1 / h); ++k) EXPECT_TRUE(world.step(h).ok());
    sum += world.character(0).report().momentum.z() / kHeights;
  }
  return sum + 25 * (4 + 9.81 * 0.1);
}

TEST(OneStep, AStretchedLimbStrikesWithAllOfItsWeight) {
  const double exact = landed(1 / 3840.0);
  ASSERT_GT(exact, 10);
  EXPECT_NEAR(landed(1 / 60.0) / exact, 1, 0.1);
  EXPECT_NEAR(landed(1 / 240.0) / exact, 1, 0.05);
}

TEST(OneStep, AThrownCrateIsStoppedByFrictionAtTheImpact) {
  const double exact = slid(1 / 960.0);
  EXPECT_NEAR(slid(1 / 60.0) / exact, 1, 0.2);
  EXPECT_NEAR(slid(1 / 120.0) / exact, 1, 0.1);
}

TEST(OneStep, ABallThatBouncesLeavesRolling) {
  for (const double hz : {30, 60, 120})
    for (int n = 0; n < 4; ++n) {
      WorldSettings settings = one_step();
      settings.ground_friction = 1;
      World<double> world(settings);
      ASSERT_TRUE(world.declare<Restitution>().ok());
      PropSettings ball = thrown(Shape::kSphere, 0.35 + 0.01 * n, 3);
      ball.friction = 1;
      ball.restitution = 0.8;
      Status status;
      ASSERT_EQ(world.add_prop(ball, status), 0) << status.reason;
      bool down = false;
      for (int k = 0; k < hz; ++k) {
        ASSERT_TRUE(world.step(1 / hz).ok());
        const bool falls = world.prop_velocity(0).z() < 0;
        if (down && !falls) break;
        down = down || falls;
      }
      const Quat<double> before = world.prop_pose(0).rotation;
      ASSERT_TRUE(world.step(1 / hz).ok());
      const Vec3<double> speed = world.prop_velocity(0),
                         spin = hz * rotation_log<double>(world.prop_pose(0).rotation * before.conjugate());
      EXPECT_NEAR(speed.x(), 3 * 5 / 7.0, 0.03 * 3) << hz << " Hz";
      EXPECT_NEAR(spin.y() * 0.1, speed.x(), 0.03 * 3) << hz << " Hz";
    }
}

/// Where limp figures that start at the given places (m, along x) are after half a second, thirty steps, one
/// of which was struck in flight: [figure] place of its head.
std::vector<Vec3<float>> struck_in_flight(const std::vector<double>& places, double struck) {
  World<float> world(one_step());
  const Skeleton body = fixtures::humanoid();
  CharacterSettings limp;
  limp.root = RootDrive::kFree;
  limp.strength = 0;
  for (std::size_t n = 0; n < places.size(); ++n) {
    Status status;
    EXPECT_EQ(world.add_character(body, limp, status), static_cast<int>(n)) << status.reason;
    std::vector<JointJet<float>> jets(body.joints.size());
    for (std::size_t i = 0; i < jets.size(); ++i)
      jets[i].translation = body.joints[i].rest.translation.cast<float>();
    jets[0].translation += Vec3<float>(float(places[n]), 0, 3);
    EXPECT_TRUE(world.character(static_cast<int>(n)).set_target(jets).ok());
    (void)world.character(static_cast<int>(n)).reset();
  }
  for (int k = 0; k < 30; ++k) {
    for (std::size_t n = 0; n < places.size(); ++n) {
      Character<float> figure = world.character(static_cast<int>(n));
      if (k == 5 && places[n] == struck) {
        EXPECT_TRUE(figure.apply_impulse(3, figure.model()[3].translation, Vec3<float>(60, 20, 30)).ok());
      }
    }
    EXPECT_TRUE(world.step(1 / 60.0f).ok());
  }
  std::vector<Vec3<float>> out;
  for (std::size_t n = 0; n < places.size(); ++n)
    out.push_back(world.character(static_cast<int>(n)).model().back().translation);
  return out;
}

TEST(OneStep, AStrikeIsThatOfTheOneWhoWasStruck) {
  const std::vector<double> places{0, 20, 40, 60};
  for (const double struck : places) {
    const std::vector<Vec3<float>> together = struck_in_flight(places, struck);
    for (std::size_t n = 0; n < places.size(); ++n)
      EXPECT_EQ(together[n], struck_in_flight({places[n]}, struck)[0]) << struck << ", " << places[n];
  }
}

/// J: the most that a limp fall stands above the energy that it starts with.
template <class T>
double gain(double h, unsigned seed) {
  fixtures::Limp<T> limp(one_step(), 1.5, 3, seed);
  const auto energy = [&] {
    const CharacterReport& r = limp.world.character(0).report();
    return r.kinetic_energy + r.potential_energy + r.elastic_energy;
  };
  double start = 0, most = -1e9;
  for (int n = 0; n < std::lround(2 / h); ++n) {
    EXPECT_TRUE(limp.world.step(T(h)).ok());
    if (n == 0) start = energy();
    most = std::max(most, energy() - start);
  }
  return most;
}

TEST(OneStep, LimpFallsGainNoEnergy) {
  for (const double hz : {240, 120, 60, 30, 15})
    for (unsigned seed = 1; seed <= 3; ++seed) {
      EXPECT_LT(gain<double>(1 / hz, seed), 1e-6) << hz << " Hz, seed " << seed;
      EXPECT_LT(gain<float>(1 / hz, seed), 0.05) << hz << " Hz, seed " << seed;  // of 1200 J
    }
}

/// A figure that plays, is struck, falls limp and gets its strength back.
template <class T>
struct Play {
  fixtures::Playing<T> playing{one_step()};
  int frame = 0;

  void step() {
    Character<T> hero = playing.character();
    if (frame == 20) {
      EXPECT_TRUE(hero.apply_impulse(2, hero.model()[2].translation, Vec3<T>(120, 40, 0)).ok());
    }
    if (frame == 60) {
      (void)hero.set_root_drive(RootDrive::kFree);
      EXPECT_TRUE(hero.set_strength(T(0)).ok());
    }
    if (frame == 150) {
      (void)hero.set_root_drive(RootDrive::kAssisted);
      EXPECT_TRUE(hero.set_strength(T(1)).ok());
    }
    playing.step();
    ++frame;
  }
  std::vector<std::byte> saved() {
    std::vector<std::byte> bytes(playing.world.snapshot_capacity());
    bytes.resize(playing.world.save(bytes));
    EXPECT_FALSE(bytes.empty());
    return bytes;
  }
};

template <class T>
void goes_on_to_the_bit() {
  for (const int at : {5, 21, 25, 62, 75, 120, 152}) {
    Play<T> one, other;
    for (int n = 0; n < at; ++n) one.step();
    ASSERT_TRUE(other.playing.world.restore(one.saved()).ok());
    other.frame = one.frame;
    other.playing.time = one.playing.time;
    for (int n = 0; n < 30; ++n) {
      one.step();
      other.step();
    }
    EXPECT_EQ(one.saved(), other.saved()) << "saved in frame " << at;
  }
}

TEST(OneStep, RestoredItGoesOnToTheBit) {
  goes_on_to_the_bit<float>();
  goes_on_to_the_bit<double>();
}

/// Where a figure's joints are half a second after it was struck, with all hinges swinging at 20 rad/s, in
/// frames of 1/60 s that are cut into `parts`, or in as many steps.
std::vector<Transform<double>> swung(int parts, bool as_steps) {
  WorldSettings settings = one_step(1e-7);
  settings.accuracy.substeps = as_steps ? 1 : parts;
  settings.ground = false;  // what feet kick there is chaotic
  fixtures::Playing<double> playing(settings);
  const int steps = as_steps ? parts : 1;
  for (int n = 0; n <= 30 * steps; ++n) {
    const double t = n / (60.0 * steps);
    std::vector<JointJet<double>> jets = fixtures::idle<double>(playing.skeleton, 0);
    for (std::size_t i = 0; i < jets.size(); ++i) {
      const Joint& joint = playing.skeleton.joints[i];
      if (joint.type != JointType::kRevolute) continue;
      jets[i].rotation =
          jets[i].rotation * Quat<double>(Eigen::AngleAxisd(0.2 * std::sin(20 * t), joint.axis));
      jets[i].omega = 4 * std::cos(20 * t) * joint.axis;
      jets[i].alpha = -80 * std::sin(20 * t) * joint.axis;
    }
    Character<double> hero = playing.character();
    EXPECT_TRUE(hero.set_target(jets).ok());
    if (n == 0) (void)hero.reset();
    if (n / steps == 6) {
      EXPECT_TRUE(hero.apply_force(2, hero.model()[2].translation, 60 * Vec3<double>(60, 20, 0)).ok());
    }
    if (n > 0) {
      EXPECT_TRUE(playing.world.step(1 / (60.0 * steps)).ok());
    }
  }
  const auto model = playing.character().model();
  return {model.begin(), model.end()};
}

TEST(OneStep, InPartsOfAFrameWhatIsLedMovesAsInSteps) {
  // With the speeds of the frame's end in every part, limbs were flung away.
  for (const int parts : {4, 16}) {
    const auto in_parts = swung(parts, false), in_steps = swung(parts, true);
    double apart = 0;
    for (std::size_t i = 0; i < in_parts.size(); ++i)
      apart = std::max(apart, (in_parts[i].translation - in_steps[i].translation).norm());
    EXPECT_LT(apart, 0.002) << parts << " parts";  // the cubic between two targets is not the sine
  }
}

TEST(OneStep, TorquesKeepToTheirLimits) {
  Play<float> play;
  float most = 0;
  for (int n = 0; n < 60; ++n) {
    play.step();
    const auto torque = play.playing.character().torque(), limit = play.playing.character().limit();
    for (std::size_t dof = 6; dof < torque.size(); ++dof)
      if (limit[dof] > 0) most = std::max(most, std::abs(torque[dof]) / limit[dof]);
  }
  EXPECT_GT(most, 0.9f);
  SINEW_FAILS_TODAY(most < 1.02f, "1.06 in the chart of a joint that a hit has thrown far off its way back");
}

}  // namespace
}  // namespace sinew
