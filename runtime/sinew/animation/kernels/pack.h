// A fixed number of scalars that behave as one: the scalar type of the SIMD kernels.
//
// Include from kernel translation units only. Everything here has internal linkage, so that code compiled for
// a wider instruction set can never be picked by the linker for a machine that lacks it.
#pragma once

#ifdef __AVX__
#include <immintrin.h>
#endif

#include <cmath>
#include <cstdint>
#include <type_traits>
#include <utility>

#include "sinew/skeleton/portable_math.h"
#include "sinew/skeleton/scalar.h"

namespace sinew {
namespace {

/// What a comparison of packs says of each lane: all bits set, or none.
template <class T, int N>
struct Mask {
  using Lane = std::conditional_t<sizeof(T) == sizeof(std::int32_t), std::int32_t, std::int64_t>;
  using Bits [[gnu::vector_size(N * sizeof(T))]] = Lane;
  Bits v;

  static Mask all(bool set) { return {Bits{} - Lane(set)}; }
  friend Mask both(const Mask& a, const Mask& b) { return {a.v & b.v}; }
  friend Mask either(const Mask& a, const Mask& b) { return {a.v | b.v}; }
  friend Mask operator!(const Mask& a) { return {~a.v}; }
  bool lane(int i) const { return v[i] != 0; }
  friend bool any(const Mask& a) {
    if constexpr (sizeof(Bits) > 2 * sizeof(std::int64_t)) {
      return [&]<int... I>(std::integer_sequence<int, I...>) {
        return any(Mask<T, N / 2>{__builtin_shufflevector(a.v, a.v, I...) |
                                  __builtin_shufflevector(a.v, a.v, (N / 2 + I)...)});
      }
      (std::make_integer_sequence<int, N / 2>());
    } else {
      std::int64_t halves[2] = {};
      __builtin_memcpy(halves, &a.v, sizeof(Bits));
      return (halves[0] | halves[1]) != 0;
    }
  }
};

/// N scalars in GCC's and Clang's portable vector type. Every operation is the exact IEEE operation on each
/// lane, in the order written (kernels are compiled without contraction): results depend neither on N nor on
/// the machine.
template <class T, int N>
struct Pack {
  using Scalar = T;
  // Aligned like the narrowest register: Eigen, which lays out floats alike for all instruction sets, asks no
  // more of memory.
  using Vector [[gnu::vector_size(N * sizeof(T)), gnu::aligned(16)]] = T;
  static constexpr int kLanes = N;
  Vector v;

