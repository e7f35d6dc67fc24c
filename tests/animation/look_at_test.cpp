// Who looks at what, how far and how fast.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>
#include <type_traits>
#include <utility>

#include "sinew/animation/look_at_job.h"
#include "sinew/skeleton/rotation.h"

namespace sinew {
namespace {

using Vec = Vec3<double>;
using Moving = MovingVector<double>;
using Pose = std::vector<JointJet<double>>;

static_assert(std::is_trivially_copyable_v<LookState<float>> &&
              std::is_trivially_copyable_v<LookState<double>>);

constexpr double kPi = 3.14159265358979323846, kDegree = kPi / 180;

Skeleton upper_body() {
  Skeleton s;
  const auto add = [&](Role role, const Vec& at) {
    Joint joint;
    joint.role = role;
    joint.parent = int(s.joints.size()) - 1;
    joint.rest.translation = at;
    s.joints.push_back(joint);
  };
  add(Role::kPelvis, {0, 0, 1});
  add(Role::kSpine, {0, 0, 0.1});
  add(Role::kChest, {0, 0, 0.2});
  add(Role::kNeck, {0, 0, 0.2});
  add(Role::kHead, {0.02, 0, 0.1});
  return s;
}

/// A body at rest whose head is 1.6 m high and looks along x.
class LookAt : public testing::Test {
 protected:
  LookAt() {
    EXPECT_TRUE(find_look_chain(skeleton, chain).ok());
    for (const Joint& joint : skeleton.joints) parents.push_back(joint.parent);
    job.parents = parents;
    job.chain = &chain;
    job.state = &state;
  }
  /// Looks at a point that moves; the direction that the head has then, with its rates.
  Moving look(const Moving& target, double step = 0) {
    jets.assign(parents.size(), {});
    for (std::size_t i = 0; i < jets.size(); ++i) jets[i].translation = skeleton.joints[i].rest.translation;
    job.jets = jets;
    job.target = target;
    job.step = step;
    status = job.Run();
    return model_motion<double>(jets, parents, kHead).rotation * still<double>(chain.axis);
  }
  Moving look(const Vec& target, double step = 0) { return look(still<double>(target), step); }
  /// rad, between where the head looks and the target.
  double missed(const Vec& target, const Moving& direction) const {
    const Vec from = value_of<double>(model_motion<double>(jets, parents, kHead).translation);
    return rotation_between<double>(value_of<double>(direction), target - from)
        .angularDistance(Quat<double>::Identity());
  }
  static double yaw(const Moving& v) { return std::atan2(v.y().value, v.x().value); }

