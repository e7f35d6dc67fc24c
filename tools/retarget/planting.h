// The motion of a target: it follows the source, its feet are where its own legs carry them, and what stands
// on the floor stays where it stands.
#pragma once

#include "retarget/pose_map.h"
#include "retarget/sole.h"

namespace sinew::retarget {

struct Retargeted {
  Motion motion;                                ///< of the target; same frames as the source
  double floor = 0;                             ///< m, under the target
  Vec3<double> carried = Vec3<double>::Zero();  ///< m/s: how a clip that moves in place moves its floor past
  int unreachable = 0;                          ///< frames in which a limb had no plane to bend in
};

/// `contacts`: windows of source joints, s of the source's time (feet, toes, hands).
///
/// The hips travel as the source's, times the ratio of leg lengths; ankles stand relative to their hip joints
/// as the source's do, times the same; soles are as high above the floor as the source's, times the same.
/// With `plant`, soles are on the floor in their windows, and don't slide there: what a foot would slip by is
/// taken off its path, and given back while it is in the air. Hands do the same where they touch the floor,
/// and follow their arms elsewhere. Where legs would not reach, the hips are lower for a while. The floor is
/// z = 0 where the source's is near that, else the source's, times the ratio.
Retargeted retarget_motion(const PoseMap& map, const Motion& source, std::span<const ContactWindow> contacts,
                           bool plant);

}  // namespace sinew::retarget
