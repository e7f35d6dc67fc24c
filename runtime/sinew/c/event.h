// Events of clips for the C interface.
#pragma once

#include <cstring>

#include "sinew/animation/event_job.h"
#include "sinew/c/sinew.h"

namespace sinew::c {

static_assert(int(EventKind::kInstant) == SINEW_EVENT_INSTANT &&
              int(EventKind::kBegin) == SINEW_EVENT_BEGIN && int(EventKind::kEnd) == SINEW_EVENT_END);

inline sinew_graph_event event_of(const EventHit& hit) {
  sinew_graph_event out{hit.event->name,
                        static_cast<sinew_event_kind>(hit.kind),
                        hit.weight,
                        hit.seconds_ago,
                        hit.event->begin,
                        hit.event->end,
                        {}};
  static_assert(sizeof out.payload == sizeof hit.event->payload);
  std::memcpy(out.payload, hit.event->payload.data(), sizeof out.payload);
  return out;
}

}  // namespace sinew::c
