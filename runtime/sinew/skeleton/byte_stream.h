// A state as flat bytes without padding. One list of fields serves all that is done with them: bounding,
// writing, reading, and naming the field that a byte belongs to. Internal to the runtime.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <type_traits>

#include "sinew/skeleton/vector.h"

namespace sinew {

/// Goes through fields in a fixed order. Reading never leaves the bytes: where they end, ok() becomes false
/// and fields stay as they are.
class ByteStream {
 public:
  enum class Mode {
    kBound,  ///< counts the most that a state can take
    kWrite,
    kRead,
    kName,  ///< finds which field holds a byte
  };

  static ByteStream bound() { return {Mode::kBound, nullptr, nullptr, 0}; }
  static ByteStream writer(std::span<std::byte> out) {
    return {Mode::kWrite, out.data(), nullptr, out.size()};
  }
  static ByteStream reader(std::span<const std::byte> in) {
    return {Mode::kRead, nullptr, in.data(), in.size()};
  }
  static ByteStream namer(std::size_t byte) { return {Mode::kName, nullptr, nullptr, byte}; }

  bool reading() const { return mode_ == Mode::kRead; }
  bool bounding() const { return mode_ == Mode::kBound; }
  bool ok() const { return ok_; }
  std::size_t position() const { return position_; }
  std::size_t left() const { return size_ - position_; }  ///< bytes, reading or writing
  const char* name() const { return name_; }              ///< kName: of the field found, or ""

  template <class V>
  void array(const char* name, V* values, std::size_t count) {
    static_assert(std::is_arithmetic_v<V> && !std::is_same_v<V, bool>);
    const std::size_t bytes = count * sizeof(V);
    if (mode_ == Mode::kName) {
      if (position_ <= size_ && size_ < position_ + bytes) name_ = name;
    } else if (mode_ != Mode::kBound) {
      ok_ = ok_ && bytes <= size_ - position_;
      if (!ok_ || bytes == 0) return;
      if (mode_ == Mode::kWrite)
        std::memcpy(out_ + position_, values, bytes);
      else
        std::memcpy(values, in_ + position_, bytes);
    }
    position_ += bytes;
  }
  template <class V>
  void value(const char* name, V& v) {
    array(name, &v, 1);
  }
  /// Any other byte than 0 is read as true.
  void flag(const char* name, bool& b) {
    std::uint8_t byte = b ? 1 : 0;
    value(name, byte);
    if (reading()) b = byte != 0;
  }
  /// An enumeration as one byte, kept within what it knows: up to `last`.
  template <class E>
  void enumeration(const char* name, E& e, E last) {
    auto byte = static_cast<std::uint8_t>(e);
    value(name, byte);
    if (reading()) e = static_cast<E>(std::min(byte, static_cast<std::uint8_t>(last)));
  }
  template <class T, int kSize>
  void vector(const char* name, Eigen::Matrix<T, kSize, 1>& v) {
    array(name, v.data(), std::size_t(kSize));
  }
  template <class T>
  void matrix(const char* name, Mat3<T>& m) {
    array(name, m.data(), 9);
  }
  template <class T>
  void rotation(const char* name, Quat<T>& q) {
    array(name, q.coeffs().data(), 4);
  }
  /// kBound: that so many bytes may follow.
  void reserve_capacity(std::size_t bytes) { position_ += bytes; }
  /// Whether a part follows; `there` is what the state says. A bound counts every part.
  bool part(const char* name, bool there) {
    std::uint8_t flag = there ? 1 : 0;
    value(name, flag);
    return mode_ == Mode::kBound || (ok_ && flag != 0);
  }

 private:
  ByteStream(Mode mode, std::byte* out, const std::byte* in, std::size_t size)
      : mode_(mode), out_(out), in_(in), size_(size) {}

  Mode mode_;
  std::byte* out_;
  const std::byte* in_;
  std::size_t size_;  ///< of the bytes; kName: the byte looked for
  std::size_t position_ = 0;
  const char* name_ = "";
  bool ok_ = true;
};

}  // namespace sinew
