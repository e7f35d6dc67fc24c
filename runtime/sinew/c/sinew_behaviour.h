/// @file
/// Balance: a character with SINEW_ROOT_GROUNDED that gives, steps, staggers or falls when it is pushed, and
/// gets up. Part of sinew.h.
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
  SINEW_BEHAVIOUR_DOWN = 5,     ///< lies still: it may get up, or the host decides how
  SINEW_BEHAVIOUR_GATHER = 6,   ///< lies, and comes into the pose from which it rises
  SINEW_BEHAVIOUR_RISE = 7      ///< gets up
};

/// What the host may ask of a behaviour.
typedef int32_t sinew_behaviour_order;
/// Values of sinew_behaviour_order.
enum sinew_behaviour_order_values {
  SINEW_BEHAVIOUR_KNOCK_DOWN = 0,  ///< falls
  SINEW_BEHAVIOUR_STAND = 1,       ///< is on its animation again
  SINEW_BEHAVIOUR_GET_UP = 2       ///< gets up as soon as it lies still; refused where it never may or can
};

/// When a body that lies still gets up.
typedef int32_t sinew_get_up_policy;
/// Values of sinew_get_up_policy.
enum sinew_get_up_policy_values {
  SINEW_GET_UP_AUTO = 0,          ///< as soon as it lies still, if it has clips to get up by
  SINEW_GET_UP_WHEN_ALLOWED = 1,  ///< after SINEW_BEHAVIOUR_GET_UP
  SINEW_GET_UP_NEVER = 2          ///< dead
};

/// How a character keeps its balance. Fields mean what those of BehaviourSettings do.
typedef struct sinew_behaviour_settings {
  uint32_t size;               ///< bytes of this struct, as the caller knows it
  int32_t most_steps;          ///< before it gives up
  double reaction;             ///< s
  double gravity;              ///< m/s2, the world's
  double help_torque;          ///< N m of a human
  double fallen_strength;      ///< of the muscles of who fell, 0 to 1
  double let_go;               ///< s
  sinew_get_up_policy get_up;  ///< when it gets up
  int32_t unused;              ///< 0
  double gather;               ///< s, from where it lies into the pose from which it rises
  double rise_force;           ///< N of a human, of help while it rises
  double rise_torque;          ///< N m of a human, likewise
  double walk_torque;          ///< N m of a human, of help while steps of a walk catch it
  double walk_force;           ///< N of a human, likewise; beside it what its animation asks of no floor
  double reach_strength;       ///< of its arms, which reach for the ground in a fall, 0 to 1; 0: they hang
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
  int32_t tries;                ///< to get up, since it fell
  int32_t clip;      ///< of sinew_character_use_get_ups: by which it gets up, or did last; -1: none
  int32_t mirrored;  ///< flag: by its mirror image
  int32_t unused2;   ///< 0
  double clip_time;  ///< s, of that clip
  double off;        ///< m, of the body from the pose that it should be in, while it gets up
} sinew_behaviour_report;

/// What a behaviour tells of.
typedef int32_t sinew_behaviour_event_kind;
/// Values of sinew_behaviour_event_kind.
enum sinew_behaviour_event_kind_values {
  SINEW_BEHAVIOUR_EVENT_FALLEN = 0,   ///< it falls, or lies again after it tried to rise
  SINEW_BEHAVIOUR_EVENT_RISING = 1,   ///< it has begun to get up
  SINEW_BEHAVIOUR_EVENT_STANDING = 2  ///< it stands
};

/// Why.
typedef int32_t sinew_behaviour_reason;
/// Values of sinew_behaviour_reason.
enum sinew_behaviour_reason_values {
  SINEW_BEHAVIOUR_REASON_NONE = 0,           ///< none is told
  SINEW_BEHAVIOUR_REASON_ASKED = 1,          ///< the host wanted it
  SINEW_BEHAVIOUR_REASON_BEYOND_REACH = 2,   ///< number: m that the capture point was beyond what steps reach
  SINEW_BEHAVIOUR_REASON_TILTED = 3,         ///< number: m, height of the root over the ground
  SINEW_BEHAVIOUR_REASON_NOT_GATHERED = 4,   ///< number: m off the pose from which it was to rise
  SINEW_BEHAVIOUR_REASON_LEFT_ITS_CLIP = 5,  ///< number: m off it
  SINEW_BEHAVIOUR_REASON_TOOK_TOO_LONG = 6   ///< number: s
};

/// What a host may want to hear of: sounds, scores, decisions.
typedef struct sinew_behaviour_event {
  sinew_behaviour_event_kind kind;  ///< what happened
  sinew_behaviour_reason reason;    ///< why
  double number;                    ///< what the reason says
} sinew_behaviour_event;

/// The library's defaults.
SINEW_API sinew_status sinew_behaviour_settings_init(sinew_behaviour_settings* settings);
/// Set-up; a second one takes the place of the first. What it remembers is no part of a world's snapshots:
/// see sinew_character_save_behaviour. `settings` may be null.
SINEW_API sinew_status sinew_character_add_behaviour(sinew_character character,
                                                     const sinew_behaviour_settings* settings);
/// Set-up: the clips by which it gets up, of those of an asset with the character's skeleton the ones named
/// get_up... and roll..., each also mirrored. The asset may be destroyed then. Refused where there is none.
SINEW_API sinew_status sinew_character_use_get_ups(sinew_character character, sinew_asset asset);
/// Before a step of h seconds, with what the animation wants at its end: changed where the behaviour acts,
/// and made the target. One jet for each joint, aligned to 16 bytes.
SINEW_API sinew_status sinew_character_balance(sinew_character character, sinew_jet* jets, int32_t count,
                                               float h);
/// Knocks it down, has who is down stand on its animation again, or lets it get up.
SINEW_API sinew_status sinew_character_order(sinew_character character, sinew_behaviour_order order);
/// What its behaviour does; refused without one.
SINEW_API sinew_status sinew_character_get_behaviour(sinew_character character, sinew_behaviour_report* out);
/// What happened in the last sinew_character_balance, four events at most. `count`: how many, also with
/// SINEW_TOO_SMALL.
SINEW_API sinew_status sinew_character_get_behaviour_events(sinew_character character,
                                                            sinew_behaviour_event* out, int32_t capacity,
                                                            int32_t* count);
/// Copies all that its behaviour remembers, to be restored when its world is to the same moment; sizes as of
/// sinew_world_save.
SINEW_API sinew_status sinew_character_save_behaviour(sinew_character character, void* out, size_t capacity,
                                                      size_t* size);
/// Refuses what sinew_character_save_behaviour of such a behaviour did not write, with nothing changed.
SINEW_API sinew_status sinew_character_restore_behaviour(sinew_character character, const void* bytes,
                                                         size_t size);

#endif
