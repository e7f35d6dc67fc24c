#include "sinew/character/return_to_animation.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

#include "sinew/effects/joint_limit.h"
#include "sinew/muscle/joint_coordinates.h"
#include "sinew/skeleton/portable_math.h"
#include "sinew/skeleton/rotation.h"

namespace sinew {
namespace {

constexpr double kBraking =
    0.33;  ///< of a muscle's limit; the rest bears weight. Half: at the edge of an overshoot

/// Speed towards 0 at `offset` from which `deceleration` still stops there, in steps of h.
template <class T>
T stoppable(T offset, T deceleration, T h) {
  const T in_step = deceleration * h;
  return std::sqrt(in_step * in_step + 2 * deceleration * std::abs(offset)) - in_step;
}

/// Where a fraction u of the frame has brought an animation that moves by `whole` in it, and its rate per
/// frame there: on the cubic with the rates at both ends, since straight lines would ask for infinite
/// accelerations where frames meet. Foreign rates are left out.
template <class T>
std::pair<Vec3<T>, Vec3<T>> on_the_way(const Vec3<T>& whole, const Vec3<T>& leaving, const Vec3<T>& arriving,
                                       T u) {
  if (are_foreign(whole, leaving, arriving)) return {u * whole, whole};
  return {(u * u * (3 - 2 * u)) * whole + (u * (1 - u)) * ((1 - u) * leaving - u * arriving),
          (6 * u * (1 - u)) * whole + (1 - u * (4 - 3 * u)) * leaving - (u * (2 - 3 * u)) * arriving};
}

/// How far a joint's pose is beyond its limits (joint_limit.h), rad or m; 0 within.
template <class T>
T beyond_limits(const CharacterState<T>& s, int i, const Transform<T>& local) {
  const JointLaw<T>& law = s.problem.law;
  const Transform<T> rest = s.tree.rest[i].template cast<T>();
  T most = T(0);
  if (law.swing_limit[i] >= T(0)) {
    const Quat<T> relative = rest.rotation.conjugate() * local.rotation;
    const Vec3<T> a = law.swing_axis[i].template cast<T>();
    most = std::max(most, swing_angle<T>(relative, a) - T(law.swing_limit[i]));
    const T twist = twist_angle<T>(relative, a);
    return std::max({most, twist - T(law.twist_upper[i]), T(law.twist_lower[i]) - twist});
  }
  if (s.tree.type[i] == JointType::kFree) return most;
  const std::array<T, 6> offset = joint_offset_value<T>(s.tree, i, rest, local);
  for (int k = 0; k < s.tree.dof_count(i); ++k) {
    const int dof = s.tree.first_dof[i] + k;
    most = std::max({most, offset[k] - T(law.upper[dof]), T(law.lower[dof]) - offset[k]});
  }
  return most;
}

/// Where a return goes in a step, no further beyond a joint's limits than the joint is or its animation
/// wants. Where that carries the joint to its stop, the return is as much shorter as it has to be.
template <class T>
std::array<T, 6> within_limits(const CharacterState<T>& s, int i, const std::array<T, 6>& offset) {
  constexpr int kHalvings = 10;
  constexpr T kRoundings = T(1e-6);  // rad or m: clips that rest at a limit do so within roundings
  const auto beyond = [&](const std::array<T, 6>& at) {
    return beyond_limits(s, i, at_offset<T>(s.tree, i, s.wanted[i], at));
  };
  const T most =
      kRoundings + std::max(beyond_limits(s, i, s.wanted[i]), beyond_limits(s, i, s.problem.start[i]));
  if (!(beyond(offset) > most)) return offset;
  std::array<T, 6> inside = s.deviation[i].offset, outside = offset;
  if (beyond(inside) > most) {
    outside = inside;
    inside = {};
  }
  for (int n = 0; n < kHalvings; ++n) {
    std::array<T, 6> middle;
    for (std::size_t k = 0; k < middle.size(); ++k) middle[k] = (inside[k] + outside[k]) / 2;
    (beyond(middle) > most ? outside : inside) = middle;
  }
  return inside;
}

/// How far a pose takes what may stand on the floor below it, m.
template <class T>
T below_floor(CharacterState<T>& s, std::span<const Transform<T>> pose, T ground) {
  forward_kinematics<T>(s.tree, pose, s.problem.common_origin, s.guessed);
  const SupportPoints<T>& support = s.rig->support;
  T lowest = ground;
  for (int i = 0; i < s.tree.bodies; ++i)
    for (int k = support.first[i]; k < support.first[i + 1]; ++k) {
      const auto& point = support.points[k];
      lowest = std::min(
          lowest, s.guessed.origin[i].z() + s.guessed.rotation[i].row(2).dot(point.local) - point.radius);
    }
  return ground - lowest;
}

/// Its root gives way to what its feet meet.
template <class T>
bool is_raised_by_feet(const CharacterState<T>& s) {
  return (s.settings.root == RootDrive::kAssisted || s.grounded()) && s.settings.ground_contact && s.floats &&
         !s.rig->support.points.empty();
}

/// m, that an animation may take feet into the floor.
template <class T>
T pressed_by_clip(const CharacterState<T>& s) {
  return T(kPressedByClips) * s.tree.scale.length;
}

/// How far two poses are from each other, m and rad.
template <class T>
struct Apart {
  T moved, turned;
  Apart(const Transform<T>& a, const Transform<T>& b)
      : moved((b.translation - a.translation).norm()),
        turned(rotation_log<T>(a.rotation.conjugate() * b.rotation).norm()) {}
};

/// What the animation wants of the joint's own freedom, and of the rest what `base` has. Joints that slide,
/// and a universal joint's axes, are the animation's.
template <class T>
Transform<T> on_base(const Tree<T>& tree, int i, const Transform<T>& base, const Transform<T>& wanted) {
  switch (tree.type[i]) {
    case JointType::kFixed:
      return base;
    case JointType::kRevolute:
      return rebased<T>(tree, i, base, wanted);
    case JointType::kBall:
    case JointType::kUniversal:
      return {wanted.rotation, base.translation};
    default:
      return wanted;
  }
}

}  // namespace

template <class T>
void follow_across(CharacterState<T>& s, int i, T h, Transform<T>& wanted) {
  constexpr T kNothing = T(2e-5), kPace = T(1), kTurns = T(5);  // m or rad; m/s and rad/s of a human
  const bool driven = s.joint_is_driven(i) && !s.only_falls();
  if (driven && s.deviation[i].on_animation) return;
  const Transform<T> own_base = on_base(s.tree, i, s.local[i], wanted);
  const Apart<T> off(own_base, wanted);
  if (off.moved < kNothing * s.tree.scale.length && off.turned < kNothing) return;
  if (!driven) {
    wanted = own_base;
    return;
  }
  const JointJet<T>& last = s.last_target()[i];
  const Apart<T> own(on_base(s.tree, i, {last.rotation, last.translation}, wanted), wanted);
  const T time = h / s.tree.scale.time, pace = kPace * time * s.tree.scale.length, turns = kTurns * time;
  const T share = std::min((own.moved + pace) / std::max(off.moved, pace),
                           (own.turned + turns) / std::max(off.turned, turns));
  if (!(share < T(1))) return;
  wanted.translation = own_base.translation + share * (wanted.translation - own_base.translation);
  wanted.rotation = own_base.rotation.slerp(share, wanted.rotation);
}

template <class T>
void sum_subtrees(CharacterState<T>& s) {
  TreeProblem<T>& p = s.problem;
  for (int i = 0; i < s.tree.bodies; ++i) {
    const Mat3<T>& r = p.kinematics.rotation[i];
    p.composite[i] = {};
    p.composite[i].add_body(s.tree.mass[i], p.kinematics.center[i], r * s.tree.inertia[i] * r.transpose());
  }
  for (int i = s.tree.bodies - 1; i > 0; --i)
    if (const int parent = s.tree.parent[i]; parent >= 0) p.composite[parent] += p.composite[i];
}

template <class T>
T inertia_of(const TreeProblem<T>& p, int body, int dof) {
  const Vec3<T>&w = p.kinematics.w[dof], &v = p.kinematics.v[dof];
  const Composite<T>& c = p.composite[body];
  return c.mass * v.squaredNorm() + 2 * v.dot(w.cross(c.first)) + w.dot(c.rotational * w);
}

template <class T>
JointJet<T> animation_within(const JointJet<T>& before, const JointJet<T>& now, T frame, T fraction) {
  const Vec3<T> turn = rotation_log<T>(before.rotation.conjugate() * now.rotation);
  const Vec3<T> rate = now.omega + turn.cross(now.omega) / 2;  // of the rotation vector, to first order
  const auto [turned, turning] = on_the_way<T>(turn, frame * before.omega, frame * rate, fraction);
  const auto [moved, moving] = on_the_way<T>(now.translation - before.translation, frame * before.velocity,
                                             frame * now.velocity, fraction);
  JointJet<T> jet;
  jet.rotation = before.rotation * rotation_exp<T>(turned);
  jet.omega = right_jacobian<T>(turned) * turning / frame;
  jet.translation = before.translation + moved;
  jet.velocity = moving / frame;
  return jet;
}

template <class T>
void choose_targets(CharacterState<T>& s, T return_time, T ground, T h) {
  TreeProblem<T>& p = s.problem;
  if (s.only_falls()) {
    std::copy(s.wanted.begin(), s.wanted.end(), p.target.begin());
    return;
  }
  return_time *= s.tree.scale.time;
  const T decay = portable::exp(-h / return_time);
  bool summed = false;
  for (int i = 0; i < s.tree.bodies; ++i) {
    const Deviation<T>& d = s.deviation[i];
    p.target[i] = s.wanted[i];
    if (d.on_animation || (s.joint_has_tone(i) && !s.grounding.returns)) continue;
    std::array<T, 6> offset{};
    for (int k = 0; k < s.tree.dof_count(i); ++k) {
      const int dof = s.tree.first_dof[i] + k;
      const T now = d.offset[k];
      offset[k] = (now + (d.rate[k] + now / return_time) * h) * decay;
      const T limit = now > T(0) ? p.law.torque_plus[dof] : p.law.torque_minus[dof];
      if (now == T(0) || !(limit > T(0)) || std::isinf(limit)) continue;
      if (!summed) sum_subtrees(s);
      summed = true;
      const T inertia = inertia_of(p, i, dof);
      if (!(inertia > T(0))) continue;
      // What carries it beyond its target is no return that could be braked: it was thrown.
      const T beyond = now * d.rate[k] < T(0) ? h * std::abs(d.rate[k]) - std::abs(now) : T(0);
      const T most = std::max(h * stoppable<T>(now, T(kBraking) * limit / inertia, h), beyond);
      offset[k] = now > T(0) ? std::max(offset[k], now - most) : std::min(offset[k], now + most);
    }
    p.target[i] = at_offset<T>(s.tree, i, s.wanted[i], within_limits(s, i, offset));
  }
  if (!is_raised_by_feet(s) || std::isinf(ground)) return;
  const T target = below_floor<T>(s, p.target, ground),
          clip = s.calm ? target : below_floor<T>(s, s.wanted, ground);
  const T deeper = target - std::min(clip, pressed_by_clip(s));
  const T share = s.grounded() ? T(1) - decay : T(1);  // no help of his drives him there: he would leap
  p.target[0].translation.z() += share * std::max(deeper, T(0));
}

template <class T>
bool drives_into_floor(CharacterState<T>& s, const WorldSettings& world) {
  if (!is_raised_by_feet(s) || !world.ground) return false;
  for (int i = 0; i < s.tree.bodies; ++i) s.wanted[i] = {s.target[i].rotation, s.target[i].translation};
  s.problem.common_origin = s.wanted[0].translation;
  const T ground = height_of_floor<T>(world, double(s.problem.common_origin.z()));
  return below_floor<T>(s, s.wanted, ground) > pressed_by_clip(s);
}

template JointJet<float> animation_within<float>(const JointJet<float>&, const JointJet<float>&, float,
                                                 float);
template JointJet<double> animation_within<double>(const JointJet<double>&, const JointJet<double>&, double,
                                                   double);
template void follow_across<float>(CharacterState<float>&, int, float, Transform<float>&);
template void follow_across<double>(CharacterState<double>&, int, double, Transform<double>&);
template bool drives_into_floor<float>(CharacterState<float>&, const WorldSettings&);
template bool drives_into_floor<double>(CharacterState<double>&, const WorldSettings&);
template void sum_subtrees<float>(CharacterState<float>&);
template float inertia_of<float>(const TreeProblem<float>&, int, int);
template void choose_targets<float>(CharacterState<float>&, float, float, float);
template void sum_subtrees<double>(CharacterState<double>&);
template double inertia_of<double>(const TreeProblem<double>&, int, int);
template void choose_targets<double>(CharacterState<double>&, double, double, double);

}  // namespace sinew
