// Characters of the C interface.
#include <algorithm>
#include <cstring>
#include <limits>

#include "sinew/c/call.h"
#include "sinew/c/fields.h"
#include "sinew/c/layout.h"
#include "sinew/c/make_world.h"
#include "sinew/c/report.h"
#include "sinew/character/physics_values.h"
#include "sinew/character/spare_acceleration.h"

namespace sinew::c {
namespace {

static_assert(int(Tone::kRigid) == SINEW_TONE_RIGID && int(Tone::kRelaxed) == SINEW_TONE_RELAXED &&
              int(Tone::kAlert) == SINEW_TONE_ALERT && int(Tone::kBraced) == SINEW_TONE_BRACED);

constexpr double kInfinity = std::numeric_limits<double>::infinity();

constexpr auto kSettings = [](auto& c, auto& s, auto&& f) {
  f("no such root drive", c.root, s.root);
  f("root_force must be at least 0", c.root_force, s.root_force, 0, kInfinity);
  f("root_torque must be at least 0", c.root_torque, s.root_torque, 0, kInfinity);
  f("help_force must be at least 0", c.help_force, s.help_force, 0, kInfinity);
  f("help_torque must be at least 0", c.help_torque, s.help_torque, 0, kInfinity);
  f("strength must be at least 0", c.strength, s.strength, 0, kInfinity);
  f("", c.ground_contact, s.ground_contact);
  f("", c.self_collision, s.self_collision);
  f("", c.layers, s.layers);
  f("no such level", c.most, s.detail.most);
  f("significance must be finite", c.significance, s.detail.significance);
  f("check_every must be 1 to 1000000", c.check_every, s.detail.check_every, 1, 1e6);
  f("", c.bake, s.detail.bake);
  f("no such tone", c.tone, s.tone);
  f("", c.meets, s.meets);
};

constexpr const char* kOutside = "no such character in this world";

template <class T>
sinew_view view_of(std::span<const T> span) {
  return {span.data(), static_cast<int32_t>(span.size()), static_cast<int32_t>(sizeof(T))};
}

sinew_view view_of(const Character<float>& character, sinew_view_kind kind) {
  switch (kind) {
    case SINEW_VIEW_MODEL:
      return view_of(character.model());
    case SINEW_VIEW_LOCAL:
      return view_of(character.local());
    case SINEW_VIEW_TORQUE:
      return view_of(character.torque());
    case SINEW_VIEW_LOAD:
      return view_of(character.load());
    case SINEW_VIEW_LIMIT:
      return view_of(character.limit());
    default:
      return view_of(character.unknown());
  }
}

sinew_status play(const sinew_play& play) noexcept {
  return with_character(play.character, [&](OwnedWorld& w, Character<float> character) {
    return with_asset(play.asset, [&](const Asset& asset) {
      const std::size_t joints = character.local().size();
      if (asset.skeleton.joints.size() != joints) return fail(SINEW_INVALID_ARGUMENT, kOtherSkeleton);
      const std::span<JointJet<float>> jets = std::span(w.jets).first(joints);
      const sinew_status status = sample(asset, play.clip, {play.time, play.rate, play.rate_change}, jets);
      return status == SINEW_OK ? answer(character.set_target(jets)) : status;
    });
  });
}

/// A hit or a load: apply(character, point, vector) at a place that is there.
template <class Apply>
sinew_status push(sinew_character handle, const double* point, const double* vector, Apply&& apply) noexcept {
  if (!point || !vector) return fail(SINEW_INVALID_ARGUMENT, kNull);
  const Vec3<float> at = Eigen::Map<const Vec3<double>>(point).cast<float>();
  const Vec3<float> of = Eigen::Map<const Vec3<double>>(vector).cast<float>();
  return with_character(handle, [&](OwnedWorld&, Character<float> c) { return answer(apply(c, at, of)); });
}

/// change(character) → Status.
template <class Change>
sinew_status change(sinew_character handle, Change&& change) noexcept {
  return with_character(handle, [&](OwnedWorld&, Character<float> c) { return answer(change(c)); });
}

/// The same where it may allocate.
template <class Change>
sinew_status change_set_up(sinew_character handle, Change&& change) noexcept {
  return with_character(
      handle, [&](OwnedWorld&, Character<float> c) { return answer(change(c)); }, true);
}

/// The same with a tone, if there is such.
template <class Change>
sinew_status change_tone(sinew_character handle, sinew_tone tone, Change&& change) noexcept {
  if (tone < SINEW_TONE_RIGID || tone > SINEW_TONE_BRACED)
    return fail(SINEW_INVALID_ARGUMENT, "no such tone", tone);
  return change_set_up(handle, [&](Character<float> c) { return change(c, Tone(tone)); });
}

}  // namespace

sinew_status read_character_settings(const sinew_character_settings* from, CharacterSettings& to) {
  return read_settings(from, to, kSettings);
}

}  // namespace sinew::c

