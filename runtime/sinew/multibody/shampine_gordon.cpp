#include "sinew/multibody/shampine_gordon.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace sinew::multibody {
namespace {

constexpr double kRound = std::numeric_limits<double>::epsilon();
/// |γ*_k|: error coefficients of the Adams–Moulton formulas of constant step.
constexpr double kErrorConstant[] = {0,      0.5,     0.0833,  0.0417,  0.0264,  0.0188,  0.0143,
                                     0.0114, 0.00936, 0.00789, 0.00679, 0.00592, 0.00524, 0.00468};
constexpr int kStiffSteps = 50;  ///< so many steps of order 4 or less in a row: stability limits them
constexpr const char* kNoEvaluation = "the equations cannot be evaluated near the present state";

}  // namespace

ShampineGordon::ShampineGordon(System& system, double t0, const Vector& y0,
                               const IntegratorSettings& settings)
    : system_(&system),
      settings_(settings),
      eps_(std::max(settings.rtol, settings.atol)),
      t_(t0),
      y_(y0),
      yp_(y0.size()),
      predicted_(y0.size()),
      weight_(y0.size()) {
  if (settings_.max_order <= 0 || settings_.max_order > kMaxOrder) settings_.max_order = kMaxOrder;
  for (Vector& p : phi_) p = Vector::Zero(y0.size());
  g_[1] = 1;
  g_[2] = 0.5;
  sigma_[1] = 1;
}

void ShampineGordon::weigh() {
  weight_ = (settings_.rtol / eps_) * y_.cwiseAbs();
  weight_.array() += settings_.atol / eps_;
}

void ShampineGordon::first_step() {
  phi_[1] = yp_;
  const double speed = norm(yp_);
  // From a state at rest the first-order guess would be a huge step: stay below what the longest step allows.
  h_ = settings_.max_step > 0 ? settings_.max_step : 1.0;
  if (eps_ < 16 * speed * h_ * h_) h_ = 0.25 * std::sqrt(eps_ / speed);
  starting_ = false;
}

void ShampineGordon::coefficients() {
  if (h_ != h_old_) same_steps_ = 0;
  if (same_steps_ <= k_old_) ++same_steps_;
  const int ns = same_steps_, k = k_;
  if (k < ns) return;
  beta_[ns] = 1;
  alpha_[ns] = 1.0 / ns;
  double temp1 = h_ * ns;
  sigma_[ns + 1] = 1;
  for (int i = ns + 1; i <= k; ++i) {
    const double temp2 = psi_[i - 1];
    psi_[i - 1] = temp1;
    beta_[i] = beta_[i - 1] * psi_[i - 1] / temp2;
    temp1 = temp2 + h_;
    alpha_[i] = h_ / temp1;
    sigma_[i + 1] = i * alpha_[i] * sigma_[i];
  }
  psi_[k] = temp1;
  if (ns <= 1) {
    for (int q = 1; q <= k; ++q) w_[q] = v_[q] = 1.0 / (q * (q + 1));
  } else {
    if (k > k_old_) {  // the order has just been raised: one more entry of v
      v_[k] = 1.0 / (k * (k + 1));
      for (int j = 1; j <= ns - 2; ++j) v_[k - j] -= alpha_[j + 1] * v_[k - j + 1];
    }
    for (int q = 1; q <= k + 1 - ns; ++q) {
      v_[q] -= alpha_[ns] * v_[q + 1];
      w_[q] = v_[q];
    }
    g_[ns + 1] = w_[1];
  }
  for (int i = ns + 2; i <= k + 1; ++i) {
    for (int q = 1; q <= k + 2 - i; ++q) w_[q] -= alpha_[i - 1] * w_[q + 1];
    g_[i] = w_[1];
  }
}

void ShampineGordon::restore() {
  for (int i = 1; i <= k_; ++i) phi_[i] = (phi_[i] - phi_[i + 1]) / beta_[i];
  for (int i = 2; i <= k_; ++i) psi_[i - 1] = psi_[i] - h_;
}

