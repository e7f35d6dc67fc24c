// One frame of a scene: characters that follow their animation, props that collide with them, a floor.
//
//     World<float> world(settings);
//     int hero = world.add_character(asset.skeleton, {}, status);
//     …each frame:
//     SamplingJob<float>{&clip, time, jets}.Run();     // what the animation wants at the END of the frame
//     world.character(hero).set_target(jets);
//     world.step(1 / 60.f);
//     draw(world.character(hero).model());                // joint → world transforms
//
// Undisturbed characters cost a residual pass; the pose is then the clip's, bit for bit. Where the residual
// exceeds a muscle's limit, those joints are solved together with contacts and friction.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "sinew/animation/clip.h"
#include "sinew/character/body_ref.h"
#include "sinew/character/level_of_detail.h"
#include "sinew/effects/effect.h"
#include "sinew/effects/island_effect.h"
#include "sinew/effects/loop.h"
#include "sinew/effects/particles.h"
#include "sinew/effects/step_plan.h"
#include "sinew/muscle/tone.h"
#include "sinew/optimizer/accuracy.h"
#include "sinew/skeleton/parallel_for.h"
#include "sinew/skeleton/portable_math.h"
#include "sinew/skeleton/skeleton.h"

namespace sinew {

/// What holds a character's root joint.
enum class RootDrive : std::uint8_t {
  kKinematic,  ///< follows the animation whatever it takes
  kAssisted,   ///< follows it up to `root_force` and `root_torque`
  kFree,       ///< unactuated: only contacts hold it
  kGrounded,   ///< follows it as long as the ground can hold it so, with `help_force` and `help_torque` at
               ///< most, and with what the animation's accelerations ask of no floor that there could be
};

/// Whether a character's limbs meet each other.
enum class SelfCollision : std::uint8_t {
  kAsCreated,  ///< as CharacterSettings::self_collision says
  kOn,
  kOff,
};

/// Where a grounded character follows its animation: turned about the world's vertical, then moved.
struct Displacement {
  double x = 0;    ///< m, world
  double y = 0;    ///< m, world
  double yaw = 0;  ///< rad, about Z
  double z = 0;    ///< m, world: to ground of another height

  /// Whether it moves anything.
  bool any() const { return x != 0 || y != 0 || yaw != 0 || z != 0; }
  /// By yaw, about the world's vertical.
  Quat<double> turn() const { return {portable::cos(yaw / 2), 0, 0, portable::sin(yaw / 2)}; }
  /// The one that leads back: then() of the two is none.
  Displacement inverse() const {
    const Vec3<double> back = turn().conjugate() * Vec3<double>(-x, -y, 0);
    return {back.x(), back.y(), -yaw, -z};
  }
  /// This one, and after it another.
  Displacement then(const Displacement& next) const {
    const Vec3<double> to = next.turn() * Vec3<double>(x, y, 0);
    return {to.x() + next.x, to.y() + next.y, yaw + next.yaw, z + next.z};
  }
};

/// What bears a body from below, of all contacts that bear it by their share, and how it moves: still where
/// it is static. What is steeper than 60° is no ground, nor are limbs of others.
struct BearingGround {
  double force = 0;                              ///< N, up; 0: nothing bears it, and the rest is 0
  Vec3<double> place = Vec3<double>::Zero();     ///< m, world: where it is pressed
  Vec3<double> velocity = Vec3<double>::Zero();  ///< m/s, of what is there
  double turn_rate = 0;                          ///< rad/s, about the vertical
  Vec3<double> normal = Vec3<double>::Zero();    ///< world; of who was solved for, else 0
  double depth = 0;                              ///< m, that the body lies in it: as clips press; likewise

