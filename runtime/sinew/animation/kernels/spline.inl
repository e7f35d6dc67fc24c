// Sums of control points and their projection, `Lanes` joints at a time. Included once per instruction set
// with SINEW_KERNELS naming it.
#include <type_traits>

#include "sinew/animation/kernels/jet_algebra.h"
#include "sinew/animation/kernels/kernels.h"
#include "sinew/animation/kernels/lanes.h"

namespace sinew::kernels {
namespace {

/// Weighted sums of one block of control points, still in the order of the clip: a row of numbers does not
/// care which joints they belong to.
template <class P>
struct Sums {
  P p[4], dp[4], ddp[4];
};

template <class P, int Terms, bool kDerivatives>
Sums<P> sums(const float* const (&rows)[Terms], int first_float, const P (&weights)[3][Terms]) {
  Sums<P> s;
  for (int c = 0; c < 4; ++c) s.p[c] = s.dp[c] = s.ddp[c] = P::all(0);
#pragma GCC unroll 6
  for (int t = 0; t < Terms; ++t)
    for (int c = 0; c < 4; ++c) {
      const P control = P::load(rows[t] + first_float + c * P::kLanes);
      s.p[c] = s.p[c] + weights[0][t] * control;
      if constexpr (kDerivatives) {
        s.dp[c] = s.dp[c] + weights[1][t] * control;
        s.ddp[c] = s.ddp[c] + weights[2][t] * control;
      }
    }
  return s;
}

/// Where the results of one block go, one pointer per lane: a scratch place for joints that nobody asked for.
template <class Out, int kLanes>
struct Targets {
  Out* lane[kLanes];
  Out unwanted;

