// Tells whether something has changed.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

namespace sinew::batch {

/// FNV-1a of 64 bits, eight bytes at a time, upper bits folded back onto the lower: tells changes, not
/// attacks. Two of 100 000 different contents have the same one with a probability of 3e-10.
class Digest {
 public:
  void add(const void* data, std::size_t size);
  void add(const std::string& text) { add(text.data(), text.size()); }
  /// The bytes of a regular file; of what is none, or is missing, that it is.
  void add_file(const std::filesystem::path& path);
  /// 16 hexadecimal digits.
  std::string text() const;

 private:
  void mix(std::uint64_t word) {
    hash_ = (hash_ ^ word) * 1099511628211ull;
    hash_ ^= hash_ >> 32;
  }
  std::uint64_t hash_ = 14695981039346656037ull;
};

std::string digest_of_file(const std::filesystem::path& path);

}  // namespace sinew::batch
