// Flat byte stream between the sandboxed reader and its parent. The child is not trusted: reading checks
// every length.
#pragma once

#include <cstdint>
#include <cstring>
#include <string>
#include <type_traits>
#include <vector>

namespace sinew::import {

class ByteWriter {
 public:
  template <class T>
  void pod(const T& value) {
    static_assert(std::is_trivially_copyable_v<T>);
    const auto* raw = reinterpret_cast<const char*>(&value);
    data_.append(raw, sizeof(T));
  }
  void text(const std::string& s) {
    pod(std::uint64_t(s.size()));
    data_ += s;
  }
  template <class T>
  void array(const std::vector<T>& v) {
    pod(std::uint64_t(v.size()));
    if (!v.empty()) data_.append(reinterpret_cast<const char*>(v.data()), v.size() * sizeof(T));
  }
  const std::string& data() const { return data_; }

 private:
  std::string data_;
};

/// Every call returns false once anything did not fit.
class ByteReader {
 public:
  explicit ByteReader(const std::string& data) : data_(data) {}
  template <class T>
  bool pod(T& value) {
    static_assert(std::is_trivially_copyable_v<T>);
    if (data_.size() - at_ < sizeof(T)) return false;
    std::memcpy(static_cast<void*>(&value), data_.data() + at_, sizeof(T));
    at_ += sizeof(T);
    return true;
  }
  bool text(std::string& s) {
    std::uint64_t size = 0;
    if (!pod(size) || size > data_.size() - at_) return false;
    s.assign(data_, at_, size);
    at_ += size;
    return true;
  }
  template <class T>
  bool array(std::vector<T>& v) {
    std::uint64_t count = 0;
    if (!pod(count) || count > (data_.size() - at_) / sizeof(T)) return false;
    v.resize(count);
    if (count > 0) std::memcpy(static_cast<void*>(v.data()), data_.data() + at_, count * sizeof(T));
    at_ += count * sizeof(T);
    return true;
  }
  /// A count of elements of at least `smallest` bytes each.
  bool count(std::uint64_t& n, std::size_t smallest) {
    return pod(n) && n <= (data_.size() - at_) / smallest;
  }
  bool done() const { return at_ == data_.size(); }

 private:
  const std::string& data_;
  std::size_t at_ = 0;
};

}  // namespace sinew::import
