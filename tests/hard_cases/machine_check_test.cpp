// A busy machine is noticed, and then nothing is written that times decide. Clocks are made up.
#include <gtest/gtest.h>

#include <map>

#include "study/accuracy_clock.h"
#include "study/accuracy_dial.h"
#include "study/accuracy_trip.h"

namespace sinew::study {
namespace {

/// A machine of which the test says how long its work takes.
struct Machine {
  double processor = 0, wall = 0;     ///< s, that have gone by
  double work = 0.01, waiting = 0.0;  ///< s each time

  MachineCheck check() {
    Clocks clocks;
    clocks.processor = [this] { return processor; };
    clocks.wall = [this] { return wall; };
    return MachineCheck(clocks, [this] { processor += work, wall += work + waiting; });
  }
};

TEST(MachineCheck, AQuietMachineIsBelieved) {
  Machine machine;
  MachineCheck check = machine.check();
  EXPECT_FALSE(check.busy()) << "nothing has been asked yet";
  check.run();
  machine.work *= 1.04;  // within MachineCheck::kDisagreement
  check.run();
  EXPECT_FALSE(check.busy()) << check.reason();
}

TEST(MachineCheck, TwoRunsThatDisagreeGiveItAway) {
  Machine machine;
  MachineCheck check = machine.check();
  check.run();
  machine.work *= 1.07;
  check.run();
  EXPECT_EQ(check.reason(), "a fixed piece of work took 10.0 ms once and 10.7 ms another time");
  machine.work = 0.01;
  check.run();
  EXPECT_TRUE(check.busy()) << "what was busy once has disturbed what was measured then";
}

TEST(MachineCheck, SoDoesWaitingForTheProcessorHoweverEvenTheTimesAre) {
  Machine machine;
  machine.waiting = machine.work;
  MachineCheck check = machine.check();
  check.run();
  check.run();
  EXPECT_EQ(
      check.reason(),
      "other programs kept the processor from this one for 50 % of the time in which a fixed piece of work "
      "ran");
}

/// Presets of one setting.
nlohmann::json dial() {
  DialPoint p;
  p.option = sinew_options()[0];
  p.us = p.us_limp = 10;
  p.error = 1e-4;
  return dial_json({p}, "a machine", "2000-01-01");
}

TEST(MachineCheck, PresetsAreWrittenOnAQuietMachineAndRefusedOnABusyOne) {
  std::map<std::string, std::string> files;
  const auto write = [&](const std::string& path, const std::string& text) {
    files[path] = text;
    return convert::Error{};
  };
  Machine machine;
  MachineCheck check = machine.check();
  check.run();
  EXPECT_FALSE(store_presets(dial(), "out", check, write));
  EXPECT_EQ(files.count("out/accuracy_presets.json"), 1u);
  EXPECT_EQ(files.count("out/presets.h"), 1u);
  files.clear();
  machine.work *= 2;
  check.run();
  const convert::Error refused = store_presets(dial(), "out", check, write);
  EXPECT_NE(refused.message.find("no presets are written, since the machine was busy"), std::string::npos)
      << refused.message;
  EXPECT_NE(refused.message.find("run the study again"), std::string::npos);
  EXPECT_TRUE(files.empty());
}

TEST(MachineCheck, ProcessorTimeStandsStillWhileAThreadSleeps) {
  const double begin = processor_seconds();
  timespec nap{0, 50'000'000};
  nanosleep(&nap, nullptr);
  EXPECT_LT(processor_seconds() - begin, 0.5 * 0.05) << "s; a wall clock would have gone on by 0.05";
  volatile double sum = 0;
  for (int n = 0; n < 100'000; ++n) sum = sum + n;
  EXPECT_GT(processor_seconds(), begin);
}

TEST(FrameCosts, AreTheWorksAndNotOfWhatDisturbedOneRun) {
  std::vector<std::vector<double>> runs(3, std::vector<double>(101, 1.0));
  for (std::vector<double>& run : runs) run[100] = 5;  // every run's last frame is dear
  runs[1][7] = 1000;                                   // once something came between
  const FrameCosts costs = frame_costs(runs);
  EXPECT_DOUBLE_EQ(costs.worst, 5);
  EXPECT_DOUBLE_EQ(costs.p99, 1);  // 99 of the other 100 lie below
  EXPECT_DOUBLE_EQ(costs.mean, 105.0 / 101);
  EXPECT_EQ(frame_costs({}).worst, 0);
}

}  // namespace
}  // namespace sinew::study
