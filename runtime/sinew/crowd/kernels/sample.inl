// Sampling with lanes of characters. Every clip is summed up by itself, four components at a time in the
// order in which it lies in memory; then joint by joint the lanes' sums are transposed and projected
// together. Nothing is asked of the clips: not the same tracks, knots or degree. Every number has the bits
// that SamplingJob and place_root give. Included once per instruction set, as
// effects/kernels/check.inl.
#include "sinew/animation/bspline.h"
#include "sinew/animation/kernels/jet_algebra.h"
#include "sinew/animation/kernels/pack_eigen.h"
#include "sinew/crowd/kernels/sample.h"
#include "sinew/skeleton/transform.h"

namespace sinew::crowd_kernels {
namespace {

constexpr detail::BsplineMonomials<float> kCubic(3), kQuintic(5);

/// What sampling works in.
struct SampleScratch {
  float (*weights)[6][Instant::kGroups];  ///< [value, rate, acceleration][term][group]
  std::uint32_t *turning, *shifting;      ///< [joint] bit l: lane l's clip has a track of it
  TrackSum *turns, *shifts;               ///< [lane][joint] where a track is
  int joints;

  SampleScratch(void* memory, int count) : joints(count) {
    const auto take = [&]<class U>(U*& out, std::size_t n) {
      out = static_cast<U*>(memory);
      memory = out + n;
    };
    take(weights, 3);
    take(turns, std::size_t(kMaxLanes) * count);
    take(shifts, std::size_t(kMaxLanes) * count);
    take(turning, count);
    take(shifting, count);
    for (int i = 0; i < count; ++i) turning[i] = shifting[i] = 0;
  }
};

/// Basis functions of all groups, a register of them at a time.
template <class P>
void weigh(const Instant& instant, const SampleScratch& scratch) {
  for (int g = 0; g < instant.group_count; g += P::kLanes) {
    const P u = P::load(instant.u + g), scale = P::load(instant.scale + g), bend = P::load(instant.bend + g);
    bool cubic = false, quintic = false;
    float degree[P::kLanes];
    for (int i = 0; i < P::kLanes; ++i) {
      const bool five = g + i < instant.group_count && instant.group[g + i].degree == 5;
      degree[i] = five ? 5 : 3;
      (five ? quintic : cubic) = true;
    }
    BsplineBasis<P> w = BsplineBasis<P>::of(quintic ? kQuintic : kCubic, quintic ? 5 : 3, u);
    if (cubic && quintic) {
      const BsplineBasis<P> three = BsplineBasis<P>::of(kCubic, 3, u);
      const auto five = P::load(degree) == P(5);
      for (int t = 0; t < 6; ++t) {
        w.value[t] = select(five, w.value[t], three.value[t]);
        w.first[t] = select(five, w.first[t], three.first[t]);
        w.second[t] = select(five, w.second[t], three.second[t]);
      }
    }
    for (int t = 0; t < 6; ++t) {
      store<0, P::kLanes>(w.value[t], scratch.weights[0][t] + g);
      store<0, P::kLanes>(scale * w.first[t], scratch.weights[1][t] + g);
      store<0, P::kLanes>(scale * scale * w.second[t] + bend * w.first[t], scratch.weights[2][t] + g);
    }
  }
}

/// Sums of whole tracks: as many as fours fit into a register. `row(t)` loads them.
template <class P, int kTerms, bool kDerivatives, class Row>
[[gnu::always_inline]] inline void add_up(const SampleScratch& scratch, int g, const int* joints, TrackSum* out,
                                          Row row) {
  P value = P(0), rate = P(0), acceleration = P(0);
#pragma GCC unroll 6
  for (int t = 0; t < kTerms; ++t) {
    const P control = row(t);
    value += scratch.weights[0][t][g] * control;
    if constexpr (kDerivatives) {
      rate += scratch.weights[1][t][g] * control;
      acceleration += scratch.weights[2][t][g] * control;
    }
  }
  for_each_index<P::kLanes / 4>([&](auto k) {
    TrackSum& sum = out[joints[k]];
    store<4 * k, 4>(value, sum.value);
    if constexpr (kDerivatives) {
      store<4 * k, 4>(rate, sum.rate);
      store<4 * k, 4>(acceleration, sum.acceleration);
    }
  });
}

/// One group of one lane. Blocks of rotations that no body asks for are left out, as far as they may be; the
/// last block begins early enough to be full.
template <class P, int kTerms>
void add_up_group(const TrackGroup& group, int g, int bodies, int end, const SampleScratch& scratch) {
  using Four = Pack<float, 4>;
  constexpr int kBlock = P::kLanes / 4;
  TrackSum* out = (group.rotation ? scratch.turns : scratch.shifts) + std::size_t(group.lane) * scratch.joints;
  std::uint32_t* moving = group.rotation ? scratch.turning : scratch.shifting;
  for (int k = 0; k < group.tracks && group.lanes != 0; ++k)
    if (group.joints[k] < end) moving[group.joints[k]] |= group.lanes;
  const auto block = [&]<class Q>(Q, int first) {
    const auto row = [&](int t) { return Q::load(group.rows[t] + 4 * first); };
    int lowest = end;
    for (int k = 0; k < Q::kLanes / 4; ++k)
      lowest = group.joints[first + k] < lowest ? group.joints[first + k] : lowest;
    if (lowest < bodies)
      add_up<Q, kTerms, true>(scratch, g, group.joints + first, out, row);
    else if (lowest < end)
      add_up<Q, kTerms, false>(scratch, g, group.joints + first, out, row);
  };
  if (!group.rotation) {
    for (int k = 0; k < group.tracks; ++k)
      add_up<Four, kTerms, true>(scratch, g, group.joints + k, out, [&](int t) -> Four {
        const float* x = group.rows[t] + 3 * k;
        return typename Four::Vector{x[0], x[1], x[2], 0};
      });
  } else if (group.tracks < kBlock) {
    for (int k = 0; k < group.tracks; ++k) block(Four(), k);
  } else {
    for (int k = 0; k < group.tracks; k += kBlock)
      block(P(), k + kBlock <= group.tracks ? k : group.tracks - kBlock);
  }
}

/// Four numbers of every lane, from where `at(lane)` says.
template <class P, class At>
[[gnu::always_inline]] inline void gather(At at, P (&out)[4]) {
  for (int r = 0; r < 4; ++r) out[r] = load_fours<P>([&](int four) { return at(4 * four + r); });
  transpose(out);
}

/// The lanes that one pass takes, and what they show.
template <class P>
struct Shown {
  const Instant& instant;
  const SampleScratch& scratch;
  int first;               ///< lane
  std::uint32_t bits = 0;  ///< lanes whose clips are shown
  bool one_clip = true;    ///< the same constants for all

