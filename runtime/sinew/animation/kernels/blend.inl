// Blends of jets, a pack of joints at a time. Included once per instruction set with SINEW_KERNELS naming it.
#include "sinew/animation/kernels/jet_algebra.h"
#include "sinew/animation/kernels/kernels.h"
#include "sinew/animation/kernels/lanes.h"

namespace sinew::kernels {
namespace {

constexpr int kNumbers = 20;  ///< of a jet, padding included
constexpr int kRotation = 0, kOmega = 4, kAlpha = 7, kTranslation = 10, kVelocity = 13, kAcceleration = 16;

/// Jets of a pack of joints, number by number in the order of JetLayout.
template <class P>
struct PackedJets {
  P number[kNumbers];
};

/// jets = other where a equals b.
template <class P>
void replace_where_equal(const P& a, typename P::Scalar b, const PackedJets<P>& other, PackedJets<P>& jets) {
  for (int i = 0; i < kNumbers; ++i) jets.number[i] = where_equal(a, b, other.number[i], jets.number[i]);
}
/// jets = other where a does not.
template <class P>
void replace_where_not(const P& a, typename P::Scalar b, const PackedJets<P>& other, PackedJets<P>& jets) {
  for (int i = 0; i < kNumbers; ++i) jets.number[i] = where_equal(a, b, jets.number[i], other.number[i]);
}

/// Which joints a pack holds; the last one repeats where there are fewer joints than lanes.
template <class P>
struct Block {
  using T = typename P::Scalar;
  int joint[P::kLanes];

  Block(int first, int end) {
    for (int i = 0; i < P::kLanes; ++i) joint[i] = first + i < end ? first + i : end - 1;
  }
  P load(const T* numbers) const {
    P x;
    for (int i = 0; i < P::kLanes; ++i) x.v[i] = numbers[joint[i]];
    return x;
  }
  PackedJets<P> load(const JetLayout<T>* jets) const {
    const T* from = reinterpret_cast<const T*>(jets);
    PackedJets<P> packed;
    for (int c = 0; c < kNumbers; c += 4) {
      P m[4];
      for (int r = 0; r < 4; ++r)
        m[r] = load_fours<P>([&](int group) { return from + kNumbers * joint[4 * group + r] + c; });
      transpose(m);
      for (int r = 0; r < 4; ++r) packed.number[c + r] = m[r];
    }
    return packed;
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
  void store(const PackedJets<P>& packed, JetLayout<T>* jets) const {
    T* to = reinterpret_cast<T*>(jets);
    for (int c = 0; c < kNumbers; c += 4) {
      P m[4] = {packed.number[c], packed.number[c + 1], packed.number[c + 2], packed.number[c + 3]};
      transpose(m);
      for_each_index<P::kLanes / 4>([&](auto group) {
        for (int r = 0; r < 4; ++r)
          sinew::store<4 * group, 4>(m[r], to + kNumbers * joint[4 * group + r] + c);
      });
    }
  }
};

/// A quaternion in R⁴ and a translation, moving.
template <class P>
struct Moving {
  TimeJet<P> rotation[4], translation[3];
};

template <class P>
Moving<P> moving(const PackedJets<P>& jets) {
  const P* x = jets.number;
  Moving<P> m;
  quaternion_jet(x + kRotation, x + kOmega, x + kAlpha, m.rotation);
  for (int i = 0; i < 3; ++i)
    m.translation[i] = {x[kTranslation + i], x[kVelocity + i], x[kAcceleration + i]};
  return m;
}

template <class P>
PackedJets<P> packed(const Moving<P>& m) {
  PackedJets<P> jets;
  P p[4], dp[4], ddp[4], rotation[4], omega[3], alpha[3];
  for (int i = 0; i < 4; ++i) {
    p[i] = m.rotation[i].value;
    dp[i] = m.rotation[i].rate;
    ddp[i] = m.rotation[i].acceleration;
  }
  project(p, dp, ddp, rotation, omega, alpha);
  for (int i = 0; i < 4; ++i) jets.number[kRotation + i] = rotation[i];
  for (int i = 0; i < 3; ++i) {
    jets.number[kOmega + i] = omega[i];
    jets.number[kAlpha + i] = alpha[i];
    jets.number[kTranslation + i] = m.translation[i].value;
    jets.number[kVelocity + i] = m.translation[i].rate;
    jets.number[kAcceleration + i] = m.translation[i].acceleration;
  }
  jets.number[kNumbers - 1] = P::all(0);
  return jets;
}

/// One layer on one block: its jets, and its weight at every joint.
template <class P>
struct BlockLayer {
  PackedJets<P> jets;
  P mask;
  TimeJet<P> weight;
  bool full;  ///< where the mask is 1 the layer is all there is

