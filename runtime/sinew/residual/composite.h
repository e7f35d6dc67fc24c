// Composite bodies: the tree-shaped matrix of a quadratic form that is given per body.
#pragma once

#include <span>

#include "sinew/residual/path_axes.h"
#include "sinew/residual/tree.h"
#include "sinew/residual/tree_factor.h"

namespace sinew {

/// Quadratic form of one body's small motion (w, v) about the common origin,
///     ½ m |v|² + v·(w × mc) + ½ wᵀ K w,
/// and the wrench-like sums that make the second derivative of the pose itself (see assemble_tree_matrix).
/// All members add up along the tree.
template <class T>
struct Composite {
  T mass = T(0);
  Vec3<T> first = Vec3<T>::Zero();       ///< mass · centre
  Mat3<T> rotational = Mat3<T>::Zero();  ///< K about the common origin
  Vec3<T> force = Vec3<T>::Zero();       ///< F = Σ f, gradient of the energy by translation
  Vec3<T> couple = Vec3<T>::Zero();      ///< G = Σ g, gradient by rotation that no force explains
  Mat3<T> virial = Mat3<T>::Zero();      ///< S = Σ (x fᵀ − (x·f)·1), forces at their points

  Composite& operator+=(const Composite& other) {
    mass += other.mass;
    first += other.first;
    rotational += other.rotational;
    force += other.force;
    couple += other.couple;
    virial += other.virial;
    return *this;
  }

  /// A rigid body: mass m at c, rotational stiffness K_c about c.
  void add_body(T m, const Vec3<T>& c, const Mat3<T>& about_center) {
    mass += m;
    first += m * c;
    rotational += about_center + m * (c.squaredNorm() * Mat3<T>::Identity() - c * c.transpose());
  }
  /// A force gradient f at the material point x.
  void add_force(const Vec3<T>& x, const Vec3<T>& f) {
    force += f;
    virial += x * f.transpose() - x.dot(f) * Mat3<T>::Identity();
  }
};

/// Which unknown each degree of freedom is, and back, over one or several trees. Kinematic ones have none and
/// cost nothing.
struct Unknowns {
  TreePattern pattern;
  std::vector<int> of_dof;  ///< [dof, trees one after the other] unknown, or -1
  std::vector<int> dof;     ///< [unknown] degree of freedom within its tree

  void reserve(int dofs);
  void clear();
};

/// Appends a tree: its degrees of freedom with free[dof] ≠ 0 become unknowns. Allocation-free within what was
/// reserved. Returns where the tree's part of `of_dof` begins.
template <class T>
int append_unknowns(const Tree<T>& tree, std::span<const std::uint8_t> free, Unknowns& out);

/// Entries of a tree matrix in which every degree of freedom is an unknown.
template <class T>
int matrix_entries(const Tree<T>& tree);

/// Room that the path of a body's last degree of freedom takes.
template <class T>
int path_entries(const Tree<T>& tree, int body);

/// The last unknown at or above a body, of the tree whose part of `of_dof` begins at `first`; −1 where
/// nothing moves it.
template <class T>
int unknown_above(const Tree<T>& tree, int body, const Unknowns& unknowns, int first);

/// Composite-body recursion (leaves → root): H_kl = S_lᵀ C_k S_k for l on the path of k, C_k the sum over k's
/// subtree. With `geometric`, adds what the turning of the motion axes contributes,
///     w_l · (S w_k + v_k × F + ½ w_k × G),
/// which is Σ f·(w_l × u_k(x)) over the forces of the subtree: the exact second derivative together with K.
/// `bodies` [body] is overwritten by subtree sums; `first` is what append_unknowns answered; only this tree's
/// rows of `out` are written; `axes` holds the paths of all unknowns. O(unknowns · depth).
template <class T>
void assemble_tree_matrix(const Tree<T>& tree, const Kinematics<T>& kinematics, const PathAxes<T>& axes,
                          std::span<Composite<T>> bodies, const Unknowns& unknowns, int first, bool geometric,
                          TreeMatrix<T>& out);

/// Adds to every unknown's diagonal entry what sums of floats cannot resolve anyway, 5e-7 of its subtree's
/// inertia about the common origin, so that elimination never finds a negative pivot in it: a massless link's
/// spin between two ball joints, or a light rope's with a heavy tip, moves almost nothing. In double too it
/// keeps Newton from turning such a link by a radian (passes of the rope: 2.9 instead of 21). `bodies`: the
/// subtree sums that assemble_tree_matrix left.
template <class T>
void add_floor(const Tree<T>& tree, const Kinematics<T>& kinematics, std::span<const Composite<T>> bodies,
               const Unknowns& unknowns, int first, TreeMatrix<T>& out);

#define SINEW_COMPOSITE_INSTANCES(prefix, T)                                                    \
  prefix int append_unknowns<T>(const Tree<T>&, std::span<const std::uint8_t>, Unknowns&);      \
  prefix void add_floor<T>(const Tree<T>&, const Kinematics<T>&, std::span<const Composite<T>>, \
                           const Unknowns&, int, TreeMatrix<T>&);                               \
  prefix int unknown_above<T>(const Tree<T>&, int, const Unknowns&, int);                       \
  prefix int matrix_entries<T>(const Tree<T>&);                                                 \
  prefix int path_entries<T>(const Tree<T>&, int);                                              \
  prefix void assemble_tree_matrix<T>(const Tree<T>&, const Kinematics<T>&, const PathAxes<T>&, \
                                      std::span<Composite<T>>, const Unknowns&, int, bool, TreeMatrix<T>&);
SINEW_COMPOSITE_INSTANCES(extern template, float)
SINEW_COMPOSITE_INSTANCES(extern template, double)

}  // namespace sinew
