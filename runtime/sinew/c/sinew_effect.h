/// @file
/// Effects: wind, water, fields of force, springs of joints. Part of sinew.h.
///
/// Each acts on one character or prop. Its settings may change between steps (gusts, tides, a blast); they
/// are not part of snapshots. Impacts that give back, and fast things that do not pass through walls, are of
/// a whole world: sinew_world_settings.
#ifndef SINEW_C_SINEW_EFFECT_H
#define SINEW_C_SINEW_EFFECT_H

#ifndef SINEW_C_SINEW_H
#error "include sinew/c/sinew.h"
#endif

// ---- Effects ----

/// What acts on a character or prop; goes with its world, or is taken away before.
typedef uint64_t sinew_effect;

/// Moving or still air: quadratic drag on colliders. Fields mean what those of WindSettings do.
typedef struct sinew_wind {
  uint32_t size;          ///< bytes of this struct, as the caller knows it
  int32_t joint_count;    ///< of `joints`; 0: all
  const int32_t* joints;  ///< whose colliders feel it; read when it is added
  double velocity[3];     ///< m/s, world, of the air
  double density;         ///< kg/m3
} sinew_wind;

/// Water below a level: lift of what colliders displace, and drag. Fields mean what those of BuoyancySettings
/// do.
typedef struct sinew_buoyancy {
  uint32_t size;          ///< bytes of this struct, as the caller knows it
  int32_t joint_count;    ///< of `joints`; 0: all
  const int32_t* joints;  ///< whose colliders feel it; read when it is added
  double level;           ///< m, height of the surface
  double density;         ///< kg/m3
  double flow[3];         ///< m/s, world, of the water
  double volume;          ///< times that of the colliders: they may overlap, or hold air
} sinew_buoyancy;

/// A pull towards a place, or a blast away from it. Fields mean what those of ForceFieldSettings do.
typedef struct sinew_force_field {
  uint32_t size;          ///< bytes of this struct, as the caller knows it
  int32_t joint_count;    ///< of `joints`; 0: all
  const int32_t* joints;  ///< whose bodies feel it; read when it is added
  double center[3];       ///< m, world
  double acceleration;    ///< m/s2 towards the centre; negative: away from it
  double reach;           ///< m, within which it grows linearly
} sinew_force_field;

/// Passive springs and dampers of joints. Fields mean what those of JointSpringSettings do.
typedef struct sinew_joint_spring {
  uint32_t size;          ///< bytes of this struct, as the caller knows it
  int32_t joint_count;    ///< of `joints`; 0: all that have freedom, but not a free root
  const int32_t* joints;  ///< that it bends; read when it is added
  double stiffness;       ///< N m/rad, or N/m where the joint slides
  double damping;         ///< N m s/rad, or N s/m
  double rest[3];         ///< rad or m, by degree of freedom, from the skeleton's rest pose
} sinew_joint_spring;

/// The library's defaults.
SINEW_API sinew_status sinew_wind_init(sinew_wind* settings);
/// The library's defaults.
SINEW_API sinew_status sinew_buoyancy_init(sinew_buoyancy* settings);
/// The library's defaults.
SINEW_API sinew_status sinew_force_field_init(sinew_force_field* settings);
/// The library's defaults.
SINEW_API sinew_status sinew_joint_spring_init(sinew_joint_spring* settings);
/// Set-up. `settings` may be null: still air.
SINEW_API sinew_status sinew_character_add_wind(sinew_character character, const sinew_wind* settings,
                                                sinew_effect* out);
/// Set-up. `settings` may be null: still water below 0 m.
SINEW_API sinew_status sinew_character_add_buoyancy(sinew_character character, const sinew_buoyancy* settings,
                                                    sinew_effect* out);
/// Set-up. `settings` may be null: none, until sinew_effect_set_force_field.
SINEW_API sinew_status sinew_character_add_force_field(sinew_character character,
                                                       const sinew_force_field* settings, sinew_effect* out);
/// Set-up. `settings` may be null.
SINEW_API sinew_status sinew_character_add_joint_spring(sinew_character character,
                                                        const sinew_joint_spring* settings,
                                                        sinew_effect* out);
/// Set-up, as of a character; `joints` are none.
SINEW_API sinew_status sinew_prop_add_wind(sinew_prop prop, const sinew_wind* settings, sinew_effect* out);
/// Set-up, as of a character; `joints` are none.
SINEW_API sinew_status sinew_prop_add_buoyancy(sinew_prop prop, const sinew_buoyancy* settings,
                                               sinew_effect* out);
/// Set-up, as of a character; `joints` are none.
SINEW_API sinew_status sinew_prop_add_force_field(sinew_prop prop, const sinew_force_field* settings,
                                                  sinew_effect* out);
/// From the next step on; `joints` stay as they are. Refused of an effect of another kind. Wakes nobody who
/// sleeps.
SINEW_API sinew_status sinew_effect_set_wind(sinew_effect effect, const sinew_wind* settings);
/// The same of water.
SINEW_API sinew_status sinew_effect_set_buoyancy(sinew_effect effect, const sinew_buoyancy* settings);
/// The same of a field of force.
SINEW_API sinew_status sinew_effect_set_force_field(sinew_effect effect, const sinew_force_field* settings);
/// The same of springs.
SINEW_API sinew_status sinew_effect_set_joint_spring(sinew_effect effect, const sinew_joint_spring* settings);
/// Takes it away; its handle is refused from then on.
SINEW_API sinew_status sinew_effect_remove(sinew_effect effect);
/// Takes all effects of a character away.
SINEW_API sinew_status sinew_character_remove_effects(sinew_character character);

#endif
