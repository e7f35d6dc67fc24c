// Jets of several joints side by side: a pack for every number of a jet. Internal linkage, as pack.h.
#pragma once

#include "sinew/animation/kernels/kernels.h"
#include "sinew/animation/kernels/offset_jet.h"
#include "sinew/animation/kernels/pack.h"

namespace sinew::kernels {
namespace {

constexpr int kNumbers = 20;      ///< of a jet, padding included
constexpr int kTurnNumbers = 12;  ///< the first ones: all of the rotation, and two of the translation
constexpr int kRotation = 0, kOmega = 4, kAlpha = 7, kTranslation = 10, kVelocity = 13, kAcceleration = 16;

/// Jets of a pack of joints, number by number in the order of JetLayout.
template <class P>
struct PackedJets {
  P number[kNumbers];
};

template <class P>
OffsetRotation<P> rotation_part(const PackedJets<P>& jets) {
  OffsetRotation<P> r;
  for (int i = 0; i < 4; ++i) r.q[i] = jets.number[kRotation + i];
  for (int i = 0; i < 3; ++i) {
    r.omega[i] = jets.number[kOmega + i];
    r.alpha[i] = jets.number[kAlpha + i];
  }
  return r;
}
template <class P>
void set_rotation_part(const OffsetRotation<P>& r, PackedJets<P>& jets) {
  for (int i = 0; i < 4; ++i) jets.number[kRotation + i] = r.q[i];
  for (int i = 0; i < 3; ++i) {
    jets.number[kOmega + i] = r.omega[i];
    jets.number[kAlpha + i] = r.alpha[i];
  }
}

/// Which joints a pack holds; the last one repeats where there are fewer joints than lanes. Whole blocks read
/// and write at fixed distances: addresses of single joints would cost as much as the arithmetic.
template <class P>
struct Block {
  using T = typename P::Scalar;
  int first, last;
  bool whole;

  Block(int begin, int end) : first(begin), last(end - 1), whole(begin + P::kLanes <= end) {}
  int joint(int lane) const { return first + lane < last ? first + lane : last; }

  P load(const T* numbers) const { return whole ? P::load(numbers + first) : load_part(numbers); }
  PackedJets<P> load(const JetLayout<T>* jets) const {
    const T* from = reinterpret_cast<const T*>(jets);
    if (!whole) return load_jets_part(from);
    const T* begin = from + kNumbers * first;
    return load_at([&](int lane) { return begin + kNumbers * lane; });
  }
  /// The first kTurnNumbers alone.
  PackedJets<P> load_turns(const JetLayout<T>* jets) const {
    const T* from = reinterpret_cast<const T*>(jets);
    if (!whole) return load_jets_part(from);
    const T* begin = from + kNumbers * first;
    return load_at<kTurnNumbers>([&](int lane) { return begin + kNumbers * lane; });
  }
  /// At rest in the poses given, or at the parent's origin.
  PackedJets<P> still(const PoseLayout<T>* poses) const {
    PackedJets<P> packed;
    for (P& number : packed.number) number = P::all(0);
    rotations(poses, packed.number + kRotation);
    if (poses) translations(poses, packed.number + kTranslation);
    return packed;
  }
  /// Of poses, x y z w; of none that of the parent.
  void rotations(const PoseLayout<T>* poses, P* out) const {
    if (!poses) {
      for (int c = 0; c < 4; ++c) out[c] = P::all(c == 3 ? 1 : 0);
      return;
    }
    load_four(reinterpret_cast<const T*>(poses), out);
  }
  /// Of poses, x y z.
  void translations(const PoseLayout<T>* poses, P* out) const {
    P four[4];
    load_four(reinterpret_cast<const T*>(poses) + 4, four);
    for (int c = 0; c < 3; ++c) out[c] = four[c];
  }
  void store(const PackedJets<P>& packed, JetLayout<T>* jets) const {
    T* to = reinterpret_cast<T*>(jets);
    if (!whole) return store_part(packed, to);
    T* begin = to + kNumbers * first;
    store_at(packed, [&](int lane) { return begin + kNumbers * lane; });
  }
  /// The first kTurnNumbers alone; the others are those of `rest`, which may be `jets`.
  void store_turns(const PackedJets<P>& packed, const JetLayout<T>* rest, JetLayout<T>* jets) const {
    T* to = reinterpret_cast<T*>(jets);
    if (rest != jets)
      for (int i = 0; i < P::kLanes; ++i) {
        const int at = kNumbers * (whole ? first + i : joint(i)) + kTurnNumbers;
        sinew::store<0, kNumbers - kTurnNumbers>(
            Pack<T, kNumbers - kTurnNumbers>::load(reinterpret_cast<const T*>(rest) + at), to + at);
      }
    if (!whole) return store_part<kTurnNumbers>(packed, to);
    T* begin = to + kNumbers * first;
    store_at<kTurnNumbers>(packed, [&](int lane) { return begin + kNumbers * lane; });
  }

