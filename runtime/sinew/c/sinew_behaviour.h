/// @file
/// Balance: a character with SINEW_ROOT_GROUNDED that gives, steps, staggers or falls when it is pushed. Part
/// of sinew.h.
#ifndef SINEW_C_SINEW_BEHAVIOUR_H
#define SINEW_C_SINEW_BEHAVIOUR_H

#ifndef SINEW_C_SINEW_H
#error "include sinew/c/sinew.h"
#endif

/// What a behaviour does.
typedef int32_t sinew_behaviour_state;
/// Values of sinew_behaviour_state.
enum sinew_behaviour_state_values {
  SINEW_BEHAVIOUR_CLIP = 0,     ///< the animation, and nothing else
  SINEW_BEHAVIOUR_PASSIVE = 1,  ///< pushed, and not reacting yet
  SINEW_BEHAVIOUR_BALANCE = 2,  ///< gives way, and stays on its feet
  SINEW_BEHAVIOUR_STEP = 3,     ///< puts a foot where it will stand
  SINEW_BEHAVIOUR_FALL = 4,     ///< has given up
  SINEW_BEHAVIOUR_DOWN = 5      ///< lies still: the host decides how it gets up
};

/// What the host may ask of a behaviour.
typedef int32_t sinew_behaviour_order;
/// Values of sinew_behaviour_order.
enum sinew_behaviour_order_values {
  SINEW_BEHAVIOUR_KNOCK_DOWN = 0,  ///< falls
  SINEW_BEHAVIOUR_STAND = 1        ///< is on its animation again
};

/// How a character keeps its balance. Fields mean what those of BehaviourSettings do.
typedef struct sinew_behaviour_settings {
  uint32_t size;           ///< bytes of this struct, as the caller knows it
  int32_t most_steps;      ///< before it gives up
  double reaction;         ///< s
  double gravity;          ///< m/s2, the world's
  double help_torque;      ///< N m of a human
  double fallen_strength;  ///< of the muscles of who fell
  double let_go;           ///< s
} sinew_behaviour_settings;

/// How a character keeps its balance now.
typedef struct sinew_behaviour_report {
  uint32_t size;                ///< bytes of this struct, as the caller knows it
  sinew_behaviour_state state;  ///< what it does
  int32_t steps;                ///< since the push
  int32_t unused;               ///< 0
  double capture_depth;         ///< m, of the capture point inside the standing soles
  double time;                  ///< s since the push
  double fell_beyond;           ///< m that the capture point was beyond reach, where it fell
} sinew_behaviour_report;

/// The library's defaults.
SINEW_API sinew_status sinew_behaviour_settings_init(sinew_behaviour_settings* settings);
/// Set-up; a second one takes the place of the first. Not part of snapshots. `settings` may be null.
SINEW_API sinew_status sinew_character_add_behaviour(sinew_character character,
                                                     const sinew_behaviour_settings* settings);
/// Before a step of h seconds, with what the animation wants at its end: changed where the behaviour acts,
/// and made the target. One jet for each joint, aligned to 16 bytes.
SINEW_API sinew_status sinew_character_balance(sinew_character character, sinew_jet* jets, int32_t count,
                                               float h);
/// Knocks it down, or has who is down stand on its animation again.
SINEW_API sinew_status sinew_character_order(sinew_character character, sinew_behaviour_order order);
/// What its behaviour does; refused without one.
SINEW_API sinew_status sinew_character_get_behaviour(sinew_character character, sinew_behaviour_report* out);

#endif
