// Where IslandStepper starts a solve: not beyond what its bodies would strike on the way.
#include <algorithm>

#include "sinew/character/baking.h"
#include "sinew/character/island.h"
#include "sinew/character/unknowns.h"

namespace sinew {
namespace {

constexpr double kDeep = 0.03;  ///< m; guesses that go no deeper are left again in a pass or two

constexpr double kSharesTurn = 0.1;  ///< of a figure's kinetic energy; whatever less does is not worth a part
constexpr double kShareOfProps = 0.01;  ///< of the kinetic energy of all that is stepped together
/// Of how far others turn in a part: what spins between two hinges wobbles, and a top leaves its precession.
constexpr double kTied = 0.6;

}  // namespace

/// Starts the solve nearer to where it was, where an effect says so.
template <class T>
void IslandStepper<T>::limit_guess(T h) {
  free_share_.assign(states_.size(), T(1));
  for (const auto& effect : effects_) effect->limit_guess(trees_, contacts_, h, free_share_);
  for (std::size_t n = 0; n < states_.size(); ++n)
    if (free_share_[n] < T(1)) first_guess(*states_[n], h, free_share_[n]);
}

/// Whether a prop goes by its turning: it rolls on what it bears on, or something holds it at a point.
template <class T>
bool IslandStepper<T>::goes_by_turning(std::size_t n) const {
  const CharacterState<T>& s = *states_[n];
  if (s.tied) return true;
  const bool round = std::all_of(s.colliders.begin(), s.colliders.end(),
                                 [](const Collider& c) { return !is_polyhedron(c.shape); });
  return round && std::any_of(lagged_.begin(), lagged_.end(),
                              [&](const LaggedForce<T>& f) { return is_of_tree(f.id, indices_[n]); });
}

/// Whether a figure that falls, or is off its animation, has a body that turns too far in h; or so many props
/// do, whose way depends on it, that they have a share in the motion of all.
template <class T>
bool IslandStepper<T>::turns_far(T h) const {
  const Accuracy& accuracy = world_->accuracy;
  if (!(accuracy.max_rotation > 0) || !may_divide()) return false;
  const auto kinetic = [](const CharacterState<T>& s) {
    return totals<T>(s.tree, s.history, Vec3<double>::Zero()).kinetic_energy;
  };
  double turning = 0;  // J, of these props' spins
  for (std::size_t n = 0; n < states_.size(); ++n) {
    const CharacterState<T>& s = *states_[n];
    const T most = T(accuracy.max_rotation) * (s.is_prop && s.tied ? T(kTied) : T(1));
    if (h <= T(1.5 * accuracy.shortest_part) * s.tree.scale.time ||
        !(largest_turn<T>(s.tree, s.history, h) > most))
      continue;
    if (!s.is_prop) {
      const bool moves = s.passive() || !s.undisturbed();
      if (moves && share_turning_faster<T>(s.tree, s.history, most / h) > T(kSharesTurn)) return true;
    } else if (!s.is_particles && goes_by_turning(n)) {
      turning += kinetic(s) - 0.5 * s.total_mass * double(s.history.velocity[0].squaredNorm());
    }
  }
  double all = 0;
  for (std::size_t n = 0; turning > 0 && n < states_.size(); ++n) all += kinetic(*states_[n]);
  return turning > kShareOfProps * all;
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

#define SINEW_GUESS_INSTANCES(T)                                      \
  template bool IslandStepper<T>::goes_by_turning(std::size_t) const; \
  template void IslandStepper<T>::limit_guess(T);                     \
  template bool IslandStepper<T>::turns_far(T) const;                 \
  template bool IslandStepper<T>::strikes_deep(T) const;              \
  template void IslandStepper<T>::choose_guess(T);
SINEW_GUESS_INSTANCES(float)
SINEW_GUESS_INSTANCES(double)

}  // namespace sinew
