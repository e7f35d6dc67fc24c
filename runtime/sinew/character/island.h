// One solve: characters and props that may touch each other, stepped together. Internal to the character
// layer.
#pragma once

#include <array>
#include <vector>

#include "sinew/character/contact_finder.h"
#include "sinew/character/contact_log.h"
#include "sinew/character/energy_balance.h"
#include "sinew/effects/island_effect.h"
#include "sinew/optimizer/bossak.h"
#include "sinew/optimizer/end_velocities.h"
#include "sinew/optimizer/newton.h"

namespace sinew {

/// Working memory of island steps; one per worker, sized when characters are added. Keeps nothing from one
/// step to the next.
template <class T>
class IslandStepper {
 public:
  void reserve(const SolveCapacity& capacity, int obstacles);
  /// That reserve() takes.
  std::size_t bytes(const SolveCapacity& capacity) const;
  /// Set-up, before reserve(): the world's plan, again where it has changed.
  void declare(const StepPlan<T>& plan) {
    settings_.plan = &plan;
    solver_.declare(plan);
    if (plan.contacts) finder_ = plan.contacts->make_finder();
  }
  void declare(std::unique_ptr<IslandEffect<T>> effect) { effects_.push_back(std::move(effect)); }
  void drop_last_effect() { effects_.pop_back(); }

  /// Where the coming steps write what they find of contacts; null: nowhere.
  void write_contacts_to(ContactLog<T>* log) { log_ = log; }
  /// Steps the given characters and props by h. `indices` are their numbers in the world (for contact
  /// identities), `couplings` what they are tied together with; `lagged` the normal forces of the last step,
  /// sorted by id; new ones are written to `lagged_out`, as many as it takes. `spent`: passes of the step's
  /// budget that are gone. Returns how many.
  int step(const WorldSettings& world, const Surroundings& surroundings, T h,
           std::span<CharacterState<T>* const> states, std::span<const int> indices,
           std::span<Coupling<T>* const> couplings, std::span<const LaggedForce<T>> lagged,
           std::span<LaggedForce<T>> lagged_out, int spent = 0);

 private:
  /// A body's motion before land().
  struct Landing {
    Vec3<T> velocity, momentum, struck_velocity, struck_momentum;
    Mat3<T> rotation_rate;
    std::array<T, 6> rate;
    Deviation<T> deviation;
  };

  std::span<const std::uint8_t> find_bearing(int tree);
  int parts_of() const;
  int unsolved() const;
  bool may_divide() const;
  bool starts() const;
  void limit_guess(T h);
  void find_accelerations();
  void begin_loaded(T h);
  void advance_part(T begin, T end, int splits_left);
  void find_contacts(T h);
  void begin_part(T h, T fraction);
  bool goes_by_turning(std::size_t tree) const;
  bool turns_far(T h) const;
  bool strikes_deep(T h) const;
  void choose_guess(T h);
  void begin_solve();
  int most_passes() const;
  SolveReport solve();
  void loosen_loops();
  bool tighten_loops();
  SolveReport attempt(bool may_split);
  void begin(const WorldSettings& world, const Surroundings& surroundings, T h,
             std::span<CharacterState<T>* const> states, std::span<const int> indices,
             std::span<Coupling<T>* const> couplings, std::span<const LaggedForce<T>> lagged);
  bool stays_where_it_sticks(const Contact<T>& c) const;
  void choose_lagged(std::span<const LaggedForce<T>> lagged);
  bool passive() const;
  double pose_energy() const;
  double way_energy() const;
  double energy_error(bool easy) const;
  double rest_tolerance() const;
  SolveReport solve_from_start();
  void freeze(CharacterState<T>& state);
  void forget_contacts();
  void write_pushes(CharacterState<T>& state, T emphasis) const;
  void stop_lost();
  void freeze_lost(bool no_pose);
  T return_time() const { return T(world_->accuracy.return_time); }
  bool is_finite(const CharacterState<T>& state) const;
  void choose_wanted(CharacterState<T>& state, T fraction);
  bool touches_more_than_ground(int tree) const;
  void find_sets();
  void predict_all(T h);
  void predict_euler_all(T h);
  void expect_to_last(T h);
  void drop_constant(CharacterState<T>& state, int tree, std::span<const T> force);
  T opening_speed(const Contact<T>& c) const;
  void write_borne();
  void drop_opened(T h);
  void drop_played();
  void strike_all();
  Strike<T> strike_of(std::size_t tree) const;
  void strike(CharacterState<T>& state, std::span<Vec3<T>> velocity, std::span<Vec3<T>> momentum);
  bool may_land() const;
  bool are_tied(int a, int b) const;
  bool strikes(const Contact<T>& contact, T h) const;
  Bounce<T> bounce_of(const Contact<T>& contact, T h) const;
  void note_bounces();
  Contact<T>* find_contact(std::uint64_t id);
  bool ties_passive(const Coupling<T>& coupling) const;
  bool passes_by(const Contact<T>& contact) const;
  bool strikes_limit(CharacterState<T>& state, T h);
  std::array<T, 6> rate_at_start(const CharacterState<T>& state, int joint) const;
  template <class Act>
  void for_each_limit(CharacterState<T>& state, T h, bool all, const Act& act);
  void add_limits(CharacterState<T>& state, int tree, T h);
  void append_loose(const CharacterState<T>& state);
  void add_to_rate(CharacterState<T>& state, int joint, const std::array<T, 6>& spin);
  void measure_driven_at_start(const CharacterState<T>& state, int tree);
  void land(T h);
  void take_landing(T h);
  void lead_back(CharacterState<T>& state, int tree, T h);
  void take_back_landing();
  void log_strikes();
  void log_contacts(T h);
  void log_bounces(const IslandEffect<T>& effect);
  T impulse_of(const Contact<T>& contact, T h) const;
  LoggedContact<T> logged_at_end(const Contact<T>& contact) const;
  void drop_trial(CharacterState<T>& state, int tree);
  void begin_ends();
  void take_over(Contact<T>& contact) const;
  void split_contacts(T h);
  void measure_constant(const CharacterState<T>& state, TreeProblem<T>& problem, int tree,
                        const Kinematics<T>& kinematics);
  void measure_constant_at_start(CharacterState<T>& state, int tree, T h);
  Jumps<T> measure_jumps(CharacterState<T>& state, int tree, T h);
  T choose_start(const CharacterState<T>& state, int tree);
  void add_start(CharacterState<T>& state, int tree);
  void measure_driven(const CharacterState<T>& state, int tree, T h);
  bool is_locked(const CharacterState<T>& state) const;
  void fall(History<T>& history) const;
  void accelerate_locked(CharacterState<T>& state, int tree);
  bool choose_loose();
  void advance_one_step(T h);
  void emphasise_friction(T h);
  void relax_friction(T h);
  void press(T h);
  void finish_pose(CharacterState<T>& state, int tree, T h);
  void number_bodies();
  void advance_all(T h);
  void advance_by(const TimeScheme<T>& scheme, T h);
  void add_bearing(const Contact<T>& contact, int tree, BearingGround& ground) const;
  void find_ground();
  void report(CharacterState<T>& state, int tree);

