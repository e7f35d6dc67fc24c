/// @file
/// Worlds: settings, steps, what stands in them. Part of sinew.h.
#ifndef SINEW_C_SINEW_WORLD_H
#define SINEW_C_SINEW_WORLD_H

#ifndef SINEW_C_SINEW_H
#error "include sinew/c/sinew.h"
#endif

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

/// A convex solid that does not move, by the half spaces that it is the intersection of: a ramp, a rock.
typedef struct sinew_convex_solid {
  uint32_t size;        ///< bytes of this struct, as the caller knows it
  int32_t face_count;   ///< of `faces`, 1 to 65536
  const double* faces;  ///< [face][4] unit outward normal, and m from the world's origin along it; copied
  uint32_t layers;      ///< bits that queries choose by
  int32_t unused;       ///< 0
  double inner_radius;  ///< m, of a ball that fits inside
  double friction;      ///< at least 0
  double restitution;   ///< 0 to 1
} sinew_convex_solid;

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
/// The library's defaults; faces are none.
SINEW_API sinew_status sinew_convex_solid_init(sinew_convex_solid* settings);
/// The library's defaults.
SINEW_API sinew_status sinew_host_shape_init(sinew_host_shape* settings);
/// Set-up.
SINEW_API sinew_status sinew_world_add_obstacle(sinew_world world, const sinew_obstacle* settings);
/// Set-up: a convex hull of `count` points, three numbers each (m, in the axes of the obstacle's pose), of at
/// most 32 corners; `shape` and `extent` of the settings do not count. sinew_last_index(): the point at
/// fault.
SINEW_API sinew_status sinew_world_add_convex_obstacle(sinew_world world, const sinew_obstacle* settings,
                                                       const double* points, int32_t count);
/// Set-up. `heights` are copied.
SINEW_API sinew_status sinew_world_add_height_field(sinew_world world, const sinew_height_field* settings);
/// Set-up. `faces` are copied. Over edges and corners what is met is as if they were not rounded off.
/// sinew_last_index(): the face at fault.
SINEW_API sinew_status sinew_world_add_convex_solid(sinew_world world, const sinew_convex_solid* settings);
/// Set-up. `context` must outlive the world.
SINEW_API sinew_status sinew_world_add_host_shape(sinew_world world, const sinew_host_shape* settings);

#endif
