// Vectors and rotations whose numbers are packs. Internal linkage, as pack.h.
#pragma once

#include "sinew/animation/kernels/pack.h"

namespace sinew::crowd_kernels {
namespace {

template <class P>
struct Vec {
  P x, y, z;

  friend Vec operator+(const Vec& a, const Vec& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
  friend Vec operator-(const Vec& a, const Vec& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
  friend Vec operator*(const P& s, const Vec& a) { return {s * a.x, s * a.y, s * a.z}; }
  friend Vec operator*(float s, const Vec& a) { return {s * a.x, s * a.y, s * a.z}; }
};

template <class P>
Vec<P> same(const float (&v)[3]) {
  return {P::all(v[0]), P::all(v[1]), P::all(v[2])};
}
template <class P>
P dot(const Vec<P>& a, const Vec<P>& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
template <class P>
Vec<P> cross(const Vec<P>& a, const Vec<P>& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

/// Rotation matrix by columns.
template <class P>
struct Turn {
  Vec<P> x, y, z;

  Vec<P> operator*(const Vec<P>& v) const { return v.x * x + v.y * y + v.z * z; }
  /// Transpose times v.
  Vec<P> back(const Vec<P>& v) const { return {dot(x, v), dot(y, v), dot(z, v)}; }
};

/// Of a unit quaternion x y z w.
template <class P>
[[gnu::always_inline]] inline Turn<P> turn_of(const P* q) {
  const P x2 = q[0] + q[0], y2 = q[1] + q[1], z2 = q[2] + q[2], one = P::all(1);
  const P xx = x2 * q[0], xy = x2 * q[1], xz = x2 * q[2], yy = y2 * q[1], yz = y2 * q[2], zz = z2 * q[2];
  const P wx = x2 * q[3], wy = y2 * q[3], wz = z2 * q[3];
  return {{one - (yy + zz), xy + wz, xz - wy},
          {xy - wz, one - (xx + zz), yz + wx},
          {xz + wy, yz - wx, one - (xx + yy)}};
}

/// Symmetric matrix xx yy zz xy xz yz times v.
template <class P>
Vec<P> symmetric_times(const float (&m)[6], const Vec<P>& v) {
  return {m[0] * v.x + m[3] * v.y + m[4] * v.z, m[3] * v.x + m[1] * v.y + m[5] * v.z,
          m[4] * v.x + m[5] * v.y + m[2] * v.z};
}

template <class P>
P largest(const P& a, const P& b) {
  return where_negative(a - b, b, a);
}
template <class P>
P smallest(const P& a, const P& b) {
  return where_negative(a - b, a, b);
}

}  // namespace
}  // namespace sinew::crowd_kernels
