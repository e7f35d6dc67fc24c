// Jobs on one pose of the C interface: transitions, limbs, looks, left and right exchanged.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <span>

#include "sinew/animation/inertialize_job.h"
#include "sinew/animation/inverse_kinematics.h"
#include "sinew/animation/look_at_job.h"
#include "sinew/c/pose_call.h"

namespace sinew::c {
namespace {

/// A place that moves.
struct Moving {
  Vec3<double> place = Vec3<double>::Zero(), velocity = Vec3<double>::Zero(),
               acceleration = Vec3<double>::Zero();

  MovingVector<float> vector() const {
    const auto at = [&](int k) {
      return TimeJet<float>(float(place[k]), float(velocity[k]), float(acceleration[k]));
    };
    return {at(0), at(1), at(2)};
  }
};

/// How much of something, with its rates.
struct Weight {
  double value = 1, rate = 0, acceleration = 0;

  TimeJet<float> jet() const { return {float(value), float(rate), float(acceleration)}; }
};

void list_target(auto& c, auto& target, auto& weight, auto&& f) {
  f("target must be within 1e6 m", c.target, target.place, -1e6, 1e6);
  f("target_velocity must be below 1e5 m/s", c.target_velocity, target.velocity, -1e5, 1e5);
  f("target_acceleration must be below 1e8 m/s2", c.target_acceleration, target.acceleration, -1e8, 1e8);
  f("weight must be 0 to 1", c.weight, weight.value, 0, 1);
  f("weight_rate must be within 1e6", c.weight_rate, weight.rate, -1e6, 1e6);
  f("weight_acceleration must be within 1e9", c.weight_acceleration, weight.acceleration, -1e9, 1e9);
}

struct TwoBone {
  int upper = -1, middle = -1, end = -1;
  Moving target;
  Vec3<double> pole = Vec3<double>::Zero(), hinge = Vec3<double>::Zero();
  Weight weight;
  double softness = TwoBoneJob<double>().softness;
  bool keep_end = TwoBoneJob<double>().keep_end;
};

constexpr auto kTwoBone = [](auto& c, auto& s, auto&& f) {
  f("upper must be a joint", c.upper, s.upper);
  f("middle must be a joint", c.middle, s.middle);
  f("end must be a joint", c.end, s.end);
  list_target(c, s.target, s.weight, f);
  f("pole must be within 1e6", c.pole, s.pole, -1e6, 1e6);
  f("hinge must be within 1e6", c.hinge, s.hinge, -1e6, 1e6);
  f("softness must be 0.001 to 0.999", c.softness, s.softness, 0.001, 0.999);
  f("", c.keep_end, s.keep_end);
};

struct Aim {
  int joint = -1;
  Moving target;
  Vec3<double> axis = AimJob<double>().axis;
  Weight weight;
  double limit = AimJob<double>().limit;
};

constexpr auto kAim = [](auto& c, auto& s, auto&& f) {
  f("joint must be one", c.joint, s.joint);
  list_target(c, s.target, s.weight, f);
  f("axis must be a unit vector", c.axis, s.axis, -1.01, 1.01);
  f("limit must be 0 to 3.1 rad", c.limit, s.limit, 0, 3.1);
};

struct Look {
  bool changed = false;
  Moving target, before;
  Weight weight;
  double step = 0;
  LookSettings<double> settings;
};

constexpr auto kLook = [](auto& c, auto& s, auto&& f) {
  f("", c.changed, s.changed);
  list_target(c, s.target, s.weight, f);
  f("before must be within 1e6 m", c.before, s.before.place, -1e6, 1e6);
  f("before_velocity must be below 1e5 m/s", c.before_velocity, s.before.velocity, -1e5, 1e5);
  f("before_acceleration must be below 1e8 m/s2", c.before_acceleration, s.before.acceleration, -1e8, 1e8);
  f("step must be 0 to 1e6 s", c.step, s.step, 0, 1e6);
  f("yaw must be 0 to 3.1 rad", c.yaw, s.settings.yaw, 0, 3.1);
  f("pitch_down must be 0 to 1.5 rad", c.pitch_down, s.settings.pitch_down, 0, 1.5);
  f("pitch_up must be 0 to 1.5 rad", c.pitch_up, s.settings.pitch_up, 0, 1.5);
  f("softness must be 0 to 3.1 rad", c.softness, s.settings.softness, 0, 3.1);
  f("behind must be 0 to 3.1 rad", c.behind, s.settings.behind, 0, 3.1);
  f("fastest must be 1e-3 to 1e4 rad/s", c.fastest, s.settings.fastest, 1e-3, 1e4);
  f("least_time must be 0 to 100 s", c.least_time, s.settings.least_time, 0, 100);
  f("half_life must be 0 to 100 s", c.half_life, s.settings.half_life, 0, 100);
};

LookSettings<float> in_float(const LookSettings<double>& s) {
  return {float(s.yaw),    float(s.pitch_down), float(s.pitch_up),   float(s.softness),
          float(s.behind), float(s.fastest),    float(s.least_time), float(s.half_life)};
}

/// copy(number of the C struct, number of the state) for all that fades, in the order of LookState.
template <class C, class S, class Copy>
void list_numbers(C& c, S& s, Copy&& copy) {
  NumberList list{c.numbers, copy};
  for (auto* track : {&s.body, &s.head}) {
    for (auto& offset : track->offset) list.jet(offset);
    for (auto& angle : track->angles) list.jet(angle.x);
  }
  list.number(s.elapsed);
  list.number(s.duration);
  static_assert(std::size(C{}.numbers) == 26);
}

sinew_status read_state(const sinew_look_state& from, LookState<float>& to) {
  for (const float x : from.numbers)
    if (!std::isfinite(x)) return fail(SINEW_NOT_FINITE, "the look's state is not finite");
  to.started = from.started != 0;
  to.side = from.side < 0 ? -1 : 1;
  list_numbers(from, to, [](const float& c, float& s) { s = c; });
  return SINEW_OK;
}

void write_state(const LookState<float>& from, sinew_look_state& to) {
  to.started = from.started;
  to.side = from.side;
  list_numbers(to, from, [](float& c, const float& s) { c = s; });
}

/// act(const OwnedAsset&) of an asset whose left and right are known.
template <class Act>
sinew_status with_mirror(sinew_asset handle, Act&& act) noexcept {
  return with_owned_asset(
      handle, [&](const OwnedAsset& owned) { return owned.mirrors ? act(owned) : answer(owned.mirrors); });
}

// A transition as a caller keeps it: seconds since it began, of how many, joints, those whose translations
// differ, and what they differ by.
constexpr std::size_t kTransitionHead = 4;

/// The first joints, up to the last whose place against its parent differs.
int translated_of(std::span<const JointJet<float>> a, std::span<const JointJet<float>> b) {
  std::size_t n = a.size();
  while (n > 1 && a[n - 1].translation == b[n - 1].translation && a[n - 1].velocity == b[n - 1].velocity) --n;
  return static_cast<int>(n);
}

void write_transition(const InertialState<float>& from, float* to) {
  to[0] = from.elapsed;
  to[1] = from.duration;
  to[2] = static_cast<float>(from.joints);
  to[3] = static_cast<float>(from.translated);
}

/// False where it is none, or none for so many jets.
bool read_transition(float* from, int count, int jets, InertialState<float>& to) {
  if (count < static_cast<int>(kTransitionHead)) return false;
  const auto is_count = [&](float x) {
    return x >= 0 && x <= static_cast<float>(jets) && x == std::floor(x);
  };
  if (!is_count(from[2]) || !is_count(from[3])) return false;
  to.elapsed = from[0];
  to.duration = from[1];
  to.joints = static_cast<int>(from[2]);
  to.translated = static_cast<int>(from[3]);
  const std::size_t numbers = kTransitionHead + inertial_numbers(to.joints, to.translated);
  if (std::size_t(count) < numbers) return false;
  to.offsets = std::span(from, numbers).subspan(kTransitionHead);
  return to.elapsed >= 0 && std::isfinite(to.elapsed) &&
         std::all_of(to.offsets.begin(), to.offsets.end(), [](float x) { return std::isfinite(x); });
}

}  // namespace
}  // namespace sinew::c

