#include "sinew/c/handle.h"

#include <array>
#include <atomic>

namespace sinew::c {
namespace {

constexpr int kIndexBits = 20, kSerialBits = 24, kSlotBits = 16;
static_assert(kMostInWorld == 1u << kIndexBits);
constexpr int kSerialAt = kIndexBits, kSlotAt = kSerialAt + kSerialBits, kKindAt = kSlotAt + kSlotBits;
constexpr std::uint32_t kSlots = 1u << kSlotBits, kLastSerial = (1u << kSerialBits) - 1;

constexpr std::uint64_t field(std::uint64_t handle, int at, int bits) {
  return handle >> at & ((std::uint64_t(1) << bits) - 1);
}

/// The world's, asset's or graph's own handle, without what in it is meant; that is what a slot is labelled
/// with.
constexpr std::uint64_t label(Kind owner, std::uint32_t slot, std::uint32_t serial) {
  return std::uint64_t(owner) << kKindAt | std::uint64_t(slot) << kSlotAt |
         std::uint64_t(serial) << kSerialAt;
}

/// What has a slot of its own; all else is in a world.
constexpr bool is_owner(Kind kind) {
  return kind == Kind::kAsset || kind == Kind::kGraph || kind == Kind::kWorld;
}

constexpr Kind owner_of(Kind kind) {
  return is_owner(kind) ? kind : Kind::kWorld;
}

constexpr Kind kind_of(std::uint64_t handle) {
  return Kind(handle >> kKindAt);
}

constexpr std::uint64_t owner_handle(std::uint64_t handle, Kind owner) {
  return label(owner, std::uint32_t(field(handle, kSlotAt, kSlotBits)),
               std::uint32_t(field(handle, kSerialAt, kSerialBits)));
}

struct Slot {
  std::atomic<std::uint64_t> label{0};  ///< 0: free
  std::atomic<void*> object{nullptr};
};

/// Memory that is not touched before it is used.
struct Table {
  std::array<Slot, kSlots> slots;
  std::array<std::uint32_t, kSlots> serial;  ///< last used
  std::array<std::uint16_t, kSlots> next;    ///< in the list of slots that were given back; 0 ends it
  std::atomic_flag taken;                    ///< by who makes or destroys something
  std::uint32_t fresh = 1, free = 0;         ///< the first never used; the list's first. Slot 0 is never used
};

constinit Table table{};

/// The table for a few instructions: who comes meanwhile turns round. Unlike a mutex there when programs
/// start, with every C++ library.
class Changing {
 public:
  Changing() {
    while (table.taken.test_and_set(std::memory_order_acquire)) {
    }
  }
  ~Changing() { table.taken.clear(std::memory_order_release); }
  Changing(const Changing&) = delete;
  Changing& operator=(const Changing&) = delete;
};

}  // namespace

std::uint64_t make_handle(Kind owner, void* object) {
  const Changing change;
  std::uint32_t slot = table.free;
  if (slot != 0)
    table.free = table.next[slot];
  else if (table.fresh < kSlots)
    slot = table.fresh++;
  else
    return 0;
  const std::uint64_t handle = label(owner, slot, ++table.serial[slot]);
  table.slots[slot].object.store(object, std::memory_order_relaxed);
  table.slots[slot].label.store(handle, std::memory_order_release);
  return handle;
}

void* find_object(std::uint64_t handle, Kind kind) noexcept {
  if (kind_of(handle) != kind || (is_owner(kind) && index_of(handle) != 0)) return nullptr;
  const Slot& slot = table.slots[std::size_t(field(handle, kSlotAt, kSlotBits))];
  if (slot.label.load(std::memory_order_acquire) != owner_handle(handle, owner_of(kind))) return nullptr;
  return slot.object.load(std::memory_order_relaxed);
}

void* retire_handle(std::uint64_t handle, Kind owner) {
  const Changing change;
  void* const object = find_object(handle, owner);
  if (!object) return nullptr;
  const auto slot = std::uint32_t(field(handle, kSlotAt, kSlotBits));
  table.slots[slot].label.store(0, std::memory_order_release);
  table.slots[slot].object.store(nullptr, std::memory_order_relaxed);
  if (table.serial[slot] == kLastSerial) return object;  // never to be used again
  table.next[slot] = static_cast<std::uint16_t>(table.free);
  table.free = slot;
  return object;
}

std::uint64_t handle_in(std::uint64_t world, Kind kind, int index) noexcept {
  const std::uint64_t place = owner_handle(world, Kind::kNone);
  return place | std::uint64_t(kind) << kKindAt | std::uint64_t(index);
}

std::uint64_t world_of(std::uint64_t handle) noexcept {
  return owner_handle(handle, Kind::kWorld);
}

int index_of(std::uint64_t handle) noexcept {
  return static_cast<int>(field(handle, 0, kIndexBits));
}

const char* why_not(std::uint64_t handle, Kind kind) noexcept {
  if (handle == 0) return "the handle is 0, which names nothing";
  if (kind_of(handle) != kind) return "the handle is of another kind";
  return "the handle names something that was destroyed, or never was";
}

}  // namespace sinew::c
