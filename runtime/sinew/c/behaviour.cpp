// Balance of characters, for the C interface.
#include "sinew/behaviour/behaviour.h"

#include <algorithm>
#include <utility>

#include "sinew/c/call.h"
#include "sinew/c/fields.h"
#include "sinew/c/layout.h"

namespace sinew::c {

// Before a body got up by clips.
template <>
inline constexpr std::uint32_t kFirstSize<sinew_behaviour_settings> = 48;
template <>
inline constexpr std::uint32_t kFirstSize<sinew_behaviour_report> = 40;

namespace {

static_assert(int(BehaviourState::kClip) == SINEW_BEHAVIOUR_CLIP &&
              int(BehaviourState::kPassive) == SINEW_BEHAVIOUR_PASSIVE &&
              int(BehaviourState::kBalance) == SINEW_BEHAVIOUR_BALANCE &&
              int(BehaviourState::kStep) == SINEW_BEHAVIOUR_STEP &&
              int(BehaviourState::kFall) == SINEW_BEHAVIOUR_FALL &&
              int(BehaviourState::kDown) == SINEW_BEHAVIOUR_DOWN &&
              int(BehaviourState::kGather) == SINEW_BEHAVIOUR_GATHER &&
              int(BehaviourState::kRise) == SINEW_BEHAVIOUR_RISE);
static_assert(int(GetUpPolicy::kAuto) == SINEW_GET_UP_AUTO &&
              int(GetUpPolicy::kWhenAllowed) == SINEW_GET_UP_WHEN_ALLOWED &&
              int(GetUpPolicy::kNever) == SINEW_GET_UP_NEVER);
static_assert(int(BehaviourEventKind::kFallen) == SINEW_BEHAVIOUR_EVENT_FALLEN &&
              int(BehaviourEventKind::kRising) == SINEW_BEHAVIOUR_EVENT_RISING &&
              int(BehaviourEventKind::kStanding) == SINEW_BEHAVIOUR_EVENT_STANDING);
static_assert(int(BehaviourReason::kNone) == SINEW_BEHAVIOUR_REASON_NONE &&
              int(BehaviourReason::kAsked) == SINEW_BEHAVIOUR_REASON_ASKED &&
              int(BehaviourReason::kBeyondReach) == SINEW_BEHAVIOUR_REASON_BEYOND_REACH &&
              int(BehaviourReason::kTilted) == SINEW_BEHAVIOUR_REASON_TILTED &&
              int(BehaviourReason::kNotGathered) == SINEW_BEHAVIOUR_REASON_NOT_GATHERED &&
              int(BehaviourReason::kLeftItsClip) == SINEW_BEHAVIOUR_REASON_LEFT_ITS_CLIP &&
              int(BehaviourReason::kTookTooLong) == SINEW_BEHAVIOUR_REASON_TOOK_TOO_LONG);

constexpr auto kSettings = [](auto& c, auto& s, auto&& f) {
  f("most_steps must be 0 to 1000", c.most_steps, s.most_steps, 0, 1000);
  f("reaction must be 0 to 10 s", c.reaction, s.reaction, 0, 10);
  f("gravity must be 1e-3 to 1e4 m/s2", c.gravity, s.gravity, 1e-3, 1e4);
  f("help_torque must be 0 to 1e9 N m", c.help_torque, s.help_torque, 0, 1e9);
  f("fallen_strength must be 0 to 1", c.fallen_strength, s.fallen_strength, 0, 1);
  f("let_go must be 0 to 10 s", c.let_go, s.let_go, 0, 10);
  f("no such policy of getting up", c.get_up, s.get_up);
  f("gather must be 0.01 to 10 s", c.gather, s.gather, 0.01, 10);
  f("rise_force must be 0 to 1e9 N", c.rise_force, s.rise_force, 0, 1e9);
  f("rise_torque must be 0 to 1e9 N m", c.rise_torque, s.rise_torque, 0, 1e9);
  f("walk_torque must be 0 to 1e9 N m", c.walk_torque, s.walk_torque, 0, 1e9);
  f("walk_force must be 0 to 1e9 N", c.walk_force, s.walk_force, 0, 1e9);
  f("reach_strength must be 0 to 1", c.reach_strength, s.reach_strength, 0, 1);
};

/// act(OwnedBehaviour&, character) of a character that has one. `breaks`: as of in_world.
template <class Act>
sinew_status with_owned(sinew_character handle, Act&& act, bool breaks = false) noexcept {
  return with_character(
      handle,
      [&](OwnedWorld& w, const Character<float>& character) {
        OwnedBehaviour* const owned = w.behaviours[std::size_t(index_of(handle))].get();
        if (!owned) return fail(SINEW_INVALID_ARGUMENT, "the character has no behaviour");
        return act(*owned, character);
      },
      breaks);
}

/// act(Behaviour&, character).
template <class Act>
sinew_status with_behaviour(sinew_character handle, Act&& act) noexcept {
  return with_owned(handle, [&](OwnedBehaviour& owned, const Character<float>& character) {
    return act(owned.behaviour, character);
  });
}

bool gets_up(const Behaviour<float>& behaviour) {
  return behaviour.state() == BehaviourState::kGather || behaviour.state() == BehaviourState::kRise;
}

/// How it gets up, or did last.
void fill_get_up(const OwnedBehaviour& owned, sinew_behaviour_report& r) {
  const GetUp<float>& up = owned.behaviour.getting_up();
  const auto chosen = std::size_t(up.variant());
  r.clip = -1;
  if (up.variant() < 0 || chosen >= up.clips().variants().size()) return;
  const GetUpVariant& variant = up.clips().variants()[chosen];
  r.clip = static_cast<int32_t>(variant.clip - owned.clips->clips.data());
  r.mirrored = variant.mirrored;
  r.clip_time = up.time();
  r.off = up.off();
}

}  // namespace
}  // namespace sinew::c

