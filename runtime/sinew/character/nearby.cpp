#include "sinew/character/nearby.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace sinew {
namespace {

constexpr double kCreeps = 0.02;  ///< m/s of a human: ground that is slower counts as standing
constexpr double kSlides = 0.3;   ///< m/s of a human: a prop that is faster is no ground
constexpr double kAround = 0.1;   ///< m of a human, beyond what it reaches and moves by
constexpr double kBears = 1e-3;   ///< of all that points may bear

SignedDistance<double> distance_to(const Collider& collider, const Transform<double>& pose,
                                   const Vec3<double>& point) {
  SignedDistance<double> d =
      signed_distance<double>(collider.shape, collider.size, pose.inverse() * point, collider.hull);
  d.normal = pose.rotation * d.normal;
  return d;
}

SignedDistance<double> distance_to(const Collider& obstacle, const Vec3<double>& point) {
  return distance_to(obstacle, obstacle.local, point);
}

/// Of where it bears; `point` (m) from the common origin.
template <class T>
SignedDistance<double> distance_to(const MovingShape<T>& shape, const Vec3<double>& point) {
  return distance_to(*shape.to.collider, shape.ground().pose.template cast<double>(), point);
}

/// m: how far what is at `place` at the end of a step has come in it.
template <class T>
Vec3<T> way_to(const Vec3<T>& place, const PlacedCollider<T>& from, const PlacedCollider<T>& to) {
  return place - from.pose * (to.pose.inverse() * place);
}

/// Whether a place on the nth collider goes along with what moves: nearer to its way than to standing still.
template <class T>
bool goes_along(const Nearby<T>& nearby, std::size_t n, const Vec3<T>& place, const MovingShape<T>& shape) {
  const Vec3<T> ground = way_to(place, shape.from, shape.to);
  const Vec3<T> own = way_to(place, nearby.before[n], nearby.after[n]);
  return (own - ground).norm() <= own.norm() + nearby.creeps;
}

template <class T>
const Nearby<T>& nearby_of(const void* surroundings) {
  return *static_cast<const Nearby<T>*>(surroundings);
}

template <class T>
bool near(const void* surroundings, const Vec3<T>& point, T reach) {
  const Nearby<T>& nearby = nearby_of<T>(surroundings);
  const Vec3<double> from_origin = (nearby.root + point).template cast<double>();
  const Vec3<double> at = nearby.origin + from_origin;
  const auto most = double(reach);
  const auto within = [most](const auto& all, auto distance) {
    return std::any_of(all.begin(), all.end(), [&](const auto& o) { return distance(o) < most; });
  };
  return at.z() - nearby.floor < most ||
         within(nearby.obstacles, [&](const Collider* o) { return distance_to(*o, at).distance; }) ||
         within(nearby.hosts, [&](const HostObstacle& o) { return o.shape->distance(at).distance; }) ||
         within(nearby.moving, [&](const MovingShape<T>& o) { return distance_to(o, from_origin).distance; });
}

/// From a little above the point: what an animation presses into the edge of a step stands on it.
template <class T>
GroundUnder<T> under(const void* surroundings, const Vec3<T>& center,
                     const typename SupportPoints<T>::Point& point) {
  const Nearby<T>& nearby = nearby_of<T>(surroundings);
  const Vec3<T> place = nearby.root + center;
  const Vec3<double> at = nearby.origin + place.template cast<double>();
  const double radius = double(point.radius), lift = SupportSettings{}.reach * double(nearby.unit);
  GroundUnder<T> nearest;
  if (std::isfinite(nearby.floor)) {
    nearest.gap = T(at.z() - nearby.floor - radius);
    nearest.friction = point.friction * T(nearby.floor_friction);
  }
  const auto look = [&](const SignedDistance<double>& d, double friction) {
    const T gap = T(d.distance - lift * d.normal.z() - radius);
    if (d.normal.z() < kGroundLevel || !(gap < nearest.gap)) return false;
    nearest = {gap, d.normal.template cast<T>(), std::sqrt(point.friction * T(friction))};
    return true;
  };
  const Vec3<double> up = lift * Vec3<double>::UnitZ();
  for (const Collider* o : nearby.obstacles) look(distance_to(*o, at + up), o->friction);
  for (const HostObstacle& o : nearby.hosts) look(o.shape->distance(at + up), o.friction);
  for (const MovingShape<T>& o : nearby.moving)
    if (o.bears && look(distance_to(o, place.template cast<double>() + up), o.to.collider->friction))
      nearest.moving = static_cast<int>(&o - nearby.moving.data());
  return nearest;
}

bool kept_apart(std::span<const BodyPair> apart, int a, int b) {
  return std::any_of(apart.begin(), apart.end(), [&](const BodyPair& p) {
    return (p.state_a == a && p.state_b == b) || (p.state_a == b && p.state_b == a);
  });
}

/// Into `out`, the bodies at the target.
template <class T>
void place_at(CharacterState<T>& s, const std::vector<JointJet<T>>& target, const Vec3<double>& origin,
              std::vector<PlacedCollider<T>>& out) {
  out.clear();
  for (int i = 0; i < s.tree.bodies; ++i) s.problem.target[i] = {target[i].rotation, target[i].translation};
  place_colliders<T>(s, s.problem.target, target[0].translation.template cast<double>(), origin, out);
}

template <class T>
void place_now(CharacterState<T>& s, const Vec3<double>& origin, std::vector<PlacedCollider<T>>& out) {
  out.clear();
  place_colliders<T>(s, s.local, s.history.place, origin, out);
}

/// Appends what is driven as a whole, as its target has it.
template <class T>
void add_carrier(CharacterState<T>& carrier, Nearby<T>& out) {
  const std::size_t first = out.moving.size();
  place_now(carrier, out.origin, out.others);
  for (const PlacedCollider<T>& from : out.others) out.moving.push_back({&carrier, from, from});
  place_at(carrier, carrier.target, out.origin, out.others);
  const JointJet<T>&root = carrier.target[0], &before = carrier.last_target()[0];
  const Vec3<T> turned = rotation_log<T>(before.rotation.conjugate() * root.rotation);
  const Vec3<T> omega = rate_at_end<T>(turned, root.omega - out.h * root.alpha, root.omega, out.h);
  const Vec3<T> velocity = rate_at_end<T>(root.translation - before.translation,
                                          root.velocity - out.h * root.acceleration, root.velocity, out.h);
  const Vec3<double> place = root.translation.template cast<double>() - out.origin;
  for (std::size_t c = 0; c < out.others.size(); ++c) {
    MovingShape<T>& shape = out.moving[first + c];
    shape.to = out.others[c];
    shape.spin = root.rotation * omega;
    shape.velocity = velocity + shape.spin.cross(shape.to.pose.translation - place.template cast<T>());
  }
}

/// Appends a prop or another figure, that is solved or played beside it and in whose way it may be.
template <class T>
void add_other(CharacterState<T>& other, const Vec3<T>& gravity, Nearby<T>& out) {
  place_now(other, out.origin, out.now);
  out.others.clear();
  predict_colliders<T>(other, out.now, out.origin, gravity, out.h, out.others);
  for (std::size_t c = 0; c < out.now.size(); ++c) {
    MovingShape<T>& shape = out.moving.emplace_back(MovingShape<T>{&other, out.now[c], out.others[c]});
    if (!other.is_prop) continue;
    const Vec3<T> arm = shape.from.pose.translation - other.guessed.center[0];
    const Vec3<T> slides = other.history.velocity[0] + angular_velocity(other.history, 0).cross(arm);
    shape.slides = slides.template head<2>().norm();
  }
}

/// m, from a point to a shape's way.
template <class T>
T distance_to_way(const MovingShape<T>& shape, const Vec3<T>& point) {
  const Vec3<T> from = shape.from.pose.translation, way = shape.to.pose.translation - from;
  const T square = way.squaredNorm();
  const T along = square > T(0) ? std::clamp((point - from).dot(way) / square, T(0), T(1)) : T(0);
  return (from + along * way - point).norm();
}

/// What carries among the members, and who else is touched, within `reach` (m) of `center` (m, from the
/// common origin).
template <class T>
void find_moving(const CharacterState<T>& s, const Surroundings& around, const Members<T>& members,
                 const Vec3<T>& gravity, const Vec3<T>& center, T reach, Nearby<T>& out) {
  const auto touched = [&](const CharacterState<T>& other) {
    return std::find(members.touched.begin(), members.touched.end(), &other) != members.touched.end();
  };
  const auto self = std::find(members.states.begin(), members.states.end(), &s) - members.states.begin();
  for (std::size_t n = 0; n < members.states.size(); ++n) {
    CharacterState<T>& other = *members.states[n];
    if (&other == &s || !s.may_meet(other) ||
        kept_apart(around.apart, members.indices[static_cast<std::size_t>(self)], members.indices[n]))
      continue;
    if (other.is_carrier())
      add_carrier(other, out);
    else if (touched(other) && !other.is_particles)
      add_other(other, gravity, out);
  }
  std::erase_if(out.moving,
                [&](const MovingShape<T>& o) { return distance_to_way(o, center) > reach + o.to.radius; });
}

/// Whether a collider meets a prop on it: is above it where the two have met, and was not below before.
template <class T>
bool meets_from_above(const PlacedCollider<T>& from, const PlacedCollider<T>& to,
                      const MovingShape<T>& prop) {
  return distance_between(to, prop.to).normal.z() > T(kGroundLevel) &&
         distance_between(from, prop.from).normal.z() > -T(kGroundLevel);
}

/// Whether colliders on their way push what gives way, or it them: a figure, or a prop other than from above.
template <class T>
bool push(const ColliderPaths<T>& paths, const MovingShape<T>& shape) {
  if (shape.of->is_carrier()) return false;
  for (std::size_t n = 0; n < paths.to.size(); ++n) {
    const ColliderPaths<T> one{paths.from.subspan(n, 1), paths.to.subspan(n, 1)};
    if (touch_on_the_way<T>(one, {{&shape.from, 1}, {&shape.to, 1}}, T(0)) &&
        !(shape.of->is_prop && meets_from_above(paths.from[n], paths.to[n], shape)))
      return true;
  }
  return false;
}

/// The places of points of the nth collider, that is `placed`: any(place, point), until one is true.
template <class T, class Any>
bool any_point(const CharacterState<T>& s, std::size_t n, const PlacedCollider<T>& placed, Any any) {
  const Transform<T> body = placed.pose * s.colliders[n].local.inverse().template cast<T>();
  for (int k = s.first_point[n]; k < s.first_point[n + 1]; ++k) {
    const ContactPoint<T>& point = s.points[static_cast<std::size_t>(k)];
    if (point.meets_plane() && any(Vec3<T>(body * point.local), point)) return true;
  }
  return false;
}

/// Whether something that would stand on what moves goes along with it: of who rides, whatever it does there.
template <class T>
bool carries(const CharacterState<T>& s, const Nearby<T>& nearby, const MovingShape<T>& shape) {
  if (!shape.of->is_prop && !shape.of->is_carrier()) return false;
  if (shape.of->is_prop) return shape.slides < T(kSlides) * nearby.unit / s.tree.scale.time;
  if (s.grounding.rides) return true;
  const auto reach = T(SupportSettings{}.reach) * nearby.unit;
  for (std::size_t n = 0; n < nearby.after.size(); ++n) {
    const PlacedCollider<T>& placed = nearby.after[n];
    const auto distance = [&](const Vec3<T>& place) {
      return T(distance_to(shape, place.template cast<double>()).distance);
    };
    if (distance(placed.pose.translation) > placed.radius + reach) continue;
    const auto goes = [&](const Vec3<T>& place, const ContactPoint<T>& point) {
      return distance(place) - point.radius < reach && goes_along(nearby, n, place, shape);
    };
    if (any_point(s, n, placed, goes)) return true;
  }
  return false;
}

/// Whether colliders end deeper than `depth` in a shape of the host's, or pass within reach of it faster than
/// it is thick (`thin`, m). By their middles and points.
template <class T>
bool goes_into(const CharacterState<T>& s, const ColliderPaths<T>& paths, const Vec3<double>& origin,
               const StaticShape& shape, T depth, T thin) {
  const auto distance = [&](const Vec3<T>& place) {
    return T(shape.distance(origin + place.template cast<double>()).distance);
  };
  for (std::size_t n = 0; n < paths.to.size(); ++n) {
    const PlacedCollider<T>& to = paths.to[n];
    const T middle = distance(to.pose.translation);
    if (middle > to.radius) {
      const T way = (to.pose.translation - paths.from[n].pose.translation).norm();
      if (way > thin && middle < to.radius + way) return true;
      continue;
    }
    const auto deep = [&](const Vec3<T>& place, const ContactPoint<T>& point) {
      return distance(place) - point.radius < -depth;
    };
    if (any_point(s, n, to, deep)) return true;
  }
  return false;
}

}  // namespace

