/// @file
/// Characters: what they are to do, and what they do. Part of sinew.h.
#ifndef SINEW_C_SINEW_CHARACTER_H
#define SINEW_C_SINEW_CHARACTER_H

#ifndef SINEW_C_SINEW_H
#error "include sinew/c/sinew.h"
#endif

/// What leads a root.
typedef int32_t sinew_root_drive;
/// Values of sinew_root_drive.
enum sinew_root_drive_values {
  SINEW_ROOT_KINEMATIC = 0,  ///< follows the animation whatever it takes
  SINEW_ROOT_ASSISTED = 1,   ///< up to root_force and root_torque
  SINEW_ROOT_FREE = 2,       ///< only contacts hold it
  SINEW_ROOT_GROUNDED = 3    ///< as long as the ground can hold it so
};

/// How much is computed for a character.
typedef int32_t sinew_level;
/// Values of sinew_level.
enum sinew_level_values {
  SINEW_LEVEL_ASLEEP = 0,  ///< limp and at rest: nothing is computed
  SINEW_LEVEL_PLAYBACK =
      1,  ///< on the clip, or on a smooth way back to it; what its muscles can do is not asked
  SINEW_LEVEL_CHECKED = 2,  ///< on the clip, which its muscles can follow
  SINEW_LEVEL_PARTIAL = 3,  ///< some degrees of freedom are solved for
  SINEW_LEVEL_FULL = 4,     ///< all are
  SINEW_LEVEL_SUBSTEPS = 5  ///< all or some are, in parts of a step
};

/// How stiffly muscles stay with the animation below their limits.
typedef int32_t sinew_tone;
/// Values of sinew_tone.
enum sinew_tone_values {
  SINEW_TONE_RIGID = 0,    ///< as stiffly as the limit allows
  SINEW_TONE_RELAXED = 1,  ///< at ease: rings for a while
  SINEW_TONE_ALERT = 2,    ///< stands or walks attentively
  SINEW_TONE_BRACED = 3    ///< expects the blow
};

/// Whether limbs meet each other.
typedef int32_t sinew_self_collision;
/// Values of sinew_self_collision.
enum sinew_self_collision_values {
  SINEW_SELF_COLLISION_AS_CREATED = 0,  ///< as the settings say
  SINEW_SELF_COLLISION_ON = 1,
  SINEW_SELF_COLLISION_OFF = 2
};

/// What a character begins with. Fields mean what those of CharacterSettings do.
typedef struct sinew_character_settings {
  uint32_t size;           ///< bytes of this struct, as the caller knows it
  sinew_root_drive root;   ///< what leads its root
  double root_force;       ///< N, assisted
  double root_torque;      ///< N m, assisted
  double help_force;       ///< N of a human, grounded
  double help_torque;      ///< N m of a human, grounded
  double strength;         ///< scales every muscle; 0 = ragdoll, infinity = pure playback
  int32_t ground_contact;  ///< flag
  int32_t self_collision;  ///< flag
  uint32_t layers;         ///< bits that queries and `meets` choose by
  sinew_level most;        ///< at most this
  double significance;     ///< the budget takes from the least significant first
  int32_t check_every;     ///< steps from one check of the muscles to the next, at least 1
  int32_t bake;            ///< flag: hands, feet and toes dynamic now and then
  sinew_tone tone;         ///< of all muscles
  int32_t unused;          ///< 0
  uint32_t meets;          ///< touches who has one of these bits in its layers, and would touch it, too
  int32_t unused2;         ///< 0
} sinew_character_settings;

