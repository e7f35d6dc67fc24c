// What a world is made of. Internal to the character layer.
#pragma once

#include <array>
#include <atomic>

#include "sinew/character/contact_reporter.h"
#include "sinew/character/couplings.h"
#include "sinew/character/cut.h"
#include "sinew/character/island.h"
#include "sinew/character/islands.h"
#include "sinew/character/levels.h"
#include "sinew/character/nearby.h"
#include "sinew/character/playback.h"
#include "sinew/character/snapshot.h"
#include "sinew/character/touching_sets.h"
#include "sinew/effects/check_batch.h"
#include "sinew/effects/particles.h"

namespace sinew {

/// A particle body: its tree, its elements, and where its frame is fixed.
struct ParticleSet {
  ParticleBody body;
  std::vector<int> bodies;  ///< see bodies_of_nodes
  int state = 0;
  Place place;
};

/// Where an effect that was added is found, and whose it is.
template <class T>
struct EffectSlot {
  std::uint32_t serial = 0;  ///< 0: free
  CharacterState<T>* owner = nullptr;
  Effect<T>* effect = nullptr;
};

/// What calls answer where an index names nothing.
inline Status no_such_character(int index) {
  return Status::error(Code::kInvalidArgument, "no such character", index);
}
inline Status no_such_prop(int index) {
  return Status::error(Code::kInvalidArgument, "no such prop", index);
}

template <class T>
struct World<T>::Impl {
  static constexpr std::size_t kMostWaiting = 4 * BatchCheck::kMostLanes;  ///< per worker
  /// An island of one whose animation is to be checked with others'.
  struct Unchecked {
    int island = 0;
    CharacterState<T>* state = nullptr;
    bool stands = false;  ///< see stands()
    double spent = 0;     ///< on it so far, by the budget's clock

    bool alike(const Unchecked& other) const {
      return state->rig == other.state->rig && stands == other.stands;
    }
  };
  /// What one thread works in.
  struct Worker {
    IslandStepper<T> stepper;
    std::unique_ptr<BatchCheck> checks;  ///< null: not declared
    std::vector<Unchecked> unchecked;
    std::vector<std::byte> check_scratch;     ///< of a check alone, of the largest rig
    std::vector<CharacterState<T>*> members;  ///< of the island, `indices` in the world
    std::span<const int> indices;
    std::vector<Coupling<T>*> ties;
    std::vector<JointJet<T>> jets;
    std::span<CharacterState<T>* const> touched;  ///< members of the set that is stepped
    std::vector<CharacterState<T>*> solved;       ///< of that set, `solved_indices` in the world
    std::vector<int> solved_indices;
    std::vector<std::size_t> first_load;  ///< [member of the set] of its forces, what it bears in this step
    Nearby<T> nearby;                     ///< of whom may_play() has asked about last
    TouchingSets<T> sets;
    std::size_t number = 0;
    ContactLog<T>* log = nullptr;  ///< of the island that it steps; null where nobody listens
  };

  WorldSettings settings;
  StepPlan<T> plan;  ///< what is declared
  std::vector<std::shared_ptr<const Rig<T>>> rigs;
  std::vector<std::unique_ptr<CharacterState<T>>>
      states;                          ///< characters and props in the order they were added
  std::vector<KeptStep<T>> kept;       ///< [state]
  std::vector<int> characters, props;  ///< into states
  Couplings<T> couplings;
  std::vector<std::span<std::byte>> games;  ///< their bytes are saved with the state
  std::vector<int> loops;                   ///< into couplings
  std::vector<ParticleSet> particles;
  std::vector<EffectSlot<T>> effect_slots;
  std::vector<Collider> obstacles;
  NeighbourGrid obstacle_grid;
  std::vector<HostObstacle> hosts;
  std::vector<std::uint32_t> obstacle_layers, host_layers;  ///< see CharacterSettings::layers
  std::vector<LaggedForce<T>> lagged;                       ///< of the last step, by identity
  std::unique_ptr<ContactReporter<T>> reporter;             ///< null: nobody listens
  std::vector<std::unique_ptr<Worker>> workers;
  std::vector<MakeIslandEffect<T>> declared;  ///< each worker has one of each
  SolveCapacities rooms;
  /// What the largest rig that may be played has: points that may stand on the ground.
  struct {
    int bodies = 0, dofs = 0, points = 0;
  } checked_rig;
  SolveCapacity small_capacity;  ///< of an island that any worker can step; the first one can step all

  // Of the present step
  T h = T(0);
  Islands<T> islands;
  std::vector<int> large, heavy, light;  ///< islands: for the first worker alone, to be solved, to be played
  std::vector<LaggedForce<T>> lagged_new;
  std::vector<int> first_lagged, lagged_count;  ///< [island] of its part of lagged_new
  BudgetController<T> controller;
  WorldReport report;
  std::atomic<int> next_heavy{0}, next_light{0};

