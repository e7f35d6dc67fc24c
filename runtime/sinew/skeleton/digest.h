// Whether bytes are still those that were written.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace sinew {

/// FNV-1a, 64 bits: finds accidents, not intentions. (Fowler, Noll & Vo, 1991.) `hash`: of what came before.
inline std::uint64_t digest(std::span<const std::byte> bytes, std::uint64_t hash = 0xcbf29ce484222325ull) {
  for (const std::byte b : bytes) hash = (hash ^ std::to_integer<std::uint64_t>(b)) * 0x100000001b3ull;
  return hash;
}

}  // namespace sinew