  /// Whether it does.
  bool moves() const { return turn_rate != 0 || !velocity.isZero(0); }
};

/// What World::add_character() is told of one character. Refused where strength, a limit of the root's or a
/// help is negative or NaN, where the tone is none, and where `detail` is refused.
struct CharacterSettings {
  RootDrive root = RootDrive::kKinematic;  ///< see Character::set_root_drive()
  double root_force = 2000;                ///< N, assisted
  double root_torque = 600;                ///< N·m, assisted
  /// N of a human, grounded: what an invisible hand may do where the ground can't. Scaled with the
  /// character's weight; what it did is in the report, with what blends ask of no floor.
  double help_force = 8;
  double help_torque = 8;       ///< N·m of a human, likewise; scaled with weight and size
  double strength = 1;          ///< scales every muscle; 0 = ragdoll, infinity = pure playback
  Tone tone = Tone::kRigid;     ///< how far all muscles give way below their limits, see set_tone()
  bool ground_contact = true;   ///< meets what is static: ground, obstacles, the host's shapes
  bool self_collision = false;  ///< between bodies that neither neighbour nor overlap at rest
  CharacterDetail detail;       ///< see Character::set_detail()
  std::uint32_t layers = 1;     ///< bits by which queries (queries.h) and `meets` choose
  /// Of characters, props and particles it touches those with one of these bits in their layers, that would
  /// touch it, too: either side is enough to pass through each other. What is static does not ask; see
  /// `ground_contact`. Single pairs: World::keep_apart().
  std::uint32_t meets = ~0u;
};

/// What the last step did with one character.
struct CharacterReport {
  Level level = Level::kChecked;  ///< see LevelOfDetail::dwell: what it needed lately, not only in this step
  int dofs = 0;                   ///< degrees of freedom of the character
  int unknown_dofs = 0;           ///< of these, handed to the optimizer; 0 = pure playback
  int baked = 0;                  ///< joints that CharacterDetail::bake left out of the (last) solve
  int unbaked = 0;           ///< that it had to solve for all the same: at a limit, or about to go far wrong
  int outer_passes = 0;      ///< of truncated Newton (optimizer/newton.h), over all parts of its whole island
  int factorisations = 0;    ///< of the inner problem's matrix, likewise
  int simplified_steps = 0;  ///< steps of simplified Newton, with the matrix of the pass before
  int corrections = 0;       ///< second-order corrections that saved a full step
  int plain_passes = 0;      ///< passes without the geometric terms, which made the matrix indefinite
  int contacts = 0;          ///< active contact points
  double contact_force = 0;  ///< N, along their normals, summed, at the end of the step
  int left_out = 0;      ///< of the candidates for contacts, those that there was no memory for: the furthest
  int substeps = 0;      ///< parts that the step was solved in; 0 = played
  int splits = 0;        ///< of these, halvings because a solve did not converge
  int restarts = 0;      ///< of the parts, solved again from where they began: the first result was too deep
  int damped = 0;        ///< of the parts, slowed because energy had come from nowhere (EnergyBalance)
  int frozen = 0;        ///< trees that were stopped where they stood: no pose could be found
  bool crowded = false;  ///< near one whom it was not solved together with: WorldSettings::island_dofs
  bool converged = true;  ///< every part of the step did, and nobody solved with it was frozen
  bool carried = false;  ///< the driven root's target leapt: put there as by reset(), limp joints swinging on
  double kinetic_energy = 0;                             ///< J
  double potential_energy = 0;                           ///< J, gravity
  double elastic_energy = 0;                             ///< J, stored in contacts and joint limits
  Vec3<double> momentum = Vec3<double>::Zero();          ///< kg·m/s
  Vec3<double> angular_momentum = Vec3<double>::Zero();  ///< kg·m²/s, about the centre of mass
  double penetration = 0;                                ///< m, deepest contact
  double help_force = 0;                                 ///< N that bore a grounded root besides the ground
  double help_torque = 0;                                ///< N·m, likewise
  BearingGround
      ground;  ///< at the end of the step; of who was only played, where it moves; not after restore()
  /// m, where Accuracy::estimate_error asks for it: how far this step alone, by its finite length, took the
  /// character from the exact motion (rms of all mass). 0 where the animation was played: that is exact.
  double estimated_error = 0;
};

/// One-body tree: a ball, a box, a rock.
struct PropSettings {
  Shape shape = Shape::kSphere;                     ///< solid, of uniform density
  Vec3<double> size = Vec3<double>::Constant(0.1);  ///< as Collider::size; of a hull nothing
  const ConvexHull* hull = nullptr;  ///< instead of a shape; not copied: it must outlive the world
  double mass = 1;                   ///< kg, > 0
  double friction = 0.6;             ///< as Collider::friction
  double restitution = 0;            ///< see Collider::restitution
  Transform<double> pose;            ///< shape → world
  Vec3<double> velocity = Vec3<double>::Zero();          ///< m/s, of the origin of its shape
  Vec3<double> angular_velocity = Vec3<double>::Zero();  ///< rad/s, world
  std::uint32_t layers = 1;                              ///< see CharacterSettings::layers
  std::uint32_t meets = ~0u;                             ///< see CharacterSettings::meets
};

/// What a world is made with; nothing changes it later.
struct WorldSettings {
  Accuracy accuracy;                  ///< of all solves, against their time
  LevelOfDetail detail;               ///< when characters go up and down, and the budget of a step
  Vec3<double> gravity{0, 0, -9.81};  ///< m/s², world
  double ground_height = 0;           ///< m, world
  bool ground = true;                 ///< a level floor at that height; needs Contacts to be declared
  double ground_friction = 1.0;       ///< multiplies the collider's
  double ground_restitution = 0;      ///< see Collider::restitution
  bool body_contact = true;           ///< characters and props meet each other
  bool ground_support = true;         ///< the floor bears what a driven root would (see effects/support.h)
  int workers = 1;      ///< threads that a step may use, through its ParallelFor; each has its own memory
  bool batches = true;  ///< characters of one rig that nothing is near are solved several at a time, one per
                        ///< SIMD lane: faster, the same bits (float only)
  std::size_t memory_cap = 0;  ///< bytes (see WorldMemory); who would exceed it is not added. 0: none
  int island_dofs = 4096;  ///< degrees of freedom that are solved together at most; beyond, neighbours pass
                           ///< through each other. Limits the memory
};

/// Bytes that a world has from the heap, without what the allocator adds.
struct WorldMemory {
  std::size_t rigs = 0;        ///< shared by all characters of a skeleton
  std::size_t characters = 0;  ///< and props
  std::size_t solving = 0;  ///< of the workers: the first can solve the largest island, the others small ones

