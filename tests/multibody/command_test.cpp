// `sinew simulate MECHANISM.json` as a user runs it.
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

namespace {

using nlohmann::json;

struct Outcome {
  int code = -1;
  std::string out;
};

Outcome sinew(const std::string& arguments) {
  Outcome run;
  FILE* pipe = popen((std::string(SINEW_COMMAND) + " " + arguments + " 2>&1").c_str(), "r");
  char buffer[4096];
  for (std::size_t n; (n = fread(buffer, 1, sizeof buffer, pipe)) > 0;) run.out.append(buffer, n);
  run.code = WEXITSTATUS(pclose(pipe));
  return run;
}

std::string own_file(const std::string& name) {
  const std::string directory = testing::TempDir() + "sinew_mechanism_" + std::to_string(getpid()) + "/";
  std::filesystem::create_directories(directory);
  return directory + name;
}

std::string content(const std::string& path) {
  std::ifstream file(path);
  return {std::istreambuf_iterator<char>(file), {}};
}

const std::string kMechanisms = std::string(SINEW_SOURCE_DIR) + "/assets/mechanisms/";

TEST(MechanismCommand, WritesCoordinatesAndPointsAtTheInstantsAsked) {
  const std::string table = own_file("out.csv");
  const Outcome run =
      sinew("simulate " + kMechanisms +
            "four_bar.json --formulation RR-Rz-JF --integrator ode15sR --rtol 1e-6 --atol 1e-6 "
            "--at 0.25 1 0.5 --json -o " +
            table);
  ASSERT_EQ(run.code, 0) << run.out;
  std::stringstream lines(content(table));
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
  const std::string table = own_file("out.csv");
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
  const std::string table = own_file("partial.csv");
  const Outcome run = sinew("simulate " + kMechanisms + "chain.json --rtol 1e-16 --atol 1e-16 -o " + table);
  EXPECT_EQ(run.code, 1);
  EXPECT_NE(run.out.find("sinew: " + kMechanisms + "chain.json: stopped at t = "), std::string::npos)
      << run.out;
  EXPECT_NE(content(table).find("\n0,"), std::string::npos);
}

TEST(MechanismCommand, BadMechanismsAreRefusedInOneLineAndLeaveNothing) {
  json file = json::parse(content(kMechanisms + "chain.json"));
  file["joints"][3]["parent"] = "nobody";
  const std::string spoiled = own_file("spoiled.json"), table = own_file("never.csv");
  std::ofstream(spoiled) << file;
  const Outcome run = sinew("simulate " + spoiled + " -o " + table);
  EXPECT_EQ(run.code, 1);
  EXPECT_EQ(std::count(run.out.begin(), run.out.end(), '\n'), 1) << run.out;
  EXPECT_EQ(run.out.rfind("sinew: " + spoiled + ": joint 'hinge4'", 0), 0u) << run.out;
  EXPECT_FALSE(std::filesystem::exists(table));
}

TEST(MechanismCommand, UnknownFormulationIsAUsageError) {
  EXPECT_EQ(sinew("simulate " + kMechanisms + "chain.json --formulation XYZ -o x.csv").code, 2);
}

}  // namespace
