// The schemes in time that the documents compare with the runtime's own (bossak.h): never left, whatever
// happens to contacts, and with no rule of their own. For studies; no program of a game links them.
//
//   momentum  as bdf1, but the rotational residual is the seed talk's literal (I₁ω₁ − L₀)/h with
//             ω₁ = log(R₁R₀ᵀ)/h: no gradient of any energy ("Character Physics and Animation in Full Auto")
//   bdf1      ĉ = c₀ + h ċ₀                     R̂ = R₀ + h Ṙ₀ (affine)      α = 1/h²
//   bdf2      ĉ = a₀c₀ + a₁c₋₁ + βh(a₀ċ₀ + a₁ċ₋₁)   R̂ = R₀ exp(x)           α = 1/(βh²)
//             a₀ = (1+w)²/(1+2w), a₁ = −w²/(1+2w), β = (1+w)/(1+2w), w = h/h₋₁; the first step is bdf1's
//
// semi_implicit.h and forward_euler.h have the two that the talk argues against.
//
// x is the torque-free rotation: I·(derivative of the rotation vector) = exp(−x) R₀ᵀ L*, L* = a₀L₀ + a₁L₋₁.
// With an affine R̂ bdf2 would be as stable, but free spin would decay.
#pragma once

#include <optional>
#include <string>

#include "sinew/character/world.h"
#include "sinew/optimizer/time_scheme.h"

namespace sinew::study {

/// Implicit Euler.
template <class T>
class Bdf1 : public TimeScheme<T> {
 public:
  static void declare(StepPlan<T>& plan);
  void predict(const Tree<T>& tree, const History<T>& history, T h, const Vec3<double>& common_origin,
               Prediction<T>& out) const override;
  void advance(const Tree<T>& tree, const Kinematics<T>& kinematics, const Prediction<T>& prediction,
               std::span<const Vec3<T>> torque, T h, const Vec3<double>& common_origin,
               History<T>& history) const override;
};

/// The seed talk's residual. Newton alone, with nothing to fall back on; splits where it fails.
template <class T>
class Momentum : public Bdf1<T> {
 public:
  static void declare(StepPlan<T>& plan);
  void predict(const Tree<T>& tree, const History<T>& history, T h, const Vec3<double>& common_origin,
               Prediction<T>& out) const override;
  bool has_energy() const override { return false; }
  Vec3<T> couple(const StepSettings<T>& settings, const TreeProblem<T>& problem, int body) const override;
};

template <class T>
class Bdf2 : public TimeScheme<T> {
 public:
  static void declare(StepPlan<T>& plan);
  /// The state before a step of h seconds that led to `now`.
  static void keep(const History<T>& before, T h, History<T>& now);
  void predict(const Tree<T>& tree, const History<T>& history, T h, const Vec3<double>& common_origin,
               Prediction<T>& out) const override;
  void advance(const Tree<T>& tree, const Kinematics<T>& kinematics, const Prediction<T>& prediction,
               std::span<const Vec3<T>> torque, T h, const Vec3<double>& common_origin,
               History<T>& history) const override;
};

enum class Compared { kBossak, kBdf2, kBdf1, kMomentum, kSemiImplicit, kForwardEuler };

/// By the name that scene files give it: bossak, bdf2, bdf1, momentum, semi_implicit, forward_euler.
std::optional<Compared> scheme_named(const std::string& name);

/// Lets a world step by it; before anything is added. kBossak: as it does by itself.
template <class T>
Status declare_scheme(Compared scheme, World<T>& world);

extern template class Bdf1<float>;
extern template class Bdf1<double>;
extern template class Momentum<float>;
extern template class Momentum<double>;
extern template class Bdf2<float>;
extern template class Bdf2<double>;
extern template Status declare_scheme<float>(Compared, World<float>&);
extern template Status declare_scheme<double>(Compared, World<double>&);

}  // namespace sinew::study
