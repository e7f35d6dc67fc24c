// Characters of the C interface that follow a graph.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <memory>
#include <span>

#include "sinew/c/call.h"
#include "sinew/c/event.h"
#include "sinew/c/fields.h"
#include "sinew/c/layout.h"
#include "sinew/graph/graph_recorder.h"

namespace sinew::c {
namespace {

constexpr auto kSettings = [](auto& c, auto& s, auto&& f) {
  f("events must be 0 to 65536", c.events, s.events, 0, 65536);
  f("place must be within 1e6 m", c.place[0], s.place[0], -1e6, 1e6);
  f("place must be within 1e6 m", c.place[1], s.place[1], -1e6, 1e6);
  f("heading must be within 1e6 rad", c.heading, s.heading, -1e6, 1e6);
  f("no such ground", c.ground, s.ground, SINEW_GROUND_LEVEL, SINEW_GROUND_HOST);
  f("", c.layers, s.layers);
  f("reach must be 1e-3 to 1e4 m", c.reach, s.reach, 1e-3, 1e4);
  f("", c.physics, s.physics);
};

/// act(GraphPlayer&, Character) of a character that follows a graph.
template <class Act>
sinew_status with_player(sinew_character handle, Act&& act) noexcept {
  return with_character(handle, [&](OwnedWorld& w, const Character<float>& character) {
    GraphPlayer* const player = w.graphs[std::size_t(index_of(handle))].get();
    if (!player) return fail(SINEW_INVALID_ARGUMENT, "the character follows no graph");
    return act(*player, character);
  });
}

/// act(GraphPlayer&, parameter) of a parameter that has a name.
template <class Act>
sinew_status with_named(sinew_character handle, const char* name, Act&& act) noexcept {
  return with_player(handle, [&](GraphPlayer& player, const Character<float>&) {
    if (!name) return fail(SINEW_INVALID_ARGUMENT, kNull);
    const int parameter = find_named(player.bound().graph.definition().parameters, name);
    return parameter < 0 ? fail(SINEW_NOT_FOUND, kNoName) : answer(act(player, parameter));
  });
}

/// Only a look or a foot may fail then: its node is Status::index.
sinew_status check_step(float h) noexcept {
  if (!std::isfinite(h)) return fail(SINEW_NOT_FINITE, "a graph's step must be finite");
  return h >= 0 && h <= 1 ? sinew_status(SINEW_OK)
                          : fail(SINEW_OUT_OF_RANGE, "a graph's step must be 0 to 1 s");
}

sinew_status play(sinew_character handle, float h) noexcept {
  return with_player(handle, [&](GraphPlayer& player, Character<float> character) {
    if (const sinew_status status = check_step(h); status != SINEW_OK) return status;
    const Status played = player.play(character, h);
    const Status set = character.set_target(player.jets());
    return answer(played ? set : played);
  });
}

/// The scratch of a graph that somebody in the world follows already, or a new one.
std::shared_ptr<GraphScratch<float>> scratch_for(const OwnedWorld& world, const BoundGraph& bound) {
  for (const auto& player : world.graphs)
    if (player && player->plays(bound)) return player->scratch();
  return std::make_shared<GraphScratch<float>>(bound.graph);
}

sinew_status add_player(OwnedWorld& world, int index, const std::shared_ptr<const BoundGraph>& bound,
                        const sinew_graph_settings* settings) {
  PlayerSettings read;
  if (const sinew_status s = read_settings(settings, read, kSettings); s != SINEW_OK) return s;
  std::unique_ptr<GraphPlayer>& player = world.graphs[std::size_t(index)];
  if (player) return fail(SINEW_INVALID_ARGUMENT, "the character follows a graph already");
  if (std::size_t(bound->graph.joint_count()) != world.world.character(index).local().size())
    return fail(SINEW_INVALID_ARGUMENT, "the graph's asset has not the character's number of joints");
  sinew_graph_settings all{};
  static_cast<void>(read_sized(settings, all));
  if (read.ground == SINEW_GROUND_HOST && !all.below) return fail(SINEW_INVALID_ARGUMENT, kNull);
  player = std::make_unique<GraphPlayer>(bound, scratch_for(world, *bound), read, world.world, index);
  player->ground = {read.ground, &world.world, read.layers, read.reach, all.below, all.context, {}};
  world.world.keep_with_state(player->block());
  return SINEW_OK;
}

}  // namespace
}  // namespace sinew::c

using namespace sinew;
using namespace sinew::c;

sinew_status sinew_graph_settings_init(sinew_graph_settings* settings) {
  return init<PlayerSettings>(settings, kSettings);
}

