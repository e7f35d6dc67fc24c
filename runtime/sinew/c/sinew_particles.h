/// @file
/// Strands, cloth and soft tissue: bodies of particles that hang on a joint, a prop or the world. Part of
/// sinew.h.
///
/// Free nodes are solved for together with the characters and props that they touch; fixed ones ride on the
/// frame and pull back on it.
#ifndef SINEW_C_SINEW_PARTICLES_H
#define SINEW_C_SINEW_PARTICLES_H

#ifndef SINEW_C_SINEW_H
#error "include sinew/c/sinew.h"
#endif

// ---- Particles ----

/// A strand, a cloth or soft tissue of a world; goes with it.
typedef uint64_t sinew_particles;

/// Hair, a rope, a tail: straight along `direction` from `root` at rest. Fields mean what those of
/// StrandSettings do.
typedef struct sinew_strand {
  uint32_t size;        ///< bytes of this struct, as the caller knows it
  int32_t particles;    ///< free ones, at equal distances, after the fixed node at the root, or two if it is
                        ///< clamped
  sinew_anchor frame;   ///< what it hangs on
  double root[3];       ///< m, in the frame's axes
  double direction[3];  ///< any length but 0
  double length;        ///< m
  double mass;          ///< kg, all of it
  double stretch;       ///< share of its length by which it gives under its own weight
  double bending;       ///< N m2
  double radius;        ///< m, of every node as others meet it; 0: passes through everything
  double friction;      ///< at least 0
  double damping;       ///< N s/m of every node against the air
  int32_t clamped;      ///< flag: leaves the root along `direction`; else it hangs on a pivot
  int32_t unused;       ///< 0
} sinew_strand;

/// Triangles that stretch and bend. Fields mean what those of ClothSettings do.
typedef struct sinew_cloth {
  uint32_t size;             ///< bytes of this struct, as the caller knows it
  int32_t node_count;        ///< of `positions`
  sinew_anchor frame;        ///< what it hangs on
  const double* positions;   ///< [node][3] m, at rest, in the frame's axes; copied
  const int32_t* triangles;  ///< [triangle][3] nodes; copied
  int32_t triangle_count;    ///< of `triangles`
  int32_t fixed_count;       ///< of `fixed`
  const int32_t* fixed;      ///< nodes that ride on the frame; copied
  double density;            ///< kg/m2
  double stretch;            ///< N/m: a strip pulled by so much per metre of width is twice as long
  double bending;            ///< N m
  double radius;             ///< m, of every node as others meet it; 0: passes through everything
  double friction;           ///< at least 0
  double damping;            ///< N s/m of every node against the air
} sinew_cloth;

/// Tetrahedra that keep their volume. Fields mean what those of SoftTissueSettings do.
typedef struct sinew_soft_tissue {
  uint32_t size;            ///< bytes of this struct, as the caller knows it
  int32_t node_count;       ///< of `positions`
  sinew_anchor frame;       ///< what it hangs on
  const double* positions;  ///< [node][3] m, at rest, in the frame's axes; copied
  const int32_t*
      tetrahedra;  ///< [tetrahedron][4] nodes, the fourth sees the others anticlockwise from outside
  int32_t tetrahedron_count;  ///< of `tetrahedra`
  int32_t fixed_count;        ///< of `fixed`
  const int32_t* fixed;       ///< nodes that ride on the frame; copied
  double density;             ///< kg/m3
  double young;               ///< Pa, stiffness against pulling
  double poisson;             ///< below 0.5
  double radius;              ///< m, of every node as others meet it; 0: passes through everything
  double friction;            ///< at least 0
  double damping;             ///< N s/m of every node against the air
} sinew_soft_tissue;

/// One node.
typedef struct sinew_particle {
  float position[3];  ///< m, world
  float velocity[3];  ///< m/s; of a fixed one 0
} sinew_particle;

/// The library's defaults.
SINEW_API sinew_status sinew_strand_init(sinew_strand* settings);
/// The library's defaults; nodes are none.
SINEW_API sinew_status sinew_cloth_init(sinew_cloth* settings);
/// The library's defaults; nodes are none.
SINEW_API sinew_status sinew_soft_tissue_init(sinew_soft_tissue* settings);
/// Set-up. It begins at rest where its frame is now. `settings` may be null: it hangs from the world's
/// origin.
SINEW_API sinew_status sinew_world_add_strand(sinew_world world, const sinew_strand* settings,
                                              sinew_particles* out);
/// Set-up. sinew_last_index(): the node or triangle at fault.
SINEW_API sinew_status sinew_world_add_cloth(sinew_world world, const sinew_cloth* settings,
                                             sinew_particles* out);
/// Set-up. sinew_last_index(): the node or tetrahedron at fault.
SINEW_API sinew_status sinew_world_add_soft_tissue(sinew_world world, const sinew_soft_tissue* settings,
                                                   sinew_particles* out);
/// The handle of an index, as contacts and queries tell it.
SINEW_API sinew_status sinew_world_get_particles(sinew_world world, int32_t index, sinew_particles* out);
/// Copies its nodes, in the order in which they were given, to out[capacity]. `count`: how many there are,
/// also with SINEW_TOO_SMALL.
SINEW_API sinew_status sinew_particles_get_nodes(sinew_particles particles, sinew_particle* out,
                                                 int32_t capacity, int32_t* count);
/// Back to rest in its frame, as after a teleport, with all nodes moving so [3] (m/s).
SINEW_API sinew_status sinew_particles_reset(sinew_particles particles, const float velocity[3]);
/// What the last step did with it.
SINEW_API sinew_status sinew_particles_get_report(sinew_particles particles, sinew_character_report* out);

#endif
