// Short ways to what hard cases, maps and tests are made of.
#pragma once

#include "scene/bodies.h"
#include "scene/humanoid.h"
#include "scene/start.h"
#include "study/stage.h"

namespace sinew::study {

using scene::ball_body;
using scene::bend;
using scene::box_body;
using scene::box_inertia;
using scene::chain;
using scene::ChainShape;
using scene::free_body;
using scene::humanoid;
using scene::make_frictionless;
using scene::randomise_speeds;

CharacterSettings passive();
WorldSettings weightless();
/// A frictionless limp humanoid in the air, random joint speeds.
template <class T>
int add_thrown_humanoid(Stage<T>& stage, double height, double rms, unsigned seed);

/// A scene's own copy of a character's skeleton, to change it.
Skeleton& skeleton_of(scene::Scene& scene, int character = 0);

Collider obstacle_box(const Vec3<double>& center, const Vec3<double>& half, double friction = 0.8);

}  // namespace sinew::study