sinew_status sinew_character_add_graph(sinew_character character, sinew_graph graph,
                                       const sinew_graph_settings* settings) {
  return with_graph(graph, [&](const std::shared_ptr<const BoundGraph>& bound) {
    const auto add = [&](OwnedWorld& w, const Character<float>&) {
      return add_player(w, index_of(character), bound, settings);
    };
    return with_character(character, add, true);
  });
}

sinew_status sinew_character_play_graph(sinew_character character, float h) {
  return play(character, h);
}

sinew_status sinew_play_graphs(const sinew_graph_play* plays, int32_t count) {
  if (!plays && count != 0) return fail(SINEW_INVALID_ARGUMENT, kNull);
  if (count < 0) return fail(SINEW_INVALID_ARGUMENT, "a number of graphs below 0", count);
  for (int32_t n = 0; n < count; ++n)
    if (const sinew_status status = play(plays[n].character, plays[n].h); status != SINEW_OK)
      return failed_at(status, n);
  return SINEW_OK;
}

sinew_status sinew_character_sample_graph(sinew_character character, float h, sinew_jet* jets,
                                          int32_t count) {
  return with_player(character, [&](GraphPlayer& player, const Character<float>& c) {
    if (!jets) return fail(SINEW_INVALID_ARGUMENT, kNull);
    if (!aligned(jets)) return fail(SINEW_INVALID_ARGUMENT, kMisaligned);
    if (count < 0 || std::size_t(count) != player.jets().size())
      return fail(SINEW_INVALID_ARGUMENT, "not one jet per joint", count);
    if (const sinew_status status = check_step(h); status != SINEW_OK) return status;
    const Status status = player.play(c, h);
    std::copy(player.jets().begin(), player.jets().end(), jets_of(jets, count).begin());
    return answer(status);
  });
}

sinew_status sinew_character_set_parameter(sinew_character character, int32_t parameter, float value) {
  return with_player(character, [&](GraphPlayer& player, const Character<float>&) {
    return answer(player.parameters().set(parameter, value));
  });
}

sinew_status sinew_character_set_parameter_by_name(sinew_character character, const char* name, float value) {
  return with_named(character, name, [&](GraphPlayer& player, int parameter) {
    return player.parameters().set(parameter, value);
  });
}

sinew_status sinew_character_trigger(sinew_character character, int32_t parameter) {
  return with_player(character, [&](GraphPlayer& player, const Character<float>&) {
    return answer(player.parameters().trigger(parameter));
  });
}

sinew_status sinew_character_trigger_by_name(sinew_character character, const char* name) {
  return with_named(character, name, [&](GraphPlayer& player, int parameter) {
    return player.parameters().trigger(parameter);
  });
}

sinew_status sinew_character_get_parameter(sinew_character character, int32_t parameter,
                                           sinew_parameter_value* out) {
  return with_player(character, [&](GraphPlayer& player, const Character<float>&) {
    if (!out) return fail(SINEW_INVALID_ARGUMENT, kNull);
    if (!has(player.bound().graph.definition().parameters, parameter))
      return fail(SINEW_INVALID_ARGUMENT, kNoParameter, parameter);
    const TimeJet<float> x = player.parameters().filtered(parameter);
    *out = {player.parameters().goal(parameter), x.value, x.rate, x.acceleration};
    return sinew_status(SINEW_OK);
  });
}

sinew_status sinew_character_get_machine(sinew_character character, int32_t machine,
                                         sinew_machine_report* out) {
  return with_player(character, [&](GraphPlayer& player, const Character<float>&) {
    if (const sinew_status s = check_size(out); s != SINEW_OK) return s;
    GraphParameters<float> parameters = player.parameters();
    const int state = parameters.state(machine);
    if (state < 0) return fail(SINEW_INVALID_ARGUMENT, kNoMachine, machine);
    return fill_sized(out, [&](sinew_machine_report& r) {
      r.state = state;
      r.name = player.bound().graph.node(machine).states[std::size_t(state)].name.c_str();
      r.time = parameters.seconds_in_state(machine);
      r.fading = parameters.fading(machine);
    });
  });
}

sinew_status sinew_character_get_graph_place(sinew_character character, sinew_graph_place* out) {
  return with_player(character, [&](GraphPlayer& player, const Character<float>&) {
    if (!out) return fail(SINEW_INVALID_ARGUMENT, kNull);
    GraphParameters<float> parameters = player.parameters();
    const Vec3<double> place = parameters.place();
    const TravelVelocity<float> travel = parameters.travel();
    out->place[0] = place.x();
    out->place[1] = place.y();
    out->heading = parameters.heading();
    for (int k = 0; k < 3; ++k) {
      out->velocity[k] = travel.velocity[k];
      out->change[k] = travel.change[k];
    }
    return sinew_status(SINEW_OK);
  });
}