using namespace sinew;
using namespace sinew::c;

sinew_status sinew_asset_begin_transition(sinew_asset asset, const sinew_jet* now, int32_t now_count,
                                          const sinew_jet* next, int32_t next_count, float duration,
                                          float* state, int32_t capacity, int32_t* count) {
  return with_owned_asset(asset, [&](const OwnedAsset& owned) {
    if (const sinew_status s = check_jets(owned, now, now_count); s != SINEW_OK) return s;
    if (const sinew_status s = check_jets(owned, next, next_count); s != SINEW_OK) return s;
    if (next_count != now_count)
      return fail(SINEW_INVALID_ARGUMENT, "the new motion has another number of joints", next_count);
    if (!count || (!state && capacity != 0)) return fail(SINEW_INVALID_ARGUMENT, kNull);
    const std::span<const JointJet<float>> from = jets_of(now, now_count), to = jets_of(next, next_count);
    InertialState<float> begun;
    begun.joints = now_count;
    begun.translated = translated_of(from, to);
    const std::size_t numbers = kTransitionHead + inertial_numbers(begun.joints, begun.translated);
    *count = static_cast<int32_t>(numbers);
    if (capacity < *count) return fail(SINEW_TOO_SMALL, "room for fewer numbers than the transition has");
    begun.offsets = std::span(state, numbers).subspan(kTransitionHead);
    if (const Status status = begin_inertial(from, to, duration, begun); !status) return answer(status);
    write_transition(begun, state);
    return sinew_status(SINEW_OK);
  });
}