template <class T>
void look_around(CharacterState<T>& s, const WorldSettings& world, const Surroundings& around,
                 const Members<T>& members, T h, Nearby<T>& out) {
  out.clear();
  const bool statics = s.settings.ground_contact && (!around.obstacles.empty() || !around.hosts.empty());
  const bool others = world.body_contact && members.states.size() > 1;
  if (!statics && !others) return;
  out.h = h;
  out.origin = s.history.place;
  out.unit = s.tree.scale.length;
  out.creeps = T(kCreeps) * h * out.unit / s.tree.scale.time;
  out.floor = world.ground && s.settings.ground_contact ? world.ground_height
                                                        : -std::numeric_limits<double>::infinity();
  out.floor_friction = world.ground_friction;
  out.base = around.floor;
  out.weight = s.total_mass * world.gravity.norm();
  out.root = (s.target[0].translation.template cast<double>() - out.origin).template cast<T>();
  const Vec3<double> center = s.local[0].translation.template cast<double>();
  const T goes = std::max(2 * h * s.history.velocity[0].norm(),
                          T((s.target[0].translation - s.local[0].translation).norm()));
  const T reach = s.radius + T(kAround) * out.unit + goes;
  if (statics && !around.obstacles.empty())
    around.grid->overlapping(center, double(reach), [&](int o) {
      const Collider& obstacle = around.obstacles[static_cast<std::size_t>(o)];
      if (distance_to(obstacle, center).distance < double(reach)) out.obstacles.push_back(&obstacle);
    });
  if (statics && std::any_of(around.hosts.begin(), around.hosts.end(), [&](const HostObstacle& o) {
        return o.shape->distance(center).distance < double(reach);
      }))
    out.hosts = around.hosts;
  if (!others) return;
  find_moving<T>(s, around, members, world.gravity.template cast<T>(),
                 (center - out.origin).template cast<T>(), reach, out);
}

