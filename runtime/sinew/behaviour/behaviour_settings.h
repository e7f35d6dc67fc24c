// What a game sets of a body that keeps its balance.
#pragma once

#include <cstdint>

namespace sinew {

/// When a body that lies at rest gets up.
enum class GetUpPolicy : std::uint8_t {
  kAuto,         ///< as soon as it lies still
  kWhenAllowed,  ///< when Behaviour::get_up() has been called
  kNever,        ///< dead
};

/// Where it says "of a human", a figure's is by its size and mass.
struct BehaviourSettings {
  double reaction = 0.125;  ///< s, in which nothing but physics acts (Bortolami 2003: 125 ms)
  double gravity = 9.81;    ///< m/s²: the world's
  int most_steps = 4;       ///< before the body gives up
  double help_torque = 60;  ///< N·m of a human, that may keep the trunk up while it balances; see the report
  double walk_torque = 120;  ///< N·m of a human, likewise while steps of a walk catch it
  /// N of a human, likewise: a tenth of its weight. Beside it, what the animation asks of no floor by itself.
  double walk_force = 75;
  double fallen_strength = 0.02;  ///< of the muscles, once it lies: limbs do not flail
  double let_go = 0.15;           ///< s, in which they come to that, or to what they reach with
  /// Of the arms' muscles, while they reach for the ground in a fall; trunk and legs have less. 0: nothing
  /// reaches, as of who is unconscious.
  double reach_strength = 0.7;
  GetUpPolicy get_up = GetUpPolicy::kAuto;  ///< needs clips, see Behaviour::use_get_ups()
  double gather = 0.6;      ///< s, of a human, from where it lies into the pose from which it rises
  double rise_force = 0;    ///< N of a human, that an invisible hand may do while it rises; see the report
  double rise_torque = 60;  ///< N·m of a human, likewise
};

}  // namespace sinew
