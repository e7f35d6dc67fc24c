// A TreeProblem of packs: what a solve knows about characters of one rig, one per lane. Kernel translation
// units only.
#pragma once

#include "sinew/animation/kernels/pack_eigen.h"
#include "sinew/effects/joint_damping.h"
#include "sinew/effects/joint_limit.h"
#include "sinew/effects/muscle.h"
#include "sinew/optimizer/joint_terms_pass.h"
#include "sinew/optimizer/kernels/newton.h"
#include "sinew/optimizer/problem_pass.h"
#include "sinew/residual/articulated_pass.h"

namespace sinew::newton_kernels {
namespace {

/// Hands out memory piece by piece; measures it where there is none.
class Arena {
 public:
  explicit Arena(void* memory) : begin_(static_cast<std::byte*>(memory)) {}
  template <class U>
  void take(std::span<U>& out, int count) {
    out = {begin_ ? reinterpret_cast<U*>(begin_ + used_) : nullptr, begin_ ? std::size_t(count) : 0};
    used_ += (std::size_t(count) * sizeof(U) + 63) / 64 * 64;
  }
  std::size_t used() const { return used_; }

 private:
  std::byte* begin_;
  std::size_t used_ = 0;
};

/// One number of each lane: where it lies in a pack.
template <class P>
float& lane_of(P& pack, int lane) {
  return reinterpret_cast<float*>(&pack)[lane];
}
template <class P, int R, int C>
void put(const Eigen::Matrix<float, R, C>& from, int lane, Eigen::Matrix<P, R, C>& to) {
  for (int i = 0; i < R * C; ++i) lane_of(to(i), lane) = from(i);
}
template <class P>
void put(const Transform<float>& from, int lane, Transform<P>& to) {
  for (int i = 0; i < 4; ++i) lane_of(to.rotation.coeffs()[i], lane) = from.rotation.coeffs()[i];
  put(from.translation, lane, to.translation);
}

template <class P, int R, int C>
void get(Eigen::Matrix<P, R, C>& from, int lane, Eigen::Matrix<float, R, C>& to) {
  for (int i = 0; i < R * C; ++i) to(i) = lane_of(from(i), lane);
}
template <class P>
void get(Transform<P>& from, int lane, Transform<float>& to) {
  for (int i = 0; i < 4; ++i) to.rotation.coeffs()[i] = lane_of(from.rotation.coeffs()[i], lane);
  get(from.translation, lane, to.translation);
}
template <class P>
JointRow<float> row_of(JointRow<P>& row, int lane) {
  JointRow<float> one;
  one.kind = row.kind;
  one.scalar = row.scalar;
  one.component = row.component;
  one.sign = row.sign;
  one.muscle = row.muscle;
  one.dof = row.dof;
  one.count = row.count;
  for (int a = 0; a < row.count; ++a) one.gradient[a] = lane_of(row.gradient[a], lane);
  one.value = lane_of(row.value, lane);
  one.minus = lane_of(row.minus, lane);
  one.plus = lane_of(row.plus, lane);
  one.width = lane_of(row.width, lane);
  one.stiffness = lane_of(row.stiffness, lane);
  one.stretch = lane_of(row.stretch, lane);
  one.lag = lane_of(row.lag, lane);
  return one;
}

template <class P>
using MaskOf = decltype(P() < P());

/// A joint's row and in which lanes it is.
template <class P>
struct PackRow : JointRow<P> {
  MaskOf<P> present;
  int place = 0;    ///< its number among all rows that its tree may have: rows are sorted by it
  P at, along;      ///< s at the inner solution so far, and along the step
  P in_factor;      ///< curvature that the last factor holds
  int unknown = 0;  ///< of its first degree of freedom
};

/// Rows in the order in which they were measured.
template <class P>
class Rows {
 public:
  std::span<PackRow<P>> store;
  void clear() { size_ = 0; }
  PackRow<P>& append() { return store[size_++]; }
  std::size_t size() const { return size_; }
  PackRow<P>* begin() const { return store.data(); }
  PackRow<P>* end() const { return store.data() + size_; }
  PackRow<P>& operator[](std::size_t n) const { return store[n]; }

 private:
  std::size_t size_ = 0;
};

template <class P>
struct PackKinematics {
  std::span<Mat3<P>> rotation;
  std::span<Vec3<P>> origin, center, w, v;
};

template <class P>
struct PackPrediction {
  std::span<Vec3<P>> center;
  std::span<Mat3<P>> rotation;
  P weight;
};

/// Limits of each lane; the rest is the rig's.
template <class P>
struct PackLaw {
  static constexpr float kUnlimited = JointLaw<float>::kUnlimited;

  std::span<P> torque_minus, torque_plus;
  std::span<const float> dry_friction, damping, lower, upper, swing_limit, twist_lower, twist_upper;
  std::span<const Vec3<float>> swing_axis;
  JointLawPresence present;  ///< in any lane

  MaskOf<P> has_muscle(int dof) const { return either(torque_minus[dof] > P(0), torque_plus[dof] > P(0)); }
};

template <class P>
struct PackProblem {
  const Tree<float>* tree = nullptr;
  float kink_width = 0;
  JointTerms<P, PackLaw<P>, PackProblem> terms;  ///< those that are declared for scalars
  PackLaw<P> law;
  PackPrediction<P> prediction;
  Vec3<P> common_origin;
  std::span<Transform<P>> local, target, start;
  std::span<std::uint8_t> free;  ///< [dof] in some lane
  std::span<MaskOf<P>> live;     ///< [dof] lanes in which it is an unknown
  PackKinematics<P> kinematics;
  std::span<Vec3<P>> force, moment, body_force, couple;
  std::span<P> gradient;
  Rows<P> rows, model_rows;  ///< at `local`; at the chart centres
  std::span<Composite<P>> composite;
  std::span<Mat3<P>> joint_curvature;
  bool alike = true;  ///< all lanes have the same unknowns

