// What one character (or prop) carries from step to step. Internal to the character layer.
#pragma once

#include <algorithm>
#include <array>
#include <limits>
#include <memory>
#include <utility>
#include <vector>

#include "sinew/character/world.h"
#include "sinew/effects/check_pass.h"
#include "sinew/effects/contact.h"
#include "sinew/effects/support.h"
#include "sinew/optimizer/problem.h"

namespace sinew {

/// Motion of one joint relative to the animation; zero while it is on it.
template <class T>
struct Deviation {
  std::array<T, 6> offset{};  ///< see joint_offset, from the animation
  std::array<T, 6> rate{};    ///< 1/s
  bool on_animation = true;   ///< exactly where the clip wants it
  bool released = false;      ///< was an unknown in the last step
  bool on_path = false;       ///< went along the return in the last step: `rate` is that path's
};

/// The rate of a deviation, whose turn is that of a rotation vector, with the child's angular velocity about
/// its own axes instead; and back. They are the same near the animation.
template <class T>
std::array<T, 6> spin_of_rate(JointType type, const std::array<T, 6>& offset, std::array<T, 6> rate);
template <class T>
std::array<T, 6> rate_of_spin(JointType type, const std::array<T, 6>& offset, std::array<T, 6> spin);

/// What a played step leaves undone until somebody asks: mostly nobody does. See keep_record(),
/// synchronise().
template <class T>
struct Deferred {
  bool loads = false;    ///< `load` and `limit`, of `torque` and the muscles' present strength
  bool rates = false;    ///< `rate`
  bool history = false;  ///< all of it but `place` and velocity[0]
  bool motion = false;   ///< nor has anybody measured how the bodies move: played without a check
  bool totals = false;   ///< the report's energies and momenta
  /// Deviations, by a step in which it only fell: nobody asks until something holds it again. They are those
  /// of a joint on the animation meanwhile.
  bool deviations = false;
  T h = T(0);  ///< s, of the step
  Vec3<double> gravity = Vec3<double>::Zero();
};

/// See level_of_detail.h.
struct LevelState {
  Level level = Level::kChecked;  ///< as reported
  Level cap = Level::kSubsteps;   ///< of the budget
  bool asleep = false;
  float unneeded = 0;            ///< s since a level as high was needed
  Level lower = Level::kAsleep;  ///< the highest that was needed since
  float lower_unneeded = 0;      ///< s since that was needed
  float cap_age = 1e6f;          ///< s since the cap changed
  float still = 0;               ///< s at rest
  float cost = 0;                ///< smoothed, as Budget::limit
  float spared = 0;              ///< that the cap saves, as `cost`
  std::int32_t nap = -1;         ///< who sleeps with it: all with the same number
  std::uint32_t steps = 0;       ///< staggered from one character to the next
  // Of the present step
  Level allowed = Level::kSubsteps, did = Level::kChecked;
  bool wake = false;           ///< the host changed something
  double spent = 0, work = 0;  ///< as Budget::limit; units of work
};

/// Of a grounded character, and of one with a tone: see grounding.h.
template <class T>
struct Grounding {
  Displacement by;                           ///< of the targets that the host gives
  T rest = T(0);                             ///< s that it has stood as its animation wants it
  T alone = T(0);                            ///< s that nothing but the ground has acted on a toned body
  double help_force = -1, help_torque = -1;  ///< N and N·m instead of the settings', where not negative
  RootWrench<T> hand;  ///< in this step: what no floor could give to what its animation does
  /// m, of what its animation last stood on, but for `by`.
  double level = std::numeric_limits<double>::max();
  /// m, that its target may lie in things in this step: Character::keep_out().
  double presses = std::numeric_limits<double>::max();
  bool by_hand = false;     ///< whether that is left to an invisible hand
  bool leads = false;       ///< its root is borne where the animation has it, in this step
  bool comes_back = false;  ///< Character::come_back() in this step
  bool has_hand = false;    ///< Character::give_hand() in this step
  bool rides = false;       ///< Character::ride() in this step
  bool returns = false;     ///< next to its animation, where it may be played if ground and muscles can do it
};

/// What all characters of one skeleton share.
template <class T>
struct Rig {
  Skeleton skeleton;
  Tree<T> tree;
  double total_mass = 0;              ///< kg
  std::vector<Collider> colliders;    ///< the skeleton's, each on a simulated joint
  std::vector<Vec3<T>> bound_center;  ///< [collider] bounding sphere, body axes
  std::vector<T> bound_radius;
  std::vector<T> body_reach;  ///< [body] m, from its joint to the furthest of its colliders; 0: it has none
  std::vector<ContactPoint<T>> points;
  std::vector<int> first_point;         ///< [collider + 1] into points
  SupportPoints<T> support;             ///< those that may stand on the ground
  std::vector<std::uint8_t> may_touch;  ///< [collider, collider] self collision is possible
  std::vector<std::uint8_t> bakes;      ///< [body] hand, foot or toes: see CharacterDetail::bake
  T radius;  ///< m, from the root's origin as far as a collider reaches, however its joints are turned

