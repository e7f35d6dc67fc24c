// The file system that assimp sees inside the sandbox: the source itself, and what the broker grants.
#pragma once

#include <algorithm>
#include <assimp/IOStream.hpp>
#include <assimp/IOSystem.hpp>
#include <cstring>
#include <map>
#include <string>

#include "import/readers.h"

namespace sinew::import {

/// A file in memory, as assimp wants it.
class MemoryStream : public Assimp::IOStream {
 public:
  explicit MemoryStream(std::string content) : content_(std::move(content)) {}
  size_t Read(void* to, size_t size, size_t count) override {
    if (size == 0) return 0;
    const size_t items = std::min(count, (content_.size() - at_) / size);
    std::memcpy(to, content_.data() + at_, items * size);
    at_ += items * size;
    return items;
  }
  size_t Write(const void*, size_t, size_t) override { return 0; }
  aiReturn Seek(size_t offset, aiOrigin origin) override {
    const size_t base = origin == aiOrigin_SET ? 0 : (origin == aiOrigin_CUR ? at_ : content_.size());
    const size_t to = origin == aiOrigin_END ? base - offset : base + offset;
    if (to > content_.size()) return aiReturn_FAILURE;
    at_ = to;
    return aiReturn_SUCCESS;
  }
  size_t Tell() const override { return at_; }
  size_t FileSize() const override { return content_.size(); }
  void Flush() override {}

 private:
  std::string content_;
  size_t at_ = 0;
};

class ClosedWorld : public Assimp::IOSystem {
 public:
  ClosedWorld(std::string main_name, const std::string& main, const OpenFile& open_file, std::uint64_t most)
      : main_name_(std::move(main_name)), main_(main), open_file_(open_file), most_(most) {}
  /// One more file, instead of any of that name on disk.
  void add(const std::string& name, std::string bytes) { added_[name] = std::move(bytes); }

  bool Exists(const char* file) const override {
    return file == main_name_ || added_.count(file) > 0 || descriptor_of(file) >= 0;
  }
  char getOsSeparator() const override { return '/'; }
  Assimp::IOStream* Open(const char* file, const char*) override {
    if (file == main_name_) return new MemoryStream(main_);
    if (const auto known = added_.find(file); known != added_.end()) return new MemoryStream(known->second);
    const int descriptor = descriptor_of(file);
    return descriptor < 0 ? nullptr : new MemoryStream(read_descriptor(descriptor, most_));
  }
  void Close(Assimp::IOStream* stream) override { delete stream; }

 private:
  /// As named; else, since exporters write paths of their author's disk, by its last part alone.
  int descriptor_of(std::string name) const {
    std::replace(name.begin(), name.end(), '\\', '/');
    const auto known = descriptors_.find(name);
    if (known != descriptors_.end()) return known->second;
    int descriptor = open_file_(name);
    const auto slash = name.rfind('/');
    if (descriptor < 0 && slash != std::string::npos) descriptor = open_file_(name.substr(slash + 1));
    return descriptors_[name] = descriptor;
  }

  std::string main_name_;
  const std::string& main_;
  const OpenFile& open_file_;
  std::uint64_t most_;
  std::map<std::string, std::string> added_;
  mutable std::map<std::string, int> descriptors_;  ///< open until the child ends
};

}  // namespace sinew::import
