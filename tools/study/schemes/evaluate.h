// What schemes of their own solve share: wrenches, rows and gradient of all trees where they are.
#pragma once

#include <algorithm>

#include "sinew/optimizer/inner_problem.h"

namespace sinew::study {

/// At every tree's `local`. `contact_model`: of the step's plan.
template <class T>
void evaluate_all(const StepSettings<T>& settings, std::span<TreeProblem<T>* const> trees,
                  std::span<Contact<T>> contacts, std::span<Coupling<T>* const> couplings,
                  const ContactModel<T>& contact_model) {
  double energy = 0;
  for (TreeProblem<T>* p : trees) energy += begin_evaluation(settings, *p);
  contact_model.evaluate(trees, contacts, settings.stick, energy);
  for (Coupling<T>* c : couplings) {
    settings.plan->couplings->measure(trees, settings.common_origin, *c);
    settings.plan->couplings->add_wrenches(*c, trees);
  }
  for (TreeProblem<T>* p : trees) finish_gradient(*p);
}

/// Makes unknowns of those joints whose needed torque is more than their muscles have. True if there were
/// any.
template <class T>
bool release_overloaded(TreeProblem<T>& p) {
  bool any = false;
  for (int i = 0; i < p.tree->bodies; ++i) {
    const int first = p.tree->first_dof[i], last = p.tree->first_dof[i + 1];
    if (first == last || p.free[first]) continue;
    T load = T(0);
    for (int dof = first; dof < last; ++dof) load = std::max(load, p.law.load(*p.tree, i, dof, p.gradient));
    if (load <= T(1)) continue;
    std::fill(p.free.begin() + first, p.free.begin() + last, std::uint8_t{1});
    any = true;
  }
  return any;
}

}  // namespace sinew::study