using namespace sinew;
using namespace sinew::c;

sinew_status sinew_behaviour_settings_init(sinew_behaviour_settings* settings) {
  return init<BehaviourSettings>(settings, kSettings);
}

sinew_status sinew_character_add_behaviour(sinew_character character,
                                           const sinew_behaviour_settings* settings) {
  return with_character(character, [&](OwnedWorld& w, const Character<float>& c) {
    BehaviourSettings read;
    if (const sinew_status s = read_settings(settings, read, kSettings); s != SINEW_OK) return s;
    Status status;
    auto made = std::make_unique<OwnedBehaviour>(c.skeleton(), read, status);
    if (status) w.behaviours[std::size_t(index_of(character))] = std::move(made);
    return answer(status);
  });
}

sinew_status sinew_character_use_get_ups(sinew_character character, sinew_asset asset) {
  return with_shared_asset(asset, [&](const std::shared_ptr<const Asset>& clips) {
    const auto use = [&](OwnedBehaviour& owned, const Character<float>& c) {
      if (clips->skeleton.joints.size() != c.skeleton().joints.size())
        return fail(SINEW_INVALID_ARGUMENT, kOtherSkeleton);
      if (gets_up(owned.behaviour)) return fail(SINEW_INVALID_ARGUMENT, "it is getting up by other clips");
      (void)owned.behaviour.use_get_ups(c.skeleton(), {});  // those of before may go
      owned.clips = clips;
      return answer(owned.behaviour.use_get_ups(c.skeleton(), clips->clips));
    };
    return with_owned(character, use, true);
  });
}

