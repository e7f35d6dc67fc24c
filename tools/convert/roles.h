// Which joint is which body part, by the names of the common rigs.
#pragma once

#include <string>
#include <vector>

#include "sinew/skeleton/skeleton.h"

namespace sinew::convert {

/// Role by name alone: Mixamo, CMU/BVH, KayKit, Unreal, Rigify, VRM, Biped. kNone where nothing fits.
/// Several spine or clavicle joints may share a role; a chain's first joint is meant.
Role role_of_name(const std::string& name);

/// Names of joints that steer others and are no body part (IK targets, poles, slots).
bool is_control_name(const std::string& name);

/// "thigh_l" for Role::kThighL; empty for kNone.
std::string role_name(Role role);
Role role_from_name(const std::string& role);

}  // namespace sinew::convert
