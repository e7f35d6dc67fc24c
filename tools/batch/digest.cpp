#include "batch/digest.h"

#include <algorithm>
#include <cstdio>
#include <cstring>
#include <fstream>

namespace sinew::batch {

namespace fs = std::filesystem;

void Digest::add(const void* data, std::size_t size) {
  const auto* bytes = static_cast<const unsigned char*>(data);
  for (std::size_t k = 0; k < size; k += sizeof(std::uint64_t)) {
    std::uint64_t word = 0;
    std::memcpy(&word, bytes + k, std::min(sizeof word, size - k));
    mix(word);
  }
  mix(size);
}

void Digest::add_file(const fs::path& path) {
  std::error_code code;
  if (!fs::is_regular_file(path, code)) return add("missing");  // sources may name devices
  std::ifstream file(path, std::ios::binary);
  char block[1 << 16];
  while (file.read(block, sizeof block) || file.gcount() > 0)
    add(block, static_cast<std::size_t>(file.gcount()));
}

std::string Digest::text() const {
  char out[17];
  std::snprintf(out, sizeof out, "%016llx", static_cast<unsigned long long>(hash_));
  return out;
}

std::string digest_of_file(const fs::path& path) {
  Digest digest;
  digest.add_file(path);
  return digest.text();
}

}  // namespace sinew::batch
