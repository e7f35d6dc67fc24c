#include "sinew/animation/event_job.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <random>

namespace sinew {
namespace {

constexpr unsigned kSeed = 20261125;
constexpr double kDuration = 1.25;  ///< s

const std::vector<ClipEvent> kEvents = {{0, 0, 1}, {0.3f, 0.3f, 2}, {0.3f, 0.9f, 3}, {1.25f, 1.25f, 4}};

struct Frame {
  std::vector<EventHit> places = std::vector<EventHit>(100);
  EventSink sink{places};

  std::span<const EventHit> run(double from, double to, bool loops = true, bool starts = false,
                                float weight = 1) {
    sink.count = 0;
    EventJob job;
    job.events = kEvents;
    job.duration = kDuration;
    job.loops = loops;
    job.from = from;
    job.to = to;
    job.starts = starts;
    job.step = 0.1f;
    job.weight = weight;
    job.out = &sink;
    const Status status = job.Run();
    EXPECT_TRUE(status.ok()) << status.reason;
    return std::span<const EventHit>(places).first(std::size_t(sink.count));
  }
};

/// How often an instant lies between two times, by going through the loops one by one.
int by_counting(double instant, double from, double to, bool loops) {
  int count = 0;
  for (int loop = loops ? -40 : 0; loop <= (loops ? 40 : 0); ++loop) {
    const double time = instant + loop * kDuration;
    if (to >= from ? time > from && time <= to : time >= to && time < from) ++count;
  }
  return count;
}

TEST(Events, MillionRandomFramesReportWhatCountingFinds) {
  std::mt19937 random(kSeed);
  std::uniform_real_distribution<double> begin(-9, 9);
  std::normal_distribution<double> length(0, 1.5);
  Frame frame;
  for (int n = 0; n < 1'000'000; ++n) {
    const double from = begin(random), to = from + length(random);
    const bool loops = n % 3 != 0;
    int instants = 0, begins = 0, ends = 0;
    for (const EventHit& hit : frame.run(from, to, loops)) {
      instants += hit.kind == EventKind::kInstant;
      begins += hit.kind == EventKind::kBegin;
      ends += hit.kind == EventKind::kEnd;
    }
    const auto counted = [&](float instant) { return by_counting(double(instant), from, to, loops); };
    ASSERT_EQ(instants, counted(0) + counted(0.3f) + counted(1.25f))
        << from << " " << to << ", seed " << kSeed;
    ASSERT_EQ(begins, counted(to >= from ? 0.3f : 0.9f));
    ASSERT_EQ(ends, counted(to >= from ? 0.9f : 0.3f));
  }
}

TEST(Events, FramesThatFollowEachOtherLoseNothingAndRepeatNothing) {
  Frame frame;
  std::map<std::uint32_t, int> count;
  // Frames that end exactly on events too; 8 whole loops.
  const double steps[] = {0.3f, 0.9f - 0.3f, kDuration - 0.9f, 0.05, 0.25, 0.95};
  double t = 0;
  for (int n = 0; n < 24; ++n) {
    const double to = n == 23 ? 8 * kDuration : t + steps[n % 6];
    for (const EventHit& hit : frame.run(t, to, true, n == 0)) ++count[hit.event->name];
    t = to;
  }
  EXPECT_EQ(count[1], 9) << "at 0, and at the end of each of eight loops";
  EXPECT_EQ(count[2], 8);
  EXPECT_EQ(count[3], 16) << "beginnings and ends";
  EXPECT_EQ(count[4], 9) << "its end is the next one's beginning";
}

TEST(Events, TurningBackOnAnEventReportsItOnce) {
  Frame frame;
  const double there = 0.3f;
  EXPECT_EQ(frame.run(0.2, there).size(), 2u) << "the instant and the beginning";
  EXPECT_EQ(frame.run(there, 0.1).size(), 0u);
  EXPECT_EQ(frame.run(0.1, there).size(), 2u);
}

TEST(Events, ComeInTheOrderInWhichTheyHappenedWithTheirAge) {
  Frame frame;
  for (const double to : {2.4, -2.4}) {
    float last = 1;
    for (const EventHit& hit : frame.run(to > 0 ? 0.1 : -0.1, to)) {
      EXPECT_LE(hit.seconds_ago, last);
      EXPECT_GE(hit.seconds_ago, 0);
      EXPECT_LE(hit.seconds_ago, 0.1f);
      last = hit.seconds_ago;
    }
  }
  const auto hits = frame.run(0.2, 0.4);  // half of the frame ago
  ASSERT_EQ(hits.size(), 2u);
  EXPECT_NEAR(hits[0].seconds_ago, 0.05f, 1e-6);
}

TEST(Events, LightClipsKeepQuietButEndWhatTheyBegan) {
  Frame frame;
  EXPECT_EQ(frame.run(0.2, 0.4, true, false, 0.4f).size(), 0u);
  const auto hits = frame.run(0.8, 1.0, true, false, 0.4f);
  ASSERT_EQ(hits.size(), 1u);
  EXPECT_EQ(hits[0].kind, EventKind::kEnd);
}

TEST(Events, LeavingAClipEndsWhatHasBegun) {
  std::vector<EventHit> places(4);
  for (const double at : {0.3001, 0.6, 0.6 + 3 * kDuration, 0.2, 0.9001}) {
    EventSink sink{places};
    end_events(kEvents, kDuration, true, at, false, sink);
    const double within = at - kDuration * std::floor(at / kDuration);
    EXPECT_EQ(sink.count, within > 0.3 && within < 0.9 ? 1 : 0) << at;
  }
}

TEST(Events, AClipWithoutLengthIsAPoseAndASinkThatIsFullCounts) {
  const ClipEvent event[] = {{0, 0, 7}};
  std::vector<EventHit> places(1);
  EventSink sink{places};
  EventJob job;
  job.events = event;
  job.out = &sink;
  job.starts = true;
  ASSERT_TRUE(job.Run().ok());
  EXPECT_EQ(sink.count, 1);
  job.to = 0.1;
  ASSERT_TRUE(job.Run().ok());
  EXPECT_EQ(sink.lost, 1);
  job.starts = false;
  ASSERT_TRUE(job.Run().ok());
  EXPECT_EQ(sink.lost, 1) << "not again";
}

TEST(Events, RefusesWhatCannotBeMeant) {
  EventSink sink;
  EventJob job;
  job.duration = 1;
  EXPECT_FALSE(job.Run().ok());
  job.out = &sink;
  const ClipEvent late[] = {{0.5f, 2, 1}};
  job.events = late;
  EXPECT_EQ(job.Run().index, 0);
  job.events = {};
  job.to = NAN;
  EXPECT_EQ(job.Run().code, Code::kNotFinite);
  job.to = 5000;
  job.loops = true;
  EXPECT_EQ(job.Run().code, Code::kOutOfRange);
}

}  // namespace
}  // namespace sinew
