// Feet on the ground for the C interface.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <span>

#include "sinew/animation/foot_placement_job.h"
#include "sinew/c/grounds.h"
#include "sinew/c/pose_call.h"
#include "sinew/character/check_jet.h"

namespace sinew::c {
namespace {

constexpr std::size_t kFeet = 2;   ///< left and right
constexpr float kFarthest = 1e6f;  ///< m, of hits
constexpr float kLargest = 1e12f;  ///< of what a state holds, which is metres and seconds, with their rates

static_assert(int(FootHold::kFree) == SINEW_HOLD_FREE && int(FootHold::kToe) == SINEW_HOLD_TOE &&
              int(FootHold::kHeel) == SINEW_HOLD_HEEL);
static_assert(sizeof(sinew_ground_hit) == sizeof(GroundHit<float>));
static_assert(alignof(sinew_ground_hit) == alignof(GroundHit<float>));
static_assert(offsetof(sinew_ground_hit, normal) == offsetof(GroundHit<float>, normal));
static_assert(offsetof(sinew_ground_hit, body) == offsetof(GroundHit<float>, ground));

struct FeetSettings {
  double level = 0, level_rate = 0, level_acceleration = 0, step = 0;
  FootSettings<double> settings;
  double reach = FootPlacementJob<double>().reach, follow = FootPlacementJob<double>().follow,
         rise = FootPlacementJob<double>().rise, deepest = FootPlacementJob<double>().deepest;
};

constexpr auto kFields = [](auto& c, auto& s, auto&& f) {
  f("level must be within 1e6 m", c.level, s.level, -1e6, 1e6);
  f("level_rate must be below 1e5 m/s", c.level_rate, s.level_rate, -1e5, 1e5);
  f("level_acceleration must be below 1e8 m/s2", c.level_acceleration, s.level_acceleration, -1e8, 1e8);
  f("step must be 0 to 1e6 s", c.step, s.step, 0, 1e6);
  f("lock_at must be 0 to 1", c.lock_at, s.settings.lock_at, 0, 1);
  f("release_at must be 0 to lock_at", c.release_at, s.settings.release_at, 0, c.lock_at);
  f("lock_time must be 0 to 100 s", c.lock_time, s.settings.lock_time, 0, 100);
  f("release_time must be 0 to 100 s", c.release_time, s.settings.release_time, 0, 100);
  f("half_life must be 1e-3 to 100 s", c.half_life, s.settings.half_life, 1e-3, 100);
  f("farthest must be 1e-3 to 1e4 m", c.farthest, s.settings.farthest, 1e-3, 1e4);
  f("steepest must be 0 to 1.5 rad", c.steepest, s.settings.steepest, 0, 1.5);
  f("reach must be 0.5 to 0.998", c.reach, s.reach, 0.5, 0.998);
  f("follow must be 0 to 1", c.follow, s.follow, 0, 1);
  f("rise must be 1e-3 to 100 s", c.rise, s.rise, 1e-3, 100);
  f("deepest must be 0 to 1e4 m", c.deepest, s.deepest, 0, 1e4);
};

FootSettings<float> in_float(const FootSettings<double>& s) {
  return {float(s.lock_at),   float(s.release_at), float(s.lock_time), float(s.release_time),
          float(s.half_life), float(s.farthest),   float(s.steepest)};
}

sinew_status read_hits(const sinew_ground_hit* hits, int count, int foot,
                       std::span<const GroundHit<float>>& to) {
  if (!hits && count != 0) return fail(SINEW_INVALID_ARGUMENT, kNull, foot);
  if (count < 0) return fail(SINEW_INVALID_ARGUMENT, "a foot has fewer hits than none", foot);
  to = {reinterpret_cast<const GroundHit<float>*>(hits), std::size_t(count)};
  const bool near = std::all_of(to.begin(), to.end(), [](const GroundHit<float>& hit) {
    return hit.point.cwiseAbs().maxCoeff() <= kFarthest || !hit.point.allFinite();  // the job refuses these
  });
  return near ? sinew_status(SINEW_OK) : fail(SINEW_OUT_OF_RANGE, "a hit must be within 1e6 m", foot);
}

sinew_status read_foot(const sinew_foot& from, int foot, FootInput<float>& to) {
  to.contact = from.contact;
  if (const sinew_status s = read_hits(from.under, from.under_count, foot, to.under); s != SINEW_OK) return s;
  return read_hits(from.ahead, from.ahead_count, foot, to.ahead);
}

/// copy(number of the C struct, number of the state) for all that has no name there, in the order of
/// FootState.
template <class C, class S, class Copy>
void list_numbers(C& c, S& s, Copy&& copy) {
  NumberList list{c.numbers, copy};
  for (auto* vector : {&s.point, &s.normal, &s.lock})
    for (auto& x : *vector) list.number(x);
  list.jet(s.height.x);
  for (auto& slope : s.slope) list.jet(slope.x);
  for (auto& offset : s.offset) list.jet(offset);
  list.jet(s.grip);
  static_assert(std::size(C{}.numbers) == 30);
}

template <std::size_t n>
bool in_range(const float (&numbers)[n]) {
  return std::all_of(numbers, numbers + n, [](float x) { return std::abs(x) <= kLargest; });
}
bool in_range(const sinew_foot_state& foot) {
  return in_range(foot.numbers) && foot.elapsed >= 0 && foot.elapsed <= kLargest && foot.duration >= 0 &&
         foot.duration <= kLargest;
}
bool in_range(const sinew_feet_state& state) {
  return in_range(state.feet[0]) && in_range(state.feet[1]) && in_range(state.drop);
}

constexpr const char* kNoState = "the feet's state is none that a call has written";

sinew_status read_foot_state(const sinew_foot_state& from, int foot, int grounds, FootState<float>& to) {
  to = {};
  if (from.started == 0) return SINEW_OK;
  if (!in_range(from) || from.hold < SINEW_HOLD_FREE || from.hold > SINEW_HOLD_HEEL)
    return fail(SINEW_OUT_OF_RANGE, kNoState, foot);
  if (from.ground < -1 || from.ground >= grounds)
    return fail(SINEW_INVALID_ARGUMENT, "the ground that the foot is on is not given", foot);
  to.started = true;
  to.hold = FootHold(from.hold);
  to.ground = from.ground;
  to.elapsed = from.elapsed;
  to.duration = from.duration;
  list_numbers(from, to, [](const float& c, float& s) { s = c; });
  return SINEW_OK;
}

void write_foot_state(const FootState<float>& from, sinew_foot_state& to) {
  to.started = from.started;
  to.hold = int(from.hold);
  to.ground = from.ground;
  to.elapsed = from.elapsed;
  to.duration = from.duration;
  list_numbers(to, from, [](float& c, const float& s) { c = s; });
}

/// What the feet of a character remember.
struct Remembered {
  std::array<FootState<float>, kFeet> feet;
  SmoothInput<float> drop;
};

sinew_status read_state(const sinew_feet_state& from, int grounds, Remembered& to) {
  if (!in_range(from.drop)) return fail(SINEW_OUT_OF_RANGE, kNoState);
  to.drop.x = {from.drop[0], from.drop[1], from.drop[2]};
  for (std::size_t n = 0; n < kFeet; ++n)
    if (const sinew_status s = read_foot_state(from.feet[n], int(n), grounds, to.feet[n]); s != SINEW_OK)
      return s;
  return SINEW_OK;
}

sinew_feet_state state_of(const Remembered& from) {
  sinew_feet_state to{};
  for (std::size_t n = 0; n < kFeet; ++n) write_foot_state(from.feet[n], to.feet[n]);
  to.drop[0] = from.drop.x.value;
  to.drop[1] = from.drop.x.rate;
  to.drop[2] = from.drop.x.acceleration;
  return to;
}

/// Runs the job; what it changed of the pose is as before where it fails.
sinew_status run_or_undo(const OwnedAsset& owned, const FootPlacementJob<float>& job, const Remembered& after,
                         sinew_feet_state& state) {
  if (const Status status = job.Validate(); !status) return answer(status);
  const auto& [left, right] = owned.legs;
  const std::array changed{owned.pelvis, left.upper,   left.middle, left.foot,
                           right.upper,  right.middle, right.foot};
  std::array<JointJet<float>, changed.size()> before;
  for (std::size_t n = 0; n < changed.size(); ++n) before[n] = job.jets[std::size_t(changed[n])];
  Status status = job.Run();
  const sinew_feet_state written = state_of(after);
  const bool good = in_range(written) && std::all_of(changed.begin(), changed.end(), [&](int joint) {
                      return is_finite(job.jets[std::size_t(joint)]);
                    });
  if (status && !good)
    status = Status::error(Code::kOutOfRange, "a jet, ground or level is absurdly far or fast");
  if (status)
    state = written;
  else
    for (std::size_t n = 0; n < changed.size(); ++n) job.jets[std::size_t(changed[n])] = before[n];
  return answer(status);
}

}  // namespace

sinew_status read_grounds(const sinew_jet* jets, int count, Grounds& grounds) noexcept {
  if (!jets && count != 0) return fail(SINEW_INVALID_ARGUMENT, kNull);
  if (!aligned(jets)) return fail(SINEW_INVALID_ARGUMENT, kMisaligned);
  if (count < 0 || std::size_t(count) > Grounds::kMost)
    return fail(SINEW_INVALID_ARGUMENT, "there may be 0 to 8 bodies", count);
  const std::span<const JointJet<float>> read = jets_of(jets, count);
  for (int n = 0; n < count; ++n)
    if (const Status status = check_jet(read[std::size_t(n)], n); !status) return answer(status);
  std::transform(read.begin(), read.end(), grounds.bodies.begin(), moving_transform<float>);
  grounds.count = read.size();
  return SINEW_OK;
}

}  // namespace sinew::c

