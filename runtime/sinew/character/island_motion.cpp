// Bossak's scheme in IslandStepper: what a step predicts, and the motion that it leaves (bossak.h).
#include <algorithm>
#include <cmath>

#include "sinew/character/island.h"
#include "sinew/character/touch_digest.h"
#include "sinew/character/unknowns.h"

namespace sinew {
namespace {

/// That a contact's force would take to do what it does to velocities at most: one that has hardly begun to
/// bear is no wall yet. Falls keep as much energy with 2 as without a bound, and less with a half.
constexpr double kMostSteps = 2;

}  // namespace

/// The set that each tree belongs to: those that may touch in this step, or are tied. Numbered by their first
/// trees.
template <class T>
void IslandStepper<T>::find_sets() {
  const int count = static_cast<int>(states_.size());
  set_.resize(count);
  for (int n = 0; n < count; ++n) set_[n] = n;
  const auto first_of = [&](int n) {
    while (set_[n] != n) n = set_[n];
    return n;
  };
  const auto join = [&](int a, int b) {
    a = first_of(a), b = first_of(b);
    set_[std::max(a, b)] = std::min(a, b);
  };
  for (const Contact<T>& c : contacts_)
    if (c.tree_b >= 0) join(c.tree_a, c.tree_b);
  if (!couplings_.empty())
    for (int n = 1; n < count; ++n) join(0, n);
  for (int n = 0; n < count; ++n) set_[n] = first_of(n);
}

/// Targets of Bossak's scheme, with one spectral radius for all that may touch: contact forces are equal and
/// opposite in the momentum that they give only then.
template <class T>
void IslandStepper<T>::predict_all(T h) {
  find_sets();
  driven_.assign(states_.size(), 0);
  radius_.assign(states_.size(), T(1));
  for (std::size_t n = 0; n < states_.size(); ++n)
    if (!states_[n]->passive() || !couplings_.empty()) driven_[set_[n]] = 1;
  for (std::size_t n = 0; n < states_.size(); ++n) {
    T& radius = radius_[set_[n]];
    radius = std::min(radius, spectral_radius<T>(largest_turn<T>(states_[n]->tree, states_[n]->history, h),
                                                 driven_[set_[n]] != 0));
  }
  number_bodies();
  for (std::size_t n = 0; n < states_.size(); ++n) {
    CharacterState<T>& s = *states_[n];
    TreeProblem<T>& p = s.problem;
    predict_bossak<T>(s.tree, s.history, strike_of(n), radius_[set_[n]], h, settings_.common_origin,
                      p.prediction);
    if (s.pushed()) write_pushes(s, constant_emphasis(p.prediction.weight, h));
  }
}

/// The same of implicit Euler: for a restart, and for a first step whose accelerations could not be found.
template <class T>
void IslandStepper<T>::predict_euler_all(T h) {
  for (CharacterState<T>* s : states_) {
    TreeProblem<T>& p = s->problem;
    predict_euler<T>(s->tree, s->history, h, settings_.common_origin, p.prediction);
    if (s->pushed()) write_pushes(*s, T(1));
  }
}

/// Appends to `loose_` which of a tree's degrees of freedom give way to what strikes: those of limp trees,
/// and of those that muscles move which are not infinitely strong.
template <class T>
void IslandStepper<T>::append_loose(const CharacterState<T>& s) {
  const JointLaw<T>& law = s.problem.law;
  const bool passive = s.passive(), gives_way = s.levels.allowed >= Level::kPartial;
  for (int dof = 0; dof < s.tree.dofs; ++dof) {
    const bool driven =
        s.root_is_kinematic() && s.tree.type[0] == JointType::kFree && dof < s.tree.first_dof[1];
    const bool weak = std::isfinite(law.torque_minus[dof]) && std::isfinite(law.torque_plus[dof]);
    loose_.push_back(passive || (gives_way && !driven && weak));
  }
}

/// A joint moves by so much faster than its animation.
template <class T>
void IslandStepper<T>::add_to_rate(CharacterState<T>& s, int i, const std::array<T, 6>& spin) {
  Deviation<T>& d = s.deviation[i];
  const std::array<T, 6> jump = rate_of_spin<T>(s.tree.type[i], d.offset, spin);
  for (int k = 0; k < s.tree.dof_count(i); ++k) {
    d.rate[k] += jump[k];
    d.on_animation = d.on_animation && spin[k] == T(0);
  }
}

/// Impulses that strike change velocities where the bodies are, before the step: over the step they would act
/// on what has moved by then, and on which they have more effect, and on muscles that have the whole step to
/// resist. Muscles lead what was struck back; it begins at its new speed, while what is limp moves as under
/// the constant force that the impulse is the mean of: `velocity` and `momentum` [body] are what that leaves
/// out.
template <class T>
void IslandStepper<T>::strike(CharacterState<T>& s, std::span<Vec3<T>> velocity,
                              std::span<Vec3<T>> momentum) {
  TreeProblem<T>& p = s.problem;
  const Vec3<T> origin = s.floats ? s.local[0].translation : Vec3<T>(Vec3<T>::Zero());
  forward_kinematics<T>(s.tree, std::span<const Transform<T>>(s.local).first(s.tree.bodies), origin,
                        p.kinematics);
  p.clear_wrenches();
  for (const ExternalForce<T>& impulse : s.impulses) {
    const Vec3<T> at =
        p.kinematics.origin[impulse.body] + p.kinematics.rotation[impulse.body] * impulse.local;
    p.force[impulse.body] += impulse.force;
    p.moment[impulse.body] += at.cross(impulse.force);
  }
  jump_force_.assign(s.tree.dofs, T(0));
  project_wrenches<T>(s.tree, p.kinematics, p.force, p.moment, jump_force_);
  loose_.clear();
  append_loose(s);
  TreeProblem<T>* const struck = &p;
  ends_.begin({&struck, 1}, loose_);
  turned_.resize(s.tree.bodies);
  ends_.respond(0, jump_force_, velocity, turned_);
  for (int i = 0; i < s.tree.bodies; ++i) {
    const Mat3<T>& r = p.kinematics.rotation[i];
    momentum[i] = r * (s.tree.inertia[i] * (r.transpose() * turned_[i]));
    s.history.velocity[i] += velocity[i];
    s.history.momentum[i] += momentum[i];
    s.history.rotation_rate[i] += skew<T>(turned_[i]) * r;
    velocity[i] /= 2;  // they act all along the step
    momentum[i] /= 2;
  }
  if (s.passive()) return;
  jumps_.resize(s.tree.bodies);
  ends_.answered(0, jumps_);
  for (int i = 0; i < s.tree.bodies; ++i) add_to_rate(s, i, jumps_[i]);
  s.clear_deviations();
  std::fill_n(velocity.begin(), s.tree.bodies, Vec3<T>(Vec3<T>::Zero()));
  std::fill_n(momentum.begin(), s.tree.bodies, Vec3<T>(Vec3<T>::Zero()));
}

/// The same of all trees.
template <class T>
void IslandStepper<T>::strike_all() {
  const auto struck = [&](const CharacterState<T>* s) { return s->is_struck(return_time()); };
  for (auto* v : {&struck_velocity_, &struck_momentum_}) v->clear();
  blow_ = std::any_of(states_.begin(), states_.end(), struck);
  if (!blow_) return;
  std::size_t body = 0;
  for (CharacterState<T>* s : states_) {
    for (auto* v : {&struck_velocity_, &struck_momentum_}) v->resize(body + s->tree.bodies, Vec3<T>::Zero());
    if (struck(s))
      strike(*s, std::span(struck_velocity_).subspan(body), std::span(struck_momentum_).subspan(body));
    body += s->tree.bodies;
  }
}

/// What impulses keep a tree's bodies from in this step. The bodies are numbered.
template <class T>
Strike<T> IslandStepper<T>::strike_of(std::size_t n) const {
  if (struck_velocity_.empty()) return {};
  const auto bodies = [&](const auto& all) {
    return std::span(all).subspan(first_body_[n], states_[n]->tree.bodies);
  };
  return {bodies(struck_velocity_), bodies(struck_momentum_)};
}

/// Friction is constant over a step, as far as it is a force.
template <class T>
void IslandStepper<T>::emphasise_friction(T h) {
  if (settings_.plan->scheme) return;
  for (Contact<T>& c : contacts_) c.grip *= constant_emphasis(problems_[c.tree_a]->prediction.weight, h);
}

/// Undoes that, before another prediction: implicit Euler's forces are what they are.
template <class T>
void IslandStepper<T>::relax_friction(T h) {
  for (Contact<T>& c : contacts_) c.grip /= constant_emphasis(problems_[c.tree_a]->prediction.weight, h);
}

/// Takes what the constant forces [dof] of a tree make of its accelerations out of these, at the kinematics
/// that the problems hold.
template <class T>
void IslandStepper<T>::drop_constant(CharacterState<T>& s, int tree, std::span<const T> force) {
  for (auto* v : {&moved_, &turned_}) v->resize(s.tree.bodies);
  ends_.respond(tree, force, moved_, turned_);
  for (int i = 0; i < s.tree.bodies; ++i) {
    const Mat3<T>& r = s.problem.kinematics.rotation[i];
    s.history.acceleration[i] -= moved_[i];
    s.history.torque[i] -= r * (s.tree.inertia[i] * (r.transpose() * turned_[i]));
  }
}

/// Whether no degree of freedom of a tree can move in the step, but as it is driven.
template <class T>
bool IslandStepper<T>::is_locked(const CharacterState<T>& s) const {
  const auto none = [](const auto& v) {
    return std::all_of(v.begin(), v.end(), [](auto x) { return x == 0; });
  };
  return couplings_.empty() && s.problem.effects.empty() && none(s.problem.free) && none(s.baked);
}

/// The accelerations that smooth forces leave a tree that is locked: those of each body by itself. They have
/// the same part in the joints' freedom as those of the tree, Jᵀm a = JᵀF, and where no joint is free nothing
/// else of them counts.
template <class T>
void IslandStepper<T>::accelerate_locked(CharacterState<T>& s, int tree) {
  History<T>& h = s.history;
  fall(h);
  const auto act = [&](int body, const Vec3<T>& at, const Vec3<T>& force) {
    if (!(s.tree.mass[body] > T(0))) return;
    h.acceleration[body] += force / s.tree.mass[body];
    h.torque[body] += (at - s.problem.kinematics.center[body]).cross(force);
  };
  for (const Contact<T>& c : contacts_) {
    if (!(c.smooth_force > T(0))) continue;
    const Vec3<T> normal = c.smooth_force * c.normal;
    if (c.tree_a == tree) act(c.body_a, c.point, normal);
    if (c.tree_b == tree) act(c.body_b, c.point, Vec3<T>(-normal));
  }
}

/// The same of a tree on which nothing but gravity acts.
template <class T>
void IslandStepper<T>::fall(History<T>& h) const {
  std::fill(h.acceleration.begin(), h.acceleration.end(), settings_.gravity);
  std::fill(h.torque.begin(), h.torque.end(), Vec3<T>(Vec3<T>::Zero()));
}

/// Takes out of accelerations all that played animations took but gravity.
template <class T>
void IslandStepper<T>::drop_played() {
  bool begun = false;
  for (std::size_t n = 0; n < states_.size(); ++n) {
    CharacterState<T>& s = *states_[n];
    if (s.rate_step > T(0) || !s.history.accelerates) continue;
    TreeProblem<T>& p = s.problem;
    if (is_locked(s)) {
      fall(s.history);
      continue;
    }
    if (!begun) begin_ends();
    begun = true;
    for (int i = 0; i < s.tree.bodies; ++i) {
      p.force[i] = s.tree.mass[i] * (s.history.acceleration[i] - settings_.gravity);
      p.moment[i] = p.kinematics.center[i].cross(p.force[i]) + s.history.torque[i];
    }
    constant_.assign(s.tree.dofs, T(0));
    project_wrenches<T>(s.tree, p.kinematics, p.force, p.moment, constant_);
    drop_constant(s, static_cast<int>(n), constant_);
  }
}

/// How fast a contact opens where the part begins, m/s.
template <class T>
T IslandStepper<T>::opening_speed(const Contact<T>& c) const {
  const auto speed = [&](int tree, int body) {
    const CharacterState<T>& s = *states_[tree];
    const Vec3<T> arm = c.point - s.problem.kinematics.center[body];
    return Vec3<T>(s.history.velocity[body] + angular_velocity(s.history, body).cross(arm));
  };
  const Vec3<T> carried = c.tree_b < 0 ? Vec3<T>(Vec3<T>::Zero()) : speed(c.tree_b, c.body_b);
  return c.normal.dot(Vec3<T>(speed(c.tree_a, c.body_a) - carried));
}

/// The wrenches of forces that contacts bore in the step before, times `opened_`, into the problems' rooms.
template <class T>
void IslandStepper<T>::write_borne() {
  for (CharacterState<T>* s : states_) s->problem.clear_wrenches();
  const auto act = [&](int tree, int body, const Vec3<T>& at, const Vec3<T>& force) {
    TreeProblem<T>& p = states_[tree]->problem;
    p.force[body] += force;
    p.moment[body] += at.cross(force);
  };
  for (std::size_t k = 0; k < contacts_.size(); ++k) {
    const Contact<T>& c = contacts_[k];
    const Vec3<T> bore = opened_[k] * c.smooth_before * c.normal;
    if (bore.isZero(T(0))) continue;
    act(c.tree_a, c.body_a, c.point, bore);
    if (c.tree_b >= 0) act(c.tree_b, c.body_b, c.point, Vec3<T>(-bore));
  }
}

/// Takes out of accelerations what contacts bore until a blow parted them: their force ended before the step.
/// All of it where they stay open; less where they, bearing nothing, would close within the step again.
template <class T>
void IslandStepper<T>::drop_opened(T h) {
  const auto struck = [&](int n) {
    return n >= 0 && states_[n]->history.accelerates && states_[n]->is_struck(return_time());
  };
  const auto parts = [&](const Contact<T>& c) {
    return c.smooth_before > T(0) && (struck(c.tree_a) || struck(c.tree_b)) && opening_speed(c) > T(0);
  };
  opened_.clear();
  for (const Contact<T>& c : contacts_) opened_.push_back(parts(c) ? T(1) : T(0));
  if (std::all_of(opened_.begin(), opened_.end(), [](T x) { return x == T(0); })) return;
  const auto each_tree = [&](const auto& act) {  // act(tree): its generalised forces are in constant_
    write_borne();
    for (std::size_t n = 0; n < states_.size(); ++n) {
      CharacterState<T>& s = *states_[n];
      if (!s.history.accelerates || is_locked(s)) continue;
      constant_.assign(s.tree.dofs, T(0));
      project_wrenches<T>(s.tree, s.problem.kinematics, s.problem.force, s.problem.moment, constant_);
      act(static_cast<int>(n));
    }
  };
  begin_ends();
  shut_.assign(contacts_.size(), T(0));
  each_tree([&](int n) {
    const CharacterState<T>& s = *states_[n];
    for (auto* v : {&moved_, &turned_}) v->resize(s.tree.bodies);
    ends_.respond(n, constant_, moved_, turned_);
    const auto along = [&](const Contact<T>& c, int body) {
      const Vec3<T> arm = c.point - s.problem.kinematics.center[body];
      return c.normal.dot(Vec3<T>(moved_[body] + turned_[body].cross(arm)));
    };
    for (std::size_t k = 0; k < contacts_.size(); ++k) {
      const Contact<T>& c = contacts_[k];
      if (opened_[k] == T(0)) continue;
      if (c.tree_a == n) shut_[k] += along(c, c.body_a);
      if (c.tree_b == n) shut_[k] -= along(c, c.body_b);
    }
  });
  for (std::size_t k = 0; k < contacts_.size(); ++k) {
    Contact<T>& c = contacts_[k];
    if (opened_[k] == T(0)) continue;
    const T opens = opening_speed(c), closes = h * shut_[k];
    opened_[k] = opens < closes ? opens / closes : T(1);
  }
  each_tree([&](int n) { drop_constant(*states_[n], n, constant_); });
  for (std::size_t k = 0; k < contacts_.size(); ++k) {
    Contact<T>& c = contacts_[k];
    if (opened_[k] == T(0)) continue;
    c.smooth_before *= 1 - opened_[k];
    c.grip *= 1 - opened_[k];
    const auto left = std::lower_bound(lagged_.begin(), lagged_.end(), c.id,
                                       [](const LaggedForce<T>& f, std::uint64_t id) { return f.id < id; });
    left->smooth = c.smooth_before;  // should the part be halved
  }
}

/// Every degree of freedom loose, but those of trees that are locked.
template <class T>
void IslandStepper<T>::begin_ends() {
  loose_.clear();
  for (const CharacterState<T>* s : states_) loose_.insert(loose_.end(), s->tree.dofs, is_locked(*s) ? 0 : 1);
  ends_.begin(problems_, loose_);
}

/// Whether the same contacts and limits as in the steps before are expected at the end of this one. What a
/// carrier meets tells those who meet it.
template <class T>
void IslandStepper<T>::expect_to_last(T h) {
  lasts_.resize(states_.size());
  for (std::size_t n = 0; n < states_.size(); ++n)
    lasts_[n] = states_[n]->is_carrier() ||
                (states_[n]->steps_unchanged >= kUnchangedSteps &&
                 touching_soon<T>(contacts_, static_cast<int>(n), states_, world_->gravity, h) ==
                     states_[n]->contact_signature);
}

/// A point that has slid from one obstacle on to the next, of the same plane, bears there what it bore.
template <class T>
void IslandStepper<T>::take_over(Contact<T>& c) const {
  if (!c.fresh || c.tree_b >= 0 || !(normal_force(c) > T(0))) return;
  for (const Contact<T>& left : contacts_) {
    if (point_of(left) != point_of(c) || left.tree_b >= 0 || left.fresh || normal_force(left) > T(0))
      continue;
    if (left.frame.col(2).dot(c.normal) < T(kSamePlane)) continue;
    c.smooth_before = left.smooth_before;
    c.lasting_last = left.lasting_last;
    c.lasting_before = left.lasting_before;
    return;
  }
}

/// After a solve: splits the contacts' forces into smooth ones and impulses.
template <class T>
void IslandStepper<T>::split_contacts(T h) {
  for (std::size_t n = 0; n < states_.size(); ++n)
    lasts_[n] = states_[n]->is_carrier() ||
                (lasts_[n] && touching<T>(contacts_, static_cast<int>(n)) == states_[n]->contact_signature &&
                 bearing<T>(*problems_[n]) == states_[n]->limit_signature);
  for (Contact<T>& c : contacts_) {
    take_over(c);
    const T share = lasting_share(problems_[c.tree_a]->prediction.weight, h);
    split<T>(lasts_[c.tree_a] && (c.tree_b < 0 || lasts_[c.tree_b]), share, c);
  }
  for (Coupling<T>* c : couplings_) {
    if (!c->closes_slowly) continue;  // what gives is smooth
    bool last = true;
    T share = T(1);
    for (const CouplingNode<T>& node : c->nodes) {
      if (node.tree < 0) continue;
      last = last && lasts_[node.tree];
      share = lasting_share(problems_[node.tree]->prediction.weight, h);
    }
    for (Stencil<T>& e : c->stencils) e.carried.advance(stencil_pull(*c, e), last && !e.only_pulls, share);
  }
}

/// Where each tree's bodies and degrees of freedom begin among those of all.
template <class T>
void IslandStepper<T>::number_bodies() {
  for (auto* v : {&first_body_, &first_dof_}) v->clear();
  int bodies = 0, dofs = 0;
  for (const CharacterState<T>* s : states_) {
    first_body_.push_back(bodies);
    first_dof_.push_back(dofs);
    bodies += s->tree.bodies;
    dofs += s->tree.dofs;
  }
  for (auto* v : {&start_sped_, &start_spun_, &missed_, &unturned_}) v->resize(bodies);
  impulse_.resize(dofs);
}

/// Moves all trees' histories on to the solution.
template <class T>
void IslandStepper<T>::advance_one_step(T h) {
  split_contacts(h);
  turned_far_.assign(states_.size(), 0);
  for (std::size_t n = 0; n < states_.size(); ++n)
    measure_constant_at_start(*states_[n], static_cast<int>(n), h);
  begin_ends();
  for (std::size_t n = 0; n < states_.size(); ++n) {
    CharacterState<T>& s = *states_[n];
    TreeProblem<T>& p = s.problem;
    const bool locked = is_locked(s);
    const Jumps<T> jumps = locked ? Jumps<T>{} : measure_jumps(s, static_cast<int>(n), h);
    advance_bossak<T>(s.tree, p.kinematics, p.prediction, p.couple, jumps, h, settings_.common_origin,
                      s.history);
    if (locked) {
      for (auto* v : {&s.smooth, &s.lasting, &s.lasting_before}) std::fill(v->begin(), v->end(), T(0));
      accelerate_locked(s, static_cast<int>(n));
    } else {
      add_start(s, static_cast<int>(n));
    }
  }
  if (choose_loose()) ends_.begin(problems_, loose_);
  for (std::size_t n = 0; n < states_.size(); ++n) {
    CharacterState<T>& s = *states_[n];
    measure_driven(s, static_cast<int>(n), h);
    // Mean rates over the step, those before it: with both what is near to those at the end.
    for (int i = 0; s.rate_step_before > T(0) && i < s.tree.bodies; ++i)
      for (int k = 0; k < s.tree.dof_count(i); ++k)
        if (ends_.loose(static_cast<int>(n), s.tree.first_dof[i] + k))
          s.rate[i][k] = 2 * s.rate[i][k] - s.rate_before[i][k];
    ends_.project(static_cast<int>(n), driven_rates_, s.rate,
                  std::span<const T>(impulse_).subspan(first_dof_[n], s.tree.dofs), s.history);
  }
  press(h);
  for (std::size_t n = 0; n < states_.size(); ++n) {
    CharacterState<T>& s = *states_[n];
    ends_.write(static_cast<int>(n), s.history, s.rate);
  }
  for (auto* v : {&struck_velocity_, &struck_momentum_}) v->clear();  // in the parts to come nothing strikes
}

/// Whether nothing leads what a coupling ties: joints that muscles hold may not move as it does.
template <class T>
bool IslandStepper<T>::ties_passive(const Coupling<T>& c) const {
  return std::all_of(c.nodes.begin(), c.nodes.end(), [&](const CouplingNode<T>& node) {
    return node.tree < 0 || states_[node.tree]->passive();
  });
}

/// What bears at the end of the step, where something has just begun or ceased to, goes no deeper.
template <class T>
void IslandStepper<T>::press(T h) {
  find_sets();
  struck_.assign(states_.size(), 0);
  for (std::size_t n = 0; n < states_.size(); ++n)
    if (!lasts_[n]) struck_[set_[n]] = 1;
  for (const Contact<T>& c : contacts_) {
    const T level = T(kSameLevel) * c.length_scale;
    const bool struck = struck_[set_[c.tree_a]] && normal_force(c) > T(0) &&
                        !settings_.plan->contacts->is_internal_edge(c, contacts_, level, states_);
    if (!struck && !(c.grip > T(0))) continue;
    const Prediction<T>& prediction = problems_[c.tree_a]->prediction;
    const T acted = 1 / (h * prediction.weight);  // κh, s; twice that for what is constant over the step
    const T rubbed = prediction.rho > T(0) ? 2 * acted : acted;
    const T cone = c.friction * acted * (normal_force(c) - c.smooth_force) + rubbed * c.grip;
    ends_.add(c, struck ? T(kMostSteps) * h * normal_force(c) : T(0), cone,
              Vec3<T>(-rubbed * friction_gradient(c, settings_.stick)));
  }
  for (const Coupling<T>* c : couplings_)
    for (const Stencil<T>& e : c->stencils)
      if (c->driven || (e.tight > T(0) && ties_passive(*c))) ends_.add(*c, e);
  for (std::size_t n = 0; n < states_.size(); ++n) {
    if (!struck_[set_[n]]) continue;
    for (const JointRow<T>& row : problems_[n]->rows)
      if (row.kind == RowKind::kOneSided && row.slope(row.value) > T(0))
        ends_.add(static_cast<int>(n), row, T(kMostSteps) * h * row.slope(row.value));
  }
  ends_.press();
  if (log_) ends_.for_each_pushed([&](std::uint64_t id, T impulse) { log_->push(id, impulse); });
}

#define SINEW_MOTION_INSTANCES(T)                                                                     \
  template void IslandStepper<T>::find_sets();                                                        \
  template void IslandStepper<T>::predict_all(T);                                                     \
  template void IslandStepper<T>::predict_euler_all(T);                                               \
  template void IslandStepper<T>::strike(CharacterState<T>&, std::span<Vec3<T>>, std::span<Vec3<T>>); \
  template void IslandStepper<T>::append_loose(const CharacterState<T>&);                             \
  template void IslandStepper<T>::add_to_rate(CharacterState<T>&, int, const std::array<T, 6>&);      \
  template void IslandStepper<T>::strike_all();                                                       \
  template Strike<T> IslandStepper<T>::strike_of(std::size_t) const;                                  \
  template void IslandStepper<T>::drop_constant(CharacterState<T>&, int, std::span<const T>);         \
  template T IslandStepper<T>::opening_speed(const Contact<T>&) const;                                \
  template void IslandStepper<T>::write_borne();                                                      \
  template void IslandStepper<T>::drop_opened(T);                                                     \
  template void IslandStepper<T>::drop_played();                                                      \
  template void IslandStepper<T>::begin_ends();                                                       \
  template void IslandStepper<T>::expect_to_last(T);                                                  \
  template void IslandStepper<T>::take_over(Contact<T>&) const;                                       \
  template void IslandStepper<T>::split_contacts(T);                                                  \
  template bool IslandStepper<T>::is_locked(const CharacterState<T>&) const;                          \
  template void IslandStepper<T>::fall(History<T>&) const;                                            \
  template void IslandStepper<T>::accelerate_locked(CharacterState<T>&, int);                         \
  template void IslandStepper<T>::number_bodies();                                                    \
  template void IslandStepper<T>::advance_one_step(T);                                                \
  template void IslandStepper<T>::emphasise_friction(T);                                              \
  template void IslandStepper<T>::relax_friction(T);                                                  \
  template bool IslandStepper<T>::ties_passive(const Coupling<T>&) const;                             \
  template void IslandStepper<T>::press(T);
SINEW_MOTION_INSTANCES(float)
SINEW_MOTION_INSTANCES(double)

}  // namespace sinew
