// Rigs of one build and different size do the same in times that go with the square roots of their lengths
// (residual/scale.h).
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <numbers>
#include <string>
#include <vector>

#include "character/scenes.h"
#include "sinew/residual/scale.h"

namespace sinew {
namespace {

constexpr double kStep = 1 / 60.0;

/// A humanoid s times as long and s³ times as heavy, as strong for its weight; knees, elbows, hips and
/// shoulders bend as far as people's.
Skeleton sized(double s) {
  Skeleton body = fixtures::humanoid();
  const double mass = s * s * s, torque = mass * s;
  for (Joint& joint : body.joints) {
    joint.rest.translation *= s;
    joint.center_of_mass *= s;
    joint.mass *= mass;
    joint.inertia *= mass * s * s;
    for (DofLimits& dof : joint.dofs) {
      dof.torque_minus *= torque;
      dof.torque_plus *= torque;
      dof.dry_friction *= torque;
    }
    if (joint.type == JointType::kRevolute) {
      const bool knee = joint.name.find("shin") != std::string::npos;
      joint.dofs[0].lower = knee ? -0.05 : -2.4;
      joint.dofs[0].upper = knee ? 2.4 : 0.05;
    } else if (joint.type == JointType::kBall) {
      joint.swing_limit = 0.8;
      joint.twist_lower = -0.5;
      joint.twist_upper = 0.5;
    }
  }
  for (Collider& c : body.colliders) {
    c.local.translation *= s;
    c.size *= s;
  }
  return body;
}

/// What happens to the figure.
enum class Scene {
  kFall,     ///< limp, from where it stands
  kSlide,    ///< limp, thrown along the floor
  kPushed,   ///< stands by its muscles, pushed at the chest
  kHit,      ///< played, hit at an arm
  kCollide,  ///< two limp ones
};
constexpr Scene kScenes[] = {Scene::kFall, Scene::kSlide, Scene::kPushed, Scene::kHit, Scene::kCollide};
constexpr const char* kNames[] = {"fall", "slide", "pushed", "hit", "collide"};

struct Course {
  std::vector<Vec3<double>> places;  ///< m of a human: of all joints after each step
  double beyond = 0;                 ///< rad, most that a joint was past a limit
  int passes = 0;                    ///< outer, of all steps
  int unconverged = 0;               ///< steps
};

/// rad, that a joint is past its limits.
double past_limit(const Joint& joint, const Quat<double>& local) {
  const Quat<double> turned = joint.rest.rotation.conjugate() * local;
  if (joint.type == JointType::kRevolute) {
    const double angle = joint.axis.dot(rotation_log<double>(turned));
    return std::max(angle - joint.dofs[0].upper, joint.dofs[0].lower - angle);
  }
  if (joint.swing_limit < 0) return 0;
  const Vec3<double>& a = joint.swing_axis;
  const double twist = twist_angle<double>(turned, a);
  return std::max({std::acos(std::clamp(a.dot(turned * a), -1.0, 1.0)) - joint.swing_limit,
                   twist - joint.twist_upper, joint.twist_lower - twist});
}

/// `steps` steps of h seconds.
template <class T>
Course run(Scene scene, double s, double h, int steps) {
  const Skeleton body = sized(s);
  const double speed = std::sqrt(s);
  CharacterSettings settings;
  const bool limp = scene != Scene::kPushed && scene != Scene::kHit;
  settings.self_collision = limp;
  if (scene != Scene::kHit) settings.root = RootDrive::kFree;
  if (limp) settings.strength = 0;
  World<T> world({});
  Status status;
  EXPECT_EQ(world.add_character(body, settings, status), 0) << status.reason;
  Character<T> figure = world.character(0);
  std::vector<JointJet<T>> jets = fixtures::idle<T>(body, 0);
  for (JointJet<T>& jet : jets) jet.omega.setZero(), jet.alpha.setZero();
  const std::vector<JointJet<T>> still = jets;
  if (scene == Scene::kFall) jets[0].omega = Vec3<T>(T(0.5 / speed), T(0.75 / speed), T(0));
  if (scene == Scene::kSlide) {
    jets[0].rotation = Quat<T>(Eigen::AngleAxis<T>(T(1.5), Vec3<T>::UnitY()));
    jets[0].translation.z() = T(0.25 * s);
    jets[0].velocity = Vec3<T>(T(3 * speed), T(0.5 * speed), T(0));
  }
  if (scene == Scene::kCollide) {
    EXPECT_EQ(world.add_character(body, settings, status), 1) << status.reason;
    Character<T> other = world.character(1);
    jets[0].translation.x() = T(0.5 * s);
    jets[0].velocity = Vec3<T>(T(-2 * speed), T(0), T(0));
    EXPECT_TRUE(other.set_target(jets).ok());
    (void)other.reset();
    jets = still;
  }
  EXPECT_TRUE(figure.set_target(jets).ok());
  (void)figure.reset();
  Course result;
  for (int n = 0; n < steps; ++n) {
    if (!limp) {
      EXPECT_TRUE(figure.set_target(still).ok());
    }
    if (n == 5 && !limp) {
      const int at = scene == Scene::kHit ? body.find("forearm_l") : 0;
      const double impulse = (scene == Scene::kHit ? 25 : 60) * s * s * s * speed;
      EXPECT_TRUE(figure.apply_impulse(at, figure.model()[at].translation, Vec3<T>(T(impulse), 0, 0)).ok());
    }
    EXPECT_TRUE(world.step(T(h)).ok());
    for (int i = 0; i < body.body_count; ++i) {
      result.places.push_back(figure.model()[i].translation.template cast<double>() / s);
      result.beyond = std::max(
          result.beyond, past_limit(body.joints[i], figure.local()[i].rotation.template cast<double>()));
    }
    result.passes += figure.report().outer_passes;
    result.unconverged += !figure.report().converged;
  }
  return result;
}

/// m of a human, that two motions are apart at most.
double apart(const Course& a, const Course& b) {
  double most = 0;
  for (std::size_t n = 0; n < a.places.size(); ++n) most = std::max(most, (a.places[n] - b.places[n]).norm());
  return most;
}

TEST(Size, OfTheHumanoidIsTheUnit) {
  const Scale<double> human = scale_of(fixtures::humanoid());
  EXPECT_EQ(human.length, 1);
  EXPECT_EQ(human.time, 1);
  EXPECT_EQ(human.energy, 1);
  EXPECT_EQ(human.load, 1);
  const Scale<double> giant = scale_of(sized(4));
  EXPECT_EQ(giant.length, 4);
  EXPECT_EQ(giant.time, 2);
  EXPECT_EQ(giant.energy, 256);
  EXPECT_EQ(giant.load, 256);
}

// Powers of four scale every number that is in proportion without rounding, roots included.
template <class T>
void expect_same_bits(double s) {
  for (std::size_t n = 0; n < std::size(kScenes); ++n) {
    const Course human = run<T>(kScenes[n], 1, kStep, 90);
    const Course other = run<T>(kScenes[n], s, kStep * std::sqrt(s), 90);
    EXPECT_EQ(apart(human, other), 0) << kNames[n] << ", " << s << " times as large";
    EXPECT_EQ(human.passes, other.passes) << kNames[n] << ", " << s << " times as large";
  }
}

TEST(Size, ChangesNoBitOfWhatHappensInProportionateTime) {
  for (const double s : {1 / 16.0, 4.0}) {
    expect_same_bits<double>(s);
    expect_same_bits<float>(s);
  }
}

/// m of a human: how far float's motion of a human is from double's `fine`, at most; of such, too, as are a
/// few per cent larger or smaller, for one alone may round well.
double rounding(Scene scene, const Course& fine, int steps) {
  double most = 0;
  for (const double s : {0.97, 0.99, 1.0, 1.01, 1.03})
    most = std::max(most, apart(fine, run<float>(scene, s, kStep * std::sqrt(s), steps)));
  return most;
}

// Other factors round; what rounding does to a motion is how far float's is from double's.
TEST(Size, ChangesNothingButRoundingInProportionateTime) {
  constexpr int kSteps = 60;
  for (const Scene scene : kScenes) {
    const char* name = kNames[static_cast<std::size_t>(scene)];
    const Course fine = run<double>(scene, 1, kStep, kSteps);
    const double rounds = rounding(scene, fine, kSteps);
    for (const double s : {1 / 15.0, 1 / 5.0, 3.0, 10.0}) {
      const double h = kStep * std::sqrt(s);
      EXPECT_LT(apart(fine, run<double>(scene, s, h, kSteps)), 1e-4) << name << ", x " << s;
      EXPECT_LT(apart(fine, run<float>(scene, s, h, kSteps)), 4 * rounds) << name << ", x " << s;
    }
  }
}

// At 60 Hz a small figure makes larger steps by its own time: a fifteenth does what the humanoid does at
// 15.5 Hz.
TEST(Size, KeepsLimitsAtTheUsualStep) {
  double furthest = 0;  // degrees
  for (const double s : {1 / 15.0, 1 / 5.0, 1.0, 3.0, 10.0})
    for (std::size_t n = 0; n < std::size(kScenes); ++n) {
      const int steps = static_cast<int>(std::lround(90 * std::sqrt(s)));
      const Course course = run<float>(kScenes[n], s, kStep, steps),
                   human = run<float>(kScenes[n], 1, kStep, 90);
      furthest = std::max(furthest, course.beyond * 180 / std::numbers::pi);
      EXPECT_EQ(course.unconverged, 0) << kNames[n] << ", x " << s;
      // Larger ones make smaller steps by their own time.
      if (s > 1) {
        EXPECT_LE(course.passes * 90, 2 * human.passes * steps + 90) << kNames[n] << ", x " << s;
      }
    }
  EXPECT_LT(furthest, 5);
}

// What needs no unit of its own has the humanoid's, and one in between where its size is absurd.
TEST(Size, OfAThingIsTheHumansUnlessItIsAbsurd) {
  const auto ball = [](double radius) {
    Skeleton s;
    Joint& joint = s.joints.emplace_back();
    joint.type = JointType::kFree;
    joint.mass = 1;
    joint.inertia = Mat3<double>::Identity() * 0.4 * radius * radius;
    s.body_count = 1;
    return scale_of(s);
  };
  for (const double radius : {0.05, 0.3, 2.0}) EXPECT_EQ(ball(radius).length, 1) << radius << " m";
  EXPECT_LT(ball(0.01).length, 0.5);
  EXPECT_GT(ball(0.01).length, 0.05);
  EXPECT_GT(ball(20).length, 4);
}

}  // namespace
}  // namespace sinew
