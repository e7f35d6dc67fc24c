// The convex model of one outer pass: kinematics frozen, contact and joint rows linear, their one-sided
// energies exact.
//
//     m(d) = g·d + ½ dᵀ H₀ d + Σ contact rows + Σ joint rows
//
// H₀ is inertia with the geometric terms. Minimised by Newton with an exact line search in row space until
// its steps have shrunk to a tenth. While nothing couples two branches the matrix has the tree's sparsity and
// is factorised exactly; loops that do are joined to that factor (row_factor.h); contacts between trees, or
// between branches of one, are left to preconditioned conjugate gradients with it (6–10 products;
// solver-prototype, addendum D), and joined with loops where those take many.
#pragma once

#include <span>
#include <vector>

#include "sinew/optimizer/contact_rows.h"
#include "sinew/optimizer/coupling_rows.h"
#include "sinew/optimizer/ellipsoid_rows.h"
#include "sinew/optimizer/newton_constants.h"
#include "sinew/optimizer/problem.h"
#include "sinew/residual/articulated_matrix.h"

namespace sinew {

struct InnerReport {
  bool solved = false;      ///< false: H₀ was indefinite where the rows did not help
  double first_length = 0;  ///< m, of the first Newton step
  bool straight = false;    ///< that was all: no row had a kink on its way
};

/// Of which forces a model has geometric terms.
enum class Geometry : std::uint8_t { kNone, kTies, kAll };

template <class T>
class InnerProblem {
 public:
  /// Set-up, before reserve(): what `plan` has rows of, it can solve.
  void declare(const StepPlan<T>& plan);
  void reserve(const SolveCapacity& capacity);
  /// That reserve() takes.
  std::size_t bytes(const SolveCapacity& capacity) const {
    return contact_rows_->bytes(capacity) +
           RowFactor<T>::bytes(groups_across(capacity), entries_across(capacity)) +
           (couplings_ ? couplings_->bytes(capacity) : 0) +
           (ellipsoid_model_ ? ellipsoid_model_->bytes(capacity.dofs / 3) : 0) +
           capacity.dofs * (8 * sizeof(JointRows) + 14 * sizeof(T) + 8 * sizeof(int)) +
           capacity.effect_rows * sizeof(JointRows) + capacity.path_entries * 8 * sizeof(T) +
           capacity.bodies * 2 * sizeof(Vec3<T>) +
           ArticulatedMatrix<T>::bytes(capacity.bodies, capacity.dofs);
  }

  /// Numbers the unknowns of all trees.
  void begin(const StepSettings<T>& settings, std::span<TreeProblem<T>* const> trees);
  int size() const { return unknowns_.pattern.size; }
  /// Unknown of a tree's degree of freedom, or −1.
  int unknown(const TreeProblem<T>& tree, int dof) const {
    return unknowns_.of_dof[tree.first_unknown_map + dof];
  }

  /// Model about the present pose, whose gradient and wrenches the trees hold. Trees in contact with each
  /// other have geometric terms of what ties them only, asked for all or not: in a pile they led astray
  /// (README.md).
  void build(std::span<const Contact<T>> contacts, std::span<Coupling<T>* const> couplings, bool geometric);
  /// Whether the model has geometric terms.
  bool geometric() const { return geometry_ != Geometry::kNone; }
  /// Whether nothing but what joints do acts on the tree; it is one then.
  bool joints_only() const { return articulated_; }
  /// Minimises from the chart centres; the minimiser is correction().
  InnerReport minimise(T tolerance);
  /// Tells the contacts the normal forces at the minimiser, whose geometric terms the next model has.
  void expect_forces(std::span<Contact<T>> contacts) const { contact_rows_->expect_forces(contacts); }
  /// Second-order correction: the model again, with gaps and slips as the contacts found them where the
  /// correction led, and the old Jacobians. Call minimise() after it.
  void correct(std::span<const Contact<T>> contacts);

  /// Simplified Newton step, from where the last correction led: true gradient, rows as the trees
  /// and `contacts` found them there, this pass's H₀ and Jacobians. It becomes correction(); the model is
  /// spent. Returns its length (m, see displacement), infinite where there is none. Costs a factorisation
  /// where a row has changed much.
  double simplified_newton_step(std::span<const Contact<T>> contacts);

  const ContactModel<T>& contacts() const { return *contact_rows_; }
  std::vector<T>& correction() { return correction_; }
  const std::vector<T>& correction() const { return correction_; }
  bool has_contacts() const { return !contact_rows_->empty(); }
  /// Directional derivative of the true energy at the chart centres.
  T slope(std::span<const T> direction) const;
  /// Directional derivative with the gradient that the trees hold now.
  T slope_now(std::span<const T> direction) const;
  /// Largest displacement (m) of any body with mass along a direction: of its centre plus 0.15 m per radian.
  /// Infinite where it is no number.
  T displacement(std::span<const T> direction) const;

  int factorisations = 0;  ///< since begin()
  int products = 0;        ///< of conjugate gradients, since begin()

