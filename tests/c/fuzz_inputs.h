// What random calls of the C interface are given: numbers, handles and pointers, most of which can be meant;
// and what has to be true of every answer.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>
#include <span>
#include <vector>

#include "c/scene.h"

namespace sinew {

class FuzzInputs {
 protected:
  explicit FuzzInputs(unsigned seed) : random_(seed) {}

  int below(std::size_t count) { return static_cast<int>(random_() % count); }
  bool rarely() { return below(24) == 0; }
  double number(double least, double most) {
    constexpr double kOdd[] = {NAN, INFINITY, -INFINITY, 1e300, -1e30, 0, -1, 1e-300};
    if (rarely()) return kOdd[below(std::size(kOdd))];
    return std::uniform_real_distribution<double>(least, most)(random_);
  }
  float real(double least, double most) { return static_cast<float>(number(least, most)); }
  std::int32_t index(int count) {
    constexpr std::int32_t kOdd[] = {
        -1,      -2,  std::numeric_limits<std::int32_t>::min(), std::numeric_limits<std::int32_t>::max(),
        1 << 20, 4097};
    return rarely() ? kOdd[below(std::size(kOdd))] : below(std::size_t(count));
  }
  std::uint64_t handle(const std::vector<std::uint64_t>& of) {
    if (rarely()) return random_() ^ random_() << 32;
    if (rarely() && !gone_.empty()) return gone_[std::size_t(below(gone_.size()))];
    if (rarely()) return worlds_.empty() ? 0 : worlds_.front() + std::uint64_t(below(3));
    return of.empty() ? 0 : of[std::size_t(below(of.size()))];
  }
  template <class T>
  T* or_null(T* pointer) {
    return rarely() ? nullptr : pointer;
  }
  /// Three numbers within ±most.
  const double* triple(double most) {
    for (double& x : triples_[next_]) x = number(-most, most);
    const double* const out = triples_[next_].data();
    next_ = (next_ + 1) % triples_.size();
    return or_null(out);
  }
  template <class S>
  S settings(sinew_status (*init)(S*)) {
    S s{};
    s.size = rarely() ? std::uint32_t(below(2 * sizeof s)) : sizeof s;
    check(init(&s));
    return s;
  }
  void turn(sinew_pose& pose) {
    const double angle = number(-3, 3);
    pose.rotation[2] = std::sin(angle / 2);
    pose.rotation[3] = rarely() ? number(-2, 2) : std::cos(angle / 2);
    for (double& x : pose.translation) x = number(-2, 3);
  }

  void check(sinew_status status) {
    ASSERT_GE(status, SINEW_OK);
    ASSERT_LE(status, SINEW_UNSUPPORTED);
    if (status == SINEW_OK) return;
    ASSERT_STRNE(sinew_last_reason(), "") << sinew_status_name(status);
    ASSERT_STRNE(sinew_status_name(status), "unknown status");
    ASSERT_NE(status, SINEW_NO_MEMORY) << sinew_last_reason();
  }
  /// Poses are finite.
  void check_poses(std::uint64_t world) {
    for (int n = 0; n < 8; ++n) {
      std::uint64_t someone = 0;
      if (sinew_world_get_character(world, n, &someone) != SINEW_OK) return;
      sinew_view view{};
      ASSERT_EQ(sinew_character_get_view(someone, SINEW_VIEW_LOCAL, &view), SINEW_OK);
      for (const sinew_transform& t :
           std::span(static_cast<const sinew_transform*>(view.data), std::size_t(view.count)))
        for (const float x : t.rotation) ASSERT_TRUE(std::isfinite(x));
    }
  }

  std::mt19937_64 random_;
  std::vector<std::uint64_t> assets_, graphs_, worlds_, people_, props_, loops_, effects_, bodies_, sensors_,
      gone_;
  std::vector<char> balanced_;  ///< what a behaviour saved

 private:
  std::array<std::array<double, 3>, 4> triples_{};
  std::size_t next_ = 0;
};

}  // namespace sinew
