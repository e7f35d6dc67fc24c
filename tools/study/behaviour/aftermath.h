// What became of somebody who was pushed, from recorded poses alone: nothing that a behaviour says of itself
// is read.
#pragma once

#include "scene/recording.h"

namespace sinew::study {

enum class Outcome {
  kStay,  ///< no foot was lifted
  kStep,
  kFall,
};

struct Aftermath {
  Outcome outcome = Outcome::kStay;
  int lifts = 0;           ///< of a foot, before a fall
  double lowest_root = 1;  ///< of the root's height in the first frame
  /// m, furthest that a foot slid while it bore on the ground, before a fall. Of the points that touch in two
  /// frames the one that moved least counts: a foot that rolls or turns about a point does not slide.
  double slip = 0;
};

/// Of a recording's first character, which stands in the first frame. It falls when its root comes below 0.6
/// of its height then, or anything but its feet touches the ground; a foot is lifted when foot and toes are
/// more than 2 cm over it. Without roles of both feet nothing is ever lifted.
Aftermath aftermath(const scene::Recording& recording);

/// m, furthest that any joint of the first characters of two recordings is from the other's in a frame, after
/// the second is moved over the ground and turned about the vertical to fit best.
double off_motion(const scene::Recording& is, const scene::Recording& wanted, int frame);

}  // namespace sinew::study
