#include "sinew/animation/clip_packing.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <random>

namespace sinew {
namespace {

constexpr unsigned kSeed = 20261125;

/// Tracks of every kind, their numbers a random walk.
Clip::Group random_group(bool rotation, int knots, std::mt19937& random) {
  Clip::Group group;
  group.rotation = rotation;
  group.control_count = knots;
  constexpr int kTracks = 5;
  std::int32_t numbers[kTracks][4] = {};
  for (int k = 0; k < kTracks; ++k) {
    Clip::Packing packing;
    packing.step = std::uint8_t(40 + random() % 20);  // rotations within a turn of their reference
    packing.components = rotation && k % 2 == 1 ? 4 : 3;
    if (rotation && packing.components == 3)
      for (std::int8_t& r : packing.reference) r = std::int8_t(int(random() % 200) - 100);
    group.tracks.push_back({int(random() % 60000)});
    group.packings.push_back(packing);
    for (std::int32_t& number : numbers[k]) number = int(random() % 2001) - 1000;
  }
  for (int knot = 0; knot < knots; ++knot)
    for (int k = 0; k < kTracks; ++k) {
      const int stride = 1 << (2 * k);
      for (std::int32_t& number : numbers[k]) number += int(random() % (2 * stride + 1)) - stride;
      float control[4];
      unpack_control(group.packings[k], rotation, numbers[k], control);
      group.controls.insert(group.controls.end(), control, control + (rotation ? 4 : 3));
    }
  return group;
}

Clip::Group unpacked(const std::vector<std::uint8_t>& bytes, const Clip::Group& like, Status& status) {
  Clip::Group out;
  out.rotation = like.rotation;
  out.control_count = like.control_count;
  status = unpack_group(bytes, out);
  return out;
}

TEST(ClipPacking, GivesEveryBitBack) {
  std::printf("seed %u\n", kSeed);
  std::mt19937 random(kSeed);
  for (int n = 0; n < 200; ++n) {
    const Clip::Group group = random_group(n % 2 == 0, 10 + int(random() % 100), random);
    std::vector<std::uint8_t> bytes;
    ASSERT_TRUE(pack_group(group, bytes)) << n;
    Status status;
    const Clip::Group back = unpacked(bytes, group, status);
    ASSERT_TRUE(status.ok()) << status.reason;
    EXPECT_EQ(back.controls, group.controls) << n;
    for (std::size_t k = 0; k < group.tracks.size(); ++k) {
      EXPECT_EQ(back.tracks[k].joint, group.tracks[k].joint);
      EXPECT_EQ(back.packings[k].step, group.packings[k].step);
    }
    std::vector<std::uint8_t> again;
    ASSERT_TRUE(pack_group(back, again));
    EXPECT_EQ(again, bytes);
  }
}

TEST(ClipPacking, RefusesControlsThatAreNoWholeNumbers) {
  std::mt19937 random(kSeed);
  const Clip::Group good = random_group(true, 20, random);
  std::vector<std::uint8_t> bytes;
  Clip::Group group = good;
  group.controls[33] = std::nextafter(group.controls[33], 10.f);
  EXPECT_FALSE(pack_group(group, bytes));
  EXPECT_TRUE(bytes.empty());
  group = good;
  group.controls[0] = NAN;
  EXPECT_FALSE(pack_group(group, bytes));
  group = good;
  group.packings[2].step = kPackingSteps;
  EXPECT_FALSE(pack_group(group, bytes));
  group = good;
  group.packings.clear();
  EXPECT_FALSE(pack_group(group, bytes));
}

/// Bytes bound what they can ask for: a bit of a Golomb–Rice code says at most one number, sixteen bytes.
TEST(ClipPacking, DamagedBytesAreRefusedOrHarmless) {
  std::printf("seed %u\n", kSeed);
  std::mt19937 random(kSeed);
  int refused = 0;
  for (int n = 0; n < 5000; ++n) {
    const Clip::Group group = random_group(n % 2 == 0, 10 + int(random() % 30), random);
    std::vector<std::uint8_t> bytes;
    ASSERT_TRUE(pack_group(group, bytes));
    if (n % 3 == 0) bytes.resize(random() % bytes.size());
    for (unsigned k = random() % 4; k > 0 && !bytes.empty(); --k)
      bytes[random() % bytes.size()] = std::uint8_t(random());
    Clip::Group like = group;
    if (n % 5 == 0) like.control_count = int(random()) / 2;
    Status status;
    const Clip::Group back = unpacked(bytes, like, status);
    refused += status.ok() ? 0 : 1;
    EXPECT_LE(back.controls.size() * sizeof(float), 128 * bytes.size());
    for (const float control : back.controls) EXPECT_TRUE(!status.ok() || std::isfinite(control));
  }
  EXPECT_GT(refused, 1600);  // all that were cut short
}

TEST(ClipPacking, SmoothCurvesTakeFewBits) {
  std::vector<std::int32_t> smooth, still(200, -1234);
  for (int i = 0; i < 200; ++i) smooth.push_back(int(std::lround(3000 * std::sin(0.05 * i))));
  // Third differences of a sine of amplitude 3000 are below 3000 · 0.05³ = 0.4 but for the rounding, whose
  // own are of the order of 2: four bits. Thirteen are its range.
  EXPECT_LT(double(packed_bits(smooth)) / 200, 4.5);
  EXPECT_LT(packed_bits(still), 32u);
}

}  // namespace
}  // namespace sinew
