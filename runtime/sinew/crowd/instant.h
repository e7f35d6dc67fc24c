// What the characters of a batch play, as the sampling kernels want it. Internal to the crowd layer.
#pragma once

#include <span>

#include "sinew/crowd/crowd.h"
#include "sinew/crowd/kernels/sample.h"

namespace sinew {

/// Whether the batch kernels sample it: not what the host writes, nor a clip of more groups than they hold.
bool sampled_in_batches(const CrowdTrack& track);

/// Looks up where the tracks that take part are in their clips; the other lanes show one that does.
/// `takes_part`: at least one. O(lanes · groups).
void set_instant(std::span<const CrowdTrack> lanes, std::span<const std::uint8_t> takes_part,
                 crowd_kernels::Instant& instant);

}  // namespace sinew
