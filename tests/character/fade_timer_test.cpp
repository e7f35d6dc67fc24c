// How long transitions are that muscles time, against closed forms and against what a world finds.
#include "sinew/character/fade_timer.h"

#include <numbers>

#include "character/rods.h"
#include "character/scenes.h"

namespace sinew {
namespace {

/// A character in a world, and a transition between two poses at rest.
struct Scene {
  Skeleton skeleton;
  World<double> world;
  std::vector<JointJet<double>> to;
  std::vector<double> numbers;
  InertialState<double> offset;

  explicit Scene(int rods, const Vec3<double>& gravity, double strength = 1)
      : skeleton(fixtures::rods(rods)), world(settings(gravity)), to(std::size_t(rods) + 1) {
    CharacterSettings with;
    with.strength = strength;
    Status status;
    EXPECT_EQ(world.add_character(skeleton, with, status), 0) << status.reason;
    for (std::size_t j = 2; j < to.size(); ++j) to[j].translation = {1, 0, 0};
  }
  static WorldSettings settings(const Vec3<double>& gravity) {
    WorldSettings settings;
    settings.ground = false;
    settings.gravity = gravity;
    return settings;
  }
  static Quat<double> turn(double angle) { return rotation_exp<double>(Vec3<double>(0, angle, 0)); }
  /// From a pose that is turned by `angle` in each joint.
  FadeQuestion<double> question(double angle, double budget = 0.5, double most = 2) {
    std::vector<JointJet<double>> from = to;
    for (std::size_t j = 1; j < from.size(); ++j) from[j].rotation = from[j].rotation * turn(angle);
    numbers.assign(inertial_numbers(static_cast<int>(to.size()), 1), 0);
    offset = {numbers, static_cast<int>(to.size()), 1, 0, 0};
    EXPECT_TRUE(begin_inertial<double>(from, to, most, offset).ok());
    return {to, &offset, budget, 0.08, most};
  }
  /// Torques of the motion at an instant, as the world finds them when it is played.
  std::vector<double> torque(double elapsed, double duration) {
    offset.elapsed = elapsed;
    offset.duration = duration;
    std::vector<JointJet<double>> jets = to;
    EXPECT_TRUE((InertializeJob<double>{to, &offset, {}, jets}.Run().ok()));
    EXPECT_TRUE(world.character(0).set_strength(1000).ok());  // whatever it asks
    EXPECT_TRUE(world.character(0).set_target(jets).ok());
    EXPECT_TRUE(world.character(0).reset().ok());
    EXPECT_TRUE(world.character(0).set_target(jets).ok());
    EXPECT_TRUE(world.step(1e-3).ok());
    EXPECT_EQ(world.character(0).report().unknown_dofs, 0);
    const auto span = world.character(0).torque();
    return {span.begin() + 6, span.end()};
  }
};

const Vec3<double> kNone = Vec3<double>::Zero(), kDown{0, 0, -9.81};

/// A quintic offset from rest accelerates by 10/√3·θ/T² at most.
double closed_form(double angle, double acceleration) {
  return std::sqrt(10 / std::sqrt(3) * angle / acceleration);
}

TEST(FadeTimer, ARodsIsThatOfItsLimitAndInertia) {
  Scene scene(1, kNone);
  FadeTimer<double> timer(scene.world, 0);
  const double inertia = 2.0 / 12 + 2 * 0.25;
  // The offset is a rotation vector by its parameters, which is 4 tan(θ/4): to second order.
  EXPECT_NEAR(timer.duration(scene.question(0.4)), closed_form(0.4, 0.5 * 30 / inertia), 5e-3);
  EXPECT_EQ(timer.tried(), 1);
  EXPECT_NEAR(timer.duration(scene.question(0.4, 0.25)), closed_form(0.4, 0.25 * 30 / inertia), 5e-3);
  EXPECT_EQ(timer.duration(scene.question(1e-4)), 0.08) << "the shortest that there is";
  EXPECT_EQ(timer.duration(scene.question(0.4, 0.5, 0.2)), 0.2) << "as long as it may be";
}

TEST(FadeTimer, CountsWhatTheMotionGoneToAsksNotWhatIsLeft) {
  Scene level(1, kDown), hanging(1, kDown);
  hanging.to[1].rotation = Scene::turn(std::numbers::pi / 2);  // X down: its muscle bears nothing
  FadeTimer<double> of_level(level.world, 0), of_hanging(hanging.world, 0);
  const double inertia = 2.0 / 12 + 2 * 0.25;
  const double loaded = of_level.duration(level.question(0.1)),
               free = of_hanging.duration(hanging.question(0.1));
  EXPECT_NEAR(loaded, closed_form(0.1, 0.5 * (30 - 9.81) / inertia), 5e-3);
  EXPECT_NEAR(free, closed_form(0.1, 0.5 * 30 / inertia), 5e-3);
  // What the body does meanwhile changes nothing.
  (void)hanging.torque(0, 1);
  EXPECT_TRUE(hanging.world.character(0).set_strength(1).ok());
  EXPECT_EQ(of_hanging.duration(hanging.question(0.1)), free);
}

TEST(FadeTimer, TiredMusclesTakeLonger) {
  Scene fresh(1, kNone), tired(1, kNone, 0.25);
  FadeTimer<double> a(fresh.world, 0), b(tired.world, 0);
  EXPECT_NEAR(b.duration(tired.question(0.4)), 2 * a.duration(fresh.question(0.4)), 1e-2);
}

// Two rods that unfold together load the first hinge by more than each alone: the closed form is too short,
// and the residual pass finds it.
TEST(FadeTimer, IsConfirmedByAllMusclesTogether) {
  Scene scene(2, kNone);
  FadeTimer<double> timer(scene.world, 0);
  const double budget = 0.5, allowed = budget * 30 * 1.001;
  const double duration = timer.duration(scene.question(0.5, budget));
  EXPECT_GT(timer.tried(), 1);
  EXPECT_LT(duration, 2);
  const auto most = [&](double of) {
    (void)scene.question(0.5, budget);
    double greatest = 0;
    for (const double part : {0.2113, 0.7887})
      for (const double torque : scene.torque(part * of, of)) greatest = std::max(greatest, std::abs(torque));
    return greatest;
  };
  EXPECT_LE(most(duration), allowed);
  EXPECT_GT(most(duration / 1.3), allowed) << "and not longer than need be";
}

TEST(FadeTimer, OfNobodyIsAsLongAsItMayBe) {
  Scene scene(1, kNone);
  FadeTimer<double> nobody(scene.world, 7);
  EXPECT_EQ(nobody.duration(scene.question(0.4, 0.5, 0.7)), 0.7);
  FadeTimer<double> timer(scene.world, 0);
  FadeQuestion<double> no_pose = scene.question(0.4);
  no_pose.destination = {};
  EXPECT_EQ(timer.duration(no_pose), 2);
}

}  // namespace
}  // namespace sinew
