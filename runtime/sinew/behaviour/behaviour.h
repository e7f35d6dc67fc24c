// A body that keeps its balance when it is pushed: it gives, steps, staggers or falls.
//
//     Behaviour<float> balance(asset.skeleton, {}, status);
//     …each frame:
//     sample(jets);                                  // what the game's animation wants at the frame's end
//     balance.update(world.character(hero), jets, dt);        // replaced where a behaviour acts
//     world.character(hero).set_target(jets);
//     world.step(dt);
//
// For a character whose root is RootDrive::kGrounded: as long as the ground can do what the animation asks of
// it, nothing happens here, at the cost of one question. When it can't, the body first does what physics
// makes of it for a reaction time; then a plan (balance_plan.h) moves the centre of mass over feet that press
// where it helps, and puts a foot where the capture point will be when pressing alone does not reach. A push
// that no step can catch is a fall: muscles let go, and `kDown` is told when the body lies still.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "sinew/animation/foot_lock.h"
#include "sinew/animation/inertialize_job.h"
#include "sinew/behaviour/balance_plan.h"
#include "sinew/behaviour/behaviour_settings.h"
#include "sinew/behaviour/get_up.h"
#include "sinew/behaviour/protective_reach.h"
#include "sinew/behaviour/stance.h"
#include "sinew/character/world.h"

namespace sinew {

/// What the body is doing about its balance.
enum class BehaviourState : std::uint8_t {
  kClip,     ///< the animation, and nothing else
  kPassive,  ///< pushed, and not reacting yet
  kBalance,  ///< feet stand, the body is brought back over them
  kStep,     ///< one foot is on its way, or the feet of a walk land where they catch it
  kFall,     ///< nothing is done any more
  kDown,     ///< lies still: it may get up, or the host decides how
  kGather,   ///< lies, and comes into the pose from which it rises
  kRise,     ///< gets up
};

/// What a host may want to hear of: sounds, scores, decisions.
enum class BehaviourEventKind : std::uint8_t {
  kFallen,    ///< it falls, or lies again after it tried to rise
  kRising,    ///< it has begun to get up
  kStanding,  ///< it stands
};

/// Why.
enum class BehaviourReason : std::uint8_t {
  kNone,         ///< there is nothing to explain
  kAsked,        ///< the host wanted it
  kBeyondReach,  ///< number: m that the capture point was beyond what steps reach
  kTilted,       ///< number: m, height of the root over the ground
  kNotGathered,  ///< number: m off the pose from which it was to rise
  kLeftItsClip,  ///< number: m off it
  kTookTooLong,  ///< number: s
};

/// One thing that happened in an update, see Behaviour::events().
struct BehaviourEvent {
  BehaviourEventKind kind = BehaviourEventKind::kFallen;  ///< what happened
  BehaviourReason reason = BehaviourReason::kNone;        ///< why
  double number = 0;                                      ///< see BehaviourReason
};

/// What it did, for whoever tells the player.
struct BehaviourReport {
  BehaviourState state = BehaviourState::kClip;  ///< now
  int steps = 0;                                 ///< since the push, without those that put a foot back
  double capture_depth = 0;  ///< m, of the capture point inside the standing soles; negative: outside
  double time = 0;           ///< s since the push; since it fell or stood up again
  double fell_beyond = 0;    ///< m that the capture point was beyond reach, where it fell
  int tries = 0;             ///< to get up, since it fell
};

/// A frame of reference that moves over the ground, world.
struct CarriedFrame {
  Vec3<double> place = Vec3<double>::Zero();     ///< m
  Vec3<double> velocity = Vec3<double>::Zero();  ///< m/s, there
  double turn_rate = 0;                          ///< rad/s, about the vertical

  /// Whether it does.
  bool moves() const { return turn_rate != 0 || velocity != Vec3<double>::Zero(); }
  /// m/s, at a point of it.
  Vec3<double> at(const Vec3<double>& point) const {
    return velocity + Vec3<double>(0, 0, turn_rate).cross(point - place);
  }
};

/// What the last step left of a body, world.
struct MeasuredBody {
  MassMotion mass;                        ///< of the whole body; its velocity over ground that moves
  Transform<double> root;                 ///< of the root joint
  std::array<Transform<double>, 2> foot;  ///< of the foot joints: left, right
  std::array<double, 2> lowest{};         ///< m, height of their soles' lowest points

