// Bodies that feet stand on, for the C interface.
#pragma once

#include <array>
#include <cstddef>
#include <span>

#include "sinew/animation/moving_transform.h"
#include "sinew/c/sinew.h"

namespace sinew::c {

/// What sinew_ground_hit::body refers to.
struct Grounds {
  static constexpr std::size_t kMost = 8;
  std::array<MovingTransform<float>, kMost> bodies;  ///< body → world, or model space
  std::size_t count = 0;

  std::span<const MovingTransform<float>> all() const { return std::span(bodies).first(count); }
};

/// What a caller tells of them; refuses more than eight, and what is no motion. `grounds` is as it was then.
sinew_status read_grounds(const sinew_jet* jets, int count, Grounds& grounds) noexcept;

}  // namespace sinew::c
