// The muscles' targets: the animation, or the way back to it of a joint that was thrown off.
#pragma once

#include "sinew/character/state.h"

namespace sinew {

/// Writes `problem.target` for a part of h seconds that ends at `state.wanted`. The way back is critically
/// damped with time constant `return_time` (s), e(h) = (e₀ + (ė₀ + e₀/τ)·h)·exp(−h/τ), e the offset from the
/// animation; and no faster than the muscle can stop again with half its strength, or a return time far below
/// the step would fling the joint across. `problem.start` and `problem.common_origin` must be set.
template <class T>
void choose_targets(CharacterState<T>& state, T return_time, T h);

/// The animation at a fraction of a frame of `frame` seconds between two targets: the cubic with the
/// velocities at both ends.
template <class T>
Transform<T> animation_within(const JointJet<T>& before, const JointJet<T>& now, T frame, T fraction);

extern template Transform<float> animation_within<float>(const JointJet<float>&, const JointJet<float>&,
                                                         float, float);
extern template Transform<double> animation_within<double>(const JointJet<double>&, const JointJet<double>&,
                                                           double, double);
extern template void choose_targets<float>(CharacterState<float>&, float, float);
extern template void choose_targets<double>(CharacterState<double>&, double, double);

}  // namespace sinew