 private:
  /// Contacts across paths that are joined to a factor with loops at most, and entries of their paths.
  static constexpr int kMostJoined = 48, kMostJoinedEntries = 2048;

  static int groups_across(const SolveCapacity& c) {
    return c.loops > 0 ? c.loops + std::min(c.contacts, kMostJoined) : 0;
  }
  static int entries_across(const SolveCapacity& c) {
    return c.loops > 0 ? c.loop_entries + std::min(c.contact_entries, kMostJoinedEntries) : 0;
  }

  struct JointRows {
    JointRow<T> row;
    int unknown = 0;  ///< of the row's first degree of freedom
    T value = T(0), d_value = T(0);
    T in_factor = T(0);  ///< curvature that the last factor holds

    /// At the inner solution so far. Beyond its kink a muscle pulls with the same force however far it gives
    /// way; `secant` is the share of that force by its way from the kink that counts.
    T curvature(T secant) const {
      const T exact = row.curvature(value);
      const bool beyond = secant > T(0) && exact == T(0) && value != T(0) &&
                          (row.kind == RowKind::kKink || row.kind == RowKind::kTone);
      return beyond ? secant * row.slope(value) / value : exact;
    }
    /// Whether a whole step from the inner solution so far changes the slope otherwise than the factor has
    /// it.
    bool bends() const {
      const T from = row.slope(value), to = from + in_factor * d_value;
      return std::abs(row.slope(value + d_value) - to) > T(kSameSlope) * (std::abs(from) + std::abs(to));
    }
  };

  /// Shares of a secant stiffness that count as curvature where a force does not grow and the true one is
  /// none. With that, steps run on to where many such forces have turned round, and a line search stops at
  /// the first.
  struct Secants {
    T slips = T(0);    ///< of contacts: of what friction resists along a slip, by what it resists across it
    T muscles = T(0);  ///< beyond their kinks
  };

  void assemble(std::span<const Contact<T>> contacts, std::span<Coupling<T>* const> couplings);
  bool rounded() const;
  bool tied() const { return couplings_ && !couplings_->empty(); }
  bool coupled() const {
    return contact_rows_->coupled() ||
           (couplings_ && (couplings_->loops_coupled() || couplings_->others_coupled()));
  }
  bool ties_left() const;
  bool left_out() const;
  bool join();
  void assemble_articulated();
  template <class Add>
  void add_joint_geometry(TreeProblem<T>& tree, const Add& add);
  template <class Add>
  void add_row_curvature(T secant, const Add& add);
  void add_row_gradient(std::span<T> gradient) const;
  T row_slope(T t) const;
  T exact_line_search(T quadratic, T linear) const;
  bool factorise(const Secants& secants);
  void solve_factored(std::span<T> b);
  bool factor_holds(const Secants& secants) const;
  bool newton_step(const Secants& secants, bool reuse);
  bool conjugate_gradients();
  double remaining_step();
  void multiply_smooth(std::span<const T> x, std::span<T> y);
  void multiply_full(std::span<const T> x, std::span<T> y);

  const StepSettings<T>* settings_ = nullptr;
  std::span<TreeProblem<T>* const> trees_;
  Unknowns unknowns_;
  PathAxes<T> axes_;
  TreeMatrix<T> smooth_{unknowns_.pattern};  ///< H₀, without ties
  TreeMatrix<T> factor_{unknowns_.pattern};  ///< of H₀ + rows, without what couples branches
  RowFactor<T> across_;                      ///< joined to it: loops across paths, and contacts
  bool joins_loops_ = false, joins_contacts_ = false;
  bool products_are_dear_ = false;  ///< conjugate gradients of this solve took many
  ArticulatedMatrix<T> joints_;     ///< in place of these where nothing but joints acts on a tree
  bool articulated_ = false;        ///< it is
  Geometry geometry_ = Geometry::kAll;
  int most_entries_ = 0;  ///< of contact rows, that there is memory for
  std::unique_ptr<ContactModel<T>> contact_rows_ = std::make_unique<ContactModel<T>>();
  std::unique_ptr<CouplingModel<T>> couplings_;         ///< null: none are declared
  std::unique_ptr<EllipsoidModel<T>> ellipsoid_model_;  ///< the same
  EllipsoidModel<T>* ellipsoids_ = nullptr;             ///< that one; null too where no joint has any
  std::vector<JointRows> joint_rows_;
  std::vector<T> base_gradient_;    ///< of the true energy at the chart centres
  std::vector<T> smooth_gradient_;  ///< the same without the rows
  std::vector<T> inner_gradient_;   ///< of the model at the inner solution so far
  std::vector<T> step_, product_, correction_, correction_product_;
  std::vector<T> residual_, preconditioned_, direction_, factored_;  ///< conjugate gradients
  std::vector<T> path_;                                              ///< one row of add_stiffness
  mutable std::vector<Vec3<T>> turn_, slide_;                        ///< [body] of displacement()
};

extern template class InnerProblem<float>;
extern template class InnerProblem<double>;

}  // namespace sinew
