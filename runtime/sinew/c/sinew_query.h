/// @file
/// What touches what, what a ray meets, what is drawn to look at it. Part of sinew.h.
#ifndef SINEW_C_SINEW_QUERY_H
#define SINEW_C_SINEW_QUERY_H

#ifndef SINEW_C_SINEW_H
#error "include sinew/c/sinew.h"
#endif

// ---- Contacts ----

/// What kind of body touches or was met.
typedef int32_t sinew_body_kind;
/// Values of sinew_body_kind.
enum sinew_body_kind_values {
  SINEW_BODY_GROUND = 0,     ///< the floor
  SINEW_BODY_OBSTACLE = 1,   ///< sinew_world_add_obstacle
  SINEW_BODY_SHAPE = 2,      ///< a height field, a convex solid or the host's
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

/// How many characters, props or particle bodies a world has, parked ones included: their indices are below.
SINEW_API sinew_status sinew_world_get_count(sinew_world world, sinew_body_kind kind, int32_t* out);

/// Whether two of the characters, props and particle bodies (flag; `joint` does not count) pass through each
/// other, whatever their layers say: a rider and his horse, who throws and what he throws. Wakes both. No
/// part of snapshots. For a few pairs: O(pairs) here and for every two that come close.
SINEW_API sinew_status sinew_world_keep_apart(sinew_world world, const sinew_body* a, const sinew_body* b,
                                              int32_t apart);

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

// ---- Sensors ----

/// A ball or a capsule of a world that tells who comes in and who leaves. Nothing collides with it, a step
/// does nothing for it, and snapshots do not hold it. Goes with its world.
typedef uint64_t sinew_sensor;

/// Who has come in or left.
typedef struct sinew_sensor_event {
  sinew_contact_phase phase;  ///< SINEW_CONTACT_BEGIN: is in it now; SINEW_CONTACT_END: is not any more
  sinew_body body;            ///< `joint` is 0: a character is in it by any of its colliders
} sinew_sensor_event;

/// Set-up: for so many bodies (1 to 65536) in it at once. `query`: where it is and whom it looks for, as of
/// sinew_world_overlap; characters, props and particles alone need a `kinds` that says so.
SINEW_API sinew_status sinew_world_add_sensor(sinew_world world, const sinew_query* query, int32_t bodies,
                                              sinew_sensor* out);
/// Elsewhere, of another size or for others, from its next update on.
SINEW_API sinew_status sinew_sensor_place(sinew_sensor sensor, const sinew_query* query);
/// Looks who is in it. `left_out`: bodies that found no room; may be null. Allocates nothing.
SINEW_API sinew_status sinew_sensor_update(sinew_sensor sensor, int32_t* left_out);
/// Of the last update: those who left, then those who came. `count`: how many, also with SINEW_TOO_SMALL;
/// twice the bodies that it has room for at most.
SINEW_API sinew_status sinew_sensor_get_events(sinew_sensor sensor, sinew_sensor_event* out, int32_t capacity,
                                               int32_t* count);
/// Who is in it since the last update, by kind and index. `count`: how many, also with SINEW_TOO_SMALL.
SINEW_API sinew_status sinew_sensor_get_bodies(sinew_sensor sensor, sinew_body* out, int32_t capacity,
                                               int32_t* count);

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

#endif
