/// @file
/// Sinew for every language: characters that follow their clips and are simulated where their muscles do not
/// suffice.
///
///     sinew_asset asset;
///     sinew_world world;
///     sinew_character hero;
///     sinew_asset_load("hero.sinew", &asset);
///     sinew_world_create(NULL, &world);
///     sinew_world_add_character(world, asset, NULL, &hero);
///     for (double t = 0;; t += 1 / 60.0) {
///       sinew_play play = {.character = hero, .asset = asset, .clip = 0, .time = t, .rate = 1};
///       sinew_play_clips(&play, 1);
///       sinew_world_step(world, 1 / 60.f);
///       sinew_view model;
///       sinew_character_get_view(hero, SINEW_VIEW_MODEL, &model);  // model.count transforms, to the world
///     }
///
/// Space is right-handed, Z up, X forward, Y left; metres, kilograms, seconds, radians. Quaternions are x y z
/// w. World positions that come in and go out in double are held in double.
///
/// Errors. Functions return a status; where it is not SINEW_OK nothing has moved (sinew_play_clips says how
/// far it came), and outputs are as they were unless said otherwise. sinew_last_reason() and
/// sinew_last_index() of the same thread say why. No exception crosses this interface, in neither direction:
/// callbacks must not throw or jump out. Every handle, pointer, size and number is checked.
///
/// Handles are numbers; 0 is none. One whose object was destroyed, or is of another kind, is refused with
/// SINEW_BAD_HANDLE for ever: numbers do not come again. Characters, props and loops go with their world.
///
/// Threads. One call at a time for each world and what is in it: a call that comes while another one runs
/// (from another thread, or from a callback) is refused with SINEW_BUSY and does nothing. Different worlds
/// are independent. Assets do not change and are read from any number of threads; destroy one when nobody
/// uses it any more.
///
/// Structs that begin with `size` grow at their end in later versions: set it to sizeof, then call …_init,
/// which fills what you know of. Bytes beyond what a caller knows have their defaults. Structs without it do
/// not change.
///
/// This header keeps to a regular form, from which describe_abi.py writes sinew_abi.json and the bindings are
/// made: enumerations are int32_t with the values of the enum that follows, flags are int32_t, 0 or not.
#ifndef SINEW_C_SINEW_H
#define SINEW_C_SINEW_H

#include <stddef.h>
#include <stdint.h>

#if defined(_WIN32)
#ifdef SINEW_C_BUILDS
#define SINEW_API __declspec(dllexport)
#else
#define SINEW_API __declspec(dllimport)
#endif
#else
/// Marks what the shared library exports.
#define SINEW_API __attribute__((visibility("default")))
#endif

