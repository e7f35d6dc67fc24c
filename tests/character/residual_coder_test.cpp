// Whatever the numbers and the predictions, every bit comes back; good predictions take few.
#include "sinew/character/residual_coder.h"

#include <gtest/gtest.h>

#include <limits>
#include <random>

#include "sinew/skeleton/fewer_digits.h"

namespace sinew {
namespace {

template <class V>
using BitsOf = std::conditional_t<sizeof(V) == 4, std::uint32_t, std::uint64_t>;

/// Bytes written, after checking that reading them gives the same bits.
template <class V>
std::size_t there_and_back(const std::vector<V>& values, const std::vector<V>& predicted, bool runs) {
  std::vector<std::byte> room(16 * values.size() + 16);
  ByteStream out = ByteStream::writer(room), bound = ByteStream::bound();
  for (ByteStream* stream : {&out, &bound}) {
    ResidualCoder<V> coder("values", *stream, runs);
    for (std::size_t n = 0; n < values.size(); ++n) {
      V v = values[n];
      coder.value(v, predicted[n]);
    }
  }
  EXPECT_TRUE(out.ok());
  EXPECT_LE(out.position(), bound.position());
  ByteStream in = ByteStream::reader(std::span(room).first(out.position()));
  {
    ResidualCoder<V> coder("values", in, runs);
    for (std::size_t n = 0; n < values.size(); ++n) {
      V v{};
      coder.value(v, predicted[n]);
      EXPECT_EQ(std::bit_cast<BitsOf<V>>(v), std::bit_cast<BitsOf<V>>(values[n])) << n;
    }
  }
  EXPECT_TRUE(in.ok());
  EXPECT_EQ(in.position(), out.position());
  return out.position();
}

template <class V>
class Coder : public testing::Test {};
using Numbers = testing::Types<float, double, std::uint32_t, std::uint64_t>;
TYPED_TEST_SUITE(Coder, Numbers);

TYPED_TEST(Coder, GivesBackAnyBitsWhateverThePrediction) {
  std::mt19937_64 random(7);
  std::vector<TypeParam> values, predicted;
  for (int n = 0; n < 2000; ++n) {
    // Random bits, a few of them, or none: NaN with a payload, infinities and both zeros are among them.
    const auto any = [&] {
      const std::uint64_t bits = random() >> (random() % 65 % 64);
      return std::bit_cast<TypeParam>(static_cast<BitsOf<TypeParam>>(bits));
    };
    values.push_back(any());
    predicted.push_back(n % 3 == 0 ? values.back() : any());
  }
  for (const TypeParam special :
       {std::numeric_limits<TypeParam>::max(), std::numeric_limits<TypeParam>::lowest(),
        std::numeric_limits<TypeParam>::infinity(), TypeParam(-TypeParam(0))}) {
    values.push_back(special);
    predicted.push_back(TypeParam(0));
  }
  there_and_back(values, predicted, false);
  there_and_back(values, predicted, true);
}

TEST(Coder, ExactPredictionsTakeABitEachOrAsARunNextToNothingAndRandomNumbersLittleMoreThanTheirOwn) {
  std::mt19937 random(8);
  std::uniform_real_distribution<float> uniform(-1, 1);
  std::vector<float> values(800), zeros(800, 0.f), near;
  for (float& v : values) v = uniform(random);
  for (const float v : values) near.push_back(v * (1 + 4e-7f));
  EXPECT_LE(there_and_back(values, values, false), 800u / 8 + 8);  // 8: until it has learnt
  EXPECT_LE(there_and_back(values, values, true), 4u);
  EXPECT_LE(there_and_back(values, zeros, false), 800u * 34 / 8);
  EXPECT_LE(there_and_back(values, near, false), 800u);  // 3 to 7 units in the last place: below 8 bits
}

template <class V>
std::size_t unpredicted_there_and_back(std::vector<V> values, bool runs = false,
                                       const std::vector<V>& predicted = {}) {
  const auto visit_all = [&](std::vector<V>& all, ByteStream& stream) {
    ResidualCoder<V>("values", stream, runs).unpredicted([&](const auto& visit) {
      for (std::size_t n = 0; n < all.size(); ++n) visit(all[n], predicted.empty() ? V(0) : predicted[n]);
    });
    return stream.position();
  };
  std::vector<std::byte> room(16 * values.size() + 16);
  std::vector<V> read(values.size());
  ByteStream out = ByteStream::writer(room), bound = ByteStream::bound();
  const std::size_t written = visit_all(values, out);
  EXPECT_TRUE(out.ok());
  EXPECT_LE(written, visit_all(values, bound));
  ByteStream in = ByteStream::reader(std::span(room).first(written));
  EXPECT_EQ(visit_all(read, in), written);
  EXPECT_TRUE(in.ok());
  for (std::size_t n = 0; n < values.size(); ++n)
    EXPECT_EQ(std::bit_cast<BitsOf<V>>(read[n]), std::bit_cast<BitsOf<V>>(values[n])) << n;
  return written;
}

template <class V>
class FloatingCoder : public testing::Test {};
using FloatingNumbers = testing::Types<float, double>;
TYPED_TEST_SUITE(FloatingCoder, FloatingNumbers);

TYPED_TEST(FloatingCoder, GivesBackAnyBitsThatNothingPredicts) {
  std::mt19937_64 random(9);
  std::vector<TypeParam> values{0, -TypeParam(0), std::numeric_limits<TypeParam>::denorm_min(),
                                std::numeric_limits<TypeParam>::infinity(),
                                std::numeric_limits<TypeParam>::lowest()};
  for (int n = 0; n < 2000; ++n)
    values.push_back(std::bit_cast<TypeParam>(static_cast<BitsOf<TypeParam>>(random())));
  std::vector<TypeParam> predicted(values);  // some to the bit, in runs
  for (std::size_t n = 0; n < predicted.size(); ++n)
    if (random() % 4 == 0) predicted[n] = TypeParam(1);
  for (const bool runs : {false, true}) {
    unpredicted_there_and_back(values, runs);
    unpredicted_there_and_back(std::vector<TypeParam>(10, TypeParam(0)), runs);
    unpredicted_there_and_back(std::vector<TypeParam>{}, runs);
  }
  unpredicted_there_and_back(values, true, predicted);
}

TYPED_TEST(FloatingCoder, GivesBackAnyBitsOfWhatIsKnownButForItsSign) {
  std::mt19937_64 random(12);
  std::vector<TypeParam> values, predicted;
  std::normal_distribution<double> normal(0, 20);
  for (int n = 0; n < 400; ++n) {
    values.push_back(n % 7 == 0 ? std::bit_cast<TypeParam>(static_cast<BitsOf<TypeParam>>(random()))
                                : TypeParam(normal(random)));
    predicted.push_back(n % 3 == 0 ? values.back() : n % 3 == 1 ? -values.back() : TypeParam(normal(random)));
  }
  for (const bool runs : {false, true}) {
    std::vector<std::byte> room(1 << 14);
    ByteStream out = ByteStream::writer(room), in = ByteStream::reader(room), bound = ByteStream::bound();
    for (ByteStream* stream : {&out, &in, &bound}) {
      ResidualCoder<TypeParam> coder("values", *stream, runs);
      for (std::size_t n = 0; n < values.size(); ++n) {
        TypeParam v = stream->reading() ? TypeParam(0) : values[n];
        coder.value_but_sign(v, predicted[n]);
        EXPECT_EQ(std::bit_cast<BitsOf<TypeParam>>(v), std::bit_cast<BitsOf<TypeParam>>(values[n])) << n;
      }
    }
    EXPECT_LE(out.position(), bound.position());
    EXPECT_EQ(in.position(), out.position());
  }
}

TYPED_TEST(FloatingCoder, WhatIsRoundedToHalfItsDigitsTakesHalfTheRoom) {
  std::mt19937 random(10);
  std::normal_distribution<double> normal(0, 20);
  std::vector<TypeParam> whole(400), rounded, zeros(400, TypeParam(0));
  for (TypeParam& v : whole) v = TypeParam(normal(random));
  for (const TypeParam v : whole) rounded.push_back(rounded_off<kHalfOfDigits<TypeParam>>(v));
  for (std::size_t n = 0; n < whole.size(); ++n)
    EXPECT_NEAR(double(rounded[n] / whole[n]), 1, sizeof(TypeParam) == 4 ? 2.5e-4 : 1.5e-8);
  const std::size_t saved = 400 * kHalfOfDigits<TypeParam> / 8;
  EXPECT_LE(unpredicted_there_and_back(rounded) + saved, unpredicted_there_and_back(whole) + 2);
  EXPECT_LE(unpredicted_there_and_back(whole), 400 * sizeof(TypeParam));
  EXPECT_LE(unpredicted_there_and_back(zeros, true), 4u);
}

TYPED_TEST(FloatingCoder, RoundedNumbersComeBackWhateverTheirPrediction) {
  std::mt19937 random(11);
  std::normal_distribution<double> normal(0, 20);
  std::vector<std::byte> room(1 << 14);
  std::vector<TypeParam> values, predicted;
  for (int n = 0; n < 400; ++n) {
    values.push_back(rounded_off<kHalfOfDigits<TypeParam>>(TypeParam(normal(random))));
    predicted.push_back(n % 3 ? values.back() * TypeParam(1.001) : TypeParam(normal(random)));
  }
  ByteStream out = ByteStream::writer(room), in = ByteStream::reader(room);
  for (ByteStream* stream : {&out, &in}) {
    ResidualCoder<TypeParam> coder("values", *stream, true, kHalfOfDigits<TypeParam>);
    for (std::size_t n = 0; n < values.size(); ++n) {
      TypeParam v = stream->reading() ? TypeParam(0) : values[n];
      coder.value(v, predicted[n]);
      EXPECT_EQ(v, values[n]) << n;
    }
  }
}

}  // namespace
}  // namespace sinew
