// The check of a pack of characters: the residual pass, the ground's support and the muscles' limits that a
// single character goes through (check_pass.h, muscle/muscle_side.h), with packs as their scalar. Included
// once per instruction set with SINEW_KERNELS naming it and SINEW_FLOAT_LANES its registers.
#include "sinew/animation/kernels/pack_eigen.h"
#include "sinew/effects/kernels/check.h"
#include "sinew/muscle/muscle_side.h"

namespace sinew::check_kernels {
namespace {

static_assert(sizeof(Transform<float>) == sizeof(kernels::PoseLayout<float>),
              "structs of floats lie in memory as in files for other instruction sets");

/// The lanes of a batch that one pass takes: as many as a register of the instruction set holds.
struct Lanes {
  int first = 0;
  int stride = 0;  ///< lanes of the batch
};

/// Jets of one joint over the lanes, a few numbers at a time in the order of JetLayout: all at once would not
/// leave registers to compute in. From lanes one after the other:
template <class P>
class Jets {
 public:
  Jets(const Batch& batch, const Lanes& lanes, int joint) : jets_(batch.jets + lanes.first), joint_(joint) {}
  /// Four numbers from number `first` on.
  void load(int first, P (&out)[4]) const {
    for (int r = 0; r < 4; ++r) out[r] = load_fours<P>([&](int four) { return of(4 * four + r) + first; });
    transpose(out);
  }
  /// Eight.
  void load(int first, P (&low)[4], P (&high)[4]) const {
    load_eights([&](int lane) { return of(lane) + first; }, low, high);
  }

 private:
  const float* of(int lane) const { return jets_[lane][joint_].rotation; }

  const kernels::JetLayout<float>* const* jets_;
  int joint_;
};
static_assert(sizeof(kernels::JetLayout<float>) == kJetNumbers * sizeof(float));

/// … or as sample.inl writes them.
template <class P>
class Rows {
 public:
  Rows(const Batch& batch, const Lanes& lanes, int joint)
      : stride_(lanes.stride), from_(batch.rows + joint * kJetNumbers * stride_ + lanes.first) {}
  void load(int first, P (&out)[4]) const {
    for (int c = 0; c < 4; ++c) out[c] = P::load(from_ + (first + c) * stride_);
  }
  void load(int first, P (&low)[4], P (&high)[4]) const {
    load(first, low);
    load(first + 4, high);
  }

