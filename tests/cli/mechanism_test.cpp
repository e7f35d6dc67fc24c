// `sinew simulate MECHANISM.json` as a user runs it.
#include <nlohmann/json.hpp>
#include <sstream>

#include "cli/command.h"
#include "fixtures/paths.h"

namespace sinew::test {
namespace {

using nlohmann::json;

const std::string kMechanisms = source_dir() + "/assets/mechanisms/";

TEST(MechanismCommand, WritesCoordinatesAndPointsAtTheInstantsAsked) {
  const std::string table = own_directory() + "out.csv";
  const Outcome run =
      sinew("simulate " + kMechanisms +
            "four_bar.json --formulation RR-Rz-JF --integrator ode15sR --rtol 1e-6 --atol 1e-6 "
            "--at 0.25 1 0.5 --json -o " +
            table);
  ASSERT_EQ(run.code, 0) << run.out;
  std::stringstream lines(bytes_of(table));
  std::string line;
  std::getline(lines, line);
  EXPECT_EQ(line, "t,q:A,q:B,q:D,u:A,u:B,u:D,x:B,y:B,z:B,x:C,y:C,z:C,kinetic,potential");
  for (const double t : {0.25, 0.5, 1.0}) {
    std::getline(lines, line);
    EXPECT_EQ(std::stod(line), t);
  }
  EXPECT_FALSE(std::getline(lines, line));
  const json telemetry = json::parse(run.out);
  for (const char* key : {"steps", "residual_evaluations", "derivative_evaluations", "tangent_evaluations",
                          "factorisations", "cpu_seconds", "closure_error_m", "energy_imbalance_J"})
    EXPECT_TRUE(telemetry.contains(key)) << key;
  EXPECT_GT(telemetry["steps"], 0);
  EXPECT_LT(telemetry["closure_error_m"], 1e-8);
}

TEST(MechanismCommand, EveryFormulationAndIntegratorThatFitsRuns) {
  const std::string table = own_directory() + "out.csv";
  for (const char* pair :
       {"DTR --integrator DE", "DSR --integrator DE", "DTR --integrator ode15s", "DSR-JF --integrator ode15s",
        "RR-JN --integrator ode15sR", "RR-JF --integrator ode15sR", "RR-JN --integrator DASSL",
        "RR-JF --integrator DASSL", "RR-JF --integrator bdf1", "RR-JF --integrator bdf2"}) {
    const Outcome run =
        sinew("simulate " + kMechanisms + "chain.json --t-end 0.1 -o " + table + " --formulation " + pair);
    EXPECT_EQ(run.code, 0) << pair << run.out;
  }
}

TEST(MechanismCommand, UnreachableToleranceExitsWithOneAndLeavesWhatWasComputed) {
  const std::string table = own_directory() + "partial.csv";
  const Outcome run = sinew("simulate " + kMechanisms + "chain.json --rtol 1e-16 --atol 1e-16 -o " + table);
  EXPECT_EQ(run.code, 1);
  EXPECT_NE(run.out.find("sinew: " + kMechanisms + "chain.json: stopped at t = "), std::string::npos)
      << run.out;
  EXPECT_NE(bytes_of(table).find("\n0,"), std::string::npos);
}

TEST(MechanismCommand, BadMechanismsAreRefusedInOneLineAndLeaveNothing) {
  json file = json::parse(bytes_of(kMechanisms + "chain.json"));
  file["joints"][3]["parent"] = "nobody";
  const std::string spoiled = written("spoiled.json", file.dump()), table = own_directory() + "never.csv";
  expect_refused("simulate " + spoiled + " -o " + table, spoiled + ": joint 'hinge4'");
  EXPECT_FALSE(std::filesystem::exists(table));
}

TEST(MechanismCommand, UnknownFormulationIsAUsageError) {
  EXPECT_EQ(sinew("simulate " + kMechanisms + "chain.json --formulation XYZ -o x.csv").code, 2);
}

}  // namespace
}  // namespace sinew::test