  const WorldSettings* world_ = nullptr;
  Surroundings surroundings_;
  std::span<CharacterState<T>* const> states_;
  std::span<const int> indices_;
  std::span<Coupling<T>* const> couplings_;
  T frame_ = T(0);                      ///< s, the whole step
  T part_end_ = T(1);                   ///< where the present part ends, as a fraction of it
  std::vector<LaggedForce<T>> lagged_;  ///< of the last part
  std::ptrdiff_t capacity_ = 0;         ///< contacts that there is memory for
  SolveReport total_;
  bool closed_ = false;  ///< nothing can do work on the trees in this part
  double budget_ = 0;    ///< J, what they had when it began, where anybody asks
  bool all_converged_ = true;
  int passes_left_ = 0;     ///< of the step, see Accuracy::max_passes
  int passes_of_part_ = 0;  ///< of all solves of the part
  int parts_ = 0, splits_ = 0, damped_ = 0, frozen_ = 0, restarts_ = 0, left_out_ = 0;
  StepSettings<T> settings_;
  std::vector<std::uint8_t> is_frozen_;  ///< [tree] in the present part
  std::vector<TreeProblem<T>*> problems_;
  std::unique_ptr<ContactSearch<T>> finder_;               ///< null: no contacts are declared
  std::vector<std::unique_ptr<IslandEffect<T>>> effects_;  ///< declared
  std::vector<IslandTree<T>> trees_;                       ///< as these see them; empty where there are none
  EnergyBalance<T> balance_;
  std::vector<T> free_share_;  ///< [tree] see IslandEffect::limit_guess
  std::span<Contact<T>> contacts_;
  NewtonSolver<T> solver_;
  // Of the scheme
  std::vector<int> set_;              ///< [tree] see find_sets
  std::vector<T> radius_;             ///< [set] ρ
  std::vector<std::uint8_t> bears_;   ///< [body] of one tree, see find_bearing
  std::vector<std::uint8_t> driven_;  ///< [set] some member has muscles, or its root is driven
  std::vector<std::uint8_t> loose_;   ///< [dof, trees one after the other] see choose_loose
  std::vector<std::uint8_t> struck_;  ///< [set] some member's do not last
  std::vector<std::uint8_t> lasts_;   ///< [tree] contacts and limits are those of the steps before
  std::vector<T> jump_force_, constant_, kinks_, others_, speed_share_;  ///< [dof] of one tree
  std::vector<Vec3<T>> moved_, turned_, end_sped_, end_spun_;            ///< [body] the same
  std::vector<Vec3<T>> start_sped_, start_spun_;  ///< [body, trees one after the other] see choose_start
  std::vector<T> impulse_;                        ///< [dof, the same] what is not in the velocities yet
  std::vector<int> first_body_, first_dof_;       ///< [tree] in these
  std::vector<Vec3<T>> missed_, unturned_;        ///< [body, the same] see begin_error
  std::vector<std::uint8_t> turned_far_;          ///< [tree] measure_constant_at_start has found something
  std::vector<std::array<T, 6>> jumps_;           ///< [body] of one tree, of its joint rates
  std::vector<std::array<T, 6>> late_jumps_;      ///< [body, trees one after the other] see take_landing
  std::vector<Vec3<T>> struck_velocity_, struck_momentum_;  ///< [body, trees one after the other] see Strike
  bool landed_ = false;                                     ///< land() has changed velocities
  std::vector<T> opened_, shut_;                            ///< [contact] see drop_opened
  bool blow_ = false;                                       ///< what it parts still carries a force
  std::vector<Landing> kept_;                               ///< [body, the same] before it did
  ContactLog<T>* log_ = nullptr;
  std::vector<Twist<T>> driven_rates_;  ///< [body]
  EndVelocities<T> ends_;
  std::vector<Vec3<double>> momenta_;  ///< [tree] at the end, where gravity alone acts
};

extern template class IslandStepper<float>;
extern template class IslandStepper<double>;

}  // namespace sinew
