// What a step reads of the one before, as flat bytes. Internal to the character layer: see World::save().
//
// One list of fields (visit_state) serves all that is done with them: bounding, writing, reading, and naming
// the field that a byte belongs to. What follows from the rest is left out: deviations of joints on the
// animation; of what only falls all deviations and last targets, for nobody asks for them until muscles hold
// it. What nearly follows is written as its distance from what it would be (residual_coder.h): masses' places
// from the pose, velocities from the joints' speeds. Whoever reads must compute these alike, as whoever
// replays must.
#pragma once

#include <cstddef>
#include <cstring>
#include <memory>
#include <span>
#include <type_traits>

#include "sinew/character/contact_finder.h"
#include "sinew/character/levels.h"
#include "sinew/effects/coupling.h"

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
  template <class T>
  void vector(const char* name, Vec3<T>& v) {
    array(name, v.data(), 3);
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

/// Everything of a character or prop that its next step depends on, but for what the host gives it.
template <class T>
void visit_state(CharacterState<T>& state, ByteStream& stream);

/// What the host gives a character for its next step: target and impulses.
template <class T>
void visit_inputs(CharacterState<T>& state, ByteStream& stream);

/// The parts of a world that move.
template <class T>
struct MovingParts {
  std::span<const std::unique_ptr<CharacterState<T>>> states;
  std::vector<LaggedForce<T>>& lagged;  ///< normal forces remembered for friction
  BudgetState& budget;
  std::span<const std::unique_ptr<Coupling<T>>> couplings;
  std::span<const std::span<std::byte>> games;  ///< bytes that the game wants kept with the state
};

enum class Content : std::uint32_t { kState = 0x324e5753, kInputs = 0x31495753 };  ///< SWN2, SWI1

constexpr std::size_t kHeaderBytes = 24;  ///< content, size, make-up of the world, digest of what follows

/// Bytes that `content` takes at most.
template <class T>
std::size_t bytes_at_most(const MovingParts<T>& world, Content content);
/// Writes a header and the content; bytes written, 0 where they do not fit.
template <class T>
std::size_t write_bytes(const MovingParts<T>& world, Content content, std::span<std::byte> out);
/// The inverse. Refuses bytes of another world, another content, or changed ones, with nothing moved.
template <class T>
Status read_bytes(const MovingParts<T>& world, Content content, std::span<const std::byte> in);
/// Which field of which state holds a byte of the snapshot that the world would give now.
template <class T>
SnapshotField field_at(const MovingParts<T>& world, std::size_t byte);

#define SINEW_SNAPSHOT_INSTANCES(prefix, T)                                                \
  prefix void visit_state<T>(CharacterState<T>&, ByteStream&);                             \
  prefix void visit_inputs<T>(CharacterState<T>&, ByteStream&);                            \
  prefix std::size_t bytes_at_most<T>(const MovingParts<T>&, Content);                     \
  prefix std::size_t write_bytes<T>(const MovingParts<T>&, Content, std::span<std::byte>); \
  prefix Status read_bytes<T>(const MovingParts<T>&, Content, std::span<const std::byte>); \
  prefix SnapshotField field_at<T>(const MovingParts<T>&, std::size_t);
SINEW_SNAPSHOT_INSTANCES(extern template, float)
SINEW_SNAPSHOT_INSTANCES(extern template, double)

}  // namespace sinew
