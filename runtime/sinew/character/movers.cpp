#include "sinew/character/movers.h"

#include "sinew/character/world_impl.h"

namespace sinew {

template <class T>
int member_count(const World<T>& world) {
  return static_cast<int>(WorldInternals<T>::of(world).states.size());
}

template <class T>
double reach_of(const World<T>& world, int character) {
  return double(WorldInternals<T>::of(world).character(character)->radius);
}

template <class T>
bool moves_by_itself(const World<T>& world, int member, T h, MovingBall& out) {
  const CharacterState<T>& s = *WorldInternals<T>::of(world).states[std::size_t(member)];
  if (s.parked || s.levels.asleep || (!s.is_prop && s.undisturbed())) return false;
  const T travels = s.is_prop ? h * s.history.velocity[0].norm() : T(0);
  out = {s.middle().template cast<double>(), double(s.radius + travels)};
  return true;
}

SINEW_MOVERS_INSTANCES(template, float)
SINEW_MOVERS_INSTANCES(template, double)

}  // namespace sinew
