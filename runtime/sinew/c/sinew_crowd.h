/// @file
/// Many characters of one skeleton on their clips, of whom a few at a time are in a world: those who were
/// pushed, whose muscles do not suffice, or whom one of these may touch. Part of sinew.h.
///
///     sinew_world street;
///     sinew_crowd_create(asset, NULL, NULL, NULL, &street);
///     for (int i = 0; i < 1000; ++i) sinew_crowd_play(street, &tracks[i], 1);
///     …each frame:
///     sinew_world_step(street, 1 / 60.f);
///     sinew_crowd_copy_models(street, models, 1000 * joints, &count);
///
/// Everybody else is sampled and checked in batches and costs about as much as playback. Props that are
/// awake, and characters of the world's own that are not on their animation, call in whom they may touch;
/// what rests, obstacles, and two who play their clips into each other do not. The world is one as others
/// are: with props, obstacles, contacts, snapshots, and characters of its own beside the crowd. Its steps are
/// not recorded: that is refused with SINEW_UNSUPPORTED.
#ifndef SINEW_C_SINEW_CROWD_H
#define SINEW_C_SINEW_CROWD_H

#ifndef SINEW_C_SINEW_H
#error "include sinew/c/sinew.h"
#endif

// ---- Crowds ----

/// Of a crowd.
typedef struct sinew_crowd_settings {
  uint32_t size;     ///< bytes of this struct, as the caller knows it
  int32_t capacity;  ///< characters, 1 to 65536
  int32_t places;    ///< of them that may be in the world at once, 1 to 4096 and the capacity; each takes
                     ///< memory
  int32_t lanes;     ///< characters of a batch: 8, 16, or 0 for what this processor does best
  int32_t chunks;    ///< that a frame is divided into for the host's threads, 1 to 4096: a few per thread
} sinew_crowd_settings;

/// What one of a crowd plays.
typedef struct sinew_crowd_track {
  int32_t character;  ///< below the capacity
  int32_t clip;       ///< of the crowd's asset
  double time;        ///< s, of the clip, finite; steps move it on
  double rate;        ///< s of the clip per s
  sinew_pose place;   ///< clip to world, within 1e6 m
} sinew_crowd_track;

/// Where one of a crowd stands.
typedef struct sinew_crowd_member {
  uint32_t size;              ///< bytes of this struct, as the caller knows it
  sinew_level level;          ///< what it needed lately; SINEW_LEVEL_CHECKED outside of the world
  sinew_character character;  ///< while it is in the world, else 0; the place is another's afterwards
  float peak_load;            ///< largest torque / limit of its clip's frame, the root's left out
  int32_t unused;             ///< 0
} sinew_crowd_member;

/// Of the last step.
typedef struct sinew_crowd_report {
  uint32_t size;        ///< bytes of this struct, as the caller knows it
  int32_t in_world;     ///< characters that are in the world
  int32_t turned_away;  ///< that were called for and found no place: they stay on their clips
} sinew_crowd_report;

/// Fills in the defaults: 1000 characters, 64 places.
SINEW_API sinew_status sinew_crowd_settings_init(sinew_crowd_settings* settings);
/// A world with a crowd of the asset's skeleton, which plays its clips; nobody is there before he plays.
/// NULL: the defaults; `character` are those in the world. Destroy it as any world. The asset's handle may
/// go before.
SINEW_API sinew_status sinew_crowd_create(sinew_asset asset, const sinew_crowd_settings* settings,
                                          const sinew_world_settings* world,
                                          const sinew_character_settings* character, sinew_world* out);
/// From now on they play this; who was in the world leaves it. Where one is refused, sinew_last_index() says
/// which; those before it play.
SINEW_API sinew_status sinew_crowd_play(sinew_world world, const sinew_crowd_track* tracks, int32_t count);
/// It is gone: out of the world, in its rest pose, until it plays again.
SINEW_API sinew_status sinew_crowd_stop(sinew_world world, int32_t character);
/// impulse[3] (N s, world) on the body of a joint, at the joint, in the next step. SINEW_OUT_OF_RANGE where
/// the world has no place left.
SINEW_API sinew_status sinew_crowd_push(sinew_world world, int32_t character, int32_t joint,
                                        const double* impulse);
/// Of all its muscles, at least 0, infinity: never overloaded; on its clip and in the world, until it is
/// stopped.
SINEW_API sinew_status sinew_crowd_set_strength(sinew_world world, int32_t character, float strength);
/// What it plays, at the time (s) that it is at; refused of one that plays nothing.
SINEW_API sinew_status sinew_crowd_get_track(sinew_world world, int32_t character, sinew_crowd_track* out);
/// [3] m/s, world, of its root, as its clip moves it.
SINEW_API sinew_status sinew_crowd_get_root_velocity(sinew_world world, int32_t character, float out[3]);
/// Of one that plays.
SINEW_API sinew_status sinew_crowd_get_member(sinew_world world, int32_t character, sinew_crowd_member* out);
/// Of the crowd as a whole.
SINEW_API sinew_status sinew_crowd_get_report(sinew_world world, sinew_crowd_report* out);
/// Frames of joints to the world, of one: `data` is sinew_transform, [joint]. Valid until the next step.
SINEW_API sinew_status sinew_crowd_get_model(sinew_world world, int32_t character, sinew_view* out);
/// The same of all, [character][joint], those who play nothing at their rest pose. `count`: how many
/// transforms there are; SINEW_TOO_SMALL where `capacity` is less.
SINEW_API sinew_status sinew_crowd_copy_models(sinew_world world, sinew_transform* out, int32_t capacity,
                                               int32_t* count);

#endif
