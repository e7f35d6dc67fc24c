#include "sinew/multibody/velocity_transformation.h"

#include <algorithm>
#include <limits>

namespace sinew::multibody {
namespace {

constexpr double kRounding = 1e-16;  ///< m
constexpr double kFarthestMove = 1;  ///< rad or m, in one iteration
constexpr int kMaxIterations = 12;

}  // namespace

VelocityTransformation::VelocityTransformation(const Model& model, LoopFactor::Kind kind)
    : model_(&model),
      kind_(kind),
      jacobian_(Matrix::Zero(model.loop_rows, model.size())),
      phi_(Vector::Zero(model.loop_rows)),
      zero_(Vector::Zero(model.size())) {
  for (int i = 0; i < model.size(); ++i) independent_.push_back(i);
}

bool VelocityTransformation::choose(const BodyMotion& motion) {
  closure_jacobian(*model_, motion, jacobian_);
  Eigen::ColPivHouseholderQR<Matrix> pivoted(jacobian_.rows(), jacobian_.cols());
  pivoted.setThreshold(LoopFactor::kSingular);
  pivoted.compute(jacobian_);
  // Passing through a singular position the rank drops for a moment: keep the larger set of dependent ones.
  if (pivoted.rank() < static_cast<Eigen::Index>(dependent_.size())) return false;
  std::vector<int> chosen;
  for (Eigen::Index i = 0; i < pivoted.rank(); ++i)
    chosen.push_back(static_cast<int>(pivoted.colsPermutation().indices()[i]));
  std::sort(chosen.begin(), chosen.end());
  if (chosen == dependent_) return false;
  dependent_ = chosen;
  independent_.clear();
  for (int i = 0; i < model_->size(); ++i)
    if (!std::binary_search(dependent_.begin(), dependent_.end(), i)) independent_.push_back(i);
  const Eigen::Index nd = static_cast<Eigen::Index>(dependent_.size()), nf = freedom();
  by_dependent_.resize(jacobian_.rows(), nd);
  by_independent_.resize(jacobian_.rows(), nf);
  rates_.resize(nd, nf);
  factor_.resize(jacobian_.rows(), nd);
  split(jacobian_);
  return true;
}

void VelocityTransformation::split(const Matrix& jacobian) {
  for (std::size_t i = 0; i < dependent_.size(); ++i) by_dependent_.col(i) = jacobian.col(dependent_[i]);
  for (std::size_t i = 0; i < independent_.size(); ++i)
    by_independent_.col(i) = jacobian.col(independent_[i]);
  factor_.compute(by_dependent_, kind_);
}

bool VelocityTransformation::close_positions(Eigen::Ref<Vector> q, BodyMotion& motion, double tolerance) {
  double moved = 1, best = std::numeric_limits<double>::infinity();
  for (int i = 0; i < kMaxIterations; ++i) {
    move_to(*model_, q, motion);
    if (model_->loop_rows == 0) return true;
    closure(*model_, motion, phi_);
    if (!phi_.allFinite()) return false;
    if (moved > 1e-8) {  // below, the factor of the last place serves: its error is of second order
      closure_jacobian(*model_, motion, jacobian_);
      split(jacobian_);
    }
    const double open = phi_.cwiseAbs().maxCoeff();
    // Near a singular position a gap is magnified by 1/σ in positions and by 1/σ³ in accelerations: close it
    // to rounding there, that is until it shrinks no more.
    const bool closed = open <= tolerance && (weakest() > kWeak || open <= kRounding || open > 0.1 * best);
    if (closed) {
      rates_ = -factor_.solve(by_independent_);
      return true;
    }
    best = std::min(best, open);
    const Vector step = factor_.solve(phi_);
    moved = step.size() == 0 ? 0 : step.cwiseAbs().maxCoeff();
    if (!(moved < kFarthestMove)) return false;  // another assembly of the loop, or none
    for (std::size_t d = 0; d < dependent_.size(); ++d) q[dependent_[d]] -= step[d];
  }
  return false;
}

void VelocityTransformation::linearise(const BodyMotion& motion) {
  if (trivial()) return;
  closure_jacobian(*model_, motion, jacobian_);
  split(jacobian_);
  rates_ = -factor_.solve(by_independent_);
}

void VelocityTransformation::follow(Eigen::Ref<Vector> qd) const {
  for (std::size_t d = 0; d < dependent_.size(); ++d) {
    double sum = 0;
    for (int i = 0; i < freedom(); ++i) sum += rates_(d, i) * qd[independent_[i]];
    qd[dependent_[d]] = sum;
  }
}

void VelocityTransformation::close_rates(Eigen::Ref<Vector> qd) const {
  if (trivial()) return;
  const Vector step = factor_.solve(jacobian_ * qd);
  for (std::size_t d = 0; d < dependent_.size(); ++d) qd[dependent_[d]] -= step[d];
}

void VelocityTransformation::bias(BodyMotion& motion, Vector& bias) {
  bias.setZero();
  if (trivial()) return;
  accelerate(*model_, zero_, motion);
  closure_acceleration(*model_, motion, phi_);
  const Vector step = factor_.solve(phi_);
  for (std::size_t d = 0; d < dependent_.size(); ++d) bias[dependent_[d]] = -step[d];
}

void VelocityTransformation::expand(const Vector& bias, Eigen::Ref<Vector> qdd) const {
  if (trivial()) return;
  for (std::size_t d = 0; d < dependent_.size(); ++d) {
    double sum = bias[dependent_[d]];
    for (int i = 0; i < freedom(); ++i) sum += rates_(d, i) * qdd[independent_[i]];
    qdd[dependent_[d]] = sum;
  }
}

void VelocityTransformation::reduce(const Vector& force, Vector& out) const {
  if (trivial()) {
    out = force;
    return;
  }
  out.resize(freedom());
  for (int i = 0; i < freedom(); ++i) {
    double sum = force[independent_[i]];
    for (std::size_t d = 0; d < dependent_.size(); ++d) sum += rates_(d, i) * force[dependent_[d]];
    out[i] = sum;
  }
}

void VelocityTransformation::reduce(const Matrix& a, Matrix& out) const {
  if (trivial()) {
    out = a;
    return;
  }
  // With the coordinates sorted into independent and dependent ones and D = ∂q_d/∂q_i:
  // A_ii + A_id D + Dᵀ(A_di + A_dd D). Cheap because the dependent ones are few.
  const Eigen::Index nf = freedom(), nd = static_cast<Eigen::Index>(dependent_.size());
  out.resize(nf, nf);
  Matrix id(nf, nd), di(nd, nf), dd(nd, nd);
  for (Eigen::Index c = 0; c < nf; ++c) {
    for (Eigen::Index r = 0; r < nf; ++r) out(r, c) = a(independent_[r], independent_[c]);
    for (Eigen::Index r = 0; r < nd; ++r) di(r, c) = a(dependent_[r], independent_[c]);
  }
  for (Eigen::Index c = 0; c < nd; ++c) {
    for (Eigen::Index r = 0; r < nf; ++r) id(r, c) = a(independent_[r], dependent_[c]);
    for (Eigen::Index r = 0; r < nd; ++r) dd(r, c) = a(dependent_[r], dependent_[c]);
  }
  di.noalias() += dd * rates_;
  out.noalias() += id * rates_;
  out.noalias() += rates_.transpose() * di;
}

Gap VelocityTransformation::gap(const BodyMotion& motion) {
  if (model_->loop_rows == 0) return {};
  closure(*model_, motion, phi_);
  return worst_gap(*model_, phi_);
}

}  // namespace sinew::multibody