  Pack() = default;
  Pack(Vector x) : v(x) {}
  template <class Number>
  requires std::is_arithmetic_v<Number> Pack(Number x) : Pack(all(T(x))) {}
  static Pack all(T x) {
    return [&]<int... I>(std::integer_sequence<int, I...>) {
      return Pack(Vector{(static_cast<void>(I), x)...});
    }
    (std::make_integer_sequence<int, N>());
  }
  template <class U>
  static Pack load(const U* from) {
    using Source [[gnu::vector_size(N * sizeof(U))]] = U;
    Source x;
    __builtin_memcpy(&x, from, sizeof(x));
    return __builtin_convertvector(x, Vector);
  }
  friend Pack operator+(const Pack& a, const Pack& b) { return a.v + b.v; }
  friend Pack operator-(const Pack& a, const Pack& b) { return a.v - b.v; }
  friend Pack operator*(const Pack& a, const Pack& b) { return a.v * b.v; }
  friend Pack operator/(const Pack& a, const Pack& b) { return a.v / b.v; }
  friend Pack operator-(const Pack& a) { return -a.v; }
  friend Pack operator*(T s, const Pack& a) { return s * a.v; }
  Pack& operator+=(const Pack& b) { return *this = *this + b; }
  Pack& operator-=(const Pack& b) { return *this = *this - b; }
  Pack& operator*=(const Pack& b) { return *this = *this * b; }
  Pack& operator/=(const Pack& b) { return *this = *this / b; }
  friend Mask<T, N> operator<(const Pack& a, const Pack& b) { return {a.v < b.v}; }
  friend Mask<T, N> operator>(const Pack& a, const Pack& b) { return {a.v > b.v}; }
  friend Mask<T, N> operator<=(const Pack& a, const Pack& b) { return {a.v <= b.v}; }
  friend Mask<T, N> operator>=(const Pack& a, const Pack& b) { return {a.v >= b.v}; }
  friend Mask<T, N> operator==(const Pack& a, const Pack& b) { return {a.v == b.v}; }
  friend Mask<T, N> operator!=(const Pack& a, const Pack& b) { return {a.v != b.v}; }
  friend Pack abs(const Pack& a) { return Pack(a.v < T(0) ? -a.v : a.v); }
  friend Pack select(const Mask<T, N>& mask, const Pack& yes, const Pack& no) {
    return Pack(mask.v ? yes.v : no.v);
  }
  friend Pack where_equal(const Pack& a, T b, const Pack& yes, const Pack& no) {
    return Pack(a.v == b ? yes.v : no.v);
  }
  friend Pack where_negative(const Pack& a, const Pack& yes, const Pack& no) {
    return Pack(a.v < T(0) ? yes.v : no.v);
  }
  friend Pack sqrt(const Pack& a) {
    Pack x;
    for (int i = 0; i < N; ++i) {
      if constexpr (sizeof(T) == sizeof(float))
        x.v[i] = __builtin_sqrtf(a.v[i]);
      else
        x.v[i] = __builtin_sqrt(a.v[i]);
    }
    return x;
  }
  // The library's, lane by lane: the same bits as a scalar's.
  friend Pack sin(const Pack& a) {
    return each_lane(a, [](T x) { return portable::sin(x); });
  }
  friend Pack cos(const Pack& a) {
    return each_lane(a, [](T x) { return portable::cos(x); });
  }
  friend Pack atan2(const Pack& y, const Pack& x) {
    Pack angle;
    for (int i = 0; i < N; ++i) angle.v[i] = portable::atan2(y.v[i], x.v[i]);
    return angle;
  }
  template <class Function>
  static Pack each_lane(const Pack& a, Function f) {
    Pack x;
    for (int i = 0; i < N; ++i) x.v[i] = f(a.v[i]);
    return x;
  }
};

/// See scalar.h.
template <int N>
Pack<double, N> widened(const Pack<float, N>& x) {
  return Pack<double, N>(__builtin_convertvector(x.v, typename Pack<double, N>::Vector));
}
/// What a comparison in double precision says, for lanes of floats.
template <int N>
Mask<float, N> narrowed(const Mask<double, N>& mask) {
  return {__builtin_convertvector(mask.v, typename Mask<float, N>::Bits)};
}

}  // namespace

template <class T, int N>
struct NumberOf<Pack<T, N>> {
  using Type = T;
};

namespace {

/// Four numbers from each of the addresses `at(group)`. Registers are joined, never assembled in memory: a
/// wide load that follows narrow stores stalls. Where the instruction set loads into a part of a register
/// that is said outright: GCC 12 makes a load and a shuffle across lanes of a portable join.
template <class P, class At>
[[gnu::always_inline]] inline P load_fours(At at, int group = 0) {
  using T = typename P::Scalar;
  if constexpr (P::kLanes == 4) {
    return P::load(at(group));
#ifdef __AVX512F__
  } else if constexpr (P::kLanes == 16 && sizeof(T) == 4) {
    const auto four = [&](int g) { return _mm_loadu_ps(at(group + g)); };
    __m512 all = _mm512_castps128_ps512(four(0));
    all = _mm512_mask_broadcast_f32x4(all, 0x00f0, four(1));
    all = _mm512_mask_broadcast_f32x4(all, 0x0f00, four(2));
    return P(_mm512_mask_broadcast_f32x4(all, 0xf000, four(3)));
#endif
#ifdef __AVX__
  } else if constexpr (P::kLanes == 8 && sizeof(T) == 4) {
    return P(_mm256_insertf128_ps(_mm256_castps128_ps256(_mm_loadu_ps(at(group))),
                                  _mm_loadu_ps(at(group + 1)), 1));
#endif
  } else {
    constexpr int kHalf = P::kLanes / 2;
    using Half = Pack<T, kHalf>;
    const Half low = load_fours<Half>(at, group), high = load_fours<Half>(at, group + kHalf / 4);
    return [&]<int... I>(std::integer_sequence<int, I...>) {
      return P(__builtin_shufflevector(low.v, high.v, I...));
    }
    (std::make_integer_sequence<int, P::kLanes>());
  }
}

/// Calls f with the constants 0 … N − 1.
template <int N, class F>
[[gnu::always_inline]] inline void for_each_index(F f) {
  [&]<int... I>(std::integer_sequence<int, I...>) {
    (f(std::integral_constant<int, I>()), ...);
  }
  (std::make_integer_sequence<int, N>());
}

/// `Count` lanes from lane `First` on.
template <int First, int Count, class T, int N>
void store(const Pack<T, N>& x, T* to) {
  [&]<int... I>(std::integer_sequence<int, I...>) {
    const auto some = __builtin_shufflevector(x.v, x.v, (First + I)...);
    __builtin_memcpy(to, &some, sizeof(some));
  }
  (std::make_integer_sequence<int, Count>());
}

/// Shuffle within every four lanes of two packs: lane i of the result is lane index(i) of `a`, or, from N on,
/// of `b`.
template <class P, class Index>
P shuffle(const P& a, const P& b, Index) {
  return [&]<int... I>(std::integer_sequence<int, I...>) {
    return P(__builtin_shufflevector(
        a.v, b.v, (I / 4 * 4 + Index::from(I % 4) + (Index::second(I % 4) ? P::kLanes : 0))...));
  }
  (std::make_integer_sequence<int, P::kLanes>());
}
template <int From>
struct Interleaved {  // a₀ b₀ a₁ b₁
  static constexpr int from(int i) { return From + i / 2; }
  static constexpr bool second(int i) { return i % 2 == 1; }
};
template <int From>
struct Joined {  // a₀ a₁ b₀ b₁
  static constexpr int from(int i) { return From + i % 2; }
  static constexpr bool second(int i) { return i >= 2; }
};
template <class P>
P interleave_low(const P& a, const P& b) {
  return shuffle(a, b, Interleaved<0>());
}
template <class P>
P interleave_high(const P& a, const P& b) {
  return shuffle(a, b, Interleaved<2>());
}

/// Every four lanes in another order.
template <int X, int Y, int Z, int W, class P>
P rearranged(const P& a) {
  constexpr int kFrom[] = {X, Y, Z, W};
  return [&]<int... I>(std::integer_sequence<int, I...>) {
    return P(__builtin_shufflevector(a.v, a.v, (I / 4 * 4 + kFrom[I % 4])...));
  }
  (std::make_integer_sequence<int, P::kLanes>());
}

/// Transposes every 4×4 block of the 4×N matrix `m`: lane 4g + k of row c swaps with lane 4g + c of row k.
/// Its own inverse. Eight shuffles.
template <class P>
void transpose(P (&m)[4]) {
  const P low01 = interleave_low(m[0], m[1]), high01 = interleave_high(m[0], m[1]);
  const P low23 = interleave_low(m[2], m[3]), high23 = interleave_high(m[2], m[3]);
  m[0] = shuffle(low01, low23, Joined<0>());
  m[1] = shuffle(low01, low23, Joined<2>());
  m[2] = shuffle(high01, high23, Joined<0>());
  m[3] = shuffle(high01, high23, Joined<2>());
}

/// Every four lanes from number 4·Odd on of every eight of two packs.
template <int Odd, class P>
P fours_of_eights(const P& a, const P& b) {
  return [&]<int... I>(std::integer_sequence<int, I...>) {
    return P(__builtin_shufflevector(a.v, b.v, (8 * (I / 4) + 4 * Odd + I % 4)...));
  }
  (std::make_integer_sequence<int, P::kLanes>());
}

/// Eight numbers from each lane's address `at(lane)`: low[c], high[c] are the numbers c and 4 + c of all
/// lanes. Half the loads that fours take.
template <class P, class At>
[[gnu::always_inline]] inline void load_eights(At at, P (&low)[4], P (&high)[4]) {
  constexpr int kHalf = P::kLanes / 2;
  if constexpr (P::kLanes == 4) {
    for (int lane = 0; lane < 4; ++lane) {
      low[lane] = P::load(at(lane));
      high[lane] = P::load(at(lane) + 4);
    }
    transpose(low);
    transpose(high);
  } else {
    const auto rows = [&](int lane) {
#ifdef __AVX512F__
      if constexpr (P::kLanes == 16)
        return P(_mm512_insertf32x8(_mm512_castps256_ps512(_mm256_loadu_ps(at(lane))),
                                    _mm256_loadu_ps(at(lane + 4)), 1));
#endif
      if constexpr (P::kLanes == 8) return P::load(at(lane));
    };
    P a[4], b[4];
    for (int r = 0; r < 4; ++r) {
      a[r] = rows(r);
      b[r] = rows(kHalf + r);
    }
    transpose(a);
    transpose(b);
    for (int c = 0; c < 4; ++c) {
      low[c] = fours_of_eights<0>(a[c], b[c]);
      high[c] = fours_of_eights<1>(a[c], b[c]);
    }
  }
}

}  // namespace
}  // namespace sinew
