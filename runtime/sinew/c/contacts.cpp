// Contact events of the C interface.
#include <algorithm>

#include "sinew/c/body.h"
#include "sinew/c/call.h"
#include "sinew/c/fields.h"

namespace sinew::c {
namespace {

static_assert(int(ContactPhase::kBegin) == SINEW_CONTACT_BEGIN &&
              int(ContactPhase::kStay) == SINEW_CONTACT_STAY && int(ContactPhase::kEnd) == SINEW_CONTACT_END);
static_assert(std::size(sinew_contact_event{}.point) == ContactEvent::kMostPoints);

struct Settings {
  ContactReportSettings report;
  int capacity = 256;  ///< a few characters that fall
};

constexpr auto kSettings = [](auto& c, auto& s, auto&& f) {
  f("capacity must be 1 to 1048576", c.capacity, s.capacity, 1, 1 << 20);
  f("", c.begin, s.report.begin);
  f("", c.stay, s.report.stay);
  f("", c.end, s.report.end);
  f("", c.animated, s.report.animated);
  f("animated_reach must be 0 to 1000 m", c.animated_reach, s.report.animated_reach, 0, 1e3);
};

void copy(const Vec3<double>& from, double (&to)[3]) {
  for (int k = 0; k < 3; ++k) to[k] = from[k];
}

sinew_contact_event event_of(const ContactEvent& from) {
  sinew_contact_event to{};
  to.phase = static_cast<sinew_contact_phase>(from.phase);
  to.solved = from.solved;
  to.a = body_of(from.a);
  to.b = body_of(from.b);
  to.points = from.points;
  to.kept = from.kept;
  to.impulse = from.impulse;
  copy(from.normal, to.normal);
  for (std::size_t k = 0; k < from.point.size(); ++k) {
    const TouchPoint& point = from.point[k];
    copy(point.position, to.point[k].position);
    copy(point.normal, to.point[k].normal);
    copy(point.friction, to.point[k].friction);
    to.point[k].impulse = point.impulse;
    to.point[k].force = point.force;
    to.point[k].depth = point.depth;
  }
  return to;
}

sinew_status stop_reports(OwnedWorld& world) {
  const Status status = report_contacts<float>(world.world, nullptr);
  world.ring.reset();
  world.waiting.clear();
  return answer(status);
}

sinew_status start_reports(OwnedWorld& world, const Settings& settings) {
  if (const sinew_status status = stop_reports(world); status != SINEW_OK) return status;
  world.waiting.resize(std::size_t(settings.capacity));
  world.ring.emplace(world.waiting);
  const Status status = report_contacts(world.world, &*world.ring, settings.report);
  if (!status) world.ring.reset();
  return answer(status);
}

}  // namespace
}  // namespace sinew::c

using namespace sinew;
using namespace sinew::c;

sinew_status sinew_contact_settings_init(sinew_contact_settings* settings) {
  return init<Settings>(settings, kSettings);
}

sinew_status sinew_world_report_contacts(sinew_world world, const sinew_contact_settings* settings) {
  return set_up(world, [&](OwnedWorld& w) {
    if (!settings) return stop_reports(w);
    Settings read;
    const sinew_status status = read_settings(settings, read, kSettings);
    return status == SINEW_OK ? start_reports(w, read) : status;
  });
}

sinew_status sinew_world_take_contacts(sinew_world world, sinew_contact_event* out, int32_t capacity,
                                       int32_t* count, uint64_t* dropped) {
  return with_world(world, [&](OwnedWorld& w) {
    if (!count || (!out && capacity != 0)) return fail(SINEW_INVALID_ARGUMENT, kNull);
    if (capacity < 0) return fail(SINEW_INVALID_ARGUMENT, "the capacity is negative");
    if (!w.ring) return fail(SINEW_INVALID_ARGUMENT, "the world reports no contacts");
    int32_t taken = 0;
    for (ContactEvent event; taken < capacity && w.ring->take(event); ++taken) out[taken] = event_of(event);
    *count = taken;
    if (dropped) *dropped = w.ring->dropped();
    return sinew_status(SINEW_OK);
  });
}
