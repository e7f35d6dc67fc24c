// What every function of the C interface goes through: handles found, one call at a time, exceptions caught,
// reasons kept.
#pragma once

#include <atomic>
#include <cstdint>
#include <cstring>
#include <new>

#include "sinew/c/owned.h"
#include "sinew/c/sinew.h"
#include "sinew/skeleton/status.h"

namespace sinew::c {

/// Keeps the reason for sinew_last_reason(); returns `status`. `reason` lives for ever. A reason per thread
/// rather than in a buffer of the caller's: nothing to pass and to size at every call, nothing to do in one
/// that succeeds.
sinew_status fail(sinew_status status, const char* reason, int index = -1) noexcept;
/// The same of what the C++ side answers.
sinew_status answer(const Status& status) noexcept;
sinew_status refuse(std::uint64_t handle, Kind kind) noexcept;
/// Of a call for many: what has just failed, and has been told of, is number `index` of them.
sinew_status failed_at(sinew_status status, int index) noexcept;

constexpr const char* kNull = "a pointer is null";
constexpr const char* kMisaligned = "jets must lie at a multiple of 16 bytes";

/// Calls act() and lets no exception out. `broken`, if any, is set where one came.
template <class Act>
sinew_status caught(Act&& act, bool* broken = nullptr) noexcept {
  try {
    return act();
  } catch (const std::bad_alloc&) {
    if (broken) *broken = true;
    return fail(SINEW_NO_MEMORY, "no memory");
  } catch (...) {
    if (broken) *broken = true;
    return fail(SINEW_NO_MEMORY, "an exception: a container would be too large");
  }
}

/// In something, as long as nobody else is.
class Entry {
 public:
  explicit Entry(std::atomic<bool>& busy)
      : busy_(busy), alone_(!busy.exchange(true, std::memory_order_acquire)) {}
  ~Entry() {
    if (alone_) busy_.store(false, std::memory_order_release);
  }
  Entry(const Entry&) = delete;
  Entry& operator=(const Entry&) = delete;
  bool alone() const { return alone_; }

 private:
  std::atomic<bool>& busy_;
  bool alone_;
};

constexpr const char* kBusy = "another call for this world runs, in another thread or around a callback";

/// act(OwnedWorld&) in the world that `handle`, of that kind, names or is in. `breaks`: an exception leaves
/// it half done.
template <class Act>
sinew_status in_world(std::uint64_t handle, Kind kind, bool breaks, Act&& act) noexcept {
  auto* const world = static_cast<OwnedWorld*>(find_object(handle, kind));
  if (!world) return refuse(handle, kind);
  const Entry entry(world->busy);
  if (!entry.alone()) return fail(SINEW_BUSY, kBusy);
  if (world->broken) return fail(SINEW_BROKEN, "the world ran out of memory while something was added");
  return caught([&] { return act(*world); }, breaks ? &world->broken : nullptr);
}

/// A call that adds nothing.
template <class Act>
sinew_status with_world(sinew_world handle, Act&& act) noexcept {
  return in_world(handle, Kind::kWorld, false, act);
}

/// A call that adds something.
template <class Act>
sinew_status set_up(sinew_world handle, Act&& act) noexcept {
  return in_world(handle, Kind::kWorld, true, act);
}

/// act(OwnedWorld&, Character<float>) of a character.
template <class Act>
sinew_status with_character(sinew_character handle, Act&& act, bool breaks = false) noexcept {
  return in_world(handle, Kind::kCharacter, breaks, [&](OwnedWorld& world) {
    const Character<float> character = world.world.character(index_of(handle));
    return character.valid() ? act(world, character) : refuse(handle, Kind::kCharacter);
  });
}

/// act(OwnedAsset&) of an asset.
template <class Act>
sinew_status with_owned_asset(sinew_asset handle, Act&& act) noexcept {
  auto* const owned = static_cast<OwnedAsset*>(find_object(handle, Kind::kAsset));
  if (!owned) return refuse(handle, Kind::kAsset);
  return caught([&] { return act(*owned); });
}

/// act(const std::shared_ptr<const Asset>&) of an asset, for who keeps it.
template <class Act>
sinew_status with_shared_asset(sinew_asset handle, Act&& act) noexcept {
  return with_owned_asset(handle, [&](const OwnedAsset& owned) { return act(owned.asset); });
}

/// act(const Asset&) of an asset.
template <class Act>
sinew_status with_asset(sinew_asset handle, Act&& act) noexcept {
  return with_shared_asset(handle, [&](const std::shared_ptr<const Asset>& asset) { return act(*asset); });
}

/// act(const std::shared_ptr<const BoundGraph>&) of a graph.
template <class Act>
sinew_status with_graph(sinew_graph handle, Act&& act) noexcept {
  const auto* const owned = static_cast<const OwnedGraph*>(find_object(handle, Kind::kGraph));
  if (!owned) return refuse(handle, Kind::kGraph);
  return caught([&] { return act(owned->bound); });
}

/// Bytes of a struct in the version that brought it. Once it grows: the number that its size was.
template <class S>
inline constexpr std::uint32_t kFirstSize = sizeof(S);

/// Whether the caller's `size` can be meant.
template <class S>
sinew_status check_size(const S* s) noexcept {
  if (!s) return fail(SINEW_INVALID_ARGUMENT, kNull);
  if (s->size < kFirstSize<S>)
    return fail(SINEW_INVALID_ARGUMENT, "the struct's size is not set to its sizeof");
  if (s->size > sizeof(S))
    return fail(SINEW_BAD_VERSION, "the struct is larger than this library's: a newer header");
  return SINEW_OK;
}

/// Copies what a caller of an older version knows of; his size stays.
template <class S>
void write_sized(S from, S* to) noexcept {
  from.size = to->size;
  std::memcpy(to, &from, to->size);
}

/// Lays what a caller knows of over the defaults in `to`; null: nothing.
template <class S>
sinew_status read_sized(const S* from, S& to) noexcept {
  if (!from) return SINEW_OK;
  if (const sinew_status status = check_size(from); status != SINEW_OK) return status;
  std::memcpy(&to, from, from->size);
  return SINEW_OK;
}

/// fill(S&) makes what is written into *out.
template <class S, class Fill>
sinew_status fill_sized(S* out, Fill&& fill) noexcept {
  if (const sinew_status status = check_size(out); status != SINEW_OK) return status;
  S s{};
  fill(s);
  write_sized(s, out);
  return SINEW_OK;
}

inline bool aligned(const void* jets) noexcept {
  return reinterpret_cast<std::uintptr_t>(jets) % 16 == 0;
}

}  // namespace sinew::c
