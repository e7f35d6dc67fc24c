// Recursive Newton–Euler in the axes of each body, a pack of characters at a time. Included once per
// instruction set with SINEW_KERNELS naming it and SINEW_FLOAT_LANES its registers.
//
// residual/tree.h does the same recursion in world axes, because the optimizer wants its matrices there. Body
// axes need no rotated inertias, which is most of the arithmetic of a check that asks for torques alone.
#include "sinew/animation/kernels/jet_algebra.h"
#include "sinew/crowd/kernels/batch.h"
#include "sinew/crowd/kernels/spatial.h"

namespace sinew::crowd_kernels {
namespace {

/// One body of every character of the batch. Vectors in body axes unless said.
template <class P>
struct Body {
  Turn<P> turn;          ///< body → parent
  Vec<P> arm;            ///< origin, parent axes
  Vec<P> omega, alpha;   ///< of the body
  Vec<P> acceleration;   ///< of its origin, less gravity
  Vec<P> force, moment;  ///< that its motion asks for, about its origin
};

/// Where it is, for those who need to know.
template <class P>
struct Placed {
  P rotation[4];  ///< body → world
  Turn<P> world;
  Vec<P> origin;  ///< from the root's, world axes
};

/// A point near enough to the ground to bear weight.
template <class P>
struct Standing {
  Vec<P> place;  ///< from the root's origin, world axes
  P share;       ///< 1 on the floor … 0 at the reach
};

template <class P>
struct Scratch {
  Body<P>* body;
  Placed<P>* placed;
  Standing<P>* standing;  ///< [point] filled for bodies that are near the ground

  Scratch(void* memory, int bodies)
      : body(static_cast<Body<P>*>(memory)),
        placed(reinterpret_cast<Placed<P>*>(body + bodies)),
        standing(reinterpret_cast<Standing<P>*>(placed + bodies)) {}
  static_assert(sizeof(Body<P>) + sizeof(Placed<P>) == kBodyPacks * sizeof(P) &&
                sizeof(Standing<P>) == kPointPacks * sizeof(P));
};

/// The lanes of a batch that one pass takes: as many as a register of the instruction set holds.
struct Lanes {
  int first = 0;
  int stride = 0;  ///< lanes of the batch
};

/// Numbers of one body's jet over the lanes, in the order of JetLayout.
template <class P>
struct Jet {
  P rotation[4];
  Vec<P> omega, alpha, translation, velocity, acceleration;

