// Contacts as the inner convex problem sees them: gap and slips linear in the unknowns, energies exact.
//
// Each side of a contact moves with the unknowns on one path of its tree, so its rows are stored root first,
// component by component: adding a contact to a tree matrix is a contiguous vector update per unknown. What
// couples two sides leaves the tree's sparsity: it is applied as a product (see multiply), or joined to the
// factor as rows (row_factor.h).
#pragma once

#include <memory>
#include <span>

#include "sinew/optimizer/problem.h"
#include "sinew/residual/row_factor.h"

namespace sinew {

/// As a solve calls it. This one has no contacts, as a world has that declares none.
template <class T>
class ContactModel {
 public:
  using Trees = std::span<TreeProblem<T>* const>;

  virtual ~ContactModel() = default;
  /// Set-up for so many contacts and entries of their paths; nothing allocates afterwards.
  virtual void reserve(int /*contacts*/, int /*entries*/) {}
  /// That reserve() takes.
  virtual std::size_t bytes(const SolveCapacity& /*capacity*/) const { return 0; }
  /// Of the coming solve: as many entries as its trees have room for, whoever else the memory serves.
  virtual void limit(int /*entries*/) {}

  /// Measures all contacts at the present kinematics of `trees`; adds their energy (J), and its gradient to
  /// the wrenches.
  virtual void evaluate(Trees /*trees*/, std::span<Contact<T>> /*contacts*/, T /*stick*/,
                        double& /*energy*/) const {}
  /// Geometric terms of friction and of the normal forces expected, into the trees' composites.
  virtual void add_forces(Trees /*trees*/, std::span<const Contact<T>> /*contacts*/, T /*stick*/) const {}

  /// Linearises all contacts nearer than `near` (m) about the present kinematics of `trees`.
  virtual void collect(Trees /*trees*/, std::span<const Contact<T>> /*contacts*/,
                       const Unknowns& /*unknowns*/, const PathAxes<T>& /*axes*/, T /*near*/, T /*stick*/) {}
  virtual bool empty() const { return true; }
  /// Some contact has unknowns on both sides; of one of those the surface bends, or slides.
  virtual bool coupled() const { return false; }
  virtual bool bends_across() const { return false; }
  virtual bool slides_across() const { return false; }

  /// Changes of gaps and slips along a direction, for slope() and move().
  virtual void look_along(std::span<const T> /*direction*/) {}
  /// Derivative of the contacts' energy by t, t along that direction. J.
  virtual T slope(T /*t*/) const { return T(0); }
  /// Goes on by t along that direction.
  virtual void move(T /*t*/) {}
  /// Re-measures: as far from the chart centres as the direction leads, gaps and slips are the contacts' own
  /// (second-order correction).
  virtual void correct(std::span<const Contact<T>> /*contacts*/) {}
  /// Gaps and slips as the contacts have them now.
  virtual void measure(std::span<const Contact<T>> /*contacts*/) {}
  /// Whether the last factor is still good: no curvature has changed much since measure_curvature(). Where
  /// what couples two sides was left to products, as `apart` says: none that there is.
  virtual bool in_factor(T /*drag*/, bool /*apart*/) const { return true; }
  /// Tells the contacts the normal forces at the inner solution.
  virtual void expect_forces(std::span<Contact<T>> /*contacts*/) const {}

  /// gradient += ∂E/∂d at the present gaps and slips.
  virtual void add_gradient(std::span<T> /*gradient*/) const {}
  /// Second derivatives at the present gaps and slips, for all that follows. Friction resists further slip at
  /// least by the share `drag` of what it resists across.
  virtual void measure_curvature(T /*drag*/) {}
  /// Adds each side's of them; what couples two sides is left out. Without `across` contacts that do are left
  /// to add_rows().
  virtual void add_curvature(TreeMatrix<T>& /*matrix*/, bool /*across*/) const {}
  /// Appends those that bear something. False where there is no room.
  virtual bool add_rows(const TreePattern& /*pattern*/, RowFactor<T>& /*rows*/) const { return true; }
  /// y += the whole second derivative · x, both sides and what couples them.
  virtual void multiply(std::span<const T> /*x*/, std::span<T> /*y*/) const {}
  /// y += what couples two sides · x: all that add_curvature leaves out.
  virtual void multiply_coupling(std::span<const T> /*x*/, std::span<T> /*y*/) const {}
  /// Geometric term: the surface's own bending turns the normal, −force·∇²distance. Per side, and what
  /// couples two sides.
  virtual void add_bending(TreeMatrix<T>& /*matrix*/) const {}
  virtual void multiply_bending(std::span<const T> /*x*/, std::span<T> /*y*/) const {}
  /// Geometric term of lines that slide along each other, force·(lever·μ² − 2μw), as far as it stiffens (see
  /// Sliding): a model without it takes figures that lie across each other to where their limbs are pressed
  /// many times as hard. Per side, and what couples two sides.
  virtual void add_sliding(TreeMatrix<T>& /*matrix*/) const {}
  virtual void multiply_sliding(std::span<const T> /*x*/, std::span<T> /*y*/) const {}
};

/// With contacts.
template <class T>
std::unique_ptr<ContactModel<T>> make_contact_rows();

extern template std::unique_ptr<ContactModel<float>> make_contact_rows<float>();
extern template std::unique_ptr<ContactModel<double>> make_contact_rows<double>();

}  // namespace sinew
