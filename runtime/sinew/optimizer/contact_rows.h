// Contacts as the inner convex problem sees them: gap and slips linear in the unknowns, energies exact.
//
// Each side of a contact moves with the unknowns on one path of its tree, so its rows are stored root first,
// component by component: adding a contact to a tree matrix is a contiguous vector update per unknown. What
// couples two sides leaves the tree's sparsity and is only ever applied as a product (see multiply).
#pragma once

#include <array>
#include <span>
#include <vector>

#include "sinew/optimizer/problem.h"

namespace sinew {

template <class T>
class ContactRows {
 public:
  /// Set-up for so many contacts and entries of their paths; nothing allocates afterwards.
  void reserve(int contacts, int entries);
  /// That reserve() takes.
  static std::size_t bytes(const SolveRoom& room) {
    return room.contacts * sizeof(Row) + room.contact_entries * (sizeof(int) + 6 * sizeof(T));
  }
  /// Of the coming solve: as many entries as its trees have room for, whoever else the memory serves.
  void limit(int entries) { most_entries_ = entries; }

  /// Linearises all contacts nearer than `near` (m) about the present kinematics of `trees`.
  void collect(std::span<TreeProblem<T>* const> trees, std::span<const Contact<T>> contacts,
               const Unknowns& unknowns, const PathAxes<T>& axes, T near, T stick);
  bool empty() const { return rows_.empty(); }
  /// Some contact has unknowns on both sides.
  bool coupled() const { return coupled_; }

  /// Changes of gaps and slips along a direction, for slope() and move().
  void look_along(std::span<const T> direction);
  /// Derivative of the contacts' energy by t, t along that direction. J.
  T slope(T t) const;
  /// Goes on by t along that direction.
  void move(T t);
  /// Re-measures: as far from the chart centres as the direction leads, gaps and slips are the contacts' own
  /// (second-order correction).
  void correct(std::span<const Contact<T>> contacts);
  /// Gaps and slips as the contacts have them now. True where that changes nothing that the last
  /// factor holds.
  bool measure(std::span<const Contact<T>> contacts);

  /// gradient += ∂E/∂d at the present gaps and slips.
  void add_gradient(std::span<T> gradient) const;
  /// Adds each side's second derivative at the present gaps and slips; what couples two sides is left out.
  void add_curvature(TreeMatrix<T>& matrix);
  /// y += the whole second derivative · x, both sides and what couples them.
  void multiply(std::span<const T> x, std::span<T> y) const;
  /// Geometric term: the surface's own bending turns the normal, −force·∇²distance. Per side, and what
  /// couples two sides.
  void add_bending(TreeMatrix<T>& matrix) const;
  void multiply_bending(std::span<const T> x, std::span<T> y) const;

 private:
  struct Side {
    int first = 0;  ///< of its entries
    int count = 0;
    int depth = 0;  ///< position of the first entry on its unknown's path
  };
  struct Row {
    int contact = 0;
    Side side[2];
    T stiffness = T(0), grip = T(0);  ///< N/m, μλ in N
    T stretch = T(1);                 ///< change of the damped gap by the gap
    T gap = T(0), slip[2]{};          ///< at the inner solution so far; the gap is the damped one
    T d_gap = T(0), d_slip[2]{};      ///< along the direction looked at
    bool in_factor = false;           ///< the last factor holds some curvature of it
    bool bends = false;
    Mat3<T> bending = Mat3<T>::Zero();  ///< −force·∇²distance, N/m, world axes
  };
  /// Second derivative by (gap, slip 1, slip 2).
  struct Block {
    T normal = T(0), slip11 = T(0), slip12 = T(0), slip22 = T(0);
    bool zero() const { return normal <= T(0) && slip11 <= T(0) && slip22 <= T(0); }
  };

  Side add_side(const Contact<T>& contact, int leaf, const Vec3<T>& material, T sign, int above,
                const TreePattern& pattern, const PathAxes<T>& axes);
  Block block(const Row& row) const;

  std::vector<Row> rows_;
  std::vector<int> unknown_;  ///< [entry]
  std::vector<T> gap_, slip_[2],
      move_[3];  ///< [entry] change per unknown; move_: of the contact point, world
  int most_entries_ = 0;
  T stick_ = T(0);
  bool coupled_ = false;
};

extern template class ContactRows<float>;
extern template class ContactRows<double>;

}  // namespace sinew