 private:
  std::ptrdiff_t stride_;
  const float* from_;
};

/// move_body, reading the jet as it goes.
template <class P, class Source>
[[gnu::always_inline]] inline void move(const Rig& rig, const Source& jets, int i, const Vec3<P>& gravity,
                                        const BodyMotion<P>* parent, BodyMotion<P>& body, Quat<P>* rotation) {
  P a[4], b[4], c[4];
  JointJet<P> jet;
  jets.load(0, a, b);
  jet.rotation = Quat<P>(a[3], a[0], a[1], a[2]);
  if (rotation) *rotation = jet.rotation;
  body.turn = jet.rotation.toRotationMatrix();
  jets.load(8, a, c);
  jet.omega = Vec3<P>(b[0], b[1], b[2]);
  jet.alpha = Vec3<P>(b[3], a[0], a[1]);
  turn_body(jet, parent, body);
  jet.translation = Vec3<P>(a[2], a[3], c[0]);
  jet.velocity = Vec3<P>(c[1], c[2], c[3]);
  jets.load(16, b);
  jet.acceleration = Vec3<P>(b[0], b[1], b[2]);
  shift_body(jet, gravity, parent, body);
  load_body<P>(*rig.tree, i, body);
}

/// Largest load of every lane. A NaN anywhere stays.
template <class P>
void compare(const Rig& rig, const Batch& batch, const Lanes& lanes) {
  const P zero = P(0);
  P peak = zero, sum = zero;
  for (int dof = rig.first_checked_dof; dof < rig.tree->dofs; ++dof) {
    const int at = dof * lanes.stride + lanes.first;
    const P torque = P::load(batch.torque + at);
    const P load = largest(torque, -torque) *
                   on_side(torque, P::load(batch.inverse_minus + at), P::load(batch.inverse_plus + at));
    peak = largest(peak, load);
    sum += load;
  }
  store<0, P::kLanes>(select(sum - sum == zero, peak, sum), batch.peak + lanes.first);
}

/// Joints that ride along take their place in the world from their parents'.
template <class P, class Source>
void ride_along(const Rig& rig, const Batch& batch, const Lanes& lanes, std::span<Quat<P>> orientation,
                std::span<Vec3<P>> origin) {
  for (int i = rig.tree->bodies; i < rig.joints; ++i) {
    const Source jets(batch, lanes, i);
    P q[4], unused[4], x[4], y[4];
    jets.load(0, q, unused);
    jets.load(8, x, y);
    const int p = rig.parent[i];
    const Transform<P> world = Transform<P>{orientation[p], origin[p]} *
                               Transform<P>{Quat<P>(q[3], q[0], q[1], q[2]), {x[2], x[3], y[0]}};
    orientation[i] = world.rotation;
    origin[i] = world.translation;
  }
}

template <class P>
void write_model(const Rig& rig, const Batch& batch, int first_lane, std::span<const Quat<P>> orientation,
                 std::span<const Vec3<P>> origin) {
  for (int i = 0; i < rig.joints; ++i) {
    const Vec3<P>& at = origin[i];
    const auto& turn = orientation[i];
    P q[4] = {turn.x(), turn.y(), turn.z(), turn.w()};
    P x[4] = {at.x(), at.y(), at.z(), P(0)};
    transpose(q);
    transpose(x);
    for_each_index<P::kLanes / 4>([&](auto group) {
      for (int r = 0; r < 4; ++r) {
        store<4 * group, 4>(q[r], batch.model[first_lane + 4 * group + r][i].rotation);
        store<4 * group, 4>(x[r], batch.model[first_lane + 4 * group + r][i].translation);
      }
    });
  }
}

template <class P, class Source>
void check(const Rig& rig, const Batch& batch, const Lanes& lanes) {
  const Tree<float>& tree = *rig.tree;
  const std::span orientation(static_cast<Quat<P>*>(batch.scratch), std::size_t(rig.joints));
  const CheckScratch<P> scratch(orientation.data() + rig.joints, tree.bodies, rig.joints,
                             rig.support ? int(rig.support->points.size()) : 0);
  const bool posed = batch.model[0], placed = rig.support || posed;
  const Vec3<P> gravity(P(rig.gravity[0]), P(rig.gravity[1]), P(rig.gravity[2]));
  for (const int i : tree.by_depth) {
    const int p = tree.parent[i];
    move<P>(rig, Source(batch, lanes, i), i, gravity, p < 0 ? nullptr : &scratch.body[p], scratch.body[i],
            posed ? &orientation[i] : nullptr);
    if (placed) place_body<P>(tree, i, scratch);
    if (posed && p >= 0) orientation[i] = orientation[p] * orientation[i];
  }
  const Vec3<P> root = scratch.body[0].arm;
  if (rig.support) stand<P>(*rig.support, LevelGround<P>{P(rig.ground_height) - root.z()}, scratch);
  project_bodies<P>(tree, scratch.body, [&](int dof, const P& torque) {
    store<0, P::kLanes>(torque, batch.torque + dof * lanes.stride + lanes.first);
  });
  if (batch.peak) compare<P>(rig, batch, lanes);
  if (batch.velocity) {
    P velocity[4];
    Source(batch, lanes, 0).load(12, velocity);
    for (int a = 0; a < 3; ++a)
      store<0, P::kLanes>(velocity[1 + a], batch.velocity + a * lanes.stride + lanes.first);
  }
  if (!posed) return;
  for (int i = 0; i < tree.bodies; ++i) scratch.origin[i] = root + scratch.origin[i];
  ride_along<P, Source>(rig, batch, lanes, orientation, scratch.origin);
  write_model<P>(rig, batch, lanes.first, orientation, scratch.origin);
}

/// A batch in as many passes as registers of `kRegister` lanes need.
template <int kRegister, int kBatch>
void check_batch(const Rig& rig, const Batch& batch) {
  constexpr int kLanes = kRegister < kBatch ? kRegister : kBatch;
  using P = Pack<float, kLanes>;
  for (int first = 0; first < kBatch; first += kLanes)
    if (batch.rows)
      check<P, Rows<P>>(rig, batch, {first, kBatch});
    else
      check<P, Jets<P>>(rig, batch, {first, kBatch});
}

}  // namespace

namespace SINEW_KERNELS {
void check8(const Rig& rig, const Batch& batch) {
  check_batch<SINEW_FLOAT_LANES, 8>(rig, batch);
}
void check16(const Rig& rig, const Batch& batch) {
  check_batch<SINEW_FLOAT_LANES, 16>(rig, batch);
}
}  // namespace SINEW_KERNELS
}  // namespace sinew::check_kernels
