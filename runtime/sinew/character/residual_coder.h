// Numbers that are nearly known, in few bits and without losing one. Internal to the character layer.
//
// A number is written as its distance, in representable numbers, from a prediction that the reader can make
// too: how many bits the distance has, by an exponential Golomb code (Teuhola, "A compression method for
// clustered bit-vectors", 1978) of how far that is from the mean of those before, then those bits. Distances
// of one field differ by powers of two rather than around a mean: a Golomb-Rice code of the distances
// themselves took 9 % more. Where many predictions are right to the bit, runs of those are counted (Elias,
// "Universal codeword sets", 1975): a field that is all as predicted takes a byte or two.
//
// Where nothing predicts a number, its exponent is written so, and the rest as it is: some four bits less
// than the number. Digits that a whole field has rounded off are left out.
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <type_traits>

#include "sinew/skeleton/byte_stream.h"

namespace sinew {

/// Codes one field: a run of numbers of a kind, from the next whole byte on, to a whole byte.
template <class V>
class ResidualCoder {
 public:
  /// `runs`: many numbers are exactly as predicted, so that before each other number stands how many are.
  /// `rounded`: the last so many digits are all 0.
  ResidualCoder(const char* name, ByteStream& stream, bool runs = false, int rounded = 0)
      : name_(name), stream_(stream), runs_(runs), rounded_(rounded), exact_(stream.reading() ? -1 : 0) {}
  ResidualCoder(const ResidualCoder&) = delete;
  ResidualCoder& operator=(const ResidualCoder&) = delete;
  ~ResidualCoder() {
    if (stream_.reading()) return;
    if (exact_ > 0) end_run();
    if (filled_ > 0) emit();
  }

  void value(V& v, V predicted) {
    if (!is_as_predicted(v, predicted)) write_or_read_distance(v, predicted);
  }
  /// A number that is near its prediction or near the opposite.
  void value_but_sign(V& v, V predicted) {
    if (is_as_predicted(v, predicted)) return;
    bool opposite = std::signbit(v) != std::signbit(predicted);
    if (stream_.reading())
      opposite = get_bits(1) != 0;
    else
      put_bits(opposite ? 1 : 0, 1);
    write_or_read_distance(v, opposite ? -predicted : predicted);
  }
  template <class Vector>
  void values(Vector& v, const Vector& predicted) {
    for (Eigen::Index n = 0; n < v.size(); ++n) value(v.data()[n], predicted.data()[n]);
  }

  /// A field whose numbers nothing predicts, but for those that are as predicted exactly: visit(f) calls
  /// f(v, predicted) for each, whenever it is called.
  template <class Visit>
  void unpredicted(const Visit& visit) {
    Bits all = 0;
    visit([&](V& v, V) { all |= Eigen::numext::bit_cast<Bits>(v); });
    auto rounded = static_cast<std::uint8_t>(std::min(std::countr_zero(all), kDigits));
    stream_.value(name_, rounded);
    rounded_ = stream_.bounding() ? 0 : std::min<int>(rounded, kDigits);
    mean_ = 16 << (kWidth - kDigits - 2);  // the exponent of numbers near 1
    visit([&](V& v, V predicted) { write_or_read(v, predicted); });
  }

 private:
  using Bits = std::conditional_t<sizeof(V) == 4, std::uint32_t, std::uint64_t>;
  static constexpr int kWidth = 8 * sizeof(V);
  static constexpr int kDigits = std::numeric_limits<V>::digits - 1;  ///< of a floating-point number, written
  static constexpr int kMostPrefix = 12;  ///< bits of a length's distance from the likely one, and more
  static constexpr int kMostRun = 24;     ///< bits of a run's length
  static constexpr int kBitsOfRun = 3;    ///< that a number as predicted adds to a run at most

  /// Where runs are counted.
  bool is_as_predicted(V& v, V predicted) {
    if (!runs_ || !is_exact(Eigen::numext::bit_cast<Bits>(v) == Eigen::numext::bit_cast<Bits>(predicted)))
      return false;
    if (stream_.reading()) v = predicted;
    return true;
  }

  void write_or_read_distance(V& v, V predicted) {
    const Bits from = ordered(predicted) >> rounded_;
    if (stream_.reading()) {
      const Bits z = get();
      v = number(from + ((z >> 1) ^ (Bits(0) - (z & 1))));
    } else {
      const Bits d = (ordered(v) >> rounded_) - from;
      put((d << 1) ^ (Bits(0) - (d >> (kWidth - 1))));
    }
  }

