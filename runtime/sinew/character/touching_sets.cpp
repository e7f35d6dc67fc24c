#include "sinew/character/touching_sets.h"

#include <algorithm>

#include "sinew/character/couplings.h"
#include "sinew/effects/support.h"

namespace sinew {
namespace {

/// m of a human: whose bodies go so deep into each other if nothing stops them will touch.
constexpr double kBoundToTouch = 5e-3;
/// Carriers that a member touches, on the average, where there is room for all; and one for each carrier.
constexpr std::size_t kTouches = 4;

}  // namespace

template <class T>
void TouchingSets<T>::reserve(const SolveCapacity& capacity) {
  for (auto* v : {&set_, &spent_, &its_indices_}) v->reserve(capacity.trees);
  for (auto* v : {&carrier_, &stepped_, &changed_}) v->reserve(capacity.trees);
  carried_.reserve((kTouches + 1) * capacity.trees);
  for (auto* v : {&from_, &to_, &placed_}) v->reserve(capacity.colliders);
  first_collider_.reserve(capacity.trees + 1);
  box_.reserve(capacity.trees);
  lagged_.reserve(capacity.loaded);
  its_states_.reserve(capacity.trees);
  its_ties_.reserve(capacity.nodes);
}

template <class T>
std::size_t TouchingSets<T>::bytes(const SolveCapacity& capacity) const {
  return capacity.trees * (4 * sizeof(int) + 3 + (kTouches + 1) * 2 * sizeof(int) + sizeof(void*) +
                           sizeof(Eigen::AlignedBox<T, 3>)) +
         3 * capacity.colliders * sizeof(PlacedCollider<T>) + capacity.loaded * sizeof(LaggedForce<T>) +
         capacity.nodes * sizeof(void*);
}

template <class T>
void TouchingSets<T>::unite(int a, int b) {
  a = set_of(a), b = set_of(b);
  set_[std::max(a, b)] = std::min(a, b);
}

/// Whether somebody of a set touches a carrier.
template <class T>
bool TouchingSets<T>::carries(int carrier, int set) {
  return std::any_of(carried_.begin(), carried_.end(),
                     [&](const auto& c) { return c.first == carrier && set_of(c.second) == set; });
}

/// Who touch. Where a carrier has more than there is room for, all of them are one set.
template <class T>
void TouchingSets<T>::join(int a, int b) {
  if (carrier_[a] && carrier_[b]) return;
  if (!carrier_[a] && !carrier_[b]) return unite(a, b);
  if (carrier_[b]) std::swap(a, b);
  if (carries(a, set_of(b))) return;
  const auto known =
      std::find_if(carried_.begin(), carried_.end(), [a](const auto& c) { return c.first == a; });
  if (known == carried_.end() || carried_.size() < kTouches * states_.size())
    carried_.emplace_back(a, b);
  else
    unite(b, known->second);
}

/// −1: none.
template <class T>
int TouchingSets<T>::member_of(int index) const {
  const auto found = std::lower_bound(indices_.begin(), indices_.end(), index);
  return found == indices_.end() || *found != index ? -1 : static_cast<int>(found - indices_.begin());
}

template <class T>
bool TouchingSets<T>::begin(const ContactTerm<T>* contacts, std::span<CharacterState<T>* const> states,
                            std::span<const int> indices, std::span<Coupling<T>* const> ties,
                            std::span<const LaggedForce<T>> lagged, const Vec3<T>& gravity, T h) {
  contacts_ = contacts;
  states_ = states;
  indices_ = indices;
  ties_ = ties;
  const int count = static_cast<int>(states.size());
  set_.resize(count);
  carrier_.resize(count);
  carried_.clear();
  for (int n = 0; n < count; ++n) {
    set_[n] = n;
    carrier_[n] = states[n]->is_carrier();
  }
  for (const Coupling<T>* tie : ties) {
    const int first = member_of(first_tree(*tie));
    for_each_tree(*tie, [&](int tree) { unite(first, member_of(tree)); });
  }
  const auto before = [](const LaggedForce<T>& f, std::uint64_t id) { return f.id < id; };
  for (int n = 0; n < count; ++n) {
    const std::uint64_t end = first_contact_id(indices[n] + 1);
    auto force = std::lower_bound(lagged.begin(), lagged.end(), first_contact_id(indices[n]), before);
    for (; force != lagged.end() && force->id < end; ++force)
      if (const int other = member_of(other_tree(force->id)); other >= 0) join(n, other);
  }
  const auto one_set = [&] {
    for (int n = 0; n < count; ++n)
      if (carrier_[n] || set_of(n) != 0) return false;
    return true;
  };
  if (!contacts_ || one_set()) return false;
  predict(gravity, h);
  return !one_set();
}

/// Unites who is bound to touch.
template <class T>
void TouchingSets<T>::predict(const Vec3<T>& gravity, T h) {
  origin_ = states_[0]->history.place;
  from_.clear();
  to_.clear();
  first_collider_.assign(1, 0);
  for (std::size_t n = 0; n < states_.size(); ++n) {
    place(static_cast<int>(n));
    from_.insert(from_.end(), placed_.begin(), placed_.end());
    contacts_->predict_colliders(*states_[n], placed_, origin_, gravity, h, to_);
    first_collider_.push_back(static_cast<int>(from_.size()));
  }
  box_.resize(states_.size());
  for (std::size_t n = 0; n < states_.size(); ++n) enclose(static_cast<int>(n));
  for (auto* v : {&stepped_, &changed_}) v->assign(states_.size(), 1);
  join_touching(T(kBoundToTouch));
}

/// The members of a set, what carries them, and what ties them.
template <class T>
void TouchingSets<T>::gather(int set) {
  its_states_.clear();
  its_indices_.clear();
  its_ties_.clear();
  for (int n = 0; n < static_cast<int>(states_.size()); ++n) {
    if (set_of(n) != set && !(carrier_[n] && carries(n, set))) continue;
    its_states_.push_back(states_[n]);
    its_indices_.push_back(indices_[n]);
  }
  for (Coupling<T>* tie : ties_)
    if (set_of(member_of(first_tree(*tie))) == set) its_ties_.push_back(tie);
}

/// A member's colliders where it is now into `placed_`.
template <class T>
void TouchingSets<T>::place(int member) {
  CharacterState<T>& s = *states_[member];
  placed_.clear();
  contacts_->place_colliders(s, s.local, s.history.place, origin_, placed_);
}

template <class T>
void TouchingSets<T>::enclose(int member) {
  Eigen::AlignedBox<T, 3>& box = box_[member];
  box.setEmpty();
  for (int c = first_collider_[member]; c < first_collider_[member + 1]; ++c)
    for (const PlacedCollider<T>* placed : {&from_[c], &to_[c]}) {
      const Vec3<T> reach = Vec3<T>::Constant(placed->radius);
      box.extend(placed->pose.translation - reach).extend(placed->pose.translation + reach);
    }
}

/// Who plays its animation with nothing but the ground under it touches props on which it may stand.
template <class T>
bool TouchingSets<T>::touch(int a, int b, T depth) const {
  if (!states_[a]->may_meet(*states_[b])) return false;
  const auto may_stand = [&](const CharacterState<T>& s, const CharacterState<T>& on) {
    return s.grounded() && s.undisturbed() && on.is_prop && !on.is_particles;
  };
  if (may_stand(*states_[a], *states_[b]) || may_stand(*states_[b], *states_[a]))
    depth = -T(SupportSettings{}.reach);
  const auto paths = [&](int n) {
    const std::size_t first = first_collider_[n], count = first_collider_[n + 1] - first;
    return ColliderPaths<T>{std::span(from_).subspan(first, count), std::span(to_).subspan(first, count)};
  };
  depth *= std::min(states_[a]->tree.scale.length, states_[b]->tree.scale.length);
  const Vec3<T> around = Vec3<T>::Constant(std::max(-depth, T(0)));
  if (!Eigen::AlignedBox<T, 3>(box_[a].min() - around, box_[a].max() + around).intersects(box_[b]))
    return false;
  return contacts_->touch_on_the_way(paths(a), paths(b), depth);
}

/// Or never have to be, as two carriers.
template <class T>
bool TouchingSets<T>::are_stepped_together(int a, int b) {
  if (carrier_[a]) return carrier_[b] || carries(a, set_of(b));
  return carrier_[b] ? carries(b, set_of(a)) : set_of(a) == set_of(b);
}

/// Unites the sets that have touched each other, or lay deeper in each other than `depth` (m of a human).
/// False where none have.
template <class T>
bool TouchingSets<T>::join_touching(T depth) {
  bool any = false;
  const int count = static_cast<int>(states_.size());
  for (int a = 0; a < count; ++a)
    for (int b = a + 1; b < count; ++b) {
      if ((!changed_[a] && !changed_[b]) || are_stepped_together(a, b) || !touch(a, b, depth)) continue;
      stepped_[set_of(a)] = stepped_[set_of(b)] = 0;
      join(a, b);
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
    if (carrier_[n] || stepped_[set]) continue;
    stepped_[n] = 0;
    spent_[n] += states_[n]->report.outer_passes;
    kept[indices_[n]].restore(*states_[n]);
    const auto its = [tree = indices_[n]](const LaggedForce<T>& f) { return is_of_tree(f.id, tree); };
    lagged_.erase(std::remove_if(lagged_.begin(), lagged_.end(), its), lagged_.end());
  }
  for (Coupling<T>* tie : ties_)
    if (!stepped_[set_of(member_of(first_tree(*tie)))])
      for (Stencil<T>& e : tie->stencils) {
        e.offset = e.offset_before;
        e.carried = e.carried_before;
      }
}

template class TouchingSets<float>;
template class TouchingSets<double>;

}  // namespace sinew
