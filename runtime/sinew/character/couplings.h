// What ties the trees of a world together: loops, and the elements of particle bodies. Internal to the
// character layer.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "sinew/character/contact_finder.h"
#include "sinew/effects/coupling.h"

namespace sinew {

template <class T>
class Couplings {
 public:
  using States = std::span<const std::unique_ptr<CharacterState<T>>>;

  /// Set-up. Returns its index.
  int add(Coupling<T> coupling);
  /// Set-up: two bodies never touch each other.
  void keep_apart(const BodyPair& pair) { apart_.push_back(pair); }
  /// Adds the room that all of them need.
  void add_room(States states, SolveSize& size) const;

  Coupling<T>& operator[](int index) { return *all_[index]; }
  const Coupling<T>& operator[](int index) const { return *all_[index]; }
  std::span<const std::unique_ptr<Coupling<T>>> all() const { return all_; }
  std::span<const BodyPair> apart() const { return apart_; }

  /// Joins the islands that couplings tie together; `group` [state].
  void join(States states, std::span<int> group) const;
  /// The couplings of one island. Valid until the next call.
  std::span<Coupling<T>* const> of_island(States states, std::span<const int> group, int island);

 private:
  bool works(const Coupling<T>& coupling, States states) const;

  std::vector<std::unique_ptr<Coupling<T>>> all_;
  std::vector<Coupling<T>*> chosen_;
  std::vector<BodyPair> apart_;
};

extern template class Couplings<float>;
extern template class Couplings<double>;

}  // namespace sinew
