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

// What there is, by theme. Each part needs those before it.
// clang-format off
#include "sinew/c/sinew_hooks.h"
#include "sinew/c/sinew_asset.h"
#include "sinew/c/sinew_pose.h"
#include "sinew/c/sinew_world.h"
#include "sinew/c/sinew_character.h"
#include "sinew/c/sinew_behaviour.h"
#include "sinew/c/sinew_crowd.h"
#include "sinew/c/sinew_graph.h"
#include "sinew/c/sinew_clip.h"
#include "sinew/c/sinew_prop.h"
#include "sinew/c/sinew_effect.h"
#include "sinew/c/sinew_particles.h"
#include "sinew/c/sinew_query.h"
#include "sinew/c/sinew_snapshot.h"
// clang-format on

#ifdef __cplusplus
}
#endif

#endif
