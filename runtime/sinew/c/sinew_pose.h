/// @file
/// Jobs on poses in the caller's memory: blending, limbs that reach, looks, feet on the ground, left and
/// right exchanged. Part of sinew.h.
///
/// Between sinew_clip_sample or sinew_character_sample_graph and sinew_character_set_target. All keep
/// velocities and accelerations exact, where weights and targets come with theirs (0: they stay as they are),
/// so that what the muscles are asked for is what the pose does. Jets are one for each joint of the asset's
/// skeleton, or of its first joints, aligned to 16 bytes. Model space: the axes of the root's parent. Nothing
/// here allocates; assets are read by any number of threads.
#ifndef SINEW_C_SINEW_POSE_H
#define SINEW_C_SINEW_POSE_H

#ifndef SINEW_C_SINEW_H
#error "include sinew/c/sinew.h"
#endif

// ---- Poses ----

/// How a layer joins what is below it; w is its weight times its mask at a joint.
typedef int32_t sinew_blend_mode;
/// Values of sinew_blend_mode.
enum sinew_blend_mode_values {
  SINEW_BLEND_MIX = 0,       ///< weighted mean of all mixed layers, which come first
  SINEW_BLEND_OVERRIDE = 1,  ///< (1 - w) of what is below, w of the layer
  SINEW_BLEND_ADDITIVE = 2   ///< w of the layer, which is a difference (sinew_asset_subtract), on top
};

/// One of the motions that are blended.
typedef struct sinew_blend_layer {
  const sinew_jet* jets;      ///< as many as come out
  const float* mask;          ///< as many, 0 to 1; null: 1 everywhere
  sinew_blend_mode mode;      ///< how it joins what is below
  float weight;               ///< at least 0
  float weight_rate;          ///< 1/s
  float weight_acceleration;  ///< 1/s2
} sinew_blend_layer;

/// A limb whose end comes to a target: hip, knee and ankle, shoulder, elbow and wrist. Fields mean what those
/// of TwoBoneJob do.
typedef struct sinew_two_bone {
  uint32_t size;                  ///< bytes of this struct, as the caller knows it
  int32_t upper;                  ///< joint
  int32_t middle;                 ///< joint below it
  int32_t end;                    ///< joint below that; what is between them rides along
  double target[3];               ///< m, model space
  double target_velocity[3];      ///< m/s
  double target_acceleration[3];  ///< m/s2
  double pole[3];  ///< model direction in which the middle points; zero: as the animation bends it
  double
      hinge[3];   ///< axis about which the middle bends, in its own axes; zero: the upper turns the short way
  double weight;  ///< 0 to 1
  double weight_rate;          ///< 1/s
  double weight_acceleration;  ///< 1/s2
  double softness;             ///< part of the limb's length, before its end, in which it slows down
  int32_t keep_end;            ///< flag: the end keeps its orientation in model space
  int32_t unused;              ///< 0
} sinew_two_bone;

/// A joint an axis of which points to a target. Fields mean what those of AimJob do.
typedef struct sinew_aim {
  uint32_t size;                  ///< bytes of this struct, as the caller knows it
  int32_t joint;                  ///< that turns
  double target[3];               ///< m, model space; not at the joint's origin
  double target_velocity[3];      ///< m/s
  double target_acceleration[3];  ///< m/s2
  double axis[3];                 ///< unit, in the joint's axes
  double weight;                  ///< 0 to 1
  double weight_rate;             ///< 1/s
  double weight_acceleration;     ///< 1/s2
  double limit;                   ///< rad, of the turn away from the animation
} sinew_aim;

