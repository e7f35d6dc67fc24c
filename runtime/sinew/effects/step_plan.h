// What a world declares of the effects that are terms of every solve: the step's plan.
//
// Each declared effect fills its own entries in, from its own object file (Muscles::declare, …); an entry
// that is null is neither called nor linked. The others are planned per tree (effect.h) or per island
// (island_effect.h).
#pragma once

#include <memory>

#include "sinew/effects/joint_step.h"

namespace sinew {

class BatchCheck;
template <class T>
class ContactModel;
template <class T>
class EllipsoidModel;
template <class T>
struct ContactTerm;
template <class T>
struct PushTerm;
template <class T>
struct SupportTerm;
template <class T>
struct CouplingTerm;
template <class T>
class TimeScheme;

/// What a step calls; null: not declared.
template <class T>
struct StepPlan {
  JointTerms<T> joints;                                              ///< muscles, damping, limits, cones
  std::unique_ptr<EllipsoidModel<T>> (*ellipsoid_rows)() = nullptr;  ///< of muscles
  std::unique_ptr<ContactModel<T>> (*contact_rows)() = nullptr;      ///< of contacts, in a solve
  const ContactTerm<T>* contacts = nullptr;                          ///< who touches whom
  const PushTerm<T>* impulses = nullptr;                             ///< of Character::apply_impulse
  const SupportTerm<T>* support = nullptr;                 ///< by the floor, of who follows the animation
  const CouplingTerm<T>* couplings = nullptr;              ///< of loops and particles
  const TimeScheme<T>* scheme = nullptr;                   ///< in place of Bossak's, for comparisons
  std::unique_ptr<BatchCheck> (*make_checks)() = nullptr;  ///< in float alone

  /// Nothing declared.
  static const StepPlan& none() {
    static constexpr StepPlan kNone{};
    return kNone;
  }
};

/// Fills the entries of one effect in; what World::declare takes.
template <class T>
using DeclareTerm = void (*)(StepPlan<T>& plan);

}  // namespace sinew
