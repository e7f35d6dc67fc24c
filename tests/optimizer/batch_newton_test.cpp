// Newton's method on packs against one solve per character: the same bits.
#include "sinew/optimizer/batch_newton.h"

#include <gtest/gtest.h>

#include <cstring>
#include <memory>

#include "fixtures/standard_plan.h"
#include "residual/random_tree.h"

namespace sinew {
namespace {

using fixtures::Random;

/// Characters of one rig somewhere in a step, each with its own pose, motion, strength and unknowns.
struct Characters {
  Skeleton skeleton;
  Tree<double> fine;
  Tree<float> tree;
  StepSettings<float> settings;
  Accuracy accuracy;
  std::vector<std::unique_ptr<TreeProblem<float>>> problems;
  NewtonSolver<float> solver;

  /// Guess and target are around `spread` rad from where the step began. Every joint is an unknown with the
  /// probability `freed`.
  Characters(unsigned seed, int count, double spread, double freed, bool with_rows)
      : skeleton(dressed(seed, with_rows)), fine(skeleton), tree(skeleton) {
    Random random(seed + 100);
    settings.plan = &standard_plan<float>();
    settings.gravity = {0.3f, -0.2f, -9.81f};
    for (int n = 0; n < count; ++n) {
      TreeProblem<float>& p = *problems.emplace_back(std::make_unique<TreeProblem<float>>(tree, skeleton));
      p.common_origin = random.vector(1).cast<float>();
      const std::vector<Transform<double>> start = fixtures::random_pose(fine, random, 0.5);
      p.start = near(start, 0, random);
      p.target = near(start, spread, random);
      p.local = near(start, spread, random);
      for (int i = 0; i < tree.bodies; ++i) {
        const bool is_free = random.below(100) < 100 * freed || i == 0;
        for (int dof = tree.first_dof[i]; dof < tree.first_dof[i + 1]; ++dof) p.free[dof] = is_free;
      }
      for (int dof = 0; dof < tree.dofs; ++dof) {
        p.law.torque_minus[dof] *= float(n % 3);
        p.law.torque_plus[dof] *= float(n % 3);
      }
      Kinematics<float> k(tree);
      forward_kinematics<float>(tree, near(start, spread, random), p.common_origin, k);
      p.prediction.weight = (n % 2 ? 1.0f : 2.25f) / (settings.h * settings.h);
      for (int i = 0; i < tree.bodies; ++i) {
        p.prediction.center[i] = k.center[i];
        p.prediction.rotation[i] = k.rotation[i];
      }
    }
    solver.declare(*settings.plan);
    solver.reserve(problems[0]->room);
  }
  std::vector<Transform<float>> near(const std::vector<Transform<double>>& pose, double spread,
                                     Random& random) const {
    std::vector<double> d(tree.dofs);
    for (double& x : d) x = random.normal(spread);
    std::vector<Transform<float>> out;
    for (const Transform<double>& t : fixtures::displaced_pose(fine, pose, d.data()))
      out.push_back(t.cast<float>());
    return out;
  }
  static Skeleton dressed(unsigned seed, bool with_rows) {
    Skeleton s = fixtures::random_skeleton(seed);
    Random random(seed + 900);
    for (Joint& joint : s.joints) {
      for (DofLimits& dof : joint.dofs) {
        dof.dry_friction = with_rows ? 0.5 : 0;
        if (!with_rows) continue;
        dof.torque_minus = 4;
        dof.torque_plus = 9;
        dof.damping = 0.3;
        dof.lower = -0.1;
        dof.upper = 0.3;
      }
      if (!with_rows || joint.type != JointType::kBall || random.below(2)) continue;
      joint.swing_limit = 0.3;
      joint.swing_axis = random.unit();
      joint.twist_lower = -0.2;
      joint.twist_upper = 0.1;
    }
    return s;
  }
};

struct Case {
  InstructionSet set;
  unsigned seed;
};

class BatchNewtonTest : public testing::TestWithParam<Case> {
 protected:
  /// Solves them in batches and one by one. Answers how many a batch solved.
  int compare(double spread, double freed, bool with_rows, int count) {
    Characters batched(GetParam().seed, count, spread, freed, with_rows),
        alone(GetParam().seed, count, spread, freed, with_rows);
    BatchNewton batch(GetParam().set);
    batch.reserve(batched.problems[0]->room);
    int solved = 0;
    for (int first = 0; first < count; first += batch.lanes()) {
      const int lanes = std::min(batch.lanes(), count - first);
      std::vector<TreeProblem<float>*> problems;
      for (int n = first; n < first + lanes; ++n) problems.push_back(batched.problems[n].get());
      std::vector<SolveReport> reports(lanes);
      batch.solve(batched.settings, batched.accuracy, problems, reports);
      for (int lane = 0; lane < lanes; ++lane) {
        TreeProblem<float>* one[] = {alone.problems[first + lane].get()};
        const auto before = one[0]->local;
        const SolveReport report = alone.solver.solve(alone.settings, alone.accuracy, one, {});
        const auto& expected = reports[lane].converged ? one[0]->local : before;
        for (int i = 0; i < alone.tree.bodies; ++i) {
          const Transform<float>&a = problems[lane]->local[i], &b = expected[i];
          EXPECT_EQ(a.rotation.coeffs(), b.rotation.coeffs())
              << "character " << first + lane << " body " << i;
          EXPECT_EQ(a.translation, b.translation) << "character " << first + lane << " body " << i;
        }
        if (!reports[lane].converged) continue;
        ++solved;
        EXPECT_TRUE(report.converged);
        EXPECT_EQ(reports[lane].outer_passes, report.outer_passes);
        EXPECT_EQ(reports[lane].factorisations, report.factorisations);
        EXPECT_EQ(reports[lane].chords, report.chords);
        EXPECT_EQ(reports[lane].evaluations, report.evaluations);
        EXPECT_EQ(reports[lane].energy, report.energy);
      }
    }
    return solved;
  }
  void SetUp() override {
    if (!available(GetParam().set)) GTEST_SKIP() << "this processor lacks the instruction set";
  }
};

TEST_P(BatchNewtonTest, LanesHaveTheBitsOfTheirOwnSolve) {
  EXPECT_GE(compare(0.003, 1, false, 32), 12);
}

TEST_P(BatchNewtonTest, SoTheyHaveWithMusclesFrictionLimitsAndCones) {
  EXPECT_GE(compare(0.003, 1, true, 32), 12);
}

TEST_P(BatchNewtonTest, SoTheyHaveWithUnknownsOfTheirOwn) {
  EXPECT_GE(compare(0.003, 0.5, true, 32), 12);
}

TEST_P(BatchNewtonTest, WhoNeedsMoreThanWholeStepsIsHandedBackAsItWas) {
  EXPECT_LT(compare(0.8, 1, true, 32), 32);
}

TEST_P(BatchNewtonTest, LanesMayBeEmpty) {
  EXPECT_GE(compare(0.003, 1, true, 3), 1);
}

std::vector<Case> cases() {
  std::vector<Case> all;
  for (const InstructionSet set : {InstructionSet::kBaseline, InstructionSet::kAvx2, InstructionSet::kAvx512})
    for (const unsigned seed : {1u, 2u, 3u, 4u}) all.push_back({set, seed});
  return all;
}
std::string name_of(const testing::TestParamInfo<Case>& test) {
  constexpr const char* kNames[] = {"Baseline", "Avx2", "Avx512"};
  return kNames[int(test.param.set)] + std::to_string(test.param.seed);
}
INSTANTIATE_TEST_SUITE_P(Seeds, BatchNewtonTest, testing::ValuesIn(cases()), name_of);

}  // namespace
}  // namespace sinew