#ifdef __cplusplus
/// Before a member: at multiples of so many bytes.
#define SINEW_ALIGNED(bytes) alignas(bytes)
extern "C" {
#else
/// Before a member: at multiples of so many bytes.
#define SINEW_ALIGNED(bytes) _Alignas(bytes)
#endif

// ---- Errors and version ----

/// Why a call was refused, or SINEW_OK.
typedef int32_t sinew_status;
/// Values of sinew_status.
enum sinew_status_values {
  SINEW_OK = 0,                ///< done
  SINEW_INVALID_ARGUMENT = 1,  ///< a null, size, index or setting that can't be meant
  SINEW_NOT_FINITE = 2,        ///< NaN or infinity in an input
  SINEW_OUT_OF_RANGE = 3,      ///< finite, but absurd
  SINEW_BAD_FILE = 4,          ///< no Sinew file, truncated, or broken
  SINEW_BAD_VERSION = 5,       ///< a file, or a struct's size, of a newer version
  SINEW_IO = 6,                ///< the file could not be read
  SINEW_BAD_HANDLE = 7,        ///< null, destroyed, or of another kind
  SINEW_BUSY = 8,              ///< another call for the same world runs
  SINEW_NO_MEMORY = 9,    ///< a set-up call found no memory; a world that it should have changed is broken
  SINEW_NOT_FOUND = 10,   ///< no such name
  SINEW_TOO_SMALL = 11,   ///< the caller's memory; the size that it takes is told
  SINEW_BROKEN = 12,      ///< a world that ran out of memory while something was added: destroy it
  SINEW_UNSUPPORTED = 13  ///< this library was built without it
};

/// "0.2.0", of the library.
SINEW_API const char* sinew_version(void);
/// "SINEW_NOT_FINITE"; "unknown status" of another number.
SINEW_API const char* sinew_status_name(sinew_status status);
/// Why the last call of this thread that failed did: one clause, "" before any. Valid for ever. Calls that
/// succeed leave it.
SINEW_API const char* sinew_last_reason(void);
/// Which joint, clip or element that reason is about; -1 if none.
SINEW_API int32_t sinew_last_index(void);

// ---- Hooks of the whole library ----
// Set them before anything else, or while no other call runs: they are read without a lock. What they call
// must not call Sinew.

/// Memory of so many bytes (at least 1) at a multiple of `alignment`, a power of two; null where there is
/// none. Called by set-up, recordings and loading, on any thread; never by a step.
typedef void* (*sinew_allocate)(void* context, size_t bytes, size_t alignment);
/// Takes back what sinew_allocate gave.
typedef void (*sinew_release)(void* context, void* memory);
/// Every byte that the library takes from the heap comes from `allocate` from now on; both null: from malloc.
/// Files that are loaded are mapped meanwhile, by the system. SINEW_INVALID_ARGUMENT while the library has
/// memory, as a living asset or world; SINEW_UNSUPPORTED where the C++ library is not within it
/// (BUILD_SHARED_LIBS, sanitizers, WebAssembly): operator new of the program serves then.
SINEW_API sinew_status sinew_set_memory(sinew_allocate allocate, sinew_release release, void* context);
/// Blocks that the library has now; 0 where sinew_set_memory is not supported.
SINEW_API size_t sinew_memory_blocks(void);

/// How bad it is.
typedef int32_t sinew_log_level;
/// Values of sinew_log_level.
enum sinew_log_level_values {
  SINEW_LOG_INFO = 0,     ///< a result is less exact than it should be
  SINEW_LOG_WARNING = 1,  ///< something was given up: a contact left out, a body stopped
  SINEW_LOG_ERROR = 2     ///< a call was refused; sinew_last_reason() says the same
};
/// `words` live for ever; `index` of the character, prop or element that they are about, -1 if none.
typedef void (*sinew_log)(void* context, sinew_log_level level, const char* words, int32_t index);
/// Who hears of every call that is refused, on its thread, and of what steps could not do, at their end;
/// null: nobody.
SINEW_API sinew_status sinew_set_log(sinew_log log, void* context);

/// An assumption of the library's own that does not hold: its text and place. Where it returns, the call goes
/// on.
typedef void (*sinew_assertion)(void* context, const char* condition, const char* file, int32_t line);
/// Null: written to stderr, and the program aborts. SINEW_UNSUPPORTED where the library does not check them
/// (it does when built with SINEW_ASSERTS).
SINEW_API sinew_status sinew_set_assertion(sinew_assertion failed, void* context);

/// A part of a step begins, or ends: nested, each on one thread. `zone`: its name, which lives for ever.
typedef void (*sinew_zone)(void* context, const char* zone);
/// Both or none. SINEW_UNSUPPORTED where the library was built without SINEW_PROFILER.
SINEW_API sinew_status sinew_set_profiler(sinew_zone begin, sinew_zone end, void* context);

// ---- What is passed about ----

/// A skeleton and its clips; constant. Destroy it.
typedef uint64_t sinew_asset;
/// Characters, props and what surrounds them. Destroy it.
typedef uint64_t sinew_world;
/// One character of a world; goes with it.
typedef uint64_t sinew_character;
/// One prop of a world; goes with it.
typedef uint64_t sinew_prop;
/// One loop of a world; goes with it.
typedef uint64_t sinew_loop;

/// Local motion of a joint: pose, velocity and acceleration of its frame relative to its parent's. Angular
/// derivatives are in the joint's axes, those of the translation in the parent's.
typedef struct sinew_jet {
  SINEW_ALIGNED(16) float rotation[4];  ///< x y z w, unit
  float angular_velocity[3];            ///< rad/s
  float angular_acceleration[3];        ///< rad/s2
  float translation[3];                 ///< m
  float velocity[3];                    ///< m/s
  float acceleration[3];                ///< m/s2
} sinew_jet;

/// x_parent = rotation * x + translation.
typedef struct sinew_transform {
  SINEW_ALIGNED(16) float rotation[4];  ///< x y z w, unit
  float translation[3];                 ///< m
} sinew_transform;

/// The same of what is placed in the world.
typedef struct sinew_pose {
  double rotation[4];     ///< x y z w, unit
  double translation[3];  ///< m
} sinew_pose;

/// Memory of a world's own, to be read without a copy: `count` elements, `stride` bytes from one to the next.
typedef struct sinew_view {
  const void* data;  ///< the first element; null if there is none
  int32_t count;     ///< elements
  int32_t stride;    ///< bytes
} sinew_view;

// ---- Assets: a skeleton and its clips, as `sinew convert` writes them ----

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

/// Set-up: reads a file, checked throughout.
SINEW_API sinew_status sinew_asset_load(const char* path, sinew_asset* out);
/// The same from memory, which is copied.
SINEW_API sinew_status sinew_asset_read(const void* bytes, size_t size, sinew_asset* out);
/// Worlds keep what they need of it; only clips cannot be played any more.
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
/// What a clip shows at a time (s), for whoever blends by himself. `rate`: how fast clip time goes, 1 at
/// normal speed; `rate_change`, 1/s: exact velocities and accelerations while time is warped. Loops wrap,
/// other clips hold their ends. `jets`: [count], aligned to 16 bytes; fewer than the skeleton's joints: only
/// those. Allocates nothing.
SINEW_API sinew_status sinew_clip_sample(sinew_asset asset, int32_t clip, double time, double rate,
                                         double rate_change, sinew_jet* jets, int32_t count);

// ---- Worlds ----

/// What is to be done for one index.
typedef void (*sinew_task)(void* task_context, int32_t index);
/// `task` for every index in [0, count), on any threads and in any order; returns when all have returned.
typedef void (*sinew_run_tasks)(void* context, int32_t count, sinew_task task, void* task_context);
/// Microseconds, from any thread.
typedef double (*sinew_clock)(void* context);

/// Fields mean what those of WorldSettings, Accuracy and LevelOfDetail do; lengths, times and speeds are
/// those of a figure of human size.
typedef struct sinew_world_settings {
  uint32_t size;                 ///< bytes of this struct, as the caller knows it
  int32_t workers;               ///< threads that a step may use (sinew_world_set_jobs), 1 to 256
  double gravity[3];             ///< m/s2
  double ground_height;          ///< m
  double ground_friction;        ///< multiplies the collider's
  double ground_restitution;     ///< 0 to 1
  int32_t ground;                ///< flag: there is a floor
  int32_t body_contact;          ///< flag: characters and props meet each other
  int32_t ground_support;        ///< flag: the floor bears what a driven root would
  int32_t batches;               ///< flag: several characters at a time, the same bits
  int32_t restitution;           ///< flag: impacts give back what colliders' restitution says
  int32_t continuous_detection;  ///< flag: what is fast does not pass through walls
  int32_t island_dofs;  ///< degrees of freedom solved together at most; beyond, neighbours pass through each
                        ///< other
  int32_t max_iterations;  ///< outer passes of a solve
  uint64_t memory_cap;     ///< bytes; who would exceed it is not added. 0: none
  double tolerance;        ///< m, of the last correction
  int32_t substeps;        ///< every step in so many equal parts, 1 to 64
  int32_t max_splits;      ///< halvings of a step that does not converge, 0 to 10
  double max_rotation;     ///< rad; a step in which a limp figure turns further is halved. 0: never
  double shortest_part;    ///< s; such halves are not halved below
  int32_t max_passes;      ///< outer passes of all solves of a substep together
  int32_t estimate_error;  ///< flag: fill estimated_error of reports
  double sink_depth;       ///< m, of a contact point under the character's weight
  double contact_damping;  ///< 1 is critical
  double stick_speed;      ///< m/s, below which friction sticks
  double limit_stiffness;  ///< N m/rad, of joint limits
  double limit_damping;    ///< s
  double return_time;      ///< s, of the return to the animation
  double dwell;            ///< s, that a level is kept after it was last needed
  double sleep_after;      ///< s at rest. 0: never
  double sleep_speed;      ///< m/s, below which it rests
  double sleep_spin;       ///< rad/s
  double baked_decay;      ///< 1/s
  int32_t bake_every;      ///< steps between those in which baked joints are dynamic, at least 1
  int32_t unused;          ///< 0
  double budget;           ///< per step: microseconds by `clock`, without one units of work. 0: no limit
  sinew_clock clock;       ///< or null
  void* clock_context;     ///< given to `clock`
} sinew_world_settings;

/// What the last step cost, and how detailed characters are.
typedef struct sinew_world_report {
  uint32_t size;          ///< bytes of this struct, as the caller knows it
  int32_t capped;         ///< characters that the budget holds down
  double cost;            ///< of the last step, as `budget` is given
  double forecast;        ///< smoothed
  int32_t characters[6];  ///< at each sinew_level
} sinew_world_report;

/// The library's defaults. `settings->size` must be set; so with every …_init.
SINEW_API sinew_status sinew_world_settings_init(sinew_world_settings* settings);
/// Sets what accuracy costs to a measured preset: "cinematic", "game" or "crowd".
SINEW_API sinew_status sinew_world_settings_use_preset(sinew_world_settings* settings, const char* preset);
/// Set-up, in single precision. `settings` may be null: defaults.
SINEW_API sinew_status sinew_world_create(const sinew_world_settings* settings, sinew_world* out);
/// With everything that is in it.
SINEW_API sinew_status sinew_world_destroy(sinew_world world);
/// Whose threads a step uses from now on; null: the calling one alone. The result has the same bits.
SINEW_API sinew_status sinew_world_set_jobs(sinew_world world, sinew_run_tasks run, void* context);
/// Advances by h seconds, 1e-5 to 0.25. Allocates nothing (but while it is recorded) and takes no lock.
SINEW_API sinew_status sinew_world_step(sinew_world world, float h);
/// What the last step cost.
SINEW_API sinew_status sinew_world_get_report(sinew_world world, sinew_world_report* out);
/// Bytes that it has from the heap. O(characters).
SINEW_API sinew_status sinew_world_get_memory(sinew_world world, uint64_t* bytes);
/// joint to world of all joints of all characters, in the order in which they were added: copied to
/// out[capacity]. `count`: how many there are, also with SINEW_TOO_SMALL.
SINEW_API sinew_status sinew_world_copy_models(sinew_world world, sinew_transform* out, int32_t capacity,
                                               int32_t* count);

// ---- Surroundings ----

/// What a collider is.
typedef int32_t sinew_shape;
/// Values of sinew_shape.
enum sinew_shape_values {
  SINEW_SHAPE_SPHERE = 0,   ///< a radius
  SINEW_SHAPE_CAPSULE = 1,  ///< a radius and the half length of a segment
  SINEW_SHAPE_BOX = 2       ///< three half extents
};

/// A solid that does not move.
typedef struct sinew_obstacle {
  uint32_t size;      ///< bytes of this struct, as the caller knows it
  sinew_shape shape;  ///< a capsule and a box lie along their local z
  double extent[3];  ///< m; sphere: radius; capsule: radius, -, half length of the segment; box: half extents
  sinew_pose pose;   ///< in the world
  double friction;   ///< at least 0
  double restitution;  ///< 0 to 1
  uint32_t layers;     ///< bits that queries choose by
  int32_t unused;      ///< 0
} sinew_obstacle;

/// Ground given by heights on a grid.
typedef struct sinew_height_field {
  uint32_t size;          ///< bytes of this struct, as the caller knows it
  int32_t columns;        ///< along x
  int32_t rows;           ///< along y
  uint32_t layers;        ///< bits that queries choose by
  const double* heights;  ///< [row * columns + column], m; copied
  double corner[3];       ///< m, of heights[0]; its z is added to all
  double spacing;         ///< m
  double friction;        ///< at least 0
  double restitution;     ///< 0 to 1
} sinew_height_field;

/// Signed distance (m, negative inside) of a world point from something that does not move, and the outward
/// unit normal there. Called within steps, often, also from job threads: the same answer to the same point,
/// no lock, no call of Sinew.
typedef double (*sinew_distance)(void* context, const double point[3], double normal[3]);

/// The host's own collision world.
typedef struct sinew_host_shape {
  uint32_t size;            ///< bytes of this struct, as the caller knows it
  uint32_t layers;          ///< bits that queries choose by
  sinew_distance distance;  ///< must not be null
  void* context;            ///< must outlive the world
  double half_thickness;    ///< m, of its thinnest part
  double friction;          ///< at least 0
  double restitution;       ///< 0 to 1
} sinew_host_shape;

/// The library's defaults.
SINEW_API sinew_status sinew_obstacle_init(sinew_obstacle* settings);
/// The library's defaults.
SINEW_API sinew_status sinew_height_field_init(sinew_height_field* settings);
/// The library's defaults.
SINEW_API sinew_status sinew_host_shape_init(sinew_host_shape* settings);
/// Set-up.
SINEW_API sinew_status sinew_world_add_obstacle(sinew_world world, const sinew_obstacle* settings);
/// Set-up. `heights` are copied.
SINEW_API sinew_status sinew_world_add_height_field(sinew_world world, const sinew_height_field* settings);
/// Set-up. `context` must outlive the world.
SINEW_API sinew_status sinew_world_add_host_shape(sinew_world world, const sinew_host_shape* settings);

// ---- Characters ----

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
  uint32_t layers;         ///< bits that queries choose by
  sinew_level most;        ///< at most this
  double significance;     ///< the budget takes from the least significant first
  int32_t check_every;     ///< steps from one check of the muscles to the next, at least 1
  int32_t bake;            ///< flag: hands, feet and toes dynamic now and then
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
} sinew_character_report;

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
/// Of the subtree below a joint, of one muscle, of all muscles of a group: all multiply.
SINEW_API sinew_status sinew_character_set_joint_strength(sinew_character character, int32_t joint,
                                                          float strength);
