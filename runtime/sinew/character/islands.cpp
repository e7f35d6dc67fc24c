#include "sinew/character/islands.h"

#include <algorithm>

#include "sinew/character/sleep.h"
#include "sinew/skeleton/hooks.h"

namespace sinew {
namespace {

constexpr double kTouching = 0.02;  ///< m beyond what they move by, at which a sleeper wakes

}  // namespace

template <class T>
void Islands<T>::reserve(int states, int couplings, int colliders) {
  moving_.reserve(colliders);
  first_moving_.reserve(states);
  grid_.reserve(states);
  box_.reserve(states);
  for (auto* v : {&parent_, &dofs_, &island_, &members_, &awake_, &ball_}) v->reserve(states);
  first_.reserve(states + 1);
  first_tie_.reserve(states + 2);
  ties_.reserve(couplings);
}

template <class T>
int Islands<T>::root_of(int n) {
  while (parent_[n] != n) n = parent_[n] = parent_[parent_[n]];
  return n;
}

template <class T>
void Islands<T>::join(int a, int b, std::span<const std::unique_ptr<CharacterState<T>>> states,
                      int most_dofs) {
  const int one = root_of(a), two = root_of(b);
  if (one == two) return;
  if (dofs_[one] + dofs_[two] > most_dofs)
    states[a]->crowded = states[b]->crowded = true;
  else
    unite(one, two);
}

template <class T>
void Islands<T>::unite(int one, int two) {
  if (one == two) return;
  const int to = std::min(one, two), from = std::max(one, two);
  parent_[from] = to;
  dofs_[to] += dofs_[from];
}

/// Everybody who sleeps with a woken one.
template <class T>
void Islands<T>::wake(int nap, std::span<const std::unique_ptr<CharacterState<T>>> states) {
  for (std::size_t n = 0; n < states.size(); ++n) {
    LevelState& l = states[n]->levels;
    if (l.nap != nap) continue;
    l.nap = -1;
    if (!l.asleep) continue;
    l.asleep = false;
    l.still = 0;
    awake_.push_back(static_cast<int>(n));
  }
}

/// Who is tied to somebody awake; along chains of couplings too.
template <class T>
void Islands<T>::wake_tied(std::span<const std::unique_ptr<CharacterState<T>>> states,
                           const Couplings<T>& couplings) {
  for (bool again = true; again;) {
    again = false;
    for (const int c : couplings.working()) {
      bool any_awake = false;
      for_each_tree(couplings[c], [&](int n) { any_awake = any_awake || !states[n]->levels.asleep; });
      if (!any_awake) continue;
      for_each_tree(couplings[c], [&](int n) {
        if (!states[n]->levels.asleep) return;
        wake(states[n]->levels.nap, states);
        again = true;
      });
    }
  }
}

/// Which island each working coupling belongs to; none where it sleeps.
template <class T>
void Islands<T>::divide_ties(const Couplings<T>& couplings) {
  ties_.clear();
  if (couplings.working().empty()) return;
  first_tie_.assign(first_.size() + 1, 0);  // one more than there will be: each island's end moves down
  const auto island = [&](int c) { return island_[first_tree(couplings[c])]; };
  for (const int c : couplings.working())
    if (const int i = island(c); i >= 0) ++first_tie_[i + 2];
  for (std::size_t i = 1; i < first_tie_.size(); ++i) first_tie_[i] += first_tie_[i - 1];
  ties_.resize(first_tie_.back());
  for (const int c : couplings.working())
    if (const int i = island(c); i >= 0) ties_[first_tie_[i + 1]++] = c;
  first_tie_.pop_back();
}

/// What holds the nth state through the step.
template <class T>
const Eigen::AlignedBox<T, 3>& Islands<T>::box(CharacterState<T>& s, int n, const ContactTerm<T>& contacts,
                                               T h) {
  if (box_[n].isEmpty()) box_[n] = contacts.swept_box(s, h);
  return box_[n];
}

/// The colliders of the nth state.
template <class T>
std::span<const MovingCollider<T>> Islands<T>::moving(CharacterState<T>& s, int n,
                                                      const ContactTerm<T>& contacts, T h) {
  if (first_moving_[n] < 0) {
    first_moving_[n] = static_cast<int>(moving_.size());
    contacts.append_moving(s, h, moving_);
  }
  return std::span(moving_).subspan(first_moving_[n], s.colliders.size());
}

template <class T>
void Islands<T>::find(std::span<const std::unique_ptr<CharacterState<T>>> states,
                      const Couplings<T>& couplings, T h, int most_dofs, const ContactTerm<T>* contacts) {
  SINEW_ZONE("who touches");
  const int count = static_cast<int>(states.size());
  grid_.clear();
  parent_.resize(count);
  dofs_.resize(count);
  island_.assign(count, -1);
  moving_.clear();
  first_moving_.assign(count, -1);
  ball_.resize(count);
  box_.assign(count, {});
  awake_.clear();
  // Nobody is woken, or solved for, because somebody walks by.
  const auto meet = [&](int n, int other) {
    if (!states[n]->may_meet(*states[other])) return false;
    const T margin = (states[other]->levels.asleep ? T(kTouching) : T(kCloseMargin)) *
                     std::max(states[n]->tree.scale.length, states[other]->tree.scale.length);
    return contacts->boxes_come_close(box(*states[n], n, *contacts, h),
                                      box(*states[other], other, *contacts, h), h, margin) &&
           !couplings.are_apart(n, other) &&
           contacts->come_close(moving(*states[n], n, *contacts, h),
                                moving(*states[other], other, *contacts, h), h, margin);
  };
  // Together they leave a decimetre, and twice what both may move by.
  const auto reach = [&](int n) {
    return double(states[n]->radius + T(0.05) * states[n]->tree.scale.length + 2 * h * states[n]->pace());
  };
  for (int n = 0; n < count; ++n) {
    CharacterState<T>& s = *states[n];
    parent_[n] = n;
    dofs_[n] = s.tree.dofs;
    s.crowded = false;
    if (is_woken(s) && s.levels.nap >= 0) wake(s.levels.nap, states);
    s.levels.wake = false;
  }
  wake_tied(states, couplings);
  for (const int c : couplings.working()) {
    const int first = first_tree(couplings[c]);
    for_each_tree(couplings[c], [&](int n) { unite(root_of(first), root_of(n)); });
  }
  awake_.clear();
  const bool may_meet = contacts && count > 1;
  for (int n = 0; n < count; ++n) {
    if (states[n]->parked) continue;
    if (may_meet) ball_[n] = grid_.add(n, states[n]->middle(), reach(n));
    if (!states[n]->levels.asleep) awake_.push_back(n);
  }
  if (may_meet) grid_.build();
  for (std::size_t next = 0; may_meet && next < awake_.size();) {  // grows by those who are woken
    const int n = awake_[next++];
    grid_.overlapping(ball_[n], [&](int other) {
      CharacterState<T>& s = *states[other];
      // From the side of the first, unless the other sleeps.
      if ((other <= n && !s.levels.asleep) || root_of(other) == root_of(n) || !meet(n, other)) return;
      if (s.levels.asleep) wake(s.levels.nap, states);
      join(n, other, states, most_dofs);
    });
  }
  // Islands in the order of their first members; members in theirs.
  first_.assign(1, 0);
  for (int n = 0; n < count; ++n) {
    if (!takes_part(*states[n])) continue;
    const int root = root_of(n);
    if (root == n) {
      island_[n] = static_cast<int>(first_.size()) - 1;
      first_.push_back(0);
    }
    island_[n] = island_[root];
    ++first_[island_[n] + 1];
  }
  for (std::size_t i = 1; i < first_.size(); ++i) first_[i] += first_[i - 1];
  members_.resize(first_.back());
  for (int n = count - 1; n >= 0; --n)  // backwards: each island's end moves down to its beginning
    if (takes_part(*states[n])) members_[--first_[island_[root_of(n)] + 1]] = n;
  for (std::size_t i = 0; i + 1 < first_.size(); ++i) first_[i] = first_[i + 1];
  first_.back() = static_cast<int>(members_.size());
  divide_ties(couplings);
}

template class Islands<float>;
template class Islands<double>;

}  // namespace sinew