/// What the last step did with a character or prop: CharacterReport.
typedef struct sinew_character_report {
  uint32_t size;               ///< bytes of this struct, as the caller knows it
  sinew_level level;           ///< what it needed lately, not only in this step
  int32_t dofs;                ///< degrees of freedom of the character
  int32_t unknown_dofs;        ///< of these, solved for; 0 = pure playback
  int32_t baked;               ///< joints that `bake` left out of the (last) solve
  int32_t unbaked;             ///< that it had to solve for all the same
  int32_t outer_passes;        ///< of all solves
  int32_t factorisations;      ///< of all solves
  int32_t simplified_steps;    ///< steps of simplified Newton, with the matrix of the pass before
  int32_t corrections;         ///< second-order corrections that saved a full step
  int32_t plain_passes;        ///< passes without the geometric terms
  int32_t contacts;            ///< active contact points
  int32_t left_out;            ///< candidates for contacts that there was no memory for: the furthest
  int32_t substeps;            ///< parts that the step was solved in; 0 = played
  int32_t splits;              ///< of the substeps, halvings because a solve did not converge
  int32_t restarts;            ///< of the substeps, solved again: the first result was too deep
  int32_t damped;              ///< of the substeps, slowed because energy had come from nowhere
  int32_t frozen;              ///< trees that were stopped where they stood: no pose could be found
  int32_t crowded;             ///< flag
  int32_t converged;           ///< flag
  int32_t carried;             ///< flag
  int32_t on_animation;        ///< flag: every joint is exactly where the clip wants it; 0 of a prop
  double kinetic_energy;       ///< J
  double potential_energy;     ///< J
  double elastic_energy;       ///< J
  double momentum[3];          ///< kg m/s
  double angular_momentum[3];  ///< kg m2/s, about the centre of mass
  double penetration;          ///< m
  double help_force;           ///< N
  double help_torque;          ///< N m
  double estimated_error;      ///< m
  double position[3];          ///< m, of the root's origin
  double ground_force;         ///< N, up: of what bears it; who is only played: where it moves
  double ground_place[3];      ///< m, world: where it presses
  double ground_velocity[3];   ///< m/s, of what is there
  double ground_turn_rate;     ///< rad/s, about the vertical
} sinew_character_report;

/// How a character stands, and what its muscles bear.
typedef struct sinew_physics {
  uint32_t size;        ///< bytes of this struct, as the caller knows it
  float tilt;           ///< rad, 0 to pi: of the root from upright
  float face_up;        ///< how far its front points up: 1 on the back, -1 on the belly
  float height;         ///< of the root over the ground, a part of that at rest
  float load;           ///< the greatest of its muscles; 1: at the limit
  float off_animation;  ///< m: root mean square, over all mass, of how far it is from its animation
  float contacts;       ///< contact points that press; 0 where the animation was only played
  float contact_force;  ///< of these, normal, as parts of its weight on Earth
} sinew_physics;

/// A clip that a character follows: what it shows at `time` (as sinew_clip_sample) is wanted at the end of
/// the next step.
typedef struct sinew_play {
  sinew_character character;  ///< who follows
  sinew_asset asset;          ///< whose clip
  int32_t clip;               ///< index in the asset
  int32_t unused;             ///< 0
  double time;                ///< s
  double rate;                ///< 1 at normal speed
  double rate_change;         ///< 1/s
} sinew_play;

/// What a view shows, and of which type its elements are.
typedef int32_t sinew_view_kind;
/// Values of sinew_view_kind.
enum sinew_view_kind_values {
  SINEW_VIEW_MODEL = 0,   ///< sinew_transform by joint: joint to world
  SINEW_VIEW_LOCAL = 1,   ///< sinew_transform by joint: joint to parent
  SINEW_VIEW_TORQUE = 2,  ///< float by degree of freedom, N m or N
  SINEW_VIEW_LOAD = 3,    ///< float by degree of freedom: torque / limit
  SINEW_VIEW_LIMIT = 4,   ///< float by degree of freedom, N m or N
  SINEW_VIEW_UNKNOWN = 5  ///< uint8_t by degree of freedom: 1 where the last step solved for it
};

/// The library's defaults.
SINEW_API sinew_status sinew_character_settings_init(sinew_character_settings* settings);
/// Set-up: of the asset's skeleton, at its rest pose until a target is set and sinew_character_reset called.
/// `settings` may be null.
SINEW_API sinew_status sinew_world_add_character(sinew_world world, sinew_asset asset,
                                                 const sinew_character_settings* settings,
                                                 sinew_character* out);
