// ode15s and ode15sR: numerical differentiation formulas of order 1–5 with quasi-constant step.
//
// Source: Shampine & Reichelt, "The MATLAB ODE Suite", SIAM J. Sci. Comput. 18 (1997): backward differences
// of the solution at a constant step, rescaled by a triangular matrix when the step changes; κ shrinks the
// error constant. Formulated on F(t, y, y') = 0 with y' = (α_k d + ψ)/h, d the correction of the prediction,
// so the same code serves derivatives (ode15s: F = y' − f) and residuals (ode15sR, section 3.3 of the paper).
#pragma once

#include <array>

#include "sinew/multibody/integrator.h"
#include "sinew/multibody/newton.h"

namespace sinew::multibody {

class Ndf : public Integrator {
 public:
  Ndf(System& system, double t0, const Vector& y0, double end, const IntegratorSettings& settings);

  std::string step() override;
  double time() const override { return t_; }
  double last_step() const override { return step_taken_; }
  const Vector& state() const override { return state_; }
  Vector at(double t) const override;
  int order() const override { return order_taken_; }

 private:
  static constexpr int kMaxOrder = 5;
  using Square = Eigen::Matrix<double, kMaxOrder + 1, kMaxOrder + 1>;

  static Square step_change(int order, double factor);
  std::string first_step();
  void change_step(double factor);
  /// Newton's method for d at the end of the step. False: give up at this step.
  bool correct(double t_new, const Vector& predicted, const Vector& psi, Vector& d);
  bool new_tangent(double t, const Vector& y, const Vector& yp);
  void choose_next(double error);

  System* system_;
  IntegratorSettings settings_;
  double end_;
  double t_, h_ = 0;
  int k_ = 1;
  int equal_steps_ = 0;
  bool started_ = false, tangent_valid_ = false, tangent_fresh_ = false, factor_valid_ = false,
       factor_fresh_ = false;
  NewtonConvergence newton_{0.5, 4};
  std::array<Vector, kMaxOrder + 3> difference_;
  Vector state_, residual_, rate_;

  // For interpolation: the differences when the last step was accepted.
  double step_taken_ = 0;
  int order_taken_ = 1;
  std::array<Vector, kMaxOrder + 1> accepted_;
};

}  // namespace sinew::multibody
