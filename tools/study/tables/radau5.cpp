#include "study/tables/radau5.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>

namespace sinew::study {
namespace {

using multibody::Vector;

constexpr double kRound = std::numeric_limits<double>::epsilon();
constexpr int kMaxIterations = 7;
constexpr double kSafety = 0.9;
constexpr double kFastEnough = 1e-3;            ///< rate of Newton's method at which a tangent is kept
constexpr double kGrow = 8, kShrink = 5;        ///< of a step, at most
constexpr double kKeepFrom = 1, kKeepTo = 1.2;  ///< change of the step that is not worth new factors
constexpr double kSmallestStep = 16;            ///< resolutions of time

const double kRoot6 = std::sqrt(6.0);
const double kNode[3] = {(4 - kRoot6) / 10, (4 + kRoot6) / 10, 1};

/// Radau IIA of order 5: A_ij = ∫ from 0 to c_i of Lagrange's polynomial j.
Eigen::Matrix3d coefficients() {
  Eigen::Matrix3d powers, integrals;
  for (int i = 0; i < 3; ++i)
    for (int k = 0; k < 3; ++k) {
      powers(i, k) = std::pow(kNode[i], k);
      integrals(i, k) = std::pow(kNode[i], k + 1) / (k + 1);
    }
  return integrals * powers.inverse();
}

/// Weights of the embedded formula on z_i, times γ (RADAU5's DD1 to DD3).
const double kEstimate[3] = {-(13 + 7 * kRoot6) / 3, (-13 + 7 * kRoot6) / 3, -1.0 / 3};

}  // namespace

ComplexHalf complex_half(const multibody::Equations& equations) {
  struct State {
    std::complex<double> c;
    Eigen::PartialPivLU<Eigen::MatrixXcd> factor;
  };
  const auto state = std::make_shared<State>();
  const auto factorise = [state, &equations](std::complex<double> c) {
    state->c = c;
    const Eigen::MatrixXcd matrix = multibody::iteration_matrix(equations.parts(), c);
    if (!matrix.allFinite()) return false;
    state->factor.compute(matrix);
    return state->factor.matrixLU().diagonal().cwiseAbs().minCoeff() > 0;
  };
  const auto solve = [state, &equations](Eigen::VectorXcd& r) {
    const auto of_rates = [&](const Eigen::VectorXcd& x) { return Eigen::VectorXcd(state->factor.solve(x)); };
    multibody::solve_newton(equations.parts(), equations.transformation(), state->c, of_rates, r);
  };
  return {factorise, solve};
}

Radau5::Radau5(multibody::System& system, ComplexHalf complex_half, double t0, const Vector& y0, double end,
               const multibody::IntegratorSettings& settings)
    : system_(&system),
      complex_(std::move(complex_half)),
      settings_(settings),
      end_(end),
      t_(t0),
      y_(y0),
      yp_(y0.size()),
      z_(Stages::Zero(y0.size(), 3)),
      w_(Stages::Zero(y0.size(), 3)),
      before_(y0),
      last_z_(Stages::Zero(y0.size(), 3)) {
  // As the program does: a tolerance of the method is one of its estimate of order 3.
  const double ratio = settings.atol / settings.rtol;
  settings_.rtol = 0.1 * std::pow(settings.rtol, 2.0 / 3);
  settings_.atol = ratio * settings_.rtol;
  newton_tolerance_ = std::max(10 * kRound / settings_.rtol, std::min(0.03, std::sqrt(settings_.rtol)));
  inverse_a_ = coefficients().inverse();
  const Eigen::EigenSolver<Eigen::Matrix3d> eigen(inverse_a_);
  for (int i = 0; i < 3; ++i) {
    const std::complex<double> value = eigen.eigenvalues()[i];
    if (std::abs(value.imag()) < 1e-9) {
      gamma_ = value.real();
      to_stages_.col(0) = eigen.eigenvectors().col(i).real();
    } else if (value.imag() > 0) {
      alpha_beta_ = value;
      to_stages_.col(1) = eigen.eigenvectors().col(i).real();
      to_stages_.col(2) = eigen.eigenvectors().col(i).imag();
    }
  }
  from_stages_ = to_stages_.inverse();
}

double Radau5::norm(const Vector& x) const {
  return std::sqrt((x.array() / scale_.array()).square().mean());
}

std::string Radau5::first_step() {
  if (!system_->derivative(t_, y_, yp_))
    return multibody::stopped(t_, "the equations cannot be evaluated at the start");
  scale_ = settings_.atol + settings_.rtol * y_.array().abs();
  const double slope = norm(yp_);
  h_ = 1e-3 * (end_ - t_);
  if (slope > 0.5 / h_) h_ = 0.5 / slope;
  started_ = true;
  return {};
}

bool Radau5::new_tangent() {
  tangent_here_ = system_->tangent(t_, y_, yp_, gamma_ / h_, true);
  factors_valid_ = false;
  return tangent_here_;
}

bool Radau5::residuals(Stages& out) {
  Vector f(y_.size());
  for (int i = 0; i < 3; ++i) {
    const Vector rate = z_ * inverse_a_.row(i).transpose() / h_;
    if (!system_->residual(t_ + kNode[i] * h_, y_ + z_.col(i), rate, f)) return false;
    out.col(i) = f;
  }
  out = (out * from_stages_.transpose()).eval();
  return out.allFinite();
}

bool Radau5::factorise() {
  // The real one first: it renews what the parts need.
  factors_valid_ = system_->factorise(gamma_ / h_) && complex_.factorise(alpha_beta_ / h_);
  contraction_ = 1;
  return factors_valid_;
}

bool Radau5::iterate() {
  Stages g(y_.size(), 3);
  contraction_ = std::pow(std::max(contraction_, kRound), 0.8);
  theta_ = kFastEnough;
  shrink_ = 0.5;
  double before = 0, rate_before = 0;
  for (iterations_ = 1; iterations_ <= kMaxIterations; ++iterations_) {
    ++counts_.newton_iterations;
    if (!residuals(g) || (!factors_valid_ && !factorise())) return false;
    Vector real = g.col(0);
    system_->solve(real);
    Eigen::VectorXcd both = g.col(1) - std::complex<double>(0, 1) * g.col(2);
    complex_.solve(both);
    g.col(0) = -real;
    g.col(1) = -both.real();
    g.col(2) = both.imag();
    w_ += g;
    z_ = w_ * to_stages_.transpose();
    const double size = std::sqrt((g.array().colwise() / scale_.array()).square().mean());
    if (!std::isfinite(size)) return false;
    if (size <= h_ * system_->noise() / settings_.atol) return true;
    if (iterations_ > 1) {
      const double rate = size / before;
      theta_ = iterations_ == 2 ? rate : std::sqrt(rate * rate_before);
      rate_before = rate;
      if (!(theta_ < 0.99)) return false;
      contraction_ = theta_ / (1 - theta_);
      const double left = kMaxIterations - 1 - iterations_;
      const double promised = contraction_ * size * std::pow(theta_, left) / newton_tolerance_;
      if (promised >= 1) {
        const double too_much = std::clamp(promised, 1e-4, 20.0);
        shrink_ = 0.8 * std::pow(too_much, -1 / (4 + left));
        return false;
      }
    }
    before = std::max(size, kRound);
    if (contraction_ * size <= newton_tolerance_) return true;
  }
  return false;
}

double Radau5::estimate(const Vector& at, const Vector& rate) {
  Vector e(y_.size());
  if (!system_->residual(t_, at, rate, e)) return -1;
  system_->solve(e);
  e = -e;
  const double size = norm(e) - h_ * system_->noise() / settings_.atol;
  if (size >= 1 && (first_ || rejected_) && &at == &y_) {  // once more, filtered
    const Vector moved = y_ + e;
    return estimate(moved, rate);
  }
  return std::isfinite(size) ? std::max(size, 1e-10) : -1;
}

double Radau5::error() {
  Vector rate = Vector::Zero(y_.size());
  for (int i = 0; i < 3; ++i) rate -= kEstimate[i] / h_ * z_.col(i);
  return estimate(y_, rate);
}

Vector Radau5::polynomial(double s) const {
  // Lagrange's through 0 at s = 0 and z_i at the nodes.
  Vector sum = Vector::Zero(y_.size());
  for (int i = 0; i < 3; ++i) {
    double weight = s / kNode[i];
    for (int k = 0; k < 3; ++k)
      if (k != i) weight *= (s - kNode[k]) / (kNode[i] - kNode[k]);
    sum += weight * last_z_.col(i);
  }
  return sum;
}

void Radau5::predict_stages() {
  if (first_)
    z_.setZero();
  else
    for (int i = 0; i < 3; ++i) z_.col(i) = polynomial(1 + kNode[i] * h_ / taken_) - last_z_.col(2);
  w_ = z_ * from_stages_.transpose();
}

void Radau5::accept(double error) {
  const double used = kSafety * (1 + 2 * kMaxIterations) / (iterations_ + 2 * kMaxIterations);
  double quotient = std::clamp(std::pow(error, 0.25) / std::min(kSafety, used), 1 / kGrow, kShrink);
  if (!first_) {
    // Gustafsson's prediction.
    const double trend = accepted_step_ / h_ * std::pow(error * error / accepted_error_, 0.25) / kSafety;
    quotient = std::max(quotient, std::clamp(trend, 1 / kGrow, kShrink));
  }
  accepted_step_ = h_;
  accepted_error_ = std::max(1e-2, error);
  const Vector rate = z_ * inverse_a_.row(2).transpose() / h_;
  taken_ = h_;
  before_ = y_;
  last_z_ = z_;
  t_ += h_;
  y_ += z_.col(2);
  yp_ = rate;
  ++counts_.steps;
  const bool other_meaning = system_->accept(t_, y_);
  scale_ = settings_.atol + settings_.rtol * y_.array().abs();
  double next = h_ / quotient;
  if (rejected_) next = std::min(next, h_);
  const bool keep_tangent = theta_ <= kFastEnough && !other_meaning;
  if (keep_tangent && next >= kKeepFrom * h_ && next <= kKeepTo * h_) next = h_;
  if (next != h_ || !keep_tangent) factors_valid_ = false;
  tangent_here_ = keep_tangent;
  h_ = next;
  first_ = rejected_ = false;
}

void Radau5::reject(double error) {
  const double used = kSafety * (1 + 2 * kMaxIterations) / (iterations_ + 2 * kMaxIterations);
  ++counts_.error_failures;
  h_ *= first_ ? 0.1 : 1 / std::clamp(std::pow(error, 0.25) / std::min(kSafety, used), 1 / kGrow, kShrink);
  rejected_ = true;
  factors_valid_ = false;
}

std::string Radau5::step() {
  if (!started_)
    if (std::string why = first_step(); !why.empty()) return why;
  if (10 * kRound >= settings_.rtol && settings_.atol < kRound)
    return multibody::stopped(t_, multibody::kTooAccurate);
  bool tangent_of_now = false;
  for (int failures = 0; failures < 60; ++failures) {
    if (settings_.max_step > 0 && h_ > settings_.max_step) h_ = settings_.max_step, factors_valid_ = false;
    if (h_ < kSmallestStep * kRound * std::abs(t_)) break;
    if (!tangent_here_) {
      if (!new_tangent()) return multibody::stopped(t_, "the equations have no tangent here");
      tangent_of_now = true;
    }
    predict_stages();
    if (!iterate()) {
      ++counts_.newton_failures;
      h_ *= shrink_;
      rejected_ = true;
      factors_valid_ = false;
      tangent_here_ = tangent_of_now;
      continue;
    }
    const double e = error();
    if (e >= 0 && e < 1) {
      accept(e);
      return {};
    }
    reject(e < 0 ? 1e4 : e);
    tangent_here_ = tangent_of_now;
  }
  return multibody::stopped(t_, multibody::kStepTooSmall);
}

Vector Radau5::at(double t) const {
  if (taken_ == 0) return y_;
  const double s = (t - t_ + taken_) / taken_;
  return s == 1 ? y_ : Vector(before_ + polynomial(s));
}

}  // namespace sinew::study
