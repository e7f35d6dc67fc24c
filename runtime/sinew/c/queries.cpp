// Casts, overlaps and sensors of the C interface.
#include "sinew/character/queries.h"

#include <algorithm>
#include <array>
#include <memory>
#include <span>
#include <utility>

#include "sinew/c/body.h"
#include "sinew/c/call.h"
#include "sinew/c/fields.h"

namespace sinew::c {
namespace {

constexpr int kMostHits = 256;  ///< that a call tells at most; they lie on its stack

constexpr auto kQuery = [](auto& c, auto& s, auto&& f) {
  f("", c.layers, s.filter.layers);
  f("a query's place must be within 1e9 m", c.origin, s.from, -1e9, 1e9);
  f("a query's motion must be within 1e9 m", c.motion, s.motion, -1e9, 1e9);
  f("half_axis must be within 1e6 m", c.half_axis, s.half_axis, -1e6, 1e6);
  f("radius must be 0 to 1e6 m", c.radius, s.radius, 0, 1e6);
};

constexpr std::uint32_t bit(BodyKind kind) {
  return 1u << static_cast<unsigned>(kind);
}

bool ask(void* context, const BodyRef& body) {
  const auto& asked = *static_cast<const AskedAccept*>(context);
  const sinew_body met = body_of(body);
  return asked.accept(asked.context, &met) != 0;
}

/// Index of what a query passes through in this world; −1: nothing.
sinew_status find_without(sinew_world world, std::uint64_t handle, Kind kind, int& index) {
  if (handle == 0) return SINEW_OK;
  if (!find_object(handle, kind)) return refuse(handle, kind);
  if (world_of(handle) != world)
    return fail(SINEW_INVALID_ARGUMENT, "what the query passes through is elsewhere");
  index = index_of(handle);
  return SINEW_OK;
}

sinew_status read_query(sinew_world world, const sinew_query* from, Cast& to, AskedAccept& asked) {
  if (!from) return fail(SINEW_INVALID_ARGUMENT, kNull);
  if (const sinew_status s = read_settings(from, to, kQuery); s != SINEW_OK) return s;
  QueryFilter& filter = to.filter;
  filter.ground = (from->kinds & bit(BodyKind::kGround)) != 0;
  filter.obstacles = (from->kinds & (bit(BodyKind::kObstacle) | bit(BodyKind::kShape))) != 0;
  filter.characters = (from->kinds & bit(BodyKind::kCharacter)) != 0;
  filter.props = (from->kinds & bit(BodyKind::kProp)) != 0;
  filter.particles = (from->kinds & bit(BodyKind::kParticles)) != 0;
  asked = {from->accept, from->context};
  if (asked.accept) {
    filter.accept = ask;
    filter.context = &asked;
  }
  if (const sinew_status s =
          find_without(world, from->without_character, Kind::kCharacter, filter.without_character);
      s != SINEW_OK)
    return s;
  return find_without(world, from->without_prop, Kind::kProp, filter.without_prop);
}

sinew_hit hit_of(const QueryHit& from) {
  sinew_hit to{};
  to.body = body_of(from.body);
  to.collider = from.collider;
  to.distance = from.distance;
  for (int k = 0; k < 3; ++k) {
    to.position[k] = from.position[k];
    to.normal[k] = from.normal[k];
  }
  to.depth = from.depth;
  return to;
}

using Find = Status (*)(const World<float>&, const Cast&, std::span<QueryHit>, int&);

sinew_status query(sinew_world handle, const sinew_query* from, sinew_hit* out, int32_t capacity,
                   int32_t* count, Find find) noexcept {
  return with_world(handle, [&](OwnedWorld& w) {
    if (!count || (!out && capacity != 0)) return fail(SINEW_INVALID_ARGUMENT, kNull);
    if (capacity < 0) return fail(SINEW_INVALID_ARGUMENT, "the capacity is negative");
    Cast cast;
    AskedAccept asked;
    if (const sinew_status s = read_query(handle, from, cast, asked); s != SINEW_OK) return s;
    std::array<QueryHit, kMostHits> hits;
    int met = 0;
    const std::span<QueryHit> room = std::span(hits).first(std::size_t(std::min(capacity, kMostHits)));
    if (const Status status = find(w.world, cast, room, met); !status) return answer(status);
    std::transform(hits.begin(), hits.begin() + met, out, hit_of);
    *count = met;
    return sinew_status(SINEW_OK);
  });
}

/// act(OwnedSensor&) of a sensor.
template <class Act>
sinew_status with_sensor(sinew_sensor handle, Act&& act) noexcept {
  return in_world(handle, Kind::kSensor, false, [&](OwnedWorld& world) {
    const auto index = std::size_t(index_of(handle));
    return index < world.sensors.size() ? act(world, *world.sensors[index]) : refuse(handle, Kind::kSensor);
  });
}

/// Copies all of `from`, as `made` makes them, to a caller who has room.
template <class From, class To, class Make>
sinew_status copy_out(std::span<const From> from, To* out, int32_t capacity, int32_t* count, Make&& make) {
  if (!count || (!out && capacity != 0)) return fail(SINEW_INVALID_ARGUMENT, kNull);
  if (capacity < 0) return fail(SINEW_INVALID_ARGUMENT, "the capacity is negative");
  *count = static_cast<int32_t>(from.size());
  if (capacity < *count) return fail(SINEW_TOO_SMALL, "room for fewer bodies");
  std::transform(from.begin(), from.end(), out, make);
  return SINEW_OK;
}

}  // namespace
}  // namespace sinew::c

