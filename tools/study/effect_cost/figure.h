// What effects are counted on: a wheel of 64 rods on hinges about a fixed hub, the same all the way round, so
// that cost could be linear in the rods that an effect acts on.
#pragma once

#include <string>
#include <vector>

#include "sinew/animation/clip.h"
#include "sinew/skeleton/skeleton.h"

namespace sinew::study {

constexpr int kRods = 64;
constexpr float kRodAngle = 2 * 3.14159265f / kRods;
constexpr float kStep = 1 / 60.f;

/// Terms that the solver has built in, on the first so many rods.
struct BuiltIn {
  int muscles = 0, limits = 0, damping = 0, dry_friction = 0, colliders = kRods;
};

/// Lying at a height, m.
Skeleton wheel(const BuiltIn& on, double height = 0);
/// On joint 0.
Collider rod_capsule();
std::vector<std::string> first_rods(int count);
std::vector<JointJet<float>> at_rest(const Skeleton& skeleton);

}  // namespace sinew::study
