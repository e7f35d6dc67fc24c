// All memory of the runtime comes from operator new, which a program may replace. Every call of the C heap's
// functions out of this program's objects, the runtime's among them, is counted (the linker's --wrap).
#include <cstdlib>

#include "character/scenes.h"
#include "fixtures/counting_new.h"

namespace {

long taken = 0;

}  // namespace

// The names are the linker's.
// NOLINTBEGIN(bugprone-reserved-identifier)
extern "C" {
void* __real_malloc(std::size_t bytes);
void* __real_calloc(std::size_t count, std::size_t bytes);
void* __real_realloc(void* memory, std::size_t bytes);
void* __real_aligned_alloc(std::size_t alignment, std::size_t bytes);
int __real_posix_memalign(void** out, std::size_t alignment, std::size_t bytes);

void* __wrap_malloc(std::size_t bytes) {
  ++taken;
  return __real_malloc(bytes);
}
void* __wrap_calloc(std::size_t count, std::size_t bytes) {
  ++taken;
  return __real_calloc(count, bytes);
}
void* __wrap_realloc(void* memory, std::size_t bytes) {
  ++taken;
  return __real_realloc(memory, bytes);
}
void* __wrap_aligned_alloc(std::size_t alignment, std::size_t bytes) {
  ++taken;
  return __real_aligned_alloc(alignment, bytes);
}
int __wrap_posix_memalign(void** out, std::size_t alignment, std::size_t bytes) {
  ++taken;
  return __real_posix_memalign(out, alignment, bytes);
}
}
// NOLINTEND(bugprone-reserved-identifier)

namespace sinew {
namespace {

using fixtures::allocations;

TEST(Heap, WhatTheProgramTakesItselfIsCounted) {
  const long before = taken;
  void* const memory = std::malloc(100);
  EXPECT_NE(memory, nullptr);
  EXPECT_EQ(taken - before, 1);
  std::free(memory);
}

TEST(Heap, OfTheRuntimeIsOperatorNewsAlone) {
  const long before = taken, by_new = allocations;
  {
    fixtures::Limp<float> fall({}, 0.3, 3, 5);
    fixtures::Playing<double> play;
    Status status;
    PropSettings box;
    box.shape = Shape::kBox;
    ASSERT_EQ(fall.world.add_prop(box, status), 0) << status.reason;
    LoopSettings rope;
    rope.kind = LoopKind::kRope;
    rope.a.kind = AnchorKind::kCharacter;
    rope.b.kind = AnchorKind::kProp;
    rope.length = 5;
    ASSERT_EQ(fall.world.add_loop(rope, status), 0) << status.reason;
    for (int n = 0; n < 60; ++n) ASSERT_TRUE(fall.world.step(1 / 60.f));
    std::vector<std::byte> snapshot(fall.world.snapshot_capacity());
    ASSERT_GT(fall.world.save(snapshot), 0u);
  }
  EXPECT_GT(allocations - by_new, 100);
  EXPECT_EQ(taken - before, allocations - by_new);
}

}  // namespace
}  // namespace sinew
