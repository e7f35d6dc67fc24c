// What ties the trees of a world together: loops, and the elements of particle bodies. Internal to the
// character layer.
#pragma once

#include <algorithm>
#include <memory>
#include <span>
#include <vector>

#include "sinew/character/contact_finder.h"
#include "sinew/effects/coupling.h"
#include "sinew/optimizer/solve_capacity.h"

namespace sinew {

template <class T>
class Couplings {
 public:
  using States = std::span<const std::unique_ptr<CharacterState<T>>>;

  /// Set-up. Returns its index.
  int add(Coupling<T> coupling);
  void drop_last();
  /// Set-up: two bodies never touch each other.
  void keep_apart(const BodyPair& pair) { apart_.push_back(pair); }
  /// Of whole states.
  void set_apart(int a, int b, bool apart);
  /// Whether no body of one ever touches one of the other.
  bool are_apart(int a, int b) const;
  /// Adds what all of them bring to solves, after all states; what they may tie together is solved as one,
  /// and each bears the weight of the heaviest of it. `gravity`: m/s².
  void count_in(States states, double gravity, SolveCapacities& rooms);
  /// What one of them brings to a solve, as counted.
  const SolveCapacity& capacity(int index) const { return capacities_[index]; }

  Coupling<T>& operator[](int index) { return *all_[index]; }
  const Coupling<T>& operator[](int index) const { return *all_[index]; }
  std::span<const std::unique_ptr<Coupling<T>>> all() const { return all_; }
  std::span<const BodyPair> apart() const { return apart_; }

  /// Finds those that are switched on and whose trees are all in the world, and marks these trees as tied.
  void begin_step(States states);
  /// Indices of these, ascending. Each has a node on a tree.
  std::span<const int> working() const { return working_; }

 private:
  bool works(const Coupling<T>& coupling, States states) const;

  std::vector<std::unique_ptr<Coupling<T>>> all_;
  std::vector<SolveCapacity> capacities_;
  std::vector<int> working_;
  std::vector<BodyPair> apart_;
};

/// Before a step of h seconds of these trees, whose numbers are `indices`: tells the couplings' nodes which
/// tree of the solve they are on, and lets what is open close by a step.
template <class T>
void begin_couplings(std::span<Coupling<T>* const> couplings, std::span<CharacterState<T>* const> states,
                     std::span<const int> indices);

/// What the couplings of a solve store, J, that is booked to one of its trees: that of a coupling's first
/// node that is on one.
template <class T>
double elastic_of(std::span<Coupling<T>* const> couplings, int tree) {
  double sum = 0;
  for (const Coupling<T>* c : couplings) {
    const auto moving = std::find_if(c->nodes.begin(), c->nodes.end(),
                                     [](const CouplingNode<T>& node) { return node.tree >= 0; });
    if (moving != c->nodes.end() && moving->tree == tree) sum += c->energy;
  }
  return sum;
}

/// Calls `what` with the number of each node's tree, where it is on one.
template <class T, class Function>
void for_each_tree(const Coupling<T>& coupling, Function what) {
  for (const CouplingNode<T>& node : coupling.nodes)
    if (node.state >= 0) what(node.state);
}

/// The first of these, or −1.
template <class T>
int first_tree(const Coupling<T>& coupling) {
  for (const CouplingNode<T>& node : coupling.nodes)
    if (node.state >= 0) return node.state;
  return -1;
}

extern template class Couplings<float>;
extern template class Couplings<double>;
extern template void begin_couplings<float>(std::span<Coupling<float>* const>,
                                            std::span<CharacterState<float>* const>, std::span<const int>);
extern template void begin_couplings<double>(std::span<Coupling<double>* const>,
                                             std::span<CharacterState<double>* const>, std::span<const int>);

}  // namespace sinew