/// Spine, neck and head that look at a target. Fields mean what those of LookAtJob and LookSettings do.
typedef struct sinew_look {
  uint32_t size;                  ///< bytes of this struct, as the caller knows it
  int32_t changed;                ///< flag: another target than in the last call; `before` tells of that
  double target[3];               ///< m, model space
  double target_velocity[3];      ///< m/s
  double target_acceleration[3];  ///< m/s2
  double before[3];               ///< m, where the target up to now is at this instant
  double before_velocity[3];      ///< m/s
  double before_acceleration[3];  ///< m/s2
  double weight;                  ///< 0 to 1
  double weight_rate;             ///< 1/s
  double weight_acceleration;     ///< 1/s2
  double step;                    ///< s since the last call
  double yaw;                     ///< rad, to either side
  double pitch_down;              ///< rad
  double pitch_up;                ///< rad
  double softness;                ///< rad, before and beyond limits
  double behind;                  ///< rad, that a target behind has to pass for the side to change
  double fastest;                 ///< rad/s, of a turn to another target
  double least_time;              ///< s, of such a turn
  double half_life;               ///< s, by which all turns lag; 0: the aim is exact
} sinew_look;

/// What a look remembers from one call to the next, the caller's: zeros for a character that appears, a copy
/// for a snapshot.
typedef struct sinew_look_state {
  int32_t started;    ///< flag
  int32_t side;       ///< 1 left, -1 right
  float numbers[26];  ///< of the turns that fade
} sinew_look_state;

/// What a ray met of the ground.
typedef struct sinew_ground_hit {
  float point[3];   ///< m: of sinew_foot in model space, of sinew_ground_below in the world
  float normal[3];  ///< unit, upwards, in the same axes
  int32_t body;     ///< of sinew_asset_place_feet or sinew_character_set_grounds; -1: it does not move
} sinew_ground_hit;

/// What of a foot stays on the ground.
typedef int32_t sinew_foot_hold;
/// Values of sinew_foot_hold.
enum sinew_foot_hold_values {
  SINEW_HOLD_FREE = 0,  ///< nothing: it goes as animated
  SINEW_HOLD_TOE = 1,   ///< the toe stays, the heel may rise
  SINEW_HOLD_HEEL = 2   ///< the heel stays, the toe comes down
};

/// A leg, and where the sole of its foot is.
typedef struct sinew_leg_info {
  uint32_t size;   ///< bytes of this struct, as the caller knows it
  int32_t upper;   ///< joint: thigh
  int32_t middle;  ///< joint: shin
  int32_t foot;    ///< joint: foot
  float toe[3];    ///< m, in the foot joint's axes: the sole under the ball
  float heel[3];   ///< m, in the foot joint's axes: the sole under the heel
} sinew_leg_info;

/// What is known of a foot in a frame. Cast rays down from above its toe, from above its heel, and from above
/// where the toe will be within 0.3 s: a foot has to rise before a stair and not in it. The highest hit under
/// the foot counts. Without hits it keeps the ground that it had.
typedef struct sinew_foot {
  const sinew_ground_hit* under;  ///< below the foot as it is; null: none
  const sinew_ground_hit* ahead;  ///< on its way; null: none
  int32_t under_count;            ///< hits
  int32_t ahead_count;            ///< hits
  float contact;                  ///< 0 to 1, that it rests: weights of the clips that say so, summed
  int32_t unused;                 ///< 0
} sinew_foot;

/// Feet on uneven and on moving ground. Fields mean what those of FootPlacementJob and FootSettings do.
typedef struct sinew_feet {
  uint32_t size;              ///< bytes of this struct, as the caller knows it
  int32_t unused;             ///< 0
  double level;               ///< m: height of the ground that the animation walks on
  double level_rate;          ///< m/s
  double level_acceleration;  ///< m/s2
  double step;                ///< s since the last call that was not refused
  double lock_at;             ///< contact from which a foot locks
  double release_at;          ///< contact below which it leaves, at most lock_at
  double lock_time;           ///< s, until a foot that comes down rests
  double release_time;        ///< s, until a foot that leaves is back on the animation
  double half_life;           ///< s, of steps of the ground under a foot that is free
  double farthest;            ///< m, from the animation on the ground, where a lock breaks
  double steepest;            ///< rad: steeper ground is taken for a wall, and as level where it was met
  double reach;               ///< of a leg's length, to which the pelvis comes down
  double follow;              ///< part of the feet's mean shift sideways that the pelvis takes
  double rise;                ///< s, half of the pelvis' way up
  double deepest;             ///< m, that the pelvis comes down at most
} sinew_feet;

