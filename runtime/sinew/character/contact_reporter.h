// Makes events of what a step's solves have logged of contacts (contact_events.h). Internal to the character
// layer; a world has one only while somebody listens.
#pragma once

#include <algorithm>
#include <memory>
#include <span>
#include <vector>

#include "sinew/character/contact_events.h"
#include "sinew/character/contact_log.h"
#include "sinew/character/islands.h"

namespace sinew {

template <class T>
class ContactReporter {
 public:
  ContactReporter(ContactRing& ring, const ContactReportSettings& settings, std::size_t workers)
      : ring_(&ring), settings_(settings), logs_(workers) {}
  /// For so many contacts that solves may log, islands, and colliders of all.
  void reserve(int contacts, int islands, int colliders);
  std::size_t bytes() const;

  void begin_step(int islands) { counts_.assign(static_cast<std::size_t>(islands), 0); }
  /// A worker's, to write an island's contacts to, of which there are at most `most`, `first` after all those
  /// of the islands before: each has its own part of the memory, so that no worker waits for another.
  ContactLog<T>* open(std::size_t worker, int island, int first, int most) {
    logs_[worker].begin(
        std::span(contacts_).subspan(static_cast<std::size_t>(first), static_cast<std::size_t>(most)),
        counts_[static_cast<std::size_t>(island)]);
    return &logs_[worker];
  }
  /// After the step: adds what animations set on the ground, and tells how pairs have changed. `first`
  /// [island]: as open() was told; `name`(TouchingBody): what the host calls it.
  template <class Name>
  void report(std::span<const std::unique_ptr<CharacterState<T>>> states, std::span<const int> characters,
              const Islands<T>& islands, const WorldSettings& world, std::span<const int> first,
              const Name& name);
  /// Those of the last step, by pairs.
  std::span<const LoggedContact<T>> contacts() const { return std::span(contacts_).first(count_); }

 private:
  void gather(std::span<const int> first);
  void add_animated(CharacterState<T>& state, int n, const WorldSettings& world);
  bool touches_still(const TouchingPair& pair,
                     std::span<const std::unique_ptr<CharacterState<T>>> states) const;
  template <class Name>
  void tell(ContactPhase phase, const TouchingPair& pair, std::span<LoggedContact<T>> points,
            const Name& name);

  ContactRing* ring_;
  ContactReportSettings settings_;
  std::vector<ContactLog<T>> logs_;               ///< [worker]
  std::vector<LoggedContact<T>> contacts_;        ///< of one island after the other, then by pairs
  std::size_t count_ = 0;                         ///< of these, after the step
  std::vector<int> counts_;                       ///< [island]
  std::vector<TouchingPair> touching_, touched_;  ///< after this step and the last one, in order
};

/// What two bodies' contacts make of an event, all but their names.
template <class T>
void fill_event(std::span<LoggedContact<T>> points, ContactEvent& out);

template <class T>
template <class Name>
void ContactReporter<T>::tell(ContactPhase phase, const TouchingPair& pair,
                              std::span<LoggedContact<T>> points, const Name& name) {
  const bool wanted = phase == ContactPhase::kBegin  ? settings_.begin
                      : phase == ContactPhase::kStay ? settings_.stay
                                                     : settings_.end;
  if (!wanted) return;
  ContactEvent event;
  event.phase = phase;
  event.a = name(pair.a);
  event.b = name(pair.b);
  fill_event<T>(points, event);
  ring_->put(event);
}

template <class T>
template <class Name>
void ContactReporter<T>::report(std::span<const std::unique_ptr<CharacterState<T>>> states,
                                std::span<const int> characters, const Islands<T>& islands,
                                const WorldSettings& world, std::span<const int> first, const Name& name) {
  gather(first);
  for (const int n : characters)
    if (settings_.animated && world.ground && islands.contains(n)) add_animated(*states[n], n, world);
  const std::span<LoggedContact<T>> found = std::span(contacts_).first(count_);
  std::sort(found.begin(), found.end(), [](const LoggedContact<T>& a, const LoggedContact<T>& b) {
    return a.pair != b.pair ? a.pair < b.pair : a.id < b.id;
  });
  touching_.swap(touched_);
  touching_.clear();
  auto before = touched_.begin();
  const auto leave_until = [&](const TouchingPair* next) {
    for (; before != touched_.end() && (!next || *before < *next); ++before) {
      if (touches_still(*before, states) && touching_.size() < touching_.capacity())
        touching_.push_back(*before);
      else
        tell(ContactPhase::kEnd, *before, {}, name);
    }
  };
  for (auto point = found.begin(); point != found.end();) {
    const TouchingPair pair = point->pair;
    const auto end =
        std::find_if(point, found.end(), [&](const LoggedContact<T>& other) { return other.pair != pair; });
    leave_until(&pair);
    const bool touched = before != touched_.end() && *before == pair;
    if (touched) ++before;
    if (touching_.size() < touching_.capacity()) touching_.push_back(pair);
    tell(touched ? ContactPhase::kStay : ContactPhase::kBegin, pair, std::span(point, end), name);
    point = end;
  }
  leave_until(nullptr);
}

extern template class ContactReporter<float>;
extern template class ContactReporter<double>;

}  // namespace sinew
