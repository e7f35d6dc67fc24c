// What a game sets of a body that keeps its balance.
#pragma once

namespace sinew {

struct BehaviourSettings {
  double reaction = 0.125;  ///< s, in which nothing but physics acts (Bortolami 2003: 125 ms)
  double gravity = 9.81;    ///< m/s²: the world's
  int most_steps = 4;       ///< before the body gives up
  double help_torque = 60;  ///< N·m of a human, that may keep the trunk up while it balances; see the report
  double fallen_strength = 0.02;  ///< of the muscles, once it falls: limbs do not flail
  double let_go = 0.15;           ///< s, in which they come to that
};

}  // namespace sinew