using namespace sinew;
using namespace sinew::c;

sinew_status sinew_character_settings_init(sinew_character_settings* settings) {
  return init<CharacterSettings>(settings, kSettings);
}

sinew_status sinew_world_add_character(sinew_world world, sinew_asset asset,
                                       const sinew_character_settings* settings, sinew_character* out) {
  return set_up(world, [&](OwnedWorld& w) {
    if (!out) return fail(SINEW_INVALID_ARGUMENT, kNull);
    const auto* const of = static_cast<const OwnedAsset*>(find_object(asset, Kind::kAsset));
    if (!of) return refuse(asset, Kind::kAsset);
    const Skeleton& skeleton = of->asset->skeleton;
    CharacterSettings read;
    if (const sinew_status s = read_character_settings(settings, read); s != SINEW_OK) return s;
    w.jets.resize(std::max(w.jets.size(), skeleton.joints.size()));
    w.behaviours.resize(std::size_t(w.world.character_count()) + 1);
    w.graphs.resize(w.behaviours.size());
    Status status;
    const int index = w.world.add_character(skeleton, read, status);
    if (index >= 0) *out = handle_in(world, Kind::kCharacter, index);
    return answer(status);
  });
}

sinew_status sinew_world_get_character(sinew_world world, int32_t index, sinew_character* out) {
  return with_world(world, [&](OwnedWorld& w) {
    if (!out) return fail(SINEW_INVALID_ARGUMENT, kNull);
    if (!w.world.character(index).valid()) return fail(SINEW_INVALID_ARGUMENT, kOutside, index);
    *out = handle_in(world, Kind::kCharacter, index);
    return sinew_status(SINEW_OK);
  });
}

sinew_status sinew_play_clips(const sinew_play* plays, int32_t count) {
  if (!plays && count != 0) return fail(SINEW_INVALID_ARGUMENT, kNull);
  if (count < 0) return fail(SINEW_INVALID_ARGUMENT, "a number of clips below 0", count);
  for (int32_t n = 0; n < count; ++n)
    if (const sinew_status status = play(plays[n]); status != SINEW_OK) return failed_at(status, n);
  return SINEW_OK;
}

sinew_status sinew_character_set_target(sinew_character character, const sinew_jet* jets, int32_t count) {
  if (!jets) return fail(SINEW_INVALID_ARGUMENT, kNull);
  if (!aligned(jets)) return fail(SINEW_INVALID_ARGUMENT, kMisaligned);
  if (count < 0) return fail(SINEW_INVALID_ARGUMENT, "a number of jets below 0", count);
  return change(character, [&](Character<float> c) { return c.set_target(jets_of(jets, count)); });
}

sinew_status sinew_character_reset(sinew_character character) {
  return change(character, [](Character<float> c) { return c.reset(); });
}

sinew_status sinew_character_set_strength(sinew_character character, float strength) {
  return change(character, [&](Character<float> c) { return c.set_strength(strength); });
}

sinew_status sinew_character_get_strength(sinew_character character, float* out) {
  return with_character(character, [&](OwnedWorld&, const Character<float>& c) {
    if (!out) return fail(SINEW_INVALID_ARGUMENT, kNull);
    *out = c.strength();
    return sinew_status(SINEW_OK);
  });
}

