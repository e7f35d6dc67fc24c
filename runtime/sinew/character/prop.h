// A prop as the solver sees it: a skeleton of one free body. Internal to the character layer.
#pragma once

#include "sinew/character/world.h"

namespace sinew {

/// Of uniform density.
Skeleton skeleton_of(const PropSettings& prop);

}  // namespace sinew
