// A file as bytes in memory, read when they are first touched: the one place in the runtime that knows of
// operating systems.
#pragma once

#include <cstdint>
#include <span>

#include "sinew/skeleton/status.h"

namespace sinew {

class MappedFile {
 public:
  MappedFile() = default;
  ~MappedFile();
  MappedFile(const MappedFile&) = delete;
  MappedFile& operator=(const MappedFile&) = delete;

  /// Once. `path`: as the system's own calls take it; on Windows in UTF-8. Errors: kIo where there is no such
  /// file, or no regular one, kBadFile where it is empty.
  Status open(const char* path);
  std::span<const std::uint8_t> bytes() const { return {static_cast<const std::uint8_t*>(data_), size_}; }

 private:
  void* data_ = nullptr;
  std::size_t size_ = 0;
};

}  // namespace sinew