sinew_status sinew_character_set_joint_strength(sinew_character character, int32_t joint, float strength) {
  return change(character, [&](Character<float> c) { return c.set_strength(joint, strength); });
}

sinew_status sinew_character_set_muscle_strength(sinew_character character, int32_t muscle, float strength) {
  return change(character, [&](Character<float> c) { return c.set_muscle_strength(muscle, strength); });
}

sinew_status sinew_character_set_group_strength(sinew_character character, const char* group,
                                                float strength) {
  if (!group) return fail(SINEW_INVALID_ARGUMENT, kNull);
  return change(character, [&](Character<float> c) { return c.set_group_strength(group, strength); });
}

sinew_status sinew_character_set_activation(sinew_character character, const float* activation,
                                            int32_t count) {
  if (!activation) return fail(SINEW_INVALID_ARGUMENT, kNull);
  if (count < 0) return fail(SINEW_INVALID_ARGUMENT, "a number of joints below 0", count);
  return change(character, [&](Character<float> c) {
    return c.set_activation(std::span(activation, static_cast<std::size_t>(count)));
  });
}

sinew_status sinew_character_set_self_collision(sinew_character character, sinew_self_collision collision) {
  if (collision < SINEW_SELF_COLLISION_AS_CREATED || collision > SINEW_SELF_COLLISION_OFF)
    return fail(SINEW_INVALID_ARGUMENT, "no such self collision", collision);
  return change(character,
                [&](Character<float> c) { return c.set_self_collision(SelfCollision(collision)); });
}

sinew_status sinew_character_set_tone(sinew_character character, sinew_tone tone) {
  return change_tone(character, tone, [&](Character<float> c, Tone t) { return c.set_tone(t); });
}

sinew_status sinew_character_set_joint_tone(sinew_character character, int32_t joint, sinew_tone tone) {
  return change_tone(character, tone, [&](Character<float> c, Tone t) { return c.set_tone(joint, t); });
}

sinew_status sinew_character_set_group_tone(sinew_character character, const char* group, sinew_tone tone) {
  if (!group) return fail(SINEW_INVALID_ARGUMENT, kNull);
  return change_tone(character, tone, [&](Character<float> c, Tone t) { return c.set_group_tone(group, t); });
}

sinew_status sinew_character_set_joint_stiffness(sinew_character character, int32_t joint, double stiffness,
                                                 double damping_ratio) {
  return change_set_up(character, [&](Character<float> c) {
    return c.set_tone(joint, Stiffness{stiffness, damping_ratio});
  });
}

sinew_status sinew_character_get_stiffness(sinew_character character, int32_t dof, double* stiffness,
                                           double* damping_ratio) {
  return with_character(character, [&](OwnedWorld&, const Character<float>& c) {
    if (!stiffness || !damping_ratio) return fail(SINEW_INVALID_ARGUMENT, kNull);
    if (dof < 0 || std::size_t(dof) >= c.torque().size())
      return fail(SINEW_INVALID_ARGUMENT, "no such degree of freedom", dof);
    const Stiffness of = c.tone(dof);
    *stiffness = of.stiffness;
    *damping_ratio = of.damping_ratio;
    return sinew_status(SINEW_OK);
  });
}

sinew_status sinew_character_get_muscle_torque(sinew_character character, int32_t muscle, float* out) {
  return with_character(character, [&](OwnedWorld&, Character<float> c) {
    if (!out) return fail(SINEW_INVALID_ARGUMENT, kNull);
    if (muscle < 0 || std::size_t(muscle) >= c.skeleton().muscles.size())
      return fail(SINEW_INVALID_ARGUMENT, "no such muscle", muscle);
    *out = c.muscle_torque(muscle);
    return sinew_status(SINEW_OK);
  });
}