  /// What WorldSettings::memory_cap limits.
  std::size_t total() const { return rigs + characters + solving; }
};

/// Where a byte of a snapshot belongs.
struct SnapshotField {
  int state = -1;         ///< character or prop, in the order in which they were added; -1: the world
  const char* name = "";  ///< "" where there is no such byte
};

class StaticShape;
template <class T>
struct WorldInternals;

template <class T>
struct CharacterState;  // residual, history and solver state; world.cpp
template <class T>
class Character;
/// For the library's own: what a handle stands for, or null.
template <class T>
CharacterState<T>* state_of(const Character<T>& character);

/// Handle on one character of a world; cheap to copy, valid while the world lives. That of an index which
/// names nobody is null: what changes something answers kInvalidArgument, what reads gives zeros, identities
/// and empty spans.
template <class T>
class Character {
 public:
  /// World::character() makes them; null stands for nobody.
  explicit Character(CharacterState<T>* state) : state_(state) {}
  /// Whether it stands for a character.
  bool valid() const { return state_ != nullptr; }

  /// What the animation wants at the end of the next step: local jets of all joints of the skeleton (see
  /// SamplingJob). NaN is refused and leaves the old target in place.
  Status set_target(std::span<const JointJet<T>> jets);
  /// Puts the character on the present target at once, with the target's velocity; forgets its history.
  Status reset();
  /// Strength of all muscles, ≥ 0: 0 is limp, infinity never yields. The joints' and the muscles' own
  /// multiply it.
  Status set_strength(T strength);
  /// That of all muscles, as it was set last.
  T strength() const;
  /// Strength of a joint's muscles and of all below it, ≥ 0; that of all muscles multiplies it. Refuses what
  /// is no simulated joint.
  Status set_strength(int joint, T strength);
  /// How much of their strength muscles are given at the moment, [joint of the skeleton] 0 to 1: multiplies
  /// all strengths. For what moves a body beside the host, as behaviours do; strengths are the host's.
  Status set_activation(std::span<const T> activation);
  /// The same of all joints alike.
  Status set_activation(T activation);
  /// Whether limbs meet each other from now on. For what moves a body beside the host, too: behaviours ask
  /// for it of who fell, and not of who gets up. Refuses what is none of the values.
  Status set_self_collision(SelfCollision collision);
  /// Strength of one of Skeleton::muscles, ≥ 0; the character's and the joint's multiply it.
  Status set_muscle_strength(int muscle, T strength);
  /// The same of all muscles of a group (Muscle::group); refuses one that no muscle has.
  Status set_group_strength(const char* group, T strength);
  /// Tone of all muscles: how stiffly they stay with the animation below their limits (muscle/tone.h). Rigid
  /// ones (the default) cost nothing; the others are solved for while something moves them, and play the
  /// animation to the bit while nothing does. The first that is not rigid allocates.
  Status set_tone(Tone tone);
  /// Of a joint and all below it. Refuses what is no simulated joint.
  Status set_tone(int joint, Tone tone);
  /// Of one joint alone, all of its degrees of freedom; stiffness > 0 (N·m/rad, infinite: rigid), damping
  /// ratio ≥ 0.
  Status set_tone(int joint, const Stiffness& stiffness);
  /// Of the degrees of freedom that a group of Skeleton::muscles works on.
  Status set_group_tone(const char* group, Tone tone);
  /// What was asked for of a degree of freedom (see first_dof); rigid where there is none such.
  Stiffness tone(int dof) const;
  /// What one of Skeleton::muscles gives of its joint's torque(), N·m: see Muscle. 0 where there is none
  /// such.
  T muscle_torque(int muscle) const;
  /// What holds the root from the next step on; wakes who sleeps.
  Status set_root_drive(RootDrive drive);
  /// Where a grounded character follows its animation since something moved it: what a host adds to its own
  /// place of the character, if it wants to. Targets are given as if nothing had happened; reset() forgets
  /// it.
  Displacement displacement() const;
  /// The host has moved the character's place itself: targets are given there from now on.
  Status take_displacement();
  /// Puts its animation elsewhere: targets given from now on are turned and moved once more by that, in the
  /// world. For who stands there already, within millimetres, as after a step; the rest returns over time.
  Status displace(const Displacement& further);
  /// The same where its last target was there already: of who has been led there.
  Status displace_led(const Displacement& further);
  /// The same before a step, of an animation that goes there in it, as taken along by what it stands on: the
  /// next target is given with the root's speed of that way, and the body is where it is wanted.
  Status ride(const Displacement& further);
  /// A grounded root that moves nearly as its animation wants it (6 cm, 6°, 0.12 m/s or a tenth of the
  /// animation's speed, and 0.6 rad/s of a human) is led back onto it from the end of the next step on, from
  /// where it is and as fast as it is: who walks does not come to rest. What the ground can't give then is
  /// help that nobody meters.
  Status come_back();
  /// In the next step a grounded root that is free may be given, besides its help, as much as its target asks
  /// of no floor at all: a run is at fault itself where it pushes off before its feet are down, and who was
  /// pushed while he runs would fall from that. Metered as help.
  Status give_hand();
  /// Its target of the next step is somebody's plan, who knows what is around: of that it may lie `most` m
  /// in things, where of a clip 3 cm of a human may in what stands, and 1 cm in what moves.
  Status keep_out(double most);
  /// What may hold a grounded root besides the ground from now on, N and N·m; negative: as in its settings.
  Status set_help(double force, double torque);
  /// How much work it may get from the next step on. Refuses what validate() does; `detail` stays then.
  Status set_detail(const CharacterDetail& detail);
  /// As it was set last.
  const CharacterDetail& detail() const;
  /// A hit: impulse (N·s, world) at a world point on the body of a joint, at the beginning of the next step,
  /// whatever muscles hold it; they bring it back. One that moves nothing by a millimetre is left to them.
  Status apply_impulse(int joint, const Vec3<T>& point, const Vec3<T>& impulse);
  /// A load: force (N, world) at a world point on the body of a joint, during the next step. Muscles bear it
  /// as far as they can. What pushes for longer is applied in every step.
  Status apply_force(int joint, const Vec3<T>& point, const Vec3<T>& force);
  /// The world's own copy, which all characters with an equal one share.
  const Skeleton& skeleton() const;
  std::span<const Transform<T>> local() const;  ///< [joint] joint → parent
  std::span<const Transform<T>> model() const;  ///< [joint] joint → world
  /// The root's origin, world, m: local() and model() hold it rounded to T, the simulation does not.
  Vec3<double> position() const;
  /// [DOF] that the animation (or the muscle) exerts, N·m (N for translations).
  std::span<const T> torque() const;
  // model(), and of a character that was only played load(), limit() and the report's totals, are worked out
  // when they are first asked for after the step: not by two threads at once.
  std::span<const T> load() const;   ///< [DOF] |torque| / limit: 0 where it has no muscle (root);
                                     ///< 1 = saturated; one for all three of an ellipsoidal limit
  std::span<const T> limit() const;  ///< [DOF] N·m, of the direction in which it pulls now
  int first_dof(int joint) const;    ///< index into the spans above; −1 unless 0 ≤ joint < body_count
  std::span<const std::uint8_t> unknown() const;  ///< per DOF: 1 where the last step solved for it
  bool on_animation() const;                      ///< every joint is exactly where the clip wants it
  /// What the last step did with it.
  const CharacterReport& report() const;
  /// report().ground, for nothing: totals are not worked out for it.
  const BearingGround& ground() const;
  /// m: height of what a grounded character's animation last stood on, its lowest, without what it is
  /// displaced by. None until it has been played, or led, over ground that bears it.
  std::optional<double> animation_ground() const;

