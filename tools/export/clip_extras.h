// What clips say beside their motion, as the converter reads it back from the extras of a glTF.
#pragma once

#include <nlohmann/json.hpp>

#include "sinew/io/asset.h"

namespace sinew::exporting {

/// Of an animation: `sinew` with loops, events, curves and markers, in the words of clip data
/// (tools/convert/README.md), and `contacts`, the windows in which joints rest on the ground.
nlohmann::json clip_extras(const Asset& asset, const Clip& clip);

/// Of the file: `sinew` with the curves' values at rest and the masks, or null where there are none.
nlohmann::json asset_extras(const Asset& asset);

}  // namespace sinew::exporting
