#include "sinew/multibody/fixed_bdf.h"

#include "sinew/multibody/newton.h"

namespace sinew::multibody {
namespace {

constexpr int kMatrices = 6;               ///< per step, at most
constexpr int kIterations = 5;             ///< with one matrix
constexpr double kNewtonTolerance = 0.01;  ///< of the integration tolerance

}  // namespace

FixedBdf::FixedBdf(System& system, double t0, const Vector& y0, int order, const IntegratorSettings& settings)
    : system_(&system), settings_(settings), order_(order), t0_(t0), t_(t0), y_(y0), before_(y0) {}

bool FixedBdf::iterate(double t, double c, Vector& y, Vector& yp) {
  if (!system_->tangent(t, y, yp, c, false)) return false;
  NewtonConvergence newton(kNewtonTolerance, kIterations);
  Vector r(y.size());
  auto answer = NewtonConvergence::Answer::kGoOn;
  for (bool first = true; answer == NewtonConvergence::Answer::kGoOn; first = false) {
    ++counts_.newton_iterations;
    if (!system_->residual(t, y, yp, r) || (first && !system_->factorise(c))) return false;
    system_->solve(r);
    y -= r;
    yp -= c * r;
    const double negligible = settings_.fixed_step * system_->noise() / settings_.atol;
    answer = newton.judge(worst_component(r, y_, settings_), negligible);
  }
  return answer == NewtonConvergence::Answer::kConverged;
}

std::string FixedBdf::step() {
  const double h = settings_.fixed_step;
  const bool second = order_ == 2 && counts_.steps > 0;
  if (counts_.steps == 0) {
    rate_.resize(y_.size());
    if (!system_->derivative(t_, y_, rate_))
      return stopped(t_, "the equations cannot be evaluated at the start");
  }
  const double t = t0_ + h * static_cast<double>(counts_.steps + 1);
  const double c = (second ? 1.5 : 1.0) / h;
  const Vector past = second ? Vector((-2 * y_ + 0.5 * before_) / h) : Vector(-y_ / h);
  Vector y = y_ + h * rate_, yp = c * y + past;
  bool converged = false;
  for (int i = 0; i < kMatrices && !converged; ++i) converged = iterate(t, c, y, yp);
  if (!converged) return stopped(t_, "Newton's method does not converge at this step length");
  rate_before_ = rate_;
  before_ = y_;
  y_ = y;
  rate_ = yp;
  t_ = t;
  ++counts_.steps;
  system_->accept(t_, y_);
  return {};
}

Vector FixedBdf::at(double t) const {
  if (counts_.steps == 0) return y_;
  // Cubic Hermite polynomial between the last two states.
  const double h = settings_.fixed_step, s = (t - t_ + h) / h;
  const double a = s * s * (3 - 2 * s), b = s * (1 - s) * (1 - s), c = -s * s * (1 - s);
  return (1 - a) * before_ + a * y_ + h * (b * rate_before_ + c * rate_);
}

}  // namespace sinew::multibody
