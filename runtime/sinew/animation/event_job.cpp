#include "sinew/animation/event_job.h"

#include <algorithm>
#include <cmath>

namespace sinew {
namespace {

constexpr double kMostLoops = 1000;  ///< in one frame

/// How often an instant of a clip has been passed at a time: counted up to and with it, or before it. Frames
/// report differences of such numbers, so that neither rounding nor a long frame loses or repeats one.
double passes(double time, double instant, double duration, bool loops, bool with) {
  if (!loops) return with ? (time >= instant ? 1 : 0) : (time > instant ? 1 : 0);
  const double turns = (time - instant) / duration;
  return with ? std::floor(turns) : std::ceil(turns) - 1;
}

}  // namespace

Status EventJob::Validate() const {
  if (!out) return Status::error(Code::kInvalidArgument, "no sink");
  if (!std::isfinite(from) || !std::isfinite(to) || !std::isfinite(step) || !std::isfinite(weight))
    return Status::error(Code::kNotFinite, "time, step or weight is not finite");
  if (!(duration >= 0) || !std::isfinite(duration) || step < 0)
    return Status::error(Code::kOutOfRange, "duration or step is negative");
  if (loops && !(std::abs(to - from) <= kMostLoops * duration))
    return Status::error(Code::kOutOfRange, "more than a thousand loops in one frame");
  for (std::size_t i = 0; i < events.size(); ++i)
    if (!(events[i].begin >= 0 && events[i].begin <= events[i].end && double(events[i].end) <= duration))
      return Status::error(Code::kOutOfRange, "event is not within the clip", static_cast<int>(i));
  return {};
}

Status EventJob::Run() const {
  if (Status status = Validate(); !status) return status;
  const bool forwards = to >= from;
  const int first = out->count;
  const auto report = [&](const ClipEvent& event, double instant, EventKind kind) {
    if (kind != EventKind::kEnd && weight < threshold && !event.always) return;
    // Numbers of passes before the frame and after it.
    const double before = passes(from, instant, duration, loops, forwards != starts);
    const double after = passes(to, instant, duration, loops, forwards);
    const double low = std::min(before, after), high = std::max(before, after);
    for (double n = low + 1; n <= high; ++n) {
      const double time = instant + (loops ? n * duration : 0);
      const double part = to == from ? 0 : std::clamp((to - time) / (to - from), 0.0, 1.0);
      out->add({&event, kind, weight, static_cast<float>(part) * step});
    }
  };
  for (const ClipEvent& event : events) {
    if (event.begin == event.end) {
      report(event, double(event.begin), EventKind::kInstant);
      continue;
    }
    report(event, double(event.begin), forwards ? EventKind::kBegin : EventKind::kEnd);
    report(event, double(event.end), forwards ? EventKind::kEnd : EventKind::kBegin);
  }
  std::sort(out->hits.begin() + first, out->hits.begin() + out->count,
            [](const EventHit& a, const EventHit& b) {
              if (a.seconds_ago != b.seconds_ago) return a.seconds_ago > b.seconds_ago;
              if (a.kind != b.kind) return a.kind == EventKind::kEnd;  // what ends makes way
              return a.event < b.event;
            });
  return {};
}

void end_events(std::span<const ClipEvent> events, double duration, bool loops, double at, bool backwards,
                EventSink& out) {
  for (const ClipEvent& event : events) {
    if (event.begin == event.end) continue;
    const double begun = passes(at, double(event.begin), duration, loops, !backwards),
                 ended = passes(at, double(event.end), duration, loops, !backwards);
    if (begun > ended) out.add({&event, EventKind::kEnd, 0, 0});
  }
}

}  // namespace sinew
