// Semi-implicit Euler: implicit Euler's equations, linearised once where the step's first guess is, and
// solved once. The talk: "Semi implicit Euler assumes that the Hessian is constant. This will not handle
// unilateral constraints, or highly nonlinear terms, i.e. collisions, friction." For studies.
#pragma once

#include "study/schemes/schemes.h"

namespace sinew::study {

/// The first guess is the talk's "Q'' initial guess": no acceleration, or the animation's where muscles bore
/// their load in the last step. There forces, Hessian, and which muscle is at its limit, which contact
/// presses and which slides are taken; where that leads nobody looks. A pass of the optimizer's Newton
/// method, taken whole: what differs from Bdf1 is the non-linear solve and nothing else.
template <class T>
class SemiImplicit : public Bdf1<T> {
 public:
  static void declare(StepPlan<T>& plan);
  void predict(const Tree<T>& tree, const History<T>& history, T h, const Vec3<double>& common_origin,
               Prediction<T>& out) const override;
  bool solves() const override { return true; }
  void solve(const StepSettings<T>& settings, std::span<TreeProblem<T>* const> trees,
             std::span<Contact<T>> contacts, std::span<Coupling<T>* const> couplings) const override;
};

extern template class SemiImplicit<float>;
extern template class SemiImplicit<double>;

}  // namespace sinew::study
