// The physical body of a rig that has none: which joints are simulated, masses, inertias, colliders, limits,
// muscles.
#pragma once

#include "convert/options.h"
#include "convert/rig.h"

namespace sinew::convert {

/// Skeleton of a rig: simulated joints first. `joint_of_rig` maps rig joints to skeleton joints.
/// Masses from skinned volume (or, without a mesh, from bone lengths) scaled to the total; inertias of the
/// fitted shapes, which obey the triangle inequality; limits by anatomy, widened to hold the clips' own
/// poses.
Skeleton build_body(const Rig& rig, const Options& options, std::vector<int>& joint_of_rig,
                    nlohmann::json& report);

/// Raises every muscle to the peak torque that the clips ask (recursive residual pass, feet supported) times
/// the margin.
void strengthen(const std::vector<Clip>& clips, double margin, Skeleton& skeleton, nlohmann::json& report);

/// Solid inertia of a collider about its own centre, in its own axes, for a mass in kg.
Mat3<double> solid_inertia(const Collider& shape, double mass);

}  // namespace sinew::convert