  /// The same without what its animation is displaced by: in the frame in which targets are given.
  MeasuredBody without(const Displacement& displacement) const {
    const Displacement back = displacement.inverse();
    const Transform<double> home{back.turn(), {back.x, back.y, back.z}};
    return {{home * mass.place, home.rotation * mass.velocity},
            home * root,
            {home * foot[0], home * foot[1]},
            {lowest[0] + back.z, lowest[1] + back.z}};
  }
};

/// How far a body is with coming down that nothing has borne for a while.
enum class Landing : std::uint8_t {
  kNone,    ///< it stands, or walks
  kInAir,   ///< its plan is that of a body in the air
  kLands,   ///< its legs take up what it fell
  kLanded,  ///< they have: it has to plan anew where its feet stand
};

/// Of a foot in the air.
struct Footfall {
  Vec2 place = Vec2::Zero();  ///< m, where it lands
  double in = 0;              ///< s, until it does
};

/// What a behaviour asks of its character after a step.
struct LastStep {
  Vec3<double> momentum = Vec3<double>::Zero();  ///< kg·m/s
  BearingGround ground;                          ///< that bears it
  bool root_unknown = false;                     ///< its root was solved for
};

/// Keeps one character on its feet: each character needs its own.
template <class T>
class Behaviour {
 public:
  /// Set-up: finds legs, soles and masses. Errors name what is missing, roles of thigh, shin, foot and toes,
  /// or what is wrong in the settings.
  Behaviour(const Skeleton& skeleton, const BehaviourSettings& settings, Status& status);
  Behaviour(const Behaviour&) = delete;
  Behaviour& operator=(const Behaviour&) = delete;
  /// What was moved from is only destroyed or assigned to.
  Behaviour(Behaviour&&) noexcept = default;
  /// Likewise.
  Behaviour& operator=(Behaviour&&) noexcept = default;

  /// Set-up: the clips by which it gets up, of all clips of an asset those named get_up… and roll…, which
  /// must outlive this. Errors if there is none.
  Status use_get_ups(const Skeleton& skeleton, std::span<const Clip> clips);

  /// Before a step of h seconds, with what the animation wants at its end. Errors if the span has not one jet
  /// per joint. No allocation. O(1) while nothing disturbs, else O(joints).
  Status update(Character<T> character, std::span<JointJet<T>> jets, T h);
  /// Falls now, whatever the balance says.
  void knock_down(Character<T> character);
  /// Lets it get up as soon as it lies still (GetUpPolicy::kWhenAllowed). Errors if it never may, or has no
  /// clip to get up by.
  Status get_up();
  /// Whether it falls or lies, and does nothing about it yet.
  bool fallen() const {
    return report_.state == BehaviourState::kFall || report_.state == BehaviourState::kDown;
  }
  /// Whether it gathers its limbs or gets up.
  bool is_rising() const {
    return report_.state == BehaviourState::kGather || report_.state == BehaviourState::kRise;
  }
  /// After it was down, or to give a behaviour up: the animation again, muscles as strong as they were. Where
  /// it lies is the animation's to begin from.
  void stand(Character<T> character);

  /// What it does now.
  const BehaviourReport& report() const { return report_; }
  // A behaviour is saved beside its world, between steps, and restored beside it: together they go on to the
  // bit. What is set up (settings, clips to get up by) is not part of it.

  /// Bytes that save() writes.
  std::size_t saved_bytes();
  /// What it remembers, and what it is going to ask of its character. Bytes written, or 0 where `out` is too
  /// small. O(joints), no allocation.
  std::size_t save(const Character<T>& character, std::span<std::byte> out);
  /// Refuses what save() of such a behaviour did not write, with nothing changed.
  Status restore(std::span<const std::byte> saved);

  /// Of the last update.
  std::span<const BehaviourEvent> events() const { return {events_.data(), events_count_}; }
  /// By which it gets up.
  const GetUp<T>& getting_up() const { return get_up_; }
  BehaviourState state() const { return report_.state; }  ///< as in the report
  /// Of the body that was pushed, m and m/s.
  const Pendulum& plan() const { return plan_; }