/// The handle of an index, as contacts and queries tell it.
SINEW_API sinew_status sinew_world_get_character(sinew_world world, int32_t index, sinew_character* out);
/// Samples clips and makes them targets, for any number of characters in one call, also of several worlds.
/// Stops at the first that is refused: sinew_last_index() says which. Allocates nothing.
SINEW_API sinew_status sinew_play_clips(const sinew_play* plays, int32_t count);
/// The same with jets of the host's own: one for each joint, aligned to 16 bytes; copied.
SINEW_API sinew_status sinew_character_set_target(sinew_character character, const sinew_jet* jets,
                                                  int32_t count);
/// Puts it on its target at once, with the target's velocity; forgets its history.
SINEW_API sinew_status sinew_character_reset(sinew_character character);
/// Of all muscles, at least 0.
SINEW_API sinew_status sinew_character_set_strength(sinew_character character, float strength);
/// As it was set last, of all muscles.
SINEW_API sinew_status sinew_character_get_strength(sinew_character character, float* out);
/// Of the subtree below a joint, of one muscle, of all muscles of a group: all multiply.
SINEW_API sinew_status sinew_character_set_joint_strength(sinew_character character, int32_t joint,
                                                          float strength);
/// The same of one muscle, by its index in the asset.
SINEW_API sinew_status sinew_character_set_muscle_strength(sinew_character character, int32_t muscle,
                                                           float strength);
/// The same of all muscles of a group; SINEW_NOT_FOUND if there are none.
SINEW_API sinew_status sinew_character_set_group_strength(sinew_character character, const char* group,
                                                          float strength);
/// How much of their strength muscles are given at the moment, [count] one for each joint of the skeleton, 0
/// to 1: multiplies all strengths. For what moves a body beside the host, as behaviours do.
SINEW_API sinew_status sinew_character_set_activation(sinew_character character, const float* activation,
                                                      int32_t count);
/// Whether limbs meet each other from now on. Behaviours ask for it of who fell, and not of who gets up.
SINEW_API sinew_status sinew_character_set_self_collision(sinew_character character,
                                                          sinew_self_collision collision);
/// Tone of all muscles. The first that is not rigid allocates; so with the others.
SINEW_API sinew_status sinew_character_set_tone(sinew_character character, sinew_tone tone);
/// The same of the muscles of a joint and of those below it.
SINEW_API sinew_status sinew_character_set_joint_tone(sinew_character character, int32_t joint,
                                                      sinew_tone tone);
/// The same of the degrees of freedom that a group of muscles works on; SINEW_NOT_FOUND if there are none.
SINEW_API sinew_status sinew_character_set_group_tone(sinew_character character, const char* group,
                                                      sinew_tone tone);
/// Of one joint alone, all of its degrees of freedom: above 0 (N m/rad, infinite: rigid), and a damping
/// ratio.
SINEW_API sinew_status sinew_character_set_joint_stiffness(sinew_character character, int32_t joint,
                                                           double stiffness, double damping_ratio);
/// What was asked for of a degree of freedom: N m/rad (infinite: rigid), and the damping ratio.
SINEW_API sinew_status sinew_character_get_stiffness(sinew_character character, int32_t dof,
                                                     double* stiffness, double* damping_ratio);
/// N m, what a muscle gives of its joint's torque.
SINEW_API sinew_status sinew_character_get_muscle_torque(sinew_character character, int32_t muscle,
                                                         float* out);
/// From the next step on; the other settings of the root stay.
SINEW_API sinew_status sinew_character_set_root_drive(sinew_character character, sinew_root_drive drive);
/// What may hold a grounded root besides the ground, N and N m; negative: as in its settings.
SINEW_API sinew_status sinew_character_set_help(sinew_character character, double force, double torque);
/// significance, most, check_every and bake of its settings.
SINEW_API sinew_status sinew_character_set_detail(sinew_character character, double significance,
                                                  sinew_level most, int32_t check_every, int32_t bake);
/// As they were set last.
SINEW_API sinew_status sinew_character_get_detail(sinew_character character, double* significance,
                                                  sinew_level* most, int32_t* check_every, int32_t* bake);
