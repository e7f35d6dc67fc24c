// What clips say beside their motion: from a file beside the source, from a glTF's extras, from the options.
#include "convert/clip_data.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "reading.h"
#include "sinew/animation/curve_job.h"
#include "skinned_leg.h"

namespace sinew::convert {
namespace {

using import::test::Scratch;
using testing::HasSubstr;

nlohmann::json leg() {
  return import::test::skinned({1, 0, 0, 0}, {0});
}

/// A kicking leg, and what stands beside its file.
struct Converted {
  Asset asset;
  std::string error;

  Converted(const nlohmann::json& gltf, const std::string& beside, const nlohmann::json& options = {}) {
    const Scratch scratch;
    const std::string file = scratch.write("leg.gltf", gltf.dump()).string();
    if (!beside.empty()) scratch.write("leg.clips.json", beside);
    nlohmann::json report;
    error = convert_files({file}, options, asset, report).message;
  }
};

constexpr const char* kBeside = R"({
  // comments are welcome
  "curves": { "strength": 1 },
  "masks": { "lower": { "from": "leg" }, "all": { "from": "hip", "feather": 1, "joints": { "leg": 0.25 } } },
  "clips": { "kick": {
    "events": [ { "name": "hit", "from": 0.5, "to": 0.75, "always": true },
                { "name": "swing", "time": 0.25, "payload": [7, 255] } ],
    "curves": { "strength": [[0, 1], [0.5, 0.25], [1, 1]], "smile": { "keys": [[0, 0], [1, 2]], "smooth": true } }
  } } })";

TEST(ClipData, StandsBesideTheSource) {
  const Converted made(leg(), kBeside);
  ASSERT_EQ(made.error, "");
  ASSERT_EQ(made.asset.clips.size(), 1u);
  const Clip& clip = made.asset.clips[0];
  ASSERT_EQ(clip.events.size(), 2u);
  EXPECT_EQ(clip.events[0].name, event_name("swing"));
  EXPECT_EQ(clip.events[0].payload[1], std::byte(255));
  EXPECT_EQ(clip.events[1].begin, 0.5f);
  EXPECT_EQ(clip.events[1].end, 0.75f);
  EXPECT_TRUE(clip.events[1].always);
  ASSERT_EQ(made.asset.curve_slots.size(), 2u);
  std::vector<TimeJet<double>> values(2);
  CurveJob<double> job;
  job.clip = &clip;
  job.time = 0.5;
  job.slots = made.asset.curve_slots;
  job.values = values;
  ASSERT_TRUE(job.Run().ok());
  EXPECT_NEAR(values[std::size_t(made.asset.find_curve("strength"))].value, 0.25, 2e-3);
  EXPECT_NEAR(values[std::size_t(made.asset.find_curve("smile"))].value, 1, 1e-4);
  const JointMask& lower = made.asset.masks[std::size_t(made.asset.find_mask("lower"))];
  const JointMask& all = made.asset.masks[std::size_t(made.asset.find_mask("all"))];
  const auto of = [&](const JointMask& mask, const char* joint) {
    return int(mask.weights[std::size_t(made.asset.skeleton.find(joint))]);
  };
  EXPECT_EQ(of(lower, "hip"), 0);
  EXPECT_EQ(of(lower, "leg"), 255);
  EXPECT_EQ(of(all, "hip"), 128);
  EXPECT_EQ(of(all, "leg"), 64);
}

TEST(ClipData, StandsInTheExtrasOfAGltf) {
  nlohmann::json gltf = leg();
  gltf["extras"] = {{"sinew", {{"masks", {{"lower", {{"from", "leg"}}}}}}}, {"author", 7}};
  // An object, and the same as a text, as exporters write it that know no objects.
  for (const bool as_text : {false, true}) {
    const nlohmann::json own = nlohmann::json::parse(R"({"events": [{"name": "hit", "time": 0.5}]})");
    gltf["animations"][0]["extras"]["sinew"] = as_text ? nlohmann::json(own.dump()) : own;
    const Converted made(gltf, "");
    ASSERT_EQ(made.error, "");
    ASSERT_EQ(made.asset.clips[0].events.size(), 1u);
    EXPECT_EQ(made.asset.clips[0].events[0].begin, 0.5f);
    EXPECT_EQ(made.asset.find_mask("lower"), 0);
  }
  gltf["animations"][0]["extras"]["sinew"] = "{";
  EXPECT_THAT(Converted(gltf, "").error, HasSubstr("animation 'kick': extras.sinew is no JSON"));
}

TEST(ClipData, OfOptionsCountsMoreThanThatBesideTheSourceAndThatMoreThanExtras) {
  nlohmann::json gltf = leg();
  const auto events = [](double time) {
    return nlohmann::json{{"events", {{{"name", "hit"}, {"time", time}}}}};
  };
  const auto clips = [&](double time) { return nlohmann::json{{"clips", {{"kick", events(time)}}}}; };
  gltf["animations"][0]["extras"]["sinew"] = events(0.25);
  EXPECT_EQ(Converted(gltf, "").asset.clips[0].events[0].begin, 0.25f);
  EXPECT_EQ(Converted(gltf, clips(0.5).dump()).asset.clips[0].events[0].begin, 0.5f);
  EXPECT_EQ(Converted(gltf, clips(0.5).dump(), {{"clip_data", clips(0.75)}}).asset.clips[0].events[0].begin,
            0.75f);
}

TEST(ClipData, SaysWhetherAClipLoops) {
  EXPECT_FALSE(Converted(leg(), "").asset.clips[0].loops);
  EXPECT_TRUE(Converted(leg(), R"({"clips": {"kick": {"loops": true}}})").asset.clips[0].loops);
}

