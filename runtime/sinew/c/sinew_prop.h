/// @file
/// Props, and loops that tie things together. Part of sinew.h.
#ifndef SINEW_C_SINEW_PROP_H
#define SINEW_C_SINEW_PROP_H

#ifndef SINEW_C_SINEW_H
#error "include sinew/c/sinew.h"
#endif

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
  uint32_t layers;             ///< bits that queries and `meets` choose by
  int32_t unused;              ///< 0
  uint32_t meets;              ///< touches who has one of these bits in its layers, and would touch it, too
  int32_t unused2;             ///< 0
} sinew_prop_settings;

/// The library's defaults.
SINEW_API sinew_status sinew_prop_settings_init(sinew_prop_settings* settings);
/// Set-up. `settings` may be null.
SINEW_API sinew_status sinew_world_add_prop(sinew_world world, const sinew_prop_settings* settings,
                                            sinew_prop* out);
/// Set-up: a prop of uniform density that is the convex hull of `count` points, three numbers each (m, in the
/// axes of its pose), of at most 32 corners. `settings` may be null; their `shape` and `extent` do not count.
/// sinew_last_index(): the point at fault.
SINEW_API sinew_status sinew_world_add_convex_prop(sinew_world world, const sinew_prop_settings* settings,
                                                   const double* points, int32_t count, sinew_prop* out);
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
  double stiffness;      ///< N/m of each point; 0: the weight of the heaviest tied to it moves it by 0.1 mm
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

#endif