/// The same of one muscle, by its index in the asset.
SINEW_API sinew_status sinew_character_set_muscle_strength(sinew_character character, int32_t muscle,
                                                           float strength);
/// The same of all muscles of a group; SINEW_NOT_FOUND if there are none.
SINEW_API sinew_status sinew_character_set_group_strength(sinew_character character, const char* group,
                                                          float strength);
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
/// Where a grounded character follows its animation since something moved it: [3] x, y (m), yaw (rad).
SINEW_API sinew_status sinew_character_get_displacement(sinew_character character, double out[3]);
/// The host has moved the character's place itself: targets are given there from now on.
SINEW_API sinew_status sinew_character_take_displacement(sinew_character character);
/// Puts its animation elsewhere: by [3] x, y (m), yaw (rad).
SINEW_API sinew_status sinew_character_displace(sinew_character character, const double further[3]);
/// A hit: impulse [3] (N s, world) at a world point [3] on a joint's body, at the beginning of the next step.
SINEW_API sinew_status sinew_character_apply_impulse(sinew_character character, int32_t joint,
                                                     const double point[3], const double impulse[3]);
/// A load: force [3] (N, world) during the next step.
SINEW_API sinew_status sinew_character_apply_force(sinew_character character, int32_t joint,
                                                   const double point[3], const double force[3]);
