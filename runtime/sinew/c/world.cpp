// Worlds of the C interface: settings, steps, reports.
#include <algorithm>
#include <cstring>
#include <memory>
#include <utility>

#include "sinew/c/call.h"
#include "sinew/c/fields.h"
#include "sinew/c/layout.h"
#include "sinew/c/make_world.h"
#include "sinew/effects/continuous_detection.h"
#include "sinew/effects/restitution.h"
#include "sinew/optimizer/presets.h"

namespace sinew::c {
namespace {

void list_surroundings(auto& c, auto& s, auto&& f) {
  auto& w = s.world;
  f("workers must be 1 to 256", c.workers, w.workers, 1, 256);
  f("gravity must be finite, below 1e4 m/s2", c.gravity, w.gravity, -1e4, 1e4);
  f("ground_height must be within 1e6 m", c.ground_height, w.ground_height, -1e6, 1e6);
  f("ground_friction must be 0 to 1000", c.ground_friction, w.ground_friction, 0, 1000);
  f("ground_restitution must be 0 to 1", c.ground_restitution, w.ground_restitution, 0, 1);
  f("", c.ground, w.ground);
  f("", c.body_contact, w.body_contact);
  f("", c.ground_support, w.ground_support);
  f("", c.batches, w.batches);
  f("", c.restitution, s.restitution);
  f("", c.continuous_detection, s.continuous_detection);
  f("island_dofs must be 1 to 1048576", c.island_dofs, w.island_dofs, 1, 1 << 20);
  f("memory_cap must be below 2^60", c.memory_cap, w.memory_cap, 0, 0x1p60);
}

/// Bounds are those within which a step ends, not those within which it makes sense.
void list_accuracy(auto& c, auto& a, auto&& f) {
  f("tolerance must be 1e-12 to 1 m", c.tolerance, a.tolerance, 1e-12, 1);
  f("max_iterations must be 1 to 1000", c.max_iterations, a.max_iterations, 1, 1000);
  f("substeps must be 1 to 64", c.substeps, a.substeps, 1, 64);
  f("max_splits must be 0 to 10", c.max_splits, a.max_splits, 0, 10);
  f("max_rotation must be 0 to 100 rad", c.max_rotation, a.max_rotation, 0, 100);
  f("shortest_part must be 1e-5 to 1 s", c.shortest_part, a.shortest_part, 1e-5, 1);
  f("max_passes must be 1 to 100000", c.max_passes, a.max_passes, 1, 100000);
  f("", c.estimate_error, a.estimate_error);
  f("sink_depth must be 1e-7 to 1 m", c.sink_depth, a.sink_depth, 1e-7, 1);
  f("contact_damping must be 0 to 100", c.contact_damping, a.contact_damping, 0, 100);
  f("stick_speed must be 1e-6 to 100 m/s", c.stick_speed, a.stick_speed, 1e-6, 100);
  f("limit_stiffness must be 1e-3 to 1e9 N m/rad", c.limit_stiffness, a.limit_stiffness, 1e-3, 1e9);
  f("limit_damping must be 0 to 10 s", c.limit_damping, a.limit_damping, 0, 10);
  f("return_time must be 1e-3 to 100 s", c.return_time, a.return_time, 1e-3, 100);
}

void list_detail(auto& c, auto& d, auto&& f) {
  f("dwell must be 0 to 1e6 s", c.dwell, d.dwell, 0, 1e6);
  f("sleep_after must be 0 to 1e6 s", c.sleep_after, d.sleep_after, 0, 1e6);
  f("sleep_speed must be 0 to 1e3 m/s", c.sleep_speed, d.sleep_speed, 0, 1e3);
  f("sleep_spin must be 0 to 1e3 rad/s", c.sleep_spin, d.sleep_spin, 0, 1e3);
  f("baked_decay must be 0 to 1e4 1/s", c.baked_decay, d.baked_decay, 0, 1e4);
  f("bake_every must be 1 to 1000000", c.bake_every, d.bake_every, 1, 1e6);
  f("budget must be at least 0", c.budget, d.budget.limit, 0);
}

void list_settings(auto& c, auto& s, auto&& f) {
  list_surroundings(c, s, f);
  list_accuracy(c, s.world.accuracy, f);
  list_detail(c, s.world.detail, f);
}

constexpr auto kSettings = [](auto& c, auto& s, auto&& f) { list_settings(c, s, f); };

/// Those in single precision, under the names that are documented: kCrowdPreset is another name of
/// kGamePreset.
constexpr std::pair<const char*, const Accuracy*> kPresets[] = {
    {kCinematicPreset.name, &kCinematicPreset.accuracy},
    {kGamePreset.name, &kGamePreset.accuracy},
    {"crowd", &kCrowdPreset.accuracy}};

/// Copies everybody's model(); `count`: how many joints there are.
bool copy_models(World<float>& world, std::span<sinew_transform> out, int& count) {
  std::size_t joints = 0;
  for (int n = 0; n < world.character_count(); ++n) {
    const std::span<const Transform<float>> model = world.character(n).model();
    if (joints + model.size() <= out.size())
      std::memcpy(&out[joints], static_cast<const void*>(model.data()), model.size_bytes());
    joints += model.size();
  }
  count = static_cast<int>(joints);
  return joints <= out.size();
}

}  // namespace

sinew_status read_world_settings(const sinew_world_settings* from, WorldMake& to) {
  const sinew_status status = read_settings(from, to, kSettings);
  if (status != SINEW_OK || !from) return status;
  sinew_world_settings all{};
  static_cast<void>(read_sized(from, all));
  to.world.detail.budget.clock = all.clock;
  to.world.detail.budget.clock_context = all.clock_context;
  return SINEW_OK;
}

sinew_status hand_out(std::unique_ptr<OwnedWorld> world, const WorldMake& settings, sinew_world* out) {
  Status status;
  if (settings.restitution) status = world->world.declare<Restitution>();
  if (status && settings.continuous_detection) status = world->world.declare<ContinuousDetection>();
  if (!status) return answer(status);
  const sinew_world handle = make_handle(Kind::kWorld, world.get());
  if (handle == 0) return fail(SINEW_OUT_OF_RANGE, kTooMany);
  static_cast<void>(world.release());  // the handle's now
  *out = handle;
  return SINEW_OK;
}

}  // namespace sinew::c

