// Skeletons that a scene file describes itself.
#pragma once

#include "scene/reader.h"
#include "sinew/skeleton/skeleton.h"

namespace sinew::scene {

/// A character's `figure`: one of the kinds made in bodies.h, or a list of joints; then what is to be changed
/// in it. Fails where the result is no valid skeleton.
Skeleton read_figure(const json& value, const std::string& where);

/// What colliders, props and obstacles say of themselves: `shape` (sphere), and `size` as
/// Collider::size, one number for all three; of who is convex `points`, or a `prism`. Hulls are kept for as
/// long as the program runs.
void read_shape(const Reader& in, Collider& out);

}  // namespace sinew::scene
