// What is pushed takes up all of the push.
#include <gtest/gtest.h>

#include "character/scenes.h"

namespace sinew {
namespace {

constexpr double kStep = 1 / 60.0;

/// Momentum (kg·m/s) of a limp figure in free flight half a second after a push (N·s) at its chest.
template <class T>
Vec3<double> pushed_in_flight(const Vec3<double>& impulse) {
  WorldSettings settings;
  settings.gravity.setZero();
  settings.ground = false;
  fixtures::Limp<T> limp(settings, 0, 1e-6, 1);
  Character<T> figure = limp.world.character(0);
  for (int n = 0; n < 45; ++n) {
    if (n == 15) {
      const Vec3<T> chest = figure.model()[0].translation;
      EXPECT_TRUE(figure.apply_impulse(0, chest, impulse.template cast<T>()).ok());
    }
    EXPECT_TRUE(limp.world.step(T(kStep)).ok());
  }
  return figure.report().momentum;
}

TEST(Push, GivesALimpFigureInFlightItsWholeMomentum) {
  // The backward difference takes in two thirds of it in the step itself and the rest in those after, which
  // must not pass for energy from nowhere: 3^-8 of it may, and the solver's tolerance.
  const Vec3<double> impulse(60, 20, -30);
  EXPECT_LT((pushed_in_flight<double>(impulse) - impulse).norm(), 1e-3 * impulse.norm());
  EXPECT_LT((pushed_in_flight<float>(impulse) - impulse).norm(), 1e-3 * impulse.norm());
}

/// A figure that its muscles hold, its root driven, where nothing else acts.
template <class T>
struct Floating {
  Skeleton body = fixtures::humanoid();
  World<T> world{weightless()};
  Character<T> figure = added();
  int hand = body.find("hand_l");

 private:
  static WorldSettings weightless() {
    WorldSettings settings;
    settings.gravity.setZero();
    settings.ground = false;
    return settings;
  }
  Character<T> added() {
    Status status;
    EXPECT_EQ(world.add_character(body, {}, status), 0) << status.reason;
    return world.character(0);
  }
};

/// How far a hand has moved (m) a tenth of a second after a hit or, for a tenth of a second, under a load.
double moved(int hz, const Vec3<float>& hit, const Vec3<float>& load) {
  Floating<float> scene;
  auto& [body, world, figure, hand] = scene;
  const Vec3<float> before = figure.model()[hand].translation;
  for (int n = 0; n < hz / 10; ++n) {
    const Vec3<float> now = figure.model()[hand].translation;
    if (n == 0) {
      EXPECT_TRUE(figure.apply_impulse(hand, now, hit).ok());
    }
    EXPECT_TRUE(figure.apply_force(hand, now, load).ok());
    EXPECT_TRUE(world.step(1 / float(hz)).ok());
  }
  return double((figure.model()[hand].translation - before).norm());
}

TEST(Push, OfMusclesHasTheSameEffectAtAnyRate) {
  const double truth = moved(1200, {1, 0, 0}, Vec3<float>::Zero());
  EXPECT_GT(truth, 0.03);
  for (const int hz : {20, 30, 60, 120})
    EXPECT_NEAR(moved(hz, {1, 0, 0}, Vec3<float>::Zero()) / truth, 1, 0.01) << hz << " Hz";
}

/// How far a hand has moved (m) within 0.1 s of a hit, on its way back from a nudge of 1/40 of that to a
/// side.
double moved_after_nudge(float side) {
  Floating<float> scene;
  auto& [body, world, figure, hand] = scene;
  const auto at = [&scene] { return Vec3<float>(scene.figure.model()[scene.hand].translation); };
  Vec3<float> before = at();
  for (int n = 0; n < 36; ++n) {
    if (n == 0) {
      EXPECT_TRUE(figure.apply_impulse(hand, at(), {0.05f * side, 0, 0}).ok());
    }
    if (n == 30) {
      before = at();
      EXPECT_TRUE(figure.apply_impulse(hand, at(), {2, 0, 0}).ok());
    }
    EXPECT_TRUE(world.step(float(kStep)).ok());
  }
  return double((at() - before).norm());
}

TEST(Push, HasTheSameEffectOnEitherSideOfTheAnimation) {
  // A hair's breadth on the wrong side, the muscles' brake took the hit for a way back that goes too far.
  const double on_it = moved_after_nudge(0);
  EXPECT_GT(on_it, 0.05);
  for (const float side : {-1.f, 1.f}) EXPECT_NEAR(moved_after_nudge(side) / on_it, 1, 0.02) << side;
}

TEST(Push, LeavesSpeedsThatAreThoseOfThePosesAllTheWayBack) {
  // Far off its animation, the rate of a joint's rotation vector is not its angular velocity.
  Floating<double> scene;
  auto& [body, world, figure, hand] = scene;
  const double h = 1 / 240.0;
  std::vector<std::vector<Transform<double>>> poses;
  std::vector<double> energies;
  for (int n = 0; n < 120; ++n) {
    if (n == 0) {
      ASSERT_TRUE(figure.apply_impulse(hand, figure.model()[hand].translation, {18, 9, 0}).ok());
    }
    ASSERT_TRUE(world.step(h).ok());
    poses.emplace_back(figure.model().begin(), figure.model().end());
    energies.push_back(figure.report().kinetic_energy);
  }
  double furthest = 0;
  const int arm = body.find("upperarm_l");
  // From when its muscles have caught it.
  for (std::size_t n = 48; n + 1 < poses.size(); ++n) {
    furthest = std::max(furthest, poses[n][arm].rotation.angularDistance(poses.back()[arm].rotation));
    double energy = 0;
    for (int i = 0; i < body.body_count; ++i) {
      const Joint& joint = body.joints[i];
      const auto &before = poses[n - 1][i], &after = poses[n + 1][i];
      const Vec3<double> v = (after * joint.center_of_mass - before * joint.center_of_mass) / (2 * h);
      const Vec3<double> w = rotation_log<double>(before.rotation.conjugate() * after.rotation) / (2 * h);
      energy += (joint.mass * v.squaredNorm() + w.dot(joint.inertia * w)) / 2;
    }
    EXPECT_NEAR(energies[n], energy, 0.02 * energy + 1e-3) << n;
  }
  EXPECT_GT(furthest, 1);
}

TEST(Push, IsBorneByMusclesAsALoad) {
  for (const int hz : {30, 60, 120})
    EXPECT_EQ(moved(hz, Vec3<float>::Zero(), {60, 0, 0}), 0) << "60 N: as much as a hit of 1 N·s in 1/60 s";
}

}  // namespace
}  // namespace sinew
