// Coupling elements as the inner problem sees them: a quadratic form of their nodes' displacements.
//
// Jacobians are kept per node, not per element: a product first moves the nodes, then lets the elements pull
// on them, then projects what every node feels on its path. What one path holds (a loop to the world or up
// the tree, each particle's own block) also goes into the tree matrix. Of the rest, which couples unknowns
// that no path joins, loops are solved exactly (row_factor.h), and particles and solids are left to conjugate
// gradients, as contacts between trees are.
#pragma once

#include <memory>
#include <span>

#include "sinew/effects/coupling.h"
#include "sinew/optimizer/problem.h"
#include "sinew/residual/row_factor.h"

namespace sinew {

/// As the inner problem calls it: null there where nothing is tied.
template <class T>
class CouplingModel {
 public:
  virtual ~CouplingModel() = default;
  /// Set-up; nothing allocates afterwards.
  virtual void reserve(const SolveCapacity& capacity) = 0;
  /// That reserve() takes.
  virtual std::size_t bytes(const SolveCapacity& capacity) const = 0;

  /// Linearises all elements about the present kinematics of `trees`, where their nodes have been placed.
  virtual void collect(std::span<TreeProblem<T>* const> trees, std::span<Coupling<T>* const> couplings,
                       const Unknowns& unknowns, const PathAxes<T>& axes) = 0;
  virtual bool empty() const = 0;
  /// Some loop has unknowns on paths that part; some other element.
  virtual bool loops_coupled() const = 0;
  virtual bool others_coupled() const = 0;

  /// Adds what lies within paths, of loops too or without them. Without what could make the matrix
  /// indefinite: unknowns that several parted branches of an element share are left out, as they hardly
  /// change its energy.
  virtual void add_curvature(bool loops, TreeMatrix<T>& matrix) const = 0;
  /// y += the whole second derivative · x.
  virtual void multiply(std::span<const T> x, std::span<T> y) const = 0;

  /// Appends the rows of loops that bear something. False where there is no room.
  virtual bool add_rows(RowFactor<T>& rows) const = 0;
};

/// What couplings do in a step.
template <class T>
struct CouplingTerm {
  std::unique_ptr<CouplingModel<T>> (*make_rows)();
  /// Puts every node where its body is now, `common_origin` in world coordinates; energy and gradients there:
  /// see measure_elements.
  double (*measure)(std::span<TreeProblem<T>* const> trees, const Vec3<double>& common_origin,
                    Coupling<T>& coupling);
  /// Adds the nodes' gradients to the wrenches of their bodies (after begin_evaluation).
  void (*add_wrenches)(const Coupling<T>& coupling, std::span<TreeProblem<T>* const> trees);
  /// See close_slowly.
  void (*close_slowly)(T h, Coupling<T>& coupling);
  bool (*tighten)(Coupling<T>& coupling);
};

/// Declared by whoever ties something: World::add_loop, add_particles.
template <class T>
struct Ties {
  static void declare(StepPlan<T>& plan);
};

extern template struct Ties<float>;
extern template struct Ties<double>;

}  // namespace sinew
