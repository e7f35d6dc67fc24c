// Within the C interface: the table of handles, and structs of callers who were compiled with another
// version.
#include <gtest/gtest.h>

#include <thread>
#include <vector>

#include "sinew/c/call.h"

namespace sinew::c {
namespace {

/// A struct that has grown by `added`.
struct Grown {
  std::uint32_t size;
  std::int32_t old, added, more;
};

}  // namespace

template <>
inline constexpr std::uint32_t kFirstSize<Grown> = 8;

namespace {

TEST(Sized, WhatAnOlderCallerDoesNotKnowKeepsItsDefault) {
  Grown all{sizeof(Grown), 1, 2, 3};
  const Grown from{8, 7, 99, 99};
  ASSERT_EQ(read_sized(&from, all), SINEW_OK);
  EXPECT_EQ(all.old, 7);
  EXPECT_EQ(all.added, 2);
}

TEST(Sized, NothingIsWrittenBeyondWhatAnOlderCallerKnows) {
  Grown to{8, 0, 55, 66};
  ASSERT_EQ(fill_sized(&to,
                       [](Grown& g) {
                         g.old = 3;
                         g.added = 4;
                       }),
            SINEW_OK);
  EXPECT_EQ(to.size, 8u);
  EXPECT_EQ(to.old, 3);
  EXPECT_EQ(to.added, 55);
  EXPECT_EQ(to.more, 66);
}

TEST(Sized, LessThanTheFirstVersionAndMoreThanTheLastAreRefused) {
  Grown all{};
  const Grown small{4, 7, 0, 0}, large{sizeof(Grown) + 4, 7, 0, 0};
  EXPECT_EQ(read_sized(&small, all), SINEW_INVALID_ARGUMENT);
  EXPECT_EQ(read_sized(&large, all), SINEW_BAD_VERSION);
  EXPECT_EQ(all.old, 0);
}

TEST(HandleTable, NumbersDoNotComeAgain) {
  int object = 0;
  std::vector<std::uint64_t> seen;
  for (int n = 0; n < 1000; ++n) {
    const std::uint64_t handle = make_handle(Kind::kWorld, &object);
    EXPECT_EQ(find_object(handle, Kind::kWorld), &object);
    EXPECT_EQ(find_object(handle, Kind::kAsset), nullptr);
    EXPECT_EQ(find_object(handle_in(handle, Kind::kProp, 3), Kind::kProp), &object);
    EXPECT_EQ(retire_handle(handle, Kind::kWorld), &object);
    EXPECT_EQ(retire_handle(handle, Kind::kWorld), nullptr);
    EXPECT_EQ(find_object(handle_in(handle, Kind::kProp, 3), Kind::kProp), nullptr);
    EXPECT_EQ(std::count(seen.begin(), seen.end(), handle), 0);
    seen.push_back(handle);
  }
}

TEST(HandleTable, IsFullAt65535AndHasRoomAgainAfterwards) {
  int object = 0;
  std::vector<std::uint64_t> handles;
  for (std::uint64_t h = 0; (h = make_handle(Kind::kAsset, &object)) != 0;) handles.push_back(h);
  EXPECT_EQ(handles.size(), 65535u);
  ASSERT_NE(retire_handle(handles[77], Kind::kAsset), nullptr);
  handles[77] = make_handle(Kind::kAsset, &object);
  EXPECT_NE(handles[77], 0u);
  for (const std::uint64_t h : handles) EXPECT_EQ(retire_handle(h, Kind::kAsset), &object);
}

TEST(HandleTable, OneOfTwoThreadsThatDestroyGetsTheObject) {
  int object = 0;
  for (int n = 0; n < 100; ++n) {
    const std::uint64_t handle = make_handle(Kind::kWorld, &object);
    void* got[2] = {};
    std::thread other([&] { got[0] = retire_handle(handle, Kind::kWorld); });
    got[1] = retire_handle(handle, Kind::kWorld);
    other.join();
    EXPECT_NE(got[0] == nullptr, got[1] == nullptr);
  }
}

TEST(HandleTable, WhatIsInAWorldKnowsItsWorldAndIndex) {
  int object = 0;
  const std::uint64_t world = make_handle(Kind::kWorld, &object);
  const std::uint64_t last = handle_in(world, Kind::kCharacter, (1 << 20) - 1);
  EXPECT_EQ(world_of(last), world);
  EXPECT_EQ(index_of(last), (1 << 20) - 1);
  EXPECT_EQ(retire_handle(world, Kind::kWorld), &object);
}

}  // namespace
}  // namespace sinew::c
