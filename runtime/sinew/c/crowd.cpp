// Crowds of the C interface: worlds that step one.
#include <algorithm>
#include <cstring>
#include <memory>
#include <span>

#include "sinew/c/call.h"
#include "sinew/c/fields.h"
#include "sinew/c/layout.h"
#include "sinew/c/make_world.h"

namespace sinew::c {
namespace {

constexpr auto kSettings = [](auto& c, auto& s, auto&& f) {
  f("capacity must be 1 to 65536", c.capacity, s.crowd.capacity, 1, 65536);
  f("places must be 1 to 4096", c.places, s.places, 1, 4096);
  f("lanes must be 0, 8 or 16", c.lanes, s.crowd.lanes, 0, 16);
  f("chunks must be 1 to 4096", c.chunks, s.crowd.chunks, 1, 4096);
};

/// act(OwnedWorld&, Population&) in a world that has a crowd.
template <class Act>
sinew_status with_crowd(sinew_world world, Act&& act) noexcept {
  return with_world(world, [&](OwnedWorld& w) {
    return w.crowd ? act(w, *w.crowd) : fail(SINEW_INVALID_ARGUMENT, "the world has no crowd");
  });
}

/// act(OwnedWorld&, Population&) where it has that character, too.
template <class Act>
sinew_status with_member(sinew_world world, int32_t character, Act&& act) noexcept {
  return with_crowd(world, [&](OwnedWorld& w, Population& crowd) {
    return character >= 0 && character < crowd.capacity()
               ? act(w, crowd)
               : fail(SINEW_INVALID_ARGUMENT, "no such character", character);
  });
}

sinew_status play(const OwnedWorld& w, Population& crowd, const sinew_crowd_track& c) {
  const std::vector<Clip>& clips = w.crowd_asset->clips;
  if (c.clip < 0 || std::size_t(c.clip) >= clips.size())
    return fail(SINEW_INVALID_ARGUMENT, "no such clip", c.clip);
  Transform<double> place;
  FromC read;
  read("a place's rotation must be a unit quaternion, it must be within 1e6 m", c.place, place);
  if (read.status != SINEW_OK) return read.status;
  return answer(
      crowd.play(c.character, {&clips[std::size_t(c.clip)], {c.time, c.rate}, place.cast<float>()}));
}

/// The crowd's are the first of the world's characters.
std::unique_ptr<OwnedWorld> world_with(const std::shared_ptr<const Asset>& asset,
                                       std::unique_ptr<Population> crowd,
                                       const PopulationSettings& settings) {
  auto world = std::make_unique<OwnedWorld>(std::move(crowd));
  world->crowd_asset = asset;
  world->jets.resize(asset->skeleton.joints.size());
  world->behaviours.resize(std::size_t(settings.places));
  world->graphs.resize(std::size_t(settings.places));
  return world;
}

}  // namespace
}  // namespace sinew::c

using namespace sinew;
using namespace sinew::c;

sinew_status sinew_crowd_settings_init(sinew_crowd_settings* settings) {
  return init<PopulationSettings>(settings, kSettings);
}

sinew_status sinew_crowd_create(sinew_asset asset, const sinew_crowd_settings* settings,
                                const sinew_world_settings* world, const sinew_character_settings* character,
                                sinew_world* out) {
  return with_shared_asset(asset, [&](const std::shared_ptr<const Asset>& of) {
    if (!out) return fail(SINEW_INVALID_ARGUMENT, kNull);
    PopulationSettings read;
    WorldMake make;
    sinew_status status = SINEW_OK;  // sizes first: what the fields mean depends on them
    const auto has_size = [&](const auto* s) { return !s || (status = check_size(s)) == SINEW_OK; };
    if (!has_size(settings) || !has_size(world) || !has_size(character)) return status;
    status = read_settings(settings, read, kSettings);
    if (status == SINEW_OK) status = read_world_settings(world, make);
    if (status == SINEW_OK) status = read_character_settings(character, read.character);
    if (status != SINEW_OK) return status;
    read.world = make.world;
    Status made;
    std::unique_ptr<Population> crowd = Population::create(of->skeleton, read, made);
    return crowd ? hand_out(world_with(of, std::move(crowd), read), make, out) : answer(made);
  });
}

sinew_status sinew_crowd_play(sinew_world world, const sinew_crowd_track* tracks, int32_t count) {
  return with_crowd(world, [&](OwnedWorld& w, Population& crowd) {
    if (!tracks && count != 0) return fail(SINEW_INVALID_ARGUMENT, kNull);
    if (count < 0) return fail(SINEW_INVALID_ARGUMENT, "a number of tracks below 0", count);
    for (int32_t n = 0; n < count; ++n)
      if (const sinew_status status = play(w, crowd, tracks[n]); status != SINEW_OK)
        return failed_at(status, n);
    return sinew_status(SINEW_OK);
  });
}

