#include "sinew/character/couplings.h"

#include <algorithm>

namespace sinew {
namespace {

/// The state of the first node that is on one, or −1.
template <class T>
int first_state(const Coupling<T>& c) {
  const auto moving = std::find_if(c.nodes.begin(), c.nodes.end(),
                                   [](const CouplingNode<T>& node) { return node.state >= 0; });
  return moving == c.nodes.end() ? -1 : moving->state;
}

}  // namespace

template <class T>
int Couplings<T>::add(Coupling<T> coupling) {
  all_.push_back(std::make_unique<Coupling<T>>(std::move(coupling)));
  chosen_.reserve(all_.size());
  return static_cast<int>(all_.size()) - 1;
}

template <class T>
void Couplings<T>::add_room(States states, SolveSize& size) const {
  for (const auto& c : all_) {
    size.nodes += static_cast<int>(c->nodes.size());
    size.stencils += static_cast<int>(c->stencils.size());
    size.tetrahedra += static_cast<int>(c->tetrahedra.size());
    for (const CouplingNode<T>& node : c->nodes)
      if (node.state >= 0) size.node_entries += path_entries(states[node.state]->tree, node.body);
  }
}

/// Switched on, and all that it is fixed to is in the world.
template <class T>
bool Couplings<T>::works(const Coupling<T>& c, States states) const {
  return c.active && std::none_of(c.nodes.begin(), c.nodes.end(), [&](const CouplingNode<T>& node) {
           return node.state >= 0 && states[node.state]->parked;
         });
}

template <class T>
void Couplings<T>::join(States states, std::span<int> group) const {
  for (const auto& c : all_) {
    const int first = first_state(*c);
    if (first < 0 || !works(*c, states)) continue;
    for (const CouplingNode<T>& node : c->nodes) {
      if (node.state < 0 || group[node.state] == group[first]) continue;
      const int from = std::max(group[node.state], group[first]);
      const int to = std::min(group[node.state], group[first]);
      std::replace(group.begin(), group.end(), from, to);
    }
  }
}

template <class T>
std::span<Coupling<T>* const> Couplings<T>::of_island(States states, std::span<const int> group, int island) {
  chosen_.clear();
  for (const auto& c : all_)
    if (const int first = first_state(*c); first >= 0 && group[first] == island && works(*c, states))
      chosen_.push_back(c.get());
  return chosen_;
}

template class Couplings<float>;
template class Couplings<double>;

}  // namespace sinew
