// The recursions of articulated_matrix.h, on any scalar: float, double or a pack of matrices of one tree
// (pack.h).
#pragma once

#include <array>
#include <span>
#include <type_traits>

#include "sinew/residual/composite_pass.h"
#include "sinew/skeleton/scalar.h"

namespace sinew {

/// (w, v) or (moment, force); two zeros behind where that makes whole vectors.
template <class T>
using SpatialVector = Eigen::Array<T, std::is_arithmetic_v<T> ? 8 : 6, 1>;
/// Columns of a 6×6 matrix.
template <class T>
using SpatialForm = std::array<SpatialVector<T>, 6>;
/// Of the block of one joint, up to the diagonal.
template <class T>
using JointBlockRow = std::array<T, 6>;

/// Unknowns of a body's joint.
struct JointBlock {
  int parent = -1;           ///< body
  int first = 0, count = 0;  ///< unknowns
  bool laden = false;        ///< its E is not zero
};

/// Where a matrix lies.
template <class T>
struct ArticulatedParts {
  int bodies = 0;
  std::span<JointBlock> blocks;               ///< [body]
  std::span<int> first;                       ///< [unknown] of its block
  std::span<SpatialVector<T>> axes;           ///< [unknown] S
  std::span<SpatialVector<T>> moved;          ///< [unknown] C·S: what moving it asks of those above
  std::span<SpatialVector<T>> reduced;        ///< [unknown] Y
  std::span<JointBlockRow<T>> own, factor;    ///< [unknown] D; L, its diagonal inverted
  std::span<SpatialForm<T>> eliminated;       ///< [body] E
  std::span<SpatialVector<T>> force, motion;  ///< [body] p, V

