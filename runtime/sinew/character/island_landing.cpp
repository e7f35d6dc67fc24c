// Impacts in IslandStepper: what strikes within a step does so where it is, before the solve.
#include <algorithm>

#include "sinew/character/island.h"
#include "sinew/character/unknowns.h"

namespace sinew {

/// Whether all can be struck as they are: their accelerations are known, and no muscle answers.
template <class T>
bool IslandStepper<T>::may_land() const {
  return !settings_.plan->scheme && couplings_.empty() &&
         std::all_of(states_.begin(), states_.end(),
                     [](const CharacterState<T>* s) { return s->limp() && s->history.accelerates; });
}

/// Impacts of limp trees change velocities where they happen, as impulses on them do (strike()): at the end
/// of the step a stretched limb has folded, and what strikes with it weighs a fraction. They are found along
/// the way to the first guess, one after the other; until then each body goes on as it did. The solve finds
/// what is left, and what lasts. Contacts that bounce are left to it.
template <class T>
void IslandStepper<T>::land(T h) {
  landed_ = false;
  T fastest = T(0);
  for (const Contact<T>& c : contacts_)
    if (strikes_within(c, h) && c.restitution == T(0)) fastest = std::max(fastest, c.approach);
  if (!(fastest > T(0)) || !may_land()) return;
  begin_ends();
  for (std::size_t n = 0; n < states_.size(); ++n) {
    CharacterState<T>& s = *states_[n];
    TreeProblem<T>& p = s.problem;
    forward_kinematics<T>(s.tree, p.local, p.common_origin, s.guessed);
    p.local = p.start;
    led_rates_.assign(s.tree.bodies, {});
    ends_.project(static_cast<int>(n), led_rates_, s.rate, {}, s.history);
  }
  for (const Contact<T>& c : contacts_) {
    const bool slides_on = c.fresh && c.approach == T(0);  // see ContactFinder::stiffen_for_impact
    if (c.restitution > T(0) || slides_on || c.start_gap > h * fastest) continue;
    if (!c.fresh) {
      ends_.add_bearing(c);
      continue;
    }
    Contact<T> guessed = c;
    settings_.plan->contacts->measure(states_[c.tree_a]->guessed,
                                      c.tree_b < 0 ? nullptr : &states_[c.tree_b]->guessed, guessed);
    if (guessed.gap > T(0) && strikes_within(c, h)) continue;  // passes by
    const bool beyond = guessed.normal.dot(c.normal) < T(kSamePlane) || -guessed.gap > half_thickness(c);
    ends_.add_striking(c, beyond ? T(0) : (guessed.gap - c.start_gap) / h + c.approach);
  }
  landed_ = ends_.strike(h, T(kImpactSpeed));
  if (landed_) take_landing();
  for (CharacterState<T>* s : states_) first_guess(*s, h);
}

/// The velocities that impacts have left into the trees, and what bodies move less for having gone on until
/// then.
template <class T>
void IslandStepper<T>::take_landing() {
  number_bodies();
  for (auto* v : {&struck_velocity_, &struck_momentum_})
    if (v->empty()) v->assign(start_sped_.size(), Vec3<T>::Zero());
  kept_.clear();
  for (std::size_t n = 0; n < states_.size(); ++n) {
    CharacterState<T>& s = *states_[n];
    History<T>& h = s.history;
    const int first = first_body_[n];
    for (int i = 0; i < s.tree.bodies; ++i)
      kept_.push_back({h.velocity[i], h.momentum[i], struck_velocity_[first + i], struck_momentum_[first + i],
                       h.rotation_rate[i], s.rate[i]});
    if (!ends_.struck(static_cast<int>(n))) continue;
    ends_.write(static_cast<int>(n), h, s.rate);
    for (auto* v : {&moved_, &turned_}) v->resize(s.tree.bodies);
    ends_.missed(static_cast<int>(n), moved_, turned_);
    for (int i = 0; i < s.tree.bodies; ++i) {
      const Mat3<T>& r = s.problem.kinematics.rotation[i];
      struck_velocity_[first + i] += moved_[i];
      struck_momentum_[first + i] += r * (s.tree.inertia[i] * (r.transpose() * turned_[i]));
    }
  }
}

/// Before the same part is taken in two.
template <class T>
void IslandStepper<T>::take_back_landing() {
  if (!landed_) return;
  landed_ = false;
  auto kept = kept_.begin();
  int body = 0;
  for (CharacterState<T>* s : states_)
    for (int i = 0; i < s->tree.bodies; ++i, ++kept, ++body) {
      s->history.velocity[i] = kept->velocity;
      s->history.momentum[i] = kept->momentum;
      s->history.rotation_rate[i] = kept->rotation_rate;
      s->rate[i] = kept->rate;
      struck_velocity_[body] = kept->struck_velocity;
      struck_momentum_[body] = kept->struck_momentum;
    }
}

#define SINEW_LANDING_INSTANCES(T)                  \
  template bool IslandStepper<T>::may_land() const; \
  template void IslandStepper<T>::land(T);          \
  template void IslandStepper<T>::take_landing();   \
  template void IslandStepper<T>::take_back_landing();
SINEW_LANDING_INSTANCES(float)
SINEW_LANDING_INSTANCES(double)

}  // namespace sinew