  static constexpr int kHead = 4;
  Skeleton skeleton = upper_body();
  std::vector<int> parents;
  LookChain<double> chain;
  LookState<double> state;
  LookAtJob<double> job;
  Pose jets;
  Status status;
};

TEST_F(LookAt, ChainIsFoundByRoles) {
  EXPECT_EQ(chain.count, 4);
  EXPECT_EQ(chain.base, 0);
  EXPECT_EQ(chain.joints[3], kHead);
  EXPECT_NEAR(chain.shares[0] + chain.shares[1] + chain.shares[2] + chain.shares[3], 1, 1e-12);
  skeleton.joints[1].role = Role::kNone;
  ASSERT_TRUE(find_look_chain(skeleton, chain).ok());
  EXPECT_EQ(chain.count, 3);
  EXPECT_EQ(chain.base, 1);
  EXPECT_NEAR(chain.shares[0], 0.2 / 0.9, 1e-12);
  skeleton.joints[kHead].role = Role::kNone;
  EXPECT_FALSE(find_look_chain(skeleton, chain).ok());
}

TEST_F(LookAt, SharesAddUpToAnExactAim) {
  for (const Vec& target : {Vec(1, 0.5, 1.6), Vec(0.5, -0.6, 1.2), Vec(3, 2, 2.5), Vec(0.4, 0, 1.7)}) {
    const Moving direction = look(target);
    ASSERT_TRUE(status.ok());
    EXPECT_LT(missed(target, direction), 0.05 * kDegree) << target.transpose();
    state = {};
  }
  const Moving direction = look(Vec(1, 1, 1.6));
  double before = 0;
  for (int k = 0; k < chain.count; ++k) {  // each turns further than the one below it
    const Moving x =
        model_motion<double>(jets, parents, chain.joints[k]).rotation * still<double>(Vec::UnitX());
    EXPECT_GT(yaw(x), before + 2 * kDegree) << k;
    before = yaw(x);
  }
  EXPECT_NEAR(before, yaw(direction), 1e-12);
}

TEST_F(LookAt, WeightGoesBackToTheAnimation) {
  job.weight = TimeJet<double>(0.0);
  EXPECT_NEAR(yaw(look(Vec(1, 1, 1.6))), 0, 1e-12);
  job.weight = TimeJet<double>(0.5);
  EXPECT_NEAR(yaw(look(Vec(1, 1, 1.6))), 22.5 * kDegree,
              1.5 * kDegree);  // linear in R⁴ is not linear in angle
}

TEST_F(LookAt, LimitsAreSoftInYawAndInPitch) {
  const LookSettings<double>& s = job.settings;
  double before = 0;
  for (double a = 0; a < 170 * kDegree; a += kDegree) {
    state = {};
    const double now = yaw(look(Vec(10 * std::cos(a), 10 * std::sin(a), 1.6)));
    EXPECT_LE(now, s.yaw + 1e-9);
    EXPECT_GE(now, before - 1e-6) << "never back";
    EXPECT_LE(now - before, 1.1 * kDegree);
    before = now;
  }
  EXPECT_NEAR(before, s.yaw, 1e-9);
  const Vec up = value_of<double>(look(Vec(1, 0, 30)));
  EXPECT_NEAR(std::asin(up.z()), s.pitch_up, 1e-9);
  const Vec down = value_of<double>(look(Vec(0.3, 0, -30)));
  EXPECT_NEAR(std::asin(down.z()), -s.pitch_down, 1e-9);
}

/// Largest rate of the direction and largest change of its acceleration from frame to frame beside what the
/// acceleration's own rate explains.
struct Flight {
  double fastest = 0, jump = 0;
  int sides = 0;
};
Flight fly(LookAtJob<double>& job, const std::function<Moving(double)>& look_at, double frame) {
  Flight flight;
  int side = job.state->side;
  for (double t = -8; t < 8; t += frame) {
    const Moving direction = look_at(t);
    flight.fastest = std::max(flight.fastest, rate_of<double>(direction).norm());
    flight.sides += std::exchange(side, job.state->side) != side;
    // Once more with what the frame has decided.
    const Moving again = look_at(t);
    flight.jump = std::max({flight.jump, (value_of<double>(again) - value_of<double>(direction)).norm(),
                            (rate_of<double>(again) - rate_of<double>(direction)).norm(),
                            (acceleration_of<double>(again) - acceleration_of<double>(direction)).norm()});
  }
  return flight;
}

TEST_F(LookAt, FlyingPastBehindTurnsTheHeadOnceAndNotTooFast) {
  for (const double speed : {1.0, 20.0}) {
    state = {};
    double last = -8;
    const auto look_at = [&](double t) {
      const double step = t - std::exchange(last, t);
      return look(Moving(TimeJet<double>(-1.0), {-speed * t, -speed, 0}, TimeJet<double>(1.6)),
                  std::max(0.0, step));
    };
    const Flight flight = fly(job, look_at, 1 / 60.0);
    EXPECT_TRUE(status.ok());
    EXPECT_LT(flight.fastest, job.settings.fastest) << speed;
    EXPECT_GT(flight.fastest, 0.5 * job.settings.fastest) << "it does turn";
    EXPECT_LT(flight.jump, 1e-6) << speed;
    EXPECT_LE(flight.sides, 2) << "the first frame may choose";
    EXPECT_EQ(state.side, -1);
  }
}

TEST_F(LookAt, TargetThatTremblesBehindChangesNothing) {
  look(Vec(-1, 0.5, 1.6));
  const double before = yaw(look(Vec(-1, 0.1, 1.6)));
  for (int i = 0; i < 20; ++i) {
    EXPECT_NEAR(yaw(look(Vec(-1, i % 2 ? 0.2 : -0.2, 1.6), 1 / 60.0)), before, 1e-9);
    EXPECT_EQ(state.side, 1);
  }
  look(Vec(-1, -0.5, 1.6));  // 27 degrees past the middle
  EXPECT_EQ(state.side, -1);
}

TEST_F(LookAt, WithALagNothingIsFasterThanSaidWhateverTheTargetDoes) {
  job.settings.half_life = 0.2;
  for (const double speed : {1.0, 20.0}) {
    state = {};
    double last = -8;
    const auto look_at = [&](double t) {
      const double step = t - std::exchange(last, t);
      return look(Moving(TimeJet<double>(0.5), {-speed * t, -speed, 0}, TimeJet<double>(1.6)),
                  std::max(0.0, step));
    };
    const Flight flight = fly(job, look_at, 1 / 60.0);
    EXPECT_LT(flight.fastest, job.settings.limit_of()) << speed;
    EXPECT_LT(flight.jump, 1e-6);
  }
  const Vec target(1, 0.5, 1.6);
  Moving direction;
  for (int i = 0; i < 200; ++i) direction = look(target, 1 / 60.0);
  EXPECT_LT(missed(target, direction), 0.05 * kDegree) << "is there in the end";
}

TEST_F(LookAt, OverheadIsNoSingularPoint) {
  double fastest = 0;
  for (double x = -1; x < 1; x += 0.003) {
    const Moving direction = look(Moving({x, 1, 0}, {0.001, 0, 0}, TimeJet<double>(2.6)), 0.003);
    ASSERT_TRUE(status.ok());
    ASSERT_TRUE(value_of<double>(direction).allFinite() && acceleration_of<double>(direction).allFinite());
    fastest = std::max(fastest, rate_of<double>(direction).norm());
  }
  EXPECT_LT(fastest, 15) << "rad/s, of a target that passes a metre above at 1 m/s";
}

TEST_F(LookAt, StaysFiniteAndWithinItsLimitsWhateverIsLookedAt) {
  constexpr unsigned kSeed = 20261126;
  std::mt19937 random(kSeed);
  std::normal_distribution<double> normal;
  const LookSettings<double>& s = job.settings;
  Moving target = still<double>({1, 0, 1.6}), before = target;
  for (int frame = 0; frame < 20000; ++frame) {
    job.before = nullptr;
    if (frame % 11 == 0) {
      before = target;
      job.before = &before;
    }
    for (int k = 0; k < 3; ++k) target[k] = {2 * normal(random), 5 * normal(random), 20 * normal(random)};
    const Moving direction = look(target, std::abs(normal(random)) / 30);
    if (status.code == Code::kOutOfRange) continue;  // at the head
    ASSERT_TRUE(status.ok()) << status.reason << ", frame " << frame << ", seed " << kSeed;
    for (const JointJet<double>& j : jets)
      ASSERT_TRUE(j.rotation.coeffs().allFinite() && j.alpha.allFinite()) << frame;
    // What is left of a look at another target may lie beyond: at most 0.2 of its rate's way, see
    // QuinticOffset.
    if (state.elapsed >= state.duration) {
      ASSERT_LE(std::abs(yaw(direction)), s.yaw + 1e-9) << frame;
      ASSERT_LE(value_of<double>(direction).z(), std::sin(s.pitch_up) + 1e-9) << frame;
    }
  }
}

TEST_F(LookAt, RefusesWhatCannotBeMeant) {
  const Vec ahead(1, 0, 1.6);
  look(ahead);
  EXPECT_TRUE(status.ok());
  look(Vec(0.02, 0, 1.6));
  EXPECT_EQ(status.code, Code::kOutOfRange) << "at the head itself";
  for (const JointJet<double>& jet : jets) EXPECT_TRUE(jet.rotation.coeffs().allFinite());
  look(Vec(NAN, 0, 0));
  EXPECT_EQ(status.code, Code::kNotFinite);
  const LookChain<double> good = chain;
  const auto code_of = [&](auto change) {
    change();
    look(ahead);
    chain = good;
    job.settings = {};
    return status.code;
  };
  EXPECT_EQ(code_of([&] { chain.count = 0; }), Code::kInvalidArgument);
  EXPECT_EQ(code_of([&] { chain.joints[1] = 9; }), Code::kInvalidArgument);
  EXPECT_EQ(code_of([&] { std::swap(chain.joints[1], chain.joints[2]); }), Code::kInvalidArgument);
  EXPECT_EQ(code_of([&] { chain.base = kHead; }), Code::kInvalidArgument);
  EXPECT_EQ(code_of([&] { chain.shares[0] = 0.5; }), Code::kOutOfRange);
  EXPECT_EQ(code_of([&] { chain.up = Vec::UnitX(); }), Code::kInvalidArgument);
  EXPECT_EQ(code_of([&] { job.settings.yaw = 4; }), Code::kOutOfRange);
  EXPECT_EQ(code_of([&] { job.settings.pitch_up = 1.4; }), Code::kOutOfRange);
  EXPECT_EQ(code_of([] {}), Code::kOk);
}

}  // namespace
}  // namespace sinew