  void lay_out(const Shape& shape, Arena& memory) {
    for (auto* s : {&law.torque_minus, &law.torque_plus, &gradient}) memory.take(*s, shape.dofs);
    for (auto* s :
         {&prediction.center, &kinematics.origin, &kinematics.center, &force, &moment, &body_force, &couple})
      memory.take(*s, shape.bodies);
    for (auto* s : {&prediction.rotation, &kinematics.rotation, &joint_curvature})
      memory.take(*s, shape.bodies);
    for (auto* s : {&kinematics.w, &kinematics.v}) memory.take(*s, shape.dofs);
    for (auto* s : {&local, &target, &start}) memory.take(*s, shape.bodies);
    memory.take(composite, shape.bodies);
    memory.take(free, shape.dofs);
    memory.take(live, shape.dofs);
    memory.take(rows.store, shape.rows);
    memory.take(model_rows.store, shape.rows);
  }

  void clear_rows() { rows.clear(); }
  /// Where a row is absent it has no force: its lanes' sums are those without it.
  void add_row(const JointRow<P>& row, const MaskOf<P>& present) {
    const P zero = P(0);
    PackRow<P>& r = rows.append();
    static_cast<JointRow<P>&>(r) = row;
    r.present = both(present, live[row.dof]);
    for (P* force_of : {&r.minus, &r.plus, &r.stiffness}) *force_of = select(r.present, *force_of, zero);
    for (P& g : r.gradient) g = select(r.present, g, zero);
    r.value = select(r.present, row.value, P(-1));
    r.place = place_of(row);
  }

  /// In the order in which measure_rows comes by.
  int place_of(const JointRow<P>& row) const {
    const int body = tree->dof_body[row.dof], first = tree->first_dof[body];
    const bool lower = row.sign < 0;
    if (row.scalar == RowScalar::kSwing || row.scalar == RowScalar::kTwist)
      return 64 * body + 60 + 2 * (row.scalar == RowScalar::kTwist) + lower;
    const int k = row.count == 3 ? row.dof - first + row.component : row.dof - first;
    const int kind = row.scalar == RowScalar::kFromTarget  ? 0
                     : row.scalar == RowScalar::kFromStart ? 1 + (row.kind == RowKind::kSpring)
                                                           : 3 + lower;
    return 64 * body + 8 * k + kind;
  }

  /// What lane `lane` starts from. False where that is not for packs.
  void gather(const TreeProblem<float>& from, int lane) {
    for (int i = 0; i < tree->bodies; ++i) {
      put(from.local[i], lane, local[i]);
      put(from.target[i], lane, target[i]);
      put(from.start[i], lane, start[i]);
      put(from.prediction.center[i], lane, prediction.center[i]);
      put(from.prediction.rotation[i], lane, prediction.rotation[i]);
    }
    for (int dof = 0; dof < tree->dofs; ++dof) {
      lane_of(law.torque_minus[dof], lane) = from.law.torque_minus[dof];
      lane_of(law.torque_plus[dof], lane) = from.law.torque_plus[dof];
    }
    lane_of(prediction.weight, lane) = from.prediction.weight;
    put(from.common_origin, lane, common_origin);
  }
  void declare(const JointTerms<float>& declared) {
    using Law = PackLaw<P>;
    terms = {};
    if (declared.muscles) terms.muscles = &MuscleRows<P, Law, PackProblem>::kTerm;
    if (declared.damping) terms.damping = &JointDampingRows<P, Law, PackProblem>::kTerm;
    if (declared.limits) terms.limits = &JointLimitRows<P, Law, PackProblem>::kTerm;
    if (declared.cones) terms.cones = &ConeRows<P, Law, PackProblem>::kTerm;
  }
  void gather(const Batch& batch) {
    declare(batch.settings->plan->joints);
    const TreeProblem<float>& first = *batch.problems[0];
    tree = first.tree;
    kink_width = first.kink_width;
    law.dry_friction = first.law.dry_friction;
    law.damping = first.law.damping;
    law.lower = first.law.lower;
    law.upper = first.law.upper;
    law.swing_limit = first.law.swing_limit;
    law.swing_axis = first.law.swing_axis;
    law.twist_lower = first.law.twist_lower;
    law.twist_upper = first.law.twist_upper;
    // Lanes that nobody is in do as the first.
    const auto in = [&](int lane) -> const TreeProblem<float>& {
      return batch.problems[lane] ? *batch.problems[lane] : first;
    };
    law.present = first.law.present;
    for (int lane = 0; lane < P::kLanes; ++lane) {
      gather(in(lane), lane);
      law.present.muscles |= in(lane).law.present.muscles;
    }
    alike = true;
    for (int dof = 0; dof < tree->dofs; ++dof) {
      free[dof] = batch.unknowns->of_dof[dof] >= 0;
      P is = P(0);
      for (int lane = 0; lane < P::kLanes; ++lane) lane_of(is, lane) = in(lane).free[dof] ? 1.0f : 0.0f;
      live[dof] = is > P(0);
      alike = alike && (!free[dof] || !any(!live[dof]));
    }
  }
};

}  // namespace
}  // namespace sinew::newton_kernels
