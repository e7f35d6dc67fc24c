#include "sinew/crowd/population.h"

#include <algorithm>

#include "sinew/animation/crossfade.h"
#include "sinew/animation/sampling_job.h"
#include "sinew/character/movers.h"
#include "sinew/character/neighbour_grid.h"

namespace sinew {
namespace {

constexpr float kMargin =
    0.3f;  ///< m of a human, beyond what two may move by, at which a neighbour is called into the world

}  // namespace

struct Population::Impl {
  std::unique_ptr<Crowd> crowd;
  std::unique_ptr<World<float>> world;
  int capacity = 0, joints = 0;
  float margin = 0;                  ///< m, see kMargin
  float radius = 0;                  ///< m, of a character about its root
  std::vector<int> place_of;         ///< [character] in the world, or −1
  std::vector<int> character_of;     ///< [place], or −1
  std::vector<int> free;             ///< places, the next one last
  std::vector<std::uint8_t> active;  ///< [character] plays something
  std::vector<JointJet<float>> jets;
  NeighbourGrid grid;                ///< of those on their clips
  std::vector<std::uint8_t> called;  ///< [character] into the world, by who is near
  int turned_away = 0;

  bool enter(int character, double h);
  void leave(int place);
  void call_neighbours(double h);
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
  for (const Transform<float>& t : impl->world->character(0).model())
    impl->radius =
        std::max(impl->radius, (t.translation - impl->world->character(0).model()[0].translation).norm());
  impl->place_of.assign(crowd.capacity, -1);
  impl->active.assign(crowd.capacity, 0);
  impl->character_of.assign(settings.places, -1);
  for (int n = settings.places; n-- > 0;) impl->free.push_back(n);
  impl->jets.resize(skeleton.joints.size());
  impl->grid.reserve(crowd.capacity);
  impl->called.assign(crowd.capacity, 0);
  for (int n = 0; n < crowd.capacity; ++n) {
    (void)impl->crowd->set_active(n, false);
    (void)impl->crowd->set_strength(n, static_cast<float>(settings.character.strength));
  }
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
    grid.add(c, crowd->model(c)[0].translation.cast<double>(), double(radius) + moves);
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

}  // namespace sinew
