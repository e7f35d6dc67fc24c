/// @file
/// Assets: a skeleton and its clips, as `sinew convert` writes them. Part of sinew.h.
#ifndef SINEW_C_SINEW_ASSET_H
#define SINEW_C_SINEW_ASSET_H

#ifndef SINEW_C_SINEW_H
#error "include sinew/c/sinew.h"
#endif

/// How a joint may move relative to its rest frame.
typedef int32_t sinew_joint_type;
/// Values of sinew_joint_type.
enum sinew_joint_type_values {
  SINEW_JOINT_FIXED = 0,       ///< no degree of freedom
  SINEW_JOINT_REVOLUTE = 1,    ///< 1, about an axis
  SINEW_JOINT_PRISMATIC = 2,   ///< 1, along an axis
  SINEW_JOINT_UNIVERSAL = 3,   ///< 2, about one axis, then another
  SINEW_JOINT_BALL = 4,        ///< 3, rotation vector in the child's axes
  SINEW_JOINT_PLANAR = 5,      ///< 3, translation along two axes, then rotation about their normal
  SINEW_JOINT_FREE = 6,        ///< 6, translation, then rotation vector, in the parent's axes
  SINEW_JOINT_TRANSLATION = 7  ///< 3, in the parent's axes: a particle
};

/// Which part of a body a joint is.
typedef int32_t sinew_role;
/// Values of sinew_role.
enum sinew_role_values {
  SINEW_ROLE_NONE = 0,         ///< none of these
  SINEW_ROLE_PELVIS = 1,       ///< root of the body
  SINEW_ROLE_SPINE = 2,        ///< between pelvis and chest
  SINEW_ROLE_CHEST = 3,        ///< carries neck and clavicles
  SINEW_ROLE_NECK = 4,         ///< carries the head
  SINEW_ROLE_HEAD = 5,         ///< above the neck
  SINEW_ROLE_CLAVICLE_L = 6,   ///< shoulder blade, left
  SINEW_ROLE_CLAVICLE_R = 7,   ///< shoulder blade, right
  SINEW_ROLE_UPPER_ARM_L = 8,  ///< shoulder to elbow, left
  SINEW_ROLE_UPPER_ARM_R = 9,  ///< shoulder to elbow, right
  SINEW_ROLE_FOREARM_L = 10,   ///< elbow to wrist, left
  SINEW_ROLE_FOREARM_R = 11,   ///< elbow to wrist, right
  SINEW_ROLE_HAND_L = 12,      ///< below the wrist, left
  SINEW_ROLE_HAND_R = 13,      ///< below the wrist, right
  SINEW_ROLE_THIGH_L = 14,     ///< hip to knee, left
  SINEW_ROLE_THIGH_R = 15,     ///< hip to knee, right
  SINEW_ROLE_SHIN_L = 16,      ///< knee to ankle, left
  SINEW_ROLE_SHIN_R = 17,      ///< knee to ankle, right
  SINEW_ROLE_FOOT_L = 18,      ///< below the ankle, left
  SINEW_ROLE_FOOT_R = 19,      ///< below the ankle, right
  SINEW_ROLE_TOES_L = 20,      ///< front of the foot, left
  SINEW_ROLE_TOES_R = 21       ///< front of the foot, right
};

/// What an asset holds.
typedef struct sinew_asset_info {
  uint32_t size;    ///< bytes of this struct, as the caller knows it
  int32_t joints;   ///< parents first
  int32_t bodies;   ///< the first so many joints are simulated, the others ride along
  int32_t dofs;     ///< degrees of freedom of the bodies
  int32_t clips;    ///< of the asset; may be 0
  int32_t muscles;  ///< besides the one of every degree of freedom
  double mass;      ///< kg
  int32_t events;   ///< names of what happens in clips
  int32_t curves;   ///< numbers that clips move
  int32_t masks;    ///< weights by joint, under a name
  int32_t unused;   ///< 0
} sinew_asset_info;

/// One joint of a skeleton.
typedef struct sinew_joint_info {
  uint32_t size;          ///< bytes of this struct, as the caller knows it
  int32_t parent;         ///< -1 of the root
  sinew_joint_type type;  ///< how it may move
  sinew_role role;        ///< which part of a body it is
  const char* name;       ///< while the asset lives
  int32_t first_dof;      ///< into what is given by degree of freedom; -1 of a joint that rides along
  int32_t dofs;           ///< degrees of freedom
  double mass;            ///< kg
} sinew_joint_info;

/// One clip of an asset.
typedef struct sinew_clip_info {
  uint32_t size;       ///< bytes of this struct, as the caller knows it
  int32_t loops;       ///< flag
  const char* name;    ///< while the asset lives
  double duration;     ///< s
  float root_step[3];  ///< m, that one loop adds to the root's translation
} sinew_clip_info;