  T& own_entry(int k, int l) const { return own[k][l - first[k]]; }
  T& factor_entry(int k, int l) const { return factor[k][l - first[k]]; }
};

template <class T>
[[gnu::always_inline]] inline SpatialVector<T> spatial(const T& a, const T& b, const T& c, const T& d,
                                                       const T& e, const T& f) {
  SpatialVector<T> s;
  s[0] = a, s[1] = b, s[2] = c, s[3] = d, s[4] = e, s[5] = f;
  if constexpr (std::is_arithmetic_v<T>) s[6] = s[7] = T(0);
  return s;
}
template <class T>
[[gnu::always_inline]] inline SpatialVector<T> spatial(const Vec3<T>& a, const Vec3<T>& b) {
  return spatial<T>(a.x(), a.y(), a.z(), b.x(), b.y(), b.z());
}

/// f(count), where a joint has so many unknowns. Of scalars the usual counts are constants: short loops that
/// the compiler does not unroll cost more than what they do.
template <class T, class F>
[[gnu::always_inline]] inline void for_count(int count, const F& f) {
  if constexpr (std::is_arithmetic_v<T>) {
    if (count == 1) return f(std::integral_constant<int, 1>());
    if (count == 3) return f(std::integral_constant<int, 3>());
    if (count == 6) return f(std::integral_constant<int, 6>());
  }
  f(count);
}

/// The sums of a vector of four, in which two zeros take part: packs have the bits of scalars.
template <class T>
[[gnu::always_inline]] inline T spatial_dot(const SpatialVector<T>& a, const SpatialVector<T>& b) {
  if constexpr (std::is_arithmetic_v<T>) {
    const Eigen::Array<T, 4, 1> sum =
        a.template head<4>() * b.template head<4>() + a.template tail<4>() * b.template tail<4>();
    return (sum[0] + sum[2]) + (sum[1] + sum[3]);
  } else {
    const T zero = T(0);
    return ((a[0] * b[0] + a[4] * b[4]) + (a[2] * b[2] + zero)) +
           ((a[1] * b[1] + a[5] * b[5]) + (a[3] * b[3] + zero));
  }
}

template <class T>
[[gnu::always_inline]] inline SpatialVector<T> spatial_product(const SpatialForm<T>& form,
                                                               const SpatialVector<T>& x) {
  return ((form[0] * x[0] + form[1] * x[1]) + (form[2] * x[2] + form[3] * x[3])) +
         (form[4] * x[4] + form[5] * x[5]);
}

/// What small motions of a composite body ask for; with what the turning of the axes adds, see
/// geometric_column.
template <class T>
SpatialForm<T> form_of(const Composite<T>& c, bool geometric) {
  Mat3<T> turning = c.rotational;
  Vec3<T> arm = c.first;  // that a unit of v asks for is the moment arm × v
  if (geometric) {
    turning += c.virial - T(0.5) * skew<T>(c.couple);
    arm -= c.force;
  }
  const Vec3<T>& f = c.first;
  const Mat3<T>& t = turning;
  const T zero = T(0);
  return {spatial<T>(t(0, 0), t(1, 0), t(2, 0), zero, -f.z(), f.y()),
          spatial<T>(t(0, 1), t(1, 1), t(2, 1), f.z(), zero, -f.x()),
          spatial<T>(t(0, 2), t(1, 2), t(2, 2), -f.y(), f.x(), zero),
          spatial<T>(zero, arm.z(), -arm.y(), c.mass, zero, zero),
          spatial<T>(-arm.z(), zero, arm.x(), zero, c.mass, zero),
          spatial<T>(arm.y(), -arm.x(), zero, zero, zero, c.mass)};
}

/// What stands under the diagonal entry of an unknown with the axis (w, v): see add_floor.
template <class T>
T joint_floor(const Composite<T>& subtree, const Vec3<T>& w, const Vec3<T>& v) {
  const T inertia = T(Number<T>(kInertiaFloor)) * subtree.rotational.trace();
  const T mass = T(Number<T>(kInertiaFloor)) * subtree.mass;
  return mass * v.squaredNorm() + inertia * w.squaredNorm();
}

/// See ArticulatedMatrix::assemble. `dofs` [unknown]: the degree of freedom that each is.
template <class T, class K>
void assemble_joints(const Tree<Number<T>>& tree, const K& kin, std::span<Composite<T>> bodies,
                     std::span<const int> dofs, bool geometric, ArticulatedParts<T>& m) {
  m.bodies = tree.bodies;
  int next = static_cast<int>(dofs.size());  // unknowns of the bodies after this one begin here
  for (int i = tree.bodies - 1; i >= 0; --i) {
    const Composite<T>& c = bodies[i];
    const int end = next;
    while (next > 0 && tree.dof_body[dofs[next - 1]] == i) --next;
    m.blocks[i] = {tree.parent[i], next, end - next, false};
    if (end > next) {
      const SpatialForm<T> form = form_of(c, geometric);
      // One rotation vector: neither axis acts first. What the turning of axes adds is all that is not
      // symmetric.
      const bool ball = tree.type[i] == JointType::kBall, free = tree.type[i] == JointType::kFree;
      for_count<T>(end - next, [&, first = next](auto count) {
        SpatialVector<T>*const axes = m.axes.data() + first, *const moved = m.moved.data() + first;
        JointBlockRow<T>* const own = m.own.data() + first;
        for (int k = 0; k < count; ++k) {
          const int dof = dofs[first + k];
          m.first[first + k] = first;
          axes[k] = spatial<T>(kin.w[dof], kin.v[dof]);
          moved[k] = spatial_product<T>(form, axes[k]);
          for (int l = 0; l <= k; ++l) own[k][l] = spatial_dot<T>(axes[l], moved[k]);
          own[k][k] += joint_floor<T>(c, kin.w[dof], kin.v[dof]);
        }
        if (!geometric || !(ball || free)) return;
        for (int k = 1; k < count; ++k)
          for (int l = 0; l < k; ++l)
            if (ball || dofs[first + l] >= tree.first_dof[i] + 3)
              own[k][l] = T(0.5) * (own[k][l] + spatial_dot<T>(axes[k], moved[l]));
      });
    }
    if (const int p = tree.parent[i]; p >= 0) bodies[p] += c;
  }
}

/// y = H·x.
template <class T>
void multiply_by_joints(const ArticulatedParts<T>& m, std::span<const T> x, std::span<T> y) {
  for (int i = 0; i < m.bodies; ++i) m.force[i].setZero();
  for (int i = m.bodies - 1; i >= 0; --i) {
    const JointBlock& b = m.blocks[i];
    for (int k = b.first; k < b.first + b.count; ++k) y[k] = spatial_dot<T>(m.axes[k], m.force[i]);
    for (int k = b.first; k < b.first + b.count; ++k) {
      for (int l = b.first; l < k; ++l) {
        y[k] += m.own_entry(k, l) * x[l];
        y[l] += m.own_entry(k, l) * x[k];
      }
      y[k] += m.own_entry(k, k) * x[k];
      m.force[i] += x[k] * m.moved[k];
    }
    if (b.parent >= 0) m.force[b.parent] += m.force[i];
  }
  for (int i = 0; i < m.bodies; ++i) {
    const JointBlock& b = m.blocks[i];
    SpatialVector<T> motion = SpatialVector<T>::Zero();
    if (b.parent >= 0) motion = m.motion[b.parent];
    const SpatialVector<T> above = motion;
    for (int k = b.first; k < b.first + b.count; ++k) {
      y[k] += spatial_dot<T>(m.moved[k], above);
      motion += x[k] * m.axes[k];
    }
    m.motion[i] = motion;
  }
}

/// Replaces the block that `factor` holds of H by the matrix' factor. Set where H is positive definite: see
/// TreeMatrix::factorise.
template <class T>
auto factorise_joints(const ArticulatedParts<T>& m) {
  using std::sqrt;
  constexpr auto kRounding = Number<T>(sizeof(Number<T>) == 4 ? 1e-5 : 1e-12);  // of the diagonal
  auto definite = T(1) > T(0);
  for (int i = 0; i < m.bodies; ++i) m.blocks[i].laden = false;
  for (int i = m.bodies - 1; i >= 0 && any(definite); --i) {
    const JointBlock& b = m.blocks[i];
    const SpatialForm<T>& e = m.eliminated[i];
    for_count<T>(b.count, [&](auto count) {
      const SpatialVector<T>*const axes = m.axes.data() + b.first, *const moved = m.moved.data() + b.first;
      SpatialVector<T>* const reduced = m.reduced.data() + b.first;
      JointBlockRow<T>* const rows = m.factor.data() + b.first;
      for (int k = 0; k < count; ++k) {
        JointBlockRow<T>& row = rows[k];
        const T least = kRounding * row[k];
        SpatialVector<T> y = moved[k];
        if (b.laden) {
          const SpatialVector<T> taken = spatial_product<T>(e, axes[k]);
          y -= taken;
          for (int l = 0; l <= k; ++l) row[l] -= spatial_dot<T>(axes[l], taken);
        }
        for (int l = 0; l < k; ++l) {
          for (int n = 0; n < l; ++n) row[l] -= row[n] * rows[l][n];
          row[l] *= rows[l][l];
          row[k] -= row[l] * row[l];
          y -= row[l] * reduced[l];
        }
        const T pivot = largest(row[k], least);
        definite = both(definite, both(row[k] > -least, pivot > T(0)));  // not so where they are NaN
        if (!any(definite)) return;
        row[k] = T(1) / sqrt(pivot);
        reduced[k] = y * row[k];
      }
      if (b.parent < 0) return;
      const bool laden = m.blocks[b.parent].laden;
      SpatialForm<T>& above = m.eliminated[b.parent];
      for (int c = 0; c < 6; ++c) {
        SpatialVector<T> column = SpatialVector<T>::Zero();
        if (laden) column = above[c];
        if (b.laden) column += e[c];
        for (int k = 0; k < count; ++k) column += reduced[k][c] * reduced[k];
        above[c] = column;
      }
    });
    if (b.parent >= 0) m.blocks[b.parent].laden |= b.laden || b.count > 0;
  }
  return definite;
}

/// Body i's part of reduce_by_joints, after those below it.
template <class T>
[[gnu::always_inline]] inline void reduce_joint(const ArticulatedParts<T>& m, int i, std::span<T> x) {
  const JointBlock& b = m.blocks[i];
  const SpatialVector<T> below = m.force[i];
  SpatialVector<T> force = below;
  for_count<T>(b.count, [&](auto count) {
    const SpatialVector<T>*const axes = m.axes.data() + b.first, *const reduced = m.reduced.data() + b.first;
    const JointBlockRow<T>* const rows = m.factor.data() + b.first;
    T* const mine = x.data() + b.first;
    for (int k = 0; k < count; ++k) {
      T value = mine[k] - spatial_dot<T>(axes[k], below);
      for (int l = 0; l < k; ++l) value -= rows[k][l] * mine[l];
      value *= rows[k][k];
      mine[k] = value;
      force += value * reduced[k];
    }
  });
  if (b.parent >= 0) m.force[b.parent] += force;
}

/// Half of a solve with the factor that factorise_joints left, H = LᵀL: x ← L⁻ᵀx in place, from the leaves to
/// the root.
template <class T>
void reduce_by_joints(const ArticulatedParts<T>& m, std::span<T> x) {
  for (int i = 0; i < m.bodies; ++i) m.force[i].setZero();
  for (int i = m.bodies - 1; i >= 0; --i) reduce_joint<T>(m, i, x);
}

/// The other half, x ← L⁻¹x.
template <class T>
void expand_by_joints(const ArticulatedParts<T>& m, std::span<T> x) {
  for (int i = 0; i < m.bodies; ++i) {
    const JointBlock& b = m.blocks[i];
    SpatialVector<T> motion = SpatialVector<T>::Zero();
    if (b.parent >= 0) motion = m.motion[b.parent];
    const SpatialVector<T> above = motion;
    for_count<T>(b.count, [&](auto count) {
      const SpatialVector<T>*const axes = m.axes.data() + b.first, *const reduced =
                                                                       m.reduced.data() + b.first;
      const JointBlockRow<T>* const rows = m.factor.data() + b.first;
      T* const mine = x.data() + b.first;
      for (int k = count - 1; k >= 0; --k) {
        T value = mine[k] - spatial_dot<T>(reduced[k], above);
        for (int l = k + 1; l < count; ++l) value -= rows[l][k] * mine[l];
        value *= rows[k][k];
        mine[k] = value;
        motion += value * axes[k];
      }
    });
    m.motion[i] = motion;
  }
}

/// Solves H·x = b in place.
template <class T>
void solve_by_joints(const ArticulatedParts<T>& m, std::span<T> x) {
  reduce_by_joints<T>(m, x);
  expand_by_joints<T>(m, x);
}

}  // namespace sinew
