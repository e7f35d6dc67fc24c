#include "cli/memory.h"

#include <malloc.h>

#include "sinew/character/world.h"

namespace sinew::cli {
namespace {

std::size_t heap_in_use() {
  const struct mallinfo2 now = mallinfo2();
  return now.uordblks + now.hblkhd;
}

/// What stays on the heap for the result of `make`.
template <class Make>
std::size_t heap_of(const Make& make) {
  const std::size_t before = heap_in_use();
  const auto kept = make();
  return heap_in_use() - before;
}

}  // namespace

nlohmann::json memory_of(const Asset& asset) {
  Status status;
  World<float> world({});
  world.add_character(asset.skeleton, {}, status);
  if (!status) return nullptr;
  const std::size_t snapshot = world.snapshot_capacity();
  const WorldMemory memory = world.memory();
  return {{"skeleton", heap_of([&] { return asset.skeleton; })},
          {"clips", heap_of([&] { return asset.clips; })},
          {"rig", memory.rigs},
          {"character", memory.characters},
          {"solving", memory.solving},
          {"snapshot", snapshot}};
}

}  // namespace sinew::cli