/// What a foot remembers from one call to the next.
typedef struct sinew_foot_state {
  int32_t started;       ///< flag: it has found a ground; until then nothing else counts
  sinew_foot_hold hold;  ///< what of it stays; it rests on the ground once `elapsed` is `duration`
  int32_t ground;        ///< body that it is on, which has to be given as long as it is; -1: none moves
  float elapsed;         ///< s since `hold` changed
  float duration;        ///< s that it takes to come to rest, or back to the animation
  float numbers[30];     ///< of the plane below it, of the place where it stays, and of what fades
} sinew_foot_state;

/// What the feet of a character remember, the caller's: zeros for a character that appears, a copy for a
/// snapshot.
typedef struct sinew_feet_state {
  sinew_foot_state feet[2];  ///< left, right
  float drop[3];             ///< by which the pelvis still is lowered: m, m/s, m/s2
} sinew_feet_state;

/// A weight that goes from 0 to 1 within `duration` (s), `elapsed` (s) after it began, with its rate and
/// acceleration: [3], as layers take them. C2.
SINEW_API sinew_status sinew_ease(float elapsed, float duration, float out[3]);
/// Blends at most 16 layers into `jets`, which may be one of theirs. Where a joint has no mixed layer it
/// rests. sinew_last_index(): the layer at fault.
SINEW_API sinew_status sinew_asset_blend(sinew_asset asset, const sinew_blend_layer* layers,
                                         int32_t layer_count, sinew_jet* jets, int32_t count);
/// Makes of `jets` what an additive layer is: the difference from the pose of `reference`, as many, or from
/// rest where that is none.
SINEW_API sinew_status sinew_asset_subtract(sinew_asset asset, const sinew_jet* reference,
                                            int32_t reference_count, sinew_jet* jets, int32_t count);
/// Makes of `jets` an additive layer in model space: for every joint the turn from `reference`, as many, to
/// `jets`, in the axes of the root's parent; translations are left out. The pose at rest, to be such a
/// reference, is what sinew_asset_blend makes of no layers. `scratch`: memory of two jets for each of `jets`,
/// whatever is in it.
SINEW_API sinew_status sinew_asset_subtract_in_model(sinew_asset asset, const sinew_jet* reference,
                                                     int32_t reference_count, sinew_jet* jets, int32_t count,
                                                     sinew_jet* scratch, int32_t scratch_count);
/// Adds such a layer, whose mode is SINEW_BLEND_ADDITIVE, to `jets`: an aim stays level while the body below
/// leans, where sinew_asset_blend turns about the joints' own axes. Joints that the layer does not touch, and
/// whose parent it does not, keep their bits.
SINEW_API sinew_status sinew_asset_add_in_model(sinew_asset asset, const sinew_blend_layer* layer,
                                                sinew_jet* jets, int32_t count, sinew_jet* scratch,
                                                int32_t scratch_count);
/// Begins a transition by inertia: `now` is what the character does at this instant, whatever makes it do so
/// (another transition, too), `next` what the new motion does. What they differ by is written into
/// state[capacity], the caller's, a copy for a snapshot; `count`: how many numbers it has, also with
/// SINEW_TOO_SMALL. duration: s until nothing of it is left, 0 to 1000.
SINEW_API sinew_status sinew_asset_begin_transition(sinew_asset asset, const sinew_jet* now,
                                                    int32_t now_count, const sinew_jet* next,
                                                    int32_t next_count, float duration, float* state,
                                                    int32_t capacity, int32_t* count);
/// Moves on by `step` s, 0 in the frame of the switch, and adds what is left of the difference to `jets`, the
/// new motion at that instant: C2 at both ends. Once nothing is left it leaves them.
SINEW_API sinew_status sinew_asset_play_transition(sinew_asset asset, float* state, int32_t state_count,
                                                   float step, sinew_jet* jets, int32_t count);