std::string ShampineGordon::step() {
  weigh();
  if (starting_) {
    if (!system_->derivative(t_, y_, yp_)) return stopped(t_, kNoEvaluation);
    first_step();
  }
  if (settings_.max_step > 0) h_ = std::min(h_, settings_.max_step);
  const double half_eps = 0.5 * eps_;
  if (half_eps < 2 * kRound * norm(y_)) return stopped(t_, kTooAccurate);
  for (int failures = 0;;) {
    if (h_ < 4 * kRound * std::abs(t_)) return stopped(t_, kStepTooSmall);
    coefficients();
    const int k = k_;
    for (int i = same_steps_ + 1; i <= k; ++i) phi_[i] *= beta_[i];
    phi_[k + 2] = phi_[k + 1];
    phi_[k + 1].setZero();
    predicted_.setZero();
    for (int i = k; i >= 1; --i) {
      predicted_ += g_[i] * phi_[i];
      phi_[i] += phi_[i + 1];
    }
    predicted_ = y_ + h_ * predicted_;
    const bool evaluated = system_->derivative(t_ + h_, predicted_, yp_);
    double error = 2 * eps_, error_k = 0, error_below = 0, error_two_below = 0;
    int next = k;
    if (evaluated) {
      const Vector change = yp_ - phi_[1];
      if (k > 2) error_two_below = h_ * sigma_[k - 1] * kErrorConstant[k - 2] * norm(phi_[k - 1] + change);
      if (k > 1) error_below = h_ * sigma_[k] * kErrorConstant[k - 1] * norm(phi_[k] + change);
      const double size = h_ * norm(change);
      error = size * (g_[k] - g_[k + 1]);
      error_k = size * sigma_[k + 1] * kErrorConstant[k];
      if (k > 2 && std::max(error_below, error_two_below) <= error_k) next = k - 1;
      if (k == 2 && error_below <= 0.5 * error_k) next = k - 1;
    }
    if (!(error <= eps_ + h_ * system_->noise())) {
      ++counts_.error_failures;
      first_phase_ = false;
      restore();
      ++failures;
      double factor = evaluated ? 0.5 : 0.25;
      if (failures > 3 && half_eps < 0.25 * error_k) factor = std::sqrt(half_eps / error_k);
      if (failures >= 3) next = 1;
      h_ *= factor;
      k_ = next;
      if (failures > 60) return stopped(t_, evaluated ? kStepTooSmall : kNoEvaluation);
      continue;
    }
    // Correct, evaluate again, update the differences.
    k_old_ = k;
    h_old_ = h_;
    t_ += h_;
    y_ = predicted_ + h_ * g_[k + 1] * (yp_ - phi_[1]);
    system_->accept(t_, y_);
    if (!system_->derivative(t_, y_, yp_)) return stopped(t_, kNoEvaluation);
    phi_[k + 1] = yp_ - phi_[1];
    phi_[k + 2] = phi_[k + 1] - phi_[k + 2];
    for (int i = 1; i <= k; ++i) phi_[i] += phi_[k + 1];
    ++counts_.steps;
    low_order_steps_ = k <= 4 ? low_order_steps_ + 1 : 0;
    stiff_ = stiff_ || low_order_steps_ >= kStiffSteps;
    choose_next(error_k, error_below, next);
    return {};
  }
}

void ShampineGordon::choose_next(double error_k, double error_below, int next) {
  const int k = k_;
  if (next == k - 1 || k >= settings_.max_order) first_phase_ = false;
  double error = error_k;
  if (first_phase_) {
    k_ = k + 1;
  } else if (next == k - 1) {
    k_ = k - 1;
    error = error_below;
  } else if (k + 1 <= same_steps_) {
    const double error_above = h_ * kErrorConstant[k + 1] * norm(phi_[k + 2]);
    if (k > 1 && error_below <= std::min(error_k, error_above)) {
      k_ = k - 1;
      error = error_below;
    } else if (k < settings_.max_order && error_above < (k > 1 ? error_k : 0.5 * error_k)) {
      k_ = k + 1;
      error = error_above;
    }
  }
  const double half_eps = 0.5 * eps_;
  if (first_phase_ || half_eps >= error * std::ldexp(1.0, k_ + 1)) {
    h_ *= 2;
  } else if (half_eps < error) {
    const double ratio = std::pow(half_eps / error, 1.0 / (k_ + 1));
    h_ *= std::clamp(ratio, 0.5, 0.9);
  }
}

Vector ShampineGordon::at(double t) const {
  if (k_old_ == 0) return y_;
  const double hi = t - t_;
  const int ki = k_old_ + 1;
  Coefficients g{}, w{};
  g[1] = 1;
  for (int i = 1; i <= ki; ++i) w[i] = 1.0 / i;
  double term = 0;
  for (int j = 2; j <= ki; ++j) {
    const double gamma = (hi + term) / psi_[j - 1], eta = hi / psi_[j - 1];
    for (int i = 1; i <= ki + 1 - j; ++i) w[i] = gamma * w[i] - eta * w[i + 1];
    g[j] = w[1];
    term = psi_[j - 1];
  }
  Vector sum = Vector::Zero(y_.size());
  for (int i = ki; i >= 1; --i) sum += g[i] * phi_[i];
  return y_ + hi * sum;
}

}  // namespace sinew::multibody
