// A scheme in time that stands in for Bossak's (bossak.h), for comparisons. The runtime links none;
// tools/study/schemes has implicit, semi-implicit and forward Euler, bdf2 and the seed talk's momentum
// scheme.
#pragma once

#include <span>

#include "sinew/optimizer/scheme.h"

namespace sinew {

template <class T>
struct Contact;
template <class T>
struct Coupling;
template <class T>
struct StepSettings;
template <class T>
struct TreeProblem;

/// What it keeps from step to step beyond a History's places and velocities lies in History::other, which is
/// empty where that has been lost. Contacts, limits and muscles act at the end of the step, whatever has
/// lasted; velocities are what advance() makes of them.
template <class T>
class TimeScheme {
 public:
  virtual ~TimeScheme() = default;

  /// Targets of inertia for a step of h seconds. Sets `out.other`.
  virtual void predict(const Tree<T>& tree, const History<T>& history, T h, const Vec3<double>& common_origin,
                       Prediction<T>& out) const = 0;
  /// Moves the history on to the solution `kinematics`; `torque` as for advance_bossak.
  virtual void advance(const Tree<T>& tree, const Kinematics<T>& kinematics, const Prediction<T>& prediction,
                       std::span<const Vec3<T>> torque, T h, const Vec3<double>& common_origin,
                       History<T>& history) const = 0;

  /// False: couple() is the rotational part of a body's residual, N·m, and no gradient of any energy.
  virtual bool has_energy() const { return true; }
  virtual Vec3<T> couple(const StepSettings<T>& settings, const TreeProblem<T>& problem, int body) const {
    (void)settings, (void)problem, (void)body;
    return Vec3<T>::Zero();
  }

  /// True: its own solve() takes the optimizer's place, once in a step. Nothing is released, split or held to
  /// its energy then: what such a scheme does wrong is to be seen.
  virtual bool solves() const { return false; }
  /// Begins where inertia and the targets lead (`local`); leaves the trees with kinematics, wrenches and
  /// gradient at the end of the step. May make unknowns of what is overloaded, and may allocate.
  virtual void solve(const StepSettings<T>& settings, std::span<TreeProblem<T>* const> trees,
                     std::span<Contact<T>> contacts, std::span<Coupling<T>* const> couplings) const {
    (void)settings, (void)trees, (void)contacts, (void)couplings;
  }
};

}  // namespace sinew
