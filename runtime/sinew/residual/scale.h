// How large a rig is: the unit that the lengths, speeds, times and stiffnesses of a step are given in.
//
// Two rigs of one build move alike under the same gravity when times go with the square root of lengths
// (Froude's number; Alexander & Jayes, "A dynamic similarity hypothesis for the gaits of quadrupedal
// mammals", 1983). So settings such as Accuracy's and the constants beside them are those of a figure of
// human size, and any other takes its share of them.
#pragma once

#include "sinew/skeleton/skeleton.h"

namespace sinew {

/// By those of the 37-DOF humanoid (tools/scene/humanoid.h: 75 kg, 0.95 m from its centre of mass to its
/// feet), for which all are exactly 1.
template <class T>
struct Scale {
  T length = T(1);  ///< of the furthest body from the centre of mass, at rest
  T time = T(1);    ///< √length; of speeds too
  T energy = T(1);  ///< total mass · length, or length⁴ where that is more
  T load = T(1);    ///< most that hangs on one joint: mass · distance. Of torques that hold it
};

/// At rest. A rig none of whose joints turns anything (a prop, loose particles) needs no unit of its own to
/// be solved in, and keeps the human's unless that is absurd: where it is more than twice as large, or
/// smaller than a thirtieth. Cost O(joints²) at worst; for set-up.
Scale<double> scale_of(const Skeleton& skeleton);

}  // namespace sinew