sinew_status sinew_character_set_root_drive(sinew_character character, sinew_root_drive drive) {
  if (drive < SINEW_ROOT_KINEMATIC || drive > SINEW_ROOT_GROUNDED)
    return fail(SINEW_INVALID_ARGUMENT, "no such root drive", drive);
  return change(character, [&](Character<float> c) { return c.set_root_drive(RootDrive(drive)); });
}

sinew_status sinew_character_set_help(sinew_character character, double force, double torque) {
  return change(character, [&](Character<float> c) { return c.set_help(force, torque); });
}

sinew_status sinew_character_set_detail(sinew_character character, double significance, sinew_level most,
                                        int32_t check_every, int32_t bake) {
  if (most < SINEW_LEVEL_ASLEEP || most > SINEW_LEVEL_SUBSTEPS)
    return fail(SINEW_INVALID_ARGUMENT, "no such level", most);
  const CharacterDetail detail{significance, Level(most), check_every, bake != 0};
  return change(character, [&](Character<float> c) { return c.set_detail(detail); });
}

sinew_status sinew_character_get_detail(sinew_character character, double* significance, sinew_level* most,
                                        int32_t* check_every, int32_t* bake) {
  return with_character(character, [&](OwnedWorld&, const Character<float>& c) {
    if (!significance || !most || !check_every || !bake) return fail(SINEW_INVALID_ARGUMENT, kNull);
    const CharacterDetail& detail = c.detail();
    *significance = detail.significance;
    *most = static_cast<sinew_level>(detail.most);
    *check_every = detail.check_every;
    *bake = detail.bake;
    return sinew_status(SINEW_OK);
  });
}

sinew_status sinew_character_get_displacement(sinew_character character, double* out) {
  return with_character(character, [&](OwnedWorld&, const Character<float>& c) {
    if (!out) return fail(SINEW_INVALID_ARGUMENT, kNull);
    const Displacement by = c.displacement();
    out[0] = by.x;
    out[1] = by.y;
    out[2] = by.yaw;
    return sinew_status(SINEW_OK);
  });
}

sinew_status sinew_character_get_rise(sinew_character character, double* out) {
  return with_character(character, [&](OwnedWorld&, const Character<float>& c) {
    if (!out) return fail(SINEW_INVALID_ARGUMENT, kNull);
    *out = c.displacement().z;
    return sinew_status(SINEW_OK);
  });
}

sinew_status sinew_character_raise(sinew_character character, double further) {
  return change(character, [&](Character<float> c) { return c.displace({0, 0, 0, further}); });
}

sinew_status sinew_character_take_displacement(sinew_character character) {
  return change(character, [](Character<float> c) { return c.take_displacement(); });
}

sinew_status sinew_character_displace(sinew_character character, const double* further) {
  if (!further) return fail(SINEW_INVALID_ARGUMENT, kNull);
  return change(character, [&](Character<float> c) {
    return c.displace({further[0], further[1], further[2]});
  });
}

sinew_status sinew_character_ride(sinew_character character, const double* further) {
  if (!further) return fail(SINEW_INVALID_ARGUMENT, kNull);
  return change(character, [&](Character<float> c) {
    return c.ride({further[0], further[1], further[2], further[3]});
  });
}

sinew_status sinew_character_come_back(sinew_character character) {
  return change(character, [](Character<float> c) { return c.come_back(); });
}

sinew_status sinew_character_give_hand(sinew_character character) {
  return change(character, [](Character<float> c) { return c.give_hand(); });
}

sinew_status sinew_character_keep_out(sinew_character character, double most) {
  return change(character, [&](Character<float> c) { return c.keep_out(most); });
}

sinew_status sinew_character_apply_impulse(sinew_character character, int32_t joint, const double* point,
                                           const double* impulse) {
  return push(character, point, impulse,
              [&](Character<float> c, const Vec3<float>& at, const Vec3<float>& of) {
                return c.apply_impulse(joint, at, of);
              });
}

sinew_status sinew_character_apply_force(sinew_character character, int32_t joint, const double* point,
                                         const double* force) {
  return push(character, point, force, [&](Character<float> c, const Vec3<float>& at, const Vec3<float>& of) {
    return c.apply_force(joint, at, of);
  });
}

