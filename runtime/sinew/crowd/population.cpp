#include "sinew/crowd/population.h"

#include <algorithm>

#include "sinew/animation/crossfade.h"
#include "sinew/animation/sampling_job.h"
#include "sinew/character/movers.h"
#include "sinew/character/neighbour_grid.h"
#include "sinew/crowd/roll.h"

namespace sinew {
namespace {

constexpr float kMargin =
    0.3f;  ///< m of a human, beyond what two may move by, at which a neighbour is called into the world

}  // namespace

struct Population::Impl {
  std::unique_ptr<Crowd> crowd;
  std::unique_ptr<World<float>> world;
  int capacity = 0, joints = 0;
  float strength = 1;                ///< of who has just been added
  float margin = 0;                  ///< m, see kMargin
  double radius = 0;                 ///< m, of a character about its root
  std::vector<int> place_of;         ///< [character] in the world, or −1
  std::vector<int> character_of;     ///< [place], or −1
  std::vector<int> free;             ///< places, the next one last
  std::vector<std::uint8_t> active;  ///< [character] plays something
  std::vector<JointJet<float>> jets;
  NeighbourGrid grid;                ///< of those on their clips
  std::vector<std::uint8_t> called;  ///< [character] into the world, by who is near
  int turned_away = 0;
  Roll roll;  ///< room for save() and restore()

