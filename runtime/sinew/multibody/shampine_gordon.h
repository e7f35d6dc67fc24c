// DE: Adams–Bashforth–Moulton PECE of variable order 1–12 and variable step, with local extrapolation.
//
// Source: Shampine & Gordon, "Computer Solution of Ordinary Differential Equations: The Initial Value
// Problem", 1975, routines STEP and INTRP: modified divided differences φ, coefficients ψ, α, β, σ, g; the
// error test on the extrapolated formula; order from the estimates at k−2, k−1, k, k+1; step halved or
// doubled.
#pragma once

#include <array>

#include "sinew/multibody/integrator.h"

namespace sinew::multibody {

class ShampineGordon : public Integrator {
 public:
  ShampineGordon(System& system, double t0, const Vector& y0, const IntegratorSettings& settings);

  std::string step() override;
  double time() const override { return t_; }
  double last_step() const override { return h_old_; }
  const Vector& state() const override { return y_; }
  Vector at(double t) const override;
  int order() const override { return k_old_; }
  bool looks_stiff() const override { return stiff_; }

 private:
  static constexpr int kMaxOrder = 12;
  using Coefficients = std::array<double, kMaxOrder + 3>;  // indices from 1, as in the book

  void first_step();
  void coefficients();
  void weigh();
  double norm(const Vector& x) const { return x.cwiseQuotient(weight_).norm(); }
  void restore();
  void choose_next(double error_k, double error_below, int next);

  System* system_;
  IntegratorSettings settings_;
  double eps_;  ///< the larger of the tolerances; the weights carry their ratio
  double t_, h_ = 0, h_old_ = 0;
  int k_ = 1, k_old_ = 0, same_steps_ = 0;
  bool starting_ = true, first_phase_ = true, stiff_ = false;
  int low_order_steps_ = 0;
  Coefficients psi_{}, alpha_{}, beta_{}, sigma_{}, v_{}, w_{}, g_{};
  std::array<Vector, kMaxOrder + 3> phi_;
  Vector y_, yp_, predicted_, weight_;
};

}  // namespace sinew::multibody
