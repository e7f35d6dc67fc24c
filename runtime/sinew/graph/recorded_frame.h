// How a frame of a graph's recording is written. Internal to the graph layer.
//
//     RingHead · block after the last frame · pages, each: PageHead · frames
//     frame: FrameHead · block, or patches of it · rays · durations · bodies · physical pose
//     acceleration
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>

#include "sinew/animation/moving_transform.h"
#include "sinew/graph/graph_ground.h"

namespace sinew::recorded {

constexpr std::uint64_t kMagic = 0x32474e4952574e53u;  // "SNWRING2"
constexpr std::size_t kMostRays = 64, kMostBodies = 8, kMostDurations = 16;
constexpr std::uint32_t kMostFrames = 200;  ///< of a page
constexpr std::size_t kMostFrameBytes = 8 * 0xffff;

constexpr std::size_t rounded(std::size_t bytes, std::size_t to = 16) {
  return (bytes + to - 1) / to * to;
}

/// At the begin of a recording.
struct RingHead {
  std::uint64_t magic, hash, block_bytes;  ///< of the graph
  std::uint64_t pages, page_bytes;
  std::uint64_t page;    ///< that is written
  std::uint64_t frames;  ///< ever recorded

  bool same_layout(const RingHead& other) const {
    return magic == other.magic && hash == other.hash && block_bytes == other.block_bytes &&
           pages == other.pages && page_bytes == other.page_bytes && page < pages;
  }
};

/// At the begin of a page.
struct PageHead {
  std::uint64_t first;          ///< number of its first frame
  std::uint32_t frames, bytes;  ///< in it, with this
};

constexpr std::size_t pages_begin(std::size_t block_bytes) {
  return rounded(sizeof(RingHead)) + rounded(block_bytes);
}

enum FrameFlag : std::uint8_t { kWhole = 1, kPhysical = 2, kGround = 8, kMuscles = 16, kIncomplete = 32 };

/// At the begin of a frame.
template <class T>
struct FrameHead {
  std::uint64_t digest = 0;
  T h = T(0);
  std::uint16_t words = 0;  ///< of 8 bytes, of the frame
  std::uint16_t joints = 0, patches = 0, ray_bytes = 0;
  std::uint8_t rays = 0, bodies = 0, durations = 0, flags = 0;
  std::uint32_t unused[sizeof(T) == 8 ? 1 : 0] = {};  ///< fills the gap: a recording has no bytes of chance

  bool has(FrameFlag flag) const { return (flags & flag) != 0; }
  void set(FrameFlag flag) { flags = static_cast<std::uint8_t>(flags | flag); }
};

/// Of two blocks, in words of 8 bytes.
inline std::size_t changed_bytes(std::span<const std::byte> a, std::span<const std::byte> b) {
  std::size_t changed = 0;
  for (std::size_t k = 0; k + 8 <= a.size(); k += 8)
    changed += std::memcmp(a.data() + k, b.data() + k, 8) ? 12 : 0;
  return changed;
}

/// Words of a block that differ, from the first one on.
struct Patch {
  std::uint16_t word, count;
};

/// Of a ray: which of its numbers are there.
enum RayFlag : std::uint8_t {
  kMet = 1,
  kElsewhere = 2,  ///< x and y are not those of where it was cast
  kTurned = 4,     ///< another normal than that of the ray before
  kOther = 8       ///< another ground than that of the ray before
};

/// A ray's hit and what it is compared with, numbers being compared by their bits.
template <class T>
struct RayBefore {
  Vec3<T> normal = Vec3<T>::UnitZ();
  std::int32_t ground = -1;
};

/// Of a frame with a whole block at most; whose patches take no more.
template <class T>
constexpr std::size_t most_frame_bytes(std::size_t block, int joints, bool feet) {
  return rounded(sizeof(FrameHead<T>) + block + (feet ? kMostRays * (1 + 6 * sizeof(T) + 4) : 0) +
                 kMostDurations * sizeof(T) + (feet ? kMostBodies * 21 * sizeof(T) : 0) +
                 std::size_t(joints) * 20 * sizeof(T));
}

/// Appends to a frame; there must be room.
template <class T>
class FrameWriter {
 public:
  explicit FrameWriter(std::byte* at) : at_(at) {}

