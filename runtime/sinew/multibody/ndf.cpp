#include "sinew/multibody/ndf.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace sinew::multibody {
namespace {

constexpr double kRound = std::numeric_limits<double>::epsilon();
constexpr double kKappa[] = {0, -0.1850, -1.0 / 9, -0.0823, -0.0415, 0};

double gamma(int k) {
  double sum = 0;
  for (int j = 1; j <= k; ++j) sum += 1.0 / j;
  return sum;
}
double alpha(int k) {
  return (1 - kKappa[k]) * gamma(k);
}
double error_constant(int k) {
  return kKappa[k] * gamma(k) + 1.0 / (k + 1);
}

/// The suite's measure of an error: the worst component in units of its tolerance, rtol·|scale| but at least
/// atol.
double worst_error(const Vector& x, const Vector& scale, const IntegratorSettings& s) {
  return (x.array().abs() / (s.rtol * scale.array().abs()).max(s.atol)).maxCoeff();
}

}  // namespace

Ndf::Ndf(System& system, double t0, const Vector& y0, double end, const IntegratorSettings& settings)
    : system_(&system),
      settings_(settings),
      end_(end),
      t_(t0),
      state_(y0),
      residual_(y0.size()),
      rate_(y0.size()) {
  if (settings_.max_order <= 0 || settings_.max_order > kMaxOrder) settings_.max_order = kMaxOrder;
  for (Vector& d : difference_) d = Vector::Zero(y0.size());
}

std::string Ndf::first_step() {
  if (!system_->derivative(t_, state_, rate_))
    return stopped(t_, "the equations cannot be evaluated at the start");
  // First-order step whose error would be a tolerance if y'' were as large as y' over a probe of that size.
  const double span = end_ - t_, slope = worst_error(rate_, state_, settings_);
  double h = std::min(span, slope > 0 ? 0.01 / slope : 1e-3 * span);
  if (settings_.max_step > 0) h = std::min(h, settings_.max_step);
  Vector moved(rate_.size());
  const Vector ahead = state_ + h * rate_;
  if (system_->derivative(t_ + h, ahead, moved)) {
    const double bend = worst_error(moved - rate_, state_, settings_) / h;
    const double wanted = bend > 0 ? 0.5 * std::sqrt(2 / bend) : span;
    h = std::min(std::min(100 * h, wanted), settings_.max_step > 0 ? settings_.max_step : span);
  }
  h_ = h;
  difference_[0] = state_;
  difference_[1] = h_ * rate_;
  started_ = true;
  return {};
}

Ndf::Square Ndf::step_change(int order, double factor) {
  // R(factor)·R(1): differences at step h to differences at step factor·h.
  const auto triangle = [order](double x) {
    Square r = Square::Zero();
    r.row(0).setOnes();
    for (int j = 1; j <= order; ++j)
      for (int i = 1; i <= order; ++i) r(i, j) = r(i - 1, j) * (i - 1 - x * j) / i;
    return r;
  };
  return triangle(factor) * triangle(1);
}

void Ndf::change_step(double factor) {
  const Square change = step_change(k_, factor);
  std::array<Vector, kMaxOrder + 1> scaled;
  for (int j = 0; j <= k_; ++j) {
    scaled[j] = Vector::Zero(state_.size());
    for (int i = 0; i <= k_; ++i)
      if (change(i, j) != 0) scaled[j] += change(i, j) * difference_[i];
  }
  for (int j = 0; j <= k_; ++j) difference_[j] = scaled[j];
  h_ *= factor;
  equal_steps_ = 0;
  factor_valid_ = false;
}

bool Ndf::new_tangent(double t, const Vector& y, const Vector& yp) {
  tangent_valid_ = tangent_fresh_ = system_->tangent(t, y, yp, alpha(k_) / h_, true);
  factor_valid_ = false;
  return tangent_valid_;
}

bool Ndf::correct(double t_new, const Vector& predicted, const Vector& psi, Vector& d) {
  const double c = alpha(k_) / h_;
  d.setZero();
  Vector y = predicted, yp = psi / h_;
  if (!tangent_valid_ && !new_tangent(t_new, y, yp)) return false;
  const double rounding = 100 * kRound * worst_error(y, y, settings_);
  newton_.begin();
  for (auto answer = NewtonConvergence::Answer::kGoOn; answer == NewtonConvergence::Answer::kGoOn;) {
    ++counts_.newton_iterations;
    if (!system_->residual(t_new, y, yp, residual_)) return false;
    if (!factor_valid_) {
      if (!system_->factorise(c)) return false;
      factor_valid_ = factor_fresh_ = true;
      newton_.forget_rate();
    }
    system_->solve(residual_);
    d -= residual_;
    y = predicted + d;
    yp = (alpha(k_) * d + psi) / h_;
    const double negligible = std::max(rounding, h_ * system_->noise() / settings_.atol);
    answer = newton_.judge(worst_error(residual_, predicted, settings_), negligible);
    if (answer == NewtonConvergence::Answer::kConverged) return true;
  }
  return false;
}

