// Rigs of one build and different size do the same in times that go with the square roots of their lengths
// (residual/scale.h).
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
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
    other.reset();
    jets = still;
  }
  EXPECT_TRUE(figure.set_target(jets).ok());
  figure.reset();
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
  for (std::size_t scene = 0; scene < std::size(kScenes); ++scene) {
    const Course human = run<T>(kScenes[scene], 1, kStep, 90),
                 other = run<T>(kScenes[scene], s, kStep * std::sqrt(s), 90);
    EXPECT_EQ(apart(human, other), 0) << kNames[scene] << ", " << s << " times as large";
    EXPECT_EQ(human.passes, other.passes) << kNames[scene] << ", " << s << " times as large";
  }
}
TEST(Size, ChangesNoBitOfWhatHappensInProportionateTime) {
  for (const double s : {1 / 16.0, 1 / 4.0, 4.0, 16.0}) {
    expect_same_bits<double>(s);
    expect_same_bits<float>(s);
  }
}

template <class T>
void expect_alike(double s, double most) {
  for (std::size_t scene = 0; scene < std::size(kScenes); ++scene) {
    const Course human = run<T>(kScenes[scene], 1, kStep, 60),
                 other = run<T>(kScenes[scene], s, kStep * std::sqrt(s), 60);
    if (std::getenv("SIZES"))
      std::printf("%s %s x %g: %g m\n", sizeof(T) == 4 ? "float" : "double", kNames[scene], s,
                  apart(human, other));
    EXPECT_LT(apart(human, other), most) << kNames[scene] << ", " << s << " times as large";
  }
}
TEST(Size, ChangesNothingButRoundingInProportionateTime) {
  for (const double s : {1 / 15.0, 1 / 5.0, 3.0, 10.0}) {
    expect_alike<double>(s, 1e-4);
    expect_alike<float>(s, 1e-2);
  }
}

TEST(Size, KeepsLimitsAtTheUsualStep) {
  for (const double s : {1 / 15.0, 1 / 5.0, 1.0, 3.0, 10.0})
    for (const Scene scene : kScenes) {
      const int steps = static_cast<int>(std::lround(90 * std::sqrt(s)));
      const Course r = run<float>(scene, s, kStep, steps);
      const Course human = run<float>(scene, 1, kStep, 90);
      if (std::getenv("SIZES"))
        std::printf("x %g %s: %.2f deg, %.2f passes per step (human %.2f), %d unconverged\n", s,
                    kNames[int(scene)], r.beyond * 57.3, double(r.passes) / steps, human.passes / 90.0,
                    r.unconverged);
      EXPECT_LT(r.beyond, 5 / 57.3) << kNames[static_cast<int>(scene)] << ", " << s << " times as large";
    }
}

}  // namespace
}  // namespace sinew
