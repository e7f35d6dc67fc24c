#include "study/schemes/semi_implicit.h"

#include "study/schemes/evaluate.h"

namespace sinew::study {
namespace {

/// One whole Newton step of the model at the present pose; none where its matrix is not positive definite
/// even without geometric terms.
template <class T>
bool linear_step(InnerProblem<T>& inner, std::span<Contact<T>> contacts,
                 std::span<Coupling<T>* const> couplings) {
  constexpr T kAnything = T(1);  // m: minimise() is asked for the matrix alone
  for (const bool geometric : {true, false}) {
    inner.build(contacts, couplings, geometric);
    if (!inner.minimise(kAnything).solved) continue;
    return std::isfinite(inner.simplified_newton_step(contacts));
  }
  return false;
}

template <class T>
void move(const InnerProblem<T>& inner, TreeProblem<T>& p) {
  const Tree<T>& tree = *p.tree;
  for (int i = 0; i < tree.bodies; ++i) {
    T d[6] = {};
    for (int dof = tree.first_dof[i]; dof < tree.first_dof[i + 1]; ++dof)
      if (const int k = inner.unknown(p, dof); k >= 0) d[dof - tree.first_dof[i]] = inner.correction()[k];
    p.local[i] = displaced<T>(tree, i, p.local[i], d);
  }
}

}  // namespace

template <class T>
void SemiImplicit<T>::declare(StepPlan<T>& plan) {
  static const SemiImplicit scheme;
  plan.scheme = &scheme;
}

template <class T>
void SemiImplicit<T>::predict(const Tree<T>& tree, const History<T>& history, T h,
                              const Vec3<double>& common_origin, Prediction<T>& out) const {
  Bdf1<T>::predict(tree, history, h, common_origin, out);
  out.other = this;
}

template <class T>
void SemiImplicit<T>::solve(const StepSettings<T>& settings, std::span<TreeProblem<T>* const> trees,
                            std::span<Contact<T>> contacts, std::span<Coupling<T>* const> couplings) const {
  InnerProblem<T> inner;
  inner.declare(*settings.plan);
  SolveCapacity capacity;
  for (const TreeProblem<T>* p : trees) capacity += p->capacity;
  inner.reserve(capacity);
  for (Contact<T>& c : contacts) c.expected_force = c.lagged_normal_force;
  const auto evaluate = [&] { evaluate_all<T>(settings, trees, contacts, couplings, inner.contacts()); };
  evaluate();
  bool released = false;
  for (TreeProblem<T>* p : trees) released = release_overloaded(*p) || released;
  if (released) evaluate();
  inner.begin(settings, trees);
  if (inner.size() == 0 || !linear_step(inner, contacts, couplings)) return;
  for (TreeProblem<T>* p : trees) move(inner, *p);
  evaluate();
}

template class SemiImplicit<float>;
template class SemiImplicit<double>;

}  // namespace sinew::study
