#include "sinew/character/couplings.h"

#include <algorithm>
#include <numeric>

namespace sinew {

template <class T>
int Couplings<T>::add(Coupling<T> coupling) {
  all_.push_back(std::make_unique<Coupling<T>>(std::move(coupling)));
  working_.reserve(all_.size());
  return static_cast<int>(all_.size()) - 1;
}

template <class T>
bool Couplings<T>::are_apart(int a, int b) const {
  return std::any_of(apart_.begin(), apart_.end(), [&](const BodyPair& p) {
    return p.body_a < 0 && p.body_b < 0 &&
           ((p.state_a == a && p.state_b == b) || (p.state_a == b && p.state_b == a));
  });
}

template <class T>
void Couplings<T>::set_apart(int a, int b, bool apart) {
  if (apart == are_apart(a, b)) return;
  if (apart) return keep_apart({a, -1, b, -1});
  std::erase_if(apart_, [&](const BodyPair& p) {
    return p.body_a < 0 && p.body_b < 0 &&
           ((p.state_a == a && p.state_b == b) || (p.state_a == b && p.state_b == a));
  });
}

template <class T>
void Couplings<T>::drop_last() {
  all_.pop_back();
}

template <class T>
void Couplings<T>::count_in(States states, double gravity, SolveCapacities& rooms) {
  capacities_.clear();
  // Trees that are tied together if all couplings are switched on, by their first.
  std::vector<int> clump_of(states.size());
  std::iota(clump_of.begin(), clump_of.end(), 0);
  for (const auto& c : all_) {
    SolveCapacity& capacity = capacities_.emplace_back();
    capacity.nodes = static_cast<int>(c->nodes.size());
    capacity.stencils = static_cast<int>(c->stencils.size());
    capacity.tetrahedra = static_cast<int>(c->tetrahedra.size());
    for (const CouplingNode<T>& node : c->nodes)
      if (node.state >= 0) capacity.node_entries += path_entries(states[node.state]->tree, node.body);
    if (c->closes_slowly) {
      capacity.loops = capacity.stencils;
      capacity.loop_entries = capacity.node_entries;
    }
    rooms.all += capacity;
    const int first = first_tree(*c);
    for_each_tree(*c, [&](int n) {
      const auto [to, from] = std::minmax(clump_of[first], clump_of[n]);
      if (to != from) std::replace(clump_of.begin(), clump_of.end(), int(from), int(to));
    });
  }
  std::vector<double> heaviest(states.size());
  for (std::size_t n = 0; n < states.size(); ++n)
    heaviest[clump_of[n]] = std::max(heaviest[clump_of[n]], double(states[n]->total_mass));
  for (const auto& c : all_)
    if (const int first = first_tree(*c); first >= 0) c->bear(gravity * heaviest[clump_of[first]]);
  std::vector<SolveCapacity> clump(states.size());
  for (std::size_t n = 0; n < states.size(); ++n) clump[clump_of[n]] += states[n]->problem.capacity;
  for (std::size_t c = 0; c < all_.size(); ++c)
    if (const int first = first_tree(*all_[c]); first >= 0) clump[clump_of[first]] += capacities_[c];
  for (const auto& c : all_)
    if (const int first = first_tree(*c); first >= 0) rooms.include(clump[clump_of[first]]);
}

template <class T>
bool Couplings<T>::works(const Coupling<T>& c, States states) const {
  return c.active && first_tree(c) >= 0 &&
         std::none_of(c.nodes.begin(), c.nodes.end(), [&](const CouplingNode<T>& node) {
           return node.state >= 0 && states[node.state]->parked;
         });
}

template <class T>
void Couplings<T>::begin_step(States states) {
  working_.clear();
  for (const auto& s : states) s->tied = false;
  for (std::size_t n = 0; n < all_.size(); ++n) {
    if (!works(*all_[n], states)) continue;
    working_.push_back(static_cast<int>(n));
    for_each_tree(*all_[n], [&](int tree) { states[tree]->tied = true; });
  }
}

template <class T>
void begin_couplings(std::span<Coupling<T>* const> couplings, std::span<CharacterState<T>* const> states,
                     std::span<const int> indices) {
  for (Coupling<T>* c : couplings) {
    c->strained = false;
    for (CouplingNode<T>& node : c->nodes) {
      const auto found = std::find(indices.begin(), indices.end(), node.state);
      node.tree = found == indices.end() ? -1 : static_cast<int>(found - indices.begin());
      const Vec3<double>& origin = states[0]->history.place;
      if (node.tree < 0) {
        node.point = (node.place - origin).template cast<T>();
      } else {
        c->strained = c->strained || states[node.tree]->drives_limbs();
        const Vec3<T> world = states[node.tree]->model()[node.body] * node.local;
        node.point = (world.template cast<double>() - origin).template cast<T>();
      }
    }
  }
}

template class Couplings<float>;
template class Couplings<double>;
template void begin_couplings<float>(std::span<Coupling<float>* const>,
                                     std::span<CharacterState<float>* const>, std::span<const int>);
template void begin_couplings<double>(std::span<Coupling<double>* const>,
                                      std::span<CharacterState<double>* const>, std::span<const int>);

}  // namespace sinew
