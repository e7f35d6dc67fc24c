#include "sinew/crowd/roll.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstring>

#include "sinew/skeleton/digest.h"

namespace sinew {
namespace {

constexpr std::uint64_t kRoll = 0x3130304c4c4f5257;  // WROLL001

struct Header {
  std::uint64_t content = kRoll;
  std::uint64_t digest = 0;  ///< of what follows
  std::uint32_t entries = 0, places = 0, free = 0;
  std::int32_t turned_away = 0;
};
static_assert(sizeof(Header) == 32);

/// What the digest is of.
template <class Bytes>
Bytes checked(Bytes of_roll) {
  return of_roll.subspan(offsetof(Header, entries));
}

bool is_finite(const RollEntry& e) {
  const auto finite = [](auto x) { return std::isfinite(x); };
  return finite(e.time) && finite(e.rate) && finite(e.change) && e.strength >= 0 &&
         std::all_of(std::begin(e.place), std::end(e.place), finite);
}

/// Every place of the world is free or somebody's, once. Who has one plays something.
bool shares_out(Roll& roll, std::size_t places) {
  roll.taken.assign(places, 0);
  std::size_t count = 0;
  const auto take = [&](std::int32_t place) {
    if (place < 0 || std::size_t(place) >= places || roll.taken[std::size_t(place)]) return false;
    roll.taken[std::size_t(place)] = 1;
    ++count;
    return true;
  };
  if (!std::all_of(roll.free.begin(), roll.free.end(), take)) return false;
  for (const RollEntry& e : roll.entries)
    if (e.world >= 0 && (e.clip < 0 || !take(e.world))) return false;
  return count == places;
}

}  // namespace

std::size_t roll_bytes(std::size_t capacity, std::size_t places) {
  return sizeof(Header) + capacity * sizeof(RollEntry) + places * sizeof(std::int32_t);
}

void write_roll(const Roll& roll, std::size_t places, std::span<std::byte> out) {
  Header header;
  header.entries = static_cast<std::uint32_t>(roll.entries.size());
  header.places = static_cast<std::uint32_t>(places);
  header.free = static_cast<std::uint32_t>(roll.free.size());
  header.turned_away = roll.turned_away;
  const std::size_t entries = roll.entries.size() * sizeof(RollEntry);
  out = out.first(roll_bytes(roll.entries.size(), places));
  std::byte* const body = out.data() + sizeof header;
  std::memset(body + entries, 0, places * sizeof(std::int32_t));
  std::memcpy(body, roll.entries.data(), entries);
  std::memcpy(body + entries, roll.free.data(), roll.free.size() * sizeof(std::int32_t));
  std::memcpy(out.data(), &header, sizeof header);
  header.digest = digest(checked(out));
  std::memcpy(out.data(), &header, sizeof header);
}

Status read_roll(std::span<const std::byte> in, std::size_t places, std::size_t clips, Roll& roll) {
  Header header;
  if (in.size() < sizeof header) return Status::error(Code::kBadFile, "snapshot is cut off");
  std::memcpy(&header, in.data(), sizeof header);
  if (header.content != kRoll) return Status::error(Code::kBadFile, "not a snapshot of a population");
  if (header.entries != roll.entries.size() || header.places != places)
    return Status::error(Code::kInvalidArgument, "snapshot of a population of another size");
  if (in.size() != roll_bytes(roll.entries.size(), places))
    return Status::error(Code::kBadFile, "snapshot is cut off");
  if (header.digest != digest(checked(in)) || header.free > places)
    return Status::error(Code::kBadFile, "snapshot was changed");
  const std::byte* const body = in.data() + sizeof header;
  const std::size_t entries = roll.entries.size() * sizeof(RollEntry);
  std::memcpy(roll.entries.data(), body, entries);
  roll.free.resize(header.free);
  std::memcpy(roll.free.data(), body + entries, header.free * sizeof(std::int32_t));
  roll.turned_away = header.turned_away;
  for (std::size_t n = 0; n < roll.entries.size(); ++n) {
    const RollEntry& entry = roll.entries[n];
    if (entry.clip < -1 || entry.clip >= static_cast<int>(clips))
      return Status::error(Code::kInvalidArgument, "snapshot of a population with other clips", int(n));
    if (!is_finite(entry)) return Status::error(Code::kNotFinite, "snapshot is not finite", int(n));
  }
  return shares_out(roll, places) ? Status{} : Status::error(Code::kBadFile, "snapshot has places twice");
}

}  // namespace sinew
