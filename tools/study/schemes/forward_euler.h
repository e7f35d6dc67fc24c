// Forward Euler, the talk's "everyone's favorite straw man": all that a step needs is known where it begins,
//
//     q₁ = q₀ + h q'₀,    q'₁ = q'₀ + h M₀⁻¹ (F₀ − what the turning of axes and bodies asks for).
//
// "Unfortunately it is not very stable." For studies.
#pragma once

#include "study/schemes/schemes.h"

namespace sinew::study {

/// Driven joints go where they are driven; of the others each has the torque that its muscles have at the
/// start. Springs, contacts and friction are those of the runtime.
template <class T>
class ForwardEuler : public TimeScheme<T> {
 public:
  static void declare(StepPlan<T>& plan);
  void predict(const Tree<T>& tree, const History<T>& history, T h, const Vec3<double>& common_origin,
               Prediction<T>& out) const override;
  void advance(const Tree<T>& tree, const Kinematics<T>& kinematics, const Prediction<T>& prediction,
               std::span<const Vec3<T>> torque, T h, const Vec3<double>& common_origin,
               History<T>& history) const override;
  bool solves() const override { return true; }
  void solve(const StepSettings<T>& settings, std::span<TreeProblem<T>* const> trees,
             std::span<Contact<T>> contacts, std::span<Coupling<T>* const> couplings) const override;
};

extern template class ForwardEuler<float>;
extern template class ForwardEuler<double>;

}  // namespace sinew::study
