/// @file
/// Clips that are played without a graph: what happens in them, numbers that they move, inputs that do not
/// step. Part of sinew.h.
#ifndef SINEW_C_SINEW_CLIP_H
#define SINEW_C_SINEW_CLIP_H

#ifndef SINEW_C_SINEW_H
#error "include sinew/c/sinew.h"
#endif

// ---- Clips ----

/// A part of a clip that a frame passed. Fields mean what those of EventJob do.
typedef struct sinew_clip_passage {
  uint32_t size;     ///< bytes of this struct, as the caller knows it
  int32_t clip;      ///< of the asset
  double before;     ///< s, clip time at the last frame, not wrapped
  double now;        ///< s, clip time now: of a loop at most a thousand durations away
  int32_t starts;    ///< flag: the clip begins to play in this frame: `before` itself belongs to it
  int32_t unused;    ///< 0
  double step;       ///< s of real time between the two
  double weight;     ///< of the clip, 0 to 1
  double threshold;  ///< least weight for instants and beginnings: one of two footsteps; ends are always told
} sinew_clip_passage;

/// The library's defaults: nothing has passed.
SINEW_API sinew_status sinew_clip_passage_init(sinew_clip_passage* settings);
/// Events that a clip passed, in order: (before, now], played backwards [now, before). Frames that follow
/// each other tell of every event once, at any rate. 256 at most find room; `count`: how many there are, also
/// with SINEW_TOO_SMALL. Allocates nothing.
SINEW_API sinew_status sinew_asset_get_passed_events(sinew_asset asset, const sinew_clip_passage* settings,
                                                     sinew_graph_event* out, int32_t capacity,
                                                     int32_t* count);
/// Ends what a clip is in the middle of at a time (s), when it stops being played there: a beginning that was
/// told of is always followed by an end. `backwards` (flag): it came from later times.
SINEW_API sinew_status sinew_asset_get_ended_events(sinew_asset asset, int32_t clip, double time,
                                                    int32_t backwards, sinew_graph_event* out,
                                                    int32_t capacity, int32_t* count);
/// The asset's curves at a time (s) of a clip, as sinew_asset_find_curve numbers them; those that it does not
/// move rest. Time as of sinew_clip_sample. `count`: how many, also with SINEW_TOO_SMALL. Allocates nothing.
SINEW_API sinew_status sinew_asset_sample_curves(sinew_asset asset, int32_t clip, double time, double rate,
                                                 double rate_change, sinew_curve_value* out, int32_t capacity,
                                                 int32_t* count);
/// Moves an input `step` s on towards a goal that steps, so that value, rate and acceleration do not: for
/// weights, speeds and targets. Half of a step of the goal is done `half_life` s later; never beyond it from
/// rest. Exact for every step. `state`: the caller's; a value without rates begins there at rest.
SINEW_API sinew_status sinew_smooth(sinew_curve_value* state, float goal, float half_life, float step);

#endif
