#include "sinew/character/world.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "sinew/character/cut.h"
#include "sinew/character/memory.h"
#include "sinew/character/playback.h"
#include "sinew/character/prop.h"
#include "sinew/character/world_impl.h"
#include "sinew/skeleton/hooks.h"

namespace sinew {
namespace {

constexpr int kMostWorkers = 256;
constexpr int kMostObstacles = 6;  ///< that one character touches at a time, for the room of its contacts
constexpr const char* kNoMuscles = "the world declares no Muscles: strength must be 0 or infinite";
constexpr const char* kNoContacts =
    "the world declares no Contacts: no obstacles, and WorldSettings::ground must be false";
constexpr int kSmallIsland = 8;  ///< characters that any worker has memory for; one worker has for all

constexpr const char* kNotFinite = "prop's pose or velocity is not finite";

template <class T>
bool moves_finitely(const Transform<T>& pose, const Vec3<T>& velocity, const Vec3<T>& angular_velocity) {
  return pose.rotation.coeffs().allFinite() && pose.translation.allFinite() && velocity.allFinite() &&
         angular_velocity.allFinite();
}

/// Room for so many, with some to spare where it must be moved.
template <class V>
void grow(std::vector<V>& v, int count) {
  const std::size_t needed = static_cast<std::size_t>(count);
  if (needed > v.capacity()) v.reserve(std::max(needed, v.capacity() + v.capacity() / 2));
}

}  // namespace

template <class T>
World<T>::World(const WorldSettings& settings, DeclareNothing /*nothing*/) : impl_(std::make_unique<Impl>()) {
  impl_->settings = settings;
  for (int n = 0; n < std::clamp(settings.workers, 1, kMostWorkers); ++n)
    impl_->workers.push_back(std::make_unique<typename Impl::Worker>());
  for (std::size_t n = 0; n < impl_->workers.size(); ++n) {
    impl_->workers[n]->number = n;
    impl_->workers[n]->stepper.declare(impl_->plan);
  }
}

template <class T>
World<T>::~World() = default;

template <class T>
SolveCapacity World<T>::Impl::capacity_of_rig(const Rig<T>& rig) const {
  // Every point may be near the floor, an obstacle, and a few shapes of others.
  const int points = static_cast<int>(rig.points.size());
  const int around = std::min(static_cast<int>(obstacles.size() + hosts.size()), kMostObstacles);
  return capacity_of(rig.tree, points * (6 + around) + 64, 2 * points + 16,
                     static_cast<int>(rig.colliders.size()));
}

template <class T>
void World<T>::Impl::count_in(CharacterState<T>& s) {
  s.problem.capacity = capacity_of_rig(*s.rig);
  for (const auto& effect : s.effects) s.problem.capacity.effect_rows += effect->most_rows();
  rooms.add(s.problem.capacity);
  if (!s.is_prop && !s.is_particles)
    checked_rig = {std::max(checked_rig.bodies, s.tree.bodies), std::max(checked_rig.dofs, s.tree.dofs),
                   std::max(checked_rig.points, static_cast<int>(s.rig->support.points.size()))};
}

template <class T>
void World<T>::Impl::count_all() {
  rooms = {};
  checked_rig = {};
  for (const auto& s : states) count_in(*s);
  couplings.count_in(states, std::max(1.0, settings.gravity.norm()), rooms);
}

/// Of the first worker, and of the others.
template <class T>
std::array<SolveCapacity, 2> World<T>::Impl::capacity_of_workers() const {
  const SolveCapacity most = rooms.of_island(settings.island_dofs);
  return {most, workers.size() > 1 ? smaller(most, rooms.largest.times(kSmallIsland)) : most};
}

/// Everything but what the allocator adds.
template <class T>
WorldMemory World<T>::Impl::memory() const {
  WorldMemory bytes;
  for (const auto& rig : rigs) bytes.rigs += bytes_of(*rig);
  for (const auto& s : states) bytes.characters += bytes_of(*s);
  for (const KeptStep<T>& step : kept) bytes.characters += sizeof step + step.bytes();
  for (const auto& c : couplings.all()) bytes.characters += bytes_of(*c);
  bytes.characters += 2 * rooms.all.loaded * sizeof(LaggedForce<T>);
  bytes.characters += rooms.all.colliders * sizeof(MovingCollider<T>);
  if (reporter) bytes.characters += reporter->bytes();
  const auto [most, small] = capacity_of_workers();
  for (std::size_t n = 0; n < workers.size(); ++n)
    bytes.solving +=
        workers[n]->stepper.bytes(n == 0 ? most : small) + workers[n]->sets.bytes(n == 0 ? most : small);
  for (const auto& worker : workers) {
    bytes.solving += worker->check_scratch.capacity() + worker->nearby.bytes();
    if (worker->checks) bytes.solving += worker->checks->bytes();
  }
  return bytes;
}

/// Memory for everything that the next step may need.
template <class T>
void World<T>::Impl::reserve() {
  const auto [most, small] = capacity_of_workers();
  small_capacity = small;
  for (std::size_t n = 0; n < workers.size(); ++n) {
    const SolveCapacity& capacity = n == 0 ? most : small_capacity;
    workers[n]->stepper.reserve(capacity, static_cast<int>(obstacles.size()));
    workers[n]->nearby.reserve(rooms.largest.colliders, checked_rig.points, obstacles.size(),
                               static_cast<std::size_t>(capacity.colliders));
    workers[n]->sets.reserve(capacity);
    for (auto* v : {&workers[n]->members, &workers[n]->solved}) v->reserve(capacity.trees);
    workers[n]->solved_indices.reserve(capacity.trees);
    workers[n]->first_load.reserve(capacity.trees);
    workers[n]->ties.reserve(couplings.all().size());
    workers[n]->jets.reserve(rooms.largest.bodies);
    const auto& [bodies, dofs, points] = checked_rig;
    workers[n]->check_scratch.resize(CheckScratch<T>::bytes(bodies, bodies, points));
    if (workers[n]->checks) workers[n]->checks->reserve(bodies, dofs, points);
    workers[n]->unchecked.reserve(Impl::kMostWaiting);
  }
  for (auto* v : {&lagged, &lagged_new}) grow(*v, rooms.all.loaded);
  const auto count = states.capacity();
  islands.reserve(static_cast<int>(count), static_cast<int>(couplings.all().size()), rooms.all.colliders);
  controller.reserve(static_cast<int>(count));
  for (auto* v : {&large, &heavy, &light}) v->reserve(count);
  for (auto* v : {&first_lagged, &lagged_count}) v->reserve(count + 1);
  if (reporter) reporter->reserve(rooms.all.loaded, static_cast<int>(count), rooms.all.colliders);
}

/// What is around has changed: anybody may touch it.
template <class T>
void World<T>::Impl::meet_surroundings() {
  obstacle_grid.reserve(static_cast<int>(obstacles.size()));
  obstacle_grid.clear();
  for (std::size_t o = 0; o < obstacles.size(); ++o)
    obstacle_grid.add(static_cast<int>(o), obstacles[o].local.translation, bounding_radius(obstacles[o]));
  obstacle_grid.build();
  count_all();
  for (const auto& s : states) s->levels.wake = true;
  reserve();
}

template <class T>
bool World<T>::Impl::over_cap() const {
  return settings.memory_cap > 0 && memory().total() > settings.memory_cap;
}

/// Whoever was added last, and the rig that nobody else uses.
template <class T>
void World<T>::Impl::drop_last() {
  states.pop_back();
  if (kept.size() > states.size()) kept.pop_back();
  if (rigs.back().use_count() == 1) rigs.pop_back();
}

/// Returns the coupling's index.
template <class T>
int World<T>::Impl::tie(Coupling<T> coupling, Status& status) {
  const int index = couplings.add(std::move(coupling));
  count_all();
  if (over_cap()) {
    couplings.drop_last();
    count_all();
    status = Status::error(Code::kOutOfRange, "WorldSettings::memory_cap leaves no room for it");
    return -1;
  }
  meet_surroundings();
  return index;
}

template <class T>
Status World<T>::Impl::add(const Skeleton& skeleton, const CharacterSettings& character) {
  if (states.size() >= kMostTrees)
    return Status::error(Code::kOutOfRange, "a world has room for 65534 characters and props");
  if (settings.ground && !plan.contacts) return Status::error(Code::kInvalidArgument, kNoContacts);
  auto same =
      std::find_if(rigs.begin(), rigs.end(), [&](const auto& rig) { return rig->skeleton == skeleton; });
  if (same == rigs.end()) same = rigs.insert(same, std::make_shared<const Rig<T>>(skeleton, plan));
  states.push_back(std::make_unique<CharacterState<T>>(*same, character, plan));
  CharacterState<T>& added = *states.back();
  if (added.limited && !plan.joints.muscles) {
    drop_last();
    return Status::error(Code::kInvalidArgument, kNoMuscles);
  }
  added.levels.steps = static_cast<std::uint32_t>(states.size());  // not all are checked at once
  const SolveCapacities before = rooms;
  count_in(added);
  if (over_cap()) {
    rooms = before;
    drop_last();
    return Status::error(Code::kOutOfRange, "WorldSettings::memory_cap leaves no room for it");
  }
  kept.emplace_back(added);
  reserve();
  return {};
}

template <class T>
WorldMemory World<T>::memory() const {
  return impl_->memory();
}

template <class T>
int World<T>::add_character(const Skeleton& skeleton, const CharacterSettings& settings, Status& status) {
  status = validate(skeleton);
  if (!status) return -1;
  if (std::isnan(settings.strength) || settings.strength < 0 || !(settings.root_force >= 0) ||
      !(settings.root_torque >= 0) || !(settings.help_force >= 0) || !(settings.help_torque >= 0)) {
    status = Status::error(Code::kInvalidArgument, "strength, root drive limits and help must be ≥ 0");
    return -1;
  }
  if (settings.tone < Tone::kRigid || settings.tone > Tone::kBraced) {
    status = Status::error(Code::kInvalidArgument, "no such tone");
    return -1;
  }
  status = validate(settings.detail);
  if (status) status = impl_->add(skeleton, settings);
  if (!status) return -1;
  impl_->characters.push_back(static_cast<int>(impl_->states.size()) - 1);
  return static_cast<int>(impl_->characters.size()) - 1;
}

template <class T>
int World<T>::add_prop(const PropSettings& prop, Status& status) {
  status = prop.hull || prop.shape != Shape::kConvex
               ? Status()
               : Status::error(Code::kInvalidArgument, "convex prop has no hull");
  if (!status) return -1;
  const Skeleton body = skeleton_of(prop);
  status = prop.mass > 0 ? validate(body) : Status::error(Code::kInvalidArgument, "prop needs a mass");
  if (status && !moves_finitely(prop.pose, prop.velocity, prop.angular_velocity))
    status = Status::error(Code::kNotFinite, kNotFinite);
  if (!status) return -1;
  CharacterSettings limp;
  limp.root = RootDrive::kFree;
  limp.layers = prop.layers;
  limp.meets = prop.meets;
  status = impl_->add(body, limp);
  if (!status) return -1;
  impl_->states.back()->is_prop = true;
  impl_->states.back()->refresh_limits();
  impl_->props.push_back(static_cast<int>(impl_->states.size()) - 1);
  const int index = static_cast<int>(impl_->props.size()) - 1;
  status = set_prop(index, prop.pose.template cast<T>(), prop.velocity.template cast<T>(),
                    prop.angular_velocity.template cast<T>());
  return index;
}

template <class T>
Status World<T>::set_prop(int index, const Transform<T>& pose, const Vec3<T>& velocity,
                          const Vec3<T>& angular_velocity) {
  CharacterState<T>* const s = impl_->prop(index);
  if (!s) return no_such_prop(index);
  if (!moves_finitely(pose, velocity, angular_velocity))
    return Status::error(Code::kNotFinite, kNotFinite, index);
  s->parked = false;
  JointJet<T>& jet = s->target[0];
  jet = {};
  jet.rotation = pose.rotation;
  jet.translation = pose.translation;
  jet.velocity = velocity;
  jet.omega = pose.rotation.conjugate() * angular_velocity;
  s->reset_to_target(Vec3<T>::Zero());
  return {};
}

template <class T>
Status World<T>::keep_apart(const BodyRef& a, const BodyRef& b, bool apart) {
  const int first = impl_->state_named(a), second = impl_->state_named(b);
  if (first < 0 || second < 0)
    return Status::error(Code::kInvalidArgument, "no such character, prop or body of particles",
                         first < 0 ? a.index : b.index);
  if (first == second) return Status::error(Code::kInvalidArgument, "a body and itself", a.index);
  impl_->couplings.set_apart(first, second, apart);
  for (const int n : {first, second}) impl_->states[n]->levels.wake = true;
  return {};
}

template <class T>
Status World<T>::park_prop(int index) {
  CharacterState<T>* const s = impl_->prop(index);
  if (!s) return no_such_prop(index);
  impl_->park(*s);
  return {};
}

template <class T>
Status World<T>::park_character(int index) {
  CharacterState<T>* const s = impl_->character(index);
  if (!s) return no_such_character(index);
  impl_->park(*s);
  return {};
}

template <class T>
Status World<T>::unpark_character(int index) {
  CharacterState<T>* const s = impl_->character(index);
  if (!s) return no_such_character(index);
  s->parked = false;
  return Character<T>(s).reset();
}

template <class T>
bool World<T>::parked(int index) const {
  const CharacterState<T>* const s = impl_->character(index);
  return s && s->parked;
}

template <class T>
const WorldReport& World<T>::report() const {
  return impl_->report;
}

/// Out of the world; who leant on it wakes.
template <class T>
void World<T>::Impl::park(CharacterState<T>& s) {
  const bool woken = s.levels.asleep;
  const std::int32_t nap = s.levels.nap;
  s.levels = {};
  s.levels.wake = woken;
  s.levels.nap = nap;
  s.parked = true;
}

template <class T>
Status World<T>::add_obstacle(const Collider& obstacle, std::uint32_t layers) {
  if (Status status = validate(obstacle); !status) return status;
  if (!impl_->plan.contacts) return Status::error(Code::kInvalidArgument, kNoContacts);
  impl_->obstacles.push_back(obstacle);
  impl_->obstacle_layers.push_back(layers);
  impl_->meet_surroundings();
  return {};
}

template <class T>
Status World<T>::add_obstacle(const StaticShape& shape, double friction, double restitution,
                              std::uint32_t layers) {
  if (!(friction >= 0) || !(restitution >= 0 && restitution <= 1))
    return Status::error(Code::kInvalidArgument,
                         "obstacle's friction must be ≥ 0, its restitution in [0, 1]");
  const SignedDistance<double> probe = shape.distance(Vec3<double>::Zero());
  if (!std::isfinite(probe.distance) || std::abs(probe.normal.norm() - 1) > 1e-6)
    return Status::error(Code::kInvalidArgument, "obstacle's distance at the origin is no distance");
  if (!impl_->plan.contacts) return Status::error(Code::kInvalidArgument, kNoContacts);
  impl_->hosts.push_back({&shape, friction, restitution});
  impl_->host_layers.push_back(layers);
  impl_->meet_surroundings();
  return {};
}

template <class T>
Character<T> World<T>::character(int index) {
  return Character<T>(impl_->character(index));
}

template <class T>
int World<T>::character_count() const {
  return static_cast<int>(impl_->characters.size());
}

template <class T>
int World<T>::prop_count() const {
  return static_cast<int>(impl_->props.size());
}

template <class T>
Transform<T> World<T>::prop_pose(int index) const {
  CharacterState<T>* const s = impl_->prop(index);
  return s ? s->model()[0] : Transform<T>();
}

template <class T>
Vec3<T> World<T>::prop_velocity(int index) const {
  const CharacterState<T>* const s = impl_->prop(index);
  return s ? s->history.velocity[0] : Vec3<T>(Vec3<T>::Zero());
}

template <class T>
const CharacterReport& World<T>::prop_report(int index) const {
  static const CharacterReport none;
  const CharacterState<T>* const s = impl_->prop(index);
  return s ? s->report : none;
}

/// Of the last step's contact forces, only those of sleepers still hold.
template <class T>
void World<T>::Impl::keep_sleepers() {
  const auto stepped = [&](const LaggedForce<T>& f) {
    return islands.contains(static_cast<int>(f.id / first_contact_id(0)) - 1);
  };
  lagged.erase(std::remove_if(lagged.begin(), lagged.end(), stepped), lagged.end());
  for (std::size_t n = 0; n < states.size(); ++n)
    if (!islands.contains(static_cast<int>(n))) {
      CharacterState<T>& s = *states[n];
      s.levels.work = s.levels.spent = 0;
      if (s.levels.asleep) s.report.level = s.levels.level = Level::kAsleep;
    }
}

/// What the step could not do, in the order in which the bodies were added.
template <class T>
void World<T>::Impl::log_step() const {
  const auto log = [&](const std::vector<int>& list, bool are_characters) {
    for (std::size_t n = 0; n < list.size(); ++n) {
      if (!islands.contains(list[n])) continue;
      const CharacterReport& r = states[list[n]]->report;
      const auto say = [&](LogLevel level, const char* character, const char* prop) {
        write_log(level, are_characters ? character : prop, static_cast<int>(n));
      };
      if (r.frozen > 0)
        say(LogLevel::kWarning, "a character was stopped where it stood: no pose could be found",
            "a prop was stopped where it was: no pose could be found");
      if (r.left_out > 0)
        say(LogLevel::kWarning, "a character's furthest contacts were left out: no memory for so many",
            "a prop's furthest contacts were left out: no memory for so many");
      if (r.crowded)
        say(LogLevel::kWarning, "a character may pass through another: more touch than island_dofs allows",
            "a prop may pass through another: more touch than island_dofs allows");
      if (!r.converged)
        say(LogLevel::kInfo, "a character's step did not converge", "a prop's step did not converge");
    }
  };
  log(characters, true);
  log(props, false);
}

template <class T>
void World<T>::Impl::step_all(T step, const ParallelFor& parallel_for) {
  SINEW_ZONE("step");
  h = step;
  carry_who_leaps();
  couplings.begin_step(states);
  islands.find(states, couplings, h, settings.island_dofs, settings.body_contact ? plan.contacts : nullptr);
  large.clear();
  heavy.clear();
  light.clear();
  first_lagged.assign(1, 0);
  lagged_count.assign(islands.count(), 0);
  for (int i = 0; i < islands.count(); ++i) {
    SolveCapacity capacity;
    bool plays = true;
    for (const int n : islands.members(i)) {
      capacity += states[n]->problem.capacity;
      plays = plays && !states[n]->tied && states[n]->undisturbed() && !states[n]->pushed();
    }
    for (const int n : islands.ties(i)) capacity += couplings.capacity(n);
    (!capacity.fits(small_capacity) ? large : plays && capacity.trees == 1 ? light : heavy).push_back(i);
    first_lagged.push_back(first_lagged.back() + capacity.loaded);
  }
  SINEW_ASSERT(static_cast<std::size_t>(first_lagged.back()) <= lagged_new.capacity());
  lagged_new.resize(first_lagged.back());
  if (reporter) reporter->begin_step(islands.count());
  next_heavy = next_light = 0;
  parallel_for(static_cast<int>(workers.size()), work, this);
  keep_sleepers();
  for (int i = 0; i < islands.count(); ++i) {
    const auto begin = lagged_new.begin() + first_lagged[i];
    const auto room = static_cast<std::ptrdiff_t>(lagged.capacity() - lagged.size());
    lagged.insert(lagged.end(), begin, begin + std::min<std::ptrdiff_t>(lagged_count[i], room));
  }
  std::sort(lagged.begin(), lagged.end(),
            [](const LaggedForce<T>& a, const LaggedForce<T>& b) { return a.id < b.id; });
  if (reporter) report_contacts();
  controller.update(states, settings.detail, h, report);
  if (logs()) log_step();
}

template <class T>
Status World<T>::step(T h, const ParallelFor& parallel_for) {
  if (!std::isfinite(h)) return Status::error(Code::kNotFinite, "step is not finite");
  if (h <= T(0)) return Status::error(Code::kInvalidArgument, "step must be positive");
  if (h < T(1e-5)) return Status::error(Code::kOutOfRange, "step below 1e-5 s");
  if (h > T(0.25)) return Status::error(Code::kOutOfRange, "step above 0.25 s");
  const auto limited = [](const auto& s) { return s->limited && !s->parked; };
  if (!impl_->plan.joints.muscles && std::any_of(impl_->states.begin(), impl_->states.end(), limited))
    return Status::error(Code::kInvalidArgument, kNoMuscles);
  impl_->step_all(h, parallel_for);
  return {};
}

template <class T>
void World<T>::keep_with_state(std::span<std::byte> bytes) {
  impl_->games.push_back(bytes);
}

template <class T>
std::size_t World<T>::snapshot_capacity() const {
  return bytes_at_most(impl_->moving(), Content::kState);
}

template <class T>
std::size_t World<T>::save(std::span<std::byte> out) const {
  for (const auto& s : impl_->states) synchronise(*s, impl_->workers[0]->jets);
  return write_bytes(impl_->moving(), Content::kState, out);
}

template <class T>
Status World<T>::restore(std::span<const std::byte> snapshot) {
  return read_bytes(impl_->moving(), Content::kState, snapshot);
}

template <class T>
std::size_t World<T>::inputs_capacity() const {
  return bytes_at_most(impl_->moving(), Content::kInputs);
}

template <class T>
std::size_t World<T>::save_inputs(std::span<std::byte> out) const {
  return write_bytes(impl_->moving(), Content::kInputs, out);
}

template <class T>
Status World<T>::restore_inputs(std::span<const std::byte> inputs) {
  return read_bytes(impl_->moving(), Content::kInputs, inputs);
}

template <class T>
SnapshotField World<T>::snapshot_field(std::size_t byte) const {
  for (const auto& s : impl_->states) synchronise(*s, impl_->workers[0]->jets);
  return field_at(impl_->moving(), byte);
}

template class World<float>;
template class World<double>;

}  // namespace sinew