/// Out of the world, where it costs nothing and touches nobody; or back, onto its target, as by reset.
SINEW_API sinew_status sinew_character_park(sinew_character character, int32_t parked);
/// What the last step did with it.
SINEW_API sinew_status sinew_character_get_report(sinew_character character, sinew_character_report* out);
/// Where to read without a copy. The memory stays while the world lives; what is in it is up to date until
/// the world's next step, reset or restore: ask again then.
SINEW_API sinew_status sinew_character_get_view(sinew_character character, sinew_view_kind kind,
                                                sinew_view* out);

// ---- Balance: a character with SINEW_ROOT_GROUNDED that gives, steps, staggers or falls when it is pushed
// ----

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

// ---- Props ----

/// A body of one collider: a ball, a box. Fields mean what those of PropSettings do.
typedef struct sinew_prop_settings {
  uint32_t size;               ///< bytes of this struct, as the caller knows it
  sinew_shape shape;           ///< of its one collider
  double extent[3];            ///< m, as of sinew_obstacle
  double mass;                 ///< kg
  double friction;             ///< at least 0
  double restitution;          ///< 0 to 1
  sinew_pose pose;             ///< in the world
  double velocity[3];          ///< m/s
  double angular_velocity[3];  ///< rad/s, world
  uint32_t layers;             ///< bits that queries choose by
  int32_t unused;              ///< 0
} sinew_prop_settings;

