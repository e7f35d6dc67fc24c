#include "sinew/multibody/semi_recursive.h"

#include <limits>

namespace sinew::multibody {

SemiRecursive::SemiRecursive(const Model& model)
    : model_(&model),
      sums_(model.size()),
      residual_(model),
      mass_(pattern_),
      zero_(Vector::Zero(model.size())) {
  for (int i = 0; i < model.tree.bodies; ++i) pattern_.add(model.tree.parent[i]);
}

template <class Put>
void SemiRecursive::accumulate(const BodyMotion& m, const Put& put) {
  const Tree<double>& tree = model_->tree;
  for (int i = 0; i < tree.bodies; ++i) {
    AccumulatedInertia& sum = sums_[i];
    sum.mass = tree.mass[i];
    const Vec3<double>& c = m.pose.center[i];
    sum.moment = sum.mass * c;
    if (sum.mass == 0) {
      sum.inertia.setZero();
      continue;
    }
    const Mat3<double>& r = m.pose.rotation[i];
    sum.inertia.noalias() = r * tree.inertia[i] * r.transpose();
    sum.inertia.diagonal().array() += c.dot(sum.moment);
    sum.inertia -= sum.moment * c.transpose();
  }
  for (int i = tree.bodies - 1; i >= 0; --i) {
    const AccumulatedInertia& sum = sums_[i];
    const int p = tree.parent[i];
    if (p >= 0) {
      sums_[p].mass += sum.mass;
      sums_[p].moment += sum.moment;
      sums_[p].inertia += sum.inertia;
    }
    const Vec3<double>&w = m.pose.w[i], &v = m.pose.v[i];
    const Vec3<double> force = sum.mass * v + w.cross(sum.moment);
    const Vec3<double> moment = sum.inertia * w + sum.moment.cross(v);
    for (int k = i; k >= 0; k = tree.parent[k]) put(i, k, m.pose.v[k].dot(force) + m.pose.w[k].dot(moment));
  }
}

void SemiRecursive::mass_matrix(const BodyMotion& m, Matrix& mass) {
  mass.setZero();
  accumulate(m, [&](int i, int k, double entry) { mass(i, k) = mass(k, i) = entry; });
}

void SemiRecursive::forces(const BodyMotion& m, const AppliedForces& applied, Eigen::Ref<Vector> out) {
  residual_.evaluate(m, applied, out);
  out = -out;
}

void SemiRecursive::evaluate(BodyMotion& m, const AppliedForces& applied, Eigen::Ref<Vector> qdd) {
  accelerate(*model_, zero_, m);
  forces(m, applied, qdd);
  mass_.set_zero();
  accumulate(m, [&](int i, int k, double entry) { mass_.row(i)[pattern_.depth[k]] = entry; });
  if (mass_.factorise())
    mass_.solve(std::span<double>(qdd.data(), static_cast<std::size_t>(qdd.size())));
  else
    qdd.setConstant(std::numeric_limits<double>::quiet_NaN());
}

}  // namespace sinew::multibody
