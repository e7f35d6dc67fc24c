#include "sinew/character/touching_sets.h"

#include <algorithm>

#include "sinew/character/couplings.h"

namespace sinew {

template <class T>
void TouchingSets<T>::reserve(const SolveRoom& room) {
  for (auto* v : {&set_, &its_indices_}) v->reserve(room.trees);
  for (auto* v : {&stepped_, &changed_}) v->reserve(room.trees);
  for (auto* v : {&from_, &to_, &placed_}) v->reserve(room.colliders);
  first_collider_.reserve(room.trees + 1);
  lagged_.reserve(room.loaded);
  its_states_.reserve(room.trees);
  its_ties_.reserve(room.nodes);
}

template <class T>
std::size_t TouchingSets<T>::bytes(const SolveRoom& room) const {
  return room.trees * (3 * sizeof(int) + 2 + sizeof(void*)) + 3 * room.colliders * sizeof(PlacedCollider<T>) +
         room.loaded * sizeof(LaggedForce<T>) + room.nodes * sizeof(void*);
}

template <class T>
void TouchingSets<T>::unite(int a, int b) {
  a = set_of(a), b = set_of(b);
  set_[std::max(a, b)] = std::min(a, b);
}

/// −1: none.
template <class T>
int TouchingSets<T>::member_of(int index) const {
  const auto found = std::lower_bound(indices_.begin(), indices_.end(), index);
  return found == indices_.end() || *found != index ? -1 : static_cast<int>(found - indices_.begin());
}

template <class T>
bool TouchingSets<T>::begin(std::span<CharacterState<T>* const> states, std::span<const int> indices,
                            std::span<Coupling<T>* const> ties, std::span<const LaggedForce<T>> lagged) {
  states_ = states;
  indices_ = indices;
  ties_ = ties;
  const int count = static_cast<int>(states.size());
  set_.resize(count);
  for (int n = 0; n < count; ++n) set_[n] = n;
  for (const Coupling<T>* tie : ties) {
    const int first = member_of(first_tree(*tie));
    for_each_tree(*tie, [&](int tree) { unite(first, member_of(tree)); });
  }
  const auto before = [](const LaggedForce<T>& f, std::uint64_t id) { return f.id < id; };
  for (int n = 0; n < count; ++n) {
    const std::uint64_t end = first_contact_id(indices[n] + 1);
    auto force = std::lower_bound(lagged.begin(), lagged.end(), first_contact_id(indices[n]), before);
    for (; force != lagged.end() && force->id < end; ++force)
      if (const int other = member_of(other_tree(force->id)); other >= 0) unite(n, other);
  }
  const auto first = [&](int n) { return set_of(n) == 0; };
  for (int n = 1; n < count; ++n)
    if (!first(n)) {
      origin_ = states[0]->history.place;
      return true;
    }
  return false;
}

/// The members of a set, and what ties them.
template <class T>
void TouchingSets<T>::gather(int set) {
  its_states_.clear();
  its_indices_.clear();
  its_ties_.clear();
  for (int n = set; n < static_cast<int>(states_.size()); ++n) {
    if (set_of(n) != set) continue;
    its_states_.push_back(states_[n]);
    its_indices_.push_back(indices_[n]);
  }
  for (Coupling<T>* tie : ties_)
    if (set_of(member_of(first_tree(*tie))) == set) its_ties_.push_back(tie);
}

/// A member's colliders where it is now into `placed_`.
template <class T>
void TouchingSets<T>::place(const ContactTerm<T>& contacts, int member) {
  CharacterState<T>& s = *states_[member];
  placed_.clear();
  contacts.place_colliders(s, s.local, s.history.place, origin_, placed_);
}

template <class T>
bool TouchingSets<T>::touch(const ContactTerm<T>& contacts, int a, int b) const {
  const auto paths = [&](int n) {
    const std::size_t first = first_collider_[n], count = first_collider_[n + 1] - first;
    return ColliderPaths<T>{std::span(from_).subspan(first, count), std::span(to_).subspan(first, count)};
  };
  return contacts.touch_on_the_way(paths(a), paths(b));
}

/// Unites the sets that have touched each other. False where none have.
template <class T>
bool TouchingSets<T>::join_touching(const ContactTerm<T>& contacts) {
  bool any = false;
  const int count = static_cast<int>(states_.size());
  for (int a = 0; a < count; ++a)
    for (int b = a + 1; b < count; ++b) {
      if ((!changed_[a] && !changed_[b]) || set_of(a) == set_of(b) || !touch(contacts, a, b)) continue;
      stepped_[set_of(a)] = stepped_[set_of(b)] = 0;
      unite(a, b);
      any = true;
    }
  return any;
}

/// The steps of all members of sets that have to be stepped again.
template <class T>
void TouchingSets<T>::take_back(std::span<KeptStep<T>> kept) {
  const int count = static_cast<int>(states_.size());
  for (int n = 0; n < count; ++n) {
    const int set = set_of(n);
    if (stepped_[set]) continue;
    stepped_[n] = 0;
    kept[indices_[n]].restore(*states_[n]);
    const auto its = [id = first_contact_id(indices_[n])](const LaggedForce<T>& f) {
      return f.id >> 48 == id >> 48;
    };
    lagged_.erase(std::remove_if(lagged_.begin(), lagged_.end(), its), lagged_.end());
  }
  for (Coupling<T>* tie : ties_)
    if (!stepped_[set_of(member_of(first_tree(*tie)))])
      for (Stencil<T>& e : tie->stencils) e.offset = e.offset_before;
}

template class TouchingSets<float>;
template class TouchingSets<double>;

}  // namespace sinew
