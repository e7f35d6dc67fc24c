// Absence is free, and cost is a straight line: instructions counted by callgrind, symbols listed by nm.
#include <gtest/gtest.h>

#include <array>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <string>

#include "fixtures/paths.h"
#include "study/effects.h"

namespace sinew::study {
namespace {

const EffectOptions kFull{SINEW_EFFECT_COST, binary_dir()}, kBare{SINEW_EFFECT_COST_BARE, binary_dir()};

/// Empty where callgrind can count.
std::string why_not() {
  return std::system("valgrind --version >/dev/null 2>&1") == 0 ? "" : "valgrind is not installed";
}

std::string symbols(const std::string& program) {
  const std::unique_ptr<FILE, int (*)(FILE*)> pipe(popen(("nm -C '" + program + "'").c_str(), "r"), pclose);
  std::string text;
  std::array<char, 4096> part{};
  while (std::fgets(part.data(), part.size(), pipe.get())) text += part.data();
  return text;
}

TEST(EffectCost, SymbolsOfAnUndeclaredEffectAreAbsent) {
  const std::string full = symbols(kFull.program), bare = symbols(kBare.program);
  ASSERT_NE(bare.find("sinew::World<float>::step"), std::string::npos) << "nm listed nothing";
  for (const char* effect : {"sinew::Wind<",
                             "sinew::Buoyancy<",
                             "sinew::JointSpring<",
                             "sinew::ForceField<",
                             "sinew::Restitution<",
                             "sinew::ContinuousDetection<",
                             "sinew::make_strand",
                             "sinew::make_cloth",
                             "sinew::make_soft_tissue",
                             "sinew::make_loop",
                             "::add_loop",
                             "::add_particles",
                             "sinew::MuscleRows<float",
                             "::EllipsoidRows<",
                             "sinew::JointLimitRows<float",
                             "sinew::ConeRows<float",
                             "sinew::append_cone<float",
                             "sinew::JointDampingRows<float",
                             "sinew::Impulses<",
                             "::kPushes<",
                             "sinew::Support<",
                             "::kSupport<",
                             "sinew::share_support<",
                             "::ContactRows<",
                             "sinew::ContactFinder<",
                             "sinew::signed_distance<",
                             "sinew::append_contact_points<",
                             "::CouplingRows<",
                             "sinew::measure_elements<",
                             "sinew::tetrahedron_curvature<"}) {
    EXPECT_NE(full.find(effect), std::string::npos) << effect;
    EXPECT_EQ(bare.find(effect), std::string::npos) << effect;
  }
}

TEST(EffectCost, UndeclaredEffectCostsNoInstruction) {
  if (const std::string why = why_not(); !why.empty()) GTEST_SKIP() << why;
  for (const char* mode : {"checked none 0", "pass none 0", "solve none 0"}) {
    const double full = count_instructions(kFull, mode), bare = count_instructions(kBare, mode);
    ASSERT_GT(bare, 1000) << mode;
    EXPECT_NEAR(full, bare, 1e-4 * bare) << mode;
  }
}

TEST(EffectCost, DeclaredButEmptyCostsAtMostFiftyInstructions) {
  if (const std::string why = why_not(); !why.empty()) GTEST_SKIP() << why;
  for (const std::string mode : {"checked", "pass"}) {
    const double undeclared = count_instructions(kFull, mode + " none 0");
    ASSERT_GT(undeclared, 1000);
    for (const char* effect : {"wind", "buoyancy", "joint_spring"})  // a force field acts on every body
      EXPECT_LE(count_instructions(kFull, mode + " " + effect + " 0"), undeclared + 50)
          << mode << " " << effect;
    if (mode != "pass") continue;  // where joints are solved for
    for (const char* effect : {"muscles", "joint_limits", "joint_damping"})
      EXPECT_LE(count_instructions(kFull, mode + " " + effect + " 0"), undeclared + 50)
          << mode << " " << effect;
  }
}

class EffectCostIn : public testing::TestWithParam<const char*> {};

TEST_P(EffectCostIn, IsAStraightLineFromOneInstanceTo64OrSaysWhyNot) {
  if (const std::string why = why_not(); !why.empty()) GTEST_SKIP() << why;
  EffectOptions quick = kFull;
  quick.quick = true;
  quick.mode = GetParam();
  EffectStudy found;
  const convert::Error error = run_effects(quick, {}, found);
  ASSERT_FALSE(error) << error.message;
  ASSERT_GE(found.costs.size(), 4u);
  for (const EffectCost& cost : found.costs) {
    const std::string what = cost.effect + " " + cost.mode;
    ASSERT_GT(cost.instructions[0], 500) << what;
    if (cost.instance.empty()) {
      EXPECT_EQ(cost.instructions[1], cost.instructions[3]) << what;
      continue;
    }
    if (cost.effect == "restitution") {  // which takes the place of a ball's coming to rest
      EXPECT_NE(cost.instructions[0], cost.instructions[3]) << what;
    } else {
      EXPECT_GT(cost.each, 50) << what;  // it acts
    }
    if (cost.not_linear.empty()) {
      EXPECT_LT(cost.misfit, 0.02) << what;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(, EffectCostIn, testing::Values("checked", "pass", "solve", "step"));

TEST(EffectCost, PlayedStepKeepsNoRecordThatNobodyAsksFor) {
  if (const std::string why = why_not(); !why.empty()) GTEST_SKIP() << why;
  // Kinematics and residual, and on top of them the local pose and the world's own bookkeeping: a twentieth.
  // The comparison with the muscles' limits, where there are any, is another; the pose in the model's frame a
  // tenth; joint speeds, history and totals as much again as all of it.
  const double bare = count_instructions(kFull, "bare none 0");
  EXPECT_LT(count_instructions(kFull, "checked none 0"), 1.07 * bare);
  EXPECT_LT(count_instructions(kFull, "checked muscles 64"), 1.13 * bare);
}

TEST(EffectCost, FitFindsTheLine) {
  EffectCost cost;
  for (std::size_t i = 0; i < kInstances.size(); ++i)
    cost.instructions[i] = 1000 + (i == 0 ? 0 : 70 + 5 * kInstances[i]);
  fit(cost);
  EXPECT_NEAR(cost.fixed, 70, 1e-9);
  EXPECT_NEAR(cost.each, 5, 1e-9);
  EXPECT_NEAR(cost.misfit, 0, 1e-12);
  cost.instructions[3] *= 2;
  fit(cost);
  EXPECT_GT(cost.misfit, 0.1);
}

}  // namespace
}  // namespace sinew::study
