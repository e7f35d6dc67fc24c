// Jets of several joints side by side: a pack for every number of a jet. Internal linkage, as pack.h.
#pragma once

#include "sinew/animation/kernels/kernels.h"
#include "sinew/animation/kernels/pack.h"

namespace sinew::kernels {
namespace {

constexpr int kNumbers = 20;  ///< of a jet, padding included
constexpr int kRotation = 0, kOmega = 4, kAlpha = 7, kTranslation = 10, kVelocity = 13, kAcceleration = 16;

/// Jets of a pack of joints, number by number in the order of JetLayout.
template <class P>
struct PackedJets {
  P number[kNumbers];
};

/// Which joints a pack holds; the last one repeats where there are fewer joints than lanes. Whole blocks read
/// and write at fixed distances: addresses of single joints would cost as much as the arithmetic.
template <class P>
struct Block {
  using T = typename P::Scalar;
  int joint[P::kLanes];
  bool whole;

  Block(int first, int end) : whole(first + P::kLanes <= end) {
    for (int i = 0; i < P::kLanes; ++i) joint[i] = first + i < end ? first + i : end - 1;
  }
  P load(const T* numbers) const {
    if (whole) return P::load(numbers + joint[0]);
    P x;
    for (int i = 0; i < P::kLanes; ++i) x.v[i] = numbers[joint[i]];
    return x;
  }
  PackedJets<P> load(const JetLayout<T>* jets) const {
    const T* from = reinterpret_cast<const T*>(jets);
    if (!whole) return load_part(from);
    const T* first = from + kNumbers * joint[0];
    return load_at([&](int lane) { return first + kNumbers * lane; });
  }
  /// At rest in the poses given, or at the parent's origin.
  PackedJets<P> still(const PoseLayout<T>* poses) const {
    PackedJets<P> packed;
    for (P& number : packed.number) number = P::all(0);
    packed.number[kRotation + 3] = P::all(1);
    if (!poses) return packed;
    for (int i = 0; i < P::kLanes; ++i) {
      for (int c = 0; c < 4; ++c) packed.number[kRotation + c].v[i] = poses[joint[i]].rotation[c];
      for (int c = 0; c < 3; ++c) packed.number[kTranslation + c].v[i] = poses[joint[i]].translation[c];
    }
    return packed;
  }
  /// Of poses, x y z w; of none that of the parent.
  void rotations(const PoseLayout<T>* poses, P* out) const {
    if (!poses) {
      for (int c = 0; c < 4; ++c) out[c] = P::all(c == 3 ? 1 : 0);
      return;
    }
    P m[4];
    for (int r = 0; r < 4; ++r)
      m[r] = load_fours<P>([&](int group) { return poses[joint[4 * group + r]].rotation; });
    transpose(m);
    for (int c = 0; c < 4; ++c) out[c] = m[c];
  }
  void store(const PackedJets<P>& packed, JetLayout<T>* jets) const {
    T* to = reinterpret_cast<T*>(jets);
    if (!whole) return store_part(packed, to);
    T* first = to + kNumbers * joint[0];
    store_at(packed, [&](int lane) { return first + kNumbers * lane; });
  }

 private:
  template <class At>
  [[gnu::always_inline]] static PackedJets<P> load_at(At at) {
    PackedJets<P> packed;
    for (int c = 0; c < kNumbers; c += 4) {
      P m[4];
      for (int r = 0; r < 4; ++r) m[r] = load_fours<P>([&](int group) { return at(4 * group + r) + c; });
      transpose(m);
      for (int r = 0; r < 4; ++r) packed.number[c + r] = m[r];
    }
    return packed;
  }
  template <class At>
  [[gnu::always_inline]] static void store_at(const PackedJets<P>& packed, At at) {
    for (int c = 0; c < kNumbers; c += 4) {
      P m[4] = {packed.number[c], packed.number[c + 1], packed.number[c + 2], packed.number[c + 3]};
      transpose(m);
      for_each_index<P::kLanes / 4>([&](auto group) __attribute__((always_inline)) {
        for (int r = 0; r < 4; ++r) sinew::store<4 * group, 4>(m[r], at(4 * group + r) + c);
      });
    }
  }
  [[gnu::noinline]] PackedJets<P> load_part(const T* from) const {
    return load_at([&](int lane) { return from + kNumbers * joint[lane]; });
  }
  [[gnu::noinline]] void store_part(const PackedJets<P>& packed, T* to) const {
    store_at(packed, [&](int lane) { return to + kNumbers * joint[lane]; });
  }
};

}  // namespace
}  // namespace sinew::kernels
