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

/// Whether no joint of the block has anything of a layer.
template <class P>
bool is_masked_out(const BlendLayerData<typename P::Scalar>& layer, const Block<P>& block) {
  return layer.mask && !any(block.load(layer.mask) != P::all(0));
}

template <class T>
bool is_full(const BlendLayerData<T>& layer) {
  return layer.weight[0] == 1 && layer.weight[1] == 0 && layer.weight[2] == 0;
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
    full = is_full(layer);
  }
};

/// The rotation that a moving quaternion of any length means.
template <class P>
[[gnu::always_inline]] inline OffsetRotation<P> rotation_of(const TimeJet<P> (&quaternion)[4]) {
  P p[4], dp[4], ddp[4];
  for (int i = 0; i < 4; ++i) {
    p[i] = quaternion[i].value;
    dp[i] = quaternion[i].rate;
    ddp[i] = quaternion[i].acceleration;
  }
  OffsetRotation<P> r;
  project(p, dp, ddp, r.q, r.omega, r.alpha);
  return r;
}

/// 1 or −1: which of the two quaternions that mean a rotation is nearer to `reference`.
template <class P>
P side_of(const P* q, const P* reference) {
  const P dot = (q[0] * reference[0] + q[1] * reference[1]) + (q[2] * reference[2] + q[3] * reference[3]);
  return where_negative(dot, P::all(-1), P::all(1));
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
      const P sign = side_of(q, reference);
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
    write(out);
    return out;
  }
  [[gnu::always_inline]] void write(PackedJets<P>& out) const {
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

/// What a blend without masks begins with: its mixed layers, their weights divided by the sum of all, or a
/// single one and the override that follows. Then there is nothing to ask joint by joint.
template <class T>
struct PlainMix {
  using Layer = BlendLayerData<T>;
  int layers[16], count = 0;
  TimeJet<T> weights[16];
  int rest = 0;  ///< layers from here on that are not mixed join what these give

  /// None where a mask or weights that only begin to grow ask for more.
  explicit PlainMix(const BlendData<T>& data) {
    TimeJet<T> total{T(0), T(0), T(0)};
    for (int n = 0; n < data.layer_count; ++n) {
      if (data.layers[n].mode != Layer::kMix) continue;
      if (data.layers[n].mask) {
        count = 0;
        return;
      }
      add(data, n);
      total = total + weights[count - 1];
    }
    if (!(total.value > T(0))) count = 0;
    if (count == 1) take_override(data);
    if (total.value == T(1) && total.rate == T(0) && total.acceleration == T(0)) return;
    for (int k = 0; k < count && rest == 0; ++k) weights[k] = weights[k] / total;
  }

 private:
  void add(const BlendData<T>& data, int layer) {
    const T* w = data.layers[layer].weight;
    layers[count] = layer;
    weights[count++] = {w[0], w[1], w[2]};
  }
  void take_override(const BlendData<T>& data) {
    if (layers[0] != 0 || data.layer_count < 2) return;
    const Layer& over = data.layers[1];
    if (over.mode != Layer::kOverride || over.mask || is_full(over)) return;
    add(data, 1);
    weights[0] = TimeJet<T>(T(1)) - weights[1];
    rest = 2;
  }
};

template <class P>
TimeJet<P> everywhere(const TimeJet<typename P::Scalar>& w) {
  return {P::all(w.value), P::all(w.rate), P::all(w.acceleration)};
}

/// Of two layers or more.
template <class P>
[[gnu::always_inline]] inline PackedJets<P> mix_plainly(const BlendData<typename P::Scalar>& data,
                                                        const PlainMix<typename P::Scalar>& mixed,
                                                        const Block<P>& block) {
  PackedJets<P> jets = block.load(data.layers[mixed.layers[0]].jets);
  P reference[4];
  for (int i = 0; i < 4; ++i) reference[i] = jets.number[kRotation + i];
  if (data.rest) block.rotations(data.rest, reference);
  Sum<P> sum;
  sum.template add<true>(jets, everywhere<P>(mixed.weights[0]), data.rest ? reference : nullptr);
  for (int k = 1; k < mixed.count; ++k)
    sum.template add<false>(block.load(data.layers[mixed.layers[k]].jets), everywhere<P>(mixed.weights[k]),
                            reference);
  return sum.jets();
}

/// The mixed layers as they are, where one alone reaches a joint, and rest, where none does.
template <class P>
[[gnu::noinline]] PackedJets<P> unmixed(const BlendData<typename P::Scalar>& data, const Block<P>& block) {
  PackedJets<P> jets = block.still(data.rest);
  for (int n = 0; n < data.layer_count; ++n) {
    if (data.layers[n].mode != BlendLayerData<typename P::Scalar>::kMix) continue;
    const BlockLayer<P> layer(data.layers[n], block);
    replace_where_not(layer.mask, 0, layer.jets, jets);
  }
  return jets;
}

/// Weighted mean of the mixed layers. A joint with one contributor takes it as it is, one with none stays at
/// rest.
template <class P>
PackedJets<P> mix(const BlendData<typename P::Scalar>& data, const Block<P>& block) {
  const P zero = P::all(0);
  Sum<P> sum;
  bool begun = false;
  TimeJet<P> total{zero, zero, zero};
  P contributors = zero, reference[4];
  block.rotations(data.rest, reference);
  for (int n = 0; n < data.layer_count; ++n) {
    if (data.layers[n].mode != BlendLayerData<typename P::Scalar>::kMix) continue;
    if (is_masked_out(data.layers[n], block)) continue;
    const BlockLayer<P> layer(data.layers[n], block);
    for (int i = 0; i < 4 && !data.rest; ++i)  // then the first layer's, joint by joint
      reference[i] = where_equal(contributors, 0, layer.jets.number[kRotation + i], reference[i]);
    if (begun)
      sum.template add<false>(layer.jets, layer.weight, reference);
    else
      sum.template add<true>(layer.jets, layer.weight, reference);
    begun = true;
    total = total + layer.weight;
    contributors = contributors + where_equal(layer.mask, 0, zero, P::all(1));
  }
  if (!begun) return unmixed(data, block);
  sum.divide_translations(total);
  contributors = where_equal(total.value, 0, zero, contributors);  // weights that only begin to grow
  const auto several = contributors > P::all(1);
  if (!any(!several)) return sum.jets();
  PackedJets<P> jets = unmixed(data, block);
  if (any(several)) replace_where_equal(select(several, P::all(1), zero), 1, sum.jets(), jets);
  return jets;
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
  if (any(layer.mask == P::all(0)))
    replace_where_not(layer.mask, 0, sum.jets(), below);
  else
    sum.write(below);
  if (layer.masked && layer.full) replace_where_equal(layer.mask, 1, layer.jets, below);
}

/// What an additive layer is, from its motion.
template <class P>
void subtract(const PoseLayout<typename P::Scalar>* reference, const Block<P>& block, PackedJets<P>& jets) {
  P from[4], q[4], back[4], place[3];
  block.rotations(reference, from);
  block.translations(reference, place);
  for (int i = 0; i < 4; ++i) {
    q[i] = jets.number[kRotation + i];
    back[i] = i < 3 ? -from[i] : from[i];
  }
  P turned[4];
  multiply(back, q, turned);
  for (int i = 0; i < 4; ++i) jets.number[kRotation + i] = turned[i];
  for (int i = 0; i < 3; ++i) jets.number[kTranslation + i] = jets.number[kTranslation + i] - place[i];
}

/// Rotation below·((1 − w)·1 + w·layer), translation below + w·layer.
template <class P>
void add_to_below(const BlendLayerData<typename P::Scalar>& data, const Block<P>& block, BlockLayer<P>& layer,
                  PackedJets<P>& below) {
  if (data.reference) subtract(data.reference, block, layer.jets);
  const P* over = layer.jets.number;
  const P identity[4] = {P::all(0), P::all(0), P::all(0), P::all(1)};
  const P sign = side_of(over + kRotation, identity);
  P q[4];
  for (int i = 0; i < 4; ++i) q[i] = sign * over[kRotation + i];
  TimeJet<P> part[4];
  quaternion_jet(q, over + kOmega, over + kAlpha, part);
  part[3].value = part[3].value - P::all(1);
  for (TimeJet<P>& x : part) x = layer.weight * x;
  part[3].value = part[3].value + P::all(1);
  PackedJets<P> masked, &sum = layer.masked ? masked : below;
  set_rotation_part(composition(rotation_part(below), rotation_of(part)), sum);
  for (int i = 0; i < 3; ++i) {
    const int t = kTranslation + i, v = kVelocity + i, a = kAcceleration + i;
    const TimeJet<P> shift = layer.weight * TimeJet<P>(over[t], over[v], over[a]);
    sum.number[t] = below.number[t] + shift.value;
    sum.number[v] = below.number[v] + shift.rate;
    sum.number[a] = below.number[a] + shift.acceleration;
  }
  sum.number[kNumbers - 1] = P::all(0);
  if (layer.masked) replace_where_not(layer.mask, 0, masked, below);
}

/// The mixed layers of a block.
template <class P>
[[gnu::always_inline]] inline PackedJets<P> mixed_block(const BlendData<typename P::Scalar>& data,
                                                        const PlainMix<typename P::Scalar>& mixed,
                                                        const Block<P>& block) {
  if (mixed.count > 1) return mix_plainly(data, mixed, block);
  if (mixed.count == 1) return block.load(data.layers[mixed.layers[0]].jets);
  return mix(data, block);
}

/// Whatever the layers ask of a block.
template <class P>
[[gnu::noinline]] PackedJets<P> blend_block(const BlendData<typename P::Scalar>& data,
                                            const PlainMix<typename P::Scalar>& mixed,
                                            const Block<P>& block) {
  using Layer = BlendLayerData<typename P::Scalar>;
  PackedJets<P> jets = mixed_block(data, mixed, block);
  for (int n = mixed.rest; n < data.layer_count; ++n) {
    if (data.layers[n].mode == Layer::kMix || is_masked_out(data.layers[n], block)) continue;
    BlockLayer<P> layer(data.layers[n], block);
    if (data.layers[n].mode == Layer::kAdditive) {
      add_to_below(data.layers[n], block, layer, jets);
      continue;
    }
    P reference[4];
    for (int i = 0; i < 4; ++i) reference[i] = jets.number[kRotation + i];
    if (data.rest) block.rotations(data.rest, reference);
    override_below(layer, reference, jets);
  }
  return jets;
}

template <class T>
void blend_all(const BlendData<T>& data, int joints, JetLayout<T>* out) {
  using P = typename LanesOf<T>::Type;
  const PlainMix<T> mixed(data);
  const bool plain = mixed.count > 1 && (mixed.count == data.layer_count || mixed.rest == data.layer_count);
  for (int first = 0; first < joints; first += P::kLanes) {
    const Block<P> block(first, joints);
    if (plain)
      block.store(mix_plainly(data, mixed, block), out);
    else
      block.store(blend_block(data, mixed, block), out);
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