  BlockLayer(const BlendLayerData<typename P::Scalar>& layer, const Block<P>& block)
      : jets(block.load(layer.jets)) {
    mask = layer.mask ? block.load(layer.mask) : P::all(1);
    weight = {layer.weight[0] * mask, layer.weight[1] * mask, layer.weight[2] * mask};
    full = layer.weight[0] == 1 && layer.weight[1] == 0 && layer.weight[2] == 0;
  }
};

/// Quaternion of a layer, of the two that mean its rotation the one nearer to `reference`.
template <class P>
Moving<P> aligned(const PackedJets<P>& jets, const P* reference) {
  Moving<P> m = moving(jets);
  const P* q = jets.number + kRotation;
  const P dot = (q[0] * reference[0] + q[1] * reference[1]) + (q[2] * reference[2] + q[3] * reference[3]);
  const P sign = where_negative(dot, P::all(-1), P::all(1));
  for (TimeJet<P>& x : m.rotation) x = sign * x;
  return m;
}

/// Weighted mean of the mixed layers. A joint with one contributor takes it as it is, one with none stays.
template <class P>
void mix(const BlendData<typename P::Scalar>& data, const Block<P>& block, PackedJets<P>& jets) {
  const P zero = P::all(0);
  Moving<P> sum;
  for (TimeJet<P>& x : sum.rotation) x = {zero, zero, zero};
  for (TimeJet<P>& x : sum.translation) x = {zero, zero, zero};
  TimeJet<P> total{zero, zero, zero};
  P contributors = zero, reference[4] = {zero, zero, zero, zero};
  for (int n = 0; n < data.layer_count; ++n) {
    if (data.layers[n].mode != BlendLayerData<typename P::Scalar>::kMix) continue;
    const BlockLayer<P> layer(data.layers[n], block);
    for (int i = 0; i < 4; ++i)
      reference[i] = where_equal(contributors, 0, layer.jets.number[kRotation + i], reference[i]);
    const Moving<P> m = aligned(layer.jets, reference);
    for (int i = 0; i < 4; ++i) sum.rotation[i] = sum.rotation[i] + layer.weight * m.rotation[i];
    for (int i = 0; i < 3; ++i) sum.translation[i] = sum.translation[i] + layer.weight * m.translation[i];
    total = total + layer.weight;
    replace_where_not(layer.mask, 0, layer.jets, jets);
    contributors = contributors + where_equal(layer.mask, 0, zero, P::all(1));
  }
  const TimeJet<P> inverse = TimeJet<P>{P::all(1), zero, zero} / total;
  for (TimeJet<P>& x : sum.translation) x = inverse * x;  // the length of the quaternion cancels by itself
  contributors = where_equal(total.value, 0, zero, contributors);  // weights that only begin to grow
  const P several = where_negative(P::all(1) - contributors, P::all(1), zero);
  replace_where_equal(several, 1, packed(sum), jets);
}

/// (1 − w)·below + w·layer.
template <class P>
void override_below(const BlockLayer<P>& layer, PackedJets<P>& below) {
  Moving<P> m = moving(below);
  const Moving<P> over = aligned(layer.jets, below.number + kRotation);
  for (int i = 0; i < 4; ++i)
    m.rotation[i] = m.rotation[i] + layer.weight * (over.rotation[i] - m.rotation[i]);
  for (int i = 0; i < 3; ++i)
    m.translation[i] = m.translation[i] + layer.weight * (over.translation[i] - m.translation[i]);
  replace_where_not(layer.mask, 0, packed(m), below);
  if (layer.full) replace_where_equal(layer.mask, 1, layer.jets, below);
}

/// Rotation below·((1 − w)·1 + w·layer), translation below + w·layer.
template <class P>
void add_to_below(const BlockLayer<P>& layer, PackedJets<P>& below) {
  const P zero = P::all(0), one = P::all(1);
  const P identity[4] = {zero, zero, zero, one};
  Moving<P> m = moving(below);
  const Moving<P> over = aligned(layer.jets, identity);
  TimeJet<P> part[4];
  for (int i = 0; i < 4; ++i) {
    part[i] = over.rotation[i];
    part[i].value = part[i].value - identity[i];
    part[i] = layer.weight * part[i];
    part[i].value = part[i].value + identity[i];
  }
  TimeJet<P> turned[4];
  multiply(m.rotation, part, turned);
  for (int i = 0; i < 4; ++i) m.rotation[i] = turned[i];
  for (int i = 0; i < 3; ++i) m.translation[i] = m.translation[i] + layer.weight * over.translation[i];
  replace_where_not(layer.mask, 0, packed(m), below);
}

template <class T>
void blend_all(const BlendData<T>& data, int joints, JetLayout<T>* out) {
  using P = typename LanesOf<T>::Type;
  using Layer = BlendLayerData<T>;
  for (int first = 0; first < joints; first += P::kLanes) {
    const Block<P> block(first, joints);
    PackedJets<P> jets = block.still(data.rest);
    mix(data, block, jets);
    for (int n = 0; n < data.layer_count; ++n) {
      if (data.layers[n].mode == Layer::kMix) continue;
      const BlockLayer<P> layer(data.layers[n], block);
      data.layers[n].mode == Layer::kOverride ? override_below(layer, jets) : add_to_below(layer, jets);
    }
    block.store(jets, out);
  }
}

}  // namespace

namespace SINEW_KERNELS {
void blend(const BlendData<float>& data, int joints, JetLayout<float>* out) {
  blend_all(data, joints, out);
}
void blend(const BlendData<double>& data, int joints, JetLayout<double>* out) {
  blend_all(data, joints, out);
}
}  // namespace SINEW_KERNELS
}  // namespace sinew::kernels
