// RootDrive::kGrounded: the clip is the answer until the root needs more than the ground can give.
#include "pushed.h"
#include "sinew/effects/continuous_detection.h"
#include "sinew/effects/static_shape.h"
#include "sinew/skeleton/rotation.h"

namespace sinew {
namespace {

using fixtures::Pushed;

TEST(Grounded, StandingAndWalkingArePlayedToTheBit) {
  for (const char* name : {"stand", "walk"}) {
    Pushed grounded(name), led(name, RootDrive::kKinematic);
    for (int n = 0; n < 600; ++n) {
      grounded.step();
      led.step();
      const auto a = grounded.character().model(), b = led.character().model();
      for (std::size_t i = 0; i < a.size(); ++i) {
        ASSERT_EQ(a[i].translation, b[i].translation) << name << " frame " << n;
        ASSERT_EQ(a[i].rotation.coeffs(), b[i].rotation.coeffs()) << name << " frame " << n;
      }
      // Metered: what an invisible hand did is at most what the settings allow it.
      ASSERT_LE(grounded.character().report().help_force, std::sqrt(3.0) * 8 * 1.01);
      ASSERT_LE(grounded.character().report().help_torque, std::sqrt(3.0) * 8 * 1.01);
    }
    EXPECT_EQ(grounded.solved, 0) << name;
  }
}

/// Ground 30 cm above the floor, of whatever kind.
struct Raised : Pushed {
  explicit Raised(const char* name, RootDrive root = RootDrive::kGrounded) : Pushed(name, root) {
    ground = 0.3f;
  }
  void begin() {
    sample();
    (void)character().set_target(jets);
    (void)character().reset();
  }
};

/// Plays on ground that `add` puts into the world as on the floor: nothing is solved, and muscles do as much.
template <class Add>
void expect_as_on_the_floor(const char* name, RootDrive root, const Add& add) {
  Pushed floor(name, root);
  Raised raised(name, root);
  add(raised.world);
  raised.begin();
  for (int n = 0; n < 240; ++n) {
    floor.step();
    raised.step();
    const auto wanted = floor.character().torque(), is = raised.character().torque();
    for (std::size_t dof = 6; dof < wanted.size(); ++dof)
      ASSERT_NEAR(is[dof], wanted[dof], 0.1 + 2e-3 * std::abs(double(wanted[dof])))
          << name << " frame " << n << " dof " << dof;
    ASSERT_LE(raised.character().report().help_torque, floor.character().report().help_torque + 0.05);
  }
  EXPECT_EQ(floor.solved, 0) << name;
  EXPECT_EQ(raised.solved, 0) << name;
  EXPECT_NEAR(raised.character().position().z() - floor.character().position().z(), 0.3, 1e-6);
}

TEST(Grounded, BoxesAreGroundAsTheFloorIs) {
  for (const char* name : {"stand", "walk"})
    for (const RootDrive root : {RootDrive::kGrounded, RootDrive::kKinematic})
      expect_as_on_the_floor(name, root, [](World<float>& world) {
        for (const double x : {-3.0, 3.0, 9.0}) {  // side by side
          Collider box;
          box.shape = Shape::kBox;
          box.size = {3, 2, 0.15};
          box.local.translation = {x, 0, 0.15};
          ASSERT_TRUE(world.add_obstacle(box));
        }
      });
}

TEST(Grounded, ShapesOfTheHostAreGroundAsTheFloorIs) {
  const std::vector<double> heights(16, 0.3);
  const HeightField field(heights, 4, {-10, -10, 0}, 10);
  for (const char* name : {"stand", "walk"})
    expect_as_on_the_floor(name, RootDrive::kGrounded,
                           [&](World<float>& world) { ASSERT_TRUE(world.add_obstacle(field, 0.8)); });
}

TEST(Grounded, SlidesWhereBoxesAreIcy) {
  Raised body("walk");
  Collider ice;
  ice.shape = Shape::kBox;
  ice.size = {20, 20, 0.15};
  ice.local.translation.z() = 0.15;
  ice.friction = 0.01;
  ASSERT_TRUE(body.world.add_obstacle(ice));
  body.begin();
  body.run(2);
  EXPECT_GT(body.solved, 0);  // what a walk asks for is more than such ground gives
}

/// What he is going to touch in the step does not pass him by where he would be played: a ball of 20 m/s is
/// a third of a metre ahead of him when a step of 1/60 s begins, and behind him when it ends.
TEST(Grounded, IsHitByWhatIsThrownAtHim) {
  for (const double hz : {15.0, 30.0, 60.0, 120.0})
    for (const double speed : {4.0, 10.0, 20.0, 40.0}) {
      Pushed body("stand");
      ASSERT_TRUE(body.world.declare<ContinuousDetection>());
      body.h = float(1 / hz);
      PropSettings ball;
      ball.size = Vec3<double>::Constant(0.11);
      ball.mass = 0.45;
      ball.pose.translation = {-2, 0, 1.3};
      ball.velocity = {speed, 0, speed < 10 ? 1.5 : 0};
      Status status;
      const int index = body.world.add_prop(ball, status);
      ASSERT_GE(index, 0) << status.reason;
      body.run(2 / speed + 0.5);
      EXPECT_GT(body.solved, 0) << hz << " Hz, " << speed << " m/s";
      EXPECT_LT(body.world.prop_pose(index).translation.x(), 0) << hz << " Hz, " << speed << " m/s";
    }
}

/// What an animation's accelerations ask of no floor is its own; what bears it when it is still is the
/// ground's.
TEST(Grounded, LeansNoFurtherThanItsFeetBearAndStandsOnNoAir) {
  const auto falls = [](const std::function<void(JointJet<float>&, float)>& change) {
    Pushed body("stand");
    body.behave = [&](std::span<JointJet<float>> jets) { change(jets[0], float(body.time())); };
    body.run(5);
    return body.root_height() < 0.6 * double(body.jets[0].translation.z());
  };
  const auto lean = [](float to) {
    return [=](JointJet<float>& root, float time) {  // about the ankles
      const Quat<float> turn = rotation_exp<float>(Vec3<float>(0, std::min(0.1f * time, to), 0));
      const Vec3<float> ankles(0, 0, 0.08f);
      root.rotation = turn * root.rotation;
      root.translation = ankles + turn * Vec3<float>(root.translation - ankles);
    };
  };
  EXPECT_FALSE(falls(lean(0.02f)));
  EXPECT_TRUE(falls(lean(0.4f)));
  EXPECT_FALSE(falls([](JointJet<float>&, float) {}));
  // Where it is half a metre up, it falls to where it stands.
  Pushed above("stand");
  above.behave = [](std::span<JointJet<float>> jets) { jets[0].translation.z() += 0.5f; };
  above.run(1);
  EXPECT_GT(above.solved, 0);
  EXPECT_LT(above.root_height(), 1.1);
}

TEST(Grounded, AWallBesideIsNoGround) {
  Pushed plain("stand");
  Pushed beside("stand");
  Collider wall;
  wall.shape = Shape::kBox;
  wall.size = {0.1, 2, 1};
  const double arm = 0.45;
  wall.local.translation = {0, arm + 2, 1};
  ASSERT_TRUE(beside.world.add_obstacle(wall));
  for (int n = 0; n < 60; ++n) {
    plain.step();
    beside.step();
    for (std::size_t dof = 0; dof < plain.character().torque().size(); ++dof)
      ASSERT_NEAR(plain.character().torque()[dof], beside.character().torque()[dof], 0.02);
  }
  EXPECT_EQ(beside.solved, 0);
}

TEST(Toned, StandingAndWalkingArePlayedToTheBit) {
  for (const char* name : {"stand", "walk"})
    for (const RootDrive root : {RootDrive::kKinematic, RootDrive::kGrounded}) {
      Pushed toned(name, root), rigid(name, RootDrive::kKinematic);
      ASSERT_TRUE(toned.character().set_tone(Tone::kAlert));
      for (int n = 0; n < 180; ++n) {
        toned.step();
        rigid.step();
        const auto a = toned.character().model(), b = rigid.character().model();
        for (std::size_t i = 0; i < a.size(); ++i) {
          ASSERT_EQ(a[i].translation, b[i].translation) << name << " frame " << n;
          ASSERT_EQ(a[i].rotation.coeffs(), b[i].rotation.coeffs()) << name << " frame " << n;
        }
      }
      EXPECT_EQ(toned.solved, 0) << name;
    }
}

TEST(Toned, APushMovesALedBodyWhichIsPlayedAgainSoon) {
  for (const char* name : {"stand", "walk"}) {
    Pushed toned(name, RootDrive::kKinematic), led(name, RootDrive::kKinematic);
    ASSERT_TRUE(toned.character().set_tone(Tone::kAlert));
    toned.run(0.3);
    led.run(0.3);
    toned.push(15, 0.4);
    led.run(0.1);
    EXPECT_GT(toned.solved, 0);
    const auto chest = static_cast<std::size_t>(toned.asset.skeleton.find(Role::kChest));
    EXPECT_GT(
        toned.character().model()[chest].rotation.angularDistance(led.character().model()[chest].rotation),
        0.01f)
        << name;
    toned.run(2);
    const int before = toned.solved;
    toned.run(0.5);
    EXPECT_EQ(toned.solved, before) << name << ": still solved 2 s later";
    EXPECT_TRUE(toned.character().on_animation());
  }
}

TEST(Grounded, AStatueTopplesWhereThePendulumSays) {
  // m·ω·d: 36 N·s ahead, 26 back, 31 to the side, for a body that never moves a joint.
  const double ahead = 0, back = std::acos(-1.0), left = std::acos(0.0);
  const auto falls = [](double impulse, double direction) {
    Pushed statue("stand");
    statue.run(0.3);
    statue.push(impulse, direction);
    statue.run(6);
    return statue.root_height() < 0.6;
  };
  EXPECT_FALSE(falls(0.8 * 36, ahead));
  EXPECT_TRUE(falls(1.25 * 36, ahead));
  EXPECT_FALSE(falls(0.8 * 26, back));
  EXPECT_TRUE(falls(1.35 * 26, back));
  EXPECT_FALSE(falls(0.8 * 31, left));
  EXPECT_TRUE(falls(1.25 * 31, left));
}

TEST(Grounded, ComesToRestAndIsPlayedFromWhereItStands) {
  Pushed statue("stand");
  statue.run(0.3);
  statue.push(20, 0.4);
  EXPECT_GT(statue.solved, 0);
  statue.run(4);
  const int before = statue.solved;
  statue.run(1);
  EXPECT_EQ(statue.solved, before) << "still solved";
  // It stands where its feet came to rest: within centimetres, and told.
  const Displacement by = statue.character().displacement();
  EXPECT_LT(std::hypot(by.x, by.y), 0.05);
  const Vec3<double> wanted = by.turn() * Vec3<double>(statue.jets[0].translation.cast<double>());
  const Vec3<double> is = statue.character().position();
  EXPECT_LT((is - Vec3<double>(wanted.x() + by.x, wanted.y() + by.y, wanted.z())).norm(), 1e-4);
  (void)statue.character().reset();
  EXPECT_FALSE(statue.character().displacement().any());
}

TEST(Grounded, DisplacedItPlaysTheSameMotionElsewhere) {
  Pushed moved("stand"), plain("stand");
  moved.run(0.3);
  moved.push(20, 0.4);
  moved.run(5);
  plain.frame = moved.frame;
  const Displacement to = moved.character().displacement();
  ASSERT_TRUE(to.any());
  plain.sample();
  (void)plain.character().set_target(plain.jets);
  (void)plain.character().reset();
  for (int n = 0; n < 60; ++n) {
    moved.step();
    plain.step();
    const auto a = moved.character().model(), b = plain.character().model();
    for (std::size_t i = 0; i < a.size(); ++i) {
      const Vec3<double> wanted =
          to.turn() * Vec3<double>(b[i].translation.cast<double>()) + Vec3<double>(to.x, to.y, 0);
      ASSERT_LT((a[i].translation.cast<double>() - wanted).norm(), 1e-5) << n;
    }
  }
}

TEST(Grounded, GoesOnFromASnapshotWithTheSameBits) {
  Pushed statue("stand");
  statue.run(0.3);
  statue.push(20, 0.4);
  for (const double later : {0.0, 1.3, 1.0}) {  // pushed, on its way back, displaced
    statue.run(later);
    std::vector<std::byte> kept(statue.world.snapshot_capacity());
    kept.resize(statue.world.save(kept));
    ASSERT_FALSE(kept.empty());
    const int frame = statue.frame;
    statue.run(0.5);
    const std::vector<Transform<float>> first(statue.character().model().begin(),
                                              statue.character().model().end());
    ASSERT_TRUE(statue.world.restore(kept));
    statue.frame = frame;
    statue.run(0.5);
    for (std::size_t i = 0; i < first.size(); ++i)
      ASSERT_EQ(first[i].translation, statue.character().model()[i].translation) << later;
  }
}

TEST(Grounded, WithoutMusclesItIsARagdoll) {
  Pushed limp("stand");
  (void)limp.character().set_strength(0.f);
  limp.run(2);
  EXPECT_LT(limp.root_height(), 0.4);
}

TEST(Grounded, RefusesHelpThatIsNone) {
  Asset asset;
  ASSERT_TRUE(load_asset((binary_dir() + "/sample.sinew").c_str(), asset));
  World<float> world{WorldSettings{}};
  CharacterSettings settings;
  settings.help_torque = std::nan("");
  Status status;
  EXPECT_EQ(world.add_character(asset.skeleton, settings, status), -1);
  EXPECT_FALSE(status);
}

}  // namespace
}  // namespace sinew
