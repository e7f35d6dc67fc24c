// The physical body → MJCF, MuJoCo's XML.
#pragma once

#include <string>
#include <vector>

#include "sinew/skeleton/skeleton.h"

namespace sinew::exporting {

/// The file's text: bodies with masses and principal moments, joints with axes, limits, damping and dry
/// friction, colliders, a motor per degree of freedom with its torque limits, joints that ride along as
/// sites, and a floor. `notes` gains what MJCF cannot hold: cones and boxes of limits of ball joints (their
/// largest angle bounds them instead), ellipsoids of torques, a damping per axis of a ball joint.
std::string write_mjcf(const Skeleton& skeleton, std::vector<std::string>& notes);

}  // namespace sinew::exporting
