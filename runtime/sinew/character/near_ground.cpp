#include "sinew/character/near_ground.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace sinew {
namespace {

constexpr double kLevel = 0.5;  ///< cosine: what is steeper is no ground

template <class T>
const NearGround<T>& ground_of(const void* surroundings) {
  return *static_cast<const NearGround<T>*>(surroundings);
}

SignedDistance<double> distance_to(const Collider& obstacle, const Vec3<double>& point) {
  SignedDistance<double> d =
      signed_distance<double>(obstacle.shape, obstacle.size, obstacle.local.inverse() * point);
  d.normal = obstacle.local.rotation * d.normal;
  return d;
}

template <class T>
bool near(const void* surroundings, const Vec3<T>& point, T reach) {
  const NearGround<T>& ground = ground_of<T>(surroundings);
  const Vec3<double> at = ground.origin + point.template cast<double>();
  const auto most = double(reach);
  return at.z() - ground.floor < most ||
         std::any_of(ground.obstacles.begin(), ground.obstacles.end(),
                     [&](const Collider* o) { return distance_to(*o, at).distance < most; }) ||
         std::any_of(ground.hosts.begin(), ground.hosts.end(),
                     [&](const HostObstacle& o) { return o.shape->distance(at).distance < most; });
}

/// From a little above the point: what an animation presses into the edge of a step stands on it.
template <class T>
GroundUnder<T> under(const void* surroundings, const Vec3<T>& center,
                     const typename SupportPoints<T>::Point& point) {
  const NearGround<T>& ground = ground_of<T>(surroundings);
  const Vec3<double> at = ground.origin + center.template cast<double>();
  const auto radius = double(point.radius), lift = double(ground.lift);
  GroundUnder<T> nearest;
  if (std::isfinite(ground.floor)) {
    nearest.gap = T(at.z() - ground.floor - radius);
    nearest.friction = point.friction * T(ground.floor_friction);
  }
  const auto look = [&](const SignedDistance<double>& d, double friction) {
    const T gap = T(d.distance - lift * d.normal.z() - radius);
    if (d.normal.z() < kLevel || !(gap < nearest.gap)) return;
    nearest = {gap, d.normal.template cast<T>(), std::sqrt(point.friction * T(friction))};
  };
  const Vec3<double> above = at + lift * Vec3<double>::UnitZ();
  for (const Collider* o : ground.obstacles) look(distance_to(*o, above), o->friction);
  for (const HostObstacle& o : ground.hosts) look(o.shape->distance(above), o.friction);
  return nearest;
}

}  // namespace

template <class T>
const GroundProbe<T>* find_ground(const CharacterState<T>& s, const WorldSettings& world,
                                  const Surroundings& around, NearGround<T>& room) {
  room.obstacles.clear();
  if (!s.settings.ground_contact || (around.obstacles.empty() && around.hosts.empty())) return nullptr;
  const Vec3<double> center = s.target[0].translation.template cast<double>();
  const T lift = T(SupportSettings{}.reach) * s.tree.scale.length;
  const double reach = double(s.radius + lift);
  if (!around.obstacles.empty())
    around.grid->overlapping(center, reach, [&](int o) {
      const Collider& obstacle = around.obstacles[static_cast<std::size_t>(o)];
      if (distance_to(obstacle, center).distance < reach) room.obstacles.push_back(&obstacle);
    });
  const bool hosts = std::any_of(around.hosts.begin(), around.hosts.end(), [&](const HostObstacle& o) {
    return o.shape->distance(center).distance < reach;
  });
  if (room.obstacles.empty() && !hosts) return nullptr;
  room.hosts = hosts ? around.hosts : std::span<const HostObstacle>{};
  room.origin = center;
  room.floor = world.ground ? world.ground_height : -std::numeric_limits<double>::infinity();
  room.floor_friction = world.ground_friction;
  room.lift = lift;
  room.probe = {&room, near<T>, under<T>};
  return &room.probe;
}

template const GroundProbe<float>* find_ground<float>(const CharacterState<float>&, const WorldSettings&,
                                                      const Surroundings&, NearGround<float>&);
template const GroundProbe<double>* find_ground<double>(const CharacterState<double>&, const WorldSettings&,
                                                        const Surroundings&, NearGround<double>&);

}  // namespace sinew