 private:
  friend CharacterState<T>* state_of<T>(const Character&);
  CharacterState<T>* state_;
};

/// Begins a world whose effects are declared one by one.
struct DeclareNothing {};

/// Names one effect that was added to a character or prop. Effects can be taken away, so it is counted over
/// all worlds of a program: one whose effect is gone, or is another world's, finds nothing.
struct EffectId {
  std::uint32_t slot = 0;    ///< where the world keeps it; used again when the effect is gone
  std::uint32_t serial = 0;  ///< 0: none

  /// Names the same effect.
  bool operator==(const EffectId&) const = default;
};

/// Characters, props, loops and particle bodies are named by their index, in the order in which they were
/// added, each kind by itself. They leave a world only with it (park_character() and park_prop() put them
/// aside), so an index never comes to mean another one. A wrong one, such as the −1 of what could not be
/// added, moves nothing: calls that change something answer kInvalidArgument with the index, those that read
/// give zeros, identities, an empty report or a null Character.
template <class T>
class World {
 public:
  /// With the standard effects declared: Muscles, JointLimits, JointDamping, Impulses, Support, Contacts, and
  /// Batches. A program that makes worlds so links them all.
  explicit World(const WorldSettings& settings);
  /// With nothing but inertia and gravity: declare() the rest. What no world of a program declares, it does
  /// not link.
  World(const WorldSettings& settings, DeclareNothing nothing);
  ~World();
  World(const World&) = delete;
  World& operator=(const World&) = delete;

