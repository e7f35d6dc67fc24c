/// @file
/// Snapshots and recordings. Part of sinew.h.
#ifndef SINEW_C_SINEW_SNAPSHOT_H
#define SINEW_C_SINEW_SNAPSHOT_H

#ifndef SINEW_C_SINEW_H
#error "include sinew/c/sinew.h"
#endif

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

/// Where a byte of a snapshot belongs.
typedef struct sinew_snapshot_field {
  int32_t body;      ///< character or prop, in the order in which they were added; -1: the world
  int32_t unused;    ///< 0
  const char* name;  ///< lives for ever; "" where there is no such byte
} sinew_snapshot_field;

/// Writes flat bytes; of a crowd's world who plays what, too. `size`: how many were written, or, with
/// SINEW_TOO_SMALL, how many there may be at most: out = NULL and capacity 0 ask for it. Allocates nothing.
SINEW_API sinew_status sinew_world_save(sinew_world world, sinew_snapshot_part part, void* out,
                                        size_t capacity, size_t* size);
/// Refuses what sinew_world_save of a world set up the same way did not write, with nothing moved. Given the
/// same inputs it goes on to the bit.
SINEW_API sinew_status sinew_world_restore(sinew_world world, sinew_snapshot_part part, const void* bytes,
                                           size_t size);
/// What a byte of the state that sinew_world_save would write now stands for: where two machines differ.
/// SINEW_UNSUPPORTED of a world with a crowd.
SINEW_API sinew_status sinew_world_get_snapshot_field(sinew_world world, uint64_t byte,
                                                      sinew_snapshot_field* out);
/// From now on (begin: flag) steps are recorded, in the calling thread alone; or no more. Steps allocate
/// then.
SINEW_API sinew_status sinew_world_record(sinew_world world, int32_t begin);
/// The recording so far, to be copied before the next call for this world.
SINEW_API sinew_status sinew_world_get_recording(sinew_world world, sinew_view* out);
/// Repeats a recording in a world set up as the recorded one was, up to the first byte that differs.
SINEW_API sinew_status sinew_world_replay(sinew_world world, const void* bytes, size_t size,
                                          sinew_replay_report* out);

#endif
