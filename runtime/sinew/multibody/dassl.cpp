#include "sinew/multibody/dassl.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace sinew::multibody {
namespace {

constexpr double kRound = std::numeric_limits<double>::epsilon();
constexpr double kNewtonTolerance = 0.33;  ///< of the error test
constexpr double kUnknownRate = 100;

}  // namespace

Dassl::Dassl(System& system, double t0, const Vector& y0, double end, Variant variant,
             const IntegratorSettings& settings)
    : system_(&system),
      settings_(settings),
      end_(end),
      t_(t0),
      variant_(variant),
      y_(y0),
      residual_(y0.size()) {
  if (settings_.max_order <= 0 || settings_.max_order > kMaxOrder) settings_.max_order = kMaxOrder;
  for (Vector& p : phi_) p = Vector::Zero(y0.size());
}

std::string Dassl::first_step() {
  Vector yp(y_.size());
  if (!system_->derivative(t_, y_, yp)) return stopped(t_, "the equations cannot be evaluated at the start");
  h_ = 1e-3 * (end_ - t_);
  const double slope = norm(yp);
  if (slope > 0.5 / h_) h_ = 0.5 / slope;
  if (settings_.max_step > 0) h_ = std::min(h_, settings_.max_step);
  phi_[1] = y_;
  phi_[2] = h_ * yp;
  psi_[1] = h_;
  started_ = true;
  return {};
}

void Dassl::coefficients() {
  if (h_ != h_old_ || k_ != k_old_) same_steps_ = 0;
  same_steps_ = std::min(same_steps_ + 1, k_old_ + 2);
  if (k_ + 1 >= same_steps_) {
    beta_[1] = alpha_[1] = sigma_[1] = 1;
    gamma_[1] = 0;
    double temp1 = h_;
    for (int i = 2; i <= k_ + 1; ++i) {
      const double temp2 = psi_[i - 1];
      psi_[i - 1] = temp1;
      beta_[i] = beta_[i - 1] * psi_[i - 1] / temp2;
      temp1 = temp2 + h_;
      alpha_[i] = h_ / temp1;
      sigma_[i] = (i - 1) * sigma_[i - 1] * alpha_[i];
      gamma_[i] = gamma_[i - 1] + alpha_[i - 1] / h_;
    }
    psi_[k_ + 1] = temp1;
  }
  double fixed = 0, variable = 0;
  for (int i = 1; i <= k_; ++i) {
    fixed -= 1.0 / i;
    variable -= alpha_[i];
  }
  c_ = -fixed / h_;
  error_factor_ = std::max(std::abs(alpha_[k_ + 1] + fixed - variable), alpha_[k_ + 1]);
  const double bound = (1 - 0.25) / (1 + 0.25);
  if (c_factored_ == 0 || c_ / c_factored_ < bound || c_ / c_factored_ > 1 / bound) need_tangent_ = true;
  for (int j = same_steps_ + 1; j <= k_ + 1; ++j) phi_[j] *= beta_[j];
}

double Dassl::norm(const Vector& x) const {
  if (variant_ == Variant::kStrict) return worst_component(x, y_, settings_);
  const auto weighted = x.array() / (settings_.atol + settings_.rtol * y_.array().abs());
  return std::sqrt(weighted.square().mean());
}

void Dassl::predict(Vector& y, Vector& yp) const {
  y.setZero();
  yp.setZero();
  for (int j = 1; j <= k_ + 1; ++j) {
    y += phi_[j];
    yp += gamma_[j] * phi_[j];
  }
}

NewtonConvergence::Answer Dassl::judge(int iteration, double size, double negligible) {
  using Answer = NewtonConvergence::Answer;
  if (variant_ == Variant::kStrict) return newton_.judge(size, negligible);
  if (!std::isfinite(size)) return Answer::kGiveUp;
  if (size <= negligible) return Answer::kConverged;
  if (iteration == 0) {
    first_correction_ = size;
  } else {
    const double rate = std::pow(size / first_correction_, 1.0 / iteration);
    if (rate > 0.9) return Answer::kGiveUp;
    rate_bound_ = rate / (1 - rate);
  }
  if (rate_bound_ * size <= kNewtonTolerance) return Answer::kConverged;
  return iteration + 1 < newton_.at_most() ? Answer::kGoOn : Answer::kGiveUp;
}

bool Dassl::iterate(double t, bool fresh, Vector& y, Vector& yp, Vector& e) {
  if (fresh && !system_->tangent(t, y, yp, c_, false)) return false;
  const double rounding = 100 * kRound * norm(y);
  newton_.forget_rate();  // strict: of earlier steps
  newton_.begin();
  auto answer = NewtonConvergence::Answer::kGoOn;
  for (int m = 0; answer == NewtonConvergence::Answer::kGoOn; ++m) {
    ++counts_.newton_iterations;
    if (!system_->residual(t, y, yp, residual_)) return false;
    if (fresh && m == 0) {
      if (!system_->factorise(c_)) return false;
      c_factored_ = c_;
      rate_bound_ = kUnknownRate;
    }
    system_->solve(residual_);
    if (!fresh) residual_ *= 2 / (1 + c_ / c_factored_);
    y -= residual_;
    e -= residual_;
    yp -= c_ * residual_;
    answer = judge(m, norm(residual_), std::max(rounding, h_ * system_->noise() / settings_.atol));
  }
  return answer == NewtonConvergence::Answer::kConverged;
}

