// Factorisation of the iteration matrix of a tree of bodies: c·M + D + K/c, unsymmetric, most of it zero.
//
// Mass couples a joint with those on its way to the root only (the zeros of equation 30), and so does a force
// between a body and one that carries it. Eliminated from the leaves to the root such a matrix fills nothing
// in (Featherstone, "Efficient factorization of the joint-space inertia matrix for branched kinematic trees",
// 2005); a force between two branches adds the joints between its bodies, and what eliminating those fills in
// is found once, beforehand.
#pragma once

#include <vector>

#include "sinew/multibody/model.h"
#include "sinew/multibody/motion.h"

namespace sinew::multibody {

class TreeFactor {
 public:
  explicit TreeFactor(const Model& model);

  /// Takes the N×N matrix, whose entries outside the pattern must be zero, and factorises it without
  /// pivoting, in O(N·depth²). False when a pivot is lost to rounding: such a matrix asks for another method.
  bool factorise(const Matrix& a);
  /// Solves in place; O(N·depth).
  void solve(Eigen::Ref<Vector> x) const;

  /// Entries of the pattern, both triangles; N² when everything is coupled.
  long entries() const;

 private:
  std::vector<std::vector<int>>
      above_;  ///< of each joint: those nearer the root that elimination couples it with, ascending
  Matrix factor_;
};

}  // namespace sinew::multibody
