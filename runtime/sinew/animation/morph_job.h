// Morph targets: faces, correctives, anything that moves vertices by weights.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "sinew/skeleton/status.h"

namespace sinew {

/// Vertices one after the other.
struct MorphRun {
  std::uint32_t first = 0;  ///< vertex
  std::uint32_t count = 0;  ///< vertices
};

/// What a target does at weight 1, of the vertices that it touches alone: whole numbers, times a scale.
struct MorphTarget {
  std::vector<MorphRun> runs;       ///< by rising vertex, apart from each other
  std::vector<std::int16_t> moves;  ///< [touched vertex][3]
  float scale = 0;                  ///< m, of a unit of `moves`
  std::vector<std::int16_t> tilts;  ///< [touched vertex][3] of normals, or empty
  float tilt_scale = 0;             ///< of a unit of `tilts`
};

/// A target from deltas of all vertices, as files have them: `moves` [vertex][3] in m, `tilts` of the normals
/// as long, or empty. Vertices that move by less than `least` (m), and tilt by less than a thousandth, are
/// left out; gaps of up to three of them are bridged. Errors of the result: half a unit, 1/65534 of the
/// largest component. Allocates; for loading. Not finite: kNotFinite with the vertex as `Status::index`.
Status build_morph_target(std::span<const float> moves, std::span<const float> tilts, float least,
                          MorphTarget& out);

/// out = base + Σ weight · target, before skinning (whose inputs then are the outputs here). Weights may be
/// anything, also below 0 and above 1; those within 1e-4 of 0 cost nothing. They are curves of clips
/// (CurveJob), or the game's. Normals come out with unit length where a target touched them, if `normals`,
/// `out_normals` are given. Output shorter than the mesh means fewer vertices. Outputs may be the inputs.
/// Allocates nothing; cost grows with the vertices that active targets touch.
struct MorphJob {
  std::span<const float> positions;      ///< [vertex][3] m, base
  std::span<const float> normals = {};   ///< [vertex][3] unit, or empty
  std::span<const MorphTarget> targets;  ///< of this mesh
  std::span<const float> weights;        ///< [target]
  std::span<float> out_positions;        ///< [vertex][3] m
  std::span<float> out_normals = {};     ///< [vertex][3], or empty

  Status Validate() const;  ///< `Status::index`: target at fault
  Status Run() const;       ///< on an error the outputs are left as they were
};

}  // namespace sinew