template <class T>
bool is_in_the_way(CharacterState<T>& s, Nearby<T>& nearby) {
  if (!nearby.any()) return false;
  place_now(s, nearby.origin, nearby.now);
  place_at(s, s.target, nearby.origin, nearby.after);
  const ColliderPaths<T> paths{nearby.now, nearby.after};
  const T into_others = T(kPressedIntoOthers) * nearby.unit, pressed = T(kPressedByClips) * nearby.unit;
  const auto meets = [&](const PlacedCollider<T>& from, const PlacedCollider<T>& to, T most, double base) {
    const T thin = T(half_thickness_of(*from.collider, base, double(nearby.unit)));
    return touch_on_the_way<T>(paths, {{&from, 1}, {&to, 1}}, std::min(most, thin / 2));
  };
  constexpr double kNoFloor = -std::numeric_limits<double>::infinity();
  return std::any_of(nearby.obstacles.begin(), nearby.obstacles.end(),
                     [&](const Collider* o) {
                       Transform<double> pose = o->local;
                       pose.translation -= nearby.origin;
                       const PlacedCollider<T> placed{o, pose.cast<T>(), T(bounding_radius(*o))};
                       return meets(placed, placed, pressed, nearby.base);
                     }) ||
         std::any_of(nearby.moving.begin(), nearby.moving.end(),
                     [&](const MovingShape<T>& o) {
                       const T most = o.of->is_carrier() ? pressed : into_others;
                       return meets(o.from, o.to, most, kNoFloor) || push(paths, o);
                     }) ||
         std::any_of(nearby.hosts.begin(), nearby.hosts.end(), [&](const HostObstacle& o) {
           const T thin = T(o.shape->half_thickness());
           return goes_into(s, paths, nearby.origin, *o.shape, std::min(pressed, thin / 2), thin);
         });
}