  Targets(const int* joints, int count, int joint_end, Out* out) {
    for (int i = 0; i < kLanes; ++i) {
      const int joint = joints[i < count ? i : count - 1];
      lane[i] = joint < joint_end ? out + joint : &unwanted;
    }
  }
};

/// Projects one block and stores it: 4×4 transposes make structures of arrays of the clip's order, and jets
/// of them.
template <class P>
[[gnu::always_inline]] inline void store_rotations(
    Sums<P>& s, const Targets<JetLayout<typename P::Scalar>, P::kLanes>& to) {
  transpose(s.p);
  transpose(s.dp);
  transpose(s.ddp);
  P rotation[4], omega[3], alpha[3];
  project(s.p, s.dp, s.ddp, rotation, omega, alpha);
  P middle[4] = {omega[0], omega[1], omega[2], alpha[0]};
  transpose(rotation);
  transpose(middle);
  const P low = interleave_low(alpha[1], alpha[2]), high = interleave_high(alpha[1], alpha[2]);
  constexpr int kGroups = P::kLanes / 4;
  for_each_index<kGroups>([&](auto g) __attribute__((always_inline)) {
    for (int r = 0; r < 4; ++r) {
      JetLayout<typename P::Scalar>& jet = *to.lane[kGroups * r + g];
      store<4 * g, 4>(rotation[r], jet.rotation);
      store<4 * g, 4>(middle[r], jet.omega);
    }
    store<4 * g, 2>(low, to.lane[g]->alpha + 1);
    store<4 * g + 2, 2>(low, to.lane[kGroups + g]->alpha + 1);
    store<4 * g, 2>(high, to.lane[2 * kGroups + g]->alpha + 1);
    store<4 * g + 2, 2>(high, to.lane[3 * kGroups + g]->alpha + 1);
  });
}

template <class P>
[[gnu::always_inline]] inline void store_rotations(
    Sums<P>& s, const Targets<PoseLayout<typename P::Scalar>, P::kLanes>& to) {
  transpose(s.p);
  const P n = (s.p[0] * s.p[0] + s.p[1] * s.p[1]) + (s.p[2] * s.p[2] + s.p[3] * s.p[3]);
  const P inverse = sqrt(n) / n;
  for (P& x : s.p) x = x * inverse;
  transpose(s.p);
  constexpr int kGroups = P::kLanes / 4;
  for_each_index<kGroups>([&](auto g) __attribute__((always_inline)) {
    for (int r = 0; r < 4; ++r) store<4 * g, 4>(s.p[r], to.lane[kGroups * r + g]->rotation);
  });
}

/// Goes through a group in blocks. The last block starts early enough to be full: joints that it meets again
/// get the same numbers again. Groups of less than a block are padded with their last track.
template <int Terms, class T, class Out>
void sample_rotations(const SplineSpan<T>& span, Out* out) {
  using P = typename LanesOf<T>::Type;
  constexpr int kLanes = P::kLanes;
  P weights[3][Terms];
  for (int t = 0; t < Terms; ++t) {
    weights[0][t] = P::all(span.value[t]);
    weights[1][t] = P::all(span.first[t]);
    weights[2][t] = P::all(span.second[t]);
  }
  const float* rows[Terms];
  float padded[Terms][4 * kLanes];
  for (int t = 0; t < Terms; ++t) rows[t] = span.rows[t];
  if (span.tracks < kLanes) {
    for (int t = 0; t < Terms; ++t) {
      for (int k = 0; k < kLanes; ++k)
        __builtin_memcpy(padded[t] + 4 * k, rows[t] + 4 * (k < span.tracks ? k : span.tracks - 1),
                         4 * sizeof(float));
      rows[t] = padded[t];
    }
  }
  const int count = span.tracks < kLanes ? span.tracks : kLanes;
  for (int k = 0; k < span.tracks; k += kLanes) {
    const int first = k + count <= span.tracks ? k : span.tracks - count;
    Sums<P> s = sums<P, Terms, std::is_same_v<Out, JetLayout<T>>>(rows, 4 * first, weights);
    store_rotations(s, Targets<Out, kLanes>(span.joints + first, count, span.joint_end, out));
  }
}

/// One joint at a time: few joints move against their parent. Stores of four overlap, each repairs the one
/// before.
template <int Terms, class T, class Out>
void sample_translations(const SplineSpan<T>& span, Out* out) {
  using P = Pack<T, 4>;
  constexpr bool kDerivatives = std::is_same_v<Out, JetLayout<T>>;
  for (int k = 0; k < span.tracks; ++k) {
    const int joint = span.joints[k];
    if (joint >= span.joint_end) continue;
    P p = P::all(0), dp = p, ddp = p;
    for (int t = 0; t < Terms; ++t) {
      const float* x = span.rows[t] + 3 * k;
      const P control = typename P::Vector{T(x[0]), T(x[1]), T(x[2]), T(0)};
      p = p + span.value[t] * control;
      if constexpr (kDerivatives) {
        dp = dp + span.first[t] * control;
        ddp = ddp + span.second[t] * control;
      }
    }
    store<0, 4>(p, out[joint].translation);
    if constexpr (kDerivatives) {
      store<0, 4>(dp, out[joint].velocity);
      store<0, 4>(ddp, out[joint].acceleration);
    }
  }
}

/// Clips hold unit quaternions in float: that is unit enough for float.
template <class T>
Pack<T, 4> unit(const Pack<T, 4>& q) {
  if constexpr (sizeof(T) == sizeof(float)) return q;
  T n = 0;
  for (int i = 0; i < 4; ++i) n += q.v[i] * q.v[i];
  return q / sqrt(Pack<T, 4>::all(n));
}

/// Joints that keep their place: stores of four overlap here too.
template <class T>
void keep(const PoseLayout<float>* constants, int joints, JetLayout<T>* jets) {
  using P = Pack<T, 4>;
  const P zero = P::all(0);
  for (int i = 0; i < joints; ++i) {
    JetLayout<T>& jet = jets[i];
    store<0, 4>(unit(P::load(constants[i].rotation)), jet.rotation);
    store<0, 4>(zero, jet.omega);
    store<0, 4>(zero, jet.alpha);
    store<0, 4>(P::load(constants[i].translation), jet.translation);
    store<0, 4>(zero, jet.velocity);
    store<0, 4>(zero, jet.acceleration);
  }
}
template <class T>
void keep(const PoseLayout<float>* constants, int joints, PoseLayout<T>* poses) {
  using P = Pack<T, 4>;
  for (int i = 0; i < joints; ++i) {
    store<0, 4>(unit(P::load(constants[i].rotation)), poses[i].rotation);
    store<0, 4>(P::load(constants[i].translation), poses[i].translation);
  }
}

}  // namespace

namespace SINEW_KERNELS {

#define SINEW_DEFINE_KERNELS(T, Out)                                                         \
  void constants(const PoseLayout<float>* poses, int joints, Out<T>* out) {                  \
    keep(poses, joints, out);                                                                \
  }                                                                                          \
  void rotations(const SplineSpan<T>& span, Out<T>* out) {                                   \
    span.terms == 4 ? sample_rotations<4>(span, out) : sample_rotations<6>(span, out);       \
  }                                                                                          \
  void translations(const SplineSpan<T>& span, Out<T>* out) {                                \
    span.terms == 4 ? sample_translations<4>(span, out) : sample_translations<6>(span, out); \
  }
SINEW_DEFINE_KERNELS(float, JetLayout)
SINEW_DEFINE_KERNELS(float, PoseLayout)
SINEW_DEFINE_KERNELS(double, JetLayout)
SINEW_DEFINE_KERNELS(double, PoseLayout)

}  // namespace SINEW_KERNELS
}  // namespace sinew::kernels