  Jet(const Batch& batch, int first_lane, int i) {
    constexpr int kNumbers = sizeof(kernels::JetLayout<float>) / sizeof(float);
    const std::ptrdiff_t stride = std::ptrdiff_t(batch.joints) * kNumbers;
    const float* from = batch.jets->rotation + first_lane * stride + i * kNumbers;
    P n[kNumbers];
#pragma GCC unroll 5
    for (int c = 0; c < kNumbers; c += 4) {
      P m[4];
      for (int r = 0; r < 4; ++r)
        m[r] = load_fours<P>([&](int group) { return from + (4 * group + r) * stride + c; });
      transpose(m);
      for (int r = 0; r < 4; ++r) n[c + r] = m[r];
    }
    for (int c = 0; c < 4; ++c) rotation[c] = n[c];
    omega = {n[4], n[5], n[6]};
    alpha = {n[7], n[8], n[9]};
    translation = {n[10], n[11], n[12]};
    velocity = {n[13], n[14], n[15]};
    acceleration = {n[16], n[17], n[18]};
  }
};

/// Motion of a body from its parent's, and the wrench that it takes.
template <class P>
void move(const Rig& rig, const RigBody& constants, const Jet<P>& jet, const Body<P>* parent, Body<P>& body) {
  body.turn = turn_of(jet.rotation);
  body.arm = jet.translation;
  if (!parent) {
    body.omega = jet.omega;
    body.alpha = jet.alpha;
    body.acceleration = body.turn.back(jet.acceleration - same<P>(rig.gravity));
  } else {
    const Vec<P> carried = body.turn.back(parent->omega);
    body.omega = carried + jet.omega;
    body.alpha = body.turn.back(parent->alpha) + (jet.alpha + cross(carried, jet.omega));
    body.acceleration = body.turn.back(
        parent->acceleration +
        (jet.acceleration + (cross(parent->alpha, body.arm) +
                             cross(parent->omega, cross(parent->omega, body.arm) + 2 * jet.velocity))));
  }
  const Vec<P> first = same<P>(constants.first);
  body.force = constants.mass * body.acceleration +
               (cross(body.alpha, first) + cross(body.omega, cross(body.omega, first)));
  body.moment =
      symmetric_times(constants.inertia, body.alpha) +
      (cross(body.omega, symmetric_times(constants.inertia, body.omega)) + cross(first, body.acceleration));
}

/// Orientation and origin in the world.
template <class P>
void place(const Jet<P>& jet, const Turn<P>& turn, const Placed<P>* parent, Placed<P>& body) {
  if (!parent) {
    for (int c = 0; c < 4; ++c) body.rotation[c] = jet.rotation[c];
    body.world = turn;
    body.origin = {P::all(0), P::all(0), P::all(0)};
    return;
  }
  multiply(parent->rotation, jet.rotation, body.rotation);
  body.world = turn_of(body.rotation);
  body.origin = parent->origin + parent->world * jet.translation;
}

/// Torques about the joint's degrees of freedom, as JointType orders them.
template <class P>
void project(const RigBody& constants, const Body<P>& body, const Lanes& lanes, float* torque) {
  float* rows = torque + constants.first_dof * lanes.stride + lanes.first;
  const auto put = [&](int k, const P& t) { store<0, P::kLanes>(t, rows + k * lanes.stride); };
  const auto axis = [&](int k) { return same<P>(constants.axis[k]); };
  switch (constants.freedom) {
    case Freedom::kFixed:
      break;
    case Freedom::kRevolute:
      put(0, dot(axis(0), body.moment));
      break;
    case Freedom::kPrismatic:
      put(0, dot(axis(0), body.force));
      break;
    case Freedom::kUniversal:  // the first axis stays with the parent
      put(0, dot(axis(0), body.turn * body.moment));
      put(1, dot(axis(1), body.moment));
      break;
    case Freedom::kBall:
      put(0, body.moment.x);
      put(1, body.moment.y);
      put(2, body.moment.z);
      break;
    case Freedom::kPlanar: {  // all axes stay with the parent
      const Vec<P> force = body.turn * body.force;
      put(0, dot(axis(0), force));
      put(1, dot(axis(1), force));
      put(2, dot(axis(2), body.turn * body.moment));
      break;
    }
    case Freedom::kFree: {
      const Vec<P> force = body.turn * body.force, moment = body.turn * body.moment;
      put(0, force.x);
      put(1, force.y);
      put(2, force.z);
      put(3, moment.x);
      put(4, moment.y);
      put(5, moment.z);
      break;
    }
  }
}

/// share_support (effects/support.h) per lane: what the ground bears is taken from the bodies' wrenches.
template <class P>
void share_support(const Rig& rig, const P& root_height, const Scratch<P>& scratch) {
  const P zero = P::all(0), one = P::all(1), ground = P::all(rig.ground_height) - root_height;
  Vec<P> total{zero, zero, zero}, tilt = total;
  for (int i = 0; i < rig.body_count; ++i) {
    const Body<P>& body = scratch.body[i];
    const Placed<P>& placed = scratch.placed[i];
    const Vec<P> force = placed.world * body.force;
    total = total + force;
    tilt = tilt + (placed.world * body.moment + cross(placed.origin, force));
  }
  const auto near = [&](const RigBody& constants, const Placed<P>& body) {
    return constants.point_count > 0 &&
           any_negative(body.origin.z - ground - P::all(constants.bound + rig.support_reach));
  };
  P sum = zero, y_sum = zero, x_sum = zero, yy = zero, xy = zero, xx = zero;
  for (int i = 0; i < rig.body_count; ++i) {
    const RigBody& constants = rig.bodies[i];
    const Placed<P>& body = scratch.placed[i];
    if (!near(constants, body)) continue;
    for (int k = constants.first_point; k < constants.first_point + constants.point_count; ++k) {
      Vec<P> at = body.origin + body.world * same<P>(rig.points[k].local);
      at.z = at.z - P::all(rig.points[k].radius);
      const P up = largest(zero, smallest(one, (1 / rig.support_reach) * (at.z - ground)));
      const P w = (one - up) * (one - up);
      scratch.standing[k] = {at, w};
      sum = sum + w;
      y_sum = y_sum + w * at.y;
      x_sum = x_sum + w * at.x;
      yy = yy + w * at.y * at.y;
      xy = xy + w * at.x * at.y;
      xx = xx + w * at.x * at.x;
    }
  }
  if (!any_negative(P::all(1e-3f) - sum)) return;
  // Weighted least squares of vertical forces w·(1, y, −x)·λ; one point alone can't hold a tilt.
  const P slack = 1e-6f * (one + (sum + yy + xx));
  const P a = sum + slack, b = y_sum, c = -x_sum, d = yy + slack, e = -xy, f = xx + slack;
  const P c00 = d * f - e * e, c01 = c * e - b * f, c02 = b * e - c * d, c11 = a * f - c * c,
          c12 = b * c - a * e, c22 = a * d - b * b;
  const P inverse = one / (a * c00 + b * c01 + c * c02);
  const P l0 = inverse * (c00 * total.z + c01 * tilt.x + c02 * tilt.y),
          l1 = inverse * (c01 * total.z + c11 * tilt.x + c12 * tilt.y),
          l2 = inverse * (c02 * total.z + c12 * tilt.x + c22 * tilt.y);
  const auto lift = [&](const Standing<P>& s) {
    return largest(zero, s.share * (l0 + (l1 * s.place.y - l2 * s.place.x)));
  };
  // Where a limb leaves the root, seen from a point that it stands on, per metre of height.
  const auto lean = [&](int body, const Vec<P>& at) {
    while (body > 0 && rig.bodies[body].parent > 0) body = rig.bodies[body].parent;
    const Vec<P>& hip = scratch.placed[body].origin;
    const P height = hip.z - ground, low = height - P::all(rig.support_reach);
    const P slope = where_negative(-low, one / height, zero);
    return Vec<P>{slope * (hip.x - at.x), slope * (hip.y - at.y), zero};
  };
  P carried = zero, x_mean = zero, y_mean = zero, steepest = zero;
  for (int i = 0; i < rig.body_count; ++i) {
    if (!near(rig.bodies[i], scratch.placed[i])) continue;
    for (int k = 0; k < rig.bodies[i].point_count; ++k) {
      const Standing<P>& s = scratch.standing[rig.bodies[i].first_point + k];
      const P up = lift(s);
      const Vec<P> away = lean(i, s.place);
      carried = carried + up;
      x_mean = x_mean + up * away.x;
      y_mean = y_mean + up * away.y;
      steepest = where_negative(-up, largest(steepest, away.x * away.x + away.y * away.y), steepest);
    }
  }
  // Lanes that fall, fly or stand on nothing keep their wrenches.
  P scale = total.z / carried * smallest(one, 5 * sum);
  for (const P& needed : {total.z, sum - P::all(1e-3f), carried})
    scale = where_negative(-needed, scale, zero);
  // Level forces: friction's share, and the lean towards the hips about its mean.
  const P level = one / largest(total.z, sqrt(total.x * total.x + total.y * total.y));
  const P follow = smallest(one, P::all(rig.support_lean) / largest(sqrt(steepest), P::all(1e-6f)));
  const P x_push = level * total.x - follow * (x_mean / carried),
          y_push = level * total.y - follow * (y_mean / carried);
  for (int i = 0; i < rig.body_count; ++i) {
    const Placed<P>& placed = scratch.placed[i];
    if (!near(rig.bodies[i], placed)) continue;
    Vec<P> force{zero, zero, zero}, moment = force;
    for (int k = 0; k < rig.bodies[i].point_count; ++k) {
      const Standing<P>& s = scratch.standing[rig.bodies[i].first_point + k];
      const P up = where_equal(scale, 0, zero, scale * lift(s));
      const Vec<P> away = lean(i, s.place);
      const Vec<P> push{where_equal(up, 0, zero, up * (x_push + follow * away.x)),
                        where_equal(up, 0, zero, up * (y_push + follow * away.y)), up};
      force = force + push;
      moment = moment + cross(s.place - placed.origin, push);
    }
    Body<P>& body = scratch.body[i];
    body.force = body.force - placed.world.back(force);
    body.moment = body.moment - placed.world.back(moment);
  }
}

/// Largest load of every lane. A NaN anywhere stays.
template <class P>
void compare(const Rig& rig, const Batch& batch, const Lanes& lanes) {
  P peak = P::all(0), sum = peak;
  for (int dof = rig.first_checked_dof; dof < rig.dof_count; ++dof) {
    const int at = dof * lanes.stride + lanes.first;
    const P torque = P::load(batch.torque + at);
    const P plus = torque * P::load(batch.inverse_plus + at);
    const P minus = -torque * P::load(batch.inverse_minus + at);
    const P load = where_negative(torque, minus, plus);
    peak = largest(peak, load);
    sum = sum + load;
  }
  store<0, P::kLanes>(where_equal(sum - sum, 0, peak, sum), batch.peak + lanes.first);
}

template <class P>
void write_model(const Rig& rig, const Batch& batch, int first_lane, const Vec<P>& root,
                 const Placed<P>* bodies) {
  for (int i = 0; i < rig.body_count; ++i) {
    const Placed<P>& body = bodies[i];
    const Vec<P> at = root + body.origin;
    P q[4] = {body.rotation[0], body.rotation[1], body.rotation[2], body.rotation[3]};
    P x[4] = {at.x, at.y, at.z, P::all(0)};
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

template <class P>
void check(const Rig& rig, const Batch& batch, const Lanes& lanes) {
  const Scratch<P> scratch(batch.scratch, rig.body_count);
  const bool placed = rig.ground || batch.model[0];
  for (int i = 0; i < rig.body_count; ++i) {
    const int p = rig.bodies[i].parent;
    const Body<P>* parent = p < 0 ? nullptr : scratch.body + p;
    const Jet<P> jet(batch, lanes.first, i);
    move(rig, rig.bodies[i], jet, parent, scratch.body[i]);
    if (placed) place(jet, scratch.body[i].turn, p < 0 ? nullptr : scratch.placed + p, scratch.placed[i]);
  }
  const Vec<P> root = scratch.body[0].arm;
  if (rig.ground) share_support(rig, root.z, scratch);
  for (int i = rig.body_count - 1; i >= 0; --i) {
    const Body<P>& body = scratch.body[i];
    project(rig.bodies[i], body, lanes, batch.torque);
    if (rig.bodies[i].parent < 0) continue;
    Body<P>& parent = scratch.body[rig.bodies[i].parent];
    const Vec<P> force = body.turn * body.force;
    parent.force = parent.force + force;
    parent.moment = parent.moment + (body.turn * body.moment + cross(body.arm, force));
  }
  compare<P>(rig, batch, lanes);
  if (batch.model[0]) write_model(rig, batch, lanes.first, root, scratch.placed);
}

/// A batch in as many passes as registers of `kRegister` lanes need.
template <int kRegister, int kBatch>
void check_batch(const Rig& rig, const Batch& batch) {
  constexpr int kLanes = kRegister < kBatch ? kRegister : kBatch;
  for (int first = 0; first < kBatch; first += kLanes)
    check<Pack<float, kLanes>>(rig, batch, {first, kBatch});
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
}  // namespace sinew::crowd_kernels
