// The matrix of composite.h for a tree that nothing couples beyond its joints, kept and solved joint by joint.
//
// Seen from above joint k, the subtree that it moves is a quadratic form of the motion V (w, v) of its parent,
//     ½ Vᵀ(C − E)V + p·V,
// C its composite body with the geometric terms. Eliminating the joint's own unknowns d, with motion axes S,
// leaves one of the same kind, that of an articulated body (Featherstone, "Rigid Body Dynamics Algorithms",
// 2008, chapter 7):
//     U = C S − E S,   LLᵀ = D − SᵀE S,   Y = U L⁻ᵀ,   E ← E + Y Yᵀ.
// O(unknowns), where TreeMatrix with its assembly is O(unknowns·depth²): 12 thousand instructions instead of
// 47 for a humanoid's 37 unknowns. Contacts act along whole paths, and are TreeMatrix's.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "sinew/residual/composite.h"

namespace sinew {

template <class T>
class ArticulatedMatrix {
 public:
  /// Set-up for a tree of so many bodies and unknowns; nothing allocates afterwards.
  void reserve(int bodies, int unknowns);
  static std::size_t bytes(int bodies, int unknowns) {
    return bodies * (sizeof(Block) + sizeof(Form) + 2 * sizeof(Motion)) +
           unknowns * (3 * sizeof(Motion) + 2 * sizeof(Row));
  }

  /// What assemble_tree_matrix and add_floor make of the same arguments, for a tree whose unknowns are all
  /// there are. O(bodies + unknowns).
  void assemble(const Tree<T>& tree, const Kinematics<T>& kinematics, std::span<Composite<T>> bodies,
                const Unknowns& unknowns, bool geometric);
  /// Adds to entry (k, l), l ≤ k, of two unknowns of one joint.
  void add(int k, int l, T value) { own_[k][l - first_[k]] += value; }
  /// y = H·x.
  void multiply(std::span<const T> x, std::span<T> y);

  /// Copies H to where it is factorised; there add_to_factor() adds as add() does.
  void begin_factor() { factor_ = own_; }
  void add_to_factor(int k, int l, T value) { factor_[k][l - first_[k]] += value; }
  /// False where that is not positive definite; as TreeMatrix::factorise.
  bool factorise();
  /// Solves with the factor, in place.
  void solve(std::span<T> b);

 private:
  using Motion = Eigen::Array<T, 8, 1>;  ///< (w, v) or (moment, force), two zeros behind: whole vectors
  using Form = std::array<Motion, 6>;
  using Row = std::array<T, 6>;  ///< of the block of one joint, entries up to the diagonal
  struct Block {
    int parent = -1;
    int first = 0, count = 0;  ///< unknowns
    bool laden = false;        ///< its E is not zero
  };

  std::vector<Block> blocks_;           ///< [body]
  std::vector<int> first_;              ///< [unknown] of its block
  std::vector<Motion> axes_;            ///< [unknown] S
  std::vector<Motion> moved_;           ///< [unknown] C·S: what moving it asks of those above
  std::vector<Motion> reduced_;         ///< [unknown] Y
  std::vector<Row> own_, factor_;       ///< [unknown] D; L, its diagonal inverted
  std::vector<Form> eliminated_;        ///< [body] E
  std::vector<Motion> force_, motion_;  ///< [body] p, V
};

extern template class ArticulatedMatrix<float>;
extern template class ArticulatedMatrix<double>;

}  // namespace sinew
