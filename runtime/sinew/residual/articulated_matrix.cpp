#include "sinew/residual/articulated_matrix.h"

#include <algorithm>
#include <cmath>

#include "sinew/residual/composite_pass.h"

namespace sinew {
namespace {

template <class T>
using Motion = Eigen::Array<T, 8, 1>;

template <class T>
T dot(const Motion<T>& a, const Motion<T>& b) {
  const Eigen::Array<T, 4, 1> sum = a.template head<4>() * b.template head<4>() + a.template tail<4>() * b.template tail<4>();
  return sum.sum();
}

/// A form's product with a motion.
template <class T>
Motion<T> times(const std::array<Motion<T>, 6>& form, const Motion<T>& x) {
  return ((form[0] * x[0] + form[1] * x[1]) + (form[2] * x[2] + form[3] * x[3])) +
         (form[4] * x[4] + form[5] * x[5]);
}

/// Columns of what small motions of a composite body ask for, (moment, force); with what the turning of the
/// axes adds, see geometric_column.
template <class T>
std::array<Motion<T>, 6> form_of(const Composite<T>& c, bool geometric) {
  Mat3<T> turning = c.rotational;
  Vec3<T> moment = c.first;  // that a unit of v asks for is moment × v
  if (geometric) {
    turning += c.virial - T(0.5) * skew<T>(c.couple);
    moment -= c.force;
  }
  const Vec3<T>& f = c.first;
  const Mat3<T>& t = turning;
  const T zero = T(0);
  std::array<Motion<T>, 6> form;
  form[0] << t(0, 0), t(1, 0), t(2, 0), zero, -f.z(), f.y(), zero, zero;
  form[1] << t(0, 1), t(1, 1), t(2, 1), f.z(), zero, -f.x(), zero, zero;
  form[2] << t(0, 2), t(1, 2), t(2, 2), -f.y(), f.x(), zero, zero, zero;
  form[3] << zero, moment.z(), -moment.y(), c.mass, zero, zero, zero, zero;
  form[4] << -moment.z(), zero, moment.x(), zero, c.mass, zero, zero, zero;
  form[5] << moment.y(), -moment.x(), zero, zero, zero, c.mass, zero, zero;
  return form;
}

}  // namespace

template <class T>
void ArticulatedMatrix<T>::reserve(int bodies, int unknowns) {
  blocks_.reserve(bodies);
  eliminated_.reserve(bodies);
  for (auto* v : {&force_, &motion_}) v->reserve(bodies);
  first_.reserve(unknowns);
  for (auto* v : {&axes_, &moved_, &reduced_}) v->reserve(unknowns);
  for (auto* v : {&own_, &factor_}) v->reserve(unknowns);
}

template <class T>
void ArticulatedMatrix<T>::assemble(const Tree<T>& tree, const Kinematics<T>& kin,
                                    std::span<Composite<T>> bodies, const Unknowns& unknowns,
                                    bool geometric) {
  const int size = unknowns.pattern.size;
  blocks_.resize(tree.bodies);
  eliminated_.resize(tree.bodies);
  for (auto* v : {&force_, &motion_}) v->resize(tree.bodies);
  first_.resize(size);
  for (auto* v : {&axes_, &moved_, &reduced_}) v->resize(size);
  for (auto* v : {&own_, &factor_}) v->resize(size);
  int next = size;  // unknowns of the bodies after this one begin here
  for (int i = tree.bodies - 1; i >= 0; --i) {
    const Composite<T>& c = bodies[i];
    const int end = next;
    while (next > 0 && tree.dof_body[unknowns.dof[next - 1]] == i) --next;
    blocks_[i] = {tree.parent[i], next, end - next, false};
    if (end > next) {
      const Form form = form_of(c, geometric);
      const bool one_rotation_vector = tree.type[i] == JointType::kBall || tree.type[i] == JointType::kFree;
      const T inertia = T(kInertiaFloor) * c.rotational.trace(), mass = T(kInertiaFloor) * c.mass;
      for (int k = next; k < end; ++k) {
        const Vec3<T>&w = kin.w[unknowns.dof[k]], &v = kin.v[unknowns.dof[k]];
        first_[k] = next;
        axes_[k] << w.x(), w.y(), w.z(), v.x(), v.y(), v.z(), T(0), T(0);
        moved_[k] = times<T>(form, axes_[k]);
        for (int l = next; l <= k; ++l) {
          T& entry = own_[k][l - next] = dot<T>(axes_[l], moved_[k]);
          // One rotation vector: neither axis acts first.
          if (one_rotation_vector && l < k && !slides(tree, unknowns.dof[l]))
            entry = T(0.5) * (entry + dot<T>(axes_[k], moved_[l]));
        }
        own_[k][k - next] += mass * v.squaredNorm() + inertia * w.squaredNorm();
      }
    }
    if (const int p = tree.parent[i]; p >= 0) bodies[p] += c;
  }
}

template <class T>
void ArticulatedMatrix<T>::multiply(std::span<const T> x, std::span<T> y) {
  std::fill(force_.begin(), force_.end(), Motion(Motion::Zero()));
  for (std::size_t i = blocks_.size(); i-- > 0;) {
    const Block& b = blocks_[i];
    for (int k = b.first; k < b.first + b.count; ++k) y[k] = dot<T>(axes_[k], force_[i]);
    for (int k = b.first; k < b.first + b.count; ++k) {
      for (int l = b.first; l < k; ++l) {
        y[k] += own_[k][l - b.first] * x[l];
        y[l] += own_[k][l - b.first] * x[k];
      }
      y[k] += own_[k][k - b.first] * x[k];
      force_[i] += x[k] * moved_[k];
    }
    if (b.parent >= 0) force_[b.parent] += force_[i];
  }
  for (std::size_t i = 0; i < blocks_.size(); ++i) {
    const Block& b = blocks_[i];
    motion_[i] = b.parent < 0 ? Motion(Motion::Zero()) : motion_[b.parent];
    const Motion above = motion_[i];
    for (int k = b.first; k < b.first + b.count; ++k) {
      y[k] += dot<T>(moved_[k], above);
      motion_[i] += x[k] * axes_[k];
    }
  }
}

template <class T>
bool ArticulatedMatrix<T>::factorise() {
  constexpr T kRounding = sizeof(T) == 4 ? T(1e-5) : T(1e-12);  // of the diagonal
  for (Block& b : blocks_) b.laden = false;
  for (std::size_t i = blocks_.size(); i-- > 0;) {
    const Block& b = blocks_[i];
    const Form& e = eliminated_[i];
    for (int k = b.first; k < b.first + b.count; ++k) {
      Row& row = factor_[k];
      const int own = k - b.first;
      const T least = kRounding * row[own];
      Motion& y = reduced_[k] = moved_[k];
      if (b.laden) {
        const Motion taken = times<T>(e, axes_[k]);
        y -= taken;
        for (int l = 0; l <= own; ++l) row[l] -= dot<T>(axes_[b.first + l], taken);
      }
      for (int l = 0; l < own; ++l) {
        const Row& above = factor_[b.first + l];
        for (int m = 0; m < l; ++m) row[l] -= row[m] * above[m];
        row[l] *= above[l];
        row[own] -= row[l] * row[l];
        y -= row[l] * reduced_[b.first + l];
      }
      const T pivot = std::max(row[own], least);
      if (!(row[own] > -least && pivot > T(0))) return false;  // so too where it is no number
      row[own] = T(1) / std::sqrt(pivot);
      y *= row[own];
    }
    if (b.parent < 0) continue;
    Block& parent = blocks_[b.parent];
    Form& above = eliminated_[b.parent];
    if (!parent.laden) above.fill(Motion::Zero());
    parent.laden = parent.laden || b.laden || b.count > 0;
    for (int c = 0; c < 6; ++c) {
      Motion column = above[c];
      if (b.laden) column += e[c];
      for (int k = b.first; k < b.first + b.count; ++k) column += reduced_[k][c] * reduced_[k];
      above[c] = column;
    }
  }
  return true;
}

template <class T>
void ArticulatedMatrix<T>::solve(std::span<T> x) {
  std::fill(force_.begin(), force_.end(), Motion(Motion::Zero()));
  for (std::size_t i = blocks_.size(); i-- > 0;) {
    const Block& b = blocks_[i];
    const Motion below = force_[i];
    for (int k = b.first; k < b.first + b.count; ++k) {
      const Row& row = factor_[k];
      x[k] -= dot<T>(axes_[k], below);
      for (int l = b.first; l < k; ++l) x[k] -= row[l - b.first] * x[l];
      x[k] *= row[k - b.first];
      force_[i] += x[k] * reduced_[k];
    }
    if (b.parent >= 0) force_[b.parent] += force_[i];
  }
  for (std::size_t i = 0; i < blocks_.size(); ++i) {
    const Block& b = blocks_[i];
    motion_[i] = b.parent < 0 ? Motion(Motion::Zero()) : motion_[b.parent];
    const Motion above = motion_[i];
    for (int k = b.first + b.count - 1; k >= b.first; --k) {
      x[k] -= dot<T>(reduced_[k], above);
      for (int l = k + 1; l < b.first + b.count; ++l) x[k] -= factor_[l][k - b.first] * x[l];
      x[k] *= factor_[k][k - b.first];
      motion_[i] += x[k] * axes_[k];
    }
  }
}

template class ArticulatedMatrix<float>;
template class ArticulatedMatrix<double>;

}  // namespace sinew