TEST(ClipData, FaultsAreNamedWithTheWayToThem) {
  struct Case {
    const char *data, *error;
  };
  for (
      const Case& c : std::initializer_list<Case>{
          {R"({"clip": {}})", "leg.clips.json: unknown key 'clip'"},
          {"[]", "leg.clips.json: clip data is not an object"},
          {R"({"clips": {"kick": {"events": [{"name": "a", "time": 0}, {"time": 1}]}}})",
           "clips.kick.events[1] has no name"},
          {R"({"clips": {"kick": {"events": [{"name": "a"}]}}})", "needs either 'time' or 'from' and 'to'"},
          {R"({"clips": {"kick": {"events": [{"name": "a", "from": 1, "to": 0}]}}})",
           "ends before it begins"},
          {R"({"clips": {"kick": {"events": [{"name": "a", "time": 3}]}}})",
           "clip 'kick': event 'a' at 3.000000 s is not within the clip's 1.000000 s"},
          {R"({"clips": {"kick": {"events": [{"name": "a", "time": 0, "payload": [256]}]}}})", "no byte"},
          {R"({"clips": {"kick": {"curves": {"c": []}}}})", "clips.kick.curves.c has no keys"},
          {R"({"clips": {"kick": {"curves": {"c": [[0, 1], [0, 2]]}}}})", "key times do not rise"},
          {R"({"clips": {"kick": {"curves": {"c": [[0, "x"]]}}}})", "is not a number"},
          {R"({"clips": {"kick": {"markers": [{"phase": 0, "time": 0}]}}})", "does not loop"},
          {R"({"clips": {"kick": {"cycles": 1.5}}})", "not a whole number"},
          {R"({"clips": {"hop": {"loops": true}}})", "there is no clip 'hop', but kick"},
          {R"({"masks": {"m": {"from": "tail"}}})", "mask 'm': there is no joint 'tail'"},
          {R"({"masks": {"m": {"weight": 1}}})", "masks.m reaches no joint"},
          {R"({"masks": {"m": {"joints": {"leg": 2}}}})", "masks.m.joints.leg is not within 0 and 1"},
          {R"({"clips": )", "leg.clips.json: not JSON: line 1"},
          {R"({"clips": {"kick": {"events": [{"name": "costarring", "time": 0}, {"name": "liquid", "time": 0}]}}})",
           "names of one number"}})
    EXPECT_THAT(Converted(leg(), c.data).error, HasSubstr(c.error)) << c.data;
}

double value_at(const FloatCurve& curve, double duration, bool loops, double t) {
  Clip clip;
  clip.duration = static_cast<float>(duration);
  clip.loops = loops;
  clip.curves = {curve};
  EXPECT_TRUE(validate(clip).ok()) << validate(clip).reason;
  const std::vector<CurveSlot> slots = {{"c", 0}};
  TimeJet<double> value;
  CurveJob<double> job;
  job.clip = &clip;
  job.time = t;
  job.slots = slots;
  job.values = {&value, 1};
  EXPECT_TRUE(job.Run().ok());
  return value.value;
}

TEST(FitCurve, StraightLinesNeverLeaveTheirRangeAndComeAsCloseAsWasSaid) {
  std::mt19937 random(20261126);
  std::uniform_real_distribution<double> uniform(0, 1);
  for (int n = 0; n < 40; ++n) {
    const bool loops = n % 2 == 0;
    const double duration = 0.5 + 2 * uniform(random);
    CurveKeys keys;
    for (double t = 0.2 * uniform(random); t < duration; t += 0.05 + 0.4 * uniform(random))
      keys.keys.emplace_back(t, uniform(random));
    const FloatCurve curve = fit_curve(keys, duration, loops);
    double low = 1, high = 0;
    for (const auto& [time, value] : keys.keys) {
      low = std::min(low, value);
      high = std::max(high, value);
    }
    // Knots at least 3 ms apart: at a key a line that turns by 40/s may be 40/6 · 6 ms off.
    for (const auto& [time, value] : keys.keys)
      EXPECT_NEAR(value_at(curve, duration, loops, time), value, 0.05);
    for (double t = 0; t <= duration; t += 0.003) {
      const double value = value_at(curve, duration, loops, t);
      EXPECT_GE(value, low - 1e-5);
      EXPECT_LE(value, high + 1e-5);
    }
  }
}

TEST(FitCurve, SmoothOnesGoThroughTheirKeysOnFewKnots) {
  CurveKeys keys;
  keys.smooth = true;
  for (int k = 0; k <= 6; ++k) keys.keys.emplace_back(k / 3.0, std::sin(2.5 * k / 3.0));
  for (const bool loops : {false, true}) {
    if (loops) keys.keys.pop_back();
    const FloatCurve curve = fit_curve(keys, 2, loops);
    EXPECT_LE(curve.controls.size(), 70u);
    for (const auto& [time, value] : keys.keys) EXPECT_NEAR(value_at(curve, 2, loops, time), value, 4e-3);
  }
}

TEST(FitCurve, AConstantTakesOneSpan) {
  CurveKeys keys;
  keys.keys = {{0.3, 0.7}};
  EXPECT_EQ(fit_curve(keys, 2, true).controls.size(), 1u);
  EXPECT_EQ(fit_curve(keys, 2, false).controls.size(), 4u);
  EXPECT_NEAR(value_at(fit_curve(keys, 2, false), 2, false, 1.1), 0.7, 1e-6);
}

}  // namespace
}  // namespace sinew::convert
