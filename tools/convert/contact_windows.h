// When feet and hands rest on the floor that a clip moves on.
#pragma once

#include <nlohmann/json.hpp>
#include <vector>

#include "sinew/animation/clip.h"
#include "sinew/effects/contact.h"
#include "sinew/skeleton/skeleton.h"

namespace sinew::convert {

/// Height of the floor that a clip moves on, m, from the height of the body's lowest point in each frame:
/// where that is most often, to a centimetre. Some frames are in flight, and in some a collider thicker than
/// the skin sinks in.
double floor_of(std::vector<double> lowest);

/// What of a limb touches the floor: the points of the colliders of a joint and of all joints below it, of
/// toes and fingers too.
std::vector<ContactPoint<double>> points_below(const Skeleton& skeleton, int joint);

/// Finds Clip::contacts, of feet (toes are theirs) and hands: the limb's lowest point is at most 3 cm above
/// the floor, and rests there. A clip that walks in place moves all its feet back at one speed, which then
/// counts as rest. Lengths are those of a body of 1.75 m, times its size. Windows shorter than 60 ms are
/// none, gaps shorter than 50 ms neither; of a loop, a window that runs over the seam ends beyond the
/// duration.
///
/// And, where a loop's feet take turns, Clip::markers and Clip::cycles: left feet come down at whole phases.
void find_contacts(const Skeleton& skeleton, double height, Clip& clip, nlohmann::json& report);

}  // namespace sinew::convert
