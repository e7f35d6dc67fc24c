// What is around a character on its animation: what it may run into, and stand on besides the floor.
// Internal to the character layer.
//
// Obstacles, the host's shapes and what is driven as a whole, as a platform, give way to nobody. Props that
// it touches do: of a character that nothing but the ground holds they may bear the weight, which the step
// then loads them with (load_props). Looked for once in a step, all of it serves both questions that decide
// whether the animation is played: whether it is in the way (is_in_the_way), and what it bears
// (ground_under).
#pragma once

#include "sinew/character/contact_finder.h"
#include "sinew/character/memory.h"
#include "sinew/character/world.h"
#include "sinew/effects/ground_balance.h"

namespace sinew {

constexpr double kGroundLevel = 0.5;  ///< cosine: what is steeper is no ground

/// A collider of what is driven as a whole, of a prop or of another figure, from the common origin, where a
/// step begins and where it ends.
template <class T>
struct MovingShape {
  CharacterState<T>* of = nullptr;
  PlacedCollider<T> from, to;
  /// Where it bears somebody. What has just been loaded is pressed into the floor at a speed that it does not
  /// go on with: props where they are.
  const PlacedCollider<T>& ground() const { return of->is_prop ? from : to; }
  Vec3<T> velocity = Vec3<T>::Zero(), spin = Vec3<T>::Zero();  ///< m/s where `to` is, rad/s; 0 of props
  T slides = T(0);                                             ///< m/s, a prop
  bool bears = false;                                          ///< see ground_under()
};

/// What is near one character in one step.
template <class T>
struct Nearby {
  T h = T(0);                                  ///< s
  Vec3<double> origin = Vec3<double>::Zero();  ///< m, world: the common one
  std::vector<const Collider*> obstacles;
  std::span<const HostObstacle> hosts;  ///< all, or none where none is near
  std::vector<MovingShape<T>> moving;
  double floor = 0;           ///< m, world; −infinity: none
  double floor_friction = 1;  ///< of the floor
  double base = 0;            ///< m, world: what stands there as a box goes on below it; −infinity: none
  double weight = 0;          ///< N, the character's
  T unit = T(1);              ///< see Scale::length
  T creeps = T(0);            ///< m: ground that goes no further in the step counts as standing
  Vec3<T> root = Vec3<T>::Zero();                ///< m: where the animation wants it
  GroundProbe<T> probe;                          ///< of this
  std::vector<GroundUnder<T>> under;             ///< [point] what the last check has found
  std::vector<PlacedCollider<T>> before, after;  ///< the character's own, by its last target and this one
  std::vector<PlacedCollider<T>> now, others;    ///< room

  void clear() {
    obstacles.clear();
    moving.clear();
    hosts = {};
  }
  bool any() const { return !obstacles.empty() || !hosts.empty() || !moving.empty(); }
  /// Set-up: for one of so many colliders and points among so many obstacles and colliders that move.
  void reserve(int colliders, int points, std::size_t among, std::size_t carried) {
    obstacles.reserve(among);
    moving.reserve(carried);
    under.reserve(static_cast<std::size_t>(points));
    for (auto* v : {&before, &after, &now, &others}) v->reserve(static_cast<std::size_t>(colliders));
  }
  std::size_t bytes() const {
    const auto sum = [](const auto&... v) { return (std::size_t{0} + ... + bytes_held(v)); };
    return obstacles.capacity() * sizeof(void*) + sum(moving, under, before, after, now, others);
  }
};

/// The members of an island and their numbers in the world; of these, those that somebody touches.
template <class T>
struct Members {
  std::span<CharacterState<T>* const> states;
  std::span<const int> indices;
  std::span<CharacterState<T>* const> touched;
};

/// Looks around for a character with its target set; `members` of its island, itself among them. What is
/// found must outlive `out`. O(log obstacles + what is near).
template <class T>
void look_around(CharacterState<T>& state, const WorldSettings& world, const Surroundings& around,
                 const Members<T>& members, T h, Nearby<T>& out);

/// Whether the animation goes into something of it on its way to the target, deeper than kPressedByClips
/// (kPressedIntoOthers), or pushes who or what gives way: a figure, or a prop but from above. O(colliders)
/// for each.
template <class T>
bool is_in_the_way(CharacterState<T>& state, Nearby<T>& nearby);

/// What a check asks about the ground; null where there is nothing but the floor. What moves bears somebody
/// only if a point on it goes along with it in the animation: on a walkway who stands still slides.
template <class T>
const GroundProbe<T>* ground_under(CharacterState<T>& state, Nearby<T>& nearby);

/// Loads props with what they bear of a character that was played, for one step: `bearing` [point] as the
/// check has left it. What a prop has no room for is dropped.
template <class T>
void load_props(const Nearby<T>& nearby, std::span<const BearingPoint<T>> bearing);

/// What bears a character that was played, if it moves: of the last check, which has left what stands
/// [point] behind. None else.
template <class T>
BearingGround ground_that_moves(const Nearby<T>& nearby, std::span<const StandingPoint<T>> standing);

#define SINEW_NEARBY_INSTANCES(prefix, T)                                                   \
  prefix void look_around<T>(CharacterState<T>&, const WorldSettings&, const Surroundings&, \
                             const Members<T>&, T, Nearby<T>&);                             \
  prefix bool is_in_the_way<T>(CharacterState<T>&, Nearby<T>&);                             \
  prefix const GroundProbe<T>* ground_under<T>(CharacterState<T>&, Nearby<T>&);             \
  prefix void load_props<T>(const Nearby<T>&, std::span<const BearingPoint<T>>);            \
  prefix BearingGround ground_that_moves<T>(const Nearby<T>&, std::span<const StandingPoint<T>>);
SINEW_NEARBY_INSTANCES(extern template, float)
SINEW_NEARBY_INSTANCES(extern template, double)

}  // namespace sinew
