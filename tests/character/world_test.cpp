#include "sinew/character/world.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "fixtures/humanoid.h"

namespace sinew {
namespace {

template <class T>
std::vector<JointJet<T>> rest_jets(const Skeleton& s) {
  std::vector<JointJet<T>> jets(s.joints.size());
  for (std::size_t i = 0; i < jets.size(); ++i) {
    jets[i].rotation = s.joints[i].rest.rotation.cast<T>();
    jets[i].translation = s.joints[i].rest.translation.cast<T>();
  }
  return jets;
}

/// Limp: no muscles, free root, random joint speeds with the given rms (rad/s).
template <class T>
struct LimpFall {
  World<T> world;
  LimpFall(Accuracy accuracy, double height, double speed, unsigned seed, bool gravity = true)
      : world(settings(accuracy, gravity)) {
    Skeleton body = fixtures::humanoid();
    for (Joint& j : body.joints)
      for (DofLimits& d : j.dofs) d.dry_friction = 0;
    CharacterSettings limp;
    limp.root = RootDrive::kFree;
    limp.strength = 0;
    Status status;
    world.add_character(body, limp, status);
    EXPECT_TRUE(status.ok()) << status.reason;
    auto jets = rest_jets<T>(body);
    std::mt19937 random(seed);
    std::normal_distribution<double> normal(0, speed);
    jets[0].translation.z() += T(height);
    for (int i = 0; i < body.body_count; ++i) {
      if (body.joints[i].type == JointType::kRevolute)
        jets[i].omega = (body.joints[i].axis * normal(random)).cast<T>();
      else
        for (int a = 0; a < 3; ++a) jets[i].omega[a] = T(normal(random));
    }
    EXPECT_TRUE(world.character(0).set_target(jets).ok());
    world.character(0).reset();
  }
  static WorldSettings settings(Accuracy accuracy, bool gravity) {
    WorldSettings s;
    s.accuracy = accuracy;
    if (!gravity) {
      s.gravity.setZero();
      s.ground = false;
    }
    return s;
  }
};

template <class T>
void print_fall(double h, Scheme scheme) {
  Accuracy accuracy;
  accuracy.scheme = scheme;
  LimpFall<T> fall(accuracy, 0.8, 3, 7);
  double energy = NAN, worst = 0, passes = 0, deepest = 0;
  int bad = 0, most = 0, steps = int(4 / h);
  for (int n = 0; n < steps; ++n) {
    ASSERT_TRUE(fall.world.step(T(h)).ok());
    const CharacterReport& r = fall.world.character(0).report();
    const double now = r.kinetic_energy + r.potential_energy;
    if (n > 0) worst = std::max(worst, now - energy);
    energy = now;
    passes += r.outer_passes;
    most = std::max(most, r.outer_passes);
    bad += !r.converged;
    deepest = std::max(deepest, r.penetration);
  }
  const CharacterReport& r = fall.world.character(0).report();
  printf("h 1/%.0f %s: passes %.2f max %d unconverged %d rise %.3g J ke %.3g pen %.2g contacts %d z %.3f\n",
         1 / h, sizeof(T) == 4 ? "float" : "double", passes / steps, most, bad, worst, r.kinetic_energy,
         deepest, r.contacts, double(fall.world.character(0).model()[0].translation.z()));
}

TEST(World, PrintsFalls) {
  for (double h : {1 / 240.0, 1 / 60.0, 1 / 30.0, 1 / 15.0}) {
    print_fall<double>(h, Scheme::kBdf1);
    print_fall<double>(h, Scheme::kBdf2);
    print_fall<float>(h, Scheme::kBdf2);
  }
}

}  // namespace
}  // namespace sinew
