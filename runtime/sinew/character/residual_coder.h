// Numbers that are nearly known, in few bits and without losing one. Internal to the character layer.
//
// A number is written as its distance, in representable numbers, from a prediction that the reader can make
// too; distances by a Golomb–Rice code whose parameter follows the ones before (Rice & Plaunt, "Adaptive
// variable-length coding for efficient compression of spacecraft television data", 1971). A prediction that
// is right to the bit costs one bit, one that is good for nothing about three bits more than the number.
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <type_traits>

#include "sinew/character/snapshot.h"

namespace sinew {

/// Codes one field: a run of numbers of a kind, from the next whole byte on, to a whole byte.
template <class V>
class ResidualCoder {
 public:
  /// `marks`: numbers may be random or exactly as predicted, so that each has a bit that says so.
  ResidualCoder(const char* name, ByteStream& stream, bool marks = false)
      : name_(name), stream_(stream), marks_(marks) {}
  ResidualCoder(const ResidualCoder&) = delete;
  ResidualCoder& operator=(const ResidualCoder&) = delete;
  ~ResidualCoder() {
    if (!stream_.reading() && filled_ > 0) emit();
  }

  void value(V& v, V predicted) {
    const Bits from = ordered(predicted);
    if (stream_.reading()) {
      const Bits z = get();
      v = number(from + ((z >> 1) ^ (Bits(0) - (z & 1))));
    } else {
      const Bits d = ordered(v) - from;
      put((d << 1) ^ (Bits(0) - (d >> (kWidth - 1))));
    }
  }
  template <class Vector>
  void values(Vector& v, const Vector& predicted) {
    for (Eigen::Index n = 0; n < v.size(); ++n) value(v.data()[n], predicted.data()[n]);
  }

 private:
  using Bits = std::conditional_t<sizeof(V) == 4, std::uint32_t, std::uint64_t>;
  static constexpr int kWidth = 8 * sizeof(V);
  static constexpr int kLongest = 8;  ///< of the unary part; beyond, all bits follow

  /// In the order of the numbers.
  static Bits ordered(V v) {
    const auto bits = std::bit_cast<Bits>(v);
    if constexpr (std::is_integral_v<V>) return bits;
    constexpr Bits sign = Bits(1) << (kWidth - 1);
    return bits & sign ? ~bits : bits | sign;
  }
  static V number(Bits in_order) {
    if constexpr (std::is_integral_v<V>) return V(in_order);
    constexpr Bits sign = Bits(1) << (kWidth - 1);
    return std::bit_cast<V>(in_order & sign ? in_order ^ sign : ~in_order);
  }

  /// Bits of the binary part: the mean length of what came so far.
  int parameter() const { return mean_ < 0 ? kWidth / 2 : std::min(mean_ / 16, kWidth - 1); }
  void learn(Bits z) {
    const int length = 16 * static_cast<int>(std::bit_width(z));
    mean_ = mean_ < 0 ? length : mean_ + (length - mean_) / 4;
  }

  void put(Bits z) {
    if (marks_) put_bits(z == 0 ? 1 : 0, 1);
    if (marks_ && z == 0 && !stream_.bounding()) return;
    const int k = parameter();
    const Bits q = z >> k;
    if (q < Bits(kLongest) && !stream_.bounding()) {
      put_bits((Bits(2) << q) - 2, static_cast<int>(q) + 1);
      put_bits(k == 0 ? 0 : z & (~Bits(0) >> (kWidth - k)), k);
    } else {
      put_bits((Bits(1) << kLongest) - 1, kLongest);
      put_bits(z, kWidth);
    }
    learn(z);
  }
  Bits get() {
    if (marks_ && get_bits(1) != 0) return 0;
    const int k = parameter();
    int q = 0;
    while (q < kLongest && get_bits(1) != 0) ++q;
    const Bits low = get_bits(q < kLongest ? k : kWidth);
    const Bits z = q < kLongest ? Bits(Bits(q) << k) | low : low;
    learn(z);
    return z;
  }
  /// The lowest so many, the highest of them first.
  void put_bits(Bits bits, int count) {
    while (count > 0) {
      const int part = std::min(count, 8 - filled_);
      const auto next = static_cast<unsigned>(bits >> (count - part)) & ((1u << part) - 1);
      byte_ = static_cast<std::uint8_t>(unsigned(byte_) << part | next);
      filled_ += part;
      count -= part;
      if (filled_ == 8) emit();
    }
  }
  void emit() {
    byte_ = static_cast<std::uint8_t>(unsigned(byte_) << (8 - filled_));
    stream_.value(name_, byte_);
    byte_ = 0;
    filled_ = 0;
  }
  Bits get_bits(int count) {
    Bits bits = 0;
    while (count > 0) {
      if (filled_ == 0) {
        byte_ = 0;  // where the stream ends
        stream_.value(name_, byte_);
        filled_ = 8;
      }
      const int part = std::min(count, filled_);
      filled_ -= part;
      bits = static_cast<Bits>(bits << part) | ((unsigned(byte_) >> filled_) & ((1u << part) - 1));
      count -= part;
    }
    return bits;
  }

  const char* name_;
  ByteStream& stream_;
  bool marks_;
  int mean_ = -1;   ///< sixteenths of a bit; below 0: of none yet
  int filled_ = 0;  ///< bits of `byte_` that are written, or still to be read
  std::uint8_t byte_ = 0;
};

/// What the last member of a unit quaternion is, going by the others, on the side of `like`.
template <class T>
T last_of(const Quat<T>& q, const Quat<T>& like) {
  return std::copysign(std::sqrt(std::max(T(1) - q.vec().squaredNorm(), T(0))), like.w());
}

}  // namespace sinew
