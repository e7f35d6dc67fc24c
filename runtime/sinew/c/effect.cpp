// Effects of the C interface: wind, water, fields of force, springs of joints.
#include "sinew/effects/effect.h"

#include <memory>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "sinew/c/call.h"
#include "sinew/c/fields.h"

namespace sinew::c {
namespace {

constexpr const char* kDensity = "density must be 0 to 1e6 kg/m3";

void list_fields(auto& c, auto& s, auto&& f, const WindSettings&) {
  f("velocity must be below 1e4 m/s", c.velocity, s.velocity, -1e4, 1e4);
  f(kDensity, c.density, s.density, 0, 1e6);
}

void list_fields(auto& c, auto& s, auto&& f, const BuoyancySettings&) {
  f("level must be within 1e6 m", c.level, s.level, -1e6, 1e6);
  f(kDensity, c.density, s.density, 0, 1e6);
  f("flow must be below 1e4 m/s", c.flow, s.flow, -1e4, 1e4);
  f("volume must be 0 to 1e6", c.volume, s.volume, 0, 1e6);
}

void list_fields(auto& c, auto& s, auto&& f, const ForceFieldSettings&) {
  f("center must be within 1e6 m", c.center, s.center, -1e6, 1e6);
  f("acceleration must be below 1e6 m/s2", c.acceleration, s.acceleration, -1e6, 1e6);
  f("reach must be 1e-3 to 1e6 m", c.reach, s.reach, 1e-3, 1e6);
}

void list_fields(auto& c, auto& s, auto&& f, const JointSpringSettings&) {
  f("stiffness must be 0 to 1e9", c.stiffness, s.stiffness, 0, 1e9);
  f("damping must be 0 to 1e9", c.damping, s.damping, 0, 1e9);
  f("rest must be within 1e3 rad or m", c.rest, s.rest, -1e3, 1e3);
}

constexpr auto kSettings = [](auto& c, auto& s, auto&& f) { list_fields(c, s, f, s); };

/// Indices that a caller names → names, as the C++ side takes them.
template <class C>
sinew_status read_joints(const C* from, const Skeleton& skeleton, std::vector<std::string>& to) {
  C all{};
  static_cast<void>(read_sized(from, all));
  if (all.joint_count < 0) return fail(SINEW_INVALID_ARGUMENT, "a number of joints below 0", all.joint_count);
  if (all.joint_count > 0 && !all.joints) return fail(SINEW_INVALID_ARGUMENT, kNull);
  for (int n = 0; n < all.joint_count; ++n) {
    if (all.joints[n] < 0 || all.joints[n] >= skeleton.body_count)
      return fail(SINEW_INVALID_ARGUMENT, "an effect on a joint that is not simulated", n);
    const std::string& name = skeleton.joints[std::size_t(all.joints[n])].name;
    if (skeleton.find(name.c_str()) != all.joints[n])
      return fail(SINEW_INVALID_ARGUMENT, "an effect on a joint whose name another one has", n);
    to.push_back(name);
  }
  return SINEW_OK;
}

/// Adds what add(effect, EffectId*) → Status adds.
template <class E, class C, class Add>
sinew_status add_effect(OwnedWorld& w, std::uint64_t handle, const C* settings, const Skeleton& skeleton,
                        sinew_effect* out, Add&& add) {
  if (!out) return fail(SINEW_INVALID_ARGUMENT, kNull);
  typename E::Settings read;
  if (const sinew_status s = read_settings(settings, read, kSettings); s != SINEW_OK) return s;
  if (const sinew_status s = read_joints(settings, skeleton, read.joints); s != SINEW_OK) return s;
  if (w.effects.size() == kMostInWorld)
    return fail(SINEW_OUT_OF_RANGE, "the world has had 1048576 effects already");
  w.effects.push_back({});
  auto effect = std::make_unique<E>(read);
  E* const address = effect.get();
  EffectId id;
  if (const Status status = add(std::move(effect), &id); !status) {
    w.effects.pop_back();
    return answer(status);
  }
  w.effects.back() = {id, address};
  *out = handle_in(world_of(handle), Kind::kEffect, static_cast<int>(w.effects.size()) - 1);
  return SINEW_OK;
}

template <class E, class C>
sinew_status add_to_character(sinew_character handle, const C* settings, sinew_effect* out) noexcept {
  const auto act = [&](OwnedWorld& w, const Character<float>& character) {
    return add_effect<E>(w, handle, settings, character.skeleton(), out,
                         [&](std::unique_ptr<E> effect, EffectId* id) {
                           return w.world.add_effect(index_of(handle), std::move(effect), id);
                         });
  };
  return with_character(handle, act, true);
}

template <class E, class C>
sinew_status add_to_prop(sinew_prop handle, const C* settings, sinew_effect* out) noexcept {
  return in_world(handle, Kind::kProp, true, [&](OwnedWorld& w) {
    const int index = index_of(handle);
    if (index >= w.world.prop_count()) return refuse(handle, Kind::kProp);
    return add_effect<E>(w, handle, settings, {}, out, [&](std::unique_ptr<E> effect, EffectId* id) {
      return w.world.add_prop_effect(index, std::move(effect), id);
    });
  });
}

/// act(OwnedWorld&, OwnedEffect&) of an effect that acts still.
template <class Act>
sinew_status with_effect(sinew_effect handle, Act&& act) noexcept {
  return in_world(handle, Kind::kEffect, false, [&](OwnedWorld& w) {
    const auto index = std::size_t(index_of(handle));
    if (index >= w.effects.size() || !w.world.effect(w.effects[index].id))
      return refuse(handle, Kind::kEffect);
    return act(w, w.effects[index]);
  });
}

template <class E, class C>
sinew_status set(sinew_effect handle, const C* settings) noexcept {
  return with_effect(handle, [&](OwnedWorld&, OwnedEffect& owned) {
    if (!settings) return fail(SINEW_INVALID_ARGUMENT, kNull);
    // What the caller does not know of has its default, as when it was added. No names: nothing allocates.
    typename E::Settings read;
    if (const sinew_status s = read_settings(settings, read, kSettings); s != SINEW_OK) return s;
    E* const* const effect = std::get_if<E*>(&owned.effect);
    if (!effect) return fail(SINEW_INVALID_ARGUMENT, "the effect is of another kind");
    read.joints.swap((*effect)->settings.joints);
    std::swap(read, (*effect)->settings);
    return sinew_status(SINEW_OK);
  });
}

}  // namespace
}  // namespace sinew::c

