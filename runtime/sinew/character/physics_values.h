// What a character's body does: the motion that it has, and the figures that graphs and games decide by.
//
//     std::vector<float> loads(joints);                                     // room, once
//     std::vector<JointJet<float>> body(joints);
//     …each frame, after the step:
//     sinew::set_physics<float>(graph, state, sinew::physics_values<float>(hero, loads));
//     sinew::physical_motion<float>(hero, body);                            // for a graph's physical pose
//     job.physical = body;
#pragma once

#include <span>

#include "sinew/animation/physics_values.h"
#include "sinew/character/world.h"

namespace sinew {

/// Of the last step. `joint_load` [joint]: room for PhysicsValues::joint_load, which refers to it then; may
/// be shorter, or empty. Zeros, and a height of 1, of a handle that stands for nobody. Loads and contacts are
/// not part of snapshots: ask after a step, so that a graph's block, which is, holds them. Allocates nothing.
/// Cost O(joints · depth) off the animation, else O(joints).
template <class T>
PhysicsValues<T> physics_values(const Character<T>& character, std::span<T> joint_load = {});

/// `out` [joint]: how the body moves at the end of the last step, local, as a clip would tell it. Rates are
/// those of the simulation. Accelerations are those by which it went into the end of the step: what an impact
/// did within it is in the rates alone; they are 0 where the history does not know them, as after a reset of
/// a body that is limp. Joints without a body are where they are, at rest. Only joints that are there are
/// written; nothing is, of a handle that stands for nobody. `out` shorter than the bodies gives poses alone.
/// Allocates nothing. Not by two threads at once. Cost O(joints).
template <class T>
void physical_motion(const Character<T>& character, std::span<JointJet<T>> out);

#define SINEW_PHYSICS_VALUES_INSTANCES(prefix, T)                                        \
  prefix template PhysicsValues<T> physics_values<T>(const Character<T>&, std::span<T>); \
  prefix template void physical_motion<T>(const Character<T>&, std::span<JointJet<T>>);
SINEW_PHYSICS_VALUES_INSTANCES(extern, float)
SINEW_PHYSICS_VALUES_INSTANCES(extern, double)

}  // namespace sinew
