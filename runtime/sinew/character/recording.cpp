#include "sinew/character/recording.h"

#include <algorithm>
#include <cstring>

#include "sinew/character/snapshot.h"

namespace sinew {
namespace {

// A recording is a row of chunks, each a size and that many bytes: the state at the start; then, for every
// step, its h, the state before it where the host changed it (otherwise empty), the inputs, and the state
// after it.

void append(std::vector<std::byte>& out, std::span<const std::byte> chunk) {
  const std::uint32_t size = static_cast<std::uint32_t>(chunk.size());
  const auto* bytes = reinterpret_cast<const std::byte*>(&size);
  out.insert(out.end(), bytes, bytes + sizeof size);
  out.insert(out.end(), chunk.begin(), chunk.end());
}

/// Takes the next chunk off the front; false where the bytes end before it does.
bool take(std::span<const std::byte>& in, std::span<const std::byte>& chunk) {
  std::uint32_t size = 0;
  if (in.size() < sizeof size) return false;
  std::memcpy(&size, in.data(), sizeof size);
  if (size > in.size() - sizeof size) return false;
  chunk = in.subspan(sizeof size, size);
  in = in.subspan(sizeof size + size);
  return true;
}

template <class T>
void save_to(const World<T>& world, std::vector<std::byte>& out) {
  out.resize(world.snapshot_capacity());
  out.resize(world.save(out));
}

}  // namespace

template <class T>
Recorder<T>::Recorder(World<T>& world) : world_(world) {
  save_to(world_, state_);
  append(bytes_, state_);
}

template <class T>
Status Recorder<T>::step(T h) {
  save_to(world_, before_);
  inputs_.resize(world_.inputs_capacity());
  inputs_.resize(world_.save_inputs(inputs_));
  if (const Status status = world_.step(h); !status) return status;
  append(bytes_, std::as_bytes(std::span(&h, 1)));
  append(bytes_, before_ == state_ ? std::span<const std::byte>{} : before_);
  append(bytes_, inputs_);
  save_to(world_, state_);
  append(bytes_, state_);
  return {};
}

template <class T>
Status replay(World<T>& world, std::span<const std::byte> recording, ReplayReport& report) {
  const Status cut_off = Status::error(Code::kBadFile, "recording is cut off");
  report = {};
  std::span<const std::byte> chunk, before, inputs, after;
  if (!take(recording, chunk)) return cut_off;
  if (const Status status = world.restore(chunk); !status) return status;
  std::vector<std::byte> now;
  while (!recording.empty()) {
    T h = T(0);
    if (!take(recording, chunk) || !take(recording, before) || !take(recording, inputs) ||
        !take(recording, after) || chunk.size() != sizeof h)
      return cut_off;
    std::memcpy(&h, chunk.data(), sizeof h);
    if (!before.empty())
      if (const Status status = world.restore(before); !status) return status;
    if (const Status status = world.restore_inputs(inputs); !status) return status;
    if (const Status status = world.step(h); !status) return status;
    ++report.steps;
    save_to(world, now);
    // The header holds a digest of the rest: what differs is behind it.
    const auto [mine, theirs] =
        std::mismatch(now.begin() + kHeaderBytes, now.end(), after.begin() + kHeaderBytes, after.end());
    if (mine == now.end() && theirs == after.end()) continue;
    report.same = false;
    report.byte = static_cast<std::size_t>(mine - now.begin());
    report.field = world.snapshot_field(report.byte);
    return {};
  }
  return {};
}

SINEW_RECORDING_INSTANCES(template, float)
SINEW_RECORDING_INSTANCES(template, double)

}  // namespace sinew