  Rig(const Skeleton& skeleton, const StepPlan<T>& plan);

 private:
  void measure_reach(const Kinematics<T>& rest);
  void choose_self_pairs(const Kinematics<T>& rest, const ContactTerm<T>& contacts);
  void choose_baked();
};

constexpr double kLimbSpeed = 6;  ///< m/s of a human against the root, where nobody has measured it

template <class T>
struct CharacterState {
  std::shared_ptr<const Rig<T>> rig;
  const Skeleton& skeleton;  ///< these are the rig's
  const Tree<T>& tree;
  const double total_mass;  ///< kg
  const std::vector<Collider>& colliders;
  const std::vector<Vec3<T>>& bound_center;
  const std::vector<T>& bound_radius;
  const std::vector<ContactPoint<T>>& points;
  const std::vector<int>& first_point;
  const std::vector<std::uint8_t>& may_touch;
  T radius;  ///< m, from `middle` to the furthest collider; characters and props: the rig's
  Vec3<T> particles_middle = Vec3<T>::Zero();

  CharacterSettings settings;
  Grounding<T> grounding;
  SelfCollision self_collision = SelfCollision::kAsCreated;
  bool is_prop = false;       ///< or a body of particles: nothing animates it
  bool is_particles = false;  ///< every body but the fixed root is a particle
  CharacterDetail detail;
  LevelState levels;
  bool driven = false;    ///< something holds every joint: there is a clip to play (see refresh_limits)
  bool limited = false;   ///< some joint's muscles are neither dead nor boundless (see refresh_limits)
  bool tied = false;      ///< in this step, by a coupling: it has to be solved
  bool parked = false;    ///< out of the world
  bool crowded = false;   ///< near one whom it was not solved together with: the island was full
  bool carried = false;   ///< in this step, see carry_over()
  bool calm = true;       ///< no joint deviates: see clear_deviations
  bool acted_on = false;  ///< pushes or effects ask muscles with a tone for more: see begin_tone()
  bool left_to_gravity = false;  ///< in the last part of a step: nothing else from outside acted on it
  bool floats = false;           ///< hangs on one free root, whose translation is `history.place` rounded

  std::vector<JointJet<T>> target;         ///< [joint] what the animation wants at the end of the next step
  std::vector<JointJet<T>> target_before;  ///< [joint] wanted last step; see last_target()
  bool target_stands = false;              ///< nobody has set another since: `target_before` is out of date
  std::vector<Transform<T>> local;         ///< [joint]
  std::vector<Transform<T>> model_pose;    ///< [joint] see model()
  bool model_deferred = false;
  std::vector<Transform<T>> played_from;           ///< [joint] `local` before the last played step
  Deferred<T> deferred;                            ///< by that step
  std::vector<std::array<T, 6>> rate;              ///< [body] joint speed over the last step, as joint_offset
  std::vector<std::array<T, 6>> rate_before;       ///< [body] over the step before
  T rate_step = T(0);                              ///< s, that `rate` was measured over; 0: unknown
  T rate_step_before = T(0);                       ///< s, the same of `rate_before`
  std::vector<Deviation<T>> deviation;             ///< [body]
  std::vector<T> joint_strength;                   ///< [body]
  std::vector<T> muscle_strength;                  ///< [muscle of the skeleton]
  std::vector<T> activation;                       ///< [body] see Character::set_activation
  std::vector<T> torque, load, limit;              ///< [dof]
  std::vector<T> smooth, lasting, lasting_before;  ///< [dof] of limits and springs: see Contact
  std::vector<std::uint8_t> unknown;               ///< [dof]
  std::vector<ExternalForce<T>> forces;            ///< N, over the next step
  std::vector<ExternalForce<T>> impulses;          ///< N·s, waiting for the next step