  Shown(const Instant& at, const SampleScratch& in, int first_lane) : instant(at), scratch(in), first(first_lane) {
    for (int i = 0; i < P::kLanes; ++i) {
      bits |= 1u << lane(i);
      one_clip &= at.constants[first + i] == at.constants[first];
    }
  }
  int lane(int i) const { return instant.shows[first + i]; }
  const TrackSum& sum(const TrackSum* sums, int i, int joint) const {
    return sums[std::size_t(lane(i)) * scratch.joints + joint];
  }
  /// Four numbers of what the clips say of a joint without a track.
  template <class Part>
  [[gnu::always_inline]] void constants(int joint, Part part, P (&out)[4]) const {
    if (one_clip)
      for (int c = 0; c < 4; ++c) out[c] = P(part(instant.constants[first][joint])[c]);
    else
      gather([&](int i) { return part(instant.constants[first + i][joint]); }, out);
  }
  /// Lanes whose clip's bit is set. Only where they differ: narrow stores and a wide load stall.
  Mask<float, P::kLanes> lanes(std::uint32_t set) const {
    float numbers[P::kLanes];
    for (int i = 0; i < P::kLanes; ++i) numbers[i] = float((set >> lane(i)) & 1);
    return P::load(numbers) == P(1);
  }
};

/// Rotation of a joint and, of a body, how it moves. What has no track is as the clip's constants say.
template <class P>
[[gnu::always_inline]] inline void turn(const Shown<P>& shown, int joint, bool body, JointJet<P>& jet) {
  const auto still = [](const kernels::PoseLayout<float>& pose) { return pose.rotation; };
  const std::uint32_t moving = shown.scratch.turning[joint] & shown.bits;
  P q[4], omega[3], alpha[3];
  if (moving == 0) {
    shown.constants(joint, still, q);
    for (int c = 0; c < 3; ++c) omega[c] = alpha[c] = P(0);
  } else {
    const TrackSum* sums = shown.scratch.turns;
    P p[4], dp[4], ddp[4];
    for (int c = 0; c < 4; ++c) dp[c] = ddp[c] = P(0);
    gather([&](int i) { return shown.sum(sums, i, joint).value; }, p);
    if (body) {
      gather([&](int i) { return shown.sum(sums, i, joint).rate; }, dp);
      gather([&](int i) { return shown.sum(sums, i, joint).acceleration; }, ddp);
    }
    project(p, dp, ddp, q, omega, alpha);
  }
  if (moving != 0 && moving != shown.bits) {
    const auto moves = shown.lanes(moving);
    P constant[4];
    shown.constants(joint, still, constant);
    for (int c = 0; c < 4; ++c) q[c] = select(moves, q[c], constant[c]);
    for (int c = 0; c < 3; ++c) {
      omega[c] = select(moves, omega[c], P(0));
      alpha[c] = select(moves, alpha[c], P(0));
    }
  }
  jet.rotation = Quat<P>(q[3], q[0], q[1], q[2]);
  jet.omega = Vec3<P>(omega[0], omega[1], omega[2]);
  jet.alpha = Vec3<P>(alpha[0], alpha[1], alpha[2]);
}

/// The same of its translation.
template <class P>
[[gnu::always_inline]] inline void shift(const Shown<P>& shown, int joint, bool body, JointJet<P>& jet) {
  const auto still = [](const kernels::PoseLayout<float>& pose) { return pose.translation; };
  const std::uint32_t moving = shown.scratch.shifting[joint] & shown.bits;
  P x[4], dx[4], ddx[4];
  for (int c = 0; c < 4; ++c) dx[c] = ddx[c] = P(0);
  if (moving == 0) {
    shown.constants(joint, still, x);
  } else {
    const TrackSum* sums = shown.scratch.shifts;
    gather([&](int i) { return shown.sum(sums, i, joint).value; }, x);
    if (body) {
      gather([&](int i) { return shown.sum(sums, i, joint).rate; }, dx);
      gather([&](int i) { return shown.sum(sums, i, joint).acceleration; }, ddx);
    }
  }
  if (moving != 0 && moving != shown.bits) {
    const auto moves = shown.lanes(moving);
    P constant[4];
    shown.constants(joint, still, constant);
    for (int c = 0; c < 3; ++c) {
      x[c] = select(moves, x[c], constant[c]);
      dx[c] = select(moves, dx[c], P(0));
      ddx[c] = select(moves, ddx[c], P(0));
    }
  }
  jet.translation = Vec3<P>(x[0], x[1], x[2]);
  jet.velocity = Vec3<P>(dx[0], dx[1], dx[2]);
  jet.acceleration = Vec3<P>(ddx[0], ddx[1], ddx[2]);
}

/// Loops that went by, and place_root of crossfade.h.
template <class P>
void place_root(const Instant& instant, int first, JointJet<P>& root) {
  Vec3<P> at;
  for (int a = 0; a < 3; ++a) {
    root.translation[a] += P::load(instant.shift[a] + first);
    root.velocity[a] += P::load(instant.drift[a] + first);
    root.acceleration[a] += P::load(instant.push[a] + first);
    at[a] = P::load(instant.place[a] + first);
  }
  const Quat<P> turn(P::load(instant.turn[3] + first), P::load(instant.turn[0] + first),
                     P::load(instant.turn[1] + first), P::load(instant.turn[2] + first));
  root.translation = Transform<P>{turn, at} * root.translation;
  root.rotation = turn * root.rotation;
  normalize(root.rotation);
  root.velocity = turn * root.velocity;
  root.acceleration = turn * root.acceleration;
}

template <int kRegister, int kBatch>
void sample_batch(const Instant& instant, const JetRows& out) {
  constexpr int kLanes = kRegister < kBatch ? kRegister : kBatch;
  using P = Pack<float, kLanes>;
  const SampleScratch scratch(out.scratch, out.joints);
  weigh<P>(instant, scratch);
  for (int g = 0; g < instant.group_count; ++g)
    if (instant.group[g].degree == 5)
      add_up_group<P, 6>(instant.group[g], g, out.bodies, out.posed, scratch);
    else
      add_up_group<P, 4>(instant.group[g], g, out.bodies, out.posed, scratch);
  for (int first = 0; first < kBatch; first += kLanes) {
    const Shown<P> shown(instant, scratch, first);
    for (int joint = 0; joint < out.posed; ++joint) {
      const bool body = joint < out.bodies;
      JointJet<P> jet;
      turn(shown, joint, body, jet);
      shift(shown, joint, body, jet);
      if (joint == 0) place_root(instant, first, jet);
      float* to = out.rows + std::size_t(joint) * kJetNumbers * kBatch + first;
      const auto put = [&](int number, const auto& numbers, int count) {
        for (int c = 0; c < count; ++c) store<0, kLanes>(P(numbers[c]), to + (number + c) * kBatch);
      };
      put(0, jet.rotation.coeffs(), 4);
      put(10, jet.translation, 3);
      if (!body) continue;
      put(4, jet.omega, 3);
      put(7, jet.alpha, 3);
      put(13, jet.velocity, 3);
      put(16, jet.acceleration, 3);
    }
  }
}

}  // namespace

namespace SINEW_KERNELS {
void sample8(const Instant& instant, const JetRows& out) {
  sample_batch<SINEW_FLOAT_LANES, 8>(instant, out);
}
void sample16(const Instant& instant, const JetRows& out) {
  sample_batch<SINEW_FLOAT_LANES, 16>(instant, out);
}
}  // namespace SINEW_KERNELS
}  // namespace sinew::crowd_kernels
