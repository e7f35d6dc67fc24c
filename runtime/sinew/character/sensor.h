// Places that tell who comes in and who leaves: doors, traps, checkpoints, things to pick up.
//
//     Sensor<float> door(16);
//     door.shape.from = {4, 0, 1};
//     door.shape.radius = 0.8;                             // m
//     …each frame:
//     world.step(1 / 60.f);
//     Status status = door.update(world);
//     for (const SensorEvent& event : door.events())
//       if (event.phase == ContactPhase::kBegin) open(event.body);
//
// A sensor is the host's own: nothing collides with it, a world does not know of it, and a step does nothing
// for it. It looks when it is asked, by the same distances as overlap(), so it may move, grow or change its
// filter between two updates. Copies are snapshots. After World::restore() the next update tells what has
// changed since the last one.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "sinew/character/contact_events.h"
#include "sinew/character/queries.h"

namespace sinew {

/// Who has come in or left.
struct SensorEvent {
  ContactPhase phase = ContactPhase::kBegin;  ///< kBegin: is in it now; kEnd: is not any more
  BodyRef body;                               ///< `joint` is 0: a character is in it by any of its colliders

  /// Every member is the same.
  bool operator==(const SensorEvent&) const = default;
};

/// Set-up makes it; what is parked is in none, what sleeps stays. Never throws or allocates afterwards.
template <class T>
class Sensor {
 public:
  /// For so many bodies in it at once. It looks for characters, props and particles alone, until its filter
  /// says otherwise.
  explicit Sensor(std::size_t bodies);

  Cast shape;  ///< a ball or a capsule, and whom it looks for; `motion` does not count

  /// Looks who is in it. An error is overlap()'s, and nothing has changed then. O(characters + props +
  /// obstacles near).
  Status update(const World<T>& world);
  /// Who is in it since the last update, in the order of kinds and indices.
  std::span<const BodyRef> bodies() const { return inside_; }
  /// Of the last update: those who left, then those who came.
  std::span<const SensorEvent> events() const { return events_; }
  /// Bodies that the last update found no room for: they are not in it.
  int left_out() const { return left_out_; }

 private:
  void take(const BodyRef& body);

  std::size_t capacity_;
  std::vector<BodyRef> inside_, found_;  ///< sorted
  std::vector<SensorEvent> events_;
  int left_out_ = 0;
  BodyRef last_left_;  ///< of those
};

extern template class Sensor<float>;
extern template class Sensor<double>;

}  // namespace sinew
