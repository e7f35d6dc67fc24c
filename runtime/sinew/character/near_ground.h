// What a character on its animation may stand on besides the floor: obstacles and the host's shapes near it.
// Internal to the character layer.
#pragma once

#include "sinew/character/contact_finder.h"
#include "sinew/effects/support.h"

namespace sinew {

/// Static surroundings of one character, as a check asks about them.
template <class T>
struct NearGround {
  std::vector<const Collider*> obstacles;
  std::span<const HostObstacle> hosts;
  Vec3<double> origin = Vec3<double>::Zero();  ///< m, world: the common one
  double floor = 0;                            ///< m, world; −infinity: none
  double floor_friction = 1;
  T lift = T(0);         ///< m, from which ground is looked for below a point
  GroundProbe<T> probe;  ///< of this
};

/// Looks for what is near a character where its animation wants it. The probe, or null where there is nothing
/// but the floor. `room` for all obstacles; `around` must outlive what it holds.
template <class T>
const GroundProbe<T>* find_ground(const CharacterState<T>& state, const WorldSettings& world,
                                  const Surroundings& around, NearGround<T>& room);

extern template const GroundProbe<float>* find_ground<float>(const CharacterState<float>&,
                                                             const WorldSettings&, const Surroundings&,
                                                             NearGround<float>&);
extern template const GroundProbe<double>* find_ground<double>(const CharacterState<double>&,
                                                               const WorldSettings&, const Surroundings&,
                                                               NearGround<double>&);

}  // namespace sinew