/// The library's defaults.
SINEW_API sinew_status sinew_prop_settings_init(sinew_prop_settings* settings);
/// Set-up. `settings` may be null.
SINEW_API sinew_status sinew_world_add_prop(sinew_world world, const sinew_prop_settings* settings,
                                            sinew_prop* out);
/// The handle of an index, as contacts and queries tell it.
SINEW_API sinew_status sinew_world_get_prop(sinew_world world, int32_t index, sinew_prop* out);
/// Where it is, and how fast [3] (m/s); either may be null.
SINEW_API sinew_status sinew_prop_get_state(sinew_prop prop, sinew_transform* pose, float velocity[3]);
/// Puts it there, moving so [3] (m/s and rad/s, world); brings a parked one back.
SINEW_API sinew_status sinew_prop_set_state(sinew_prop prop, const sinew_transform* pose,
                                            const float velocity[3], const float angular_velocity[3]);
/// Out of the world until sinew_prop_set_state.
SINEW_API sinew_status sinew_prop_park(sinew_prop prop);
/// What the last step did with it.
SINEW_API sinew_status sinew_prop_get_report(sinew_prop prop, sinew_character_report* out);

// ---- Loops: two frames that stay together though no joint connects them ----

/// What carries an anchor.
typedef int32_t sinew_anchor_kind;
/// Values of sinew_anchor_kind.
enum sinew_anchor_kind_values {
  SINEW_ANCHOR_WORLD = 0,      ///< nothing: it stays where it is
  SINEW_ANCHOR_CHARACTER = 1,  ///< a joint of a character
  SINEW_ANCHOR_PROP = 2        ///< a prop
};

