// Coupling elements as the inner problem sees them: a quadratic form of their nodes' displacements.
//
// Jacobians are kept per node, not per element: a product first moves the nodes, then lets the elements pull
// on them, then projects what every node feels on its path. What one path holds (a loop to the world or up
// the tree, each particle's own block) also goes into the tree matrix; the rest couples unknowns that no path
// joins and is left to conjugate gradients, as with contacts between trees.
#pragma once

#include <span>
#include <vector>

#include "sinew/effects/coupling.h"
#include "sinew/optimizer/problem.h"

namespace sinew {

/// Puts every node where its body is now, `common_origin` in world coordinates.
template <class T>
void place_nodes(std::span<TreeProblem<T>* const> trees, const Vec3<double>& common_origin,
                 Coupling<T>& coupling);

/// Adds the nodes' gradients to the wrenches of their bodies (after begin_evaluation).
template <class T>
void add_wrenches(const Coupling<T>& coupling, std::span<TreeProblem<T>* const> trees);

template <class T>
class CouplingRows {
 public:
  /// Set-up; nothing allocates afterwards.
  void reserve(const SolveRoom& room);
  /// That reserve() takes.
  static std::size_t bytes(const SolveRoom& room) {
    return room.nodes * (sizeof(Node) + 2 * sizeof(Vec3<T>)) + room.stencils * sizeof(Stencils) +
           room.tetrahedra * sizeof(Tetrahedra) + room.node_entries * 3 * sizeof(T);
  }

  /// Linearises all elements about the present kinematics of `trees`, where their nodes have been placed.
  void collect(std::span<TreeProblem<T>* const> trees, std::span<Coupling<T>* const> couplings,
               const Unknowns& unknowns, const PathAxes<T>& axes);
  bool empty() const { return stencils_.empty() && tetrahedra_.empty(); }
  /// Some element has unknowns on paths that part.
  bool coupled() const { return coupled_; }

  /// Adds what lies within paths, without what could make the matrix indefinite: unknowns that several parted
  /// branches of an element share are left out, as they hardly change its energy.
  void add_curvature(TreeMatrix<T>& matrix) const;
  /// y += the whole second derivative · x.
  void multiply(std::span<const T> x, std::span<T> y) const;

 private:
  struct Node {
    int leaf = -1;   ///< last unknown of its path; −1: nothing moves it
    int first = 0;   ///< of its entries
    int single = 0;  ///< a particle: its path is its own three translations along the world's axes
  };
  struct Stencils {
    int count = 0;
    int node[4];
    T weight[4];
    Mat3<T> curvature;
  };
  struct Tetrahedra {
    int node[4];
    TetrahedronHessian<T> curvature;
  };

  void add_node(const CouplingNode<T>& node, std::span<TreeProblem<T>* const> trees, const Unknowns& unknowns,
                const PathAxes<T>& axes);
  int cut(const int* nodes, int count, int node) const;
  void add_block(int i, int j, const Mat3<T>& block, int from, TreeMatrix<T>& matrix) const;
  void note_coupling(const int* nodes, int count);

  const TreePattern* pattern_ = nullptr;
  std::vector<Node> nodes_;
  std::vector<T> along_[3];  ///< [entry] displacement per unknown, world axes, root first
  std::vector<Stencils> stencils_;
  std::vector<Tetrahedra> tetrahedra_;
  mutable std::vector<Vec3<T>> moved_, pulled_;  ///< [node] of a product
  bool coupled_ = false;
};

#define SINEW_COUPLING_ROWS_INSTANCES(prefix, T)                                                   \
  prefix class CouplingRows<T>;                                                                    \
  prefix void place_nodes<T>(std::span<TreeProblem<T>* const>, const Vec3<double>&, Coupling<T>&); \
  prefix void add_wrenches<T>(const Coupling<T>&, std::span<TreeProblem<T>* const>);
SINEW_COUPLING_ROWS_INSTANCES(extern template, float)
SINEW_COUPLING_ROWS_INSTANCES(extern template, double)

}  // namespace sinew