sinew_status sinew_character_balance(sinew_character character, sinew_jet* jets, int32_t count, float h) {
  return with_behaviour(character, [&](Behaviour<float>& behaviour, Character<float> c) {
    if (!jets) return fail(SINEW_INVALID_ARGUMENT, kNull);
    if (!aligned(jets)) return fail(SINEW_INVALID_ARGUMENT, kMisaligned);
    if (count < 0) return fail(SINEW_INVALID_ARGUMENT, "a number of jets below 0", count);
    if (!(h >= 1e-5f && h <= 0.25f)) return fail(SINEW_OUT_OF_RANGE, "a step must have 1e-5 to 0.25 s");
    const std::span<JointJet<float>> span = jets_of(jets, count);
    if (const Status status = c.set_target(span); !status) return answer(status);  // what can be meant
    if (const Status status = behaviour.update(c, span, h); !status) return answer(status);
    return answer(c.set_target(span));
  });
}

sinew_status sinew_character_order(sinew_character character, sinew_behaviour_order order) {
  return with_behaviour(character, [&](Behaviour<float>& behaviour, const Character<float>& c) {
    switch (order) {
      case SINEW_BEHAVIOUR_KNOCK_DOWN:
        behaviour.knock_down(c);
        return sinew_status(SINEW_OK);
      case SINEW_BEHAVIOUR_STAND:
        behaviour.stand(c);
        return sinew_status(SINEW_OK);
      case SINEW_BEHAVIOUR_GET_UP:
        return answer(behaviour.get_up());
      default:
        return fail(SINEW_INVALID_ARGUMENT, "no such order", order);
    }
  });
}

sinew_status sinew_character_get_behaviour(sinew_character character, sinew_behaviour_report* out) {
  return with_owned(character, [&](const OwnedBehaviour& owned, const Character<float>&) {
    return fill_sized(out, [&](sinew_behaviour_report& r) {
      const BehaviourReport& report = owned.behaviour.report();
      r.state = static_cast<sinew_behaviour_state>(report.state);
      r.steps = report.steps;
      r.capture_depth = report.capture_depth;
      r.time = report.time;
      r.fell_beyond = report.fell_beyond;
      r.tries = report.tries;
      fill_get_up(owned, r);
    });
  });
}

sinew_status sinew_character_get_behaviour_events(sinew_character character, sinew_behaviour_event* out,
                                                  int32_t capacity, int32_t* count) {
  return with_behaviour(character, [&](const Behaviour<float>& behaviour, const Character<float>&) {
    if (!count || (!out && capacity != 0)) return fail(SINEW_INVALID_ARGUMENT, kNull);
    if (capacity < 0) return fail(SINEW_INVALID_ARGUMENT, "the capacity is negative");
    const std::span<const BehaviourEvent> events = behaviour.events();
    *count = static_cast<int32_t>(events.size());
    if (events.size() > std::size_t(capacity)) return fail(SINEW_TOO_SMALL, "room for fewer events");
    std::transform(events.begin(), events.end(), out, [](const BehaviourEvent& e) {
      return sinew_behaviour_event{static_cast<sinew_behaviour_event_kind>(e.kind),
                                   static_cast<sinew_behaviour_reason>(e.reason), e.number};
    });
    return sinew_status(SINEW_OK);
  });
}

sinew_status sinew_character_save_behaviour(sinew_character character, void* out, size_t capacity,
                                            size_t* size) {
  return with_behaviour(character, [&](Behaviour<float>& behaviour, const Character<float>& c) {
    if (!size || (!out && capacity != 0)) return fail(SINEW_INVALID_ARGUMENT, kNull);
    *size = behaviour.saved_bytes();
    if (behaviour.save(c, {static_cast<std::byte*>(out), capacity}) == 0)
      return fail(SINEW_TOO_SMALL, "room for fewer bytes than the behaviour remembers");
    return sinew_status(SINEW_OK);
  });
}

sinew_status sinew_character_restore_behaviour(sinew_character character, const void* bytes, size_t size) {
  return with_behaviour(character, [&](Behaviour<float>& behaviour, const Character<float>&) {
    if (!bytes) return fail(SINEW_INVALID_ARGUMENT, kNull);
    return answer(behaviour.restore({static_cast<const std::byte*>(bytes), size}));
  });
}
