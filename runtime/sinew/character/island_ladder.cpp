// The ladder of IslandStepper, from where a part of a step is not split any further.
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>

#include "sinew/character/island.h"
#include "sinew/character/unknowns.h"
#include "sinew/effects/gravity.h"
#include "sinew/optimizer/time_scheme.h"
#include "sinew/skeleton/portable_math.h"

namespace sinew {
namespace {

constexpr int kSuspendedSteps = 30;   ///< steps after a tree was frozen
constexpr double kSlackOfWay = 1e-3;  ///< of the kinetic energy of a way: what schemes swing by

/// J, that goes at least with the way from where the tree was to the present poses in h seconds: whatever is
/// between, the mean kinetic energy is no less than the chord's. `place`: of the history, from the common
/// origin.
template <class T>
double least_kinetic(const CharacterState<T>& s, const Vec3<T>& place, double h) {
  double sum = 0;
  for (int i = 0; i < s.tree.bodies; ++i) {
    const Vec3<T> way = s.problem.kinematics.center[i] - s.history.center[i] - place;
    const Mat3<T> turn = s.history.rotation[i].transpose() * s.problem.kinematics.rotation[i];
    const double cosine = std::clamp((double(turn.trace()) - 1) / 2, -1.0, 1.0),
                 angle = portable::atan2(std::sqrt((1 - cosine) * (1 + cosine)), cosine);
    const double most_mobile = s.tree.inertia[i].template cast<double>().inverse().norm();
    sum += double(s.tree.mass[i]) * double(way.squaredNorm());
    if (std::isfinite(most_mobile)) sum += angle * angle / most_mobile;
  }
  return sum / (2 * h * h);
}

}  // namespace

/// Whether nothing can do work on the trees: no muscle, no drive, no push, no effect, no
/// loop that is being closed; nor a scheme of another solve, whose books nobody keeps.
template <class T>
bool IslandStepper<T>::passive() const {
  const bool closing =
      std::any_of(couplings_.begin(), couplings_.end(), [](const Coupling<T>* c) { return c->closes(); });
  const TimeScheme<T>* scheme = settings_.plan->scheme;
  if (closing || (scheme && scheme->solves())) return false;
  const auto closed = [](const Effect<T>* effect) { return effect->passive(); };
  return std::all_of(states_.begin(), states_.end(), [&](const CharacterState<T>* s) {
    const auto& effects = s->problem.effects;
    return !s->pushed() && s->passive() && std::all_of(effects.begin(), effects.end(), closed);
  });
}

/// What the trees store at the present poses: gravity, contacts and joint limits, J.
template <class T>
double IslandStepper<T>::pose_energy() const {
  double sum = 0;
  for (const CharacterState<T>* s : states_) {
    const Vec3<double> gravity = world_->gravity;
    for (int i = 0; i < s->tree.bodies; ++i) {
      const Vec3<double> center =
          settings_.common_origin + s->problem.kinematics.center[i].template cast<double>();
      sum += gravity_energy<double>(s->tree.mass[i], gravity, center);
    }
    for (const JointRow<T>& row : s->problem.rows)
      if (row.kind == RowKind::kOneSided) sum += double(row.stored_energy(row.value));
  }
  for (const Contact<T>& c : contacts_) sum += double(stored_energy(c));
  for (const Coupling<T>* c : couplings_) sum += c->energy;
  return sum;
}

/// J that the way to the present poses needs, at least: its kinetic energy, and what gravity stores halfway
/// (less what a way below the chord would save, m g² h²/24).
template <class T>
double IslandStepper<T>::way_energy() const {
  const double h = double(settings_.h);
  double sum = 0;
  for (const CharacterState<T>* s : states_) {
    const Vec3<T> place = (s->history.place - settings_.common_origin).template cast<T>();
    sum += (1 - kSlackOfWay) * least_kinetic(*s, place, h) -
           s->total_mass * world_->gravity.squaredNorm() * h * h / 24;
    for (int i = 0; i < s->tree.bodies; ++i) {
      const Vec3<T> middle = T(0.5) * (s->history.center[i] + place + s->problem.kinematics.center[i]);
      sum += gravity_energy<double>(s->tree.mass[i], world_->gravity,
                                    settings_.common_origin + middle.template cast<double>());
    }
  }
  return sum;
}

/// J that the present poses store beyond what the trees had and what rounding makes of it: only energy from
/// nowhere could reach them where it is above 0. Unless a solve was `easy` the way there is asked, too, which
/// may need more than they: a body leaps, and is as slow as before.
template <class T>
double IslandStepper<T>::energy_error(bool easy) const {
  const double had = budget_;
  const double needed = easy ? pose_energy() : std::max(pose_energy(), way_energy());
  return needed - had - 4 * double(std::numeric_limits<T>::epsilon()) * (std::abs(had) + std::abs(needed));
}

/// J that what stands still stores in its contacts: no more than a solve that failed may leave.
template <class T>
double IslandStepper<T>::rest_tolerance() const {
  double moments = 0;
  for (const CharacterState<T>* s : states_) moments += s->total_mass * double(s->tree.scale.length);
  return moments * std::max(1.0, world_->gravity.norm()) * world_->accuracy.sink_depth;
}

/// A solve descends from its guess, and from a guess deep inside something it may converge to a minimum in
/// there. From the pose at the start, implicit Euler's energy is all that the trees have, and each step
/// lowers it: what the result stores is no more.
template <class T>
SolveReport IslandStepper<T>::solve_from_start() {
  loosen_loops();
  for (CharacterState<T>* s : states_) first_guess(*s, settings_.h, T(0));
  relax_friction(settings_.h);
  predict_euler_all(settings_.h);
  return solve();
}

/// Last rung: where a solve left something that is no pose, or one that only energy from nowhere could reach,
/// the tree stays where it was, at rest. If it is caught in another one, neither finds a side to part to: for
/// half a second they pass.
template <class T>
void IslandStepper<T>::freeze(CharacterState<T>& s) {
  s.problem.local = s.problem.start;
  forward_kinematics<T>(s.tree, s.problem.local, s.problem.common_origin, s.problem.kinematics);
  s.problem.rows.clear();
  s.problem.ellipsoids.clear();
  std::fill(s.problem.gradient.begin(), s.problem.gradient.end(), T(0));
  s.history.stop();
  s.collision_suspended = kSuspendedSteps;
  predict_euler<T>(s.tree, s.history, settings_.h, settings_.common_origin, s.problem.prediction);
  std::fill(s.problem.couple.begin(), s.problem.couple.end(), Vec3<T>(Vec3<T>::Zero()));
  all_converged_ = false;
  ++frozen_;
}

/// Where a tree was frozen, contacts let go: surfaces that come back to it (ContactFinder::depenetrate) would
/// load what cannot move, without end.
template <class T>
void IslandStepper<T>::forget_contacts() {
  for (Contact<T>& c : contacts_) {
    settings_.plan->contacts->measure(problems_[c.tree_a]->kinematics,
                                      c.tree_b < 0 ? nullptr : &problems_[c.tree_b]->kinematics, c);
    if (!is_frozen_[c.tree_a] && (c.tree_b < 0 || !is_frozen_[c.tree_b])) continue;
    c.offset -= std::min(c.gap, T(0));
    c.gap = std::max(c.gap, T(0));
  }
}

template <class T>
bool IslandStepper<T>::is_finite(const CharacterState<T>& s) const {
  T sum = T(0);
  for (const Vec3<T>& c : s.problem.kinematics.center) sum += c.sum();
  for (const Mat3<T>& r : s.problem.kinematics.rotation) sum += r.sum();
  return std::isfinite(sum);
}

/// A force that is no number would stay in the velocities for good: such a tree is stopped.
template <class T>
void IslandStepper<T>::stop_lost() {
  for (CharacterState<T>* s : states_) {
    T sum = T(0);
    for (const Vec3<T>& v : s->history.velocity) sum += v.sum();
    for (const Vec3<T>& l : s->history.momentum) sum += l.sum();
    if (std::isfinite(sum)) continue;
    s->history.stop();
    std::fill(s->rate.begin(), s->rate.end(), std::array<T, 6>{});
    all_converged_ = false;
    ++frozen_;
  }
}

/// Holds the trees whose solve left no finite pose; all of them where there is `no_pose` at all.
template <class T>
void IslandStepper<T>::freeze_lost(bool no_pose) {
  const int frozen_before = frozen_;
  is_frozen_.assign(states_.size(), 0);
  for (std::size_t n = 0; n < states_.size(); ++n)
    if (no_pose || !is_finite(*states_[n])) {
      freeze(*states_[n]);
      is_frozen_[n] = 1;
    }
  if (frozen_ == frozen_before) return;
  forget_contacts();
  for (Coupling<T>* c : couplings_)
    (void)settings_.plan->couplings->measure(problems_, settings_.common_origin, *c);
}

#define SINEW_LADDER_INSTANCES(T)                                            \
  template bool IslandStepper<T>::passive() const;                           \
  template double IslandStepper<T>::pose_energy() const;                     \
  template double IslandStepper<T>::way_energy() const;                      \
  template double IslandStepper<T>::energy_error(bool) const;                \
  template double IslandStepper<T>::rest_tolerance() const;                  \
  template SolveReport IslandStepper<T>::solve_from_start();                 \
  template void IslandStepper<T>::freeze(CharacterState<T>&);                \
  template void IslandStepper<T>::forget_contacts();                         \
  template bool IslandStepper<T>::is_finite(const CharacterState<T>&) const; \
  template void IslandStepper<T>::stop_lost();                               \
  template void IslandStepper<T>::freeze_lost(bool);
SINEW_LADDER_INSTANCES(float)
SINEW_LADDER_INSTANCES(double)

}  // namespace sinew
