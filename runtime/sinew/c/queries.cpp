// Casts and overlaps of the C interface.
#include "sinew/character/queries.h"

#include <algorithm>
#include <array>
#include <span>

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

/// The host's question, with the bodies that it knows.
struct Asked {
  sinew_accept accept;
  void* context;
};

bool ask(void* context, const BodyRef& body) {
  const auto& asked = *static_cast<const Asked*>(context);
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

sinew_status read_query(sinew_world world, const sinew_query* from, Cast& to, Asked& asked) {
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
    Asked asked{};
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
