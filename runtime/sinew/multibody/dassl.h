// DASSL: BDF of order 1–5 on residuals F(t, y, y') = 0, variable step, fixed leading coefficient.
//
// Source: Brenan, Campbell & Petzold, "Numerical Solution of Initial-Value Problems in Differential-Algebraic
// Equations", 1989, chapter 5, routine DDASTP: modified divided differences φ of the solution, coefficients
// ψ, α, β, γ, σ; Newton's method with an old matrix scaled by 2/(1 + c_j/c_old); errors at k−2 … k+1.
// As published, errors are root mean squares over the components, and the rate of convergence of one step is
// trusted in the next until the matrix changes. The strict variant measures the worst component, as the other
// methods here do, so that a tolerance means the same, and trusts a rate in the step in which it was measured
// only.
#pragma once

#include <array>

#include "sinew/multibody/integrator.h"
#include "sinew/multibody/newton.h"

namespace sinew::multibody {

class Dassl : public Integrator {
 public:
  enum class Variant { kPublished, kStrict };

  Dassl(System& system, double t0, const Vector& y0, double end, Variant variant,
        const IntegratorSettings& settings);

  std::string step() override;
  double time() const override { return t_; }
  double last_step() const override { return h_old_; }
  const Vector& state() const override { return y_; }
  Vector at(double t) const override;
  int order() const override { return k_old_; }

 private:
  static constexpr int kMaxOrder = 5;
  using Coefficients = std::array<double, kMaxOrder + 3>;  // indices from 1, as in the book

  std::string first_step();
  void coefficients();
  bool correct(double t, Vector& y, Vector& yp, Vector& e);
  void predict(Vector& y, Vector& yp) const;
  bool iterate(double t, bool fresh, Vector& y, Vector& yp, Vector& e);
  NewtonConvergence::Answer judge(int iteration, double size, double negligible);
  double norm(const Vector& x) const;
  void restore();
  void choose_next(const Vector& e, double error_k, double error_below, int next);

  System* system_;
  IntegratorSettings settings_;
  double end_;
  double t_, h_ = 0, h_old_ = 0;
  double c_ = 0, c_factored_ = 0, error_factor_ = 0;
  int k_ = 1, k_old_ = 0, same_steps_ = 0, order_change_ = 0;
  Variant variant_;
  NewtonConvergence newton_{0.33, 4};
  double first_correction_ = 0, rate_bound_ = 0;  ///< published: size, and rate/(1 − rate)
  bool started_ = false, first_phase_ = true, need_tangent_ = true;
  Coefficients psi_{}, alpha_{}, beta_{}, gamma_{}, sigma_{};
  std::array<Vector, kMaxOrder + 3> phi_;
  Vector y_, residual_;
};

}  // namespace sinew::multibody
