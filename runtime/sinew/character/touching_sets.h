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

constexpr double kGrazing = 1e-5;  ///< m of a human: what so little depth bears is a thousandth of a weight

/// Every set of an island's members is stepped by itself, as if the others were not there. Where colliders of
/// two sets have touched on their ways, both steps are taken back, and the two are stepped together; so on
/// until nobody touches anybody of another set. Sets begin with those who are tied together, and those who
/// bore on each other at the end of the last step, or are bound to by how their bodies move. So whoever is
/// only near has the bits that it has alone.
///
/// What carries others (CharacterState::is_carrier) gives way to none of them, so it makes no set of two who
/// touch it: it is stepped with each set that does, and at last by itself, which is what it keeps.
template <class T>
class TouchingSets {
 public:
  void reserve(const SolveCapacity& capacity);
  std::size_t bytes(const SolveCapacity& capacity) const;

  /// An island's members (ascending by their numbers in the world, `indices`), what ties them, and the
  /// world's contact forces of the last step, sorted by id. False where all are in one set from the
  /// beginning.
  bool begin(const ContactTerm<T>* contacts, std::span<CharacterState<T>* const> states,
             std::span<const int> indices, std::span<Coupling<T>* const> ties,
             std::span<const LaggedForce<T>> lagged, const Vec3<T>& gravity, T h);

  /// Steps all. `kept` [world's number]; step(states, indices, ties, spent, lagged_out) steps one set, whose
  /// steps that were taken back have taken `spent` passes, and returns how many forces it has written; what
  /// carries is among several sets' states. Returns all of them, of every set.
  template <class Step>
  std::span<const LaggedForce<T>> step_all(std::span<KeptStep<T>> kept, const Step& step);

 private:
  int set_of(int member) {
    while (set_[member] != member) member = set_[member] = set_[set_[member]];
    return member;
  }
  void unite(int a, int b);
  bool carries(int carrier, int set);
  void join(int a, int b);
  bool are_stepped_together(int a, int b);
  int member_of(int index) const;
  void gather(int set);
  void place(int member);
  void enclose(int member);
  void predict(const Vec3<T>& gravity, T h);
  bool touch(int a, int b, T depth) const;
  bool join_touching(T depth);
  void take_back(std::span<KeptStep<T>> kept);

  const ContactTerm<T>* contacts_ = nullptr;
  std::span<CharacterState<T>* const> states_;
  std::span<const int> indices_;
  std::span<Coupling<T>* const> ties_;
  Vec3<double> origin_ = Vec3<double>::Zero();   ///< m, world; of the placed colliders
  std::vector<int> set_;                         ///< [member] union-find; towards the smallest
  std::vector<std::uint8_t> carrier_;            ///< [member]
  std::vector<std::pair<int, int>> carried_;     ///< carriers and whom they touch
  std::vector<std::uint8_t> stepped_, changed_;  ///< [member] its set has been stepped; in this round
  std::vector<int> spent_;                       ///< [member] passes of its steps that were taken back
  std::vector<PlacedCollider<T>> from_, to_;     ///< of all members
  std::vector<PlacedCollider<T>> placed_;        ///< of one
  std::vector<int> first_collider_;              ///< [member + 1]
  std::vector<Eigen::AlignedBox<T, 3>> box_;     ///< [member] about its colliders' ways
  std::vector<LaggedForce<T>> lagged_;           ///< of the sets that have been stepped
  // Of one set
  std::vector<CharacterState<T>*> its_states_;
  std::vector<int> its_indices_;
  std::vector<Coupling<T>*> its_ties_;
};

template <class T>
template <class Step>
std::span<const LaggedForce<T>> TouchingSets<T>::step_all(std::span<KeptStep<T>> kept, const Step& step) {
  const int count = static_cast<int>(states_.size());
  for (int n = 0; n < count; ++n) kept[indices_[n]].keep(*states_[n]);
  lagged_.clear();
  stepped_.assign(count, 0);
  spent_.assign(count, 0);
  do {
    changed_.assign(count, 0);
    for (int set = 0; set < count; ++set) {
      if (carrier_[set] || set_of(set) != set || stepped_[set]) continue;
      gather(set);
      const std::size_t had = lagged_.size();
      int room = 0, spent = 0;
      for (std::size_t k = 0; k < its_states_.size(); ++k) {
        room += its_states_[k]->problem.capacity.loaded;
        spent = std::max(spent, spent_[member_of(its_indices_[k])]);
      }
      lagged_.resize(std::min(had + room, lagged_.capacity()));
      lagged_.resize(had +
                     step(its_states_, its_indices_, its_ties_, spent, std::span(lagged_).subspan(had)));
      for (std::size_t k = 0; k < its_states_.size(); ++k) {
        const int n = member_of(its_indices_[k]);
        if (carrier_[n]) {
          kept[its_indices_[k]].restore(*its_states_[k]);
          continue;
        }
        stepped_[n] = changed_[n] = 1;
        place(n);
        std::copy(placed_.begin(), placed_.end(), to_.begin() + first_collider_[n]);
        enclose(n);
      }
    }
  } while (join_touching(T(kGrazing)) && (take_back(kept), true));
  for (int n = 0; n < count; ++n) {
    if (!carrier_[n]) continue;
    gather(n);
    step(its_states_, its_indices_, its_ties_, 0, std::span(lagged_).subspan(lagged_.size()));
  }
  return lagged_;
}

extern template class TouchingSets<float>;
extern template class TouchingSets<double>;

}  // namespace sinew
