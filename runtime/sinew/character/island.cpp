#include "sinew/character/island.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "sinew/character/baking.h"
#include "sinew/character/couplings.h"
#include "sinew/character/cut.h"
#include "sinew/character/grounding.h"
#include "sinew/character/levels.h"
#include "sinew/character/nearby.h"
#include "sinew/character/playback.h"
#include "sinew/character/return_to_animation.h"
#include "sinew/character/tone.h"
#include "sinew/character/touch_digest.h"
#include "sinew/character/unknowns.h"
#include "sinew/optimizer/error_estimate.h"
#include "sinew/optimizer/time_scheme.h"
#include "sinew/residual/tree_pass.h"
#include "sinew/skeleton/fewer_digits.h"
#include "sinew/skeleton/hooks.h"

namespace sinew {
namespace {

constexpr double kCertified = 0.9;     ///< of the limit: below, a joint at its target leaves the unknowns
constexpr double kBearsNothing = 0.5;  ///< of what releases a joint with a tone
constexpr int kReleaseRounds = 8;
constexpr int kEasyPasses = 8;  ///< a solve that took more may have gone astray: see energy_error()
constexpr int kTightenRounds = 6;
constexpr double kSlides = 0.99;  ///< of the square of a stick: what slides as far has left no elastic slip
constexpr int kLeastPasses = 12;  ///< of a part, where the step has none left: 8 leave 5 cm of error
constexpr int kMostUnsolved = 3;  ///< as many halvings leave the least passes

/// Whether no force from outside acts on it but gravity, contacts and couplings.
template <class T>
bool flies(const CharacterState<T>& s) {
  const TreeProblem<T>& p = s.problem;
  return s.floats && p.free[0] && p.effects.empty() && p.pushes.empty() &&
         std::none_of(p.rows.begin(), p.rows.end(), [](const JointRow<T>& row) { return row.dof < 6; });
}

/// Of a limp tree that was played the accelerations are not known; nor, of any, what rows exerted.
template <class T>
void begin_one_step(CharacterState<T>& s) {
  if (s.rate_step > T(0)) return;
  s.history.accelerates = s.history.accelerates && !s.passive();  // else it is the animation's
  for (auto* v : {&s.smooth, &s.lasting, &s.lasting_before}) std::fill(v->begin(), v->end(), T(0));
}

/// Whose step may be divided; else it is halved once where it must be.
template <class T>
bool gets_substeps(const CharacterState<T>* s) {
  return s->levels.allowed == Level::kSubsteps;
}

}  // namespace

template <class T>
void IslandStepper<T>::reserve(const SolveCapacity& capacity, int obstacles) {
  problems_.reserve(capacity.trees);
  free_share_.reserve(capacity.trees);
  is_frozen_.reserve(capacity.trees);
  balance_.reserve(capacity.trees);
  trees_.reserve(capacity.trees);
  for (const auto& effect : effects_) effect->reserve(capacity);
  if (finder_) finder_->reserve(capacity, obstacles);
  lagged_.reserve(capacity.contacts);
  for (auto* v : {&opened_, &shut_}) v->reserve(capacity.contacts);
  capacity_ = capacity.contacts;
  solver_.reserve(capacity);
  set_.reserve(capacity.trees);
  radius_.reserve(capacity.trees);
  driven_.reserve(capacity.trees);
  lasts_.reserve(capacity.trees);
  bears_.reserve(capacity.bodies);
  loose_.reserve(capacity.dofs);
  for (auto* v : {&jumps_, &late_jumps_}) v->reserve(capacity.bodies);
  for (auto* v : {&jump_force_, &constant_, &kinks_, &others_, &speed_share_}) v->reserve(capacity.dofs);
  for (auto* v : {&moved_, &turned_, &end_sped_, &end_spun_, &start_sped_, &start_spun_})
    v->reserve(capacity.bodies);
  impulse_.reserve(capacity.dofs);
  for (auto* v : {&first_body_, &first_dof_}) v->reserve(capacity.trees);
  turned_far_.reserve(capacity.trees);
  for (auto* v : {&missed_, &unturned_}) v->reserve(capacity.bodies);
  driven_rates_.reserve(capacity.bodies);
  for (auto* v : {&struck_velocity_, &struck_momentum_}) v->reserve(capacity.bodies);
  kept_.reserve(capacity.bodies);
  momenta_.reserve(capacity.trees);
  ends_.reserve(capacity);
  struck_.reserve(capacity.trees);
}

template <class T>
std::size_t IslandStepper<T>::bytes(const SolveCapacity& capacity) const {
  std::size_t sum = EndVelocities<T>::bytes(capacity) + capacity.dofs * (6 * sizeof(T) + 1) +
                    capacity.bodies * (10 * sizeof(Vec3<T>) + sizeof(Twist<T>) + sizeof(Landing) +
                                       2 * sizeof(std::array<T, 6>) + 1) +
                    (finder_ ? finder_->bytes(capacity) : 0) + solver_.bytes(capacity) +
                    capacity.contacts * sizeof(LaggedForce<T>);
  for (const auto& effect : effects_) sum += effect->bytes(capacity);
  return sum;
}

/// Of all the world's forces, those of the island's own features: identities begin with the tree's number.
template <class T>
void IslandStepper<T>::choose_lagged(std::span<const LaggedForce<T>> lagged) {
  lagged_.clear();
  std::ptrdiff_t room = 0;
  for (const CharacterState<T>* s : states_) room += s->problem.capacity.contacts;
  room = std::min(room, capacity_);
  const auto before = [](const LaggedForce<T>& f, std::uint64_t id) { return f.id < id; };
  for (const int index : indices_) {
    const auto begin = std::lower_bound(lagged.begin(), lagged.end(), first_contact_id(index), before);
    const auto end = std::lower_bound(begin, lagged.end(), first_contact_id(index + 1), before);
    const auto count = std::min(end - begin, room - std::ptrdiff_t(lagged_.size()));
    lagged_.insert(lagged_.end(), begin, begin + count);
  }
}

template <class T>
void IslandStepper<T>::finish_pose(CharacterState<T>& s, int tree, T h) {
  const WorldSettings& world = *world_;
  TreeProblem<T>& p = s.problem;
  read_torques(s, h);
  const bool falls = s.only_falls();
  for (int i = 0; i < s.tree.bodies; ++i) {
    std::transform(s.rate[i].begin(), s.rate[i].end(), s.rate_before[i].begin(),
                   rounded_off<kHalfOfDigits<T>, T>);
    s.rate[i] = joint_offset_value<T>(s.tree, i, p.start[i], p.local[i]);
    for (T& r : s.rate[i]) r /= h;
    if (landed_)  // it went a part of the way at the speed before
      for (std::size_t k = 0; k < s.rate[i].size(); ++k)
        s.rate[i][k] += late_jumps_[first_body_[tree] + i][k];
    s.local[i] = p.local[i];
    SINEW_ASSERT(s.local[i].rotation.coeffs().allFinite() && s.local[i].translation.allFinite());
    if (falls) continue;
    const std::array<T, 6> from_animation = joint_offset_value<T>(s.tree, i, s.wanted[i], p.local[i]);
    const std::array<T, 6> from_target = joint_offset_value<T>(s.tree, i, p.target[i], p.local[i]);
    T missed = T(0), load = T(0);
    const int first = s.tree.first_dof[i];
    for (int k = 0; k < s.tree.dof_count(i); ++k) {
      const T unit = slides(s.tree, first + k) ? s.tree.scale.length : T(1);
      missed = std::max(missed, std::abs(from_target[k]) / unit);
      s.load[first + k] = std::min(p.law.load(s.tree, i, first + k, s.torque), T(1));
      load = std::max(load, s.load[first + k]);
    }
    // Released until it has met its target with strength to spare; the kink's rounding is not a miss.
    const bool free = s.tree.dof_count(i) > 0 && (p.free[first] || s.baked[i]);
    // With a tone it has to be next to its animation, which update_deviation() asks.
    const bool met = s.joint_has_tone(i)
                         ? tone_load<T>(s, i, s.torque, &ToneOfDof<T>::asked) < T(kBearsNothing)
                         : missed < T(4) * p.kink_width && load < T(kCertified);
    if (!s.baked[i] || s.joint_is_driven(i)) s.deviation[i].released = free && !met;
    s.update_deviation(i, from_animation, h, T(world.accuracy.return_time));
  }
  if (!falls) {
    s.clear_deviations();
  } else if (!s.deferred.deviations) {
    s.deferred.deviations = true;
    std::fill(s.deviation.begin(), s.deviation.end(), Deviation<T>{});
    std::fill(s.load.begin(), s.load.end(), T(0));
  }
  for (std::size_t i = s.tree.bodies; i < s.local.size(); ++i)
    s.local[i] = {s.target[i].rotation, s.target[i].translation};
  s.rate_step_before = s.rate_step;
  s.rate_step = h;
  const bool touched = std::any_of(contacts_.begin(), contacts_.end(), [&](const Contact<T>& c) {
    return (c.tree_a == tree || c.tree_b == tree) && c.acts();
  });
  s.left_to_gravity = !touched && !landed_ && !is_frozen_[tree] && couplings_.empty() && flies(s);
}

/// Moves all trees' histories on to the solution.
template <class T>
void IslandStepper<T>::advance_all(T h) {
  SINEW_ZONE("velocities");
  momenta_.clear();
  for (const CharacterState<T>* s : states_) {
    Vec3<double>& momentum = momenta_.emplace_back(Vec3<double>::Zero());
    if (s->left_to_gravity)
      momentum = linear_momentum<T>(s->tree, s->history) + double(h) * s->total_mass * world_->gravity;
  }
  number_bodies();
  const bool estimates = world_->accuracy.estimate_error && !settings_.plan->scheme;
  const auto bodies = [&](auto& all, std::size_t n) {
    return std::span(all).subspan(first_body_[n], states_[n]->tree.bodies);
  };
  for (std::size_t n = 0; n < states_.size() && estimates; ++n)
    begin_error<T>(*problems_[n], states_[n]->history, h, settings_.common_origin, strike_of(n),
                   bodies(missed_, n), bodies(unturned_, n));
  if (settings_.plan->scheme)
    advance_by(*settings_.plan->scheme, h);
  else
    advance_one_step(h);
  for (std::size_t n = 0; n < states_.size(); ++n) {
    CharacterState<T>& s = *states_[n];
    double& error = s.report.estimated_error;
    if (parts_ <= 1) error = 0;
    if (estimates)
      error +=
          integration_error<T>(*problems_[n], s.history, s.load, h, bodies(missed_, n), bodies(unturned_, n));
  }
  for (std::size_t n = 0; n < states_.size(); ++n) {
    CharacterState<T>& s = *states_[n];
    if (s.left_to_gravity && !settings_.plan->scheme) {
      set_momentum<T>(s.tree, momenta_[n], s.history);
      s.read_root_rate();
    }
    if (s.floats) s.local[0].translation = s.history.place.template cast<T>();
    s.pose_changed();
  }
}

/// The same by another scheme: all forces are those at the end.
template <class T>
void IslandStepper<T>::advance_by(const TimeScheme<T>& scheme, T h) {
  for (Contact<T>& c : contacts_) c.smooth_force = normal_force(c);
  for (CharacterState<T>* s : states_) {
    const TreeProblem<T>& p = s->problem;
    scheme.advance(s->tree, p.kinematics, p.prediction, p.couple, h, settings_.common_origin, s->history);
  }
}

/// What a contact bears of a tree, and how what bears it moves, by its force; places from the common origin.
/// What counts as ground is what does in a check, see nearby.h: nobody else's limbs, and no wall.
template <class T>
void IslandStepper<T>::add_bearing(const Contact<T>& c, int tree, BearingGround& ground) const {
  if (c.tree_a == c.tree_b) return;
  const bool is_a = c.tree_a == tree;
  const T level = is_a ? c.normal.z() : -c.normal.z();
  const double up = double(normal_force(c) * level);
  if (!(up > 0) || level < T(kGroundLevel)) return;
  const int below = is_a ? c.tree_b : c.tree_a;
  if (below >= 0 && !states_[below]->is_prop && !states_[below]->is_carrier()) return;
  const T gap = c.distance();
  const Vec3<T> touch = c.point - (c.radius + (is_a ? gap : T(0))) * c.normal;
  ground.force += up;
  ground.depth -= up * double(gap);
  ground.place += up * touch.template cast<double>();
  ground.normal += up * (is_a ? 1 : -1) * c.normal.template cast<double>();
  if (below < 0) return;
  const CharacterState<T>& bears = *states_[below];
  const int body = is_a ? c.body_b : c.body_a;
  ground.velocity += up * bears.point_velocity(body, touch).template cast<double>();
  ground.turn_rate += up * double(angular_velocity(bears.history, body).z());
}

/// Reports what bears each tree, in the world.
template <class T>
void IslandStepper<T>::find_ground() {
  for (CharacterState<T>* s : states_) s->report.ground = {};
  for (const Contact<T>& c : contacts_) {
    if (!(c.gap < T(0))) continue;
    add_bearing(c, c.tree_a, states_[c.tree_a]->report.ground);
    if (c.tree_b >= 0) add_bearing(c, c.tree_b, states_[c.tree_b]->report.ground);
  }
  for (CharacterState<T>* s : states_) {
    BearingGround& ground = s->report.ground;
    if (!(ground.force > 0)) continue;
    ground.place = ground.place / ground.force + settings_.common_origin;
    ground.velocity /= ground.force;
    ground.turn_rate /= ground.force;
    ground.depth /= ground.force;
    ground.normal.normalize();
  }
}

/// After find_ground().
template <class T>
void IslandStepper<T>::report(CharacterState<T>& s, int tree) {
  const TreeProblem<T>& p = s.problem;
  const std::uint64_t signature = touching<T>(contacts_, tree), limits = bearing(p);
  const double error = s.report.estimated_error;
  const BearingGround ground = s.report.ground;
  CharacterReport& r = s.report;
  r = {};
  r.ground = ground;
  r.dofs = s.tree.dofs;
  r.unknown_dofs = static_cast<int>(std::count(p.free.begin(), p.free.end(), 1));
  r.baked = static_cast<int>(std::count(s.baked.begin(), s.baked.end(), 1));
  r.estimated_error = error;
  for (const Contact<T>& c : contacts_) {
    if ((c.tree_a != tree && c.tree_b != tree) || c.gap >= T(0)) continue;
    ++r.contacts;
    r.contact_force += std::max(0.0, double(normal_force(c)));
    if (c.tree_a == tree) r.elastic_energy += double(stored_energy(c));
    r.penetration = std::max(r.penetration, double(-c.gap));
  }
  for (const JointRow<T>& row : p.rows)
    if (row.kind == RowKind::kOneSided) r.elastic_energy += double(row.stored_energy(row.value));
  r.elastic_energy += elastic_of<T>(couplings_, tree);
  const bool unchanged = !landed_ && signature == s.contact_signature && limits == s.limit_signature;
  s.steps_unchanged = unchanged ? s.steps_unchanged + 1 : 0;
  if (!is_frozen_[tree] && s.collision_suspended > 0) --s.collision_suspended;
  s.contact_signature = signature;
  s.limit_signature = limits;
  s.report_totals(world_->gravity);
  report_help(s);
}

/// What the animation wants at a fraction of the frame, between the last frame's target and this one's.
template <class T>
void IslandStepper<T>::choose_wanted(CharacterState<T>& s, T fraction) {
  const bool falls = s.only_falls();  // then what moves follows no animation, the last frame's neither
  for (int i = 0; i < s.tree.bodies; ++i) {
    const JointJet<T>&now = s.target[i], &before = s.last_target()[i];
    const bool within = fraction < T(1) && !(falls && s.tree.dof_count(i) > 0);
    const JointJet<T> wanted = within ? animation_within<T>(before, now, frame_, fraction) : now;
    s.wanted[i] = s.in_solve(i, {wanted.rotation, wanted.translation}, settings_.common_origin);
    if (i > 0) follow_across<T>(s, i, settings_.h, s.wanted[i]);
  }
}

/// What may touch within h, but for what trees that were frozen are caught in.
template <class T>
void IslandStepper<T>::find_contacts(T h) {
  SINEW_ZONE("contacts");
  contacts_ = {};
  if (!finder_) return;
  contacts_ = finder_->find(*world_, surroundings_, states_, indices_, lagged_, settings_.common_origin, h);
  left_out_ = std::max(left_out_, finder_->left_out());
  const auto passes = [&](const Contact<T>& c) {
    const bool caught = c.tree_b >= 0 && c.offset > T(0);
    return caught &&
           (states_[c.tree_a]->collision_suspended > 0 || states_[c.tree_b]->collision_suspended > 0);
  };
  const auto rest = std::remove_if(contacts_.begin(), contacts_.end(), passes);
  contacts_ = contacts_.first(static_cast<std::size_t>(rest - contacts_.begin()));
}

/// The host's forces of this step, and the impulses that do not strike, as forces over it, times `emphasis`.
template <class T>
void IslandStepper<T>::write_pushes(CharacterState<T>& s, T emphasis) const {
  std::vector<ExternalForce<T>>& pushes = s.problem.pushes;
  pushes.clear();
  for (const ExternalForce<T>& f : s.forces) pushes.push_back({f.body, f.local, emphasis * f.force});
  if (!settings_.plan->scheme && s.is_struck(return_time())) return;  // see strike()
  for (const ExternalForce<T>& j : s.impulses)
    pushes.push_back({j.body, j.local, emphasis / frame_ * j.force});
}

/// Sets the problems up for one part of the step, which ends at `fraction` of it, and finds what may touch.
template <class T>
void IslandStepper<T>::begin_part(T h, T fraction) {
  const WorldSettings& world = *world_;
  problems_.clear();
  part_end_ = fraction;
  settings_.h = h;
  settings_.constant_muscles = !settings_.plan->scheme;
  settings_.common_origin = states_[0]->history.place;
  settings_.stick = T(world.accuracy.stick_speed) * h;
  for (CharacterState<T>* s : states_) {
    problems_.push_back(&s->problem);
    s->problem.kink_width = kink_width<T>(h / s->tree.scale.time, T(world.accuracy.tolerance));
    s->problem.common_origin =
        s->floats ? Vec3<T>(Vec3<T>::Zero()) : Vec3<T>(settings_.common_origin.template cast<T>());
    choose_wanted(*s, fraction);
    std::copy_n(s->local.begin(), s->tree.bodies, s->problem.start.begin());
    if (s->floats)
      s->problem.start[0].translation = (s->history.place - settings_.common_origin).template cast<T>();
    forward_kinematics<T>(s->tree, s->problem.start, s->problem.common_origin, s->problem.kinematics);
    choose_targets<T>(*s, T(world.accuracy.return_time),
                      height_of_floor<T>(world, settings_.common_origin.z()), h);
    choose_tone<T>(*s, settings_.gravity, h,
                   {frame_, fraction - h / frame_, fraction, settings_.plan->joints.damping});
    choose_baked<T>(*s, world.detail, h);
    choose_unknowns(*s);
    first_guess(*s, h);
    write_pushes(*s, T(1));
  }
  if (!settings_.plan->scheme) drop_played();
  find_contacts(h);
  if (std::exchange(blow_, false)) drop_opened(h);
}

/// The rest of what a part's first solve asks for: a guess that passes through nothing, and the prediction.
template <class T>
void IslandStepper<T>::begin_solve() {
  const T h = settings_.h;
  loosen_loops();
  for (CharacterState<T>* s : states_)
    for (Effect<T>* effect : s->problem.effects) effect->begin_step(effect_pose(settings_, s->problem));
  if (!effects_.empty()) limit_guess(h);
  if (const TimeScheme<T>* scheme = settings_.plan->scheme) {
    for (CharacterState<T>* s : states_)
      scheme->predict(s->tree, s->history, h, settings_.common_origin, s->problem.prediction);
  } else {
    expect_to_last(h);
    const bool known = std::all_of(states_.begin(), states_.end(),
                                   [](const CharacterState<T>* s) { return s->history.accelerates; });
    known ? predict_all(h) : predict_euler_all(h);
  }
  emphasise_friction(h);
  for (std::size_t n = 0; n < states_.size(); ++n)
    move_baked<T>(*states_[n], world_->detail, static_cast<int>(n), contacts_, settings_);
  if (!landed_ && strikes_deep(h)) choose_guess(h);
}

/// Passes that the next solve may take: what the step has left, or the part at least. What is tied is solved
/// again for its loops, each time with that least.
template <class T>
int IslandStepper<T>::most_passes() const {
  return std::max(passes_left_, couplings_.empty() ? kLeastPasses - passes_of_part_ : kLeastPasses);
}

template <class T>
SolveReport IslandStepper<T>::solve() {
  if (const TimeScheme<T>* scheme = settings_.plan->scheme; scheme && scheme->solves()) {
    scheme->solve(settings_, problems_, contacts_, couplings_);
    SolveReport once;
    once.outer_passes = once.factorisations = 1;
    once.converged = true;
    return once;
  }
  Accuracy accuracy = world_->accuracy;
  SolveReport report;
  int round = 0;
  do {
    accuracy.max_iterations = std::min(world_->accuracy.max_iterations, most_passes());
    const SolveReport once = solver_.solve(settings_, accuracy, problems_, contacts_, couplings_);
    passes_left_ -= once.outer_passes;
    passes_of_part_ += once.outer_passes;
    report.add(once);
  } while (round++ < kTightenRounds && report.converged && most_passes() > 0 && tighten_loops());
  return report;
}

/// Forgets the multipliers of the solve before: what a trial, or an attempt that is taken back, found.
template <class T>
void IslandStepper<T>::loosen_loops() {
  for (Coupling<T>* c : couplings_) {
    if (!c->closes_slowly) continue;
    for (Stencil<T>& e : c->stencils) {
      e.shift.setZero();
      e.shortened = T(0);
    }
  }
}

/// Whether a loop is too far apart.
template <class T>
bool IslandStepper<T>::tighten_loops() {
  bool any = false;
  for (Coupling<T>* c : couplings_) any = settings_.plan->couplings->tighten(*c) || any;
  return any;
}

namespace {

/// Whether a contact is of a body of a tree's with more than what that stands on.
template <class T>
bool is_more_than_ground(const Contact<T>& c, int tree, const SupportPoints<T>& support) {
  const auto stands = [&](int body) {
    return !support.first.empty() && support.first[body + 1] > support.first[body];
  };
  return c.acts() && (c.tree_b == tree || (c.tree_a == tree && (c.tree_b >= 0 || !stands(c.body_a))));
}

}  // namespace

/// Whether anything but what it stands on touches a tree, or is tied to it.
template <class T>
bool IslandStepper<T>::touches_more_than_ground(int tree) const {
  const CharacterState<T>& s = *states_[tree];
  return s.tied || std::any_of(contacts_.begin(), contacts_.end(), [&](const Contact<T>& c) {
           return is_more_than_ground<T>(c, tree, s.rig->support);
         });
}

/// Which joints of a tree nothing but its animation and the ground moves: its root is driven, no joint above
/// is an unknown, and what they carry touches nothing but the floor, with what may stand there.
template <class T>
std::span<const std::uint8_t> IslandStepper<T>::find_bearing(int tree) {
  const CharacterState<T>& s = *states_[tree];
  if (!s.problem.law.present.tone) return {};  // nobody asks
  bears_.assign(s.tree.bodies, 1);
  for (const Contact<T>& c : contacts_) {
    if (!is_more_than_ground<T>(c, tree, s.rig->support)) continue;
    if (c.tree_a == tree) bears_[c.body_a] = 0;
    if (c.tree_b == tree) bears_[c.body_b] = 0;
  }
  for (int i = s.tree.bodies - 1; i > 0; --i)
    if (const int parent = s.tree.parent[i]; parent >= 0 && !bears_[i]) bears_[parent] = 0;
  const auto is_free = [&](int i) { return s.tree.dof_count(i) > 0 && s.problem.free[s.tree.first_dof[i]]; };
  for (int i = 0; i < s.tree.bodies; ++i)
    for (int j = s.tree.parent[i]; j >= 0 && bears_[i]; j = s.tree.parent[j])
      if (is_free(j)) bears_[i] = 0;
  return bears_;
}

/// Solves one part of the step without moving anything: the result stays in the problems.
template <class T>
SolveReport IslandStepper<T>::attempt(bool may_split) {
  const T h = settings_.h;
  passes_of_part_ = 0;
  begin_solve();
  SolveReport total = solve();
  if (const TimeScheme<T>* scheme = settings_.plan->scheme; scheme && scheme->solves()) return total;
  for (int round = 1;; ++round) {
    if (most_passes() <= 0 || (may_split && !total.converged && passes_left_ > 0)) return total;
    bool released = false;
    for (std::size_t n = 0; n < states_.size(); ++n) {
      CharacterState<T>* const s = states_[n];
      released = release_overloaded(*s, find_bearing(static_cast<int>(n)), h) || released;
      released = release_baked(*s, world_->detail, settings_) || released;
    }
    if (!released || round == kReleaseRounds) return total;
    // Which points can move depends on what was released.
    for (CharacterState<T>* s : states_)
      forward_kinematics<T>(s->tree, s->problem.start, s->problem.common_origin, s->problem.kinematics);
    find_contacts(h);
    emphasise_friction(h);
    total.add(solve());
  }
}

/// Whether a contact that sticks keeps its place for good: what is passive does. Who follows an animation may
/// creep back to it, as far below the stick speed as friction's load is below its most.
template <class T>
bool IslandStepper<T>::stays_where_it_sticks(const Contact<T>& c) const {
  return states_[c.tree_a]->passive() || (c.tree_b >= 0 && states_[c.tree_b]->passive());
}

/// One part of the step, from `begin` to `end` (fractions of the frame): halved where it is long for an
/// impact or the solve does not converge.
template <class T>
void IslandStepper<T>::advance_part(T begin, T end, int splits_left) {
  const T h = (end - begin) * frame_;
  const auto halve = [&](int splits) {
    const T middle = (begin + end) / 2;
    advance_part(begin, middle, splits);
    advance_part(middle, end, splits);
  };
  if (turns_far(h)) return halve(splits_left);
  begin_part(h, end);
  if (begin == T(0) && may_divide() && starts()) find_accelerations();
  closed_ = passive();
  budget_ = closed_ ? balance_.open(states_, world_->gravity) : 0;
  land(h);
  const bool closed = closed_;
  SolveReport solved = attempt(splits_left > 0);
  if (passes_left_ <= 0) splits_left = 0;
  total_.add(solved);
  const bool may_restart = closed && !settings_.plan->scheme && most_passes() > 0;
  if (may_restart && (solved.converged || splits_left == 0) &&
      energy_error(solved.converged && solved.outer_passes <= kEasyPasses) > 0) {
    take_back_landing();
    solved = solve_from_start();
    total_.add(solved);
    ++restarts_;
  }
  if (splits_left > 0 && !solved.converged) {
    ++splits_;
    take_back_landing();
    return halve(splits_left - 1);
  }
  all_converged_ = all_converged_ && solved.converged;
  ++parts_;
  const bool may_bounce = std::any_of(effects_.begin(), effects_.end(), [&](const auto& effect) {
    return effect->may_change_speeds(contacts_);
  });
  if (!closed && (may_bounce || !solved.converged))  // else nobody asks what there was
    budget_ = balance_.open(states_, world_->gravity);
  freeze_lost(!solved.converged && closed && energy_error(false) > rest_tolerance());
  for (std::size_t n = 0; n < states_.size(); ++n) finish_pose(*states_[n], static_cast<int>(n), h);
  advance_all(h);
  stop_lost();
  find_ground();
  for (std::size_t n = 0; n < states_.size(); ++n)
    if (CharacterState<T>& s = *states_[n]; s.grounded() || s.problem.law.present.tone)
      hand_back<T>(s, s.problem.law.present.tone && touches_more_than_ground(static_cast<int>(n)), h);
  for (std::size_t n = 0; n < states_.size(); ++n) report(*states_[n], static_cast<int>(n));
  if (log_) log_contacts(h);
  for (const auto& effect : effects_) {
    if (!may_bounce || !effect->change_speeds(trees_, contacts_, world_->gravity, h, budget_)) continue;
    if (log_) log_bounces(*effect);
    for (CharacterState<T>* s : states_) s->report_totals(world_->gravity);
  }
  const bool tied = !couplings_.empty();
  if (!solved.converged || closed) {
    const bool exchanged = landed_ && states_.size() > 1;
    if (balance_.close(states_, contacts_, world_->gravity, !solved.converged, tied, exchanged)) ++damped_;
  } else {
    for (CharacterState<T>* s : states_) s->forget_energy();
  }
  lagged_.clear();
  for (const Contact<T>& c : contacts_) {
    const T force = normal_force(c);
    const bool driven = c.offset > T(0) && c.gap < c.offset;  // still inside
    if (!(force > T(0) || driven)) continue;
    std::array<T, 2> elastic{};
    if (stays_where_it_sticks(c)) elastic = elastic_share(c, settings_.stick);
    if (elastic[0] * elastic[0] + elastic[1] * elastic[1] > T(kSlides)) elastic = {};
    for (T& e : elastic) e = rounded_off<kHalfOfDigits<T>>(e);
    SINEW_ASSERT(lagged_.size() < lagged_.capacity());
    lagged_.push_back({c.id, force, c.stiffness, c.offset, c.smooth_force,
                       rounded_off<kHalfOfDigits<T>>(c.lasting_force), c.lasting_last, elastic});
  }
  std::sort(lagged_.begin(), lagged_.end(),
            [](const LaggedForce<T>& a, const LaggedForce<T>& b) { return a.id < b.id; });
}

/// How often to divide a step whatever happens in it.
template <class T>
int IslandStepper<T>::parts_of() const {
  return may_divide() ? std::max(world_->accuracy.substeps, 1) : 1;
}

template <class T>
bool IslandStepper<T>::may_divide() const {
  return std::any_of(states_.begin(), states_.end(), gets_substeps<T>);
}

template <class T>
void IslandStepper<T>::begin(const WorldSettings& world, const Surroundings& surroundings, T h,
                             std::span<CharacterState<T>* const> states, std::span<const int> indices,
                             std::span<Coupling<T>* const> couplings,
                             std::span<const LaggedForce<T>> lagged) {
  world_ = &world;
  surroundings_ = surroundings;
  frame_ = h;
  states_ = states;
  indices_ = indices;
  couplings_ = couplings;
  choose_lagged(lagged);
  trees_.clear();
  for (CharacterState<T>* s : effects_.empty() ? std::span<CharacterState<T>* const>() : states)
    trees_.push_back({s->problem, s->history, s->rate, s->guessed, s->report.elastic_energy,
                      s->steps_unchanged, s->contact_signature});
  total_ = {};
  all_converged_ = true;
  for (CharacterState<T>* s : states) s->unbaked = 0;
  splits_ = parts_ = damped_ = frozen_ = restarts_ = left_out_ = 0;
  settings_.gravity = world.gravity.template cast<T>();
  settings_.limit_stiffness = T(world.accuracy.limit_stiffness);
  settings_.limit_damping = T(world.accuracy.limit_damping);
  for (CharacterState<T>* s : states_) {
    if (!s->is_prop) meet_cuts(*s, h);
    if (!settings_.plan->scheme) begin_one_step(*s);
  }
  if (!settings_.plan->scheme) strike_all();
  begin_couplings<T>(couplings_, states_, indices_);
  for (Coupling<T>* c : couplings_) settings_.plan->couplings->close_slowly(h, *c);
}

/// Most of the trees' unsolved steps: each in a row halves what the next may take. What is jammed, or begins
/// deep inside something, is not solved by more passes either; what is tied, or wears cloth, takes many and
/// arrives.
template <class T>
int IslandStepper<T>::unsolved() const {
  if (!couplings_.empty()) return 0;
  int most = 0;
  for (const CharacterState<T>* s : states_) most = std::max(most, int(s->unsolved));
  return most;
}

template <class T>
int IslandStepper<T>::step(const WorldSettings& world, const Surroundings& surroundings, T h,
                           std::span<CharacterState<T>* const> states, std::span<const int> indices,
                           std::span<Coupling<T>* const> couplings, std::span<const LaggedForce<T>> lagged,
                           std::span<LaggedForce<T>> lagged_out, int spent) {
  begin(world, surroundings, h, states, indices, couplings, lagged);
  const int parts = parts_of();
  const bool fine = may_divide();
  const int splits = fine ? world.accuracy.max_splits : std::min(world.accuracy.max_splits, 1);
  passes_left_ = std::max((parts * world.accuracy.max_passes >> unsolved()) - spent, 0);
  passes_of_part_ = 0;
  for (int n = 0; n < parts; ++n)
    advance_part(T(n) / T(parts), n + 1 == parts ? T(1) : T(n + 1) / T(parts), splits);
  for (CharacterState<T>* s : states_) {
    CharacterReport& r = s->report;
    r.outer_passes = total_.outer_passes;
    r.factorisations = total_.factorisations;
    r.simplified_steps = total_.simplified_steps;
    r.corrections = total_.corrections;
    r.plain_passes = total_.plain_passes;
    r.converged = all_converged_;
    s->unsolved = all_converged_ ? 0 : static_cast<std::uint8_t>(std::min(s->unsolved + 1, kMostUnsolved));
    r.substeps = parts_;
    r.splits = splits_;
    r.damped = damped_;
    r.restarts = restarts_;
    r.frozen = frozen_;
    r.left_out = left_out_;
    r.unbaked = s->unbaked;
  }
  const std::size_t count = std::min(lagged_.size(), lagged_out.size());
  std::copy_n(lagged_.begin(), count, lagged_out.begin());
  return static_cast<int>(count);
}

template class IslandStepper<float>;
template class IslandStepper<double>;

}  // namespace sinew