  /// Set-up: allocates everything that stepping needs. Returns an index, or -1 with `status` set. The
  /// skeleton is copied. The character stands at its rest pose until a target is set and reset() called.
  int add_character(const Skeleton& skeleton, const CharacterSettings& settings, Status& status);
  /// Likewise, of a prop, which stands and moves as its settings say. Refuses what makes no valid body
  /// (skeleton.h, validate()) and velocities that are not finite.
  int add_prop(const PropSettings& settings, Status& status);
  /// Static, world space (`joint` unused). `layers`: see CharacterSettings.
  Status add_obstacle(const Collider& obstacle, std::uint32_t layers = 1);
  /// A height field, a convex solid, or the host's collision world. Not copied: it must outlive this world.
  Status add_obstacle(const StaticShape& shape, double friction = 0.8, double restitution = 0,
                      std::uint32_t layers = 1);

  /// Whether two of the characters, props and particle bodies (`joint` does not count) pass through each
  /// other, whatever their layers say: a rider and his horse, who throws and what he throws. Allocates; wakes
  /// both. No part of snapshots. O(pairs) here and for every pair that comes close, so for a few.
  Status keep_apart(const BodyRef& a, const BodyRef& b, bool apart = true);

  /// Ties two frames together; returns the loop's index, or -1. What is open closes at a walking pace.
  int add_loop(const LoopSettings& settings, Status& status);
  /// Opens a loop (it costs nothing then), or closes it again.
  Status set_loop(int index, bool closed);
  double loop_gap(int index) const;     ///< m, largest of its points, of what was open at first the rest
  Vec3<T> loop_force(int index) const;  ///< N, on side a, world axes
  /// A strand, cloth or soft tissue; returns its index, or -1. It starts at rest where its frame is now.
  int add_particles(const ParticleBody& body, Status& status);
  /// Puts a particle body back to rest in its frame (after a teleport), with its nodes at the given velocity.
  Status reset_particles(int index, const Vec3<T>& velocity = Vec3<T>::Zero());
  Vec3<T> particle(int index, int node) const;           ///< world, m
  Vec3<T> particle_velocity(int index, int node) const;  ///< m/s; of fixed nodes 0
  /// What the last step did with a particle body.
  const CharacterReport& particle_report(int index) const;
  int particles_count() const;  ///< particle bodies

