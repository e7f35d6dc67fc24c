// Energy of a ball joint's three muscles that share one limit: an ellipsoid of torques instead of a box.
//
//     ψ(s) = ‖D s‖,  D = diag(limit of each axis on the side that pulls back)
//
// s is the offset from the muscles' target. Its gradient D²s/‖D s‖ is a torque on the ellipsoid Σ (τ/D)² = 1,
// so the joint feels exactly the limit, whichever way it is off; at the target any torque inside balances.
// The kink there is rounded as those of single muscles are. Convex, and smooth where an offset changes sign
// and with it the side that pulls: there the component adds nothing.
#pragma once

#include <algorithm>

#include "sinew/skeleton/transform.h"

namespace sinew {

template <class T>
struct EllipsoidRow {
  int dof = 0;                         ///< first of the joint's three degrees of freedom, within its tree
  Mat3<T> gradient = Mat3<T>::Zero();  ///< ds/dd
  Vec3<T> value = Vec3<T>::Zero();     ///< s at the chart centre, rad
  Vec3<T> minus = Vec3<T>::Zero();     ///< N·m; pulls back where s > 0
  Vec3<T> plus = Vec3<T>::Zero();      ///< N·m; where s < 0
  T width = T(1e-5);                   ///< rad, rounding along the strongest axis

  T energy(const Vec3<T>& s) const {
    const T r = sides(s).cwiseProduct(s).norm(), rounding = this->rounding();
    return r < rounding ? r * r / (2 * rounding) : r - rounding / 2;
  }
  /// dψ/ds, N·m.
  Vec3<T> slope(const Vec3<T>& s) const {
    const Vec3<T> d = sides(s);
    const T r = std::max(d.cwiseProduct(s).norm(), rounding());
    return r > T(0) ? Vec3<T>(d.cwiseProduct(d).cwiseProduct(s) / r) : Vec3<T>(Vec3<T>::Zero());
  }
  /// d²ψ/ds², positive semidefinite.
  Mat3<T> curvature(const Vec3<T>& s) const {
    const Vec3<T> d = sides(s), u = d.cwiseProduct(s);
    const T r = u.norm();
    Mat3<T> in_u = Mat3<T>::Identity();
    if (r >= rounding() && r > T(0)) in_u -= u * u.transpose() / (r * r);
    const T scale = std::max(r, rounding());
    return scale > T(0) ? Mat3<T>(d.asDiagonal() * in_u * d.asDiagonal() / scale) : Mat3<T>(Mat3<T>::Zero());
  }

 private:
  Vec3<T> sides(const Vec3<T>& s) const {
    return (s.array() > T(0)).select(minus.array(), plus.array()).matrix();
  }
  T rounding() const { return width * std::max(minus.maxCoeff(), plus.maxCoeff()); }
};

}  // namespace sinew
