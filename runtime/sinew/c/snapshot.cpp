// Snapshots and recordings of the C interface.
#include <climits>
#include <span>

#include "sinew/c/call.h"

namespace sinew::c {
namespace {

constexpr const char* kNoPart = "a snapshot is of the state or of the inputs";

bool is_part(sinew_snapshot_part part) {
  return part == SINEW_SNAPSHOT_STATE || part == SINEW_SNAPSHOT_INPUTS;
}

/// act(OwnedWorld&) in a world that can be recorded.
template <class Act>
sinew_status with_recorded(sinew_world world, Act&& act, bool breaks = false) noexcept {
  return in_world(world, Kind::kWorld, breaks, [&](OwnedWorld& w) {
    return w.crowd ? fail(SINEW_UNSUPPORTED, "a world with a crowd is not recorded") : act(w);
  });
}

/// Bytes written, 0 where there is no room; at most how many.
std::size_t save_state(OwnedWorld& w, std::span<std::byte> out) {
  if (!w.crowd) return w.world.save(out);
  std::size_t written = 0;
  return w.crowd->save(w.crowd_asset->clips, out, written) ? written : 0;
}
std::size_t state_capacity(const OwnedWorld& w) {
  return w.crowd ? w.crowd->snapshot_capacity() : w.world.snapshot_capacity();
}
Status restore_state(OwnedWorld& w, std::span<const std::byte> from) {
  return w.crowd ? w.crowd->restore(w.crowd_asset->clips, from) : w.world.restore(from);
}

std::span<const std::byte> bytes_of(const void* bytes, std::size_t size) {
  return {static_cast<const std::byte*>(bytes), size};
}

}  // namespace
}  // namespace sinew::c

using namespace sinew;
using namespace sinew::c;

sinew_status sinew_world_save(sinew_world world, sinew_snapshot_part part, void* out, size_t capacity,
                              size_t* size) {
  return with_world(world, [&](OwnedWorld& w) {
    if (!size || (!out && capacity != 0)) return fail(SINEW_INVALID_ARGUMENT, kNull);
    if (!is_part(part)) return fail(SINEW_INVALID_ARGUMENT, kNoPart, part);
    const bool state = part == SINEW_SNAPSHOT_STATE;
    const std::span<std::byte> room(static_cast<std::byte*>(out), capacity);
    std::size_t written = 0;
    if (out) written = state ? save_state(w, room) : w.world.save_inputs(room);
    *size = written;
    if (written > 0) return sinew_status(SINEW_OK);
    *size = state ? state_capacity(w) : w.world.inputs_capacity();
    return fail(SINEW_TOO_SMALL, "room for fewer bytes than the snapshot may have");
  });
}

sinew_status sinew_world_restore(sinew_world world, sinew_snapshot_part part, const void* bytes,
                                 size_t size) {
  return with_world(world, [&](OwnedWorld& w) {
    if (!bytes) return fail(SINEW_INVALID_ARGUMENT, kNull);
    if (!is_part(part)) return fail(SINEW_INVALID_ARGUMENT, kNoPart, part);
    const std::span<const std::byte> from = bytes_of(bytes, size);
    return answer(part == SINEW_SNAPSHOT_STATE ? restore_state(w, from) : w.world.restore_inputs(from));
  });
}

sinew_status sinew_world_get_snapshot_field(sinew_world world, uint64_t byte, sinew_snapshot_field* out) {
  return with_world(world, [&](const OwnedWorld& w) {
    if (!out) return fail(SINEW_INVALID_ARGUMENT, kNull);
    if (w.crowd) return fail(SINEW_UNSUPPORTED, "fields of a crowd's snapshots have no names");
    const SnapshotField field = w.world.snapshot_field(std::size_t(byte));
    *out = {field.state, 0, field.name};
    return sinew_status(SINEW_OK);
  });
}

sinew_status sinew_world_record(sinew_world world, int32_t begin) {
  return with_recorded(world, [&](OwnedWorld& w) {
    w.recorder = begin != 0 ? std::make_unique<Recorder<float>>(w.world) : nullptr;
    return sinew_status(SINEW_OK);
  });
}

sinew_status sinew_world_get_recording(sinew_world world, sinew_view* out) {
  return with_recorded(world, [&](OwnedWorld& w) {
    if (!out) return fail(SINEW_INVALID_ARGUMENT, kNull);
    if (!w.recorder) return fail(SINEW_INVALID_ARGUMENT, "the world is not recorded");
    const std::span<const std::byte> bytes = w.recorder->bytes();
    if (bytes.size() > INT32_MAX) return fail(SINEW_OUT_OF_RANGE, "a recording of more than 2 GiB");
    *out = {bytes.data(), static_cast<int32_t>(bytes.size()), 1};
    return sinew_status(SINEW_OK);
  });
}

sinew_status sinew_world_replay(sinew_world world, const void* bytes, size_t size, sinew_replay_report* out) {
  const auto replayed = [&](OwnedWorld& w) {
    if (!bytes) return fail(SINEW_INVALID_ARGUMENT, kNull);
    if (const sinew_status s = check_size(out); s != SINEW_OK) return s;
    if (w.recorder) return fail(SINEW_INVALID_ARGUMENT, "the world is being recorded itself");
    ReplayReport report;
    if (const Status status = replay(w.world, bytes_of(bytes, size), report); !status) return answer(status);
    w.feel();  // of the last step: what the others told is recorded
    return fill_sized(out, [&](sinew_replay_report& r) {
      r.steps = report.steps;
      r.same = report.same;
      r.differing_body = report.field.state;
      r.byte = report.byte;
      r.field = report.field.name;
    });
  };
  return with_recorded(world, replayed, true);
}
