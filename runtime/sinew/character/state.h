// What one character (or prop) carries from step to step. Internal to the character layer.
#pragma once

#include <algorithm>
#include <array>
#include <limits>
#include <memory>
#include <vector>

#include "sinew/character/world.h"
#include "sinew/effects/contact.h"
#include "sinew/optimizer/problem.h"

namespace sinew {

/// Motion of one joint relative to the animation; zero while it is on it.
template <class T>
struct Deviation {
  std::array<T, 6> offset{};  ///< see joint_offset, from the animation
  std::array<T, 6> rate{};    ///< 1/s
  bool on_animation = true;   ///< exactly where the clip wants it
  bool released = false;      ///< was an unknown in the last step
};

template <class T>
struct CharacterState {
  Skeleton skeleton;
  Tree<T> tree;
  CharacterSettings settings;
  bool is_prop = false;
  bool parked = false;    ///< a prop out of the world
  bool carried = false;   ///< in this step, see carry_over()
  double total_mass = 0;  ///< kg
  bool floats = false;    ///< hangs on one free root, whose translation is `history.place` rounded

  std::vector<JointJet<T>> target,
      target_before;                          ///< [joint] what the animation wants now, and wanted last step
  std::vector<Transform<T>> local, model;     ///< [joint]
  std::vector<std::array<T, 6>> rate;         ///< [body] joint speed over the last step, as joint_offset
  std::vector<std::array<T, 6>> rate_before;  ///< [body] over the step before
  T rate_step = T(0);                         ///< s, that `rate` was measured over; 0: unknown
  std::vector<Deviation<T>> deviation;        ///< [body]
  std::vector<T> joint_strength;              ///< [body]
  std::vector<T> muscle_strength;             ///< [muscle of the skeleton]
  std::vector<T> torque, load, limit;         ///< [dof]
  std::vector<std::uint8_t> unknown;          ///< [dof]
  std::vector<ExternalForce<T>> impulses;     ///< N·s, waiting for the next step

  TreeProblem<T> problem;
  std::vector<std::unique_ptr<Effect<T>>> effects;  ///< declared for this tree, in the plan or not
  Kinematics<T> guessed;  ///< at the guess a solve starts from, where continuous detection asks for it
  History<T> history;
  Motion<T> motion;
  std::vector<Collider> colliders;    ///< the skeleton's, each on a simulated joint
  std::vector<Vec3<T>> bound_center;  ///< [collider] bounding sphere, body axes
  std::vector<T> bound_radius;
  std::vector<ContactPoint<T>> points;
  std::vector<int> first_point;         ///< [collider + 1] into points
  std::vector<std::uint8_t> may_touch;  ///< [collider, collider] self collision is possible
  T radius = T(1);                      ///< m, from the root's origin to the furthest collider at rest
  std::vector<Transform<T>> wanted;     ///< [body] what the animation wants at the end of the present part
  std::uint64_t contact_signature = 0;  ///< of the contacts that touched after the last step
  std::uint64_t limit_signature = 0;    ///< of the joint limits that bore
  int steps_unchanged = 0;
  double energy_ceiling =
      std::numeric_limits<double>::infinity();  ///< J, see EnergyLedger; infinite: unknown
  CharacterReport report;

  CharacterState(const Skeleton& s, const CharacterSettings& c);

  /// N/m of one contact point: the weight of the heaviest that it may have to bear (kg, of those near, at
  /// most a hundred times its own) sinks it by the accuracy's depth.
  T contact_stiffness(const WorldSettings& world, T heaviest) const {
    const double bears = std::clamp(double(heaviest), total_mass, 100 * total_mass);
    return T(bears * std::max(1.0, world.gravity.norm()) / world.accuracy.sink_depth);
  }
  /// What a limit (N·m) of one of the skeleton's muscles is at its strength, its joint's and the character's.
  T muscle_limit(int muscle, double limit_at_rest) const;
  /// Muscle limits of this moment: strengths and the root's drive applied.
  void refresh_limits();
  /// Velocity (m/s, world) of a body's material point, given from the common origin of `problem.kinematics`.
  Vec3<T> point_velocity(int body, const Vec3<T>& point) const {
    const Mat3<T> spin = history.rotation_rate[body] * history.rotation[body].transpose();
    return history.velocity[body] + spin * (point - problem.kinematics.center[body]);
  }
  /// Energies and momenta of the history into the report.
  void report_totals(const Vec3<double>& gravity);
  /// Model transforms of all joints from the local ones.
  void update_model();
  /// Joint `i` at `pose` (world where parentless) as the solve has it: a floating root's place is relative to
  /// the common origin, so that nothing of it is lost.
  Transform<T> in_solve(int i, const Transform<T>& pose, const Vec3<double>& common_origin) const {
    if (i > 0 || !floats) return pose;
    return {pose.rotation, (pose.translation.template cast<double>() - common_origin).template cast<T>()};
  }
  /// Puts everything on the present target, with its velocity.
  void reset_to_target(const Vec3<T>& gravity);
  bool undisturbed() const;
  /// Something holds every joint: without that there is nothing to play.
  bool fully_driven() const;
  /// The simulated joint that carries `joint`, itself or an ancestor.
  int body_of(int joint) const;
  void choose_self_pairs();
  bool root_is_kinematic() const { return settings.root == RootDrive::kKinematic && !is_prop; }
};

extern template struct CharacterState<float>;
extern template struct CharacterState<double>;

}  // namespace sinew
