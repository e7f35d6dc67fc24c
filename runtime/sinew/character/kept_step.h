// What a step changes of a character: kept before it is taken, so that it can be taken again with others.
// Internal to the character layer.
#pragma once

#include <tuple>

#include "sinew/character/memory.h"
#include "sinew/character/state.h"

namespace sinew {

/// All that a step changes and reads, or leaves for whoever asks; what snapshots restore is among these. What
/// is left out is a rig's, the host's, or room that is written before it is read, `motion` too: who owes a
/// history works it out from the target.
template <class T>
auto changed_by_steps(CharacterState<T>& s) {
  return std::tie(s.calm, s.left_to_gravity, s.target_before, s.target_stands, s.local, s.played_from,
                  s.deferred, s.rate, s.rate_before, s.rate_step, s.rate_step_before, s.deviation, s.torque,
                  s.load, s.limit, s.smooth, s.lasting, s.lasting_before, s.unknown, s.history, s.baked,
                  s.unbaked, s.contact_signature, s.limit_signature, s.steps_unchanged, s.collision_suspended,
                  s.unsolved, s.energy_ceiling, s.depenetration_energy, s.levels, s.report, s.grounding.rest,
                  s.grounding.returns);
}

template <class T>
class KeptStep {
 public:
  /// Set-up; keep() and restore() allocate nothing afterwards.
  explicit KeptStep(CharacterState<T>& state) : members_(changed_by_steps(state)) {}
  void keep(CharacterState<T>& state) { members_ = changed_by_steps(state); }
  void restore(CharacterState<T>& state) const {
    changed_by_steps(state) = members_;
    state.pose_changed();
  }
  /// Beside itself.
  std::size_t bytes() const {
    return std::apply([](const auto&... member) { return (std::size_t{0} + ... + bytes_held(member)); },
                      members_);
  }

 private:
  template <class... Members>
  static std::tuple<Members...> values(std::tuple<Members&...>);
  using Values = decltype(values(changed_by_steps(std::declval<CharacterState<T>&>())));

  Values members_;
};

}  // namespace sinew
