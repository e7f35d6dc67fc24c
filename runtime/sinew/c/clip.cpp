// Clips of the C interface that are played without a graph: events, curves, smooth inputs.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <span>

#include "sinew/animation/curve_job.h"
#include "sinew/animation/event_job.h"
#include "sinew/animation/smooth_input.h"
#include "sinew/c/call.h"
#include "sinew/c/event.h"
#include "sinew/c/fields.h"

namespace sinew::c {
namespace {

struct Passage {
  int clip = 0;
  double before = 0, now = 0, step = 0, weight = 1, threshold = double(EventJob().threshold);
  bool starts = false;
};

constexpr auto kPassage = [](auto& c, auto& s, auto&& f) {
  f("clip must be one", c.clip, s.clip, 0);
  f("before must be within 1e9 s", c.before, s.before, -1e9, 1e9);
  f("now must be within 1e9 s", c.now, s.now, -1e9, 1e9);
  f("", c.starts, s.starts);
  f("step must be 0 to 1e6 s", c.step, s.step, 0, 1e6);
  f("weight must be 0 to 1", c.weight, s.weight, 0, 1);
  f("threshold must be 0 to 1", c.threshold, s.threshold, 0, 1);
};

/// act(const Asset&, const Clip&) of a clip that is there.
template <class Act>
sinew_status with_clip(sinew_asset handle, int32_t clip, Act&& act) noexcept {
  return with_asset(handle, [&](const Asset& asset) {
    return clip >= 0 && std::size_t(clip) < asset.clips.size()
               ? act(asset, asset.clips[std::size_t(clip)])
               : fail(SINEW_INVALID_ARGUMENT, "no such clip", clip);
  });
}

/// Whether a caller's array with its length can be meant.
sinew_status check_room(const void* out, int32_t capacity, const int32_t* count) noexcept {
  if (!count || (!out && capacity != 0)) return fail(SINEW_INVALID_ARGUMENT, kNull);
  return capacity < 0 ? fail(SINEW_INVALID_ARGUMENT, "the capacity is negative") : sinew_status(SINEW_OK);
}

/// What find(EventSink&) → Status finds, to the caller.
template <class Find>
sinew_status tell_events(sinew_graph_event* out, int32_t capacity, int32_t* count, Find&& find) noexcept {
  constexpr std::size_t kMostEvents = 256;
  std::array<EventHit, kMostEvents> hits;
  EventSink sink{std::span(hits).first(std::min(kMostEvents, std::size_t(capacity)))};
  if (const Status status = find(sink); !status) return answer(status);
  *count = sink.count + sink.lost;
  if (sink.lost > 0) return fail(SINEW_TOO_SMALL, "room for fewer events");
  std::transform(hits.begin(), hits.begin() + sink.count, out, event_of);
  return SINEW_OK;
}

}  // namespace
}  // namespace sinew::c

using namespace sinew;
using namespace sinew::c;

sinew_status sinew_clip_passage_init(sinew_clip_passage* settings) {
  return init<Passage>(settings, kPassage);
}

sinew_status sinew_asset_get_passed_events(sinew_asset asset, const sinew_clip_passage* settings,
                                           sinew_graph_event* out, int32_t capacity, int32_t* count) {
  return with_asset(asset, [&](const Asset&) {
    if (!settings) return fail(SINEW_INVALID_ARGUMENT, kNull);
    Passage p;
    if (const sinew_status s = read_settings(settings, p, kPassage); s != SINEW_OK) return s;
    if (const sinew_status s = check_room(out, capacity, count); s != SINEW_OK) return s;
    return with_clip(asset, p.clip, [&](const Asset&, const Clip& clip) {
      return tell_events(out, capacity, count, [&](EventSink& sink) {
        return EventJob{clip.events, double(clip.duration), clip.loops,      p.before,           p.now,
                        p.starts,    float(p.step),         float(p.weight), float(p.threshold), &sink}
            .Run();
      });
    });
  });
}

sinew_status sinew_asset_get_ended_events(sinew_asset asset, int32_t clip, double time, int32_t backwards,
                                          sinew_graph_event* out, int32_t capacity, int32_t* count) {
  return with_clip(asset, clip, [&](const Asset&, const Clip& of) {
    if (const sinew_status s = check_room(out, capacity, count); s != SINEW_OK) return s;
    if (!std::isfinite(time)) return fail(SINEW_NOT_FINITE, "time must be finite");
    if (std::abs(time) > 1e9) return fail(SINEW_OUT_OF_RANGE, "time must be within 1e9 s");
    return tell_events(out, capacity, count, [&](EventSink& sink) {
      end_events(of.events, double(of.duration), of.loops, time, backwards != 0, sink);
      return Status{};
    });
  });
}

sinew_status sinew_asset_sample_curves(sinew_asset asset, int32_t clip, double time, double rate,
                                       double rate_change, sinew_curve_value* out, int32_t capacity,
                                       int32_t* count) {
  static_assert(sizeof(sinew_curve_value) == sizeof(TimeJet<float>) &&
                offsetof(sinew_curve_value, rate) == offsetof(TimeJet<float>, rate) &&
                offsetof(sinew_curve_value, acceleration) == offsetof(TimeJet<float>, acceleration));
  return with_clip(asset, clip, [&](const Asset& a, const Clip& of) {
    if (const sinew_status s = check_room(out, capacity, count); s != SINEW_OK) return s;
    const std::size_t slots = a.curve_slots.size();
    *count = static_cast<int32_t>(slots);
    if (slots > std::size_t(capacity)) return fail(SINEW_TOO_SMALL, "room for fewer curves");
    const std::span values(reinterpret_cast<TimeJet<float>*>(out), slots);
    return answer(CurveJob<float>{&of, {time, rate, rate_change}, a.curve_slots, values}.Run());
  });
}

sinew_status sinew_smooth(sinew_curve_value* state, float goal, float half_life, float step) {
  if (!state) return fail(SINEW_INVALID_ARGUMENT, kNull);
  for (const float x : {state->value, state->rate, state->acceleration, goal, half_life, step})
    if (!std::isfinite(x)) return fail(SINEW_NOT_FINITE, "an input and its goal must be finite");
  if (!(half_life >= 1e-4f && half_life <= 1e4f))
    return fail(SINEW_OUT_OF_RANGE, "half_life must be 1e-4 to 1e4 s");
  if (!(step >= 0 && step <= 1e4f)) return fail(SINEW_OUT_OF_RANGE, "step must be 0 to 1e4 s");
  SmoothInput<float> input{{state->value, state->rate, state->acceleration}};
  input.step(goal, SmoothInput<float>::pole_of(half_life), step);
  *state = {input.x.value, input.x.rate, input.x.acceleration};
  return SINEW_OK;
}