/// One of the two frames of a loop.
typedef struct sinew_anchor {
  sinew_anchor_kind kind;  ///< what carries it
  int32_t joint;           ///< of a character
  uint64_t handle;         ///< of the character or prop; of the world 0
  sinew_pose pose;         ///< in the joint's axes; of the world in the world's
} sinew_anchor;

/// What of two frames stays together.
typedef int32_t sinew_loop_kind;
/// Values of sinew_loop_kind.
enum sinew_loop_kind_values {
  SINEW_LOOP_POINT = 0,     ///< the origins coincide
  SINEW_LOOP_HINGE = 1,     ///< and the z axes
  SINEW_LOOP_WELD = 2,      ///< and all axes
  SINEW_LOOP_DISTANCE = 3,  ///< the origins stay `length` apart
  SINEW_LOOP_ROPE = 4       ///< or nearer
};

/// Two frames, and what keeps them together.
typedef struct sinew_loop_settings {
  uint32_t size;         ///< bytes of this struct, as the caller knows it
  sinew_loop_kind kind;  ///< what stays together
  sinew_anchor a;        ///< one side
  sinew_anchor b;        ///< the other side
  double length;         ///< m
  double stiffness;      ///< N/m of each point; 0: the weight of the heavier side moves it by 0.1 mm
  int32_t collide;       ///< flag: the two bodies may touch each other
  int32_t unused;        ///< 0
} sinew_loop_settings;

/// The library's defaults.
SINEW_API sinew_status sinew_loop_settings_init(sinew_loop_settings* settings);
/// Set-up. What is open closes at a walking pace.
SINEW_API sinew_status sinew_world_add_loop(sinew_world world, const sinew_loop_settings* settings,
                                            sinew_loop* out);
/// Opens a loop (it costs nothing then), or closes it again.
SINEW_API sinew_status sinew_loop_set_closed(sinew_loop loop, int32_t closed);
/// m by which it is apart, and the force [3] (N) on side a; either may be null.
SINEW_API sinew_status sinew_loop_get_state(sinew_loop loop, double* gap, float force[3]);

// ---- Contacts ----

/// What kind of body touches or was met.
typedef int32_t sinew_body_kind;
/// Values of sinew_body_kind.
enum sinew_body_kind_values {
  SINEW_BODY_GROUND = 0,     ///< the floor
  SINEW_BODY_OBSTACLE = 1,   ///< sinew_world_add_obstacle
  SINEW_BODY_SHAPE = 2,      ///< a height field or the host's
  SINEW_BODY_CHARACTER = 3,  ///< sinew_world_add_character
  SINEW_BODY_PROP = 4,       ///< sinew_world_add_prop
  SINEW_BODY_PARTICLES = 5   ///< a strand, cloth or soft tissue
};