  TreeProblem<T> problem;
  std::vector<std::unique_ptr<Effect<T>>> effects;  ///< declared for this tree, in the plan or not
  Kinematics<T> guessed;                            ///< room, see IslandTree; and for snapshots
  History<T> history;
  Motion<T> motion;
  std::vector<std::uint8_t> baked;      ///< [body] goes on by itself in this step
  int unbaked = 0;                      ///< of these, in this step: had to be solved for after all
  std::vector<Transform<T>> wanted;     ///< [body] what the animation wants at the end of the present part
  std::uint64_t contact_signature = 0;  ///< of the contacts that touched after the last step
  std::uint64_t limit_signature = 0;    ///< of the joint limits that bore
  int steps_unchanged = 0;
  std::uint8_t collision_suspended =
      0;                      ///< steps in which what it is caught in lets it pass: see IslandStepper::freeze
  std::uint8_t unsolved = 0;  ///< steps in a row whose solves did not converge, as far as kMostUnsolved
  double energy_ceiling =
      std::numeric_limits<double>::infinity();  ///< J, see EnergyBalance; infinite: unknown
  double depenetration_energy =
      0;  ///< J, by surfaces that lead it out of them, and stored in contacts still: not its own
  CharacterReport report;

  CharacterState(std::shared_ptr<const Rig<T>> of, const CharacterSettings& c, const StepPlan<T>& plan);

