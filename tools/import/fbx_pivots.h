// FBX pivots, offsets and pre-rotations come from assimp as helper nodes above their joint.
#pragma once

#include "import/source_scene.h"

namespace sinew::import {

/// Multiplies every helper node into the joint below it, animated ones key by key, and renumbers what refers
/// to nodes. Notes how many there were.
void fold_fbx_pivots(SourceScene& scene);

}  // namespace sinew::import
