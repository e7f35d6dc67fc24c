// Where IslandStepper starts a solve: not beyond what its bodies would strike on the way.
#include <algorithm>

#include "sinew/character/baking.h"
#include "sinew/character/island.h"
#include "sinew/character/unknowns.h"

namespace sinew {
namespace {

constexpr double kDeep = 0.03;  ///< m; guesses that go no deeper are left again in a pass or two

constexpr double kSharesTurn = 0.1;  ///< of a figure's kinetic energy; whatever less does is not worth a part

}  // namespace

/// Starts the solve nearer to where it was, where an effect says so.
template <class T>
void IslandStepper<T>::limit_guess(T h) {
  free_share_.assign(states_.size(), T(1));
  for (const auto& effect : effects_) effect->limit_guess(trees_, contacts_, h, free_share_);
  for (std::size_t n = 0; n < states_.size(); ++n)
    if (free_share_[n] < T(1)) first_guess(*states_[n], h, free_share_[n]);
}

/// Whether a figure that falls, or is off its animation, has a body that turns too far in h.
template <class T>
bool IslandStepper<T>::turns_far(T h) const {
  const Accuracy& accuracy = world_->accuracy;
  const T most = T(accuracy.max_rotation);
  if (!(most > T(0)) || !may_divide()) return false;
  return std::any_of(states_.begin(), states_.end(), [&](const CharacterState<T>* s) {
    const bool moves = !s->is_prop && (s->passive() || !s->undisturbed());
    return moves && h > T(1.5 * accuracy.shortest_part) * s->tree.scale.time &&
           largest_turn<T>(s->tree, s->history, h) > most &&
           share_turning_faster<T>(s->tree, s->history, most / h) > T(kSharesTurn);
  });
}

/// Whether what strikes would be deep inside by the end of the step, at the speed that it has.
template <class T>
bool IslandStepper<T>::strikes_deep(T h) const {
  return std::any_of(contacts_.begin(), contacts_.end(), [&](const Contact<T>& c) {
    return c.fresh && h * c.approach - c.start_gap > T(kDeep) * c.length_scale;
  });
}

/// A guess that goes deep into something is up a hill of the energy, with other minima beside it. Where the
/// trees began lies lower, as a rule: the one of the two that does is where the solve starts.
template <class T>
void IslandStepper<T>::choose_guess(T h) {
  const double ahead = solver_.energy(settings_, problems_, contacts_, couplings_);
  const auto guess = [&](auto share_of) {
    for (std::size_t n = 0; n < states_.size(); ++n) {
      first_guess(*states_[n], h, share_of(n));
      move_baked<T>(*states_[n], world_->detail, static_cast<int>(n), contacts_, settings_);
    }
  };
  guess([](std::size_t) { return T(0); });
  if (solver_.energy(settings_, problems_, contacts_, couplings_) < ahead) return;
  guess([&](std::size_t n) { return effects_.empty() ? T(1) : free_share_[n]; });
}

#define SINEW_GUESS_INSTANCES(T)                         \
  template void IslandStepper<T>::limit_guess(T);        \
  template bool IslandStepper<T>::turns_far(T) const;    \
  template bool IslandStepper<T>::strikes_deep(T) const; \
  template void IslandStepper<T>::choose_guess(T);
SINEW_GUESS_INSTANCES(float)
SINEW_GUESS_INSTANCES(double)

}  // namespace sinew
