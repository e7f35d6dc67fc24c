#include "sinew/multibody/equations.h"

#include <cmath>
#include <cstdio>
#include <limits>

namespace sinew::multibody {
namespace {

constexpr double kClosed = 1e-10;        ///< m, in an evaluation; outputs are closed to kClosedOutput
constexpr double kClosedOutput = 1e-13;  ///< m
constexpr double kNearby = 0.5;          ///< rad or m that start coordinates may be moved to close loops
constexpr double kWorstGrowth = 5;  ///< |∂q_d/∂q_i| from which other independent coordinates are tried

std::string text(double x) {
  char buffer[32];
  std::snprintf(buffer, sizeof buffer, "%.3g", x);
  return buffer;
}

}  // namespace

Equations::Equations(const Model& model, Formulation formulation, Tangent tangent, Closure closure)
    : model_(&model),
      formulation_(formulation),
      tangent_kind_(tangent),
      closure_(closure),
      n_(model.size()),
      motion_(model),
      applied_(model),
      rz_(model, closure == Closure::kInSteps ? LoopFactor::Kind::kNormal : LoopFactor::Kind::kOrthogonal),
      articulated_(model),
      semi_recursive_(model),
      recursive_residual_(model),
      q_(n_),
      qd_(n_),
      qdd_(n_),
      bias_(Vector::Zero(n_)),
      force_(n_),
      reduced_(n_),
      mass_(Matrix::Zero(n_, n_)),
      tree_factor_(model) {
  parts_.derivatives = formulation != Formulation::kRr;
  parts_.of_forces = tangent == Tangent::kAnalytic;
}

std::string Equations::start(Vector& y) {
  const Mechanism& mechanism = model_->mechanism();
  y.resize(2 * n_);
  for (int i = 0; i < n_; ++i) {
    y[i] = mechanism.joints[i].q0;
    y[n_ + i] = mechanism.joints[i].qd0;
  }
  move_to(*model_, y.head(n_), motion_);
  if (model_->loop_rows == 0) return {};
  const Gap asked = rz_.gap(motion_);
  rz_.choose(motion_);
  const auto loop_name = [&](int i) { return "loop '" + mechanism.loops[i].name + "'"; };
  const Vector asked_q = y.head(n_);
  if (!rz_.close_positions(y.head(n_), motion_, kClosedOutput) ||
      (y.head(n_) - asked_q).cwiseAbs().maxCoeff() > kNearby)
    return loop_name(asked.loop) + " cannot be assembled: gap of " + text(asked.size) +
           " m at the start coordinates, and no position within " + text(kNearby) +
           " rad or m of them closes it";
  rz_.choose(motion_);
  rz_.close_positions(y.head(n_), motion_, kClosedOutput);
  Matrix jacobian(model_->loop_rows, n_);
  closure_jacobian(*model_, motion_, jacobian);
  const Vector speed = jacobian * y.tail(n_);
  const Gap opening = worst_gap(*model_, speed);
  if (!(opening.size <= 1e-6 * std::max(1.0, y.tail(n_).cwiseAbs().maxCoeff())))
    return loop_name(opening.loop) + " is torn apart by the initial velocities at " + text(opening.size) +
           " m/s";
  rz_.close_rates(y.tail(n_));
  return {};
}

bool Equations::prepare(double t, const Vector& y) {
  q_ = y.head(n_);
  qd_ = y.tail(n_);
  if (!q_.allFinite() || !qd_.allFinite()) return false;
  if (closure_ == Closure::kInSteps) {
    move_to(*model_, q_, motion_);
    rz_.linearise(motion_);
    rz_.follow(qd_);
  } else {
    if (!rz_.close_positions(q_, motion_, kClosed)) return false;
    rz_.close_rates(qd_);
  }
  set_rates(*model_, qd_, motion_);
  apply_forces(*model_, t, q_, qd_, motion_, applied_);
  return true;
}

bool Equations::accelerations(double t, const Vector& y, Vector& qdd) {
  ++counts_.derivatives;
  if (!prepare(t, y)) return false;
  if (rz_.trivial()) {
    if (formulation_ == Formulation::kDtr)
      articulated_.evaluate(motion_, applied_, qdd);
    else
      semi_recursive_.evaluate(motion_, applied_, qdd);
    return qdd.allFinite();
  }
  // The 11 steps of section 2.2.2; steps 1–5 are prepare and bias.
  rz_.bias(motion_, bias_);
  accelerate(*model_, bias_, motion_);
  semi_recursive_.forces(motion_, applied_, force_);
  semi_recursive_.mass_matrix(motion_, mass_);
  rz_.reduce(force_, reduced_);
  rz_.reduce(mass_, reduced_mass_);
  mass_factor_.compute(reduced_mass_);
  mass_factor_.solveInPlace(reduced_);
  for (int i = 0; i < rz_.freedom(); ++i) qdd[rz_.independent()[i]] = reduced_[i];
  rz_.expand(bias_, qdd);
  return qdd.allFinite();
}

bool Equations::derivative(double t, const Vector& y, Vector& yp) {
  if (!accelerations(t, y, qdd_)) return false;
  yp.head(n_) = qd_;
  yp.tail(n_) = qdd_;
  return true;
}

bool Equations::independent_residual(double t, const Vector& y, const Vector& qdd, Vector& out) {
  ++counts_.residuals;
  if (!prepare(t, y)) return false;
  qdd_ = qdd;
  if (!rz_.trivial()) {
    rz_.bias(motion_, bias_);
    rz_.expand(bias_, qdd_);
  }
  accelerate(*model_, qdd_, motion_);
  recursive_residual_.evaluate(motion_, applied_, force_);
  rz_.reduce(force_, out);
  return out.allFinite();
}

bool Equations::residual(double t, const Vector& y, const Vector& yp, Vector& r) {
  if (formulation_ != Formulation::kRr) {
    if (!accelerations(t, y, qdd_)) return false;
    r.head(n_) = yp.head(n_) - qd_;
    r.tail(n_) = yp.tail(n_) - qdd_;
    return true;
  }
  if (!independent_residual(t, y, yp.tail(n_), reduced_)) return false;
  r.head(n_) = yp.head(n_) - qd_;
  if (rz_.trivial()) {
    r.tail(n_) = reduced_;
  } else {
    r.tail(n_) = yp.tail(n_) - qdd_;
    for (int i = 0; i < rz_.freedom(); ++i) r[n_ + rz_.independent()[i]] = reduced_[i];
  }
  return true;
}

bool Equations::analytic_tangent(double t, const Vector& y) {
  if (!prepare(t, y)) return false;
  Matrix k = Matrix::Zero(n_, n_), d = Matrix::Zero(n_, n_);
  add_force_tangent(*model_, t, q_, qd_, motion_, k, d);
  inertia_is_mass_ = true;
  rz_.reduce(k, parts_.stiffness);
  if (closure_ == Closure::kInSteps && !rz_.trivial()) reduce_rows(k, parts_.stiffness_to_all);
  rz_.reduce(d, parts_.damping);
  return true;
}

void Equations::move_position(int k, double by, Vector& y) const {
  Vector along = Vector::Unit(n_, k);
  if (closure_ == Closure::kInSteps) rz_.follow(along);  // otherwise the evaluation makes them follow
  y.head(n_) += by * along;
}

bool Equations::numeric_tangent(double t, const Vector& y, const Vector& yp, double c, bool reusable) {
  const int nf = rz_.freedom();
  parts_.stiffness.resize(nf, nf);
  parts_.damping.resize(nf, nf);
  parts_.inertia = Matrix::Zero(nf, nf);
  if (formulation_ != Formulation::kRr) parts_.inertia.setIdentity();
  inertia_is_mass_ = formulation_ == Formulation::kRr && reusable;
  Vector base(nf), moved(nf), state = y, rate = yp, qdd(n_);
  const auto evaluate = [&](Vector& out) {
    if (formulation_ == Formulation::kRr) return independent_residual(t, state, rate.tail(n_), out);
    if (!accelerations(t, state, qdd)) return false;
    for (int i = 0; i < nf; ++i) out[i] = -qdd[rz_.independent()[i]];
    return true;
  };
  if (!evaluate(base)) return false;
  const double root = std::sqrt(std::numeric_limits<double>::epsilon());
  for (int j = 0; j < nf; ++j) {
    const int k = rz_.independent()[j];
    const double dq = root * std::max(1.0, std::abs(y[k])), dv = root * std::max(1.0, std::abs(y[n_ + k]));
    move_position(k, dq, state);
    if (!evaluate(moved)) return false;
    parts_.stiffness.col(j) = (moved - base) / dq;
    state.head(n_) = y.head(n_);
    state[n_ + k] += dv;
    // Codes that evaluate the tangent for one c only take velocity and acceleration together; the others get
    // the mass by itself, when they factorise.
    if (formulation_ == Formulation::kRr && !reusable) rate[n_ + k] += c * dv;
    if (!evaluate(moved)) return false;
    parts_.damping.col(j) = (moved - base) / dv;
    state[n_ + k] = y[n_ + k];
    rate[n_ + k] = yp[n_ + k];
  }
  return true;
}

bool Equations::tangent(double t, const Vector& y, const Vector& yp, double c, bool reusable) {
  ++counts_.tangents;
  return tangent_kind_ == Tangent::kAnalytic ? analytic_tangent(t, y)
                                             : numeric_tangent(t, y, yp, c, reusable);
}

void Equations::reduce_rows(const Matrix& a, Matrix& out) const {
  out.resize(rz_.freedom(), n_);
  Vector column;
  for (int j = 0; j < n_; ++j) {
    rz_.reduce(Vector(a.col(j)), column);
    out.col(j) = column;
  }
}

void Equations::renew_mass() {
  semi_recursive_.mass_matrix(motion_, mass_);
  rz_.reduce(mass_, parts_.inertia);
}

bool Equations::factorise(double c) {
  ++counts_.factorisations;
  c_ = c;
  if (inertia_is_mass_) renew_mass();
  iteration_ = iteration_matrix(parts_, c);
  if (!iteration_.allFinite()) return false;
  by_tree_ = inertia_is_mass_ && tangent_kind_ == Tangent::kAnalytic && rz_.trivial() &&
             tree_factor_.factorise(iteration_);
  if (by_tree_) return true;
  factor_.compute(iteration_);
  return factor_.matrixLU().diagonal().cwiseAbs().minCoeff() > 0;
}

void Equations::solve(Vector& r) {
  const auto solve_rates = [this](Vector& x) {
    if (by_tree_)
      tree_factor_.solve(x);
    else
      x = factor_.solve(x).eval();
    return x;
  };
  solve_newton(parts_, rz_, c_, solve_rates, r);
}

bool Equations::close(Vector& y) {
  if (!rz_.close_positions(y.head(n_), motion_, kClosedOutput)) return false;
  rz_.close_rates(y.tail(n_));
  set_rates(*model_, y.tail(n_), motion_);
  return true;
}

double Equations::noise() const {
  // A gap of rounding size moves dependent coordinates by 1/σ of it, their rates by 1/σ², accelerations by
  // 1/σ³.
  const double weakest = rz_.weakest();
  if (rz_.trivial() || weakest > VelocityTransformation::kWeak) return 0;
  const double speed = qd_.cwiseAbs().maxCoeff();
  return std::numeric_limits<double>::epsilon() * speed * speed / (weakest * weakest * weakest);
}

bool Equations::poorly_chosen() const {
  return rz_.growth() > kWorstGrowth;
}

bool Equations::accept(double, Vector& y) {
  // In every step, though evaluations close the loops for themselves: dependent coordinates that were left to
  // drift lose the branch at a singular position.
  if (rz_.trivial() || !close(y)) return false;
  return poorly_chosen() && rz_.choose(motion_);
}

}  // namespace sinew::multibody
