// The failure maps tell engines that keep their energy from those that do not.
#include "study/maps.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

namespace sinew::study {
namespace {

/// An engine whose energy is multiplied in every step.
class Growing : public Engine {
 public:
  explicit Growing(double factor) : factor_(factor) {}
  const std::string& refusal() const override { return none_; }
  bool step() override {
    energy_ *= factor_;
    return true;
  }
  void aim(int, const std::vector<JointJet<double>>&) override {}
  void push(int, int, const Vec3<double>&) override {}
  double energy() const override { return energy_; }
  std::vector<Transform<double>> pose(int) const override { return {}; }

 private:
  double factor_, energy_ = 1;
  std::string none_;
};

/// Energy after 1 s in steps of 1/60: factor⁶⁰.
template <int thousandths>
std::unique_ptr<Engine> growing(const EngineScene&, double, const Accuracy&) {
  return std::make_unique<Growing>(1 + thousandths / 1000.0);
}

class Refusing : public Growing {
 public:
  Refusing() : Growing(1) {}
  const std::string& refusal() const override { return why_; }

 private:
  std::string why_ = "cannot";
};

std::unique_ptr<Engine> refusing(const EngineScene&, double, const Accuracy&) {
  return std::make_unique<Refusing>();
}

Fate fate(std::unique_ptr<Engine> (*make)(const EngineScene&, double, const Accuracy&)) {
  return fate_of_flight({"", "", make}, 1.0 / 60, 1, 1).fate;
}

TEST(Maps, TellKeepingLosingGainingAndExplodingApart) {
  EXPECT_EQ(fate(growing<0>), Fate::kFaithful);
  EXPECT_EQ(fate(growing<-1>), Fate::kFaithful);  // 6 %
  EXPECT_EQ(fate(growing<-10>), Fate::kLoses);    // 45 %
  EXPECT_EQ(fate(growing<1>), Fate::kGains);      // 6 %
  EXPECT_EQ(fate(growing<100>), Fate::kExplodes);
  EXPECT_EQ(fate(refusing), Fate::kCannot);
}

TEST(Maps, OurSchemesKeepTheEnergyOfASlowFlightAndOfAChain) {
  for (const EngineOption& option : sinew_options()) {
    EXPECT_EQ(fate_of_flight(option, 1.0 / 240, 1, 1).fate, Fate::kFaithful) << option.label();
    EXPECT_LE(fate_of_chain(option, 1.0 / 60, 1000, 0.5).fate, Fate::kLoses) << option.label();
  }
}

TEST(Maps, AreDrawnAndWrittenCompletely) {
  FailureMap map{"title", "across", "change"};
  map.columns = {1, 2};
  map.engines = sinew_options();
  map.cells.resize(map.engines.size() * map.steps.size() * map.columns.size());
  map.cells[3].energy = INFINITY;
  const std::string csv = map_csv(map);
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 1 + std::ptrdiff_t(map.cells.size()));
  for (const char* ending : {"png", "svg"}) {
    const std::string file = testing::TempDir() + "map." + ending;
    const convert::Error error = draw_map(map, file);
    EXPECT_FALSE(error) << error.message;
    EXPECT_GT(std::filesystem::file_size(file), 10000u);
  }
  EXPECT_TRUE(draw_map(map, "/nowhere/map.png"));
}

}  // namespace
}  // namespace sinew::study
