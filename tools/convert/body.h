// The physical body of a rig that has none: which joints are simulated, masses, inertias, colliders, limits,
// muscles.
#pragma once

#include "convert/options.h"
#include "convert/rig.h"

namespace sinew::convert {

/// Skeleton of a rig: simulated joints first. `joint_of_rig` maps rig joints to skeleton joints.
/// Masses and inertias of the skin's volume (or, without a mesh, published segment masses on shapes fitted to
/// the bones) scaled to the total; limits by anatomy, widened to hold the clips' own poses; published
/// strengths.
Skeleton build_body(const Rig& rig, const Options& options, std::vector<int>& joint_of_rig,
                    nlohmann::json& report);

/// Solid inertia of a collider about its own centre, in its own axes, for a mass in kg.
Mat3<double> solid_inertia(const Collider& shape, double mass);

}  // namespace sinew::convert
