// The failure maps tell engines that keep their energy from those that do not.
#include "study/maps.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "study/accuracy_trip.h"
#include "study/bodies.h"

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

/// A chain of hinges and a ball joint under a thrown root, after a quarter of a second in fine steps.
std::vector<Transform<double>> flown(const EngineOption& with) {
  EngineScene scene;
  scene.ground = false;
  ChainShape shape{4, JointType::kBall, JointType::kFree, 0.4, 2, 0.5};
  scene.figures.push_back(resting(chain(shape)));
  Figure& figure = scene.figures[0];
  figure.skeleton.joints[2].type = JointType::kRevolute;
  bend(figure.skeleton, figure.jets, 1, {0.4, -0.3, 0.2});
  randomise_speeds(figure.skeleton, figure.jets, 3, 1);
  figure.jets[0].velocity = {1, 2, 3};
  const double h = 1.0 / 1920;
  const std::unique_ptr<Engine> engine = with.make(scene, h, Accuracy{});
  EXPECT_EQ(engine->refusal(), "") << with.label();
  for (int n = 0; n < 480; ++n) EXPECT_TRUE(engine->step()) << with.label();
  return engine->pose(0);
}

TEST(Peers, FlyAsOursDoInFineSteps) {
  std::vector<EngineOption> peers = peer_options();
  if (peers.empty()) GTEST_SKIP() << "built without SINEW_PEERS: no other engine was compared";
  for (const EngineOption& peer : controlled_options()) peers.push_back(peer);
  const std::vector<Transform<double>> ours = flown(most_accurate_option());
  for (const EngineOption& peer : peers) {
    const std::vector<Transform<double>> theirs = flown(peer);
    ASSERT_EQ(theirs.size(), ours.size());
    for (std::size_t i = 0; i < ours.size(); ++i) {
      // First-order peers are off by some millimetres here; a wrong model by decimetres.
      EXPECT_LT((ours[i].translation - theirs[i].translation).norm(), 1e-2)
          << peer.label() << ", joint " << i;
      // Direction of the rods: about their length ODE's gyroscopic term brakes them at first order.
      const Vec3<double> rod = ours[i].rotation * Vec3<double>::UnitZ();
      EXPECT_LT((rod - theirs[i].rotation * Vec3<double>::UnitZ()).norm(), 0.03)
          << peer.label() << ", joint " << i;
    }
  }
}

AccuracyScene scene_named(const std::string& name) {
  for (const AccuracyScene& s : accuracy_scenes())
    if (s.name == name) return s;
  ADD_FAILURE() << name << " is no scene";
  return {};
}

/// Largest rms displacement of a peer's run of a scene from our fine one, m.
double apart_from_ours(const AccuracyScene& s, const EngineOption& peer, double h = 1.0 / 960,
                       const Accuracy& asked = {}) {
  const Trip theirs = travel(s, peer, h, asked, true);
  EXPECT_EQ(theirs.refusal, "") << peer.label();
  if (!theirs.survived) return INFINITY;
  return apart(s, travel(s, most_accurate_option(), 1.0 / 960, Accuracy{}, true).track, theirs.track);
}

TEST(Peers, CollapseAsOursDoInFineSteps) {
  const std::vector<EngineOption> peers = peer_options();
  if (peers.empty()) GTEST_SKIP() << "built without SINEW_PEERS: no other engine was compared";
  constexpr double kBound = 1e-2;  // m; laws of contact differ by 1 to 5 mm, other floors by decimetres
  for (const EngineOption& peer : peers) {
    if (peer.engine == "Simbody") continue;  // its steps of given size are explicit: too long for this floor
    EXPECT_LT(apart_from_ours(scene_named("collapse"), peer), kBound) << peer.label();
  }
  Accuracy asked;
  asked.tolerance = 1e-2;
  for (const EngineOption& peer : controlled_options())
    EXPECT_LT(apart_from_ours(scene_named("collapse"), peer, 1.0 / 60, asked), kBound) << peer.label();
}

TEST(Peers, ServosWithTheSameLimitsGiveWayToAPushAsOurMusclesDo) {
  int compared = 0;
  for (const EngineOption& peer : peer_options()) {
    if (peer.label() != "ODE Step" && peer.label() != "DART Euler Dantzig") continue;
    EXPECT_LT(apart_from_ours(scene_named("tracking"), peer), 3e-2) << peer.label();  // 1.5 to 2 cm
    ++compared;
  }
  if (compared == 0) GTEST_SKIP() << "built without SINEW_PEERS: no other engine was compared";
}

TEST(Peers, SimbodysMusclesGiveWayToAPushInTheAirAsOursDo) {
  const std::vector<EngineOption> controlled = controlled_options();
  if (controlled.empty()) GTEST_SKIP() << "built without SINEW_PEERS: no other engine was compared";
  AccuracyScene flying = scene_named("tracking");
  EXPECT_NE(controlled.back().make(flying.scene, 1.0 / 60, Accuracy{})->refusal(), "");  // on the floor
  flying.scene.ground = false;
  for (const EngineOption& peer : peer_options()) {
    if (peer.engine != "Simbody") continue;
    EXPECT_LT(apart_from_ours(flying, peer, 1.0 / 240), 5e-3) << peer.label();  // 1 to 2 mm
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