  /// A handle; null where the index names nobody.
  Character<T> character(int index);
  int character_count() const;              ///< parked ones included
  int prop_count() const;                   ///< parked ones included
  Transform<T> prop_pose(int index) const;  ///< shape → world
  Vec3<T> prop_velocity(int index) const;   ///< m/s, world, of its centre
  /// Puts a prop there, moving so (m/s and rad/s, world); brings a parked one back.
  Status set_prop(int index, const Transform<T>& pose, const Vec3<T>& velocity,
                  const Vec3<T>& angular_velocity);
  /// Set-up: lets an effect act on a character or a prop; each needs its own. Refused with what the effect
  /// says about its settings. The address stays good while the world lives and the effect is not taken away;
  /// `id`, where asked for, tells whether it was.
  Status add_effect(int character, std::unique_ptr<Effect<T>> effect, EffectId* id = nullptr);
  /// The same for a prop.
  Status add_prop_effect(int prop, std::unique_ptr<Effect<T>> effect, EffectId* id = nullptr);
  /// Null where the effect was taken away, or never was this world's.
  Effect<T>* effect(EffectId id) const;
  /// Takes one effect away and destroys it; its owner wakes. Refuses what effect() does not find.
  Status remove_effect(EffectId id);
  /// All of a character's.
  Status remove_effects(int character);
  /// Set-up: an effect that acts on everybody, by its type: declare<Restitution>(),
  /// declare<ContinuousDetection>(); in a world that begins with nothing, declare<Muscles>() and the other
  /// standard ones, each before the first character is added. Again changes nothing.
  template <template <class> class E>
  Status declare() {
    if constexpr (requires(StepPlan<T> & plan) { E<T>::declare(plan); })
      return declare(&E<T>::declare);
    else
      return declare([]() -> std::unique_ptr<IslandEffect<T>> { return std::make_unique<E<T>>(); });
  }
  /// What declare<E>() calls for an effect on islands (effects/island_effect.h). Refused with kOutOfRange
  /// where memory_cap leaves no room.
  Status declare(MakeIslandEffect<T> make);
  /// What declare<E>() calls for a term of every solve (effects/step_plan.h). Refused once there is a
  /// character, prop or particle body.
  Status declare(DeclareTerm<T> term);