using namespace sinew;
using namespace sinew::c;

sinew_status sinew_wind_init(sinew_wind* settings) {
  return init<WindSettings>(settings, kSettings);
}

sinew_status sinew_buoyancy_init(sinew_buoyancy* settings) {
  return init<BuoyancySettings>(settings, kSettings);
}

sinew_status sinew_force_field_init(sinew_force_field* settings) {
  return init<ForceFieldSettings>(settings, kSettings);
}

sinew_status sinew_joint_spring_init(sinew_joint_spring* settings) {
  return init<JointSpringSettings>(settings, kSettings);
}

sinew_status sinew_character_add_wind(sinew_character character, const sinew_wind* settings,
                                      sinew_effect* out) {
  return add_to_character<Wind<float>>(character, settings, out);
}

sinew_status sinew_character_add_buoyancy(sinew_character character, const sinew_buoyancy* settings,
                                          sinew_effect* out) {
  return add_to_character<Buoyancy<float>>(character, settings, out);
}

sinew_status sinew_character_add_force_field(sinew_character character, const sinew_force_field* settings,
                                             sinew_effect* out) {
  return add_to_character<ForceField<float>>(character, settings, out);
}

sinew_status sinew_character_add_joint_spring(sinew_character character, const sinew_joint_spring* settings,
                                              sinew_effect* out) {
  return add_to_character<JointSpring<float>>(character, settings, out);
}

sinew_status sinew_prop_add_wind(sinew_prop prop, const sinew_wind* settings, sinew_effect* out) {
  return add_to_prop<Wind<float>>(prop, settings, out);
}

sinew_status sinew_prop_add_buoyancy(sinew_prop prop, const sinew_buoyancy* settings, sinew_effect* out) {
  return add_to_prop<Buoyancy<float>>(prop, settings, out);
}

sinew_status sinew_prop_add_force_field(sinew_prop prop, const sinew_force_field* settings,
                                        sinew_effect* out) {
  return add_to_prop<ForceField<float>>(prop, settings, out);
}

sinew_status sinew_effect_set_wind(sinew_effect effect, const sinew_wind* settings) {
  return set<Wind<float>>(effect, settings);
}

sinew_status sinew_effect_set_buoyancy(sinew_effect effect, const sinew_buoyancy* settings) {
  return set<Buoyancy<float>>(effect, settings);
}

sinew_status sinew_effect_set_force_field(sinew_effect effect, const sinew_force_field* settings) {
  return set<ForceField<float>>(effect, settings);
}

sinew_status sinew_effect_set_joint_spring(sinew_effect effect, const sinew_joint_spring* settings) {
  return set<JointSpring<float>>(effect, settings);
}

sinew_status sinew_effect_remove(sinew_effect effect) {
  return with_effect(effect, [](OwnedWorld& w, OwnedEffect& owned) {
    owned.effect = {};
    return answer(w.world.remove_effect(owned.id));
  });
}

sinew_status sinew_character_remove_effects(sinew_character character) {
  return with_character(character, [&](OwnedWorld& w, const Character<float>&) {
    return answer(w.world.remove_effects(index_of(character)));
  });
}
