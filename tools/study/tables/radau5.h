// RADAU5: the implicit Runge–Kutta method that the paper meets in SIMPACK (section 4.2.3).
//
// Source: Hairer & Wanner, "Solving Ordinary Differential Equations II", 2nd ed. (1996), sections IV.5 and
// IV.8: collocation at Radau's three points, of order 5; simplified Newton iterations whose 3n equations are
// taken apart by the eigenvectors of A⁻¹ into one real and one complex system of n; error estimate of order 3
// with a real solve in front; predictive control of the step. Constants are those of their program, the
// transformation of tolerances included. Formulated on F(t, y, y') = 0, so the same code serves derivatives
// and residuals; the eigenvectors are computed, not typed in.
#pragma once

#include <complex>
#include <functional>

#include "sinew/multibody/equations.h"
#include "sinew/multibody/integrator.h"

namespace sinew::study {

/// The complex half of a system: ∂F/∂y + c·∂F/∂y' of complex c, from the parts that the system's last
/// `tangent` and `factorise` left.
struct ComplexHalf {
  std::function<bool(std::complex<double> c)> factorise;  ///< false: singular
  std::function<void(Eigen::VectorXcd& r)> solve;         ///< in place, r → δ
};

/// That of a mechanism; `equations` must outlive it. Its factor is dense, also on open chains.
ComplexHalf complex_half(const multibody::Equations& equations);

class Radau5 : public multibody::Integrator {
 public:
  /// `system` must outlive the integrator. `end` only scales the first step.
  Radau5(multibody::System& system, ComplexHalf complex_half, double t0, const multibody::Vector& y0,
         double end, const multibody::IntegratorSettings& settings);

  std::string step() override;
  double time() const override { return t_; }
  double last_step() const override { return taken_; }
  const multibody::Vector& state() const override { return y_; }
  multibody::Vector at(double t) const override;
  int order() const override { return 5; }

 private:
  using Stages = Eigen::Matrix<double, Eigen::Dynamic, 3>;  ///< [size×3]

  std::string first_step();
  bool new_tangent();
  /// Residuals of the stages y + z_i, taken apart by T⁻¹.
  bool residuals(Stages& out);
  bool factorise();
  /// Newton's method for the stages from where they are. False: `shrink_` says how much shorter a step to
  /// try.
  bool iterate();
  /// Hairer's estimate in units of the tolerance; negative where it cannot be evaluated.
  double error();
  double estimate(const multibody::Vector& at, const multibody::Vector& rate);
  void accept(double error);
  void reject(double error);
  void predict_stages();
  /// The collocation polynomial of the last step, less its start, s = 1 at its end.
  multibody::Vector polynomial(double s) const;
  double norm(const multibody::Vector& x) const;

  multibody::System* system_;
  ComplexHalf complex_;
  multibody::IntegratorSettings settings_;
  double end_, t_, h_ = 0;
  Eigen::Matrix3d inverse_a_, to_stages_, from_stages_;  ///< A⁻¹ = T·diag(γ, [α β; −β α])·T⁻¹
  double gamma_ = 0;
  std::complex<double> alpha_beta_;
  double newton_tolerance_ = 0;

  multibody::Vector y_, yp_, scale_;
  Stages z_, w_;
  bool started_ = false, tangent_here_ = false, factors_valid_ = false, first_ = true, rejected_ = false;
  double theta_ = 0, contraction_ = 1, shrink_ = 0.5;
  int iterations_ = 0;
  double accepted_error_ = 1e-2, accepted_step_ = 0;

  // Of the last accepted step.
  double taken_ = 0;
  multibody::Vector before_;
  Stages last_z_;
};

}  // namespace sinew::study