sinew_status sinew_crowd_stop(sinew_world world, int32_t character) {
  return with_member(world, character,
                     [&](OwnedWorld&, Population& crowd) { return answer(crowd.stop(character)); });
}

sinew_status sinew_crowd_push(sinew_world world, int32_t character, int32_t joint, const double* impulse) {
  return with_member(world, character, [&](OwnedWorld&, Population& crowd) {
    if (!impulse) return fail(SINEW_INVALID_ARGUMENT, kNull);
    const Vec3<float> of = Eigen::Map<const Vec3<double>>(impulse).cast<float>();
    if (!of.allFinite()) return fail(SINEW_NOT_FINITE, "the impulse is not finite");
    return answer(crowd.push(character, joint, of));
  });
}

sinew_status sinew_crowd_set_strength(sinew_world world, int32_t character, float strength) {
  return with_member(world, character, [&](OwnedWorld&, Population& crowd) {
    return answer(crowd.set_strength(character, strength));
  });
}

sinew_status sinew_crowd_get_track(sinew_world world, int32_t character, sinew_crowd_track* out) {
  return with_member(world, character, [&](const OwnedWorld& w, Population& crowd) {
    if (!out) return fail(SINEW_INVALID_ARGUMENT, kNull);
    const CrowdTrack& track = crowd.crowd().track(character);
    if (!track.clip) return fail(SINEW_INVALID_ARGUMENT, "it plays nothing", character);
    const auto clip = static_cast<int32_t>(track.clip - w.crowd_asset->clips.data());
    *out = {character, clip, track.time.value, track.time.rate, {}};
    ToC{}("", out->place, track.place.cast<double>());
    return sinew_status(SINEW_OK);
  });
}

sinew_status sinew_crowd_get_root_velocity(sinew_world world, int32_t character, float* out) {
  return with_member(world, character, [&](OwnedWorld&, Population& crowd) {
    if (!out) return fail(SINEW_INVALID_ARGUMENT, kNull);
    std::copy_n(crowd.crowd().root_velocity(character).data(), 3, out);
    return sinew_status(SINEW_OK);
  });
}

sinew_status sinew_crowd_get_member(sinew_world world, int32_t character, sinew_crowd_member* out) {
  return with_member(world, character, [&](OwnedWorld&, Population& crowd) {
    return fill_sized(out, [&](sinew_crowd_member& m) {
      m.level = static_cast<sinew_level>(crowd.level(character));
      if (crowd.in_world(character)) m.character = handle_in(world, Kind::kCharacter, crowd.place(character));
      m.peak_load = crowd.crowd().peak_load(character);
    });
  });
}

sinew_status sinew_crowd_get_report(sinew_world world, sinew_crowd_report* out) {
  return with_crowd(world, [&](OwnedWorld&, Population& crowd) {
    return fill_sized(out, [&](sinew_crowd_report& r) {
      r.in_world = crowd.solved_count();
      r.turned_away = crowd.turned_away();
    });
  });
}

sinew_status sinew_crowd_get_model(sinew_world world, int32_t character, sinew_view* out) {
  return with_member(world, character, [&](OwnedWorld&, Population& crowd) {
    if (!out) return fail(SINEW_INVALID_ARGUMENT, kNull);
    const std::span<const Transform<float>> model = crowd.model(character);
    *out = {model.data(), static_cast<int32_t>(model.size()), static_cast<int32_t>(sizeof(Transform<float>))};
    return sinew_status(SINEW_OK);
  });
}

sinew_status sinew_crowd_copy_models(sinew_world world, sinew_transform* out, int32_t capacity,
                                     int32_t* count) {
  return with_crowd(world, [&](OwnedWorld& w, Population& crowd) {
    if (!count || (!out && capacity != 0)) return fail(SINEW_INVALID_ARGUMENT, kNull);
    if (capacity < 0) return fail(SINEW_INVALID_ARGUMENT, "the capacity is negative");
    const std::size_t joints = w.crowd_asset->skeleton.joints.size();
    const std::size_t all = joints * std::size_t(crowd.capacity());
    *count = static_cast<int32_t>(all);
    if (all > std::size_t(capacity))
      return fail(SINEW_TOO_SMALL, "room for fewer joints than the characters have");
    for (int n = 0; n < crowd.capacity(); ++n) {
      const std::span<const Transform<float>> model = crowd.model(n);
      std::memcpy(out + joints * std::size_t(n), static_cast<const void*>(model.data()), model.size_bytes());
    }
    return sinew_status(SINEW_OK);
  });
}
