// What every node keeps: its jets are the derivatives of its poses, nothing jumps at its changes, whatever
// the frame rate, on every instruction set, without a heap.
#include "animation/motion_nodes.h"

#include <gtest/gtest.h>

#include <random>

#include "animation/node_bits.h"
#include "fixtures/counting_new.h"
#include "sinew/animation/instruction_set.h"

namespace sinew {
namespace {

using fixtures::motion_nodes;
using fixtures::NodeCase;
using fixtures::run_node;

constexpr unsigned kSeed = 20261125;
constexpr double kEnd = 3.9;  ///< s

template <class T>
NodeCase<T> node_number(int i) {
  return std::move(motion_nodes<T>()[i]);
}
std::vector<std::string> names() {
  std::vector<std::string> all;
  for (const auto& c : motion_nodes<double>()) all.push_back(c.name);
  return all;
}

class MotionNodes : public testing::TestWithParam<int> {
 protected:
  NodeCase<double> exact = node_number<double>(GetParam());
  NodeCase<float> single = node_number<float>(GetParam());
  using Pose = std::vector<JointJet<double>>;

  Pose at(double t, std::span<const double> steps = {}) {
    Pose out(exact.node->joints);
    run_node<double>(exact, steps, t, out);
    return out;
  }
  std::vector<JointJet<float>> single_at(double t, std::span<const double> steps = {}) {
    std::vector<JointJet<float>> out(single.node->joints);
    run_node<float>(single, steps, t, out);
    return out;
  }
  bool near_a_switch(double t, double h) const {
    return std::any_of(exact.switches.begin(), exact.switches.end(),
                       [&](double s) { return std::abs(s - t) <= h; });
  }
};

/// First derivatives by five points, central or on one side: errors h⁴/30 and h⁴/5 times the fifth
/// derivative, here below 1e6.
struct Stencil {
  std::array<int, 5> at;  ///< steps from the instant
  std::array<double, 5> weight;
};
constexpr Stencil kStencils[] = {{{-2, -1, 0, 1, 2}, {1 / 12.0, -8 / 12.0, 0, 8 / 12.0, -1 / 12.0}},
                                 {{0, 1, 2, 3, 4}, {-25 / 12.0, 4, -3, 4 / 3.0, -1 / 4.0}},
                                 {{0, -1, -2, -3, -4}, {25 / 12.0, -4, 3, -4 / 3.0, 1 / 4.0}}};

/// Largest difference between what the poses do and what the jets of the instant say, in parts of what is
/// allowed: the figures that the animation side promises in double precision.
double mismatch(const std::array<std::vector<JointJet<double>>, 5>& poses, const JointJet<double>* now,
                const Stencil& stencil, double h) {
  double worst = 0;
  for (std::size_t j = 0; j < poses[0].size(); ++j) {
    Vec3<double> turn = Vec3<double>::Zero(), spin = turn, move = turn, push = turn;
    for (int k = 0; k < 5; ++k) {
      const JointJet<double>& jet = poses[k][j];
      turn += stencil.weight[k] / h * rotation_log<double>(now[j].rotation.conjugate() * jet.rotation);
      spin += stencil.weight[k] / h * jet.omega;
      move += stencil.weight[k] / h * jet.translation;
      push += stencil.weight[k] / h * jet.velocity;
    }
    const auto compare = [&](const Vec3<double>& found, const Vec3<double>& said, double allowed) {
      worst = std::max(worst, (found - said).norm() / (allowed * (1 + said.norm())));
    };
    compare(turn, now[j].omega, 1e-6);
    compare(spin, now[j].alpha, 1e-4);
    compare(move, now[j].velocity, 1e-6);
    compare(push, now[j].acceleration, 1e-4);
  }
  return worst;
}

TEST_P(MotionNodes, JetsAreTheDerivativesOfThePoses) {
  std::mt19937 random(kSeed);
  std::uniform_real_distribution<double> any_time(0.01, kEnd);
  constexpr double h = 1e-4;  // s
  for (int n = 0; n < 1000; ++n) {
    const double t = any_time(random);
    if (near_a_switch(t, 5 * h)) continue;
    const Pose now = at(t);
    double worst = 1e9;
    // Third derivatives may jump, as at the knots of a cubic: then one side of the instant is smooth.
    for (const Stencil& stencil : kStencils) {
      std::array<Pose, 5> poses;
      for (int k = 0; k < 5; ++k) poses[k] = at(t + stencil.at[k] * h);
      worst = std::min(worst, mismatch(poses, now.data(), stencil, h));
      if (worst < 1) break;
    }
    ASSERT_LT(worst, 1) << "at " << t << ", seed " << kSeed;
  }
}

TEST_P(MotionNodes, SinglePrecisionFollowsDouble) {
  std::mt19937 random(kSeed);
  std::uniform_real_distribution<double> any_time(0.01, kEnd);
  for (int n = 0; n < 1000; ++n) {
    const double t = any_time(random);
    const Pose wanted = at(t);
    const auto got = single_at(t);
    for (std::size_t j = 0; j < wanted.size(); ++j) {
      const JointJet<double>& w = wanted[j];
      ASSERT_LT((got[j].omega.cast<double>() - w.omega).norm(), 1e-3 * (1 + w.omega.norm())) << j << " " << t;
      ASSERT_LT((got[j].alpha.cast<double>() - w.alpha).norm(), 1e-2 * (1 + w.alpha.norm())) << j << " " << t;
      ASSERT_LT((got[j].acceleration.cast<double>() - w.acceleration).norm(),
                1e-2 * (1 + w.acceleration.norm()));
    }
  }
}

/// Largest jump of poses, velocities, accelerations at a switch.
std::array<double, 3> jumps(const std::vector<JointJet<double>> (&at)[4]) {
  std::array<double, 3> largest = {};
  for (std::size_t j = 0; j < at[0].size(); ++j) {
    const auto jump = [&](auto number) {
      // Straight lines through two instants on either side: what is left of a smooth curve is 2e-14·its bend.
      return Vec3<double>((2 * number(at[2][j]) - number(at[3][j])) -
                          (2 * number(at[1][j]) - number(at[0][j])))
          .norm();
    };
    const Quat<double> before = at[1][j].rotation;
    const auto turn = [&](const JointJet<double>& x) {
      return rotation_log<double>(before.conjugate() * x.rotation);
    };
    const auto grow = [&](int derivative, double a, double b) {
      largest[derivative] = std::max({largest[derivative], a, b});
    };
    using Jet = JointJet<double>;
    grow(0, jump(turn), jump([](const Jet& x) { return x.translation; }));
    grow(1, jump([](const Jet& x) { return x.omega; }), jump([](const Jet& x) { return x.velocity; }));
    grow(2, jump([](const Jet& x) { return x.alpha; }), jump([](const Jet& x) { return x.acceleration; }));
  }
  return largest;
}

TEST_P(MotionNodes, NothingJumpsThatIsNotDeclaredTo) {
  constexpr double e = 1e-7;  // s
  std::array<double, 3> largest = {};
  for (const double t : exact.switches) {
    const std::vector<JointJet<double>> around[4] = {at(t - 2 * e), at(t - e), at(t + e), at(t + 2 * e)};
    const std::array<double, 3> here = jumps(around);
    for (int d = 0; d < 3; ++d) largest[d] = std::max(largest[d], here[d]);
  }
  for (int d = 0; d <= exact.continuity; ++d) EXPECT_LT(largest[d], 1e-6) << "derivative " << d;
  // What declares less must need to: a promise that is too weak would hide a cure.
  for (int d = exact.continuity + 1; d <= 2; ++d) EXPECT_GT(largest[d], 1e-2) << "derivative " << d;
}

TEST_P(MotionNodes, FrameRateChangesNothing) {
  std::mt19937 random(kSeed);
  for (const double longest : {0.001, 0.02, 0.25}) {
    std::vector<double> steps;
    std::uniform_real_distribution<double> any_step(0.001, longest + 1e-9);
    for (double t = 0; t < kEnd; t += steps.back()) {
      steps.push_back(any_step(random));
      if (steps.size() % 7 == 0) steps.push_back(0);
      if (steps.back() == 0) steps.push_back(0.001);
    }
    for (const double t : {0.55, 0.93, 2.3, kEnd}) {
      const auto once = single_at(t), often = single_at(t, steps);
      for (std::size_t j = 0; j < once.size(); ++j) {
        EXPECT_LT((once[j].translation - often[j].translation).norm(), 1e-5) << j << " at " << t;
        const Quat<float> apart = once[j].rotation.conjugate() * often[j].rotation;
        EXPECT_LT(2 * apart.vec().norm(), 1e-5) << j << " at " << t;
      }
    }
  }
}

TEST_P(MotionNodes, EveryInstructionSetGivesTheSameBits) {
  if (!available(InstructionSet::kAvx2)) GTEST_SKIP() << "this processor has nothing above the baseline";
  EXPECT_EQ(node_bits<float>(GetParam()), sinew_baseline::node_bits<float>(GetParam()));
  EXPECT_EQ(node_bits<double>(GetParam()), sinew_baseline::node_bits<double>(GetParam()));
}

TEST_P(MotionNodes, NothingIsTakenFromTheHeap) {
  std::vector<JointJet<float>> out(single.node->joints);
  run_node<float>(single, {}, kEnd, out);
  const long before = fixtures::allocations;
  for (double t = 0; t < kEnd; t += 0.1) run_node<float>(single, {}, t, out);
  EXPECT_EQ(fixtures::allocations, before);
}

INSTANTIATE_TEST_SUITE_P(All, MotionNodes, testing::Range(0, static_cast<int>(names().size())),
                         [](const auto& node) { return names()[node.param]; });

}  // namespace
}  // namespace sinew
