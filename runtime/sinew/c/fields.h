// Settings of the C interface and the C++ ones that they stand for, field by field: one list for each struct
// serves both ways.
//
// A list is a function list(c, s, f) that calls f for every pair of fields. ToC writes defaults, FromC reads
// what a caller set, within bounds.
#pragma once

#include <cmath>
#include <concepts>
#include <cstdint>
#include <limits>

#include "sinew/c/call.h"
#include "sinew/c/sinew.h"
#include "sinew/skeleton/vector.h"

namespace sinew::c {

constexpr double kAnyNumber = 1e12;  ///< where nothing closer is said

/// The largest value of an enumeration, for those that come in.
template <class E>
inline constexpr E kLast{};
template <>
inline constexpr Shape kLast<Shape> = Shape::kBox;
template <>
inline constexpr RootDrive kLast<RootDrive> = RootDrive::kGrounded;
template <>
inline constexpr Level kLast<Level> = Level::kSubsteps;
template <>
inline constexpr LoopKind kLast<LoopKind> = LoopKind::kRope;
template <>
inline constexpr Tone kLast<Tone> = Tone::kBraced;
template <>
inline constexpr GetUpPolicy kLast<GetUpPolicy> = GetUpPolicy::kNever;

/// C++ → C.
struct ToC {
  template <class C, class S>
  requires(std::is_arithmetic_v<S> || std::is_enum_v<S>) void operator()(const char*, C& c, const S& s,
                                                                         double = 0, double = 0) {
    c = static_cast<C>(s);
  }
  void operator()(const char*, double (&c)[3], const Vec3<double>& s, double = 0, double = 0) {
    for (int k = 0; k < 3; ++k) c[k] = s[k];
  }
  void operator()(const char*, sinew_pose& c, const Transform<double>& s) {
    for (int k = 0; k < 4; ++k) c.rotation[k] = s.rotation.coeffs()[k];
    for (int k = 0; k < 3; ++k) c.translation[k] = s.translation[k];
  }
};

/// C → C++; `status` tells of the first field that can't be meant. Words name the field and its bounds.
struct FromC {
  sinew_status status = SINEW_OK;

  template <class C, class S>
  requires(std::is_arithmetic_v<S> && !std::same_as<S, bool>) void operator()(const char* words, const C& c,
                                                                              S& s,
                                                                              double least = -kAnyNumber,
                                                                              double most = kAnyNumber) {
    if (within(words, double(c), least, most)) s = static_cast<S>(c);
  }
  void operator()(const char*, std::int32_t c, bool& s) { s = c != 0; }
  template <class E>
  requires std::is_enum_v<E>
  void operator()(const char* words, std::int32_t c, E& s) {
    if (within(words, c, 0, double(kLast<E>))) s = E(c);
  }
  void operator()(const char* words, const double (&c)[3], Vec3<double>& s, double least = -kAnyNumber,
                  double most = kAnyNumber) {
    for (int k = 0; k < 3; ++k)
      if (within(words, c[k], least, most)) s[k] = c[k];
  }
  void operator()(const char* words, const sinew_pose& c, Transform<double>& s) {
    double norm = 0;
    for (const double x : c.rotation) norm += x * x;
    for (const double x : c.translation) within(words, x, -kFarthest, kFarthest);
    if (!within(words, norm, 0.98, 1.02)) return;
    s.rotation = Quat<double>(c.rotation[3], c.rotation[0], c.rotation[1], c.rotation[2]);
    for (int k = 0; k < 3; ++k) s.translation[k] = c.translation[k];
  }

 private:
  static constexpr double kFarthest = 1e6;  ///< m; what characters' targets may be

  bool within(const char* words, double x, double least, double most) {
    if (x >= least && x <= most) return true;
    const bool finite = std::isfinite(x);
    if (status == SINEW_OK) status = fail(finite ? SINEW_INVALID_ARGUMENT : SINEW_NOT_FINITE, words);
    return false;
  }
};

/// Fills what the caller knows of `c` with the defaults of S, as `list` pairs them.
template <class S, class C, class List>
sinew_status init(C* c, List&& list) noexcept {
  return fill_sized(c, [&](C& all) {
    const S defaults{};
    list(all, defaults, ToC{});
  });
}

/// Reads what a caller set, defaults where he set nothing.
template <class C, class S, class List>
sinew_status read_settings(const C* from, S& to, List&& list) noexcept {
  C all{};
  list(all, to, ToC{});
  if (const sinew_status status = read_sized(from, all); status != SINEW_OK) return status;
  FromC read;
  list(all, to, read);
  return read.status;
}

}  // namespace sinew::c