sinew_status sinew_character_park(sinew_character character, int32_t parked) {
  return with_character(character, [&](OwnedWorld& w, const Character<float>&) {
    const int index = index_of(character);
    return answer(parked != 0 ? w.world.park_character(index) : w.world.unpark_character(index));
  });
}

sinew_status sinew_character_get_parked(sinew_character character, int32_t* out) {
  return with_character(character, [&](const OwnedWorld& w, const Character<float>&) {
    if (!out) return fail(SINEW_INVALID_ARGUMENT, kNull);
    *out = w.world.parked(index_of(character));
    return sinew_status(SINEW_OK);
  });
}

sinew_status sinew_character_get_ground(sinew_character character, double* force, double* place,
                                        double* velocity, double* turn_rate) {
  return with_character(character, [&](OwnedWorld&, const Character<float>& c) {
    if (!force || !place || !velocity || !turn_rate) return fail(SINEW_INVALID_ARGUMENT, kNull);
    const BearingGround& ground = c.ground();
    *force = ground.force;
    std::copy_n(ground.place.data(), 3, place);
    std::copy_n(ground.velocity.data(), 3, velocity);
    *turn_rate = ground.turn_rate;
    return sinew_status(SINEW_OK);
  });
}

sinew_status sinew_character_get_report(sinew_character character, sinew_character_report* out) {
  return with_character(character, [&](OwnedWorld&, const Character<float>& c) {
    return fill_sized(out, [&](sinew_character_report& r) {
      fill_report(c.report(), r);
      r.on_animation = c.on_animation();
      Eigen::Map<Vec3<double>>(r.position) = c.position();
    });
  });
}

sinew_status sinew_character_get_physics(sinew_character character, sinew_physics* out) {
  return with_character(character, [&](OwnedWorld&, const Character<float>& c) {
    return fill_sized(out, [&](sinew_physics& p) {
      const PhysicsValues<float> v = physics_values<float>(c);
      p.tilt = v.tilt;
      p.face_up = v.face_up;
      p.height = v.height;
      p.load = v.load;
      p.off_animation = v.off_animation;
      p.contacts = v.contacts;
      p.contact_force = v.contact_force;
    });
  });
}

sinew_status sinew_character_get_motion(sinew_character character, sinew_jet* jets, int32_t count) {
  return with_character(character, [&](OwnedWorld&, const Character<float>& c) {
    if (!jets) return fail(SINEW_INVALID_ARGUMENT, kNull);
    if (!aligned(jets)) return fail(SINEW_INVALID_ARGUMENT, kMisaligned);
    if (count < 0 || std::size_t(count) != c.local().size())
      return fail(SINEW_INVALID_ARGUMENT, "not one jet per joint", count);
    physical_motion<float>(c, jets_of(jets, count));
    return sinew_status(SINEW_OK);
  });
}

sinew_status sinew_character_get_spare_acceleration(sinew_character character, float* out, int32_t count) {
  return with_character(character, [&](OwnedWorld&, const Character<float>& c) {
    if (!out) return fail(SINEW_INVALID_ARGUMENT, kNull);
    if (count < 0 || std::size_t(count) != c.local().size())
      return fail(SINEW_INVALID_ARGUMENT, "not one number per joint", count);
    spare_acceleration<float>(c, {out, std::size_t(count)});
    return sinew_status(SINEW_OK);
  });
}

sinew_status sinew_character_get_view(sinew_character character, sinew_view_kind kind, sinew_view* out) {
  return with_character(character, [&](OwnedWorld&, const Character<float>& c) {
    if (!out) return fail(SINEW_INVALID_ARGUMENT, kNull);
    if (kind < SINEW_VIEW_MODEL || kind > SINEW_VIEW_UNKNOWN)
      return fail(SINEW_INVALID_ARGUMENT, "no such view", kind);
    *out = view_of(c, kind);
    return sinew_status(SINEW_OK);
  });
}