  /// N/m of one contact point: the weight of the heaviest that it may have to bear (kg, of those near, at
  /// most a hundred times its own) sinks it by the accuracy's depth.
  T contact_stiffness(const WorldSettings& world, T heaviest) const {
    const double bears = std::clamp(double(heaviest), total_mass, 100 * total_mass);
    return T(bears * std::max(1.0, world.gravity.norm()) /
             (world.accuracy.sink_depth * double(tree.scale.length)));
  }
  /// What the muscles of a body's joint are given now of what they were made with, without those of its own.
  T strength_of(int body) const {
    const T own = joint_strength[body] * activation[body];
    return own > T(0) ? T(settings.strength) * own : T(0);  // what is dead stays dead in who only plays
  }
  /// Whether its limbs collide with each other.
  bool has_self_collision() const {
    return self_collision == SelfCollision::kAsCreated ? settings.self_collision
                                                       : self_collision == SelfCollision::kOn;
  }
  /// What a limit (N·m) of one of the skeleton's muscles is at its strength, its joint's and the character's.
  T muscle_limit(int muscle, double limit_at_rest) const;
  /// By which that of a grounded root is multiplied.
  T root_strength() const { return activation[0] > T(0) ? T(settings.strength) * activation[0] : T(0); }
  /// N or N·m that may hold a grounded root besides the ground.
  double help_at_most(bool force) const;
  /// Muscle limits of this moment: strengths and the root's drive applied.
  void refresh_limits();
  /// Velocity (m/s, world) of a body's material point, given from the common origin of `problem.kinematics`.
  Vec3<T> point_velocity(int body, const Vec3<T>& point) const {
    const Mat3<T> spin = history.rotation_rate[body] * history.rotation[body].transpose();
    return history.velocity[body] + spin * (point - problem.kinematics.center[body]);
  }
  /// The speed of a free root from the history into `rate`: after the history was changed.
  void read_root_rate();
  /// Energies and momenta of the history into the report.
  void report_totals(const Vec3<double>& gravity);
  void report_totals(const Totals& sum);
  /// Those of the animation where the last step owes them.
  void compute_totals();
  /// What is deferred of the muscles; before their strength changes.
  void keep_loads();
  /// The same and of the joint speeds, and the history where the step was checked: to the bit what keeping
  /// them in every step would have left.
  void keep_record();
  /// Joint → world, of all joints: worked out when it is first asked for after the local ones changed.
  const std::vector<Transform<T>>& model() {
    if (model_deferred) update_model();
    return model_pose;
  }
  /// After `local` changed.
  void pose_changed();
  /// What the animation wanted last step.
  const std::vector<JointJet<T>>& last_target() const { return target_stands ? target : target_before; }
  /// The same, to be changed.
  std::vector<JointJet<T>>& own_last_target() {
    if (target_stands) target_before = target;
    target_stands = false;
    return target_before;
  }
  /// Room for another target, every joint of which has to be written.
  std::vector<JointJet<T>>& new_target() {
    if (target_stands) target.swap(target_before);
    target_stands = false;
    return target;
  }
  /// Joint `i` at `pose` (world where parentless) as the solve has it: a floating root's place is relative to
  /// the common origin, so that nothing of it is lost.
  Transform<T> in_solve(int i, const Transform<T>& pose, const Vec3<double>& common_origin) const {
    if (i > 0 || !floats) return pose;
    return {pose.rotation, (pose.translation.template cast<double>() - common_origin).template cast<T>()};
  }
  /// Puts everything on the present target, with its velocity.
  void reset_to_target(const Vec3<T>& gravity);
  /// Nothing touches, and the speed before the last step's is not known.
  void forget_contacts();
  /// Something has done work on it: what it may have is not known.
  void forget_energy() {
    energy_ceiling = std::numeric_limits<double>::infinity();
    depenetration_energy = 0;
  }
  /// After a step of h seconds: how far a joint is off what the animation wants (`measured`, a
  /// joint_offset), and how fast that changes; on the animation where both are next to nothing. `return_time`
  /// of a human's return, s.
  void update_deviation(int body, const std::array<T, 6>& measured, T h, T return_time);
  /// Before a step of h seconds, with its target set: the deviations that are deferred, where the step asks
  /// for them. Their rates are those with which the joints leave what the animation does in the step.
  void keep_deviations(T h);
  /// Where `radius` is measured from: the root's origin, or the middle of a body of particles.
  Vec3<double> middle() const {
    return is_particles ? Vec3<double>(particles_middle.template cast<double>()) : history.place;
  }
  /// m/s: of the root, or of the fastest particle.
  T pace() const;
  /// Every joint is on the animation, and none is released.
  bool undisturbed() const { return calm && !deferred.deviations && !is_prop; }
  /// After deviations changed: sums them up for undisturbed(), which is asked in every step.
  void clear_deviations();
  /// Every degree of freedom of a joint has a muscle, in both directions.
  bool joint_is_driven(int body) const;
  /// It has muscles, and they do not bear whatever comes.
  bool joint_is_limited(int body) const;
  /// It has muscles in every direction, and some give way below their limit.
  bool joint_has_tone(int body) const;
  /// Whether it is an unknown wherever something is: it has nothing that drives it, has been released, or is
  /// off its animation and has a tone.
  bool joint_gives_way(int body) const {
    return !joint_is_driven(body) || deviation[body].released ||
           (!deviation[body].on_animation && joint_has_tone(body));
  }
  /// Stiffnesses of all muscles below a joint, or of one degree of freedom of it alone (then
  /// JointLaw::refresh_presence() is left to the caller).
  void set_tone(int joint, Tone tone);
  void set_tone(int joint, int dof, Tone tone);
  /// Speed of the fastest body, m/s.
  T fastest() const;
  /// The host pushes it in the coming step.
  bool pushed() const { return !impulses.empty() || !forces.empty(); }
  /// No joint has a muscle, nothing drives the root.
  bool passive() const;
  /// Whether the impulses of the coming step change velocities at its beginning: no muscle is quick enough to
  /// do anything about them, while over a step it would bear what it can stop in one. What moves nothing by
  /// more than a millimetre until its muscles have brought it back (τ/e of its speed) is left to them.
  bool is_struck(T return_time) const;
  /// Nor is any joint put anywhere but by the solve: where the return to the animation leads is not asked.
  bool only_falls() const {
    return passive() && levels.allowed >= Level::kPartial &&
           std::min(detail.most, levels.cap) > Level::kPartial && !detail.bake;
  }
  /// The simulated joint that carries `joint`, itself or an ancestor.
  int body_of(int joint) const;
  void update_model();
  void bound_particles();
  /// Whether the two touch each other as far as their layers are concerned.
  bool may_meet(const CharacterState& other) const {
    return (settings.meets & other.settings.layers) != 0 && (other.settings.meets & settings.layers) != 0;
  }
  bool grounded() const { return settings.root == RootDrive::kGrounded && !is_prop; }
  /// Whether it has only the ground, and the help that the settings tell.
  bool may_have_a_hand() const {
    return grounded() && floats && grounding.help_force < 0 && grounding.help_torque < 0;
  }
  /// See Grounding::leads. Limits are made anew where that changes.
  void set_leads(bool leads) {
    if (std::exchange(grounding.leads, leads) != leads) refresh_limits();
  }
  bool root_is_kinematic() const { return settings.root == RootDrive::kKinematic && !is_prop; }
  /// Has no joints but a free root, which is driven, as a platform: it carries what is on it, and gives way
  /// to nobody.
  bool is_carrier() const {
    return floats && tree.dofs == tree.dof_count(0) && root_is_kinematic() && !tied && undisturbed();
  }
  /// And has limbs, that it could tear off: what has none, as a platform, presses whatever is in its way.
  bool drives_limbs() const { return root_is_kinematic() && tree.dofs > tree.dof_count(0); }
};

#define SINEW_RATE_INSTANCES(prefix, T)                                                          \
  prefix std::array<T, 6> spin_of_rate<T>(JointType, const std::array<T, 6>&, std::array<T, 6>); \
  prefix std::array<T, 6> rate_of_spin<T>(JointType, const std::array<T, 6>&, std::array<T, 6>);
SINEW_RATE_INSTANCES(extern template, float)
SINEW_RATE_INSTANCES(extern template, double)
extern template struct Rig<float>;
extern template struct Rig<double>;
extern template struct CharacterState<float>;
extern template struct CharacterState<double>;

}  // namespace sinew
