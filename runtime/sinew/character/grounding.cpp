#include "sinew/character/grounding.h"

#include <algorithm>
#include <cmath>

#include "sinew/muscle/joint_coordinates.h"
#include "sinew/skeleton/rotation.h"

namespace sinew {
namespace {

// Of a human: what counts as standing where the animation wants it.
constexpr double kTurn = 0.0175;    ///< rad, of the root's tilt and of every joint
constexpr double kSpeed = 0.02;     ///< m/s, of the root from the animation
constexpr double kTurnSpeed = 0.1;  ///< rad/s, of the root and of every joint
constexpr double kRest = 0.2;       ///< s that it has to stand so
// Of joints with a tone: near its animation the return goes on with the speed that there is; what bears may
// have settled further off.
constexpr double kGivenWay = 0.05, kSettled = 0.2;            ///< rad
constexpr double kGivenWaySpeed = 0.3, kSettledSpeed = 0.05;  ///< rad/s
constexpr double kHome = 0.1;                                 ///< s
/// s after which who is so near is led home however fast it swings: of what a blow has set swinging a tenth
/// is left by then.
constexpr double kAlone = 3;
// Of who is asked to come back: what it may be off.
constexpr double kNear = 0.06, kNearTurn = 0.105;          ///< m, rad
constexpr double kNearSpeed = 0.12, kNearTurnSpeed = 0.6;  ///< m/s, rad/s
constexpr double kNearPace = 0.1;                          ///< of its target's speed over ground: of who runs

/// The displacement that takes the animation's root to the body's: the turn about the vertical that leaves
/// the least tilt, and up or down where it stands on ground of another height. It does not lie in that by the
/// `depth` (m) that its body does: as deep as the animation pressed it, which would go on for ever.
template <class T>
Displacement towards(const Transform<T>& wanted, const Transform<T>& is, double depth, double unit) {
  const Quat<double> off =
      is.rotation.template cast<double>() * wanted.rotation.template cast<double>().conjugate();
  Displacement d;
  d.yaw = twist_angle<double>(off, Vec3<double>::UnitZ());
  const Vec3<double> from = wanted.translation.template cast<double>();
  const Vec3<double> to = is.translation.template cast<double>(), turned = d.turn() * from;
  d.x = to.x() - turned.x();
  d.y = to.y() - turned.y();
  if (const double up = to.z() - turned.z(); std::abs(up) > kOffGround * unit) d.z = up + depth;
  return d;
}

template <class T>
bool within(const std::array<T, 6>& x, int first, int last, T most) {
  return std::all_of(x.begin() + first, x.begin() + last, [&](T v) { return std::abs(v) < most; });
}

/// Whether no joint with a tone is further off than what bears may be at rest, and all others are where the
/// animation wants them.
template <class T>
bool joints_swing_near(const CharacterState<T>& s) {
  for (int i = 1; i < s.tree.bodies; ++i)
    if (!within(s.deviation[i].offset, 0, 6, T(s.joint_has_tone(i) ? kSettled : kTurn))) return false;
  return true;
}

/// Whether all joints but the root are where the animation wants them.
template <class T>
bool joints_rest(const CharacterState<T>& s) {
  const T time = s.tree.scale.time;
  for (int i = 1; i < s.tree.bodies; ++i) {
    const Deviation<T>& d = s.deviation[i];
    if (d.on_animation && !d.released) continue;
    if (s.joint_has_tone(i)) {
      const bool near = within(d.offset, 0, 6, T(kGivenWay));
      if (!within(d.offset, 0, 6, T(kSettled)) ||
          !within(d.rate, 0, 6, T(near ? kGivenWaySpeed : kSettledSpeed) / time))
        return false;
      continue;
    }
    if (d.released || !within(d.offset, 0, 6, T(kTurn)) || !within(d.rate, 0, 6, T(kTurnSpeed) / time))
      return false;
  }
  return true;
}

/// Whether it is so near that it may be led back while it moves; it is, then.
template <class T>
bool is_led_back(CharacterState<T>& s) {
  const T time = s.tree.scale.time, unit = s.tree.scale.length;
  Deviation<T>& root = s.deviation[0];
  const Vec3<T> over_ground = s.target[0].velocity - s.report.ground.velocity.template cast<T>();
  const T fast = std::max(T(kNearSpeed) * unit / time, T(kNearPace) * over_ground.norm());
  if (!within(root.offset, 0, 3, T(kNear) * unit) || !within(root.offset, 3, 6, T(kNearTurn)) ||
      !within(root.rate, 0, 3, fast) || !within(root.rate, 3, 6, T(kNearTurnSpeed) / time))
    return false;
  for (int i = 0; i < s.tree.bodies; ++i) s.deviation[i].released = false;
  s.grounding.returns = true;
  s.grounding.rest = T(0);
  s.clear_deviations();
  return true;
}

/// Muscles with a tone let go of what is left of a character that nothing acts on: it returns to its
/// animation without unknowns. What keeps it swinging is only that a solve shares weights among feet
/// otherwise than the check, and steps are coarse: after some seconds it does not wait for that to end.
template <class T>
void lead_home(CharacterState<T>& s, bool touched, T h) {
  Grounding<T>& g = s.grounding;
  const T time = s.tree.scale.time;
  g.rest = !s.acted_on && joints_rest(s) ? g.rest + h : T(0);
  g.alone = s.acted_on || touched ? T(0) : g.alone + h;
  if (g.rest < T(kHome) * time && !(g.alone > T(kAlone) * time && joints_swing_near(s))) return;
  g.alone = T(0);
  for (int i = 0; i < s.tree.bodies; ++i)
    if (s.joint_has_tone(i)) s.deviation[i].released = false;
  g.returns = true;
  s.clear_deviations();
}

}  // namespace

template <class T>
JointJet<T> displaced(const Displacement& by, const JointJet<T>& jet) {
  if (!by.any()) return jet;
  const Quat<double> turn = by.turn();
  const Quat<T>& rotation = turn.cast<T>();
  JointJet<T> out = jet;  // angular velocities are in the child's axes
  out.rotation = rotation * jet.rotation;
  out.velocity = rotation * jet.velocity;
  out.acceleration = rotation * jet.acceleration;
  const Vec3<double> place = turn * jet.translation.template cast<double>() + Vec3<double>(by.x, by.y, by.z);
  out.translation = place.template cast<T>();
  return out;
}

template <class T>
void displace_target(CharacterState<T>& s, const Displacement& further) {
  s.grounding.by = s.grounding.by.then(further);
  s.target[0] = displaced(further, s.target[0]);
  if (!s.target_stands) s.target_before[0] = displaced(further, s.target_before[0]);
  Deviation<T>& d = s.deviation[0];
  if (!s.floats) return;
  d.offset = joint_offset_value<T>(s.tree, 0, {s.target[0].rotation, s.target[0].translation}, s.local[0]);
  d.on_animation = false;
  s.calm = false;
}

template <class T>
void hand_back(CharacterState<T>& s, bool touched, T h) {
  Grounding<T>& g = s.grounding;
  g.returns = false;
  if (!s.grounded()) return lead_home(s, touched, h);
  if (!s.floats) return;
  if (g.comes_back && is_led_back(s)) return;
  const T time = s.tree.scale.time, unit = s.tree.scale.length;
  const Transform<T> wanted{s.target[0].rotation, s.target[0].translation};
  const Displacement further = towards<T>(wanted, s.local[0], s.report.ground.depth, double(unit));
  const JointJet<T> there = displaced(further, s.target[0]);
  const std::array<T, 6> left =
      joint_offset_value<T>(s.tree, 0, {there.rotation, there.translation}, s.local[0]);
  const std::array<T, 6>& rate = s.deviation[0].rate;
  const bool rests = within(left, 3, 6, T(kTurn)) && within(rate, 0, 3, T(kSpeed) * unit / time) &&
                     within(rate, 3, 6, T(kTurnSpeed) / time) && joints_rest(s);
  g.rest = rests ? g.rest + h : T(0);
  if (g.rest < T(kRest) * time) return;
  displace_target(s, further);
  s.deviation[0].offset = left;
  s.deviation[0].rate = {};
  s.deviation[0].released = false;
  g.returns = true;
  s.clear_deviations();
}

SINEW_GROUNDING_INSTANCES(template, float)
SINEW_GROUNDING_INSTANCES(template, double)

}  // namespace sinew