std::string Ndf::step() {
  if (!started_)
    if (std::string why = first_step(); !why.empty()) return why;
  if (settings_.max_step > 0 && h_ > settings_.max_step) change_step(settings_.max_step / h_);
  if (100 * kRound * worst_error(state_, state_, settings_) > 1) return stopped(t_, kTooAccurate);
  Vector d(state_.size());
  for (int failures = 0;; ++failures) {
    if (h_ < 16 * kRound * std::abs(t_) || failures > 60) return stopped(t_, kStepTooSmall);
    const double t_new = t_ + h_;
    Vector predicted = difference_[0], psi = Vector::Zero(state_.size());
    for (int m = 1; m <= k_; ++m) {
      predicted += difference_[m];
      psi += gamma(m) * difference_[m];
    }
    bool converged = correct(t_new, predicted, psi, d);
    if (!converged && !factor_fresh_) {  // the mass may have turned: cheaper to renew than a tangent
      factor_valid_ = false;
      converged = correct(t_new, predicted, psi, d);
    }
    if (!converged && !tangent_fresh_) {
      if (new_tangent(t_new, predicted, psi / h_)) converged = correct(t_new, predicted, psi, d);
    }
    if (!converged) {
      ++counts_.newton_failures;
      tangent_valid_ = factor_fresh_ = false;
      change_step(0.3);
      continue;
    }
    const Vector y = predicted + d;
    const double unavoidable = h_ * system_->noise() / settings_.atol;
    const double error = std::max(0.0, error_constant(k_) * worst_error(d, y, settings_) - unavoidable);
    if (!(error <= 1)) {
      ++counts_.error_failures;
      change_step(std::clamp(0.8 * std::pow(error, -1.0 / (k_ + 1)), 0.1, 0.8));
      continue;
    }
    t_ = t_new;
    state_ = y;
    step_taken_ = h_;
    order_taken_ = k_;
    ++counts_.steps;
    ++equal_steps_;
    difference_[k_ + 2] = d - difference_[k_ + 1];
    difference_[k_ + 1] = d;
    for (int m = k_; m >= 0; --m) difference_[m] += difference_[m + 1];
    tangent_fresh_ = factor_fresh_ = false;
    // A correction of the state shifts the whole history with it: only the zeroth difference changes.
    if (system_->accept(t_, state_)) tangent_valid_ = false;
    difference_[0] = state_;
    for (int m = 0; m <= k_; ++m) accepted_[m] = difference_[m];
    if (equal_steps_ > k_) choose_next(error);
    return {};
  }
}

void Ndf::choose_next(double error) {
  // Safety factors as in the suite: the step must promise to grow by 20 % before anything is changed.
  const int k = k_;
  const auto factor_for = [](double e, int order, double safety) {
    return e > 0 ? safety * std::pow(e, -1.0 / (order + 1)) : 10.0;
  };
  double best = factor_for(error, k, 1 / 1.2);
  int order = k;
  if (k > 1) {
    const double below = error_constant(k - 1) * worst_error(difference_[k], state_, settings_);
    const double factor = factor_for(below, k - 1, 1 / 1.3);
    if (factor > best) best = factor, order = k - 1;
  }
  if (k < settings_.max_order) {
    const double above = error_constant(k + 1) * worst_error(difference_[k + 2], state_, settings_);
    const double factor = factor_for(above, k + 1, 1 / 1.4);
    if (factor > best) best = factor, order = k + 1;
  }
  if (best < 1.2) return;
  double growth = std::min(best, 10.0);
  if (settings_.max_step > 0) growth = std::min(growth, settings_.max_step / h_);
  if (order == k && growth <= 1) return;
  k_ = order;
  factor_valid_ = false;
  change_step(growth);
}

Vector Ndf::at(double t) const {
  Vector y = state_;
  if (step_taken_ == 0) return y;
  // Newton's backward form through the last k+1 points.
  double product = 1;
  for (int m = 1; m <= order_taken_; ++m) {
    product *= (t - (t_ - (m - 1) * step_taken_)) / (m * step_taken_);
    y += product * accepted_[m];
  }
  return y;
}

}  // namespace sinew::multibody