 private:
  static constexpr int kPoseNumbers = 8;  ///< of a PoseLayout, padding included

  template <class At>
  [[gnu::always_inline]] static void load_four_at(At at, P* out) {
    P m[4];
    for (int r = 0; r < 4; ++r) m[r] = load_fours<P>([&](int group) { return at(4 * group + r); });
    transpose(m);
    for (int k = 0; k < 4; ++k) out[k] = m[k];
  }
  /// Four numbers of each pose.
  [[gnu::always_inline]] void load_four(const T* from, P* out) const {
    if (!whole) return load_four_part(from, out);
    const T* begin = from + kPoseNumbers * first;
    load_four_at([&](int lane) { return begin + kPoseNumbers * lane; }, out);
  }
  template <int kCount = kNumbers, class At>
  [[gnu::always_inline]] static PackedJets<P> load_at(At at) {
    PackedJets<P> packed;
    for (int c = 0; c < kCount; c += 4) {
      P m[4];
      load_four_at([&](int lane) { return at(lane) + c; }, m);
      for (int r = 0; r < 4; ++r) packed.number[c + r] = m[r];
    }
    return packed;
  }
  template <int kCount = kNumbers, class At>
  [[gnu::always_inline]] static void store_at(const PackedJets<P>& packed, At at) {
    for (int c = 0; c < kCount; c += 4) {
      P m[4] = {packed.number[c], packed.number[c + 1], packed.number[c + 2], packed.number[c + 3]};
      transpose(m);
      for_each_index<P::kLanes / 4>([&](auto group) __attribute__((always_inline)) {
        for (int r = 0; r < 4; ++r) sinew::store<4 * group, 4>(m[r], at(4 * group + r) + c);
      });
    }
  }
  // The last block alone: kept out of the loops, which would work its addresses out for every block.
  [[gnu::noinline]] P load_part(const T* numbers) const {
    P x;
    for (int i = 0; i < P::kLanes; ++i) x.v[i] = numbers[joint(i)];
    return x;
  }
  [[gnu::noinline]] void load_four_part(const T* from, P* out) const {
    load_four_at([&](int lane) { return from + kPoseNumbers * joint(lane); }, out);
  }
  [[gnu::noinline]] PackedJets<P> load_jets_part(const T* from) const {
    return load_at([&](int lane) { return from + kNumbers * joint(lane); });
  }
  template <int kCount = kNumbers>
  [[gnu::noinline]] void store_part(const PackedJets<P>& packed, T* to) const {
    T all[P::kLanes * kNumbers];
    store_at<kCount>(packed, [&](int lane) { return all + kNumbers * lane; });
    for (int i = 0; i <= last - first; ++i)
      for (int c = 0; c < kCount; ++c) to[kNumbers * (first + i) + c] = all[kNumbers * i + c];
  }
};

}  // namespace
}  // namespace sinew::kernels
