// Which characters and props may touch each other within a step: these are solved together, everybody else
// on any thread. Internal to the character layer.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "sinew/character/contact_finder.h"
#include "sinew/character/couplings.h"
#include "sinew/character/neighbour_grid.h"
#include "sinew/character/state.h"

namespace sinew {

template <class T>
class Islands {
 public:
  /// Set-up for so many states, couplings, and colliders of all states; nothing allocates afterwards.
  void reserve(int states, int couplings, int colliders);

  /// Wakes sleepers that the host, a neighbour or somebody tied to them calls for, then
  /// divides those who are awake into islands, each named by and listing its members in ascending order.
  /// What working couplings tie together is always in one. Pairs that would bring an island above `most_dofs`
  /// degrees of freedom stay apart, the later first: they pass through each other (see
  /// CharacterReport::crowded). O(states) where they are spread out.
  void find(std::span<const std::unique_ptr<CharacterState<T>>> states, const Couplings<T>& couplings, T h,
            int most_dofs, const ContactTerm<T>* contacts);

  int count() const { return static_cast<int>(first_.size()) - 1; }
  /// Whether a state takes part in the step: it is in the world, and awake.
  bool contains(int state) const { return island_[state] >= 0; }
  std::span<const int> members(int island) const {
    return std::span(members_).subspan(first_[island], first_[island + 1] - first_[island]);
  }
  /// Couplings of an island, ascending.
  std::span<const int> ties(int island) const {
    if (ties_.empty()) return {};
    return std::span(ties_).subspan(first_tie_[island], first_tie_[island + 1] - first_tie_[island]);
  }

 private:
  static bool takes_part(const CharacterState<T>& s) { return !s.parked && !s.levels.asleep; }
  void wake(int nap, std::span<const std::unique_ptr<CharacterState<T>>> states);
  void wake_tied(std::span<const std::unique_ptr<CharacterState<T>>> states, const Couplings<T>& couplings);
  const Eigen::AlignedBox<T, 3>& box(CharacterState<T>& state, int n, const ContactTerm<T>& contacts, T h);
  std::span<const MovingCollider<T>> moving(CharacterState<T>& state, int n, const ContactTerm<T>& contacts,
                                            T h);
  int root_of(int state);
  void unite(int root, int other);
  void divide_ties(const Couplings<T>& couplings);
  void join(int a, int b, std::span<const std::unique_ptr<CharacterState<T>>> states, int most_dofs);

  NeighbourGrid grid_;
  std::vector<int> ball_;                     ///< [state] its ball in the grid
  std::vector<Eigen::AlignedBox<T, 3>> box_;  ///< [state] see swept_box(); empty: nobody has asked
  std::vector<MovingCollider<T>> moving_;     ///< of who has met somebody in this step
  std::vector<int> first_moving_;             ///< [state] into moving_; −1: has not
  std::vector<int> parent_;                   ///< [state] union-find; towards the smallest index
  std::vector<int> dofs_;                     ///< [state] of the island whose root it is
  std::vector<int> awake_;
  std::vector<int> island_;            ///< [state] number of the island
  std::vector<int> first_, members_;   ///< [island + 1] into members_
  std::vector<int> first_tie_, ties_;  ///< [island + 1] into ties_
};

extern template class Islands<float>;
extern template class Islands<double>;

}  // namespace sinew