  /// Takes a prop out of the world, where it costs nothing and touches nobody, until set_prop.
  Status park_prop(int index);
  /// What the last step did with a prop.
  const CharacterReport& prop_report(int index) const;
  /// Takes a character out of the world, where it costs nothing and touches nobody, until it is brought back:
  /// onto its target then, as by reset().
  Status park_character(int index);
  /// Brings a character back, onto its target; its displacement() stays. One that was not parked is put there
  /// all the same.
  Status unpark_character(int index);
  bool parked(int index) const;  ///< of characters

  /// Advances by h seconds (1e-5 ≤ h ≤ 0.25; below, differences of float positions are no velocities).
  /// Allocates nothing, throws nothing, takes no lock. On an error nothing has moved. The result has the same
  /// bits for any number of workers and threads.
  Status step(T h, const ParallelFor& parallel_for = {});

  /// Of the last step.
  const WorldReport& report() const;
  /// Counted anew at each call. O(characters + props + particle bodies).
  WorldMemory memory() const;

  // Snapshots: everything that the next step depends on, as flat bytes (0.7 kB of a humanoid of 37 DOF that
  // plays, below 2 kB of any other); saving and restoring take 10 to 25 µs of one and allocate nothing. A
  // world set up the same way, restored and given the same inputs, goes on to the bit. Targets and impulses
  // are inputs and not part of it: set them after restoring. torque(), limit(), unknown() and report() follow
  // with the next step. recording.h writes whole runs and replays them.

  /// Set-up: bytes of the game's own that belong to the state, such as the block of a character's graph
  /// (graph/graph_state.h). save() writes them too, restore() puts them back; they stay where they are.
  void keep_with_state(std::span<std::byte> bytes);
  /// Bytes that a snapshot takes at most.
  std::size_t snapshot_capacity() const;
  /// Bytes written, or 0 where `out` is too small.
  std::size_t save(std::span<std::byte> out) const;
  /// Refuses what save() of such a world did not write, with nothing moved.
  Status restore(std::span<const std::byte> snapshot);
  /// Bytes that save_inputs() takes at most.
  std::size_t inputs_capacity() const;
  /// The inputs that wait for the next step: targets, impulses and forces. Bytes written, or 0 where `out` is
  /// too small.
  std::size_t save_inputs(std::span<std::byte> out) const;
  /// Refuses what save_inputs() of such a world did not write, with nothing changed.
  Status restore_inputs(std::span<const std::byte> inputs);
  /// What a byte of the snapshot that save() would write now stands for.
  SnapshotField snapshot_field(std::size_t byte) const;

 private:
  friend struct WorldInternals<T>;  // contact_events.h, queries.h and debug_draw.h read it
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// @cond
template <class T>
CharacterState<T>* state_of(const Character<T>& character) {
  return character.state_;
}
/// @endcond

extern template class Character<float>;
extern template class Character<double>;
extern template class World<float>;
extern template class World<double>;

}  // namespace sinew
