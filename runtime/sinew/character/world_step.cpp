// What a world does with one island after the other, on any thread.
#include <algorithm>
#include <array>

#include "sinew/character/playback.h"
#include "sinew/character/sleep.h"
#include "sinew/character/world_impl.h"
#include "sinew/skeleton/hooks.h"

namespace sinew {
namespace {

constexpr std::size_t kFewestLanes = 4;  ///< of a batch: fewer are solved faster one by one

double now(const Budget& budget) {
  return budget.clock ? budget.clock(budget.clock_context) : 0;
}

/// Adds to those who wait for a batch. Returns one of those who fill a batch now, or the first where the list
/// is full; null where all have to wait.
template <class Entry>
const Entry* add_waiting(std::vector<Entry>& list, const Entry& entry, int lanes, std::size_t most) {
  SINEW_ASSERT(list.size() < list.capacity());
  list.push_back(entry);
  const auto alike = [&](const Entry& other) { return other.alike(entry); };
  if (std::count_if(list.begin(), list.end(), alike) == lanes) return &list.back();
  return list.size() == most ? &list.front() : nullptr;
}

/// Moves who is like `first` from a worker's list to `batch`; returns how many.
template <class Entry, std::size_t kMost>
std::size_t take_alike(std::vector<Entry>& from, const Entry first, std::array<Entry, kMost>& batch) {
  std::size_t count = 0;
  const auto taken = [&](const Entry& other) {
    if (!other.alike(first)) return false;
    batch[count++] = other;
    return true;
  };
  from.erase(std::remove_if(from.begin(), from.end(), taken), from.end());
  return count;
}

}  // namespace

/// The clip and nothing else for members whose detail allows no more. False, with nothing moved, where
/// somebody may be solved.
template <class T>
bool World<T>::Impl::follow_set(std::span<CharacterState<T>* const> members, Worker& worker) {
  const auto may_be_solved = [&](const CharacterState<T>* s) {
    return s->levels.allowed >= Level::kPartial && (members.size() == 1 || !s->is_carrier());
  };
  if (std::any_of(members.begin(), members.end(), may_be_solved)) return false;
  for (CharacterState<T>* s : members) {
    const bool checked = s->levels.allowed == Level::kChecked && s->undisturbed() &&
                         play(*s, h, context_of_check(*s, worker, ground_near(*s, worker)));
    if (!checked) follow(*s, settings, h);
    s->levels.did = checked ? Level::kChecked : Level::kPlayback;
  }
  return true;
}

/// For what is around somebody; nothing is of what gives way to nobody.
template <class T>
void World<T>::Impl::look_around(CharacterState<T>& s, Worker& worker) const {
  if (s.is_carrier())
    worker.nearby.clear();
  else if (plan.contacts)
    plan.contacts->look_around(s, settings, surroundings(), {worker.members, worker.indices, worker.touched},
                               h, worker.nearby);
}

/// Whether it is on its animation, and nothing is in the way of that.
template <class T>
bool World<T>::Impl::may_play(CharacterState<T>& s, Worker& worker) const {
  if (s.tied || !s.driven || !(s.undisturbed() || s.grounding.returns)) return false;
  look_around(s, worker);
  return !plan.contacts || !plan.contacts->is_in_the_way(s, worker.nearby);
}

/// Whether its muscles are asked in this step.
template <class T>
bool World<T>::Impl::checks(const CharacterState<T>& s) const {
  const auto every = static_cast<std::uint32_t>(s.detail.check_every);
  return s.levels.steps % every == 0 || s.pushed() || s.levels.level > Level::kChecked;
}

/// What it may stand on besides the floor, of what has been looked around for; null: nothing.
template <class T>
const GroundProbe<T>* World<T>::Impl::ground_met(CharacterState<T>& s, Worker& worker) const {
  return plan.contacts && plan.support ? plan.contacts->ground_under(s, worker.nearby) : nullptr;
}

/// The same of whom nobody has looked around for yet.
template <class T>
const GroundProbe<T>* World<T>::Impl::ground_near(CharacterState<T>& s, Worker& worker) const {
  look_around(s, worker);
  return ground_met(s, worker);
}

template <class T>
CheckContext<T> World<T>::Impl::context_of_check(const CharacterState<T>& s, Worker& worker,
                                                 const GroundProbe<T>* ground) const {
  return {settings, plan, ground,
          CheckScratch<T>{worker.check_scratch.data(), s.tree.bodies, s.tree.bodies,
                          static_cast<int>(s.rig->support.points.size())}};
}

/// Plays who may play. False, with nothing moved, where its muscles can't.
template <class T>
bool World<T>::Impl::play_alone(CharacterState<T>& s, Worker& worker) {
  const bool checked = checks(s);
  if (!checked) follow(s, settings, h);
  if (checked) {
    const CheckContext<T> context = context_of_check(s, worker, ground_met(s, worker));
    if (!play(s, h, context)) return false;
    if (context.ground)
      s.report.ground = plan.contacts->ground_that_moves(worker.nearby, context.scratch.standing);
  }
  s.levels.did = checked ? Level::kChecked : Level::kPlayback;
  return true;
}

/// Plays who is stepped together where that will do: one, what carries it aside. False, with nothing moved,
/// where they have to be solved.
template <class T>
bool World<T>::Impl::play_set(std::span<CharacterState<T>* const> members, Worker& worker) {
  if (follow_set(members, worker)) return true;
  CharacterState<T>* one = members[0];
  // With the speed that a solve makes of its targets' ways, for those whom it meets in the next.
  if (members.size() == 1 && one->is_carrier() && worker.members.size() > 1) return false;
  for (CharacterState<T>* s : members) {
    if (s == one || s->is_carrier()) continue;
    if (!one->is_carrier()) return false;
    one = s;
  }
  return may_play(*one, worker) && play_alone(*one, worker);
}

/// Plays one that only the ground holds, on props of its set that bear it, and loads them with that. False,
/// with nothing moved, where it has to be solved with them.
template <class T>
bool World<T>::Impl::play_on_props(CharacterState<T>& s, Worker& worker) {
  if (!s.grounded() || !plan.contacts || !plan.impulses || !may_play(s, worker)) return false;
  const GroundProbe<T>* ground = ground_met(s, worker);
  const CheckContext<T> context = context_of_check(s, worker, ground);
  if (!ground || !play(s, h, context)) return false;
  s.report.ground = plan.contacts->ground_that_moves(worker.nearby, context.scratch.standing);
  s.levels.did = Level::kChecked;
  plan.contacts->load_props(worker.nearby, context.scratch.bearing);
  return true;
}

/// Whether the check of who may play can be made in a batch.
template <class T>
bool World<T>::Impl::checks_in_batches(CharacterState<T>& s, Worker& worker) const {
  if constexpr (std::is_same_v<T, float>)
    return settings.batches && worker.checks && has_plain_check(s) && !s.grounded() && checks(s) &&
           !ground_met(s, worker);
  return false;
}

/// Puts an island of one aside, until there are others of its rig to fill a batch of checks with.
template <class T>
void World<T>::Impl::check_later(int island, Worker& worker, double spent) {
  CharacterState<T>* state = worker.members[0];
  const Unchecked last{island, state, stands<T>(*state, settings, plan, nullptr), spent};
  if (const Unchecked* full = add_waiting(worker.unchecked, last, worker.checks->lanes(), kMostWaiting))
    check_alike(worker, *full);
}

/// Checks who is like `one` in a batch, plays who can be, and goes on with the others.
template <class T>
void World<T>::Impl::check_alike(Worker& worker, const Unchecked& one) {
  SINEW_ZONE("check in a batch");
  std::array<Unchecked, BatchCheck::kMostLanes> batch;
  const std::size_t count = take_alike(worker.unchecked, one, batch);
  const double begin = now(settings.detail.budget);
  bool checked = false;
  if constexpr (std::is_same_v<T, float>)
    if (count >= kFewestLanes) {
      std::array<const JointJet<float>*, BatchCheck::kMostLanes> jets;
      std::array<float*, BatchCheck::kMostLanes> torque;
      for (std::size_t n = 0; n < count; ++n) {
        jets[n] = batch[n].state->target.data();
        torque[n] = batch[n].state->problem.gradient.data();
      }
      const Rig<float>& rig = *batch[0].state->rig;
      worker.checks->check({rig.tree, batch[0].stands ? &rig.support : nullptr,
                            settings.gravity.cast<float>(), float(settings.ground_height)},
                           std::span(jets.data(), count), std::span(torque.data(), count));
      checked = true;
    }
  const double share = (now(settings.detail.budget) - begin) / double(count);
  for (std::size_t n = 0; n < count; ++n) {
    const double again = now(settings.detail.budget);
    const Unchecked& u = batch[n];
    CharacterState<T>* state = u.state;
    const bool played = checked ? play_checked(*state, settings, h)
                                : play(*state, h, context_of_check(*state, worker, nullptr));
    const double spent = u.spent + share + now(settings.detail.budget) - again;
    worker.members.assign(1, state);
    worker.indices = islands.members(u.island);
    worker.touched = {};
    worker.ties.clear();
    if (!played) {
      solve_alone(u.island, worker, spent);
      continue;
    }
    state->levels.did = Level::kChecked;
    close_island(u.island, worker.members, worker.ties, spent);
  }
}

template <class T>
void World<T>::Impl::begin_solve(CharacterState<T>& s, Worker& worker) {
  const bool toned = s.problem.law.present.tone && !s.passive();
  s.set_leads(false);
  s.grounding.by_hand = false;
  if (s.grounding.has_hand) give_hand(s, context_of_check(s, worker, nullptr));
  if (!toned && !may_be_led(s)) return;
  const CheckContext<T> context = context_of_check(s, worker, ground_near(s, worker));
  if (toned) begin_tone(s, h, context);
  const bool alone =
      worker.touched.empty() && !s.tied && !(plan.contacts && plan.contacts->is_in_the_way(s, worker.nearby));
  if (alone && may_be_led(s)) lead_root(s, context);
}

/// Solves the island of worker.members[0].
template <class T>
void World<T>::Impl::solve_alone(int island, Worker& worker, double spent) {
  const double begin = now(settings.detail.budget);
  CharacterState<T>& s = *worker.members[0];
  synchronise(s, worker.jets);
  begin_solve(s, worker);
  log_contacts(island, worker);
  lagged_count[island] = worker.stepper.step(settings, surroundings(), h, worker.members,
                                             islands.members(island), worker.ties, lagged, lagged_of(island));
  s.levels.did = level_of(s);
  close_island(island, worker.members, worker.ties, spent + now(settings.detail.budget) - begin);
}

/// Steps who touches or is tied, in `spent` passes less than a step may take. Returns how many contact forces
/// it has written.
template <class T>
int World<T>::Impl::step_set(std::span<CharacterState<T>* const> members, std::span<const int> indices,
                             std::span<Coupling<T>* const> ties, int spent, Worker& worker,
                             std::span<LaggedForce<T>> lagged_out) {
  worker.touched = members;
  for (std::size_t n = 0; worker.log && n < members.size(); ++n)
    if (!members[n]->is_carrier()) worker.log->forget(indices[n]);
  if (play_set(members, worker)) return 0;
  const auto is_plain_prop = [](const CharacterState<T>* s) { return s->is_prop && !s->is_particles; };
  const auto are_particles = [](const CharacterState<T>* s) { return s->is_particles; };
  const bool on_props = std::any_of(members.begin(), members.end(), is_plain_prop) &&
                        std::none_of(members.begin(), members.end(), are_particles);
  worker.solved.clear();
  worker.solved_indices.clear();
  worker.first_load.clear();
  for (CharacterState<T>* s : members) worker.first_load.push_back(s->forces.size());
  for (std::size_t n = 0; n < members.size(); ++n) {
    if (on_props && play_on_props(*members[n], worker)) continue;
    worker.solved.push_back(members[n]);
    worker.solved_indices.push_back(indices[n]);
  }
  for (CharacterState<T>* s : worker.solved) {
    synchronise(*s, worker.jets);
    begin_solve(*s, worker);
  }
  const int count = worker.stepper.step(settings, surroundings(), h, worker.solved, worker.solved_indices,
                                        ties, lagged, lagged_out, spent);
  for (CharacterState<T>* s : worker.solved) s->levels.did = level_of(*s);
  for (std::size_t n = 0; n < members.size(); ++n) members[n]->forces.resize(worker.first_load[n]);
  return count;
}

template <class T>
void World<T>::Impl::step_island(int island, Worker& worker) {
  SINEW_ZONE("island");
  const double begin = now(settings.detail.budget);
  worker.members.clear();
  worker.ties.clear();
  for (const int n : islands.ties(island)) worker.ties.push_back(&couplings[n]);
  const std::span<const int> indices = islands.members(island);
  for (const int n : indices) worker.members.push_back(states[n].get());
  worker.indices = indices;
  worker.touched = {};
  for (CharacterState<T>* s : worker.members) s->levels.allowed = allowed_level(*s);
  log_contacts(island, worker);
  lagged_count[island] = 0;
  // Their ways are predicted by their histories, which must not depend on whether somebody has asked for
  // them.
  for (CharacterState<T>* s : worker.members)
    if (worker.members.size() > 1 && !s->undisturbed()) synchronise(*s, worker.jets);
  if (worker.members.size() == 1) {
    const auto spent = [&] { return now(settings.detail.budget) - begin; };
    CharacterState<T>& s = *worker.members[0];
    if (!follow_set(worker.members, worker)) {
      if (!may_play(s, worker)) return solve_alone(island, worker, spent());
      if (checks_in_batches(s, worker)) return check_later(island, worker, spent());
      if (!play_alone(s, worker)) return solve_alone(island, worker, spent());
    }
  } else if (worker.sets.begin(plan.contacts, worker.members, indices, worker.ties, lagged,
                               settings.gravity.template cast<T>(), h)) {
    const std::span<const LaggedForce<T>> forces = worker.sets.step_all(
        kept, [&](std::span<CharacterState<T>* const> members, std::span<const int> numbers,
                  std::span<Coupling<T>* const> ties, int spent, std::span<LaggedForce<T>> out) {
          return step_set(members, numbers, ties, spent, worker, out);
        });
    std::copy(forces.begin(), forces.end(), lagged_of(island).begin());
    lagged_count[island] = static_cast<int>(forces.size());
  } else {
    lagged_count[island] = step_set(worker.members, indices, worker.ties, 0, worker, lagged_of(island));
  }
  close_island(island, worker.members, worker.ties, now(settings.detail.budget) - begin);
}

/// What a step leaves behind. `spent`: on the island, by the budget's clock.
template <class T>
void World<T>::Impl::close_island(int island, std::span<CharacterState<T>* const> members,
                                  std::span<Coupling<T>* const> ties, double spent) {
  double work = 0;
  for (CharacterState<T>* s : members) work += s->levels.work = work_of(*s, s->levels.did);
  if (!settings.detail.budget.clock) spent = work;
  put_to_sleep<T>(members, islands.members(island), ties, settings.detail, h);
  for (CharacterState<T>* s : members) {
    s->levels.spent = work > 0 ? spent * s->levels.work / work : 0;
    // Between two checks it is at the level that checks it.
    const Level least = s->levels.asleep ? Level::kAsleep : std::min(s->levels.allowed, Level::kChecked);
    choose_level(*s, std::max(s->levels.did, least), h, settings.detail.dwell);
    s->report.level = s->levels.level;
    s->report.crowded = s->crowded;
    s->impulses.clear();
    s->forces.clear();
    s->target_stands = true;
    s->grounding.comes_back = s->grounding.rides = false;
    s->grounding.presses = std::numeric_limits<double>::max();
    if (std::exchange(s->grounding.has_hand, false)) s->refresh_limits();
    s->report.carried = s->carried;
  }
}

/// What one worker does of a step: islands, as long as there are any left. Which ones is a matter of chance,
/// and of no consequence: a worker's memory holds nothing from one island to the next.
template <class T>
void World<T>::Impl::work(void* context, int index) {
  Impl& world = *static_cast<Impl*>(context);
  Worker& worker = *world.workers[index];
  const int heavy = static_cast<int>(world.heavy.size()), light = static_cast<int>(world.light.size());
  if (index == 0)
    for (const int island : world.large) world.step_island(island, worker);
  for (int n; (n = world.next_heavy.fetch_add(1)) < heavy;) world.step_island(world.heavy[n], worker);
  constexpr int batch = 8;  // that are taken at once: playing takes about a microsecond
  for (int begin; (begin = world.next_light.fetch_add(batch)) < light;)
    for (int n = begin; n < std::min(begin + batch, light); ++n) world.step_island(world.light[n], worker);
  while (!worker.unchecked.empty()) world.check_alike(worker, worker.unchecked[0]);
}

/// Has the worker write the contacts of an island down, where somebody listens.
template <class T>
void World<T>::Impl::log_contacts(int island, Worker& worker) {
  const int first = first_lagged[island], most = first_lagged[island + 1] - first;
  worker.log = reporter ? reporter->open(worker.number, island, first, most) : nullptr;
  worker.stepper.write_contacts_to(worker.log);
}

/// What the host calls a body that touches.
template <class T>
BodyRef World<T>::Impl::name_of(const TouchingBody& body) const {
  if (body.tree < 0)
    return body.body < 0            ? BodyRef{}
           : body.body < kFirstHost ? BodyRef{BodyKind::kObstacle, body.body, 0}
                                    : BodyRef{BodyKind::kShape, body.body - kFirstHost, 0};
  const auto among = [&](const std::vector<int>& list) {
    const auto found = std::lower_bound(list.begin(), list.end(), body.tree);
    return found != list.end() && *found == body.tree ? static_cast<int>(found - list.begin()) : -1;
  };
  if (const int n = among(characters); n >= 0) return {BodyKind::kCharacter, n, body.body};
  if (const int n = among(props); n >= 0) return {BodyKind::kProp, n, 0};
  for (std::size_t n = 0; n < particles.size(); ++n) {
    if (particles[n].state != body.tree) continue;
    const std::vector<int>& bodies = particles[n].bodies;
    const auto node = std::find(bodies.begin(), bodies.end(), body.body) - bodies.begin();
    return {BodyKind::kParticles, static_cast<int>(n), static_cast<int>(node)};
  }
  return {};
}

template <class T>
void World<T>::Impl::report_contacts() {
  reporter->report(states, characters, islands, settings, first_lagged,
                   [this](const TouchingBody& body) { return name_of(body); });
}

/// Whether a prop or particles are tied to who has leapt, and to nobody who stays, nor the world.
template <class T>
bool World<T>::Impl::goes_along(int state) const {
  const CharacterState<T>& s = *states[state];
  if (!s.is_prop || s.carried || s.parked) return false;
  bool tied = false;
  for (const auto& coupling : couplings.all()) {
    const auto is_of = [&](const CouplingNode<T>& node) { return node.state == state; };
    if (!coupling->active || std::none_of(coupling->nodes.begin(), coupling->nodes.end(), is_of)) continue;
    for (const CouplingNode<T>& node : coupling->nodes) {
      const CharacterState<T>* other = node.state < 0 ? nullptr : states[node.state].get();
      if (!other || (!other->is_prop && !other->carried)) return false;
      tied = tied || other->carried;
    }
  }
  return tied;
}

/// Else a cape or a bag would be pulled through its owner at the speed of the leap.
template <class T>
void World<T>::Impl::take_along(const Leap& leap) {
  for (bool more = true; more;) {
    more = false;
    for (int n = 0; n < static_cast<int>(states.size()); ++n) {
      if (!goes_along(n)) continue;
      go_along(*states[n], leap);
      states[n]->carried = more = true;
    }
  }
}

template <class T>
void World<T>::Impl::carry_who_leaps() {
  for (const auto& s : states) {
    s->keep_deviations(h);
    s->carried = false;
  }
  for (const auto& s : states) {
    Leap leap;
    if (s->is_prop || s->parked || !carry_over(*s, h, leap)) continue;
    s->carried = true;
    take_along(leap);
  }
}

#define SINEW_STEP_INSTANCES(T)                                        \
  template void World<T>::Impl::step_island(int, Worker&);             \
  template void World<T>::Impl::report_contacts();                     \
  template void World<T>::Impl::carry_who_leaps();                     \
  template BodyRef World<T>::Impl::name_of(const TouchingBody&) const; \
  template void World<T>::Impl::work(void*, int);
SINEW_STEP_INSTANCES(float)
SINEW_STEP_INSTANCES(double)

}  // namespace sinew
