#include "sinew/animation/curve_job.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "sinew/animation/clip_event.h"
#include "sinew/animation/joint_mask.h"

namespace sinew {
namespace {

const std::vector<CurveSlot> kSlots = {{"strength", 1}, {"smile", 0}, {"unused", -0.5f}};

Clip with_curves(bool loops) {
  Clip clip;
  clip.name = "curves";
  clip.duration = 2;
  clip.loops = loops;
  clip.curves = {{0, 0.25f, {1, 0.2f, 0.7f, 0.1f, 0.9f, 0.4f, 0.3f, 0.8f}}, {1, 0.5f, {0, 1, 0.5f, 0.25f}}};
  if (!loops)
    for (FloatCurve& curve : clip.curves) curve.controls.insert(curve.controls.end(), {0.6f, 0.2f, 0.9f});
  return clip;
}

std::vector<TimeJet<double>> sampled(const Clip& clip, const ClipTime& time) {
  std::vector<TimeJet<double>> values(kSlots.size());
  CurveJob<double> job;
  job.clip = &clip;
  job.time = time;
  job.slots = kSlots;
  job.values = values;
  const Status status = job.Run();
  EXPECT_TRUE(status.ok()) << status.reason;
  return values;
}

/// Rate and acceleration of all slots against differences of a motion [t] → jets.
template <class Motion>
void expect_exact(const Motion& motion, double t, double tolerance) {
  constexpr double kStep = 1e-4;
  const auto before = motion(t - kStep), now = motion(t), after = motion(t + kStep);
  for (std::size_t i = 0; i < now.size(); ++i) {
    EXPECT_NEAR(now[i].rate, (after[i].value - before[i].value) / (2 * kStep), tolerance) << i << " at " << t;
    EXPECT_NEAR(now[i].acceleration, (after[i].rate - before[i].rate) / (2 * kStep), 100 * tolerance)
        << i << " at " << t;
  }
}

TEST(Curves, MoveAsTheirDerivativesSayWhileTimeIsWarped) {
  const auto time = [](double t) {
    return ClipTime(t + 0.1 * std::sin(5 * t), 1 + 0.5 * std::cos(5 * t), -2.5 * std::sin(5 * t));
  };
  for (const bool loops : {true, false}) {
    const Clip clip = with_curves(loops);
    ASSERT_TRUE(validate(clip).ok());
    for (double t = 0.3; t < 1.7; t += 0.0937)
      expect_exact([&](double at) { return sampled(clip, time(at)); }, t, 1e-5);
  }
}

TEST(Curves, AreSmoothOverTheSeamOfALoopAndHeldBeyondTheEndsElsewhere) {
  const Clip loop = with_curves(true), once = with_curves(false);
  for (std::size_t i = 0; i < kSlots.size(); ++i) {
    const TimeJet<double> before = sampled(loop, 2 - 1e-9)[i], after = sampled(loop, 2 + 1e-9)[i];
    EXPECT_NEAR(before.value, after.value, 1e-7);
    EXPECT_NEAR(before.rate, after.rate, 1e-6);
    EXPECT_NEAR(before.acceleration, after.acceleration, 1e-5);
    EXPECT_EQ(sampled(loop, 0.5)[i].value, sampled(loop, 4.5)[i].value);
    EXPECT_EQ(sampled(once, 7)[i].value, sampled(once, 2)[i].value);
    EXPECT_EQ(sampled(once, 7)[i].rate, 0);
    EXPECT_EQ(sampled(once, -1)[i].value, sampled(once, 0)[i].value);
  }
}

TEST(Curves, RestWhereTheClipDoesNotMoveThem) {
  Clip clip = with_curves(true);
  EXPECT_EQ(sampled(clip, 1)[2].value, -0.5);
  clip.curves.erase(clip.curves.begin());
  const TimeJet<double> rests = sampled(clip, 1)[0];
  EXPECT_EQ(rests.value, 1);
  EXPECT_EQ(rests.rate, 0);
  EXPECT_EQ(rests.acceleration, 0);
}

TEST(Curves, StayBetweenTheirControls) {
  const Clip clip = with_curves(true);
  for (double t = 0; t < 2; t += 0.01) {
    EXPECT_GE(sampled(clip, t)[0].value, 0.1 - 1e-9);
    EXPECT_LE(sampled(clip, t)[0].value, 1 + 1e-9);
  }
}

using Values = std::vector<TimeJet<double>>;

Values blended(const std::vector<CurveLayer<double>>& layers) {
  Values out(kSlots.size());
  CurveBlendingJob<double> job;
  job.layers = layers;
  job.slots = kSlots;
  job.out = out;
  const Status status = job.Run();
  EXPECT_TRUE(status.ok()) << status.reason;
  return out;
}

TEST(CurveBlending, MovesAsItsDerivativesSay) {
  const Clip a = with_curves(true), b = with_curves(false);
  const std::vector<double> mask = {0.25, 1, 0};
  const auto weight = [](double t, double mean, double phase) {
    return TimeJet<double>(mean + 0.3 * std::sin(3 * t + phase), 0.9 * std::cos(3 * t + phase),
                           -2.7 * std::sin(3 * t + phase));
  };
  for (double t = 0.3; t < 1.7; t += 0.0937)
    expect_exact(
        [&](double at) {
          const Values x = sampled(a, at), y = sampled(b, at), z = sampled(a, at + 0.4);
          return blended({{x, weight(at, 0.5, 0)},
                          {z, weight(at, 0.4, 2), mask, BlendMode::kAdditive},
                          {y, weight(at, 1, 1)},
                          {z, weight(at, 0.6, 3), mask, BlendMode::kOverride}});
        },
        t, 1e-5);
}

TEST(CurveBlending, OneLayerAloneKeepsItsBitsAndNoneGivesRest) {
  const Values x = sampled(with_curves(true), 0.7);
  const Values alone = blended({{x, TimeJet<double>(0.3, 2, -7)}});
  for (std::size_t i = 0; i < x.size(); ++i) {
    EXPECT_EQ(alone[i].value, x[i].value);
    EXPECT_EQ(alone[i].rate, x[i].rate);
    EXPECT_EQ(alone[i].acceleration, x[i].acceleration);
    EXPECT_EQ(blended({})[i].value, double(kSlots[i].rest));
    EXPECT_EQ(blended({{x, TimeJet<double>(0)}})[i].value, double(kSlots[i].rest));
  }
}

TEST(CurveBlending, RefusesWhatIsNoWeight) {
  const Values x = sampled(with_curves(true), 0.7);
  Values out(kSlots.size());
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const std::vector<double> short_mask = {1}, steep_mask(kSlots.size(), 1.5), no_mask(kSlots.size(), nan);
  for (const CurveLayer<double>& bad :
       {CurveLayer<double>{x, TimeJet<double>(-0.1)}, CurveLayer<double>{x, TimeJet<double>(1, nan, 0)},
        CurveLayer<double>{x, TimeJet<double>(1), short_mask},
        CurveLayer<double>{x, TimeJet<double>(1), steep_mask},
        CurveLayer<double>{x, TimeJet<double>(1), no_mask}}) {
    CurveBlendingJob<double> job;
    job.layers = {&bad, 1};
    job.slots = kSlots;
    job.out = out;
    EXPECT_EQ(job.Run().index, 0);
    EXPECT_FALSE(job.Run().ok());
  }
  CurveJob<double> none;
  EXPECT_FALSE(none.Run().ok());
}

TEST(ClipData, IsCheckedWithTheClip) {
  const Clip good = with_curves(false);
  const auto refused = [&](const auto& spoil, int index) {
    Clip bad = good;
    spoil(bad);
    const Status status = validate(bad);
    EXPECT_FALSE(status.ok());
    EXPECT_EQ(status.index, index) << status.reason;
  };
  refused([](Clip& c) { c.curves[1].slot = 0; }, 1);
  refused([](Clip& c) { c.curves[0].knot_interval = 0; }, 0);
  refused([](Clip& c) { c.curves[1].controls.resize(3); }, 1);
  refused([](Clip& c) { c.curves[0].controls.resize(10); }, 0);
  refused([](Clip& c) { c.curves[0].controls[2] = std::numeric_limits<float>::infinity(); }, 0);
  refused([](Clip& c) { c.events = {{1, 1, 7}, {0.5f, 1, 7}}; }, 1);
  refused([](Clip& c) { c.events = {{1, 2.5f, 7}}; }, 0);
  refused([](Clip& c) { c.markers = {{0, 1}, {0.5, 3}}; }, 1);
  refused([](Clip& c) { c.cycles = 0; }, -1);
}

TEST(EventNames, AreKnownWhenTheGameIsCompiled) {
  static_assert(event_name("") == 2166136261u && event_name("a") == 0xE40C292Cu);
  EXPECT_NE(event_name("step_l"), event_name("step_r"));
}

TEST(JointMask, IsExactAtItsEnds) {
  const JointMask mask{"arm", {0, 255, 51}};
  std::vector<float> weights(4, 7.f);
  mask.write<float>(weights);
  EXPECT_EQ(weights, (std::vector<float>{0, 1, 0.2f, 0}));
}

}  // namespace
}  // namespace sinew
