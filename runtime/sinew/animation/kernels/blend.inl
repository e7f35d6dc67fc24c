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

/// Σw·p of motions p with weights that move. Of a rotation p' = ½p⊗ω, so that
/// (w·p)' = p⊗(½w·ω, w') and (w·p)'' = p⊗(½w·α + w'·ω, w'' − ¼w·|ω|²).
template <class P>
struct Sum {
  P p[4], dp[4], ddp[4], translation[9];

  /// `First`: of all. The side of the two quaternions that mean a rotation is the one nearer to `reference`;
  /// of none it stays as it is.
  template <bool First>
  [[gnu::always_inline]] void add(const PackedJets<P>& jets, const TimeJet<P>& w, const P* reference) {
    const P* x = jets.number;
    const P* q = x + kRotation;
    P r[4] = {q[0], q[1], q[2], q[3]};
    if (reference) {
      const P dot = (q[0] * reference[0] + q[1] * reference[1]) + (q[2] * reference[2] + q[3] * reference[3]);
      const P sign = where_negative(dot, P::all(-1), P::all(1));
      for (P& c : r) c = sign * c;
    }
    const P *omega = x + kOmega, *alpha = x + kAlpha;
    const P half = P::all(0.5f) * w.value;
    const P square = (omega[0] * omega[0] + omega[1] * omega[1]) + omega[2] * omega[2];
    add_product<First>(r, half * omega[0], half * omega[1], half * omega[2], w.rate, dp);
    add_product<First>(r, half * alpha[0] + w.rate * omega[0], half * alpha[1] + w.rate * omega[1],
                       half * alpha[2] + w.rate * omega[2], w.acceleration - (P::all(0.5f) * half) * square,
                       ddp);
    for (int i = 0; i < 4; ++i) join<First>(p[i], w.value * r[i]);
    const P twice = w.rate + w.rate;
    for (int i = 0; i < 3; ++i) {
      const P t = x[kTranslation + i], v = x[kVelocity + i];
      join<First>(translation[i], w.value * t);
      join<First>(translation[3 + i], w.value * v + w.rate * t);
      join<First>(translation[6 + i], (w.value * x[kAcceleration + i] + twice * v) + w.acceleration * t);
    }
  }
  /// Divides translations by the sum of the weights; the length of a quaternion cancels by itself.
  void divide_translations(const TimeJet<P>& total) {
    const TimeJet<P> inverse = TimeJet<P>{P::all(1), P::all(0), P::all(0)} / total;
    for (int i = 0; i < 3; ++i) {
      const TimeJet<P> x = inverse * TimeJet<P>{translation[i], translation[3 + i], translation[6 + i]};
      translation[i] = x.value;
      translation[3 + i] = x.rate;
      translation[6 + i] = x.acceleration;
    }
  }
  [[gnu::always_inline]] PackedJets<P> jets() const {
    PackedJets<P> out;
    P rotation[4], omega[3], alpha[3];
    project(p, dp, ddp, rotation, omega, alpha);
    for (int i = 0; i < 4; ++i) out.number[kRotation + i] = rotation[i];
    for (int i = 0; i < 3; ++i) {
      out.number[kOmega + i] = omega[i];
      out.number[kAlpha + i] = alpha[i];
      out.number[kTranslation + i] = translation[i];
      out.number[kVelocity + i] = translation[3 + i];
      out.number[kAcceleration + i] = translation[6 + i];
    }
    out.number[kNumbers - 1] = P::all(0);
    return out;
  }

 private:
  template <bool First>
  [[gnu::always_inline]] static void join(P& sum, const P& term) {
    sum = First ? term : sum + term;
  }
  /// sum += a⊗(x, y, z, w).
  template <bool First>
  [[gnu::always_inline]] static void add_product(const P (&a)[4], const P& x, const P& y, const P& z,
                                                 const P& w, P (&sum)[4]) {
    join<First>(sum[0], (a[3] * x + a[0] * w) + (a[1] * z - a[2] * y));
    join<First>(sum[1], (a[3] * y + a[1] * w) + (a[2] * x - a[0] * z));
    join<First>(sum[2], (a[3] * z + a[2] * w) + (a[0] * y - a[1] * x));
    join<First>(sum[3], (a[3] * w - a[0] * x) - (a[1] * y + a[2] * z));
  }
};

/// The mixed layers of a blend without masks, their weights divided by the sum of all: then there is nothing
/// to ask joint by joint.
template <class T>
struct PlainMix {
  int layers[16], count = 0;
  TimeJet<T> weights[16];

  /// None where a mask or weights that only begin to grow ask for more.
  explicit PlainMix(const BlendData<T>& data) {
    TimeJet<T> total{T(0), T(0), T(0)};
    for (int n = 0; n < data.layer_count; ++n) {
      const BlendLayerData<T>& layer = data.layers[n];
      if (layer.mode != BlendLayerData<T>::kMix) continue;
      if (layer.mask) {
        count = 0;
        return;
      }
      layers[count] = n;
      weights[count] = {layer.weight[0], layer.weight[1], layer.weight[2]};
      total = total + weights[count++];
    }
    if (!(total.value > T(0))) count = 0;
    if (total.value == T(1) && total.rate == T(0) && total.acceleration == T(0)) return;
    for (int k = 0; k < count; ++k) weights[k] = weights[k] / total;
  }
};