using namespace sinew;
using namespace sinew::c;

sinew_status sinew_asset_get_leg(sinew_asset asset, sinew_role foot, sinew_leg_info* out) {
  return with_owned_asset(asset, [&](const OwnedAsset& owned) {
    if (const sinew_status s = check_size(out); s != SINEW_OK) return s;
    if (foot != SINEW_ROLE_FOOT_L && foot != SINEW_ROLE_FOOT_R)
      return fail(SINEW_INVALID_ARGUMENT, "not the role of a foot");
    if (!owned.stands) return answer(owned.stands);
    return fill_sized(out, [&](sinew_leg_info& info) {
      const FootLeg<float>& leg = owned.legs[foot == SINEW_ROLE_FOOT_L ? 0 : 1];
      info.upper = leg.upper;
      info.middle = leg.middle;
      info.foot = leg.foot;
      std::copy_n(leg.toe.data(), 3, info.toe);
      std::copy_n(leg.heel.data(), 3, info.heel);
    });
  });
}

sinew_status sinew_feet_init(sinew_feet* settings) {
  return init<FeetSettings>(settings, kFields);
}

sinew_status sinew_asset_place_feet(sinew_asset asset, const sinew_feet* settings, const sinew_foot* feet,
                                    const sinew_jet* grounds, int32_t ground_count, sinew_feet_state* state,
                                    sinew_jet* jets, int32_t count) {
  const auto place = [&](const OwnedAsset& owned, const FeetSettings& s, std::span<JointJet<float>> all) {
    if (!feet || !state) return fail(SINEW_INVALID_ARGUMENT, kNull);
    if (!owned.stands) return answer(owned.stands);
    Grounds bodies;
    if (const sinew_status r = read_grounds(grounds, ground_count, bodies); r != SINEW_OK) return r;
    std::array<FootInput<float>, kFeet> inputs;
    for (std::size_t n = 0; n < kFeet; ++n)
      if (const sinew_status r = read_foot(feet[n], int(n), inputs[n]); r != SINEW_OK) return r;
    Remembered remembered;
    if (const sinew_status r = read_state(*state, ground_count, remembered); r != SINEW_OK) return r;
    FootPlacementJob<float> job{owned.parents,    all,         owned.pelvis,
                                owned.legs,       inputs,      remembered.feet,
                                &remembered.drop, bodies.all()};
    job.level = {float(s.level), float(s.level_rate), float(s.level_acceleration)};
    job.step = float(s.step);
    job.settings = in_float(s.settings);
    job.reach = float(s.reach);
    job.follow = float(s.follow);
    job.rise = float(s.rise);
    job.deepest = float(s.deepest);
    return run_or_undo(owned, job, remembered, *state);
  };
  return run<FeetSettings>(asset, settings, kFields, jets, count, place);
}
