// Source clips as poses in time: where a scene's nodes are at an instant, and a clip as samples of a rig's
// joints, evenly in time or, where that passes by keys, at those.
#pragma once

#include <vector>

#include "convert/rig.h"

namespace sinew::convert {

/// [node] transforms to the scene, in its axes and unit, at rest or (with a clip) t seconds into it; scale
/// and shear included. Before the first key of a track its first counts, after the last its last.
std::vector<Eigen::Matrix4d> node_transforms(const import::SourceScene& scene, const import::SourceClip* clip,
                                             double t);

/// Nearest rigid transform: columns normalised, shear and mirror taken out. Without rotation where a column
/// has no length.
Transform<double> rigid(const Eigen::Matrix4d& m);

/// Samples a clip: local transforms of the rig's joints, m. Even samples at the rate of its keys (10 to
/// 120 Hz, 30 where it has none) or, where those pass by a key farther than half of `fit_error_mm`, samples
/// at its keys. `nodes`: [joint] its node in the scene, -1: none, it stays at rest. `to_model`: from the
/// scene's axes and unit to model space, m. Loops are found, and a reference pose that captures begin with is
/// left out; `report` gains "notes" of that and of what the samples miss. Errors if the clip has more samples
/// than can be converted (3e7 joints × frames).
Error sample_clip(const import::SourceScene& scene, const import::SourceClip& clip,
                  const std::vector<int>& nodes, const Eigen::Matrix4d& to_model, const Rig& rig,
                  const Options& options, Rig::Motion& out, nlohmann::json& report);

}  // namespace sinew::convert