 private:
  MeasuredBody measure(const Character<T>& character) const;
  void watch(Character<T>& character, std::span<const JointJet<T>> jets, T h);
  void see_clip(const Character<T>& character, std::span<const JointJet<T>> jets);
  void look_back(const Character<T>& character);
  double slip_over(const Vec3<double>& velocity) const;
  void see_ground(Character<T>& character, double h);
  void visit(ByteStream& stream);
  std::uint64_t check_of(std::span<const std::byte> bytes) const;
  void find_support();
  void find_only();
  void act(Character<T>& character, std::span<JointJet<T>> jets, T h);
  void ride(Character<T>& character, JointJet<T>& root, double h) const;
  bool clip_walks() const;
  bool is_pushed(const MeasuredBody& is, double h);
  void keep_balance(Character<T>& character, const MeasuredBody& is, bool reacts);
  void give_up(Character<T>& character);
  void begin_plan(const MeasuredBody& is, std::span<const JointJet<T>> jets);
  void choose_support(const MeasuredBody& is);
  bool can_join(int foot, const MeasuredBody& is) const;
  void begin_step(const MeasuredBody& is);
  void lift(int foot, const Transform<double>& from, const MeasuredBody& is);
  void help_trunk(Character<T>& character) const;
  void stop_walking(Character<T>& character, const MeasuredBody& is, std::span<const JointJet<T>> jets);
  void put_back(const MeasuredBody& is);
  int misplaced() const;
  Displacement to_feet() const;
  void end_step(const MeasuredBody& is, std::span<const JointJet<T>> jets);
  void see_flight(double h);
  bool flies() const;
  void fly(const MeasuredBody& is, std::span<const JointJet<T>> jets, double h);
  void write_flight(std::span<JointJet<T>> jets);
  Stance planned() const;
  void land(const MeasuredBody& is, std::span<const JointJet<T>> jets);
  void give_in(const MeasuredBody& is, const JointJet<T>& root);
  void move_plan(double h);
  void move_trunk(double h);
  void move_swing(double h);
  void write_stance(std::span<JointJet<T>> jets, double h);
  void move_height(const std::array<Vec3<double>, 2>& ankle, const Vec2& shift, double higher, double h);
  void see_ground_from(const Displacement& further);
  double rises_along(const Vec2& way) const;
  void begin_trunk(const MeasuredBody& is, const JointJet<T>& root);
  void begin_walk(Character<T>& character, const MeasuredBody& world, std::span<const JointJet<T>> jets,
                  double h);
  void walk_on(Character<T>& character, const MeasuredBody& world, const JointJet<T>& root, double h);
  double beyond_any_floor() const;
  void follow_ground(Character<T>& character);
  Displacement to_standing_foot(const MeasuredBody& is, double h) const;
  void change_feet(Character<T>& character, const MeasuredBody& world, double h);
  void move_offset(const MeasuredBody& is, double h);
  void lead_foot(std::size_t side, const Vec2& to, double in, double h);
  Footfall footfall(const Vec2& ahead, const Vec2& lands, double left, double time_of_step) const;
  Vec2 clip_ankle_now(std::size_t side, double h) const;
  void write_walk(std::span<JointJet<T>> jets, double h);
  void fade(std::span<JointJet<T>> jets, T h);
  void calm_legs(std::span<JointJet<T>> jets, T h) const;
  void place_feet(std::span<JointJet<T>> jets, T h);
  bool clip_rests(std::size_t side) const;
  double time_to_set_off() const;
  static Displacement in_world(const Character<T>& character, const Displacement& further);
  void displace(Character<T>& character, const Displacement& further);
  void displace_led(Character<T>& character, const Displacement& further);
  void finish(Character<T>& character);
  void return_to_clip(Character<T>& character);
  void fall(Character<T>& character, BehaviourReason reason, double number);
  void let_go(Character<T>& character, const MeasuredBody& world, double h);
  bool lies(const MeasuredBody& is, double h);
  bool may_get_up() const;
  void lie(Character<T>& character, std::span<JointJet<T>> jets, double h);
  void rise(Character<T>& character, std::span<JointJet<T>> jets, double h);
  void wait(Character<T>& character, std::span<JointJet<T>> jets);
  void set_off(Character<T>& character);
  void take_over(Character<T>& character, std::span<JointJet<T>> jets, double h);
  void tell(BehaviourEventKind kind, BehaviourReason reason, double number = 0);
  bool may_finish(const MeasuredBody& is) const;
  Vec2 capture_point() const;
  Vec2 goal() const;
  Feet feet_now(const Transform<double>& root) const;

