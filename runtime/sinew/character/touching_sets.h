// Members of an island by who touches whom: an island is who *may* touch within a step, found before it; who
// does shows in the step. Internal to the character layer.
#pragma once

#include <algorithm>
#include <span>
#include <vector>

#include "sinew/character/contact_finder.h"
#include "sinew/character/kept_step.h"
#include "sinew/character/touching.h"

namespace sinew {

/// Every set of an island's members is stepped by itself, as if the others were not there. Where colliders of
/// two sets have touched on their ways, both steps are taken back, and the two are stepped together; so on
/// until nobody touches anybody of another set. Sets begin with those who are tied together, and those who
/// bore on each other at the end of the last step. So whoever is only near has the bits that it has alone.
template <class T>
class TouchingSets {
 public:
  void reserve(const SolveRoom& room);
  std::size_t bytes(const SolveRoom& room) const;

  /// An island's members (ascending by their numbers in the world, `indices`), what ties them, and the
  /// world's contact forces of the last step, sorted by id. False where all are in one set from the
  /// beginning.
  bool begin(std::span<CharacterState<T>* const> states, std::span<const int> indices,
             std::span<Coupling<T>* const> ties, std::span<const LaggedForce<T>> lagged);

  /// Steps all. `kept` [world's number]; step(states, indices, ties, lagged_out) steps one set and returns
  /// how many forces it has written. Returns all of them, of every set.
  template <class Step>
  std::span<const LaggedForce<T>> step_all(const ContactTerm<T>& contacts, std::span<KeptStep<T>> kept,
                                           const Step& step);

 private:
  int set_of(int member) {
    while (set_[member] != member) member = set_[member] = set_[set_[member]];
    return member;
  }
  void unite(int a, int b);
  int member_of(int index) const;
  void gather(int set);
  void place(const ContactTerm<T>& contacts, int member);
  bool touch(const ContactTerm<T>& contacts, int a, int b) const;
  bool join_touching(const ContactTerm<T>& contacts);
  void take_back(std::span<KeptStep<T>> kept);

  std::span<CharacterState<T>* const> states_;
  std::span<const int> indices_;
  std::span<Coupling<T>* const> ties_;
  Vec3<double> origin_ = Vec3<double>::Zero();   ///< m, world; of the placed colliders
  std::vector<int> set_;                         ///< [member] union-find; towards the smallest
  std::vector<std::uint8_t> stepped_, changed_;  ///< [member] its set has been stepped; in this round
  std::vector<PlacedCollider<T>> from_, to_;     ///< of all members
  std::vector<PlacedCollider<T>> placed_;        ///< of one
  std::vector<int> first_collider_;              ///< [member + 1]
  std::vector<LaggedForce<T>> lagged_;           ///< of the sets that have been stepped
  // Of one set
  std::vector<CharacterState<T>*> its_states_;
  std::vector<int> its_indices_;
  std::vector<Coupling<T>*> its_ties_;
};

template <class T>
template <class Step>
std::span<const LaggedForce<T>> TouchingSets<T>::step_all(const ContactTerm<T>& contacts,
                                                          std::span<KeptStep<T>> kept, const Step& step) {
  const int count = static_cast<int>(states_.size());
  from_.clear();
  first_collider_.assign(1, 0);
  for (int n = 0; n < count; ++n) {
    kept[indices_[n]].keep(*states_[n]);
    place(contacts, n);
    from_.insert(from_.end(), placed_.begin(), placed_.end());
    first_collider_.push_back(static_cast<int>(from_.size()));
  }
  to_ = from_;
  lagged_.clear();
  stepped_.assign(count, 0);
  do {
    changed_.assign(count, 0);
    for (int set = 0; set < count; ++set) {
      if (set_of(set) != set || stepped_[set]) continue;
      gather(set);
      const std::size_t had = lagged_.size();
      int room = 0;
      for (const CharacterState<T>* s : its_states_) room += s->problem.room.loaded;
      lagged_.resize(had + room);
      lagged_.resize(had + step(its_states_, its_indices_, its_ties_, std::span(lagged_).subspan(had)));
      for (int n = set; n < count; ++n) {
        if (set_of(n) != set) continue;
        stepped_[n] = changed_[n] = 1;
        place(contacts, n);
        std::copy(placed_.begin(), placed_.end(), to_.begin() + first_collider_[n]);
      }
    }
  } while (join_touching(contacts) && (take_back(kept), true));
  return lagged_;
}

extern template class TouchingSets<float>;
extern template class TouchingSets<double>;

}  // namespace sinew
