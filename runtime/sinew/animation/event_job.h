// Which events of a clip a frame passed.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "sinew/animation/clip_event.h"
#include "sinew/skeleton/status.h"

namespace sinew {

/// What of an event was passed.
enum class EventKind : std::uint8_t {
  kInstant,  ///< an event without length
  kBegin,    ///< it is entered; played backwards, at its end
  kEnd       ///< it is left
};

/// An event, or one end of one, that a frame passed.
struct EventHit {
  const ClipEvent* event = nullptr;      ///< one of EventJob::events
  EventKind kind = EventKind::kInstant;  ///< what of it
  float weight = 0;                      ///< of the clip; 0 from end_events()
  float seconds_ago = 0;  ///< before the end of the frame: a pose then is p − v·s + a·s²/2
};

/// The caller's place for hits of a frame, of any number of clips.
struct EventSink {
  std::span<EventHit> hits;  ///< the first `count` are this frame's
  int count = 0;             ///< the caller sets it to 0 before a frame
  int lost = 0;              ///< hits that found no place

  /// Into the next place; without one it is counted as lost.
  void add(const EventHit& hit) {
    if (std::size_t(count) < hits.size())
      hits[std::size_t(count++)] = hit;
    else
      ++lost;
  }
};

/// Reports what a clip passed between two times, in order. Forwards that is (from, to], backwards [to, from):
/// frames that follow each other report every event exactly once, at any frame rate, over any number of
/// loops, and also where the direction turns. Backwards, a part is entered at its end.
///
/// Times as given to SamplingJob, without wrapping. Allocates nothing; cost grows with events and loops.
struct EventJob {
  std::span<const ClipEvent> events;  ///< of the clip
  double duration = 0;                ///< s, of the clip
  bool loops = false;                 ///< as Clip::loops
  double from = 0;                    ///< s, clip time at the last frame
  double to = 0;                      ///< s, clip time now; of a loop at most a thousand durations away
  bool starts = false;                ///< the clip begins to play in this frame: `from` itself belongs to it
  float step = 0;                     ///< s of real time between the two
  float weight = 1;                   ///< of the clip
  float threshold = 0.5f;    ///< least weight for instants and beginnings: one of two footsteps; ends always
  EventSink* out = nullptr;  ///< hits are added to what it has

  Status Validate() const;  ///< `Status::index`: event
  Status Run() const;       ///< on an error `out` is left as it was
};

/// Ends what the clip is in the middle of at a time, when it stops being played there: a beginning that was
/// reported is always followed by an end. `backwards`: it came from later times.
void end_events(std::span<const ClipEvent> events, double duration, bool loops, double at, bool backwards,
                EventSink& out);

}  // namespace sinew