template <class T>
const GroundProbe<T>* ground_under(CharacterState<T>& s, Nearby<T>& nearby) {
  if (!nearby.any() || !s.settings.ground_contact) return nullptr;
  if (!nearby.moving.empty()) {
    place_at(s, s.last_target(), nearby.origin, nearby.before);
    place_at(s, s.target, nearby.origin, nearby.after);
    for (MovingShape<T>& shape : nearby.moving) shape.bears = carries(s, nearby, shape);
  }
  nearby.under.assign(s.rig->support.points.size(), {});
  nearby.probe = {&nearby, nearby.under, near<T>, under<T>};
  return &nearby.probe;
}

template <class T>
void load_props(const Nearby<T>& nearby, std::span<const BearingPoint<T>> bearing) {
  for (const BearingPoint<T>& p : bearing) {
    const int moving = p.force.isZero(T(0)) ? -1 : nearby.under[static_cast<std::size_t>(p.point)].moving;
    if (moving < 0) continue;
    CharacterState<T>& prop = *nearby.moving[static_cast<std::size_t>(moving)].of;
    if (!prop.is_prop || prop.forces.size() == prop.forces.capacity()) continue;
    const Vec3<double> place = nearby.origin + (nearby.root + p.place).template cast<double>();
    const Vec3<T> arm = (place - prop.history.place).template cast<T>();
    prop.forces.push_back({0, prop.local[0].rotation.conjugate() * arm, -p.force});
  }
}

