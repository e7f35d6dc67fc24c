// Where the library's memory comes from. With the C++ library within it (SINEW_OWN_MEMORY) this operator new
// is the one that all of it uses, and nobody else does: the version script keeps it inside.
#include <atomic>
#include <cstddef>
#include <cstdlib>
#include <new>

#include "sinew/c/call.h"

namespace sinew::c {
namespace {

struct Memory {
  sinew_allocate allocate = nullptr;  ///< null: the system's
  sinew_release release = nullptr;
  void* context = nullptr;
};

constinit Memory memory;
constinit std::atomic<std::size_t> blocks{0};

#ifdef SINEW_OWN_MEMORY
constexpr bool kOwn = true;

void* take(std::size_t bytes, std::size_t alignment) {
  bytes += bytes == 0;
  // aligned_alloc wants a multiple of the alignment.
  void* const taken = memory.allocate
                          ? memory.allocate(memory.context, bytes, alignment)
                          : std::aligned_alloc(alignment, (bytes + alignment - 1) / alignment * alignment);
  if (!taken) throw std::bad_alloc();
  blocks.fetch_add(1, std::memory_order_relaxed);
  return taken;
}

void give_back(void* taken) noexcept {
  if (!taken) return;
  blocks.fetch_sub(1, std::memory_order_relaxed);
  if (memory.release)
    memory.release(memory.context, taken);
  else
    std::free(taken);
}
#else
constexpr bool kOwn = false;
#endif

}  // namespace
}  // namespace sinew::c

// The other forms, of arrays and those that do not throw, call these.
#ifdef SINEW_OWN_MEMORY
void* operator new(std::size_t bytes) {
  return sinew::c::take(bytes, alignof(std::max_align_t));
}
void* operator new(std::size_t bytes, std::align_val_t alignment) {
  return sinew::c::take(bytes, static_cast<std::size_t>(alignment));
}
void operator delete(void* taken) noexcept {
  sinew::c::give_back(taken);
}
void operator delete(void* taken, std::size_t /*bytes*/) noexcept {
  sinew::c::give_back(taken);
}
void operator delete(void* taken, std::align_val_t /*alignment*/) noexcept {
  sinew::c::give_back(taken);
}
void operator delete(void* taken, std::size_t /*bytes*/, std::align_val_t /*alignment*/) noexcept {
  sinew::c::give_back(taken);
}
#endif

using namespace sinew::c;

sinew_status sinew_set_memory(sinew_allocate allocate, sinew_release release, void* context) {
  if (!kOwn) return fail(SINEW_UNSUPPORTED, "the C++ library is not within this one: replace operator new");
  if ((allocate != nullptr) != (release != nullptr))
    return fail(SINEW_INVALID_ARGUMENT, "memory needs both functions, or none");
  if (blocks.load(std::memory_order_relaxed) > 0)
    return fail(SINEW_INVALID_ARGUMENT, "the library has memory: destroy its assets and worlds first");
  memory = {allocate, release, context};
  return SINEW_OK;
}

size_t sinew_memory_blocks(void) {
  return blocks.load(std::memory_order_relaxed);
}