bool Dassl::correct(double t, Vector& y, Vector& yp, Vector& e) {
  for (bool fresh = need_tangent_;; fresh = true) {
    predict(y, yp);
    e.setZero();
    need_tangent_ = false;
    if (iterate(t, fresh, y, yp, e)) return true;
    if (!fresh) continue;
    need_tangent_ = true;
    return false;
  }
}

void Dassl::restore() {
  for (int j = same_steps_ + 1; j <= k_ + 1; ++j) phi_[j] /= beta_[j];
  for (int i = 2; i <= k_ + 1; ++i) psi_[i - 1] = psi_[i] - h_;
}

std::string Dassl::step() {
  if (!started_)
    if (std::string why = first_step(); !why.empty()) return why;
  if (settings_.max_step > 0) h_ = std::min(h_, settings_.max_step);
  if (100 * kRound * norm(y_) > 1) return stopped(t_, kTooAccurate);
  Vector y(y_.size()), yp(y_.size()), e(y_.size());
  int error_failures = 0, newton_failures = 0;
  for (;;) {
    if (h_ < 4 * kRound * std::abs(t_) || error_failures + newton_failures > 60)
      return stopped(t_, kStepTooSmall);
    coefficients();
    const int k = k_;
    if (!correct(t_ + h_, y, yp, e)) {
      ++counts_.newton_failures;
      ++newton_failures;
      first_phase_ = false;
      restore();
      h_ *= 0.25;
      continue;
    }
    const double unavoidable = h_ * system_->noise() / settings_.atol;
    const double size = std::max(0.0, norm(e) - unavoidable);
    const double error_k = sigma_[k + 1] * size;
    double error_below = 0, estimate = error_k;
    int next = k;
    if (k > 1) {
      const Vector below = phi_[k + 1] + e;
      error_below = sigma_[k] * norm(below);
      const double here = (k + 1) * error_k, lower = k * error_below;
      bool drop = k == 2 && lower <= 0.5 * here;
      if (k > 2) {
        const double two_below = (k - 1) * sigma_[k - 1] * norm(phi_[k] + below);
        drop = std::max(lower, two_below) <= here;
      }
      if (drop) next = k - 1, estimate = error_below;
    }
    if (!(error_factor_ * size <= 1)) {
      ++counts_.error_failures;
      ++error_failures;
      first_phase_ = false;
      restore();
      if (error_failures == 1) {
        k_ = next;
        h_ *= std::clamp(0.9 * std::pow(2 * estimate + 1e-4, -1.0 / (k_ + 1)), 0.25, 0.9);
      } else {
        k_ = error_failures == 2 ? next : 1;
        h_ *= 0.25;
      }
      continue;
    }
    ++counts_.steps;
    order_change_ = k - k_old_;
    k_old_ = k;
    h_old_ = h_;
    t_ += h_;
    choose_next(e, error_k, error_below, next);
    if (k_old_ != kMaxOrder) phi_[k + 2] = e;
    phi_[k + 1] += e;
    for (int j = k; j >= 1; --j) phi_[j] += phi_[j + 1];
    y_ = y;
    if (system_->accept(t_, y_)) need_tangent_ = true;
    phi_[1] = y_;
    return {};
  }
}

void Dassl::choose_next(const Vector& e, double error_k, double error_below, int next) {
  const int k = k_;
  if (next == k - 1 || k == settings_.max_order) first_phase_ = false;
  if (first_phase_) {
    k_ = k + 1;
    h_ *= 2;
    return;
  }
  double estimate = error_k;
  k_ = next;
  if (next == k - 1) {
    estimate = error_below;
  } else if (k < settings_.max_order && k + 1 < same_steps_ && order_change_ != 1) {
    const double error_above = norm(e - phi_[k + 2]) / (k + 2);
    const double here = (k + 1) * error_k, above = (k + 2) * error_above, below = k * error_below;
    if (k > 1 && below <= std::min(here, above)) {
      k_ = k - 1;
      estimate = error_below;
    } else if (above < (k > 1 ? here : 0.5 * here)) {
      k_ = k + 1;
      estimate = error_above;
    }
  }
  const double ratio = std::pow(2 * estimate + 1e-4, -1.0 / (k_ + 1));
  if (ratio >= 2)
    h_ *= 2;
  else if (ratio <= 1)
    h_ *= std::clamp(ratio, 0.5, 0.9);
}

Vector Dassl::at(double t) const {
  Vector y = y_;
  if (k_old_ == 0) return y;
  const double ahead = t - t_;
  double c = 1, gamma = ahead / psi_[1];
  for (int j = 2; j <= k_old_ + 1; ++j) {
    c *= gamma;
    gamma = (ahead + psi_[j - 1]) / psi_[j];
    y += c * phi_[j];
  }
  return y;
}

}  // namespace sinew::multibody