  std::byte* end() const { return at_; }
  void number(T x) { put(x); }
  void vector(const Vec3<T>& v) {
    for (int k = 0; k < 3; ++k) put(T(v[k]));
  }
  void jet(const JointJet<T>& jet) {
    for (int k = 0; k < 4; ++k) put(T(jet.rotation.coeffs()[k]));
    for (const Vec3<T>* v : {&jet.omega, &jet.alpha, &jet.translation, &jet.velocity, &jet.acceleration})
      vector(*v);
  }
  void body(const MovingTransform<T>& body) {
    const MovingRotation<T>& turned = body.rotation;
    for (int k = 0; k < 4; ++k) put(turned.value.coeffs()[k]);
    vector(turned.omega);
    vector(turned.alpha);
    for (int k = 0; k < 3; ++k) moving(body.translation[k]);
  }
  void ray(const Vec3<T>& from, const GroundHit<T>& hit, bool met) {
    const auto same = [](const Vec3<T>& a, const Vec3<T>& b, int count) {
      return std::memcmp(a.data(), b.data(), std::size_t(count) * sizeof(T)) == 0;
    };
    std::uint8_t flags = met ? kMet : 0;
    if (met && !same(hit.point, from, 2)) flags |= kElsewhere;
    if (met && !same(hit.normal, before_.normal, 3)) flags |= kTurned;
    if (met && hit.ground != before_.ground) flags |= kOther;
    put(flags);
    if (flags & kElsewhere) put(T(hit.point.x())), put(T(hit.point.y()));
    if (flags & kMet) put(T(hit.point.z()));
    if (flags & kTurned) vector(before_.normal = hit.normal);
    if (flags & kOther) put(before_.ground = static_cast<std::int32_t>(hit.ground));
  }
  /// A whole block; no patches.
  std::uint16_t block(std::span<const std::byte> block) {
    std::memcpy(at_, block.data(), block.size());
    at_ += block.size();
    return 0;
  }
  /// What of a block differs from `before`; how many patches.
  std::uint16_t changes(std::span<const std::byte> before, std::span<const std::byte> block) {
    const std::size_t words = block.size() / 8;
    const auto differs = [&](std::size_t w) {
      return w < words && std::memcmp(before.data() + 8 * w, block.data() + 8 * w, 8) != 0;
    };
    std::uint16_t patches = 0;
    for (std::size_t w = 0; w < words; ++w) {
      if (!differs(w)) continue;
      std::size_t end = w;
      while (differs(end)) ++end;
      put(Patch{static_cast<std::uint16_t>(w), static_cast<std::uint16_t>(end - w)});
      std::memcpy(at_, block.data() + 8 * w, 8 * (end - w));
      at_ += 8 * (end - w);
      ++patches;
      w = end;
    }
    return patches;
  }

 private:
  template <class V>
  void put(const V& value) {
    std::memcpy(at_, &value, sizeof value);
    at_ += sizeof value;
  }
  void moving(const TimeJet<T>& x) { put(x.value), put(x.rate), put(x.acceleration); }

  std::byte* at_;
  RayBefore<T> before_;
};

/// Reads it again. Bytes that are not there give zeros, and good() is false then.
template <class T>
class FrameReader {
 public:
  explicit FrameReader(std::span<const std::byte> bytes) : bytes_(bytes) {}

  bool good() const { return good_; }
  FrameHead<T> head() { return get<FrameHead<T>>(); }
  T number() { return get<T>(); }
  Vec3<T> vector() {
    Vec3<T> out;
    for (int k = 0; k < 3; ++k) out[k] = get<T>();
    return out;
  }
  JointJet<T> jet() {
    JointJet<T> out;
    for (int k = 0; k < 4; ++k) out.rotation.coeffs()[k] = get<T>();
    for (Vec3<T>* v : {&out.omega, &out.alpha, &out.translation, &out.velocity, &out.acceleration})
      *v = vector();
    return out;
  }
  MovingTransform<T> body() {
    MovingTransform<T> out;
    for (int k = 0; k < 4; ++k) out.rotation.value.coeffs()[k] = get<T>();
    out.rotation.omega = vector();
    out.rotation.alpha = vector();
    for (int k = 0; k < 3; ++k) out.translation[k] = moving();
    return out;
  }
  /// Whether it met something.
  bool ray(const Vec3<T>& from, GroundHit<T>& hit) {
    const auto flags = get<std::uint8_t>();
    if (!(flags & kMet)) return false;
    hit.point = from;
    if (flags & kElsewhere) {
      hit.point.x() = get<T>();
      hit.point.y() = get<T>();
    }
    hit.point.z() = get<T>();
    if (flags & kTurned) before_.normal = vector();
    if (flags & kOther) before_.ground = get<std::int32_t>();
    hit.normal = before_.normal;
    hit.ground = before_.ground;
    return true;
  }
  /// Puts a block, or its patches, into `block`; false where they do not fit.
  bool take_block(const FrameHead<T>& head, std::span<std::byte> block) {
    if (head.has(kWhole)) return copy(block);
    for (std::uint16_t k = 0; k < head.patches; ++k) {
      const auto patch = get<Patch>();
      const std::size_t begin = 8 * std::size_t(patch.word), count = 8 * std::size_t(patch.count);
      if (begin + count > block.size() || !copy(block.subspan(begin, count))) return good_ = false;
    }
    return good_;
  }
  void skip_block(const FrameHead<T>& head, std::size_t block_bytes) {
    if (head.has(kWhole)) return skip(block_bytes);
    for (std::uint16_t k = 0; k < head.patches; ++k) skip(8 * std::size_t(get<Patch>().count));
  }
  void skip(std::size_t bytes) {
    good_ = good_ && bytes <= bytes_.size();
    bytes_ = bytes_.subspan(good_ ? bytes : 0);
  }

 private:
  bool copy(std::span<std::byte> out) {
    good_ = good_ && out.size() <= bytes_.size();
    if (good_) std::memcpy(out.data(), bytes_.data(), out.size());
    skip(good_ ? out.size() : 0);
    return good_;
  }
  template <class V>
  V get() {
    V value{};
    std::byte raw[sizeof(V)];
    if (copy(raw)) std::memcpy(static_cast<void*>(&value), raw, sizeof value);
    return value;
  }
  TimeJet<T> moving() {
    const T value = get<T>(), rate = get<T>(), acceleration = get<T>();
    return {value, rate, acceleration};
  }

  std::span<const std::byte> bytes_;
  bool good_ = true;
  RayBefore<T> before_;
};

}  // namespace sinew::recorded