/// One muscle of a skeleton.
typedef struct sinew_muscle_info {
  uint32_t size;      ///< bytes of this struct, as the caller knows it
  int32_t joint;      ///< that it pulls at
  const char* name;   ///< while the asset lives
  const char* group;  ///< "": none
} sinew_muscle_info;

/// What happens in clips, by name.
typedef struct sinew_event_info {
  uint32_t size;     ///< bytes of this struct, as the caller knows it
  uint32_t number;   ///< of the name: sinew_graph_event::name
  const char* name;  ///< while the asset lives
} sinew_event_info;

/// A number that clips move.
typedef struct sinew_curve_info {
  uint32_t size;     ///< bytes of this struct, as the caller knows it
  float rest;        ///< where clips say nothing
  const char* name;  ///< while the asset lives
} sinew_curve_info;

/// Set-up: reads a file, checked throughout.
SINEW_API sinew_status sinew_asset_load(const char* path, sinew_asset* out);
/// The same from memory, which is copied.
SINEW_API sinew_status sinew_asset_read(const void* bytes, size_t size, sinew_asset* out);
/// Worlds and graphs keep what they need of it; only clips cannot be played any more.
SINEW_API sinew_status sinew_asset_destroy(sinew_asset asset);
/// Sizes and mass.
SINEW_API sinew_status sinew_asset_get_info(sinew_asset asset, sinew_asset_info* out);
/// One joint, by index.
SINEW_API sinew_status sinew_asset_get_joint(sinew_asset asset, int32_t joint, sinew_joint_info* out);
/// One clip, by index.
SINEW_API sinew_status sinew_asset_get_clip(sinew_asset asset, int32_t clip, sinew_clip_info* out);
/// One muscle, by index.
SINEW_API sinew_status sinew_asset_get_muscle(sinew_asset asset, int32_t muscle, sinew_muscle_info* out);
/// Index of a name; SINEW_NOT_FOUND. O(joints).
SINEW_API sinew_status sinew_asset_find_joint(sinew_asset asset, const char* name, int32_t* out);
/// The first joint of that role.
SINEW_API sinew_status sinew_asset_find_role(sinew_asset asset, sinew_role role, int32_t* out);
/// Index of a name; SINEW_NOT_FOUND. O(clips).
SINEW_API sinew_status sinew_asset_find_clip(sinew_asset asset, const char* name, int32_t* out);
/// Index of a name; SINEW_NOT_FOUND. O(muscles).
SINEW_API sinew_status sinew_asset_find_muscle(sinew_asset asset, const char* name, int32_t* out);
/// One event's name, by index.
SINEW_API sinew_status sinew_asset_get_event(sinew_asset asset, int32_t event, sinew_event_info* out);
/// Number of an event's name; SINEW_NOT_FOUND. O(events).
SINEW_API sinew_status sinew_asset_find_event(sinew_asset asset, const char* name, uint32_t* out);
/// One curve, by index.
SINEW_API sinew_status sinew_asset_get_curve(sinew_asset asset, int32_t curve, sinew_curve_info* out);
/// Index of a name; SINEW_NOT_FOUND. O(curves).
SINEW_API sinew_status sinew_asset_find_curve(sinew_asset asset, const char* name, int32_t* out);
/// Index of a name; SINEW_NOT_FOUND. O(masks).
SINEW_API sinew_status sinew_asset_find_mask(sinew_asset asset, const char* name, int32_t* out);
/// How far a mask reaches each joint, 0 to 1, for sinew_blend_layer::mask. `count`: of the skeleton's joints,
/// also with SINEW_TOO_SMALL.
SINEW_API sinew_status sinew_asset_get_mask(sinew_asset asset, int32_t mask, float* out, int32_t capacity,
                                            int32_t* count);
/// What a clip shows at a time (s), for whoever blends by himself. `rate`: how fast clip time goes, 1 at
/// normal speed; `rate_change`, 1/s: exact velocities and accelerations while time is warped. Loops wrap,
/// other clips hold their ends. `jets`: [count], aligned to 16 bytes; fewer than the skeleton's joints: only
/// those. Allocates nothing.
SINEW_API sinew_status sinew_clip_sample(sinew_asset asset, int32_t clip, double time, double rate,
                                         double rate_change, sinew_jet* jets, int32_t count);
/// Whether a joint rests on the ground at a time (s) of a clip, by the clip's contact windows: sets the flag
/// `out`. Loops wrap. O(contact windows).
SINEW_API sinew_status sinew_clip_in_contact(sinew_asset asset, int32_t clip, double time, int32_t joint,
                                             int32_t* out);

#endif
