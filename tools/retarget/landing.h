// How well a clip stands: what its soles and knees do.
#pragma once

#include "retarget/pose_map.h"

namespace sinew::retarget {

/// Over all contact windows of a clip, looked at 120 times a second.
struct Landing {
  int windows = 0;
  double lowest = 0, highest = 0;  ///< m: of the soles' lowest points over the floor
  double slide = 0;                ///< m: furthest that a sole has moved over the floor within its window
  double beyond = 0;               ///< rad: furthest that a knee is beyond its range, over the whole clip
};

/// `floor`: height, m. `carried`: m/s, how a clip that moves in place moves its floor past. `size`: the leg's
/// length, m, for the width of the patch that a sole stands on (see patch_of).
Landing landing_of(const Clip& clip, const Skeleton& skeleton, const BodyMap& map, double floor,
                   const Vec3<double>& carried, double leg);

}  // namespace sinew::retarget
