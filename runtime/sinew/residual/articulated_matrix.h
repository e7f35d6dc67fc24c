// The matrix of composite.h for a tree that nothing couples beyond its joints, kept and solved joint by
// joint.
//
// Seen from above joint k, the subtree that it moves is a quadratic form of the motion V (w, v) of its
// parent,
//     ½ Vᵀ(C − E)V + p·V,
// C its composite body with the geometric terms. Eliminating the joint's own unknowns d, with motion axes S,
// leaves one of the same kind, that of an articulated body (Featherstone, "Rigid Body Dynamics Algorithms",
// 2008, chapter 7):
//     U = C S − E S,   LLᵀ = D − SᵀE S,   Y = U L⁻ᵀ,   E ← E + Y Yᵀ.
// O(unknowns), where TreeMatrix is O(unknowns·depth²): built, factorised and solved once, 30 thousand
// instructions instead of 52 for a humanoid's 37 unknowns (callgrind, float). Contacts act along whole paths,
// and are TreeMatrix's.
#pragma once

#include <algorithm>
#include <span>
#include <vector>

#include "sinew/residual/articulated_pass.h"

namespace sinew {

template <class T>
class ArticulatedMatrix {
 public:
  /// Set-up for a tree of so many bodies and unknowns; nothing allocates afterwards.
  void reserve(int bodies, int unknowns);
  static std::size_t bytes(int bodies, int unknowns) {
    return bodies * (sizeof(JointBlock) + sizeof(SpatialForm<T>) + 2 * sizeof(SpatialVector<T>)) +
           unknowns * (sizeof(int) + 3 * sizeof(SpatialVector<T>) + 2 * sizeof(JointBlockRow<T>));
  }

  /// What assemble_tree_matrix and add_floor make of the same arguments, for a tree whose unknowns are all
  /// there are. O(bodies + unknowns).
  void assemble(const Tree<T>& tree, const Kinematics<T>& kinematics, std::span<Composite<T>> bodies,
                const Unknowns& unknowns, bool geometric);
  /// Adds to entry (k, l), l ≤ k, of two unknowns of one joint.
  void add(int k, int l, T value) { parts_.own_entry(k, l) += value; }
  /// y = H·x.
  void multiply(std::span<const T> x, std::span<T> y);

  /// Copies H to where it is factorised; there add_to_factor() adds as add() does.
  void begin_factor() { std::copy_n(own_.begin(), size_, factor_.begin()); }
  void add_to_factor(int k, int l, T value) { parts_.factor_entry(k, l) += value; }
  /// False where that is not positive definite; as TreeMatrix::factorise.
  bool factorise();
  /// Solves with the factor, in place.
  void solve(std::span<T> b);

 private:
  std::vector<JointBlock> blocks_;
  std::vector<int> first_;
  std::vector<SpatialVector<T>> axes_, moved_, reduced_, force_, motion_;
  std::vector<JointBlockRow<T>> own_, factor_;
  std::vector<SpatialForm<T>> eliminated_;
  ArticulatedParts<T> parts_;  ///< these
  int size_ = 0;               ///< unknowns
};

extern template class ArticulatedMatrix<float>;
extern template class ArticulatedMatrix<double>;

}  // namespace sinew
