// bdf1 and bdf2 with a fixed step on residuals: the schemes of the runtime's step, on the same mechanisms.
#pragma once

#include "sinew/multibody/integrator.h"

namespace sinew::multibody {

/// y1' = (y1 − y0)/h, or (3y1 − 4y0 + y−1)/2h from the second step on; each step solved by Newton's method
/// until the error left is below a hundredth of the tolerance. No error control: the step is the accuracy.
class FixedBdf : public Integrator {
 public:
  FixedBdf(System& system, double t0, const Vector& y0, int order, const IntegratorSettings& settings);

  std::string step() override;
  double time() const override { return t_; }
  double last_step() const override { return counts_.steps > 0 ? settings_.fixed_step : 0; }
  const Vector& state() const override { return y_; }
  Vector at(double t) const override;
  int order() const override { return order_; }

 private:
  /// Newton's method from y with a new matrix. False: another one is needed.
  bool iterate(double t, double c, Vector& y, Vector& yp);

  System* system_;
  IntegratorSettings settings_;
  int order_;
  double t0_, t_;
  Vector y_, before_, rate_, rate_before_;
};

}  // namespace sinew::multibody