  /// Null where an index names nothing.
  CharacterState<T>* character(int index) const { return state_of(characters, index); }
  CharacterState<T>* prop(int index) const { return state_of(props, index); }
  CharacterState<T>* state_of(const std::vector<int>& list, int index) const {
    const bool any = index >= 0 && index < static_cast<int>(list.size());
    return any ? states[list[index]].get() : nullptr;
  }
  /// Number of a character's, prop's or particle body's state; −1 where a name means none.
  int state_named(const BodyRef& body) const {
    const auto of = [&](const std::vector<int>& list) {
      return body.index >= 0 && body.index < static_cast<int>(list.size()) ? list[body.index] : -1;
    };
    if (body.kind == BodyKind::kCharacter) return of(characters);
    if (body.kind == BodyKind::kProp) return of(props);
    const ParticleSet* const set = body.kind == BodyKind::kParticles ? particle_set(body.index) : nullptr;
    return set ? set->state : -1;
  }
  Coupling<T>* loop(int index) {
    const bool any = index >= 0 && index < static_cast<int>(loops.size());
    return any ? &couplings[loops[index]] : nullptr;
  }
  const ParticleSet* particle_set(int index) const {
    const bool any = index >= 0 && index < static_cast<int>(particles.size());
    return any ? &particles[index] : nullptr;
  }
  const EffectSlot<T>* slot_of(EffectId id) const {
    const bool any = id.serial != 0 && id.slot < effect_slots.size();
    return any && effect_slots[id.slot].serial == id.serial ? &effect_slots[id.slot] : nullptr;
  }

  void declare(DeclareTerm<T> term);
  Status add(const Skeleton& skeleton, const CharacterSettings& character);
  SolveCapacity capacity_of_rig(const Rig<T>& rig) const;
  void count_in(CharacterState<T>& state);
  void count_all();
  bool over_cap() const;
  void drop_last();
  int tie(Coupling<T> coupling, Status& status);
  std::array<SolveCapacity, 2> capacity_of_workers() const;
  WorldMemory memory() const;
  void reserve();
  void meet_surroundings();
  Status add_effect(CharacterState<T>& state, std::unique_ptr<Effect<T>> effect, EffectId* id);
  void plan_effects_anew(CharacterState<T>& state);
  void park(CharacterState<T>& state);
  bool play_set(std::span<CharacterState<T>* const> members, Worker& worker);
  bool follow_set(std::span<CharacterState<T>* const> members, Worker& worker);
  bool play_alone(CharacterState<T>& state, Worker& worker);
  bool play_on_props(CharacterState<T>& state, Worker& worker);
  bool may_play(CharacterState<T>& state, Worker& worker) const;
  bool checks(const CharacterState<T>& state) const;
  void look_around(CharacterState<T>& state, Worker& worker) const;
  const GroundProbe<T>* ground_met(CharacterState<T>& state, Worker& worker) const;
  const GroundProbe<T>* ground_near(CharacterState<T>& state, Worker& worker) const;
  CheckContext<T> context_of_check(const CharacterState<T>& state, Worker& worker,
                                   const GroundProbe<T>* ground) const;
  void begin_solve(CharacterState<T>& state, Worker& worker);
  bool checks_in_batches(CharacterState<T>& state, Worker& worker) const;
  void check_later(int island, Worker& worker, double spent);
  void check_alike(Worker& worker, const Unchecked& one);
  void solve_alone(int island, Worker& worker, double spent);
  int step_set(std::span<CharacterState<T>* const> members, std::span<const int> indices,
               std::span<Coupling<T>* const> ties, int spent, Worker& worker,
               std::span<LaggedForce<T>> lagged_out);
  void step_island(int island, Worker& worker);
  void close_island(int island, std::span<CharacterState<T>* const> members,
                    std::span<Coupling<T>* const> ties, double spent);
  std::span<LaggedForce<T>> lagged_of(int island) {
    return std::span(lagged_new)
        .subspan(first_lagged[island], first_lagged[island + 1] - first_lagged[island]);
  }
  void log_contacts(int island, Worker& worker);
  void report_contacts();
  BodyRef name_of(const TouchingBody& body) const;
  static void work(void* context, int index);
  void keep_sleepers();
  void log_step() const;
  void carry_who_leaps();
  bool goes_along(int state) const;
  void take_along(const Leap& leap);
  void step_all(T step, const ParallelFor& parallel_for);
  MovingParts<T> moving() { return {states, lagged, controller.state(), couplings.all(), games}; }
  Surroundings surroundings() const {
    Surroundings around{obstacles, &obstacle_grid, hosts, couplings.apart()};
    if (settings.ground) around.floor = settings.ground_height;
    return around;
  }

  // Of loops and particle bodies: world_ties.cpp
  Status find(const Anchor& anchor, Place& out) const;
  Transform<double> frame_of(const Place& place) const;
  double weight_of(const Place& place) const;
};

/// For what belongs to worlds and is declared beside them.
template <class T>
struct WorldInternals {
  using Impl = typename World<T>::Impl;
  static Impl& of(const World<T>& world) { return *world.impl_; }
};

}  // namespace sinew
