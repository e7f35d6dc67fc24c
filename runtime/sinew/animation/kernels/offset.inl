// Offsets between motions and what is left of them, a pack of joints at a time. Included once per instruction
// set with SINEW_KERNELS naming it.
#include "sinew/animation/kernels/kernels.h"
#include "sinew/animation/kernels/lanes.h"
#include "sinew/animation/kernels/offset_jet.h"
#include "sinew/animation/kernels/packed_jets.h"

namespace sinew::kernels {
namespace {

/// Where the offsets of a joint stand: [block][number][kOffsetBlock].
template <class T>
T* offsets_of(T* offsets, int joint) {
  return offsets + joint / kOffsetBlock * (kOffsetPart * kOffsetBlock) + joint % kOffsetBlock;
}
template <class P>
[[gnu::always_inline]] inline void load_offsets(const typename P::Scalar* offsets, const Block<P>& block,
                                                P (&out)[kOffsetPart]) {
  if (block.whole) {
    const auto* from = offsets_of(offsets, block.first);
    for (int i = 0; i < kOffsetPart; ++i) out[i] = P::load(from + i * kOffsetBlock);
  } else {
    for (int i = 0; i < kOffsetPart; ++i) {
      typename P::Scalar gathered[P::kLanes];
      for (int lane = 0; lane < P::kLanes; ++lane)
        gathered[lane] = offsets_of(offsets, block.joint(lane))[i * kOffsetBlock];
      out[i] = P::load(gathered);
    }
  }
}

/// 1 for the block's joints before `end`, 0 for the others: a block may hold both.
template <class P>
P before(int end, const Block<P>& block) {
  using T = typename P::Scalar;
  T flags[P::kLanes];
  for (int lane = 0; lane < P::kLanes; ++lane) flags[lane] = block.joint(lane) < end ? T(1) : T(0);
  return P::load(flags);
}

template <class T>
void take_offsets(const JetLayout<T>* from, const JetLayout<T>* to, int joints, const OffsetNumbers<T>& out) {
  using P = typename LanesOf<T>::Type;
  for (int first = 0; first < joints; first += P::kLanes) {
    const Block<P> block(first, joints);
    const PackedJets<P> a = block.load(from), b = block.load(to);
    P sigma[3], rate[3], acceleration[3];
    parameters_of(difference(rotation_part(a), rotation_part(b)), sigma, rate, acceleration);
    T* rotation = offsets_of(out.rotations, first);
    for (int i = 0; i < 3; ++i) {
      store<0, P::kLanes>(sigma[i], rotation + i * kOffsetBlock);
      store<0, P::kLanes>(rate[i], rotation + (3 + i) * kOffsetBlock);
      store<0, P::kLanes>(acceleration[i], rotation + (6 + i) * kOffsetBlock);
    }
    if (first >= out.translated) continue;
    const P moved = before(out.translated, block);
    T* translation = offsets_of(out.translations, first);
    for (int i = 0; i < kOffsetPart; ++i) {
      const P apart = a.number[kTranslation + i] - b.number[kTranslation + i];
      store<0, P::kLanes>(where_equal(moved, T(1), apart, P::all(0)), translation + i * kOffsetBlock);
    }
  }
}

/// Adds what is left of the offsets of a block's translations.
template <class P>
void add_shifts(const OffsetFade<typename P::Scalar>& data, const QuinticOffset<P>& fade,
                const Block<P>& block, PackedJets<P>& jets) {
  P start[kOffsetPart], value[3], rate[3], acceleration[3];
  load_offsets(data.offsets.translations, block, start);
  faded(fade, start, value, rate, acceleration);
  const P moved = before(data.offsets.translated, block);
  const auto add = [&](P& number, const P& offset) {
    number = where_equal(moved, 1, number + offset, number);
  };
  for (int i = 0; i < 3; ++i) {
    add(jets.number[kTranslation + i], value[i]);
    add(jets.number[kVelocity + i], rate[i]);
    add(jets.number[kAcceleration + i], acceleration[i]);
  }
}

template <class T>
void add_all(const JetLayout<T>* to, const OffsetFade<T>& data, int joints, JetLayout<T>* out) {
  using P = typename LanesOf<T>::Type;
  const P elapsed = P::all(data.elapsed);
  QuinticOffset<P> fade = QuinticOffset<P>::at(elapsed, P::all(data.duration));
  for (int first = 0; first < joints; first += P::kLanes) {
    const Block<P> block(first, joints);
    const bool shifts = first < data.offsets.translated;
    if (data.profile) fade = QuinticOffset<P>::at(elapsed, data.duration * block.load(data.profile));
    PackedJets<P> jets = shifts ? block.load(to) : block.load_turns(to);
    P start[kOffsetPart], value[3], rate[3], acceleration[3];
    load_offsets(data.offsets.rotations, block, start);
    faded(fade, start, value, rate, acceleration);
    set_rotation_part(composition(rotation_part(jets), rotation_of(value, rate, acceleration)), jets);
    if (shifts) {
      add_shifts(data, fade, block, jets);
      block.store(jets, out);
    } else {
      block.store_turns(jets, to, out);
    }
  }
}

/// The displacement of a rotation is a quarter of its parameters, of which the motion begins at 0.
template <class T>
void go_on(const JetLayout<T>* from, const Extrapolation<T>& data, int joints, JetLayout<T>* out) {
  using P = typename LanesOf<T>::Type;
  const auto moved = [&](const P& speed, const P& change, int derivative) {
    return data.of_rate[derivative] * speed + data.of_acceleration[derivative] * change;
  };
  for (int first = 0; first < joints; first += P::kLanes) {
    const Block<P> block(first, joints);
    PackedJets<P> jets = block.load(from);
    OffsetRotation<P> begin = rotation_part(jets);
    P parameters[3][3];
    for (int d = 0; d < 3; ++d)
      for (int i = 0; i < 3; ++i) parameters[d][i] = T(0.25) * moved(begin.omega[i], begin.alpha[i], d);
    for (int i = 0; i < 3; ++i) begin.omega[i] = begin.alpha[i] = P::all(0);
    set_rotation_part(composition(begin, rotation_of(parameters[0], parameters[1], parameters[2])), jets);
    for (int i = 0; i < 3; ++i) {
      const P speed = jets.number[kVelocity + i], change = jets.number[kAcceleration + i];
      jets.number[kTranslation + i] = jets.number[kTranslation + i] + moved(speed, change, 0);
      jets.number[kVelocity + i] = moved(speed, change, 1);
      jets.number[kAcceleration + i] = moved(speed, change, 2);
    }
    block.store(jets, out);
  }
}

}  // namespace

namespace SINEW_KERNELS {

#define SINEW_DEFINE_OFFSET_KERNELS(T)                                                                      \
  void start_offsets(const JetLayout<T>* from, const JetLayout<T>* to, int joints,                          \
                     const OffsetNumbers<T>& out) {                                                         \
    take_offsets(from, to, joints, out);                                                                    \
  }                                                                                                         \
  void add_offsets(const JetLayout<T>* to, const OffsetFade<T>& fade, int joints, JetLayout<T>* out) {      \
    add_all(to, fade, joints, out);                                                                         \
  }                                                                                                         \
  void extrapolate(const JetLayout<T>* from, const Extrapolation<T>& data, int joints, JetLayout<T>* out) { \
    go_on(from, data, joints, out);                                                                         \
  }
SINEW_DEFINE_OFFSET_KERNELS(float)
SINEW_DEFINE_OFFSET_KERNELS(double)

}  // namespace SINEW_KERNELS
}  // namespace sinew::kernels