sinew_status sinew_asset_play_transition(sinew_asset asset, float* state, int32_t state_count, float step,
                                         sinew_jet* jets, int32_t count) {
  return with_owned_asset(asset, [&](const OwnedAsset& owned) {
    if (const sinew_status s = check_jets(owned, jets, count); s != SINEW_OK) return s;
    if (!state) return fail(SINEW_INVALID_ARGUMENT, kNull);
    if (!(step >= 0 && step <= 1000)) return fail(SINEW_INVALID_ARGUMENT, "step must be 0 to 1000 s");
    InertialState<float> left;
    if (!read_transition(state, state_count, count, left))
      return fail(SINEW_INVALID_ARGUMENT, "no transition of so many joints");
    left.elapsed += step;
    const std::span<JointJet<float>> out = jets_of(jets, count);
    const InertializeJob<float> job{out, &left, {}, out};
    if (const Status status = job.Run(); !status) return answer(status);
    state[0] = left.elapsed;
    return sinew_status(SINEW_OK);
  });
}

sinew_status sinew_asset_get_partner(sinew_asset asset, int32_t joint, int32_t* out) {
  return with_mirror(asset, [&](const OwnedAsset& owned) {
    const std::vector<std::uint16_t>& partners = owned.mirror.partners;
    if (!out) return fail(SINEW_INVALID_ARGUMENT, kNull);
    if (joint < 0 || std::size_t(joint) >= partners.size())
      return fail(SINEW_INVALID_ARGUMENT, "no such joint", joint);
    const std::uint16_t partner = partners[std::size_t(joint)];
    *out = partner == kNoPartner ? -1 : partner;
    return sinew_status(SINEW_OK);
  });
}

sinew_status sinew_asset_mirror(sinew_asset asset, sinew_jet* jets, int32_t count) {
  return with_mirror(asset, [&](const OwnedAsset& owned) {
    if (const sinew_status s = check_jets(owned, jets, count); s != SINEW_OK) return s;
    return answer(MirrorJob<float>{&owned.mirror, jets_of(jets, count), jets_of(jets, count)}.Run());
  });
}

