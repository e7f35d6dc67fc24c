// Energy without work: the last word on what a step may leave behind.
//
// Steps dissipate, or nearly do, but a constraint's reaction works along the chord that a joint's arc
// is stepped by, of the order of h²g/length and h²|ω|², so an inverted pendulum or a light link that whirls
// about a heavy one can gain. Where nothing does work, each island has a ceiling that never rises: what a
// step leaves above it is taken out of the motion, first of that relative to each tree's centre of mass.
// A tree in flight keeps its angular momentum, and one whose joints reach no limit loses nothing but what
// rubs within them: what the step took or gave beyond goes into the motion of its limbs against each other.
// Source of the idea: Dinev, Liu & Kavan, "Stabilizing integrators for real-time physics", 2018.
#pragma once

#include <span>

#include "sinew/character/state.h"

namespace sinew {

template <class T>
class EnergyBalance {
 public:
  void reserve(int trees) { before_.reserve(trees); }
  /// Notes the energy of the trees before a step, J. Returns their sum.
  double open(std::span<CharacterState<T>* const> states, const Vec3<double>& gravity);
  /// Holds the trees of a passive island, stepped together since open(), under their ceiling. `strict` takes
  /// what they had before for the ceiling (a solve that did not converge); `tied`: they hang together;
  /// `exchanged`: they may have struck each other, even where they are apart again. What obstacles gave
  /// through `contacts` to a tree that began inside them is paid by its motion alone. True if motion was
  /// taken out.
  bool close(std::span<CharacterState<T>* const> states, std::span<const Contact<T>> contacts,
             const Vec3<double>& gravity, bool strict, bool tied, bool exchanged) const;

 private:
  struct Before {
    double energy = 0;  ///< J, without the work of depenetration that is not paid back
    Vec3<double> angular_momentum = Vec3<double>::Zero();  ///< kg·m²/s, about the centre of mass
    bool depenetrates = false;  ///< begins now, or has not paid yet: else it came in by itself
  };
  static void keep_in_flight(CharacterState<T>& state, const Vec3<double>& gravity, const Before& before);

  std::vector<Before> before_;  ///< [tree]
};

extern template class EnergyBalance<float>;
extern template class EnergyBalance<double>;

}  // namespace sinew
