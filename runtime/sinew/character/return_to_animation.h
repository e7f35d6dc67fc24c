// The muscles' targets: the animation, or the return to it of a joint that was thrown off.
#pragma once

#include <algorithm>
#include <limits>

#include "sinew/character/state.h"

namespace sinew {

/// m of a human: what clips press into floor, obstacles and each other, a sole that is a little low, a hand
/// that leans on something: as deep it may lie there, 3 cm with what the contact gives. What they press by
/// more is kept out, twice that wholly.
constexpr double kPressedByClips = 0.027;
/// The same of figures and props, unless what bears them is a platform: nobody made the clip for where they
/// are.
constexpr double kPressedIntoOthers = 0.01;

/// From the common origin, at `origin_height` in the world (m); −∞ without a floor.
template <class T>
T height_of_floor(const WorldSettings& world, double origin_height) {
  return world.ground ? T(world.ground_height - origin_height) : -std::numeric_limits<T>::infinity();
}

/// Writes `problem.target` for a part of h seconds that ends at `state.wanted`. The return is critically
/// damped with time constant `return_time` (s, of a human), e(h) = (e₀ + (ė₀ + e₀/τ)·h)·exp(−h/τ), e the
/// offset from the animation; and no faster than the muscle can stop again with a third of its strength, or a
/// return time far below the step would fling the joint across. It leads no joint further beyond its limits
/// than it is. A muscle with a tone needs none: its target is the animation. An assisted root goes over the
/// floor: it is raised by what the animation, beyond kPressedByClips, and the joints' ways back would take
/// feet into it, or it would press them there for good; a grounded one as fast as it returns. `ground` is the
/// floor's height from the common origin (m), −∞ without one. `problem.kinematics` must be those at
/// `problem.start`.
template <class T>
void choose_targets(CharacterState<T>& state, T return_time, T ground, T h);

/// What an animation does across a joint's axes (a bone that stretches, a knee's roll) is done to who follows
/// it, played or solved: takes from `wanted`, the animation of a joint at the end of h seconds, what of that
/// the joint does not follow. One without muscles keeps what it has, or a clip that plays on would kick a
/// limp body; with its strength back it catches up, at a pace.
template <class T>
void follow_across(CharacterState<T>& state, int joint, T h, Transform<T>& wanted);

/// Each body's subtree as one rigid body, about the common origin, into `problem.composite`: with the
/// kinematics that the problem holds. O(bodies).
template <class T>
void sum_subtrees(CharacterState<T>& state);

/// Inertia (kg·m², kg) that a degree of freedom of a body's joint moves while the rest stands still. After
/// sum_subtrees().
template <class T>
T inertia_of(const TreeProblem<T>& problem, int body, int dof);

/// Whether an animation whose root is assisted, not driven, takes feet so deep into the floor that its root
/// has to be raised, at the end of the next step: it can't be played. Writes `wanted`. O(bodies).
template <class T>
bool drives_into_floor(CharacterState<T>& state, const WorldSettings& world);

/// Whether the rates (per frame) at both ends of a frame do not belong to the motion `whole` in it: a host
/// that stopped its clip, or knows none. A motion that turns back has rates that are larger than what they
/// lead to.
template <class T>
bool are_foreign(const Vec3<T>& whole, const Vec3<T>& leaving, const Vec3<T>& arriving) {
  const T off = (whole - (leaving + arriving) / 2).norm();
  return off > std::max(whole.norm() / 2, std::max(leaving.norm(), arriving.norm()) / 3);
}

/// rad/s or m/s at the end of h seconds in which a joint has `moved`: as its animation arrives, or at the
/// mean speed of its way where its rates are foreign to that.
template <class T>
Vec3<T> rate_at_end(const Vec3<T>& moved, const Vec3<T>& leaving, const Vec3<T>& arriving, T h) {
  const Vec3<T> mean = moved / h;
  return are_foreign(mean, leaving, arriving) ? mean : arriving;
}

/// Where an animation that goes from `before` to `now` within a frame of so many seconds is at a fraction of
/// it, and how fast: pose, angular velocity and velocity of the jet; on the cubic with the velocities at both
/// ends.
template <class T>
JointJet<T> animation_within(const JointJet<T>& before, const JointJet<T>& now, T frame, T fraction);

extern template JointJet<float> animation_within<float>(const JointJet<float>&, const JointJet<float>&, float,
                                                        float);
extern template JointJet<double> animation_within<double>(const JointJet<double>&, const JointJet<double>&,
                                                          double, double);
extern template void follow_across<float>(CharacterState<float>&, int, float, Transform<float>&);
extern template void follow_across<double>(CharacterState<double>&, int, double, Transform<double>&);
extern template bool drives_into_floor<float>(CharacterState<float>&, const WorldSettings&);
extern template bool drives_into_floor<double>(CharacterState<double>&, const WorldSettings&);
extern template void sum_subtrees<float>(CharacterState<float>&);
extern template float inertia_of<float>(const TreeProblem<float>&, int, int);
extern template void choose_targets<float>(CharacterState<float>&, float, float, float);
extern template void sum_subtrees<double>(CharacterState<double>&);
extern template double inertia_of<double>(const TreeProblem<double>&, int, int);
extern template void choose_targets<double>(CharacterState<double>&, double, double, double);

}  // namespace sinew