/// Where a grounded character follows its animation since something moved it: [3] x, y (m), yaw (rad).
SINEW_API sinew_status sinew_character_get_displacement(sinew_character character, double out[3]);
/// m, by which that is higher.
SINEW_API sinew_status sinew_character_get_rise(sinew_character character, double* out);
/// The host has moved the character's place itself: targets are given there from now on.
SINEW_API sinew_status sinew_character_take_displacement(sinew_character character);
/// Puts its animation elsewhere: by [3] x, y (m), yaw (rad), in the world.
SINEW_API sinew_status sinew_character_displace(sinew_character character, const double further[3]);
/// Puts its animation higher, by m.
SINEW_API sinew_status sinew_character_raise(sinew_character character, double further);
/// Before a step, of an animation that is taken along in it by what it stands on: its targets are put
/// elsewhere as by sinew_character_displace and sinew_character_raise together, by [4] x, y (m), yaw (rad), z
/// (m), and the next one has the root's speed of that way. The body is where it is wanted then.
SINEW_API sinew_status sinew_character_ride(sinew_character character, const double further[4]);
/// A grounded root that moves nearly as its animation wants it (6 cm, 6 degrees, 0.12 m/s or a tenth of
/// the animation's speed, and 0.6 rad/s of a human) is led back onto it from the end of the next step on, as
/// fast as it is. What the ground cannot give then is help that no report counts.
SINEW_API sinew_status sinew_character_come_back(sinew_character character);
/// In the next step a grounded root that is free may be given, besides its help, as much as its target asks
/// of no floor at all, as a run does that pushes off before its feet are down. Metered as help.
SINEW_API sinew_status sinew_character_give_hand(sinew_character character);
/// Its target of the next step is somebody's plan, who knows what is around: of that it may lie `most` m in
/// things, where of a clip 3 cm of a human may in what stands, and 1 cm in what moves.
SINEW_API sinew_status sinew_character_keep_out(sinew_character character, double most);
/// A hit: impulse [3] (N s, world) at a world point [3] on a joint's body, at the beginning of the next step.
SINEW_API sinew_status sinew_character_apply_impulse(sinew_character character, int32_t joint,
                                                     const double point[3], const double impulse[3]);
/// A load: force [3] (N, world) during the next step.
SINEW_API sinew_status sinew_character_apply_force(sinew_character character, int32_t joint,
                                                   const double point[3], const double force[3]);
/// Out of the world, where it costs nothing and touches nobody; or back, onto its target, as by reset.
SINEW_API sinew_status sinew_character_park(sinew_character character, int32_t parked);
/// Flag: it is out of the world.
SINEW_API sinew_status sinew_character_get_parked(sinew_character character, int32_t* out);
/// What the last step did with it. Energies and momenta of who was only played are worked out here:
/// O(bodies).
SINEW_API sinew_status sinew_character_get_report(sinew_character character, sinew_character_report* out);
/// The ground_… of its report alone, for nothing: the force (N, up; 0: nothing bears it), where it presses
/// [3] (m, world), and how that moves [3] (m/s) and turns about the vertical (rad/s).
SINEW_API sinew_status sinew_character_get_ground(sinew_character character, double* force, double place[3],
                                                  double velocity[3], double* turn_rate);
/// Where to read without a copy. The memory stays while the world lives; what is in it is up to date until
/// the world's next step, reset or restore: ask again then.
SINEW_API sinew_status sinew_character_get_view(sinew_character character, sinew_view_kind kind,
                                                sinew_view* out);
/// Of the last step; of what a snapshot has put back, contacts and loads follow with the next one.
SINEW_API sinew_status sinew_character_get_physics(sinew_character character, sinew_physics* out);
/// How the body moves at the end of the last step, as a clip would tell it: one jet for each joint, aligned
/// to 16 bytes. What an impact did within the step is in the rates alone. Joints without a body are at rest.
SINEW_API sinew_status sinew_character_get_motion(sinew_character character, sinew_jet* jets, int32_t count);
/// By how much the muscles could turn each joint faster than they do now, rad/s2, one number for each joint:
/// (limit - torque) / inertia, the least of its degrees of freedom; 1e6 where no muscle is. What a transition
/// may add, for hosts that time theirs by it; graphs with a `budget` do.
SINEW_API sinew_status sinew_character_get_spare_acceleration(sinew_character character, float* out,
                                                              int32_t count);

#endif
