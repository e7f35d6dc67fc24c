// `sinew study tables`: what is measured, what is said about it, and (with peers) that others come to the
// same motion.
#include "study/tables/tables.h"

#include <atomic>
#include <thread>

#include "fixtures/paths.h"
#include "mechanisms.h"
#include "study/tables/count.h"
#include "study/tables/judge.h"
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
  options.quick = true;
  options.only = {"chain", "figure1", "four_bar"};
  TablesResult result;
  ASSERT_EQ(run_tables(options, {}, result), "");
  EXPECT_EQ(result.names(false), (std::vector<std::string>{"chain", "figure1"}));
  EXPECT_EQ(result.names(true), (std::vector<std::string>{"four_bar"}));
  for (const SimulationRun& m : result.simulations) {
    EXPECT_EQ(m.stopped, "") << m.mechanism << " " << m.method;
    EXPECT_LT(m.error.q, 1e-2) << m.mechanism << " " << m.method;  // 1e3 tolerances, against DE at 1e-12
    // Global formulations are open by what the integrator's error moves: ten tolerances.
    const bool global = m.method.find("Cartesian") != std::string::npos;
    EXPECT_LT(m.closure, global ? 1e-4 : 1e-8) << m.mechanism << " " << m.method;
  }
  for (const EvaluationCost& e : result.evaluations) EXPECT_GT(e.microseconds, 0);
  const std::string text = tables_text(result, "**", "**");
  for (const char* title :
       {"Table I.", "Table II.", "Table III.", "Table IV.", "Work of serial chains", "Conclusions"})
    EXPECT_NE(text.find(title), std::string::npos) << title;
  EXPECT_EQ(tables_json(result)["simulations"].size(), result.simulations.size());
}

TEST(Tables, AllMechanismsOfThePaperHaveTheirReferencesInTheRepository) {
  for (const char* name : {"fivebar_pendulum", "fivebar_planar", "driver_nonstiff", "driver_stiff",
                           "driver_nonstiff_hands", "driver_stiff_hands", "bricard", "bricard_slender",
                           "suspension_5ps", "suspension_mfs", "nfourbar_2", "slider_crank", "governor"}) {
    StudyCase c;
    ASSERT_EQ(load_mechanism_only(source_dir() + "/assets/mechanisms", name, c), "");
    EXPECT_GE(c.reference.t.size(), 26u) << name;
    EXPECT_DOUBLE_EQ(c.reference.t.back(), c.mechanism.t_end) << name;
  }
}

/// Verdicts and the figures that they rest on.
std::string judged(const TablesResult& result) {
  std::string all;
  for (const Conclusion& c : result.conclusions) {
    all += c.claim + ": " + verdict(c);
    for (const Evidence& e : c.evidence) all += "; " + e.about + (e.holds ? " holds" : " does not");
    all += "\n";
  }
  return all;
}

TEST(Tables, VerdictsAreTheSameOnABusyMachine) {
  if (!can_count()) GTEST_SKIP() << "no valgrind here: nothing is judged";
  TablesOptions options;
  options.quick = true;
  options.only = {"fivebar_pendulum", "four_bar"};
  options.recount = true;
  TablesResult quiet, busy;
  ASSERT_EQ(run_tables(options, {}, quiet), "");
  std::atomic<bool> over = false;
  std::vector<std::thread> load;
  for (unsigned i = 0; i < std::max(1u, std::thread::hardware_concurrency()); ++i)
    load.emplace_back([&over] {
      while (!over) std::this_thread::yield();
    });
  EXPECT_EQ(run_tables(options, {}, busy), "");
  over = true;
  for (std::thread& t : load) t.join();
  EXPECT_EQ(judged(quiet), judged(busy));
  EXPECT_NE(judged(quiet).find("holds"), std::string::npos) << "nothing was judged";
}

TEST(Tables, DirectoryWithoutMechanismsIsNamed) {
  TablesOptions options;
  options.mechanisms = "/nowhere";
  TablesResult result;
  EXPECT_NE(run_tables(options, {}, result).find("/nowhere"), std::string::npos);
}

TEST(Tables, ConclusionsFollowTheFigures) {
  TablesResult result;
  result.counted = true;
  result.mechanisms = {{"driver", 41, 0, 41, true}, {"pendulum", 5, 0, 5, false}};
  const auto evaluations = [&](double rr) {
    result.evaluations = {{"driver", "DTR", 0, 4e4},   {"driver", "DSR", 0, 8e4},
                          {"driver", "RR", 0, 2e4},    {"pendulum", "DTR", 0, 8e3},
                          {"pendulum", "DSR", 0, 6e3}, {"pendulum", "RR", 0, rr}};
  };
  const auto verdict_on = [&](const char* about) {
    for (const Conclusion& c : conclusions_of(result))
      if (c.claim.find(about) != std::string::npos) return verdict(c);
    return std::string("no such conclusion");
  };
  evaluations(5e3);
  EXPECT_EQ(verdict_on("faster to evaluate"), "holds");
  EXPECT_EQ(verdict_on("independent one"), "not measured");
  evaluations(7e3);
  EXPECT_EQ(verdict_on("faster to evaluate"), "holds on 1 of 2");
  EXPECT_EQ(verdict_on("DSR evaluates small"), "holds");
  result.conclusions = conclusions_of(result);
  EXPECT_NE(tables_text(result, "", "").find("pendulum 6000, 7000 (not)"), std::string::npos);
}

TEST(Tables, CostAtAnErrorLiesOnTheLowerEnvelopeOfTheRuns) {
  TablesResult result;
  const auto run = [&](double error, double cost) {
    SimulationRun m;
    m.mechanism = "m", m.method = "DE · DTR", m.error.q = error, m.instructions = cost;
    result.curves.push_back(m);
  };
  run(1e-2, 100), run(1e-4, 400), run(1e-3, 900), run(1e-6, 1600);       // the third is beaten by the second
  EXPECT_NEAR(cost_at_error(result, "m", "DE · DTR", 1e-3), 200, 1e-9);  // half-way in logarithms
  EXPECT_NEAR(cost_at_error(result, "m", "DE · DTR", 1e-5), 800, 1e-9);
  EXPECT_EQ(cost_at_error(result, "m", "DE · DTR", 1), 100);
  EXPECT_EQ(cost_at_error(result, "m", "DE · DTR", 1e-8), 0);
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
      const SimulationRun m = peer.measure(c, 1e-7, 1);
      EXPECT_EQ(m.stopped, "") << peer.name << " on " << name;
      EXPECT_LT(m.error.q, 3e-3) << peer.name << " on "
                                 << name;  // they control local errors only, some loosely
    }
  }
}

}  // namespace
}  // namespace sinew::study