  BehaviourSettings settings_;
  StandingBody<T> body_;
  BalanceLaw law_;
  double unit_ = 1, weight_ = 1;  ///< size and mass, of a human's
  BehaviourReport report_;
  Pendulum plan_;
  double frequency_ = 3;                   ///< ω, 1/s
  Sole support_;                           ///< that of the feet which stand
  std::array<Transform<double>, 2> foot_;  ///< where they stand, or will
  Vec2 from_clip_ = Vec2::Zero();          ///< the clip's centre of mass from the middle of its feet
  std::array<Vec2, 2> clip_foot_;          ///< m, the clip's ankles from its centre of mass
  Vec3<double> clip_acceleration_ = Vec3<double>::Zero();  ///< m/s², of its centre of mass
  Vec2 clip_body_ = Vec2::Zero(), clip_velocity_ = Vec2::Zero();
  double clip_presses_ = 0;  ///< m, into its ground with its feet
  LastStep last_step_;
  bool restored_ = false;  ///< that is the restored world's
  Quat<double> clip_root_ = Quat<double>::Identity();
  Vec3<double> clip_spin_ = Vec3<double>::Zero();  ///< rad/s, world axes
  bool walks_ = false;                             ///< it was pushed while it walked, and walks on
  int stance_ = 0;                                 ///< the foot that stands, of a walker
  bool swung_ = false;                             ///< the other one has left the ground
  double lands_in_ = 0;        ///< s, in which it lands, if sooner than its animation's; else infinite
  bool early_ = false;         ///< the foot that stands has, and its animation's not yet
  Vec2 lands_ = Vec2::Zero();  ///< m, where the animation's foot in the air will land
  bool comes_back_ = false;    ///< it has asked to be led back to its animation
  double sunk_ = 0;            ///< m, of the animation, since something last bore the body
  double pace_ = 0;            ///< m/s, of its animation when it was pushed
  Pendulum error_;             ///< what a walker is off its animation
  /// m, and of its feet.
  std::array<MovingVector<double>, 2> foot_offset_{still<double>(Vec3<double>::Zero()),
                                                   still<double>(Vec3<double>::Zero())};
  std::array<MovingTransform<T>, 2> clip_foot_motion_;
  double ground_ = 0;                                 ///< m, height of what the clip stands on
  double level_ = 0;                                  ///< m, height of what the body stands or lies on
  Vec3<double> normal_ = Vec3<double>::UnitZ();       ///< of what the body stands or lies on
  Vec3<double> clip_normal_ = Vec3<double>::UnitZ();  ///< of what its animation stands on
  bool leveled_ = false;                              ///< something has borne the body
  double higher_ = 0;  ///< m, by which that is higher below the feet of a plan than below the clip's
  CarriedFrame carried_, carried_next_;  ///< by ground that moves: now, and after the next step
  CarriedFrame ground_before_;           ///< what bore it last moved so
  /// m, of late, by which the clip's foot slips on ground that moves, were it taken along or not.
  double slip_ridden_ = 0, slip_led_ = 0;
  bool led_ = false;  ///< the host's animation goes along by itself
  std::array<Transform<double>, 2> clip_ankle_;
  int swing_ = -1, home_ = -1;               ///< the foot in the air; the one that is put back
  Sole only_;                                ///< of the foot that stands while the other is put back
  Vec2 ahead_ = Vec2::Zero();                ///< m, of late: of the body's capture point, of the plan's
  double swing_time_ = 0, swing_lasts_ = 0;  ///< s
  Transform<double> lifted_;                 ///< where the foot that swings left the ground
  Vec3<double> turn_ = Vec3<double>::Zero(), turn_rate_ = Vec3<double>::Zero(),
               turn_acceleration_ = Vec3<double>::Zero(), spin_ = Vec3<double>::Zero();
  TimeJet<double> height_{0.0};
  double rises_ = 0;     ///< m/s, upwards, after the last step
  double airborne_ = 0;  ///< s, in which nothing has borne it
  double yields_ = 0;  ///< m/s², of its height in this frame: as far as legs give in further than they should
  Landing landing_ = Landing::kNone;
  Vec3<double> forward_ = Vec3<double>::UnitX();  ///< of the body, root axes
  Quat<double> root_before_ = Quat<double>::Identity();
  bool measured_ = false;  ///< `root_before_` is that of the last frame
  double rest_ = 0;        ///< s
  ProtectiveReach<T> reach_;
  GetUp<T> get_up_;
  bool allowed_ = false;  ///< to get up
  bool knocked_ = false;  ///< since the last update
  bool risen_ = false;    ///< it has just got up, and balances
  /// It stands as its get-up clip ends, until it may set off with an animation that does not stand.
  bool waits_ = false;
  /// s, in which it fades from there into the animation, until its feet are where those of the animation are.
  double sets_off_ = 0;
  std::array<FootState<T>, 2> placed_;  ///< its feet while it does
  SmoothInput<T> lowered_;              ///< m, by which it is lower meanwhile, as its legs need it
  double stood_on_ = 0;                 ///< m, height of what its animation stood on before it fell
  std::array<BehaviourEvent, 4> events_;
  std::size_t events_count_ = 0;
  std::vector<JointJet<T>> last_;  ///< [joint] what was asked last
  bool asked_ = false;             ///< in the last frame
  bool fades_ = false;             ///< a fade has to begin in this frame
  bool fades_root_ = false;        ///< and takes the root along
  InertialState<T> fade_;
  InertialState<T> placing_;  ///< from where it stood to where its feet are placed as it sets off
  std::vector<T> fade_numbers_, placing_numbers_;
  std::vector<MovingTransform<T>> model_;
};

extern template class Behaviour<float>;
extern template class Behaviour<double>;

}  // namespace sinew
