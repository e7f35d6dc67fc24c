// What is where in a world: rays, spheres and capsules that are cast through it, and what one overlaps.
//
//     Cast ray;
//     ray.from = eye;
//     ray.motion = 50 * look;                       // m
//     ray.filter.without_character = hero;
//     std::array<QueryHit, 1> nearest;
//     int count = 0;
//     Status status = cast(world, ray, nearest, count);
//     if (count > 0) mark(nearest[0].position, nearest[0].normal);
//
// Everything is met as it stands after the last step: the ground, obstacles, the host's shapes, and the
// colliders of characters, props and particles. Answers come in double, from distances to the same shapes
// that contacts are found with. A cast goes along by the tangent of the distance, which is convex: it arrives
// within 1e-8 m, with the normal there (on a capsule's axis, at a place within micrometres). Only in the
// host's shapes (StaticShape), whose distances are what the host says, it looks every two centimetres near
// them, and at their half thickness if that is less, and then closes in on the surface; a capsule meets them
// at points of its axis, a radius apart, as contacts do.
//
// Obstacles are looked up in the world's grid; of everybody else one ball each is looked at: O(characters +
// props + obstacles near the way). Allocates nothing. Not by two threads at once, unless Character::model()
// of everybody has been asked for since the step, nor during a step.
#pragma once

#include <cstdint>
#include <span>

#include "sinew/character/body_ref.h"
#include "sinew/skeleton/status.h"
#include "sinew/skeleton/vector.h"

namespace sinew {

template <class T>
class World;

/// What a query passes by.
struct QueryFilter {
  /// Meets only what has one of these bits in its layers (CharacterSettings::layers, PropSettings::layers,
  /// World::add_obstacle); the ground and particles have the first.
  std::uint32_t layers = ~0u;
  bool ground = true;          ///< false: passes through WorldSettings::ground
  bool obstacles = true;       ///< false: through all of World::add_obstacle(), the host's shapes, too
  bool characters = true;      ///< false: through all characters
  bool props = true;           ///< false: through all props
  bool particles = true;       ///< false: through all particle bodies
  int without_character = -1;  ///< index of one that it passes through; −1: none
  int without_prop = -1;       ///< likewise
  /// Asked last, where set: false passes a body through. Called for what is met only.
  bool (*accept)(void* context, const BodyRef& body) = nullptr;
  void* context = nullptr;  ///< what `accept` gets
};

/// A ray, a ball or a capsule, and where it goes.
struct Cast {
  Vec3<double> from = Vec3<double>::Zero();       ///< m, world; of its middle
  Vec3<double> motion = Vec3<double>::Zero();     ///< m, world: direction times length; overlap() ignores it
  double radius = 0;                              ///< m; 0: a ray
  Vec3<double> half_axis = Vec3<double>::Zero();  ///< m, of a capsule: from its middle to one end of its axis
  QueryFilter filter;                             ///< what it passes by
};

/// A collider that was met.
struct QueryHit {
  BodyRef body;       ///< whose it is
  int collider = -1;  ///< of Skeleton::colliders for characters, 0 for props and particles' nodes, else −1
  double distance = 0;                           ///< m that the cast has gone; 0 where it begins in it
  Vec3<double> position = Vec3<double>::Zero();  ///< m, world; on the surface of what was met
  Vec3<double> normal = Vec3<double>::UnitZ();   ///< unit, outwards there
  double depth = 0;  ///< m, how deep it is in that where it begins: of the point of its axis that is deepest
};

/// Writes the nearest hits into `hits`, nearest first, as many as it has room for; `count`: how many. Room
/// for one is the quickest. Every collider is met once, where the cast first touches it; what it begins in at
/// distance 0; what it begins at and leaves not at all. Refuses what is not finite, a negative radius, and a
/// cast that goes nowhere.
template <class T>
[[nodiscard]] Status cast(const World<T>& world, const Cast& query, std::span<QueryHit> hits, int& count);

/// Writes all colliders that the ball or capsule (or point) touches where it is into `hits`, deepest first,
/// as many as it has room for; `count`: how many.
template <class T>
[[nodiscard]] Status overlap(const World<T>& world, const Cast& query, std::span<QueryHit> hits, int& count);

#define SINEW_QUERY_INSTANCES(prefix, T)                                          \
  prefix Status cast<T>(const World<T>&, const Cast&, std::span<QueryHit>, int&); \
  prefix Status overlap<T>(const World<T>&, const Cast&, std::span<QueryHit>, int&);
SINEW_QUERY_INSTANCES(extern template, float)
SINEW_QUERY_INSTANCES(extern template, double)

}  // namespace sinew
