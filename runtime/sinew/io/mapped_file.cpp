#include "sinew/io/mapped_file.h"

#ifdef _WIN32
#ifndef NOMINMAX
#define NOMINMAX
#endif
#define WIN32_LEAN_AND_MEAN
#include <windows.h>

#include <string>
#else
#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>
#endif

namespace sinew {
namespace {

Status unopened() {
  return Status::error(Code::kIo, "file cannot be opened");
}
Status irregular() {
  return Status::error(Code::kIo, "not a regular file");
}
Status empty() {
  return Status::error(Code::kBadFile, "file is empty");
}
Status unmapped() {
  return Status::error(Code::kIo, "file cannot be mapped");
}

#ifdef _WIN32

/// Closed when it goes.
struct Handle {
  HANDLE handle;
  ~Handle() {
    if (handle && handle != INVALID_HANDLE_VALUE) CloseHandle(handle);
  }
};

std::wstring wide(const char* path) {
  const int length = MultiByteToWideChar(CP_UTF8, MB_ERR_INVALID_CHARS, path, -1, nullptr, 0);
  std::wstring out(static_cast<std::size_t>(length), L'\0');
  MultiByteToWideChar(CP_UTF8, MB_ERR_INVALID_CHARS, path, -1, out.data(), length);
  return out;
}

Status map(const char* path, void*& data, std::size_t& size) {
  const std::wstring name = wide(path);
  const DWORD attributes = GetFileAttributesW(name.c_str());
  if (attributes == INVALID_FILE_ATTRIBUTES) return unopened();
  if (attributes & FILE_ATTRIBUTE_DIRECTORY) return irregular();
  const Handle file{CreateFileW(name.c_str(), GENERIC_READ, FILE_SHARE_READ, nullptr, OPEN_EXISTING,
                                FILE_ATTRIBUTE_NORMAL, nullptr)};
  if (file.handle == INVALID_HANDLE_VALUE) return unopened();
  LARGE_INTEGER length;
  if (GetFileType(file.handle) != FILE_TYPE_DISK || !GetFileSizeEx(file.handle, &length)) return irregular();
  if (length.QuadPart == 0) return empty();
  const Handle mapping{CreateFileMappingW(file.handle, nullptr, PAGE_READONLY, 0, 0, nullptr)};
  if (!mapping.handle) return unmapped();
  data = MapViewOfFile(mapping.handle, FILE_MAP_READ, 0, 0, 0);
  size = static_cast<std::size_t>(length.QuadPart);
  return data ? Status{} : unmapped();
}

void unmap(void* data, std::size_t /*size*/) {
  UnmapViewOfFile(data);
}

#else

Status map(const char* path, void*& data, std::size_t& size) {
  const int file = ::open(path, O_RDONLY | O_CLOEXEC);
  if (file < 0) return unopened();
  struct stat info {};
  if (::fstat(file, &info) != 0 || !S_ISREG(info.st_mode)) {
    ::close(file);
    return irregular();
  }
  size = static_cast<std::size_t>(info.st_size);
  void* mapped = size == 0 ? nullptr : ::mmap(nullptr, size, PROT_READ, MAP_PRIVATE, file, 0);
  ::close(file);
  if (size == 0) return empty();
  if (mapped == MAP_FAILED) return unmapped();
  data = mapped;
  return {};
}

void unmap(void* data, std::size_t size) {
  ::munmap(data, size);
}

#endif

}  // namespace

Status MappedFile::open(const char* path) {
  return map(path, data_, size_);
}

MappedFile::~MappedFile() {
  if (data_) unmap(data_, size_);
}

}  // namespace sinew