template <class T>
BearingGround ground_that_moves(const Nearby<T>& nearby, std::span<const StandingPoint<T>> standing) {
  BearingGround ground;
  double all = 0;
  const double reach = SupportSettings{}.reach * double(nearby.unit);
  for (std::size_t k = 0; k < nearby.under.size(); ++k) {
    const GroundUnder<T>& under = nearby.under[k];
    if (!(double(under.gap) < reach)) continue;
    const auto share = double(standing[k].share);
    const Vec3<double> place = nearby.origin + (nearby.root + standing[k].place).template cast<double>();
    all += share;
    ground.place += share * place;
    if (under.moving < 0) continue;
    const MovingShape<T>& shape = nearby.moving[static_cast<std::size_t>(under.moving)];
    const Vec3<T> arm = nearby.root + standing[k].place - shape.to.pose.translation;
    ground.velocity += share * (shape.velocity + shape.spin.cross(arm)).template cast<double>();
    ground.turn_rate += share * double(shape.spin.z());
  }
  if (!ground.moves() || !(all > kBears)) return {};
  ground.place /= all;
  ground.velocity /= all;
  ground.turn_rate /= all;
  ground.force = nearby.weight;
  return ground;
}

SINEW_NEARBY_INSTANCES(template, float)
SINEW_NEARBY_INSTANCES(template, double)

}  // namespace sinew
