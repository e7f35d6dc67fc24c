#include "sinew/animation/phase_map.h"

#include <gtest/gtest.h>

#include <cmath>

#include "sinew/animation/smooth_input.h"

namespace sinew {
namespace {

PhaseMap fitted(std::span<const PhaseMarker> markers, double duration, int cycles = 1) {
  PhaseMap map;
  const Status status = fit_phase_map(markers, duration, cycles, map);
  EXPECT_TRUE(status.ok()) << status.reason;
  return map;
}
constexpr PhaseMarker kWalk[] = {{0, 0.1}, {0.5, 0.8}}, kRun[] = {{0, 0.4}, {0.5, 0.71}},
                      kTwice[] = {{0, 0.2}, {0.5, 0.9}, {1, 1.5}, {1.5, 2.2}};
constexpr double kWalkTime = 1.33, kRunTime = 0.67, kTwiceTime = 2.7;  ///< s

TEST(PhaseMap, GoesThroughItsMarkersInEveryCycleAndItsRatesAreItsOwn) {
  const PhaseMap maps[] = {fitted(kWalk, kWalkTime), fitted(kRun, kRunTime), fitted(kTwice, kTwiceTime, 2)};
  const std::span<const PhaseMarker> markers[] = {kWalk, kRun, kTwice};
  for (int i = 0; i < 3; ++i) {
    const PhaseMap& map = maps[i];
    for (const PhaseMarker& m : markers[i])
      for (const int loop : {-3, 0, 5})
        EXPECT_NEAR(map.by_phase(m.phase + loop * map.cycles).value, m.time + loop * double(map.duration),
                    1e-6);
    constexpr double h = 1e-5;
    for (double phase = -0.9; phase < 2; phase += 0.0317) {
      const TimeJet<double> t = map.by_phase(phase), a = map.by_phase(phase - h), b = map.by_phase(phase + h);
      EXPECT_GT(t.rate, 0.1 * map.duration / map.cycles) << "time stands still at " << phase;
      EXPECT_NEAR((b.value - a.value) / (2 * h), t.rate, 1e-7);
      EXPECT_NEAR((b.rate - a.rate) / (2 * h), t.acceleration, 1e-2);  // kinks of a cubic's second derivative
    }
  }
}

TEST(PhaseMap, MarkersComeFromContactWindows) {
  Clip clip;
  clip.loops = true;
  clip.duration = 2;
  // Two cycles, the right foot first: of joints 3 (left) and 5 (right).
  clip.contacts = {{3, 0.4f, 0.8f}, {5, 0.1f, 0.5f}, {5, 1.0f, 1.3f}, {3, 1.5f, 1.8f}, {7, 0.2f, 0.3f}};
  std::vector<PhaseMarker> markers;
  int cycles = 0;
  ASSERT_TRUE(phase_markers(clip, 3, 5, markers, cycles).ok());
  EXPECT_EQ(cycles, 2);
  const double times[] = {0.4, 1.0, 1.5, 2.1};
  ASSERT_EQ(markers.size(), 4u);
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_NEAR(markers[i].time, times[i], 1e-6);
    EXPECT_EQ(markers[i].phase, 0.5 * double(i));
  }
  clip.contacts.pop_back();
  clip.contacts.pop_back();
  EXPECT_FALSE(phase_markers(clip, 3, 5, markers, cycles).ok()) << "three steps";
  clip.loops = false;
  EXPECT_FALSE(phase_markers(clip, 3, 5, markers, cycles).ok());
}

TEST(PhaseMap, RefusesWhatWouldStopTime) {
  PhaseMap map;
  constexpr PhaseMarker backwards[] = {{0, 0.8}, {0.5, 0.1}}, crowded[] = {{0, 0}, {0.5, 0.02}},
                        wide[] = {{0, 0}, {1.5, 0.5}};
  EXPECT_EQ(fit_phase_map(backwards, 1, 1, map).index, 1);
  EXPECT_EQ(fit_phase_map(crowded, 1, 1, map).code, Code::kOutOfRange);
  EXPECT_FALSE(fit_phase_map(wide, 1, 1, map).ok());
  EXPECT_FALSE(fit_phase_map({}, 1, 1, map).ok());
  EXPECT_FALSE(fit_phase_map(kWalk, NAN, 1, map).ok());
}

TEST(PhaseJob, AloneAClipKeepsItsOwnTiming) {
  const PhaseMap walk = fitted(kWalk, kWalkTime), twice = fitted(kTwice, kTwiceTime, 2);
  for (const PhaseMap* map : {&walk, &twice})
    for (const double speed : {1.0, 0.7}) {
      const PhaseMember members[] = {{map, TimeJet<double>(1.0), speed}};
      TimeJet<double> phase(0.2);
      ClipTime time[1];
      ASSERT_TRUE((PhaseJob{members, 0, &phase, time}.Run().ok()));
      const double begin = time[0].value;
      for (int n = 1; n <= 600; ++n) {
        ASSERT_TRUE((PhaseJob{members, 1 / 60.0, &phase, time}.Run().ok()));
        ASSERT_NEAR(time[0].rate, speed, 1e-12);
        ASSERT_NEAR(time[0].acceleration, 0, 1e-9);
        ASSERT_NEAR(time[0].value - begin, speed * n / 60.0, 1e-5) << "after " << n << " frames";
      }
    }
}

TEST(PhaseJob, SweptFromWalkToRunTwiceASecondFeetComeDownTogether) {
  const PhaseMap walk = fitted(kWalk, kWalkTime), run = fitted(kRun, kRunTime);
  SmoothInput<double> input;
  TimeJet<double> phase(0.0);
  ClipTime times[2];
  double last = 0;
  for (int n = 0; n < 1200; ++n) {
    input.step(n / 60 % 2 == 0 ? 1 : 0, SmoothInput<double>::pole_of(0.1), 1 / 240.0);
    const PhaseMember members[] = {{&walk, TimeJet<double>(1.0) - input.x}, {&run, input.x}};
    ASSERT_TRUE((PhaseJob{members, n == 0 ? 0 : 1 / 240.0, &phase, times}.Run().ok()));
    EXPECT_GE(phase.value, last) << "never backwards";
    last = phase.value;
    // In which cycle, and how far into it, each clip is: where its own markers say so.
    const double loops[] = {(times[0].value - 0.1) / kWalkTime, (times[1].value - 0.4) / kRunTime};
    EXPECT_EQ(std::floor(loops[0] + 1e-7), std::floor(loops[1] + 1e-7)) << "left feet apart";
    // Slower than the run and faster than the walk, but for how uneven each is.
    EXPECT_GT(phase.rate, 0.8 / kWalkTime);
    EXPECT_LT(phase.rate, 1.25 / kRunTime);
  }
}

TEST(PhaseJob, RefusesWhatCannotBeMeant) {
  const PhaseMap walk = fitted(kWalk, kWalkTime);
  TimeJet<double> phase(0.0);
  ClipTime times[1];
  const auto status_of = [&](const PhaseMember& member, double h = 0.01) {
    const PhaseMember members[] = {member};
    return PhaseJob{members, h, &phase, times}.Run();
  };
  EXPECT_TRUE(status_of({&walk}).ok());
  EXPECT_FALSE(status_of({nullptr}).ok());
  EXPECT_FALSE(status_of({&walk, TimeJet<double>(0.0)}).ok());
  EXPECT_EQ(status_of({&walk, TimeJet<double>(-1.0)}).code, Code::kOutOfRange);
  EXPECT_EQ(status_of({&walk, TimeJet<double>(double(NAN))}).code, Code::kNotFinite);
  EXPECT_EQ(status_of({&walk, TimeJet<double>(1.0), 0}).code, Code::kOutOfRange);
  EXPECT_EQ(status_of({&walk}, -0.1).code, Code::kOutOfRange);
}

}  // namespace
}  // namespace sinew
