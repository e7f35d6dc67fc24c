// Which joints a layer reaches, and how far.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace sinew {

/// Weights per joint under a name, as assets hold them: 0 and 255 are exact.
struct JointMask {
  std::string name;                   ///< unique in its asset
  std::vector<std::uint8_t> weights;  ///< [joint]

  /// As BlendLayer takes them, 0 … 1; joints beyond the mask get 0. Allocates nothing.
  template <class T>
  void write(std::span<T> out) const {
    for (std::size_t j = 0; j < out.size(); ++j) out[j] = j < weights.size() ? T(weights[j]) / T(255) : T(0);
  }
};

}  // namespace sinew
