// `sinew study tables`: what is measured, what is said about it, and (with peers) that others come to the
// same motion.
#include "study/tables/tables.h"

#include "fixtures/paths.h"
#include "mechanisms.h"
#include "study/tables/peers.h"

namespace sinew::study {
namespace {

TEST(Tables, ErrorIsTheWorstRelativeDifferenceOfPositionsAndRates) {
  Trajectory is, was;
  is.t = was.t = {0, 1};
  is.y = {multibody::Vector{{0, 0}}, multibody::Vector{{1, 3}}};
  was.y = {multibody::Vector{{0, 0}}, multibody::Vector{{1.2, 3.4}}};
  const TrueError error = error_of(was, is);
  EXPECT_NEAR(error.q, 0.1, 1e-12);
  EXPECT_NEAR(error.u, 0.1, 1e-12);
}

TEST(Tables, RunOnTheMechanismsOfTheRepositoryAlone) {
  TablesOptions options;
  options.mechanisms = source_dir() + "/assets/mechanisms";
  options.quick = true;
  TablesResult result;
  ASSERT_EQ(run_tables(options, {}, result), "");
  EXPECT_EQ(result.open, (std::vector<std::string>{"chain", "figure1"}));
  EXPECT_EQ(result.closed, (std::vector<std::string>{"four_bar"}));
  for (const Measurement& m : result.simulations) {
    EXPECT_EQ(m.stopped, "") << m.mechanism << " " << m.method;
    EXPECT_LT(m.error.q, 1e-2) << m.mechanism << " " << m.method;  // 1e3 tolerances, against DE at 1e-12
    EXPECT_LT(m.closure, 1e-8) << m.mechanism << " " << m.method;
  }
  for (const EvaluationTime& e : result.evaluations) EXPECT_GT(e.microseconds, 0);
  const std::string text = tables_text(result, "**", "**");
  for (const char* title :
       {"Table I.", "Table II.", "Table III.", "Table IV.", "Work of serial chains", "Conclusions"})
    EXPECT_NE(text.find(title), std::string::npos) << title;
  EXPECT_EQ(tables_json(result)["simulations"].size(), result.simulations.size());
}

TEST(Tables, DirectoryWithoutMechanismsIsNamed) {
  TablesOptions options;
  options.mechanisms = "/nowhere";
  TablesResult result;
  EXPECT_NE(run_tables(options, {}, result).find("/nowhere"), std::string::npos);
}

TEST(Tables, ConclusionsFollowTheFigures) {
  TablesResult result;
  result.open = {"driver_nonstiff"};
  result.evaluations = {
      {"driver_nonstiff", "DTR", 4}, {"driver_nonstiff", "DSR", 8}, {"driver_nonstiff", "RR", 2}};
  const auto verdict_on = [&](const char* about) {
    for (const Conclusion& c : conclusions_of(result))
      if (c.claim.find(about) != std::string::npos) return c.verdict;
    return Conclusion::Verdict::kNotMeasured;
  };
  EXPECT_EQ(verdict_on("cheaper"), Conclusion::Verdict::kHolds);
  EXPECT_EQ(verdict_on("independent one"), Conclusion::Verdict::kNotMeasured);
  result.evaluations[2].microseconds = 5;
  EXPECT_EQ(verdict_on("cheaper"), Conclusion::Verdict::kDoesNot);
  result.conclusions = conclusions_of(result);
  EXPECT_NE(tables_text(result, "", "").find("does not hold here"), std::string::npos);
}

TEST(Tables, GrowthExponentIsTheSlopeOfLogarithms) {
  std::vector<ChainPoint> chains;
  for (const int n : {10, 20, 40, 80}) chains.push_back({n, 3.0 * n, 0.5 * n * n, 1});
  EXPECT_NEAR(growth_exponent(chains, &ChainPoint::dtr, 10), 1, 1e-12);
  EXPECT_NEAR(growth_exponent(chains, &ChainPoint::dsr, 20), 2, 1e-12);
}

TEST(Peers, ComeToTheSameMotion) {
  const std::vector<Peer> all = peers();
  if (all.empty()) GTEST_SKIP() << "built without SINEW_PEERS";
  for (const char* name : {"fivebar_pendulum", "driver_stiff", "bricard", "suspension_5ps"}) {
    StudyCase c;
    ASSERT_EQ(load_case(multibody::kOwn, name, c), "");
    for (const Peer& peer : all) {
      const Measurement m = peer.measure(c, 1e-7, 1);
      EXPECT_EQ(m.stopped, "") << peer.name << " on " << name;
      EXPECT_LT(m.error.q, 3e-3) << peer.name << " on "
                                 << name;  // they control local errors only, some loosely
    }
  }
}

}  // namespace
}  // namespace sinew::study
