// What an integrator asks of a system of ordinary differential equations, explicit or implicit.
#pragma once

#include <Eigen/Core>

namespace sinew::multibody {

using Vector = Eigen::VectorXd;

/// y' = f(t, y), or F(t, y, y') = 0. Functions that answer bool say false where the system cannot be
/// evaluated (a loop that does not close, a number that is not finite): the integrator then tries a shorter
/// step.
class System {
 public:
  virtual ~System() = default;
  virtual int size() const = 0;
  virtual bool derivative(double t, const Vector& y, Vector& yp) = 0;
  virtual bool residual(double t, const Vector& y, const Vector& yp, Vector& r) = 0;

  /// Evaluates the parts of ∂F/∂y + c·∂F/∂y' at a state. `reusable`: `factorise` will be called with other c
  /// as well (quasi-constant step codes), otherwise only with this one.
  virtual bool tangent(double t, const Vector& y, const Vector& yp, double c, bool reusable) = 0;
  /// Factorises ∂F/∂y + c·∂F/∂y' from the parts last evaluated. What a system knows without differences, the
  /// mass matrix, it renews at the state of its last evaluation (equations 81–83 keep the two apart), so
  /// methods evaluate the residual first. False: singular.
  virtual bool factorise(double c) = 0;
  /// Solves with that factor in place: r → δ.
  virtual void solve(Vector& r) = 0;

  /// Size of the error in y' that rounding left in the last evaluation where it is far above rounding itself
  /// (close to a singular position), else 0. Shorter steps cannot reduce it, so methods must not ask for them
  /// on its account.
  virtual double noise() const { return 0; }

  /// Called with each accepted state; may correct y (drift of dependent coordinates). True: the meaning of
  /// the tangent's parts has changed, evaluate it anew.
  virtual bool accept(double, Vector&) { return false; }
};

}  // namespace sinew::multibody