sinew_status sinew_character_put_graph(sinew_character character, const double* place, double heading) {
  return with_player(character, [&](GraphPlayer& player, const Character<float>&) {
    if (!place) return fail(SINEW_INVALID_ARGUMENT, kNull);
    for (const double x : {place[0], place[1], heading})
      if (!(std::abs(x) <= 1e6))
        return fail(std::isfinite(x) ? SINEW_OUT_OF_RANGE : SINEW_NOT_FINITE,
                    "place and heading must be within 1e6 m and rad");
    player.parameters().put({place[0], place[1], 0}, heading);
    return sinew_status(SINEW_OK);
  });
}

sinew_status sinew_character_set_grounds(sinew_character character, const sinew_jet* bodies, int32_t count) {
  return with_player(character, [&](GraphPlayer& player, const Character<float>&) {
    return read_grounds(bodies, count, player.ground.grounds);
  });
}

sinew_status sinew_character_get_graph_events(sinew_character character, sinew_graph_event* out,
                                              int32_t capacity, int32_t* count, int32_t* lost) {
  return with_player(character, [&](const GraphPlayer& player, const Character<float>&) {
    if (!count || (!out && capacity != 0)) return fail(SINEW_INVALID_ARGUMENT, kNull);
    if (capacity < 0) return fail(SINEW_INVALID_ARGUMENT, "the capacity is negative");
    const EventSink& events = player.events();
    *count = events.count;
    if (lost) *lost = events.lost;
    if (events.count > capacity) return fail(SINEW_TOO_SMALL, "room for fewer events");
    std::transform(events.hits.begin(), events.hits.begin() + events.count, out, event_of);
    return sinew_status(SINEW_OK);
  });
}

sinew_status sinew_character_get_graph_curves(sinew_character character, sinew_curve_value* out,
                                              int32_t capacity, int32_t* count) {
  return with_player(character, [&](const GraphPlayer& player, const Character<float>&) {
    if (!count || (!out && capacity != 0)) return fail(SINEW_INVALID_ARGUMENT, kNull);
    if (capacity < 0) return fail(SINEW_INVALID_ARGUMENT, "the capacity is negative");
    const std::span<const TimeJet<float>> curves = player.curves();
    *count = static_cast<int32_t>(curves.size());
    if (curves.size() > std::size_t(capacity)) return fail(SINEW_TOO_SMALL, "room for fewer curves");
    std::transform(curves.begin(), curves.end(), out, [](const TimeJet<float>& c) {
      return sinew_curve_value{c.value, c.rate, c.acceleration};
    });
    return sinew_status(SINEW_OK);
  });
}

sinew_status sinew_character_save_graph(sinew_character character, void* out, size_t capacity, size_t* size) {
  return with_player(character, [&](GraphPlayer& player, const Character<float>&) {
    if (!size || (!out && capacity != 0)) return fail(SINEW_INVALID_ARGUMENT, kNull);
    const std::span<const std::byte> block = player.block();
    *size = sizeof(SavedBlock) + block.size();
    if (capacity < *size) return fail(SINEW_TOO_SMALL, "room for fewer bytes than the graph remembers");
    const SavedBlock saved{player.bound().graph.hash(), digest_of(block)};
    std::memcpy(out, &saved, sizeof saved);
    std::memcpy(static_cast<std::byte*>(out) + sizeof saved, block.data(), block.size());
    return sinew_status(SINEW_OK);
  });
}

sinew_status sinew_character_restore_graph(sinew_character character, const void* bytes, size_t size) {
  return with_player(character, [&](GraphPlayer& player, const Character<float>&) {
    if (!bytes) return fail(SINEW_INVALID_ARGUMENT, kNull);
    const std::span<std::byte> block = player.block();
    SavedBlock saved;
    if (size != sizeof saved + block.size())
      return fail(SINEW_INVALID_ARGUMENT, "not what a character of this graph saved: another size");
    std::memcpy(&saved, bytes, sizeof saved);
    const std::span<const std::byte> from{static_cast<const std::byte*>(bytes) + sizeof saved, block.size()};
    if (saved.graph != player.bound().graph.hash())
      return fail(SINEW_INVALID_ARGUMENT, "saved by a character of another graph");
    if (saved.digest != digest_of(from)) return fail(SINEW_BAD_FILE, "what was saved is damaged");
    std::memcpy(block.data(), from.data(), from.size());
    return sinew_status(SINEW_OK);
  });
}