using namespace sinew;
using namespace sinew::c;

sinew_status sinew_world_settings_init(sinew_world_settings* settings) {
  return init<WorldMake>(settings, kSettings);
}

sinew_status sinew_world_settings_use_preset(sinew_world_settings* settings, const char* preset) {
  if (!settings || !preset) return fail(SINEW_INVALID_ARGUMENT, kNull);
  if (const sinew_status status = check_size(settings); status != SINEW_OK) return status;
  for (const auto& [name, accuracy] : kPresets) {
    if (std::strcmp(preset, name) != 0) continue;
    sinew_world_settings all{};
    std::memcpy(&all, settings, settings->size);
    list_accuracy(all, *accuracy, ToC{});
    write_sized(all, settings);
    return SINEW_OK;
  }
  return fail(SINEW_NOT_FOUND, "no preset of that name in single precision");
}

sinew_status sinew_world_create(const sinew_world_settings* settings, sinew_world* out) {
  if (!out) return fail(SINEW_INVALID_ARGUMENT, kNull);
  WorldMake read;
  if (const sinew_status status = read_world_settings(settings, read); status != SINEW_OK) return status;
  return caught([&] { return hand_out(std::make_unique<OwnedWorld>(read.world), read, out); });
}

sinew_status sinew_world_destroy(sinew_world world) {
  auto* const found = static_cast<OwnedWorld*>(find_object(world, Kind::kWorld));
  if (!found) return refuse(world, Kind::kWorld);
  if (found->busy.exchange(true, std::memory_order_acquire)) return fail(SINEW_BUSY, kBusy);
  const std::unique_ptr<OwnedWorld> gone(static_cast<OwnedWorld*>(retire_handle(world, Kind::kWorld)));
  return gone ? sinew_status(SINEW_OK) : refuse(world, Kind::kWorld);
}

sinew_status sinew_world_set_jobs(sinew_world world, sinew_run_tasks run, void* context) {
  return with_world(world, [&](OwnedWorld& w) {
    w.jobs = {run, context};
    return sinew_status(SINEW_OK);
  });
}

sinew_status sinew_world_step(sinew_world world, float h) {
  return in_world(world, Kind::kWorld, true, [&](OwnedWorld& w) {
    const Status stepped = w.crowd      ? w.crowd->step(h, w.jobs)
                           : w.recorder ? w.recorder->step(h)
                                        : w.world.step(h, w.jobs);
    if (stepped.ok()) w.feel();
    return answer(stepped);
  });
}

sinew_status sinew_world_get_report(sinew_world world, sinew_world_report* out) {
  return with_world(world, [&](OwnedWorld& w) {
    return fill_sized(out, [&](sinew_world_report& r) {
      const WorldReport& report = w.world.report();
      static_assert(sizeof r.characters == sizeof report.characters);
      r.capped = report.capped;
      r.cost = report.cost;
      r.forecast = report.forecast;
      std::copy(report.characters.begin(), report.characters.end(), r.characters);
    });
  });
}

sinew_status sinew_world_get_memory(sinew_world world, uint64_t* bytes) {
  return with_world(world, [&](OwnedWorld& w) {
    if (!bytes) return fail(SINEW_INVALID_ARGUMENT, kNull);
    *bytes = w.world.memory().total();
    return sinew_status(SINEW_OK);
  });
}

sinew_status sinew_world_copy_models(sinew_world world, sinew_transform* out, int32_t capacity,
                                     int32_t* count) {
  return with_world(world, [&](OwnedWorld& w) {
    if (!count || (!out && capacity != 0)) return fail(SINEW_INVALID_ARGUMENT, kNull);
    if (capacity < 0) return fail(SINEW_INVALID_ARGUMENT, "the capacity is negative");
    return copy_models(w.world, {out, std::size_t(capacity)}, *count)
               ? sinew_status(SINEW_OK)
               : fail(SINEW_TOO_SMALL, "room for fewer joints than the characters have");
  });
}