sinew_status sinew_two_bone_init(sinew_two_bone* settings) {
  return init<TwoBone>(settings, kTwoBone);
}

sinew_status sinew_asset_two_bone(sinew_asset asset, const sinew_two_bone* settings, sinew_jet* jets,
                                  int32_t count) {
  const auto reach = [](const OwnedAsset& owned, const TwoBone& s, std::span<JointJet<float>> all) {
    TwoBoneJob<float> job{owned.parents, all, s.upper, s.middle, s.end, s.target.vector()};
    job.pole = still<float>(s.pole.cast<float>());
    job.hinge = s.hinge.cast<float>();
    job.weight = s.weight.jet();
    job.keep_end = s.keep_end;
    job.softness = float(s.softness);
    return answer(job.Run());
  };
  return run<TwoBone>(asset, settings, kTwoBone, jets, count, reach);
}

sinew_status sinew_aim_init(sinew_aim* settings) {
  return init<Aim>(settings, kAim);
}

sinew_status sinew_asset_aim(sinew_asset asset, const sinew_aim* settings, sinew_jet* jets, int32_t count) {
  const auto aim = [](const OwnedAsset& owned, const Aim& s, std::span<JointJet<float>> all) {
    AimJob<float> job{owned.parents, all, s.joint, s.target.vector(), s.axis.cast<float>()};
    job.weight = s.weight.jet();
    job.limit = float(s.limit);
    return answer(job.Run());
  };
  return run<Aim>(asset, settings, kAim, jets, count, aim);
}

sinew_status sinew_look_init(sinew_look* settings) {
  return init<Look>(settings, kLook);
}

sinew_status sinew_asset_look(sinew_asset asset, const sinew_look* settings, sinew_look_state* state,
                              sinew_jet* jets, int32_t count) {
  const auto look = [&](const OwnedAsset& owned, const Look& s, std::span<JointJet<float>> all) {
    if (!state) return fail(SINEW_INVALID_ARGUMENT, kNull);
    if (!owned.look) return fail(SINEW_INVALID_ARGUMENT, "the skeleton has no head that could look");
    LookState<float> remembered;
    if (const sinew_status status = read_state(*state, remembered); status != SINEW_OK) return status;
    const MovingVector<float> before = s.before.vector();
    const LookAtJob<float> job{owned.parents,       all,
                               &*owned.look,        &remembered,
                               s.target.vector(),   s.changed ? &before : nullptr,
                               s.weight.jet(),      float(s.step),
                               in_float(s.settings)};
    const Status status = job.Run();
    if (status) write_state(remembered, *state);
    return answer(status);
  };
  return run<Look>(asset, settings, kLook, jets, count, look);
}

sinew_status sinew_asset_get_model(sinew_asset asset, const sinew_jet* jets, int32_t jet_count,
                                   sinew_transform* out, int32_t capacity, int32_t* count) {
  return with_owned_asset(asset, [&](const OwnedAsset& owned) {
    if (!count || (!out && capacity != 0)) return fail(SINEW_INVALID_ARGUMENT, kNull);
    if (capacity < 0) return fail(SINEW_INVALID_ARGUMENT, "the capacity is negative");
    if (const sinew_status s = check_jets(owned, jets, jet_count); s != SINEW_OK) return s;
    *count = jet_count;
    if (capacity < jet_count) return fail(SINEW_TOO_SMALL, "room for fewer joints than there are jets");
    for (int j = 0; j < jet_count; ++j) {
      const JointJet<float>& jet = jets_of(jets, jet_count)[std::size_t(j)];
      const int parent = owned.parents[std::size_t(j)];
      Transform<float> model;
      if (parent >= 0) std::memcpy(static_cast<void*>(&model), &out[parent], sizeof model);
      model = model * Transform<float>{jet.rotation, jet.translation};
      std::memcpy(&out[j], static_cast<const void*>(&model), sizeof model);  // it need not be aligned
    }
    return sinew_status(SINEW_OK);
  });
}
