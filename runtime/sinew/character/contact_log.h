// What the solves of one island have found of contacts in a step, for whoever listens (contact_events.h).
// Internal to the character layer.
//
// A step may be taken in parts, a part may be solved again from where it began, and a set of trees may be
// stepped again together with another: what is written here is of the parts that stand.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>

#include "sinew/skeleton/vector.h"

namespace sinew {

/// One of two bodies that touch, by its tree's number in the world; of what is static the tree is −1, and the
/// body −1 the ground, else the number of contact identities.
struct TouchingBody {
  int tree = -1, body = -1;

  bool operator==(const TouchingBody&) const = default;
  bool operator<(const TouchingBody& o) const { return tree != o.tree ? tree < o.tree : body < o.body; }
};

/// A pair of bodies, `a` the one that comes first; static ones always second.
struct TouchingPair {
  TouchingBody a, b;

  bool operator==(const TouchingPair&) const = default;
  bool operator<(const TouchingPair& o) const { return a == o.a ? b < o.b : a < o.a; }
};

/// A point at which they touch.
template <class T>
struct LoggedContact {
  TouchingPair pair;
  std::uint64_t id = 0;                       ///< see Contact; 0: no solve has found it
  Vec3<double> point = Vec3<double>::Zero();  ///< m, world
  Vec3<T> normal = Vec3<T>::UnitZ();          ///< from b to a
  Vec3<T> friction = Vec3<T>::Zero();         ///< N on a, at the end
  T impulse = T(0);                           ///< N·s along the normal, over the step
  T force = T(0), depth = T(0);               ///< N, m at the end
};

/// One worker's, of one island after the other: each has a part of the memory of all.
template <class T>
class ContactLog {
 public:
  /// For an island's contacts, into `room`; how many there are stands in `count` all the time.
  void begin(std::span<LoggedContact<T>> room, int& count) {
    buffer_ = room;
    count_ = &count;
    count = 0;
    end_part();
  }

  /// Adds what a part of the step has found; of a contact that is known by its identity, to what the parts
  /// before have. Drops what there is no memory for, as the step does (see lagged forces).
  void add(const LoggedContact<T>& found) {
    LoggedContact<T>* const known = find(found.id);
    if (!known && *count_ == static_cast<int>(buffer_.size())) return;
    const T impulse = known ? known->impulse : T(0);
    LoggedContact<T>& to = known ? *known : buffer_[static_cast<std::size_t>((*count_)++)];
    to = found;
    to.impulse += impulse;
  }
  /// All of the part is written.
  void end_part() {
    strikes_ = pushes_ = next_ = 0;
    known_ = *count_;
  }
  /// Drops what has been written of a tree: it is to be stepped again.
  void forget(int tree) {
    const auto its = [tree](const LoggedContact<T>& c) {
      return c.pair.a.tree == tree || c.pair.b.tree == tree;
    };
    const auto all = buffer_.first(static_cast<std::size_t>(*count_));
    *count_ = static_cast<int>(std::remove_if(all.begin(), all.end(), its) - all.begin());
    end_part();
  }

  /// A contact that has struck before the part's solve, by its impulse.
  void strike(const LoggedContact<T>& found) {
    if (strikes_ < kMost) struck_[static_cast<std::size_t>(strikes_++)] = found;
  }
  /// The part is solved from before it struck.
  void take_back_strikes() { strikes_ = 0; }
  std::span<const LoggedContact<T>> strikes() const {
    return std::span(struck_).first(static_cast<std::size_t>(strikes_));
  }
  /// An impulse (N·s) that keeps a contact from closing at the end of the part.
  void push(std::uint64_t id, T impulse) {
    if (pushes_ < kMost) pushed_[static_cast<std::size_t>(pushes_++)] = {id, impulse};
  }
  /// N·s of strike() and push() on a contact.
  T struck(std::uint64_t id) const {
    T sum = T(0);
    for (const LoggedContact<T>& c : strikes()) sum += c.id == id ? c.impulse : T(0);
    for (const Push& p : std::span(pushed_).first(static_cast<std::size_t>(pushes_)))
      sum += p.id == id ? p.impulse : T(0);
    return sum;
  }

 private:
  static constexpr int kMost = 64;  ///< EndVelocities pushes no more at a time
  struct Push {
    std::uint64_t id = 0;
    T impulse = T(0);
  };

  /// Of what parts before have written, or null. Mostly it comes in the same order.
  LoggedContact<T>* find(std::uint64_t id) {
    for (int n = 0; n < known_; ++n) {
      const int at = next_ + n < known_ ? next_ + n : next_ + n - known_;
      if (buffer_[static_cast<std::size_t>(at)].id != id) continue;
      next_ = at + 1 < known_ ? at + 1 : 0;
      return &buffer_[static_cast<std::size_t>(at)];
    }
    return nullptr;
  }

  std::span<LoggedContact<T>> buffer_;
  int* count_ = nullptr;
  int known_ = 0, next_ = 0;  ///< written by parts before; where find() begins
  int strikes_ = 0, pushes_ = 0;
  std::array<LoggedContact<T>, kMost> struck_;
  std::array<Push, kMost> pushed_;
};

}  // namespace sinew