/// What touches or was met.
typedef struct sinew_body {
  sinew_body_kind kind;  ///< what it is
  int32_t index;         ///< in the order in which those of its kind were added
  int32_t joint;         ///< that carries it, of a character; else 0
} sinew_body;

/// Where a touch is in its life.
typedef int32_t sinew_contact_phase;
/// Values of sinew_contact_phase.
enum sinew_contact_phase_values {
  SINEW_CONTACT_BEGIN = 0,  ///< they did not touch a step ago
  SINEW_CONTACT_STAY = 1,   ///< they did, and do
  SINEW_CONTACT_END = 2     ///< they do not touch any more
};

/// One point of a contact.
typedef struct sinew_touch_point {
  double position[3];  ///< m, world, on a
  double normal[3];    ///< unit, from b to a
  double friction[3];  ///< N, on a
  double impulse;      ///< N s along the normal
  double force;        ///< N along the normal, at the end of the step
  double depth;        ///< m
} sinew_touch_point;

/// Two bodies that touch each other.
typedef struct sinew_contact_event {
  sinew_contact_phase phase;   ///< whether the touch begins, goes on or ends
  int32_t solved;              ///< flag; 0: the animation leads a on to the ground, without impulses
  sinew_body a;                ///< what moves
  sinew_body b;                ///< what is static is always b
  int32_t points;              ///< at which they touch
  int32_t kept;                ///< of these, in `point`
  double impulse;              ///< N s, of all points
  double normal[3];            ///< unit, from b to a
  sinew_touch_point point[4];  ///< the first `kept`
} sinew_contact_event;

/// Which contacts are told.
typedef struct sinew_contact_settings {
  uint32_t size;          ///< bytes of this struct, as the caller knows it
  int32_t capacity;       ///< events that wait at most, 1 to 1048576; what finds no room is counted
  int32_t begin;          ///< flags: which events
  int32_t stay;           ///< flag
  int32_t end;            ///< flag
  int32_t animated;       ///< flag: what a clip sets on the ground, too
  double animated_reach;  ///< m
} sinew_contact_settings;

/// The library's defaults.
SINEW_API sinew_status sinew_contact_settings_init(sinew_contact_settings* settings);
/// Set-up: every step from now on leaves its events; null: none any more. What waited is dropped.
SINEW_API sinew_status sinew_world_report_contacts(sinew_world world, const sinew_contact_settings* settings);
/// Takes the oldest events. `dropped` (may be null): that found no room, since reports began.
SINEW_API sinew_status sinew_world_take_contacts(sinew_world world, sinew_contact_event* out,
                                                 int32_t capacity, int32_t* count, uint64_t* dropped);

// ---- Queries ----

/// 0: the body is passed by. No call of Sinew for this world.
typedef int32_t (*sinew_accept)(void* context, const sinew_body* body);

/// A ray, a ball or a capsule, where it goes, and what it meets.
typedef struct sinew_query {
  uint32_t size;        ///< bytes of this struct, as the caller knows it
  uint32_t layers;      ///< meets only what has one of these bits
  double origin[3];     ///< m, world, of its middle
  double motion[3];     ///< m, world: direction times length; an overlap ignores it
  double half_axis[3];  ///< m, of a capsule: from its middle to one end of its axis
  double radius;        ///< m; 0: a ray
  uint32_t kinds;       ///< bit 1 << sinew_body_kind: meets those; the host's shapes go with obstacles
  int32_t unused;       ///< 0
  sinew_character without_character;  ///< passes through it; 0: none
  sinew_prop without_prop;            ///< passes through it; 0: none
  sinew_accept accept;                ///< asked last; may be null
  void* context;                      ///< given to `accept`
} sinew_query;

/// What a cast or an overlap met.
typedef struct sinew_hit {
  sinew_body body;     ///< what was met
  int32_t collider;    ///< of the skeleton; 0 of props, else -1
  double distance;     ///< m that the cast has gone
  double position[3];  ///< m, world, on what was met
  double normal[3];    ///< unit, outwards
  double depth;        ///< m, how deep it begins in that
} sinew_hit;

/// The library's defaults.
SINEW_API sinew_status sinew_query_init(sinew_query* query);
/// The nearest hits, nearest first. Room for one is the quickest.
SINEW_API sinew_status sinew_world_cast(sinew_world world, const sinew_query* query, sinew_hit* out,
                                        int32_t capacity, int32_t* count);
