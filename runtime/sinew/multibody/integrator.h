// Integrators of variable step and order, one step at a time.
#pragma once

#include <memory>
#include <string>

#include "sinew/multibody/system.h"

namespace sinew::multibody {

struct IntegratorSettings {
  double rtol = 1e-5, atol = 1e-5;  ///< local error per component: atol + rtol·|y|
  double max_step = 0;              ///< s; 0: none
  double fixed_step = 1e-3;         ///< s; fixed-step schemes
  int max_order = 0;                ///< 0: all that the method has
};

struct StepCounts {
  long steps = 0;           ///< accepted
  long error_failures = 0;  ///< steps repeated because of their error
  long newton_iterations = 0;
  long newton_failures = 0;  ///< steps repeated because Newton's method did not converge
};

/// A method that has been started at a state and walks on. `step` answers "" or why it cannot go on.
class Integrator {
 public:
  virtual ~Integrator() = default;
  virtual std::string step() = 0;
  virtual double time() const = 0;          ///< end of the last accepted step
  virtual double last_step() const = 0;     ///< its length
  virtual const Vector& state() const = 0;  ///< y there
  virtual Vector at(double t) const = 0;    ///< y inside (or just outside) the last step
  virtual int order() const = 0;            ///< of the last step
  /// True once the method suspects that its step is limited by stability, not accuracy.
  virtual bool looks_stiff() const { return false; }
  const StepCounts& counts() const { return counts_; }

 protected:
  StepCounts counts_;
};

enum class Method {
  kDe,           ///< Shampine–Gordon Adams PECE, orders 1–12
  kOde15s,       ///< NDF 1–5, quasi-constant step, on derivatives
  kOde15sR,      ///< the same on residuals
  kDassl,        ///< BDF 1–5, fixed leading coefficient, as published: root mean square, rates kept
  kDasslStrict,  ///< the same in the norm and with the rule of convergence of the other methods
  kBdf1,         ///< implicit Euler, fixed step
  kBdf2,         ///< second-order BDF, fixed step
};

/// `system` must outlive the integrator. y0 at t0; y' there is asked of the system. `end` only scales the
/// first step.
std::unique_ptr<Integrator> start(Method method, System& system, double t0, const Vector& y0, double end,
                                  const IntegratorSettings& settings);

/// Largest |x|/(atol + rtol·|scale|) of a component: ≤ 1 is accurate enough.
double worst_component(const Vector& x, const Vector& scale, const IntegratorSettings& settings);

constexpr const char* kTooAccurate = "the tolerance is below what double precision can resolve";
constexpr const char* kStepTooSmall =
    "the tolerance cannot be reached: the step needed is below the resolution of time";

/// "stopped at t = … s: reason", the form in which every method says why it stops.
std::string stopped(double t, const char* reason);

}  // namespace sinew::multibody