  bool enter(int character, double h);
  void leave(int place);
  void call_neighbours(double h);
  void stop(int character);
  Status call_roll(std::span<const Clip> clips);
  void follow_roll(std::span<const Clip> clips);
  std::size_t roll_size() const { return roll_bytes(place_of.size(), character_of.size()); }
};

Population::Population(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
Population::~Population() = default;

std::unique_ptr<Population> Population::create(const Skeleton& skeleton, const PopulationSettings& settings,
                                               Status& status) {
  if (settings.places < 1 || settings.places > settings.crowd.capacity) {
    status = Status::error(Code::kInvalidArgument, "places are not within 1 and the crowd's capacity");
    return nullptr;
  }
  auto impl = std::make_unique<Impl>();
  CrowdSettings crowd = settings.crowd;
  crowd.gravity = settings.world.gravity;
  crowd.ground = settings.world.ground && settings.character.ground_contact;
  crowd.ground_height = settings.world.ground_height;
  crowd.model_poses = true;
  impl->crowd = Crowd::create(skeleton, crowd, status);
  if (!impl->crowd) return nullptr;
  impl->world = std::make_unique<World<float>>(settings.world);
  for (int n = 0; n < settings.places; ++n) {
    if (impl->world->add_character(skeleton, settings.character, status) < 0) return nullptr;
    (void)impl->world->park_character(n);
  }
  impl->capacity = crowd.capacity;
  impl->joints = static_cast<int>(skeleton.joints.size());
  impl->margin = kMargin * static_cast<float>(scale_of(skeleton).length);
  impl->radius = reach_of(*impl->world, 0);
  impl->place_of.assign(crowd.capacity, -1);
  impl->active.assign(crowd.capacity, 0);
  impl->character_of.assign(settings.places, -1);
  for (int n = settings.places; n-- > 0;) impl->free.push_back(n);
  impl->jets.resize(skeleton.joints.size());
  impl->grid.reserve(crowd.capacity);
  impl->called.assign(crowd.capacity, 0);
  impl->strength = static_cast<float>(settings.character.strength);
  impl->roll.entries.resize(std::size_t(crowd.capacity));
  impl->roll.free.reserve(std::size_t(settings.places));
  impl->roll.taken.reserve(std::size_t(settings.places));
  for (int n = 0; n < crowd.capacity; ++n) impl->stop(n);
  return std::unique_ptr<Population>(new Population(std::move(impl)));
}

/// Into the world, as the clip was `h` seconds ago. False where there is no place.
bool Population::Impl::enter(int character, double h) {
  if (place_of[character] >= 0) return true;
  if (free.empty()) {
    ++turned_away;
    return false;
  }
  const CrowdTrack& track = crowd->track(character);
  (void)SamplingJob<float>{track.clip, track.time.after(-h), jets}.Run();
  place_root(track.place, jets[0]);
  const int place = free.back();
  if (!world->character(place).set_target(jets)) return false;
  free.pop_back();
  place_of[character] = place;
  character_of[place] = character;
  Character<float> entering = world->character(place);
  if (entering.strength() != crowd->strength(character))
    (void)entering.set_strength(crowd->strength(character));
  (void)world->unpark_character(place);
  return true;
}

void Population::Impl::leave(int place) {
  (void)world->park_character(place);
  place_of[character_of[place]] = -1;
  character_of[place] = -1;
  free.push_back(place);
}

/// Whoever one of those that move by themselves, props included, may touch within h seconds.
void Population::Impl::call_neighbours(double h) {
  const int members = member_count(*world);
  MovingBall mover;
  const auto next_mover = [&](int from) {
    while (from < members && !moves_by_itself(*world, from, float(h), mover)) ++from;
    return from;
  };
  int n = next_mover(0);
  if (n == members) return;
  grid.clear();
  for (int c = 0; c < capacity; ++c) {
    called[c] = 0;
    if (!active[c] || place_of[c] >= 0) continue;
    const double moves = h * double(crowd->root_velocity(c).norm());
    grid.add(c, crowd->model(c)[0].translation.cast<double>(), radius + moves);
  }
  grid.build();
  for (; n < members; n = next_mover(n + 1))
    grid.overlapping(mover.center, mover.radius + double(margin), [&](int c) { called[c] = 1; });
  for (int c = 0; c < capacity; ++c)
    if (called[c] != 0) (void)enter(c, h);
}

Status Population::play(int character, const CrowdTrack& track) {
  Impl& impl = *impl_;
  if (!track.clip) return Status::error(Code::kInvalidArgument, "a population plays clips", character);
  if (Status status = impl.crowd->play(character, track); !status) return status;
  if (impl.place_of[character] >= 0) impl.leave(impl.place_of[character]);
  impl.active[character] = 1;
  return {};
}

void Population::Impl::stop(int character) {
  if (place_of[character] >= 0) leave(place_of[character]);
  (void)crowd->stop(character);
  (void)crowd->set_strength(character, strength);
  active[character] = 0;
}

Status Population::stop(int character) {
  if (character < 0 || character >= impl_->capacity)
    return Status::error(Code::kInvalidArgument, "no such character", character);
  impl_->stop(character);
  return {};
}

Status Population::set_strength(int character, float strength) {
  if (Status status = impl_->crowd->set_strength(character, strength); !status) return status;
  const int place = impl_->place_of[character];
  return place >= 0 ? impl_->world->character(place).set_strength(strength) : Status{};
}

Status Population::push(int character, int joint, const Vec3<float>& impulse) {
  Impl& impl = *impl_;
  if (character < 0 || character >= impl.capacity || !impl.active[character])
    return Status::error(Code::kInvalidArgument, "no such character", character);
  if (joint < 0 || joint >= impl.joints) return Status::error(Code::kInvalidArgument, "no such joint", joint);
  // The crowd has not moved on yet: its clip is now where the next step begins.
  if (!impl.enter(character, 0)) return Status::error(Code::kOutOfRange, "the world is full", character);
  Character<float> c = impl.world->character(impl.place_of[character]);
  return c.apply_impulse(joint, c.model()[joint].translation, impulse);
}

Status Population::step(float h, const ParallelFor& parallel_for) {
  Impl& impl = *impl_;
  if (!(h >= 1e-5f && h <= 0.25f))
    return Status::error(Code::kOutOfRange, "step is not within 1e-5 and 0.25 s");
  impl.turned_away = 0;
  (void)impl.crowd->step(double(h), parallel_for);
  for (const int n : impl.crowd->overloaded()) (void)impl.enter(n, double(h));
  impl.call_neighbours(double(h));
  for (std::size_t place = 0; place < impl.character_of.size(); ++place)
    if (const int n = impl.character_of[place]; n >= 0)
      (void)impl.world->character(static_cast<int>(place)).set_target(impl.crowd->jets(n));
  if (Status status = impl.world->step(h, parallel_for); !status) return status;
  for (std::size_t place = 0; place < impl.character_of.size(); ++place) {
    if (impl.character_of[place] < 0) continue;
    const Character<float> c = impl.world->character(static_cast<int>(place));
    if (c.on_animation() && c.report().level <= Level::kChecked) impl.leave(static_cast<int>(place));
  }
  return {};
}

/// Everybody into `roll`.
Status Population::Impl::call_roll(std::span<const Clip> clips) {
  for (int n = 0; n < capacity; ++n) {
    RollEntry& entry = roll.entries[std::size_t(n)];
    entry = {};
    entry.strength = crowd->strength(n);
    entry.world = place_of[n];
    if (active[n] == 0) continue;
    const CrowdTrack& track = crowd->track(n);
    const auto found =
        std::find_if(clips.begin(), clips.end(), [&](const Clip& c) { return &c == track.clip; });
    if (found == clips.end()) return Status::error(Code::kInvalidArgument, "it plays another clip", n);
    entry.clip = static_cast<std::int32_t>(found - clips.begin());
    entry.time = track.time.value;
    entry.rate = track.time.rate;
    entry.change = track.time.acceleration;
    std::copy_n(track.place.rotation.coeffs().data(), 4, entry.place);
    std::copy_n(track.place.translation.data(), 3, entry.place + 4);
  }
  roll.free.assign(free.begin(), free.end());
  roll.turned_away = turned_away;
  return {};
}

/// As `roll`, which has been checked, has it. The world has been restored.
void Population::Impl::follow_roll(std::span<const Clip> clips) {
  std::fill(character_of.begin(), character_of.end(), -1);
  for (int n = 0; n < capacity; ++n) {
    const RollEntry& entry = roll.entries[std::size_t(n)];
    place_of[n] = entry.world;
    if (entry.world >= 0) character_of[std::size_t(entry.world)] = n;
    active[n] = entry.clip >= 0;
    if (active[n] != 0) {
      CrowdTrack track{&clips[std::size_t(entry.clip)], {entry.time, entry.rate, entry.change}, {}};
      std::copy_n(entry.place, 4, track.place.rotation.coeffs().data());
      std::copy_n(entry.place + 4, 3, track.place.translation.data());
      (void)crowd->play(n, track);
    } else {
      (void)crowd->stop(n);
    }
    (void)crowd->set_strength(n, entry.strength);
  }
  free.assign(roll.free.begin(), roll.free.end());
  turned_away = roll.turned_away;
  (void)crowd->step(0);  // poses
}

std::size_t Population::snapshot_capacity() const {
  return impl_->roll_size() + impl_->world->snapshot_capacity();
}

Status Population::save(std::span<const Clip> clips, std::span<std::byte> out, std::size_t& written) {
  written = 0;
  const std::size_t roll = impl_->roll_size();
  if (Status status = impl_->call_roll(clips); !status) return status;
  const std::size_t world = out.size() > roll ? impl_->world->save(out.subspan(roll)) : 0;
  if (world == 0) return Status::error(Code::kOutOfRange, "no room for the snapshot");
  write_roll(impl_->roll, impl_->character_of.size(), out.first(roll));
  written = roll + world;
  return {};
}

Status Population::restore(std::span<const Clip> clips, std::span<const std::byte> snapshot) {
  const std::size_t roll = std::min(impl_->roll_size(), snapshot.size());
  Status status = read_roll(snapshot.first(roll), impl_->character_of.size(), clips.size(), impl_->roll);
  const auto fits = [&](const RollEntry& entry) {
    return entry.clip < 0 || clips[std::size_t(entry.clip)].joint_count == impl_->joints;
  };
  if (status && !std::all_of(impl_->roll.entries.begin(), impl_->roll.entries.end(), fits))
    status = Status::error(Code::kInvalidArgument, "clip has another number of joints than the rig");
  if (status) status = impl_->world->restore(snapshot.subspan(roll));
  if (status) impl_->follow_roll(clips);
  return status;
}

std::span<const Transform<float>> Population::model(int character) const {
  const int place = impl_->place_of[character];
  return place < 0 ? impl_->crowd->model(character) : impl_->world->character(place).model();
}

Level Population::level(int character) const {
  const int place = impl_->place_of[character];
  return place < 0 ? Level::kChecked : impl_->world->character(place).report().level;
}

bool Population::in_world(int character) const {
  return impl_->place_of[character] >= 0;
}

int Population::place(int character) const {
  return impl_->place_of[character];
}

Character<float> Population::solved(int character) {
  return impl_->world->character(impl_->place_of[character]);
}

int Population::solved_count() const {
  return static_cast<int>(impl_->character_of.size() - impl_->free.size());
}

int Population::turned_away() const {
  return impl_->turned_away;
}

World<float>& Population::world() {
  return *impl_->world;
}

Crowd& Population::crowd() {
  return *impl_->crowd;
}

int Population::capacity() const {
  return impl_->capacity;
}

}  // namespace sinew
