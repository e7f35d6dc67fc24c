// What an asset and its characters take in memory, as `sinew info` reports it.
#pragma once

#include "convert/convert.h"

namespace sinew::cli {

/// Bytes of heap: "skeleton" and "clips", once per rig; "character", what one more character adds to a world
/// in float (solver's share included); "snapshot", the most that its state takes as flat bytes. Measured by
/// making them; zeros where the heap cannot be read (address sanitizer).
nlohmann::json memory_of(const Asset& asset);

}  // namespace sinew::cli
