// Small scenes for tests of the world: a playing character and a limp one.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "fixtures/humanoid.h"
#include "sinew/character/world.h"
#include "sinew/skeleton/rotation.h"

namespace sinew::fixtures {

/// An idle that moves arms, spine and knees gently; t in seconds. Rotations are about fixed axes, so
/// velocities and accelerations are exact.
template <class T>
std::vector<JointJet<T>> idle(const Skeleton& s, double t) {
  std::vector<JointJet<T>> jets(s.joints.size());
  for (std::size_t i = 0; i < jets.size(); ++i) {
    jets[i].rotation = s.joints[i].rest.rotation.cast<T>();
    jets[i].translation = s.joints[i].rest.translation.cast<T>();
    if (s.joints[i].name.find("arm") == std::string::npos) continue;
    const double rate = 2, amplitude = 0.2;
    const Vec3<double> axis = Vec3<double>::UnitY();
    jets[i].rotation =
        (s.joints[i].rest.rotation * rotation_exp<double>(axis * amplitude * std::sin(rate * t))).cast<T>();
    jets[i].omega = (axis * amplitude * rate * std::cos(rate * t)).cast<T>();
    jets[i].alpha = (axis * -amplitude * rate * rate * std::sin(rate * t)).cast<T>();
  }
  return jets;
}

/// A character on its clip in a world with a floor.
template <class T>
struct Playing {
  Skeleton skeleton = humanoid();
  World<T> world;
  T time = 0;

  explicit Playing(const WorldSettings& settings = {}) : world(settings) {
    Status status;
    EXPECT_EQ(world.add_character(skeleton, {}, status), 0) << status.reason;
    EXPECT_TRUE(character().set_target(idle<T>(skeleton, 0)).ok());
    (void)character().reset();
  }
  Character<T> character() { return world.character(0); }
  void step(T h = T(1) / 60) {
    time += h;
    ASSERT_TRUE(character().set_target(idle<T>(skeleton, double(time))).ok());
    ASSERT_TRUE(world.step(h).ok());
  }
  bool pose_is_the_targets_bits() {
    const std::vector<JointJet<T>> wanted = idle<T>(skeleton, double(time));
    bool same = true;
    for (std::size_t i = 0; i < wanted.size(); ++i) {
      const Transform<T>& local = character().local()[i];
      same = same && local.rotation.coeffs() == wanted[i].rotation.coeffs() &&
             local.translation == wanted[i].translation;
    }
    return same;
  }
};

/// A limp humanoid without dry friction, thrown with random joint speeds of the given rms (rad/s).
template <class T>
struct Limp {
  World<T> world;

  Limp(const WorldSettings& settings, double height, double speed, unsigned seed) : world(settings) {
    Skeleton body = humanoid();
    for (Joint& joint : body.joints)
      for (DofLimits& dof : joint.dofs) dof.dry_friction = 0;
    CharacterSettings limp;
    limp.root = RootDrive::kFree;
    limp.strength = 0;
    Status status;
    EXPECT_EQ(world.add_character(body, limp, status), 0) << status.reason;
    std::vector<JointJet<T>> jets(body.joints.size());
    std::mt19937 random(seed);
    std::normal_distribution<double> normal(0, speed);
    for (std::size_t i = 0; i < jets.size(); ++i) {
      jets[i].translation = body.joints[i].rest.translation.template cast<T>();
      const Vec3<double> spin(normal(random), normal(random), normal(random));
      const bool hinge = body.joints[i].type == JointType::kRevolute;
      jets[i].omega = (hinge ? Vec3<double>(body.joints[i].axis * spin.dot(body.joints[i].axis)) : spin)
                          .template cast<T>();
    }
    jets[0].translation.z() += T(height);
    EXPECT_TRUE(world.character(0).set_target(jets).ok());
    (void)world.character(0).reset();
  }
  double energy() {
    const CharacterReport& r = world.character(0).report();
    return r.kinetic_energy + r.potential_energy + r.elastic_energy;
  }
};

}  // namespace sinew::fixtures
