// A root that has nothing but the ground (RootDrive::kGrounded): when it goes back to its animation, and
// where. Internal to the character layer.
//
// On its animation the check asks whether the ground can do it (ground_balance.h). Where it can't, the root
// is solved for like a joint whose muscle is too weak. A body that comes to rest again stands where its feet
// are, not where the animation would have them: it is taken as displaced, level, to ground of another height
// and about the vertical, and follows its animation from there. Only what is left of height and tilt returns
// in its own time.
#pragma once

#include "sinew/character/state.h"

namespace sinew {

constexpr double kOffGround = 3e-3;  ///< m of a human, by which soles of a clip may be off its ground
constexpr double kGoodGrip = 0.6;    ///< μ of a floor that no animation may blame

/// A jet of the animation's root where the character has been displaced to.
template <class T>
JointJet<T> displaced(const Displacement& by, const JointJet<T>& jet);

/// Takes a character's animation elsewhere, between steps.
template <class T>
void displace_target(CharacterState<T>& state, const Displacement& further);

/// After a solved part of h seconds of a grounded character, or of one whose muscles have a tone: whether it
/// has been as its animation wants it for long enough. If so, a grounded one is displaced, and the ordinary
/// return takes it onto its animation. `touched`: by more than what it stands on, of who has muscles with a
/// tone. After what bears it has been reported.
template <class T>
void hand_back(CharacterState<T>& state, bool touched, T h);

#define SINEW_GROUNDING_INSTANCES(prefix, T)                                       \
  prefix JointJet<T> displaced<T>(const Displacement& by, const JointJet<T>& jet); \
  prefix void displace_target<T>(CharacterState<T>&, const Displacement&);         \
  prefix void hand_back<T>(CharacterState<T>&, bool, T);
SINEW_GROUNDING_INSTANCES(extern template, float)
SINEW_GROUNDING_INSTANCES(extern template, double)

}  // namespace sinew