/// The joint on the other side; itself in the middle, -1 where there is none. Left and right are found by
/// names, roles and places when an asset is read; refused with what was in the way of that.
SINEW_API sinew_status sinew_asset_get_partner(sinew_asset asset, int32_t joint, int32_t* out);
/// Exchanges left and right of jets of all joints. Refused as sinew_asset_get_partner.
SINEW_API sinew_status sinew_asset_mirror(sinew_asset asset, sinew_jet* jets, int32_t count);
/// The library's defaults; joints are none.
SINEW_API sinew_status sinew_two_bone_init(sinew_two_bone* settings);
/// Turns two joints of a limb so that its end comes to the target.
SINEW_API sinew_status sinew_asset_two_bone(sinew_asset asset, const sinew_two_bone* settings,
                                            sinew_jet* jets, int32_t count);
/// The library's defaults; the joint is none.
SINEW_API sinew_status sinew_aim_init(sinew_aim* settings);
/// Turns one joint so that its axis points to the target. Refused where that is at the joint or straight
/// behind.
SINEW_API sinew_status sinew_asset_aim(sinew_asset asset, const sinew_aim* settings, sinew_jet* jets,
                                       int32_t count);
/// The library's defaults.
SINEW_API sinew_status sinew_look_init(sinew_look* settings);
/// Turns spine, neck and head, by their roles, to look at the target within limits. Refused of a skeleton
/// without a head, and where the target is in the eyes.
SINEW_API sinew_status sinew_asset_look(sinew_asset asset, const sinew_look* settings,
                                        sinew_look_state* state, sinew_jet* jets, int32_t count);
/// The leg of SINEW_ROLE_FOOT_L or SINEW_ROLE_FOOT_R, by the roles of its joints, and its sole, by the
/// colliders of foot and toes at rest. Refused where one of the two feet has no thigh, shin or toes.
SINEW_API sinew_status sinew_asset_get_leg(sinew_asset asset, sinew_role foot, sinew_leg_info* out);
/// The library's defaults.
SINEW_API sinew_status sinew_feet_init(sinew_feet* settings);
/// Puts both feet, left and right, on the ground, turns them as it leans, locks them while they bear, and
/// lowers the pelvis until they reach it. The last job before the target is set; model space has to be level.
/// `grounds`: the bodies that hits tell of, at most 8, body to model space and how they move; may be null
/// with a count of 0. sinew_last_index(): 0 left, 1 right. Refused as sinew_asset_get_leg; also, with
/// SINEW_OUT_OF_RANGE, where a leg finds no plane to bend in: then neither leg is placed.
SINEW_API sinew_status sinew_asset_place_feet(sinew_asset asset, const sinew_feet* settings,
                                              const sinew_foot feet[2], const sinew_jet* grounds,
                                              int32_t ground_count, sinew_feet_state* state, sinew_jet* jets,
                                              int32_t count);
/// Moves a pose by `place`: of `jets` the root's, the first one, is turned and shifted, with its motion, into
/// the axes that `place` leads to. What a clip shows at the origin is shown there then.
SINEW_API sinew_status sinew_place_jets(const sinew_pose* place, sinew_jet* jets, int32_t count);
/// root = travel * body, both with exact derivatives: heading about Z and position on the ground, which a
/// game's own controller may move, and sway, bob and lean, which stay. Refused where the root is upside down
/// and has no heading.
SINEW_API sinew_status sinew_split_root(const sinew_jet* root, sinew_jet* travel, sinew_jet* body);
/// Motion in model space of a frame that is fixed to a joint: a palm, a holster. `offset`: frame to joint;
/// null: the joint's own. From jets of all joints above it, after everything that changes them. What is let
/// go there begins with that velocity (m/s, model axes); its turn is the angular velocity in the frame's
/// axes.
SINEW_API sinew_status sinew_asset_get_socket(sinew_asset asset, const sinew_jet* jets, int32_t jet_count,
                                              int32_t joint, const sinew_transform* offset, sinew_jet* out);
/// Where joints are in model space: out[capacity] of the first joints. `count`: of `jets`, also with
/// SINEW_TOO_SMALL.
SINEW_API sinew_status sinew_asset_get_model(sinew_asset asset, const sinew_jet* jets, int32_t jet_count,
                                             sinew_transform* out, int32_t capacity, int32_t* count);

#endif
