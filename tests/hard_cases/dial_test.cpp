// The accuracy dial keeps its word on scenes that it was not made from, and refuses nonsense.
#include <gtest/gtest.h>

#include <cctype>
#include <cmath>
#include <fstream>
#include <iterator>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>

#include "fixtures/known_failure.h"
#include "fixtures/paths.h"
#include "scene/presets.h"
#include "sinew/optimizer/presets.h"
#include "study/accuracy_dial.h"
#include "study/accuracy_trip.h"

namespace sinew::study {
namespace {

constexpr double kFrame = 1.0 / 60;

EngineOption engine_of(const scene::MeasuredAccuracy& m) {
  const std::string name = m.double_precision ? "bossak double" : "bossak float";
  for (const EngineOption& o : sinew_options())
    if (o.option == name) return o;
  return {};
}

struct Outcome {
  double error = 0, degrees = 0;
};

/// Largest errors of a setting over all unseen scenes.
Outcome on_unseen_scenes(const scene::MeasuredAccuracy& m) {
  static std::map<std::string, Track> truths;
  Outcome worst;
  for (const AccuracyScene& s : unseen_scenes()) {
    if (!truths.count(s.name)) truths[s.name] = converged(s, most_accurate_option(), true);
    const Trip trip = travel(s, engine_of(m), kFrame, m.accuracy, true);
    EXPECT_TRUE(trip.survived) << s.name;
    const double error = apart(s, trip.track, truths[s.name]);
    worst.error = std::max(worst.error, error);
    if (s.drive) worst.degrees = std::max(worst.degrees, degrees_apart(s, trip.track, truths[s.name]));
    testing::Test::RecordProperty(s.name, std::to_string(error));
  }
  return worst;
}

TEST(Dial, KeepsAPromisedErrorOnScenesThatItWasNotMadeFrom) {
  ASSERT_FALSE(unseen_scenes().back().scene.figures.empty()) << "the mannequin is missing";
  for (const auto& [wanted, metres] : {std::pair("30cm", 0.3), std::pair("10cm", 0.1), std::pair("2cm", 0.02),
                                       std::pair("1cm", 0.01), std::pair("5mm", 0.005)}) {
    scene::MeasuredAccuracy chosen;
    ASSERT_FALSE(scene::within_error(wanted, chosen)) << wanted;
    EXPECT_LE(on_unseen_scenes(chosen).error, metres) << wanted;
  }
}

TEST(Dial, KeepsAPromisedAngleWhereMusclesFollowAnotherClip) {
  for (const auto& [wanted, degrees] : {std::pair("2deg", 2.0), std::pair("1deg", 1.0)}) {
    scene::MeasuredAccuracy chosen;
    ASSERT_FALSE(scene::within_error(wanted, chosen)) << wanted;
    EXPECT_LE(on_unseen_scenes(chosen).degrees, degrees) << wanted;
  }
}

TEST(Dial, PresetsStayWithinTwiceTheirMeasuredErrorOnUnseenScenes) {
  for (const scene::MeasuredAccuracy& preset : scene::accuracy_presets())
    EXPECT_LE(on_unseen_scenes(preset).error, scene::kDialSafety * preset.error) << preset.name;
}

TEST(Dial, MoreBudgetNeverBuysLessAccuracy) {
  double last = INFINITY;
  for (const char* budget : {"20us", "50us", "100us", "1ms"}) {
    scene::MeasuredAccuracy chosen;
    ASSERT_FALSE(scene::within_budget(budget, chosen)) << budget;
    EXPECT_LE(chosen.error, last) << budget;
    last = chosen.error;
  }
  scene::MeasuredAccuracy twenty;
  ASSERT_FALSE(scene::within_budget("20us", twenty));
  EXPECT_LE(twenty.us, 20);
}

TEST(Dial, HasASettingForTenMicroseconds) {
  scene::MeasuredAccuracy cheap;
  SINEW_FAILS_TODAY(!scene::within_budget("10us", cheap),
                    "implicit Euler took 9 us where the one scheme takes 16");
}

TEST(Dial, RefusesWhatIsNoErrorNoTimeOrOutOfReach) {
  scene::MeasuredAccuracy out;
  for (const char* wanted : {"", "1", "mm", "-1mm", "0mm", "nanmm", "1 furlong", "infm", "1us"})
    EXPECT_NE(scene::within_error(wanted, out).message.find("is no error"), std::string::npos) << wanted;
  for (const char* wanted : {"", "5", "us", "-3us", "1mm", "0ms"})
    EXPECT_NE(scene::within_budget(wanted, out).message.find("is no time"), std::string::npos) << wanted;
  EXPECT_NE(scene::within_error("1e-9mm", out).message.find("the most accurate promises"), std::string::npos);
  EXPECT_NE(scene::within_budget("0.01us", out).message.find("the cheapest takes"), std::string::npos);
  EXPECT_NE(scene::find_preset("perfect", out).message.find("crowd"), std::string::npos);
}

TEST(Dial, HeaderForHostsHoldsThePresetsOfTheDataFile) {
  for (const AccuracyPreset& header : {kCrowdPreset, kGamePreset, kCinematicPreset, kReferencePreset}) {
    scene::MeasuredAccuracy preset;
    ASSERT_FALSE(scene::find_preset(header.name, preset)) << header.name;
    EXPECT_EQ(header.double_precision, preset.double_precision) << header.name;
    EXPECT_EQ(header.accuracy.substeps, preset.accuracy.substeps) << header.name;
    EXPECT_DOUBLE_EQ(header.accuracy.tolerance, preset.accuracy.tolerance) << header.name;
    EXPECT_NEAR(header.error, preset.error, 0.05 * preset.error) << header.name;  // two digits
  }
}

TEST(Dial, KeepsThePartsOfAStepAsShortAtOtherFrameRates) {
  scene::MeasuredAccuracy measured;
  measured.accuracy.substeps = 3;
  Accuracy accuracy;
  bool precise = false;
  for (const auto& [rate, parts] :
       {std::pair(60.0, 3), std::pair(30.0, 6), std::pair(120.0, 2), std::pair(240.0, 1)}) {
    set_accuracy(measured, rate, accuracy, precise);
    EXPECT_EQ(accuracy.substeps, parts) << rate;
  }
}

/// Without the white space that clang-format moves.
std::string dense(std::string text) {
  std::erase_if(text, [](unsigned char c) { return std::isspace(c); });
  return text;
}

TEST(Dial, HeaderForHostsIsWrittenFromTheDataFile) {
  const auto read = [](const std::string& file) {
    std::ifstream in(source_dir() + "/" + file);
    return std::string(std::istreambuf_iterator<char>(in), {});
  };
  const std::string header = read("runtime/sinew/optimizer/presets.h");
  const std::string made = dial_header(nlohmann::json::parse(read("assets/accuracy_presets.json")));
  EXPECT_EQ(dense(header), dense(made)) << made;
}

DialPoint dial_point(double us, double error) {
  DialPoint p;
  p.option = sinew_options()[0];
  p.us = p.us_limp = us;
  p.error = error;
  return p;
}

TEST(Dial, PresetsAreTheCheapestOnTheFrontWithinTheirError) {
  const auto front =
      dial_front({dial_point(1, 0.15), dial_point(2, 0.05), dial_point(3, 0.06), dial_point(4, 0.02)});
  ASSERT_EQ(front.size(), 3u);  // 3 µs for 6 cm is beaten
  const nlohmann::json presets = dial_json(front, "", "")["presets"];
  EXPECT_EQ(presets["crowd"]["us"], 1);
  EXPECT_EQ(presets["game"]["us"], 2);
  EXPECT_EQ(presets["cinematic"]["us"], 4);  // none is within 1 cm: the most accurate
  EXPECT_FALSE(presets["crowd"].contains("same_as"));
}

TEST(Dial, APresetThatIsNoSettingOfItsOwnIsAnotherNameOfTheStricterOne) {
  const nlohmann::json dial = dial_json(dial_front({dial_point(1, 0.05), dial_point(4, 1e-4)}), "", "");
  const nlohmann::json& presets = dial["presets"];
  EXPECT_EQ(presets["crowd"]["same_as"], "game");
  EXPECT_EQ(presets["crowd"]["us"], presets["game"]["us"]) << "readers need not know";
  EXPECT_FALSE(presets["game"].contains("same_as"));
  const std::string header = dial_header(dial);
  const std::size_t game = header.find("AccuracyPreset kGamePreset{"),
                    crowd = header.find("AccuracyPreset kCrowdPreset = kGamePreset;");
  EXPECT_LT(game, crowd);
  EXPECT_NE(crowd, std::string::npos) << header;
  EXPECT_NE(header.find("another name of kGamePreset"), std::string::npos);
}

}  // namespace
}  // namespace sinew::study
