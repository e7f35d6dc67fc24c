// Who touches whom: events of pairs of bodies, for sounds, damage, footprints and scores.
//
//     std::vector<ContactEvent> room(256);
//     ContactRing ring(room);
//     report_contacts(world, &ring);                       // set-up
//     …each frame:
//     world.step(1 / 60.f);
//     for (ContactEvent event; ring.take(event);)
//       if (event.phase == ContactPhase::kBegin) thud(event.a, event.impulse);
//
// A pair is two bodies: a simulated joint of a character, a prop or a particle, and another one or something
// static. It touches in a step that leaves a force between the two, or in which one has struck the other, or
// one is still inside the other (as what was put there is, on its way out, and what was frozen by a solve
// that found no pose). Each pair begins once and ends once: what sleeps keeps its pairs without a word and
// goes on with them when it wakes. What is parked ends its pairs. Two that are let through each other, since
// neither finds a way out of the other (CharacterReport::frozen), have ended theirs.
//
// A played character has no contacts: nothing is solved, so nothing presses. What its animation sets on the
// ground is told all the same (ContactReportSettings::animated), without an impulse and with `solved` false:
// by how near to the floor the colliders of bodies are that no unknown moves. So a foot that a blow takes off
// its clip goes on in the same pair. Whatever else comes near a played character is solved with it.
//
// Events come in the order of the bodies: characters, props and particles in the order in which they were
// added, then their joints, then the other body. They are the same to the bit for any number of workers.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "sinew/character/body_ref.h"
#include "sinew/skeleton/status.h"
#include "sinew/skeleton/vector.h"

namespace sinew {

template <class T>
class World;

/// Whether a pair of bodies has come together, stays so, or has parted.
enum class ContactPhase : std::uint8_t {
  kBegin,  ///< they did not touch after the last step
  kStay,   ///< they touched after the last step, and do after this one
  kEnd,    ///< they touched after the last step, not after this one: no points, no impulse
};

/// A point at which two bodies touch.
struct TouchPoint {
  Vec3<double> position = Vec3<double>::Zero();  ///< m, world, on the surface of `a`, at the end of the step
  Vec3<double> normal = Vec3<double>::UnitZ();   ///< unit, from `b` to `a`
  Vec3<double> friction = Vec3<double>::Zero();  ///< N, on `a`, world, at the end of the step
  double impulse = 0;                            ///< N·s along the normal, over the step, ≥ 0
  double force = 0;                              ///< N along the normal, at the end of the step, ≥ 0
  double depth = 0;                              ///< m, how far they are in each other; ≥ 0
};

/// What one step did to one pair of bodies.
struct ContactEvent {
  static constexpr int kMostPoints = 4;  ///< that an event carries

  ContactPhase phase = ContactPhase::kBegin;  ///< a pair begins once, and ends once
  bool solved = true;  ///< false: the animation leads `a` on to the ground; there are no impulses
  BodyRef a;           ///< a character's, a prop's or a particle
  BodyRef b;           ///< the other one; what is static is always `b`
  double impulse = 0;  ///< N·s along the normals, over the step, of all points
  Vec3<double> normal = Vec3<double>::UnitZ();  ///< unit, from `b` to `a`: mean, weighted by impulse
  int points = 0;                               ///< at which they touch
  int kept = 0;                                 ///< of these, in `point`
  std::array<TouchPoint, kMostPoints> point;    ///< those of the largest impulses, largest first
};

/// Events on their way from a world to its host, in memory of the host's. The world writes within
/// World::step, from the thread that calls it; the host reads between steps. Never allocates.
class ContactRing {
 public:
  /// Not copied: the memory must outlive the ring, and the ring the reports.
  explicit ContactRing(std::span<ContactEvent> room) : buffer_(room) {}

  std::size_t size() const { return size_; }  ///< events that wait to be taken
  /// Events that found the ring full, since it was made; the first ones are kept.
  std::uint64_t dropped() const { return dropped_; }
  /// The oldest event; false where there is none.
  bool take(ContactEvent& out);
  /// Drops what waits; dropped() does not count it.
  void clear() { size_ = 0; }
  /// What the world calls: appends an event, or counts it as dropped where the ring is full.
  void put(const ContactEvent& event);

 private:
  std::span<ContactEvent> buffer_;
  std::size_t first_ = 0, size_ = 0;
  std::uint64_t dropped_ = 0;
};

/// Which events a host wants.
struct ContactReportSettings {
  bool begin = true;     ///< ContactPhase::kBegin
  bool stay = false;     ///< ContactPhase::kStay: one for each pair and step
  bool end = true;       ///< ContactPhase::kEnd
  bool animated = true;  ///< what a clip sets on the ground, too
  /// m of a figure of human size: colliders that an animation leads nearer to the ground than that touch it.
  double animated_reach = 0.01;
};

/// Set-up: has every step of a world write its events into `ring`, or, with null, none any more. Pairs that
/// touch already begin with the next step. Refused in a world without Contacts, and where memory_cap leaves
/// no room (some 100 bytes for every contact that the world has room for). After World::restore() events go
/// on from what was told last. A world that reports to nobody does nothing for it in its steps.
template <class T>
[[nodiscard]] Status report_contacts(World<T>& world, ContactRing* ring,
                                     const ContactReportSettings& settings = {});

/// @cond
extern template Status report_contacts<float>(World<float>&, ContactRing*, const ContactReportSettings&);
extern template Status report_contacts<double>(World<double>&, ContactRing*, const ContactReportSettings&);
/// @endcond

}  // namespace sinew
