// Linear blend skinning: vertices of a mesh under a pose.
#pragma once

#include <cstdint>
#include <span>

#include "sinew/skeleton/status.h"
#include "sinew/skeleton/transform.h"

namespace sinew {

/// Affine map with columns padded to four floats: y = axes[0]·x₀ + axes[1]·x₁ + axes[2]·x₂ + origin.
struct SkinMatrix {
  Eigen::Vector4f axes[3];  ///< columns of the linear part, 0 below
  Eigen::Vector4f origin;   ///< m, 0 below
};

/// What each joint does to vertices given in model space at the bind pose: model[i]·bind[i]⁻¹. All joint →
/// model, `palette` as long as the shorter of the two or shorter.
void skinning_palette(std::span<const Transform<float>> model, std::span<const Transform<float>> bind,
                      std::span<SkinMatrix> palette);

/// out = Σ weight · palette[joint] · vertex. Normals take the same matrices (exact for rigid joints) and are
/// normalised. Output shorter than the mesh means fewer vertices. Allocates nothing. Outputs may be the
/// inputs.
struct SkinningJob {
  std::span<const SkinMatrix> palette;    ///< of skinning_palette()
  int influences = 4;                     ///< per vertex
  std::span<const std::uint16_t> joints;  ///< [vertex][influence] index into the palette
  std::span<const float> weights;         ///< [vertex][influence] sum 1
  std::span<const float> positions;       ///< [vertex][3] m, at the bind pose
  std::span<const float> normals = {};    ///< [vertex][3] or empty
  std::span<float> out_positions;         ///< [vertex][3] m
  std::span<float> out_normals = {};      ///< [vertex][3] unit, or empty

  Status Validate() const;  ///< `Status::index`: vertex at fault
  Status Run() const;       ///< on an error the outputs are left as they were
};

}  // namespace sinew