  /// One more than the exponent, 0 for the number 0; sign; digits but those rounded off.
  void write_or_read(V& v, V predicted) {
    if (is_as_predicted(v, predicted)) return;
    constexpr Bits sign = Bits(1) << (kWidth - 1), digits = (Bits(1) << kDigits) - 1;
    const int kept = kDigits - rounded_;
    if (stream_.reading()) {
      const int size = get_length(1 << (kWidth - 1 - kDigits));
      Bits bits = size == 0 ? 0 : Bits(size - 1) << kDigits;
      if (size > 0 && get_bits(1) != 0) bits |= sign;
      if (size > 0) bits |= get_bits(kept) << rounded_;
      v = Eigen::numext::bit_cast<V>(bits);
      return;
    }
    const auto bits = Eigen::numext::bit_cast<Bits>(v);
    const int size = bits == 0 ? 0 : 1 + static_cast<int>((bits & ~sign) >> kDigits);
    if (stream_.bounding()) {
      put_bits(0, 2 * (kWidth - kDigits) + 1);  // exponent and sign
      put_bits(0, kWidth);
      return;
    }
    put_length(size);
    if (size == 0) return;
    put_bits(bits & sign ? 1 : 0, 1);
    put_bits((bits & digits) >> rounded_, kept);
  }

  /// In the order of the numbers.
  static Bits ordered(V v) {
    const auto bits = Eigen::numext::bit_cast<Bits>(v);
    if constexpr (std::is_integral_v<V>) return bits;
    constexpr Bits sign = Bits(1) << (kWidth - 1);
    return bits & sign ? ~bits : bits | sign;
  }
  V number(Bits in_order) const {
    const Bits all = in_order << rounded_, lost = (Bits(1) << rounded_) - 1;
    if constexpr (std::is_integral_v<V>) return V(all);
    constexpr Bits sign = Bits(1) << (kWidth - 1);
    return Eigen::numext::bit_cast<V>(all & sign ? all ^ sign : ~(all | lost));
  }

  /// Bits that a distance is likely to need: the mean of what came so far.
  int likely() const { return mean_ < 0 ? kWidth / 2 : (mean_ + 8) / 16; }
  void learn(int length) { mean_ = mean_ < 0 ? 16 * length : mean_ + (16 * length - mean_) / 4; }

  /// Counts a number that is as predicted; false: another one follows.
  bool is_exact(bool exact) {
    if (stream_.reading()) {
      if (exact_ < 0) exact_ = get_run();
      return exact_-- > 0;
    }
    if (stream_.bounding()) {
      put_bits(0, kBitsOfRun);
      return false;
    }
    if (exact)
      ++exact_;
    else
      end_run();
    return exact;
  }
  /// The length of a run and one more, by Elias' code.
  void end_run() {
    const auto length = static_cast<unsigned>(exact_) + 1;
    const int rest = std::bit_width(length) - 1;
    put_bits((Bits(2) << rest) - 2, rest + 1);
    put_bits(length, rest);
    exact_ = 0;
  }
  int get_run() {
    int rest = 0;
    while (rest < kMostRun && get_bits(1) != 0) ++rest;
    return (1 << rest | static_cast<int>(get_bits(rest))) - 1;
  }

  void put(Bits z) {
    const int length = stream_.bounding() ? kWidth : static_cast<int>(std::bit_width(z));
    put_length(length);
    put_bits(z, length - 1);  // the highest is one
  }
  Bits get() {
    const int length = get_length(kWidth);
    return length == 0 ? 0 : Bits(1) << (length - 1) | get_bits(length - 1);
  }
  void put_length(int length) {
    const int off = stream_.bounding() ? kWidth : length - likely();
    const unsigned q = 1 + (off < 0 ? -2 * off - 1 : 2 * off);
    const int rest = std::bit_width(q) - 1;
    put_bits((Bits(2) << rest) - 2, rest + 1);
    put_bits(q, rest);
    learn(length);
  }
  int get_length(int most) {
    int rest = 0;
    while (rest < kMostPrefix && get_bits(1) != 0) ++rest;
    const int q = (1 << rest | static_cast<int>(get_bits(rest))) - 1;
    const int length = std::clamp(likely() + (q % 2 != 0 ? -(q + 1) / 2 : q / 2), 0, most);
    learn(length);
    return length;
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
  bool runs_;
  int rounded_;
  int exact_;  ///< numbers as predicted since the last other one; reading: up to the next, below 0: unread
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