using namespace sinew;
using namespace sinew::c;

sinew_status sinew_world_get_count(sinew_world world, sinew_body_kind kind, int32_t* out) {
  return with_world(world, [&](const OwnedWorld& w) {
    if (!out) return fail(SINEW_INVALID_ARGUMENT, kNull);
    if (kind < SINEW_BODY_CHARACTER || kind > SINEW_BODY_PARTICLES)
      return fail(SINEW_INVALID_ARGUMENT, "characters, props and particles are counted", kind);
    *out = kind == SINEW_BODY_CHARACTER ? w.world.character_count()
           : kind == SINEW_BODY_PROP    ? w.world.prop_count()
                                        : w.world.particles_count();
    return sinew_status(SINEW_OK);
  });
}

sinew_status sinew_world_keep_apart(sinew_world world, const sinew_body* a, const sinew_body* b,
                                    int32_t apart) {
  return set_up(world, [&](OwnedWorld& w) {
    if (!a || !b) return fail(SINEW_INVALID_ARGUMENT, kNull);
    BodyRef of_a, of_b;
    if (!read_body(*a, of_a) || !read_body(*b, of_b))
      return fail(SINEW_INVALID_ARGUMENT, "no such kind of body");
    return answer(w.world.keep_apart(of_a, of_b, apart != 0));
  });
}

sinew_status sinew_query_init(sinew_query* query) {
  return fill_sized(query, [](sinew_query& all) {
    const Cast defaults;
    kQuery(all, defaults, ToC{});
    all.kinds = ~0u;
  });
}

sinew_status sinew_world_cast(sinew_world world, const sinew_query* query_, sinew_hit* out, int32_t capacity,
                              int32_t* count) {
  return query(world, query_, out, capacity, count, &cast<float>);
}

sinew_status sinew_world_overlap(sinew_world world, const sinew_query* query_, sinew_hit* out,
                                 int32_t capacity, int32_t* count) {
  return query(world, query_, out, capacity, count, &overlap<float>);
}

sinew_status sinew_world_add_sensor(sinew_world world, const sinew_query* query_, int32_t bodies,
                                    sinew_sensor* out) {
  return set_up(world, [&](OwnedWorld& w) {
    if (!out) return fail(SINEW_INVALID_ARGUMENT, kNull);
    if (bodies < 1 || bodies > 65536)
      return fail(SINEW_INVALID_ARGUMENT, "bodies must be 1 to 65536", bodies);
    if (w.sensors.size() >= kMostInWorld) return fail(SINEW_OUT_OF_RANGE, "too many sensors");
    auto made = std::make_unique<OwnedSensor>(std::size_t(bodies));
    Cast shape;
    if (const sinew_status s = read_query(world, query_, shape, made->asked); s != SINEW_OK) return s;
    made->sensor.shape = shape;
    w.sensors.push_back(std::move(made));
    *out = handle_in(world, Kind::kSensor, static_cast<int>(w.sensors.size()) - 1);
    return sinew_status(SINEW_OK);
  });
}

sinew_status sinew_sensor_place(sinew_sensor sensor, const sinew_query* query_) {
  return with_sensor(sensor, [&](const OwnedWorld&, OwnedSensor& s) {
    Cast shape;
    AskedAccept asked;
    if (const sinew_status status = read_query(world_of(sensor), query_, shape, asked); status != SINEW_OK)
      return status;
    s.asked = asked;
    if (shape.filter.accept) shape.filter.context = &s.asked;
    s.sensor.shape = shape;
    return sinew_status(SINEW_OK);
  });
}

sinew_status sinew_sensor_update(sinew_sensor sensor, int32_t* left_out) {
  return with_sensor(sensor, [&](const OwnedWorld& w, OwnedSensor& s) {
    const Status status = s.sensor.update(w.world);
    if (left_out) *left_out = s.sensor.left_out();
    return answer(status);
  });
}

sinew_status sinew_sensor_get_events(sinew_sensor sensor, sinew_sensor_event* out, int32_t capacity,
                                     int32_t* count) {
  return with_sensor(sensor, [&](const OwnedWorld&, const OwnedSensor& s) {
    return copy_out(s.sensor.events(), out, capacity, count, [](const SensorEvent& event) {
      return sinew_sensor_event{static_cast<sinew_contact_phase>(event.phase), body_of(event.body)};
    });
  });
}

sinew_status sinew_sensor_get_bodies(sinew_sensor sensor, sinew_body* out, int32_t capacity, int32_t* count) {
  return with_sensor(sensor, [&](const OwnedWorld&, const OwnedSensor& s) {
    return copy_out(s.sensor.bodies(), out, capacity, count, body_of);
  });
}
