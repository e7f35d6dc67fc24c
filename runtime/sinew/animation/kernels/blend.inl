// Blends of jets, a pack of joints at a time. Included once per instruction set with SINEW_KERNELS naming it.
#include "sinew/animation/kernels/jet_algebra.h"
#include "sinew/animation/kernels/kernels.h"
#include "sinew/animation/kernels/lanes.h"
#include "sinew/animation/kernels/packed_jets.h"

namespace sinew::kernels {
namespace {

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

/// A quaternion in R⁴ and a translation, moving.
template <class P>
struct Moving {
  TimeJet<P> rotation[4], translation[3];
};

template <class P>
[[gnu::always_inline]] inline Moving<P> moving(const PackedJets<P>& jets) {
  const P* x = jets.number;
  Moving<P> m;
  quaternion_jet(x + kRotation, x + kOmega, x + kAlpha, m.rotation);
  for (int i = 0; i < 3; ++i)
    m.translation[i] = {x[kTranslation + i], x[kVelocity + i], x[kAcceleration + i]};
  return m;
}

template <class P>
[[gnu::always_inline]] inline PackedJets<P> packed(const Moving<P>& m) {
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
  bool full;    ///< where the mask is 1 the layer is all there is
  bool masked;  ///< otherwise the mask is 1 throughout

  BlockLayer(const BlendLayerData<typename P::Scalar>& layer, const Block<P>& block)
      : jets(block.load(layer.jets)), masked(layer.mask != nullptr) {
    mask = layer.mask ? block.load(layer.mask) : P::all(1);
    weight = {layer.weight[0] * mask, layer.weight[1] * mask, layer.weight[2] * mask};
    full = layer.weight[0] == 1 && layer.weight[1] == 0 && layer.weight[2] == 0;
  }
};

/// Quaternions of a motion, of the two that mean its rotation the one nearer to `reference`.
template <class P>
Moving<P> aligned(const PackedJets<P>& jets, const P* reference) {
  Moving<P> m = moving(jets);
  const P* q = jets.number + kRotation;
  const P dot = (q[0] * reference[0] + q[1] * reference[1]) + (q[2] * reference[2] + q[3] * reference[3]);
  const P sign = where_negative(dot, P::all(-1), P::all(1));
  for (TimeJet<P>& x : m.rotation) x = sign * x;
  return m;
}

/// Weighted mean of the mixed layers. A joint with one contributor takes it as it is, one with none stays at
/// rest, as `jets` are.
template <class P>
void mix(const BlendData<typename P::Scalar>& data, const Block<P>& block, PackedJets<P>& jets) {
  const P zero = P::all(0);
  Moving<P> sum;
  for (TimeJet<P>& x : sum.rotation) x = {zero, zero, zero};
  for (TimeJet<P>& x : sum.translation) x = {zero, zero, zero};
  TimeJet<P> total{zero, zero, zero};
  P contributors = zero, reference[4];
  for (int i = 0; i < 4; ++i) reference[i] = jets.number[kRotation + i];
  for (int n = 0; n < data.layer_count; ++n) {
    if (data.layers[n].mode != BlendLayerData<typename P::Scalar>::kMix) continue;
    const BlockLayer<P> layer(data.layers[n], block);
    for (int i = 0; i < 4 && !data.rest; ++i)  // then the first layer's, joint by joint
      reference[i] = where_equal(contributors, 0, layer.jets.number[kRotation + i], reference[i]);
    const Moving<P> m = aligned(layer.jets, reference);
    for (int i = 0; i < 4; ++i) sum.rotation[i] = sum.rotation[i] + layer.weight * m.rotation[i];
    for (int i = 0; i < 3; ++i) sum.translation[i] = sum.translation[i] + layer.weight * m.translation[i];
    total = total + layer.weight;
    if (layer.masked) {
      replace_where_not(layer.mask, 0, layer.jets, jets);
      contributors = contributors + where_equal(layer.mask, 0, zero, P::all(1));
    } else {
      jets = layer.jets;
      contributors = contributors + P::all(1);
    }
  }
  const TimeJet<P> inverse = TimeJet<P>{P::all(1), zero, zero} / total;
  for (TimeJet<P>& x : sum.translation) x = inverse * x;  // the length of the quaternion cancels by itself
  contributors = where_equal(total.value, 0, zero, contributors);  // weights that only begin to grow
  const auto several = contributors > P::all(1);
  if (!any(!several))
    jets = packed(sum);
  else if (any(several))
    replace_where_equal(select(several, P::all(1), zero), 1, packed(sum), jets);
}

/// (1 − w)·below + w·layer, both as quaternions on the side of `reference`.
template <class P>
void override_below(const BlockLayer<P>& layer, const P* reference, PackedJets<P>& below) {
  Moving<P> m = aligned(below, reference);
  const Moving<P> over = aligned(layer.jets, reference);
  for (int i = 0; i < 4; ++i)
    m.rotation[i] = m.rotation[i] + layer.weight * (over.rotation[i] - m.rotation[i]);
  for (int i = 0; i < 3; ++i)
    m.translation[i] = m.translation[i] + layer.weight * (over.translation[i] - m.translation[i]);
  if (!layer.masked) {
    below = layer.full ? layer.jets : packed(m);
    return;
  }
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
  if (layer.masked)
    replace_where_not(layer.mask, 0, packed(m), below);
  else
    below = packed(m);
}

template <class T>
void blend_all(const BlendData<T>& data, int joints, JetLayout<T>* out) {
  using P = typename LanesOf<T>::Type;
  using Layer = BlendLayerData<T>;
  for (int first = 0; first < joints; first += P::kLanes) {
    const Block<P> block(first, joints);
    PackedJets<P> jets = block.still(data.rest);
    const PackedJets<P> rest = jets;
    const P* reference = (data.rest ? rest : jets).number + kRotation;
    mix(data, block, jets);
    for (int n = 0; n < data.layer_count; ++n) {
      if (data.layers[n].mode == Layer::kMix) continue;
      const BlockLayer<P> layer(data.layers[n], block);
      data.layers[n].mode == Layer::kOverride ? override_below(layer, reference, jets)
                                              : add_to_below(layer, jets);
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
