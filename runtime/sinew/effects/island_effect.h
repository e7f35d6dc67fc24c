// What acts on everything that is solved together and is no energy of a pose: on the guess that a solve
// starts from, or on the speeds that it left.
//
// Declared by its type, once for a world: World::declare<Restitution>(). Where nobody declares it, it is
// neither called nor linked. Each worker has its own, which keeps nothing from one step to the next.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>

#include "sinew/optimizer/problem.h"

namespace sinew {

/// One tree of a solve.
template <class T>
struct IslandTree {
  TreeProblem<T>& problem;           ///< what its solve works on
  History<T>& history;               ///< motion of its bodies, which the next step begins with
  std::span<std::array<T, 6>> rate;  ///< [body] joint speeds over the last step
  Kinematics<T>& guessed;            ///< room, for the pose that a solve starts from
  double& elastic_energy;            ///< J, stored in contacts and joint limits
  int& steps_unchanged;              ///< steps since contacts changed
  std::uint64_t& contact_signature;  ///< of the contacts that touched after the last step

  /// Velocity (m/s) of a body's material point, given from the common origin of the problem's kinematics.
  Vec3<T> point_velocity(int body, const Vec3<T>& point) const {
    const Mat3<T> spin = history.rotation_rate[body] * history.rotation[body].transpose();
    return history.velocity[body] + spin * (point - problem.kinematics.center[body]);
  }
};

/// Something that acts on all that is solved together. Every one overrides reserve() and bytes(), and what it
/// acts by.
template <class T>
class IslandEffect {
 public:
  using Trees = std::span<const IslandTree<T>>;  ///< all that is solved together

  virtual ~IslandEffect() = default;
  /// Set-up: memory for what may be solved together. The only place to allocate.
  virtual void reserve(const SolveCapacity& capacity) = 0;
  /// That reserve() takes.
  virtual std::size_t bytes(const SolveCapacity& capacity) const = 0;

  /// Before a solve of h seconds: lowers `share` [tree], the part of the motion from `problem.start` to
  /// `problem.local` that the solve may start with. Contacts and kinematics stand at the step's beginning.
  virtual void limit_guess(Trees /*trees*/, std::span<const Contact<T>> /*contacts*/, T /*h*/,
                           std::span<T> /*share*/) {}
  /// Whether a contact that is open at both ends of the guessed motion, from where the contacts were measured
  /// to the trees' `guessed`, closes on the way.
  virtual bool meets_on_the_way(Trees /*trees*/, const Contact<T>& /*contact*/) const { return false; }
  /// How a contact parts that strikes within a step of h seconds.
  virtual Bounce<T> bounce_of(const Contact<T>& /*contact*/, const Vec3<double>& /*gravity*/, T /*h*/) const {
    return {};
  }
  /// After a solve: whether change_speeds() has anything to look at.
  virtual bool may_change_speeds(std::span<const Contact<T>> /*contacts*/) const { return false; }
  /// Then: changes the histories' velocities, never to more energy than `budget` (J, before the step). True
  /// if it did.
  virtual bool change_speeds(Trees /*trees*/, std::span<Contact<T>> /*contacts*/,
                             const Vec3<double>& /*gravity*/, T /*h*/, double /*budget*/) {
    return false;
  }
  /// N·s along its normal that this has given a contact.
  virtual T pushed(const Contact<T>& /*contact*/) const { return T(0); }
};

/// Makes one of its type; what World::declare takes.
template <class T>
using MakeIslandEffect = std::unique_ptr<IslandEffect<T>> (*)();

}  // namespace sinew