/// What touches it where it is, deepest first.
SINEW_API sinew_status sinew_world_overlap(sinew_world world, const sinew_query* query, sinew_hit* out,
                                           int32_t capacity, int32_t* count);

// ---- Debug drawing ----

/// Places [3] in m, world; colours are 0xRRGGBBAA. Words are valid during the call.
typedef void (*sinew_draw_line)(void* context, const double from[3], const double to[3], uint32_t color);
/// The same of a triangle.
typedef void (*sinew_draw_triangle)(void* context, const double a[3], const double b[3], const double c[3],
                                    uint32_t color);
/// The same of words.
typedef void (*sinew_draw_text)(void* context, const double at[3], const char* words, uint32_t color);

/// What is drawn, and by which functions (DebugDrawSettings).
typedef struct sinew_draw_settings {
  uint32_t size;         ///< bytes of this struct, as the caller knows it
  int32_t skeleton;      ///< flag: a line from each joint to its parent
  int32_t colliders;     ///< flag: as wires; the host's shapes know no outline
  int32_t contacts;      ///< flag: points, forces along the normal and friction; while contacts are reported
  int32_t muscles;       ///< flag: a mark at each joint, green unloaded, red at its limit
  int32_t unknowns;      ///< flag: axes of the degrees of freedom that the last step solved for
  int32_t islands;       ///< flag: who was solved together, and words on what the step did
  int32_t support;       ///< flag: centre of mass, its foot on the ground, what a character stands on
  int32_t targets;       ///< flag: what the animation wants, where the pose is not there
  int32_t unused;        ///< 0
  double force_scale;    ///< m by N
  sinew_draw_line line;  ///< may be null
  sinew_draw_triangle triangle;  ///< may be null
  sinew_draw_text text;          ///< may be null
  void* context;                 ///< given to each
} sinew_draw_settings;

/// The library's defaults.
SINEW_API sinew_status sinew_draw_settings_init(sinew_draw_settings* settings);
/// As the last step left it; changes no bit of it. Allocates.
SINEW_API sinew_status sinew_world_draw(sinew_world world, const sinew_draw_settings* settings);

// ---- Snapshots and recordings ----

/// Which half of a snapshot.
typedef int32_t sinew_snapshot_part;
/// Values of sinew_snapshot_part.
enum sinew_snapshot_part_values {
  SINEW_SNAPSHOT_STATE = 0,  ///< everything that the next step depends on, but
  SINEW_SNAPSHOT_INPUTS = 1  ///< targets and pushes that wait for it
};

/// How far a recording was repeated.
typedef struct sinew_replay_report {
  uint32_t size;           ///< bytes of this struct, as the caller knows it
  int32_t steps;           ///< that were repeated, the differing one included
  int32_t same;            ///< flag: every byte after every step
  int32_t differing_body;  ///< otherwise: the first byte that differs belongs to this character or prop, -1:
                           ///< the world
  uint64_t byte;           ///< of the snapshot
  const char* field;       ///< what it stands for
} sinew_replay_report;

/// Writes flat bytes. `size`: how many were written, or, with SINEW_TOO_SMALL, how many there may be at most:
/// out = NULL and capacity 0 ask for it. Allocates nothing.
SINEW_API sinew_status sinew_world_save(sinew_world world, sinew_snapshot_part part, void* out,
                                        size_t capacity, size_t* size);
/// Refuses what sinew_world_save of a world set up the same way did not write, with nothing moved. Given the
/// same inputs it goes on to the bit.
SINEW_API sinew_status sinew_world_restore(sinew_world world, sinew_snapshot_part part, const void* bytes,
                                           size_t size);
/// From now on (begin: flag) steps are recorded, in the calling thread alone; or no more. Steps allocate
/// then.
SINEW_API sinew_status sinew_world_record(sinew_world world, int32_t begin);
/// The recording so far, to be copied before the next call for this world.
SINEW_API sinew_status sinew_world_get_recording(sinew_world world, sinew_view* out);
/// Repeats a recording in a world set up as the recorded one was, up to the first byte that differs.
SINEW_API sinew_status sinew_world_replay(sinew_world world, const void* bytes, size_t size,
                                          sinew_replay_report* out);

#ifdef __cplusplus
}
#endif

#endif
