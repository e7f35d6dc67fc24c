// What a behaviour remembers as flat bytes, without padding. Internal to behaviours.
#pragma once

#include <array>
#include <cstdint>
#include <cstring>
#include <span>
#include <type_traits>
#include <vector>

#include "sinew/animation/clip.h"
#include "sinew/animation/inertialize_job.h"
#include "sinew/animation/time_jet.h"
#include "sinew/character/world.h"

namespace sinew {

/// Counts, writes or reads values one after the other: of what is visited in the same order it makes the
/// same bytes.
class StateBytes {
 public:
  /// Counts.
  StateBytes() = default;
  /// Writes.
  explicit StateBytes(std::span<std::byte> to) : to_(to.data()), room_(to.size()) {}
  /// Reads.
  explicit StateBytes(std::span<const std::byte> from) : from_(from.data()), room_(from.size()) {}

  std::size_t size() const { return size_; }  ///< bytes that were visited
  bool reads() const { return from_ != nullptr; }

  template <class... V>
  void operator()(V&... values) {
    (visit(values), ...);
  }

 private:
  template <class V>
  void plain(V* values, std::size_t count) {
    const std::size_t bytes = count * sizeof(V), at = size_;
    size_ += bytes;
    if (size_ > room_) return;
    if (to_) std::memcpy(to_ + at, values, bytes);
    if (from_) std::memcpy(values, from_ + at, bytes);
  }
  template <class V>
  requires std::is_arithmetic_v<V> || std::is_enum_v<V>
  void visit(V& value) { plain(&value, 1); }
  void visit(bool& value) {
    std::uint8_t byte = value;
    plain(&byte, 1);
    value = byte != 0;
  }
  template <class S, int kRows, int kColumns>
  void visit(Eigen::Matrix<S, kRows, kColumns>& value) {
    plain(value.data(), std::size_t(value.size()));
  }
  template <class S>
  void visit(Quat<S>& value) {
    visit(value.coeffs());
  }
  template <class S>
  void visit(Transform<S>& value) {
    (*this)(value.rotation, value.translation);
  }
  template <class S>
  void visit(TimeJet<S>& value) {
    (*this)(value.value, value.rate, value.acceleration);
  }
  template <class S>
  void visit(JointJet<S>& value) {
    (*this)(value.rotation, value.omega, value.alpha, value.translation, value.velocity, value.acceleration);
  }
  template <class V, std::size_t kSize>
  void visit(std::array<V, kSize>& values) {
    for (V& value : values) visit(value);
  }
  /// Its length is set-up.
  template <class V>
  void visit(std::vector<V>& values) {
    for (V& value : values) visit(value);
  }
  void visit(Displacement& value) { (*this)(value.x, value.y, value.yaw, value.z); }
  /// But for its offsets, which are somebody else's.
  template <class S>
  void visit(InertialState<S>& value) {
    (*this)(value.elapsed, value.duration);
  }

  std::byte* to_ = nullptr;
  const std::byte* from_ = nullptr;
  std::size_t room_ = 0, size_ = 0;
};

}  // namespace sinew
