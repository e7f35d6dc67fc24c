// Impacts in IslandStepper: what strikes within a step does so where it is, before the solve.
#include <algorithm>
#include <array>
#include <utility>

#include "sinew/character/island.h"
#include "sinew/character/return_to_animation.h"
#include "sinew/character/unknowns.h"
#include "sinew/optimizer/joint_terms.h"

namespace sinew {
namespace {

/// rad/s of a human; joints that reach their limits more slowly rest there.
constexpr double kLimitSpeed = 2;
constexpr double kReached = 1e-6;   ///< rad, m of a human
constexpr double kNearLimit = 1.5;  ///< rad; what is further off reaches no limit in a step

}  // namespace

/// Whether all can be struck as they are: their accelerations are known.
template <class T>
bool IslandStepper<T>::may_land() const {
  return !settings_.plan->scheme &&
         std::all_of(states_.begin(), states_.end(),
                     [](const CharacterState<T>* s) { return s->history.accelerates; });
}

/// Whether something ties two trees to each other.
template <class T>
bool IslandStepper<T>::are_tied(int a, int b) const {
  return std::any_of(couplings_.begin(), couplings_.end(), [&](const Coupling<T>* c) {
    const auto has = [&](int tree) {
      return std::any_of(c->nodes.begin(), c->nodes.end(),
                         [&](const CouplingNode<T>& node) { return node.tree == tree; });
    };
    return has(a) && has(b);
  });
}

/// Whether a contact strikes within h, and what it strikes with, or at, no muscles move, nor carry: where an
/// animation sets a foot down, the clip knows how.
template <class T>
bool IslandStepper<T>::strikes(const Contact<T>& c, T h) const {
  const bool thrown = states_[c.tree_a]->passive() || (c.tree_b >= 0 && states_[c.tree_b]->passive());
  return thrown && strikes_within(c, h) && !(c.tree_b >= 0 && are_tied(c.tree_a, c.tree_b));
}

/// How a contact parts when it strikes.
template <class T>
Bounce<T> IslandStepper<T>::bounce_of(const Contact<T>& c, T h) const {
  for (const auto& effect : effects_)
    if (const Bounce<T> bounce = effect->bounce_of(c, world_->gravity, h); bounce.share > T(0)) return bounce;
  return {};
}

/// Whether a contact that is open at the first guess is so all along the way, as far as anybody looks.
template <class T>
bool IslandStepper<T>::passes_by(const Contact<T>& c) const {
  return std::none_of(effects_.begin(), effects_.end(),
                      [&](const auto& effect) { return effect->meets_on_the_way(trees_, c); });
}

/// How fast a joint [its degrees of freedom] moves towards its limits where the part begins: what muscles
/// move, against its animation. A clip that carries a joint to its stop does not strike there.
template <class T>
std::array<T, 6> IslandStepper<T>::rate_at_start(const CharacterState<T>& s, int i) const {
  std::array<T, 6> rate{};
  if (!s.passive()) {
    const Deviation<T>& d = s.deviation[i];
    return d.on_animation ? rate : spin_of_rate<T>(s.tree.type[i], d.offset, d.rate);
  }
  const Kinematics<T>& k = s.problem.kinematics;
  const Vec3<T> spin = angular_velocity(s.history, i) - angular_velocity(s.history, s.tree.parent[i]);
  for (int n = 0; n < s.tree.dof_count(i); ++n) rate[n] = k.w[s.tree.first_dof[i] + n].dot(spin);
  return rate;
}

/// Calls act(row, closes) for every limit of a tree's joints where the part begins; closes: it may strike
/// within h. `all`: else not for joints that hardly move.
template <class T>
template <class Act>
void IslandStepper<T>::for_each_limit(CharacterState<T>& s, T h, bool all, const Act& act) {
  TreeProblem<T>& p = s.problem;
  if (s.is_prop || (!p.law.present.ranges && !p.law.present.cones)) return;
  const T slow = T(kLimitSpeed) / s.tree.scale.time;
  for (int i = 0; i < s.tree.bodies; ++i) {
    if (s.tree.parent[i] < 0 || s.tree.dof_count(i) == 0) continue;
    const std::array<T, 6> rate = rate_at_start(s, i);
    if (!all && std::all_of(rate.begin(), rate.end(), [&](T r) { return 2 * std::abs(r) < slow; })) continue;
    p.clear_rows();
    const Transform<T> guess = std::exchange(p.local[i], p.start[i]);
    append_limit_rows(settings_, p, i);
    p.local[i] = guess;
    for (const JointRow<T>& row : p.rows) {
      T speed = T(0);
      for (int a = 0; a < row.count; ++a) speed += row.gradient[a] * rate[row.dof - s.tree.first_dof[i] + a];
      act(row, speed > slow && row.value < h * speed && row.value + h * speed > T(0));
    }
  }
  p.clear_rows();
}

/// Whether a joint strikes a limit within h, at the speed that its bodies have.
template <class T>
bool IslandStepper<T>::strikes_limit(CharacterState<T>& s, T h) {
  if (!s.passive() && s.calm) return false;
  bool any = false;
  for_each_limit(s, h, false, [&](const JointRow<T>&, bool closes) { any = any || closes; });
  return any;
}

/// The limits of all joints of a tree that give way.
template <class T>
void IslandStepper<T>::add_limits(CharacterState<T>& s, int tree, T h) {
  for_each_limit(s, h, true, [&](const JointRow<T>& row, bool closes) {
    if (!ends_.loose(tree, row.dof) || (!closes && !s.passive() && row.value < T(-kReached))) return;
    if (row.value > T(-kNearLimit)) ends_.add_limit(tree, row, !closes, T(kLimitSpeed));
  });
}

/// Impacts change velocities where they happen, as impulses do (strike()): at the end of the step a stretched
/// limb has folded, and what strikes with it weighs a fraction. They are found along the way to the first
/// guess, one after the other; until then each body goes on as it did. The solve finds what is left, and what
/// lasts.
template <class T>
void IslandStepper<T>::land(T h) {
  landed_ = false;
  for (Contact<T>& c : contacts_) c.bounced = false;
  T fastest = T(0);
  for (const Contact<T>& c : contacts_)
    if (strikes(c, h)) fastest = std::max(fastest, c.approach);
  const bool any_limit =
      std::any_of(states_.begin(), states_.end(), [&](CharacterState<T>* s) { return strikes_limit(*s, h); });
  if ((!(fastest > T(0)) && !any_limit) || !may_land()) return;
  loose_.clear();
  for (const CharacterState<T>* s : states_) append_loose(*s);
  ends_.begin(problems_, loose_);
  for (std::size_t n = 0; n < states_.size(); ++n) {
    CharacterState<T>& s = *states_[n];
    TreeProblem<T>& p = s.problem;
    forward_kinematics<T>(s.tree, p.local, p.common_origin, s.guessed);
    p.local = p.start;
    driven_rates_.assign(s.tree.bodies, {});
    if (!s.passive()) measure_driven_at_start(s, static_cast<int>(n));
    ends_.project(static_cast<int>(n), driven_rates_, s.rate, {}, s.history);
    add_limits(s, static_cast<int>(n), h);
  }
  for (const Coupling<T>* c : couplings_)
    for (const Stencil<T>& e : c->stencils)
      if (e.tight > T(0)) ends_.add_tied(*c, e);
  for (const Contact<T>& c : contacts_) {
    const Bounce<T> bounce = bounce_of(c, h);
    // See ContactFinder::stiffen_for_impact; but what lies beside what bounces may be struck next.
    const bool slides_on = c.fresh && c.approach == T(0) &&
                           !(bounce.share > T(0) && c.tree_b >= 0 && c.meeting != Meeting::kSolids);
    if (slides_on || c.start_gap > h * fastest) continue;
    if (!c.fresh) {
      ends_.add_bearing(c);
      continue;
    }
    if (strikes_within(c, h) && !strikes(c, h)) continue;
    Contact<T> guessed = c;
    settings_.plan->contacts->measure(states_[c.tree_a]->guessed,
                                      c.tree_b < 0 ? nullptr : &states_[c.tree_b]->guessed, guessed);
    if (guessed.gap > T(0) && strikes_within(c, h) && passes_by(c)) continue;
    const bool beyond = guessed.normal.dot(c.normal) < T(kSamePlane) || -guessed.gap > half_thickness(c);
    ends_.add_striking(c, beyond ? T(0) : (guessed.gap - c.start_gap) / h + c.approach, bounce);
  }
  landed_ = ends_.strike(h, T(kImpactSpeed));
  if (landed_) note_bounces();
  for (CharacterState<T>* s : states_) first_guess(*s, h);
  if (landed_ && log_) log_strikes();
  if (landed_) take_landing(h);
}

/// What has bounced does not do so again after the solve.
template <class T>
void IslandStepper<T>::note_bounces() {
  if (effects_.empty()) return;
  ends_.for_each_pushed([&](std::uint64_t id, T) {
    if (Contact<T>* c = find_contact(id)) c->bounced = c->restitution > T(0);
  });
}

/// Velocities of the joints that strikes do not move, where a part begins.
template <class T>
void IslandStepper<T>::measure_driven_at_start(const CharacterState<T>& s, int tree) {
  const Kinematics<T>& k = s.problem.kinematics;
  const auto twist = [&](int i) {
    Twist<T> of;
    of.w = angular_velocity(s.history, i);
    of.v = s.history.velocity[i] - of.w.cross(k.center[i]);
    return of;
  };
  for (int i = 0; i < s.tree.bodies; ++i) {
    const int first = s.tree.first_dof[i], count = s.tree.dof_count(i), parent = s.tree.parent[i];
    if (count > 0 ? ends_.loose(tree, first) : parent >= 0) continue;
    driven_rates_[i] = twist(i);
    if (parent < 0) continue;
    const Twist<T> outer = twist(parent);
    driven_rates_[i].w -= outer.w;
    driven_rates_[i].v -= outer.v;
  }
}

/// The velocities that impacts have left into the trees, and what bodies move less for having gone on until
/// then.
template <class T>
void IslandStepper<T>::take_landing(T h) {
  number_bodies();
  for (auto* v : {&struck_velocity_, &struck_momentum_})
    if (v->empty()) v->assign(start_sped_.size(), Vec3<T>::Zero());
  kept_.clear();
  late_jumps_.assign(start_sped_.size(), {});
  for (std::size_t n = 0; n < states_.size(); ++n) {
    CharacterState<T>& s = *states_[n];
    History<T>& history = s.history;
    const int first = first_body_[n];
    for (int i = 0; i < s.tree.bodies; ++i)
      kept_.push_back({history.velocity[i], history.momentum[i], struck_velocity_[first + i],
                       struck_momentum_[first + i], history.rotation_rate[i], s.rate[i], s.deviation[i]});
    if (!ends_.struck(static_cast<int>(n))) continue;
    ends_.write(static_cast<int>(n), history, s.rate);
    for (auto* v : {&moved_, &turned_}) v->resize(s.tree.bodies);
    ends_.missed(static_cast<int>(n), moved_, turned_);
    for (int i = 0; i < s.tree.bodies; ++i) {
      const Mat3<T>& r = s.problem.kinematics.rotation[i];
      struck_velocity_[first + i] += moved_[i];
      struck_momentum_[first + i] += r * (s.tree.inertia[i] * (r.transpose() * turned_[i]));
    }
    const auto late = std::span(late_jumps_).subspan(first, s.tree.bodies);
    ends_.answered(static_cast<int>(n), late);  // of what missed() has found
    if (!s.passive()) lead_back(s, static_cast<int>(n), h);
    first_guess(s, h);
    for (int i = 0; i < s.tree.bodies; ++i) {
      if (s.tree.dof_count(i) == 0 || !s.problem.free[s.tree.first_dof[i]]) continue;
      std::array<T, 6> less;
      for (std::size_t k = 0; k < less.size(); ++k) less[k] = -h * late[i][k];
      s.problem.local[i] = at_offset<T>(s.tree, i, s.problem.local[i], less);
    }
  }
}

/// Muscles lead back what was struck. Its way begins at its new speed, and as far behind as it went on at the
/// old one.
template <class T>
void IslandStepper<T>::lead_back(CharacterState<T>& s, int tree, T h) {
  jumps_.resize(s.tree.bodies);
  ends_.strike_changed(tree, jumps_);
  for (int i = 0; i < s.tree.bodies; ++i) {
    add_to_rate(s, i, jumps_[i]);
    Deviation<T>& d = s.deviation[i];
    const std::array<T, 6> late =
        rate_of_spin<T>(s.tree.type[i], d.offset, late_jumps_[first_body_[tree] + i]);
    for (int k = 0; k < s.tree.dof_count(i); ++k) d.offset[k] -= h * late[k];
  }
  s.clear_deviations();
  choose_targets<T>(s, return_time(), height_of_floor<T>(*world_, settings_.common_origin.z()), h);
}

/// Before the same part is taken in two.
template <class T>
void IslandStepper<T>::take_back_landing() {
  if (!landed_) return;
  landed_ = false;
  if (log_) log_->take_back_strikes();
  auto kept = kept_.begin();
  int body = 0;
  for (CharacterState<T>* s : states_)
    for (int i = 0; i < s->tree.bodies; ++i, ++kept, ++body) {
      s->history.velocity[i] = kept->velocity;
      s->history.momentum[i] = kept->momentum;
      s->history.rotation_rate[i] = kept->rotation_rate;
      s->rate[i] = kept->rate;
      s->deviation[i] = kept->deviation;
      struck_velocity_[body] = kept->struck_velocity;
      struck_momentum_[body] = kept->struck_momentum;
    }
  for (CharacterState<T>* s : states_) s->clear_deviations();
}

#define SINEW_LANDING_INSTANCES(T)                                                                \
  template bool IslandStepper<T>::may_land() const;                                               \
  template void IslandStepper<T>::land(T);                                                        \
  template bool IslandStepper<T>::strikes(const Contact<T>&, T) const;                            \
  template bool IslandStepper<T>::are_tied(int, int) const;                                       \
  template Bounce<T> IslandStepper<T>::bounce_of(const Contact<T>&, T) const;                     \
  template void IslandStepper<T>::note_bounces();                                                 \
  template std::array<T, 6> IslandStepper<T>::rate_at_start(const CharacterState<T>&, int) const; \
  template bool IslandStepper<T>::strikes_limit(CharacterState<T>&, T);                           \
  template void IslandStepper<T>::add_limits(CharacterState<T>&, int, T);                         \
  template bool IslandStepper<T>::passes_by(const Contact<T>&) const;                             \
  template void IslandStepper<T>::measure_driven_at_start(const CharacterState<T>&, int);         \
  template void IslandStepper<T>::lead_back(CharacterState<T>&, int, T);                          \
  template void IslandStepper<T>::take_landing(T);                                                \
  template void IslandStepper<T>::take_back_landing();
SINEW_LANDING_INSTANCES(float)
SINEW_LANDING_INSTANCES(double)

}  // namespace sinew
