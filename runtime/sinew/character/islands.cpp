#include "sinew/character/islands.h"

#include <algorithm>

namespace sinew {

template <class T>
void Islands<T>::reserve(int states) {
  grid_.reserve(states);
  for (auto* v : {&parent_, &dofs_, &island_, &members_}) v->reserve(states);
  first_.reserve(states + 1);
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
  const int to = std::min(one, two), from = std::max(one, two);
  if (dofs_[to] + dofs_[from] > most_dofs) {
    states[a]->crowded = states[b]->crowded = true;
    return;
  }
  parent_[from] = to;
  dofs_[to] += dofs_[from];
}

template <class T>
void Islands<T>::find(std::span<const std::unique_ptr<CharacterState<T>>> states, T h, int most_dofs) {
  const int count = static_cast<int>(states.size());
  grid_.clear();
  parent_.resize(count);
  dofs_.resize(count);
  island_.assign(count, -1);
  const auto center = [&](int n) {
    return Vec3<double>(states[n]->model[0].translation.template cast<double>());
  };
  // Together they leave a decimetre, and twice what both may move by.
  const auto reach = [&](int n) {
    return double(states[n]->radius + T(0.05) + 2 * h * states[n]->history.velocity[0].norm());
  };
  for (int n = 0; n < count; ++n) {
    parent_[n] = n;
    dofs_[n] = states[n]->tree.dofs;
    states[n]->crowded = false;
    if (!states[n]->parked) grid_.add(n, center(n), reach(n));
  }
  grid_.build();
  for (int n = 0; n < count; ++n) {
    if (states[n]->parked) continue;
    grid_.overlapping(center(n), reach(n), [&](int other) {
      if (other > n) join(n, other, states, most_dofs);
    });
  }
  // Islands in the order of their first members; members in theirs.
  first_.assign(1, 0);
  for (int n = 0; n < count; ++n) {
    if (states[n]->parked) continue;
    const int root = root_of(n);
    if (root == n) {
      island_[n] = static_cast<int>(first_.size()) - 1;
      first_.push_back(0);
    }
    ++first_[island_[root] + 1];
  }
  for (std::size_t i = 1; i < first_.size(); ++i) first_[i] += first_[i - 1];
  members_.resize(first_.back());
  for (int n = count - 1; n >= 0; --n)  // backwards: each island's end moves down to its beginning
    if (!states[n]->parked) members_[--first_[island_[root_of(n)] + 1]] = n;
  for (std::size_t i = 0; i + 1 < first_.size(); ++i) first_[i] = first_[i + 1];
  first_.back() = static_cast<int>(members_.size());
}

template class Islands<float>;
template class Islands<double>;

}  // namespace sinew
