// Names of the left and of the right side, and how one is found from the other.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace sinew {

/// The name of the same thing on the other side: LeftFoot → RightFoot, hand_l → hand_r, thigh.R → thigh.L,
/// LHip → RHip, leftarm → rightarm. Sides are whole words ("left", "right", "l", "r" in any case, between
/// signs, digits or changes of case) or the beginning of one ("leftarm"). A name without a side comes back as
/// it is. Allocates: for loading, not for a frame.
std::string mirrored_name(std::string_view name);

/// Which of `names` stands for the other side of names[index]: by `mirrored_name`, or else by the first
/// letter alone ("lfemur", "rfemur"). −1 if none does.
int find_mirrored(std::span<const std::string> names, int index);

/// What events of a clip are called while the clip is mirrored. Built once from the names of an asset.
struct EventMirror {
  std::vector<std::array<std::uint32_t, 2>> pairs;  ///< by rising first number; both ways round

  /// The number of the other side's event, or the number itself where there is none. O(log names).
  std::uint32_t operator()(std::uint32_t name) const;
};

/// From the names of an asset's events (Asset::event_names).
EventMirror mirror_events(std::span<const std::string> names);

}  // namespace sinew
