// Balance of characters, for the C interface.
#include "sinew/behaviour/behaviour.h"

#include <utility>

#include "sinew/c/call.h"
#include "sinew/c/fields.h"
#include "sinew/c/layout.h"

namespace sinew::c {
namespace {

static_assert(int(BehaviourState::kClip) == SINEW_BEHAVIOUR_CLIP &&
              int(BehaviourState::kPassive) == SINEW_BEHAVIOUR_PASSIVE &&
              int(BehaviourState::kBalance) == SINEW_BEHAVIOUR_BALANCE &&
              int(BehaviourState::kStep) == SINEW_BEHAVIOUR_STEP &&
              int(BehaviourState::kFall) == SINEW_BEHAVIOUR_FALL &&
              int(BehaviourState::kDown) == SINEW_BEHAVIOUR_DOWN);

constexpr auto kSettings = [](auto& c, auto& s, auto&& f) {
  f("most_steps must be 0 to 1000", c.most_steps, s.most_steps, 0, 1000);
  f("reaction must be 0 to 10 s", c.reaction, s.reaction, 0, 10);
  f("gravity must be 1e-3 to 1e4 m/s2", c.gravity, s.gravity, 1e-3, 1e4);
  f("help_torque must be 0 to 1e9 N m", c.help_torque, s.help_torque, 0, 1e9);
  f("fallen_strength must be 0 to 1000", c.fallen_strength, s.fallen_strength, 0, 1000);
  f("let_go must be 0 to 10 s", c.let_go, s.let_go, 0, 10);
};

/// act(Behaviour&, character) of a character that has one.
template <class Act>
sinew_status with_behaviour(sinew_character handle, Act&& act) noexcept {
  return with_character(handle, [&](OwnedWorld& w, const Character<float>& character) {
    Behaviour<float>* const behaviour = w.behaviours[std::size_t(index_of(handle))].get();
    if (!behaviour) return fail(SINEW_INVALID_ARGUMENT, "the character has no behaviour");
    return act(*behaviour, character);
  });
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
    auto made = std::make_unique<Behaviour<float>>(c.skeleton(), read, status);
    if (status) w.behaviours[std::size_t(index_of(character))] = std::move(made);
    return answer(status);
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
    if (order != SINEW_BEHAVIOUR_KNOCK_DOWN && order != SINEW_BEHAVIOUR_STAND)
      return fail(SINEW_INVALID_ARGUMENT, "no such order", order);
    if (order == SINEW_BEHAVIOUR_STAND)
      behaviour.stand(c);
    else
      behaviour.knock_down(c);
    return sinew_status(SINEW_OK);
  });
}

sinew_status sinew_character_get_behaviour(sinew_character character, sinew_behaviour_report* out) {
  return with_behaviour(character, [&](Behaviour<float>& behaviour, const Character<float>&) {
    return fill_sized(out, [&](sinew_behaviour_report& r) {
      const BehaviourReport& report = behaviour.report();
      r.state = static_cast<sinew_behaviour_state>(report.state);
      r.steps = report.steps;
      r.capture_depth = report.capture_depth;
      r.time = report.time;
      r.fell_beyond = report.fell_beyond;
    });
  });
}