template <class P>
TimeJet<P> everywhere(const TimeJet<typename P::Scalar>& w) {
  return {P::all(w.value), P::all(w.rate), P::all(w.acceleration)};
}

template <class P>
void mix_plainly(const BlendData<typename P::Scalar>& data, const PlainMix<typename P::Scalar>& mixed,
                 const Block<P>& block, const P* rest, PackedJets<P>& jets) {
  jets = block.load(data.layers[mixed.layers[0]].jets);
  if (mixed.count == 1) return;
  P reference[4];
  for (int i = 0; i < 4; ++i) reference[i] = rest ? rest[i] : jets.number[kRotation + i];
  Sum<P> sum;
  sum.template add<true>(jets, everywhere<P>(mixed.weights[0]), rest);
  for (int k = 1; k < mixed.count; ++k)
    sum.template add<false>(block.load(data.layers[mixed.layers[k]].jets), everywhere<P>(mixed.weights[k]),
                            reference);
  jets = sum.jets();
}

/// Weighted mean of the mixed layers. A joint with one contributor takes it as it is, one with none stays at
/// rest, as `jets` are.
template <class P>
void mix(const BlendData<typename P::Scalar>& data, const Block<P>& block, PackedJets<P>& jets) {
  const P zero = P::all(0);
  const TimeJet<P> none{zero, zero, zero};
  Sum<P> sum;
  sum.template add<true>(jets, none, nullptr);
  TimeJet<P> total = none;
  P contributors = zero, reference[4];
  for (int i = 0; i < 4; ++i) reference[i] = jets.number[kRotation + i];
  for (int n = 0; n < data.layer_count; ++n) {
    if (data.layers[n].mode != BlendLayerData<typename P::Scalar>::kMix) continue;
    const BlockLayer<P> layer(data.layers[n], block);
    for (int i = 0; i < 4 && !data.rest; ++i)  // then the first layer's, joint by joint
      reference[i] = where_equal(contributors, 0, layer.jets.number[kRotation + i], reference[i]);
    sum.template add<false>(layer.jets, layer.weight, reference);
    total = total + layer.weight;
    if (layer.masked) {
      replace_where_not(layer.mask, 0, layer.jets, jets);
      contributors = contributors + where_equal(layer.mask, 0, zero, P::all(1));
    } else {
      jets = layer.jets;
      contributors = contributors + P::all(1);
    }
  }
  sum.divide_translations(total);
  contributors = where_equal(total.value, 0, zero, contributors);  // weights that only begin to grow
  const auto several = contributors > P::all(1);
  if (!any(!several))
    jets = sum.jets();
  else if (any(several))
    replace_where_equal(select(several, P::all(1), zero), 1, sum.jets(), jets);
}

/// (1 − w)·below + w·layer, both as quaternions on the side of `reference`.
template <class P>
void override_below(const BlockLayer<P>& layer, const P* reference, PackedJets<P>& below) {
  if (!layer.masked && layer.full) {
    below = layer.jets;
    return;
  }
  Sum<P> sum;
  sum.template add<true>(below, TimeJet<P>{P::all(1), P::all(0), P::all(0)} - layer.weight, reference);
  sum.template add<false>(layer.jets, layer.weight, reference);
  if (!layer.masked) {
    below = sum.jets();
    return;
  }
  replace_where_not(layer.mask, 0, sum.jets(), below);
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

/// What each pack of joints is at before anything is mixed: only where that is asked for.
template <class P>
PackedJets<P> at_rest(const BlendData<typename P::Scalar>& data, const Block<P>& block, bool whole) {
  if (whole) return block.still(data.rest);
  PackedJets<P> rest;
  block.rotations(data.rest, rest.number + kRotation);
  return rest;
}

template <class T>
void blend_all(const BlendData<T>& data, int joints, JetLayout<T>* out) {
  using P = typename LanesOf<T>::Type;
  using Layer = BlendLayerData<T>;
  const PlainMix<T> mixed(data);
  for (int first = 0; first < joints; first += P::kLanes) {
    const Block<P> block(first, joints);
    const PackedJets<P> rest = at_rest(data, block, mixed.count == 0);
    PackedJets<P> jets;
    if (mixed.count > 0) {
      mix_plainly(data, mixed, block, data.rest ? rest.number + kRotation : nullptr, jets);
    } else {
      jets = rest;
      mix(data, block, jets);
    }
    for (int n = 0; n < data.layer_count; ++n) {
      if (data.layers[n].mode == Layer::kMix) continue;
      const BlockLayer<P> layer(data.layers[n], block);
      P reference[4];
      for (int i = 0; i < 4; ++i) reference[i] = (data.rest ? rest : jets).number[kRotation + i];
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
