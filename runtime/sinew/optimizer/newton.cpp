#include "sinew/optimizer/newton.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "sinew/optimizer/newton_constants.h"
#include "sinew/optimizer/problem_pass.h"
#include "sinew/residual/tree_pass.h"
#include "sinew/skeleton/hooks.h"

namespace sinew {
template <class T>
void NewtonSolver<T>::reserve(const SolveCapacity& capacity) {
  inner_.reserve(capacity);
  plain_.reserve(capacity.dofs);
  base_.reserve(capacity.bodies);
}

template <class T>
double NewtonSolver<T>::evaluate() {
  ++report_.evaluations;
  double energy = 0;
  for (TreeProblem<T>* p : trees_) energy += begin_evaluation(*settings_, *p);
  inner_.contacts().evaluate(trees_, contacts_, settings_->stick, energy);
  for (Coupling<T>* c : couplings_) {
    energy += settings_->plan->couplings->measure(trees_, settings_->common_origin, *c);
    settings_->plan->couplings->add_wrenches(*c, trees_);
  }
  for (TreeProblem<T>* p : trees_) finish_gradient(*p);
  return energy;
}

template <class T>
double NewtonSolver<T>::energy(const StepSettings<T>& settings, std::span<TreeProblem<T>* const> trees,
                               std::span<Contact<T>> contacts, std::span<Coupling<T>* const> couplings) {
  settings_ = &settings;
  trees_ = trees;
  contacts_ = contacts;
  couplings_ = couplings;
  return evaluate();
}

template <class T>
void NewtonSolver<T>::remember_charts() {
  base_.clear();
  for (const TreeProblem<T>* p : trees_) {
    SINEW_ASSERT(base_.size() + p->local.size() <= base_.capacity());
    base_.insert(base_.end(), p->local.begin(), p->local.end());
  }
}

template <class T>
void NewtonSolver<T>::try_step(T t) {
  const std::vector<T>& correction = inner_.correction();
  std::size_t first = 0;
  for (TreeProblem<T>* p : trees_) {
    const Tree<T>& tree = *p->tree;
    for (int i = 0; i < tree.bodies; ++i) {
      T d[6] = {};
      bool moves = false;
      for (int dof = tree.first_dof[i]; dof < tree.first_dof[i + 1]; ++dof) {
        const int k = inner_.unknown(*p, dof);
        if (k < 0) continue;
        d[dof - tree.first_dof[i]] = t * correction[k];
        moves = true;
      }
      p->local[i] = moves ? displaced<T>(tree, i, base_[first + i], d) : base_[first + i];
    }
    first += tree.bodies;
  }
}

/// A step is accepted when it lowers the energy, judged by the directional derivative where differences of
/// energies drown in rounding (near the solution in float: always), or where there is no energy. Of a
/// `slight` step the derivative is rounding too.
template <class T>
bool NewtonSolver<T>::accepted(T t, T slope, double energy, double new_energy, bool slight) const {
  if (!std::isfinite(new_energy)) return false;
  const auto calmer = [&] {
    return std::abs(inner_.slope_now(inner_.correction())) <= T(0.9) * std::abs(slope);
  };
  if (lacks_energy(*trees_[0])) return calmer();
  T unit = T(0);
  double outside = 0;
  for (const TreeProblem<T>* p : trees_) {
    unit = std::max(unit, p->tree->scale.energy);
    outside += p->outside_energy;
  }
  const double noise = (sizeof(T) == 4 ? 2e-5 : 1e-11) * (double(unit) + std::abs(energy)) +
                       kRoundings * double(std::numeric_limits<T>::epsilon()) * outside;
  return new_energy <= energy + 1e-4 * double(t * slope) ||
         (new_energy <= energy + noise && (slight || calmer()));
}

/// Second-order correction after a full step that failed: gaps and slips are re-measured where it led, the
/// convex model is solved once more with them and the old Jacobian, and that step is tried. Undone when it
/// fails too.
template <class T>
bool NewtonSolver<T>::correct_step(T tolerance, double energy, double& new_energy) {
  plain_ = inner_.correction();
  inner_.correct(contacts_);
  if (inner_.minimise(tolerance).solved) {
    const T slope = inner_.slope(inner_.correction());
    if (slope < T(0)) {
      try_step(T(1));
      new_energy = evaluate();
      if (accepted(T(1), slope, energy, new_energy)) return true;
    }
  }
  inner_.correction() = plain_;
  return false;
}

/// Where a full step leaves much of the slope, since the matrix has none of the negative curvature of what is
/// compressed (cloth that crumples): as far as the slopes say, while the energy falls.
template <class T>
void NewtonSolver<T>::go_further(T slope, double& energy) {
  const auto crumples = [](const Coupling<T>* c) { return !c->closes_slowly; };
  if (lacks_energy(*trees_[0]) || std::none_of(couplings_.begin(), couplings_.end(), crumples)) return;
  T t = T(1), left = inner_.slope_now(inner_.correction()) / slope;
  const T furthest = T(1) / std::max(longest_correction(), std::numeric_limits<T>::min());
  while (left > T(kUndershot)) {
    const T next = std::min(t * std::clamp(T(1) / (T(1) - left), T(1.5), T(kMostFurther)), furthest);
    if (!(next > T(1.5) * t)) return;
    try_step(next);
    const double further = evaluate();
    if (!(further < energy)) {
      try_step(t);
      energy = evaluate();
      return;
    }
    energy = further;
    t = next;
    left = inner_.slope_now(inner_.correction()) / slope;
  }
}

template <class T>
typename NewtonSolver<T>::Outcome NewtonSolver<T>::line_search(T tolerance, bool slight, double& energy) {
  const T slope = inner_.slope(inner_.correction());
  remember_charts();
  const double before = energy;
  T t = T(1);
  for (int attempt = 0; attempt < 14; ++attempt) {
    try_step(t);
    energy = evaluate();
    if (accepted(t, slope, before, energy, slight)) {
      if (attempt == 0) go_further(slope, energy);
      return attempt == 0 ? Outcome::kFull : Outcome::kShortened;
    }
    const T new_slope = inner_.slope_now(inner_.correction());
    if (attempt == 0 && inner_.has_contacts() && correct_step(tolerance, before, energy)) {
      ++report_.corrections;
      return Outcome::kCorrected;
    }
    const T secant = new_slope > T(0) ? -slope / (new_slope - slope) : T(0.5);
    t *= std::clamp(secant, T(0.1), T(0.6));
  }
  try_step(T(0));
  energy = evaluate();
  return Outcome::kRefused;
}

/// Goes on with the pass's own matrix while that shrinks the steps: an evaluation each, where a pass builds
/// and factorises. True when one was below the tolerance.
template <class T>
bool NewtonSolver<T>::converge_by_simplified_newton(double tolerance, double length, double& energy) {
  for (;;) {
    const double next = inner_.simplified_newton_step(contacts_);
    if (!(next < kSimplifiedRate * length)) return false;
    if (next < kNegligible * tolerance) return true;
    const T slope = inner_.slope_now(inner_.correction());
    remember_charts();
    try_step(T(1));
    const double new_energy = evaluate();
    const double rate = std::max(next / length, inner_.has_contacts() ? kLeastRateInContact : kLeastRate);
    const bool last = next * rate < kCautious * tolerance * (1 - rate);  // a geometric series is left
    if (!accepted(T(1), slope, energy, new_energy, last)) {
      try_step(T(0));
      energy = evaluate();
      return false;
    }
    ++report_.simplified_steps;
    energy = new_energy;
    if (last) return true;
    length = next;
  }
}

/// Of the correction's degrees of freedom, rad or the tree's unit of length: a rotation vector is good for
/// about one radian.
template <class T>
T NewtonSolver<T>::longest_correction() const {
  T longest = T(0);
  for (const TreeProblem<T>* p : trees_) {
    const Tree<T>& tree = *p->tree;
    for (int dof = 0; dof < tree.dofs; ++dof)
      if (const int k = inner_.unknown(*p, dof); k >= 0) {
        const T size = std::abs(inner_.correction()[k]);
        longest = std::max(longest, slides(tree, dof) ? size / tree.scale.length : size);
      }
  }
  return longest;
}

/// Whether contacts bear much more at the first guess than they can in the end: it is where inertia leads.
template <class T>
bool NewtonSolver<T>::forces_mislead() const {
  T now = T(0), before = T(0), mass = T(0);
  for (const Contact<T>& c : contacts_) {
    now += normal_force(c);
    before += c.lagged_normal_force;
  }
  if (now == T(0)) return false;
  for (const TreeProblem<T>* p : trees_)
    mass = std::accumulate(p->tree->mass.begin(), p->tree->mass.end(), mass);
  return now > T(kMisleading) * std::max(before, mass * settings_->gravity.norm());
}

template <class T>
SolveReport NewtonSolver<T>::solve(const StepSettings<T>& settings, const Accuracy& accuracy,
                                   std::span<TreeProblem<T>* const> trees, std::span<Contact<T>> contacts,
                                   std::span<Coupling<T>* const> couplings) {
  SINEW_ZONE("solve");
  settings_ = &settings;
  trees_ = trees;
  contacts_ = contacts;
  couplings_ = couplings;
  report_ = {};
  inner_.begin(settings, trees);
  for (Contact<T>& c : contacts_) c.expected_force = c.lagged_normal_force;
  double energy = evaluate();
  report_.converged = inner_.size() == 0;
  const double tolerance = accuracy.tolerance;
  bool geometric = !forces_mislead();
  double shortest = std::numeric_limits<double>::infinity();  // of the steps so far
  int stalled = 0;
  while (!report_.converged && report_.outer_passes < accuracy.max_iterations) {
    ++report_.outer_passes;
    InnerReport inner;
    if (geometric) {
      inner_.build(contacts_, couplings_, true);
      inner = inner_.minimise(T(tolerance));
    }
    const bool plain = !geometric || (!inner.solved && inner_.geometric());
    // Where it was indefinite now it is likely to be so in the next pass; after that it is tried again.
    geometric = !geometric || inner.solved;
    if (plain) {
      ++report_.plain_passes;
      inner_.build(contacts_, couplings_, false);
      inner = inner_.minimise(T(tolerance));
    }
    if (!inner.solved) break;
    inner_.expect_forces(contacts_);
    const T longest = longest_correction();
    if (longest > T(1))
      for (T& d : inner_.correction()) d /= longest;
    const double length = inner.straight && !(longest > T(1))
                              ? inner.first_length
                              : double(inner_.displacement(inner_.correction()));
    // The second clause is needed: a truncated inner solve alone passed with errors up to 173 mm.
    const bool small = length < tolerance && inner.first_length < 2 * tolerance;
    const Outcome outcome = line_search(T(tolerance), small && !inner_.has_contacts(), energy);
    // Where no row bears the energy is smooth, and the step Newton's own; what effects do may bend otherwise
    // than their matrix says.
    const bool exact = inner.straight && inner_.joints_only() && inner_.geometric() &&
                       !lacks_energy(*trees_[0]) && length < kExactWithin * tolerance &&
                       kLeft * length * length < kCautious * tolerance;
    const bool near = length < (inner_.has_contacts() ? kStillValidInContact : kStillValid);
    // Of what is tied, by springs a tenth of a millimetre of which bear a weight, rounding alone makes such
    // steps (float, metres from the common origin).
    const bool stalls =
        !couplings_.empty() && length < kRoundingFloor * tolerance && length > kStalls * shortest;
    stalled = stalls ? stalled + 1 : 0;
    shortest = std::min(shortest, length);
    report_.converged = small || stalled == kMostStalled ||
                        (outcome == Outcome::kFull &&
                         (exact || (near && converge_by_simplified_newton(tolerance, length, energy))));
    if (outcome == Outcome::kRefused) break;
  }
  report_.factorisations = inner_.factorisations;
  report_.products = inner_.products;
  report_.energy = energy;
  return report_;
}

template class NewtonSolver<float>;
template class NewtonSolver<double>;

}  // namespace sinew
