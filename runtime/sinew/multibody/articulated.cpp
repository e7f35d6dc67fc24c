#include "sinew/multibody/articulated.h"

#include "sinew/multibody/recursive_residual.h"

namespace sinew::multibody {

ArticulatedInertia::ArticulatedInertia(const Model& model) : model_(&model), elements_(model.size()) {}

void ArticulatedInertia::evaluate(BodyMotion& m, const AppliedForces& applied, Eigen::Ref<Vector> qdd) {
  const Tree<double>& tree = model_->tree;
  // 6-vectors are (linear, angular), as in the paper.
  const auto motion_axis = [&](int i) {
    Vec6 b;
    b << m.pose.v[i], m.pose.w[i];
    return b;
  };
  for (int i = 0; i < tree.bodies; ++i) {
    Element& e = elements_[i];
    e.force << applied.force[i], applied.moment[i];
    const double mass = tree.mass[i];
    if (mass == 0) {
      e.inertia.setZero();
      continue;
    }
    // M of equation 6 and the forces at zero Z' (equation 7).
    const Vec3<double>& c = m.pose.center[i];
    const Mat3<double>& r = m.pose.rotation[i];
    const Mat3<double> shift = skew<double>(c);
    const Mat3<double> inertia = r * tree.inertia[i] * r.transpose();
    e.inertia.topLeftCorner<3, 3>() = mass * Mat3<double>::Identity();
    e.inertia.topRightCorner<3, 3>() = -mass * shift;
    e.inertia.bottomLeftCorner<3, 3>() = mass * shift;
    e.inertia.bottomRightCorner<3, 3>() = inertia - mass * shift * shift;
    const Vec3<double> drift = m.omega[i].cross(velocity_at(m, i, c));
    const Vec3<double> force = mass * (model_->mechanism().gravity - drift);
    e.force.head<3>() += force;
    e.force.tail<3>() += c.cross(force) - m.omega[i].cross(inertia * m.omega[i]);
  }
  for (int i = tree.bodies - 1; i >= 0; --i) {
    Element& e = elements_[i];
    const Vec6 b = motion_axis(i);
    Vec6 d;
    d << m.drift_v[i], m.drift_w[i];
    e.projected.noalias() = e.inertia * b;
    e.effective = b.dot(e.projected);
    const Vec6 rest = e.force - e.inertia * d;
    e.drive = b.dot(rest) + applied.joint[i];
    if (const int p = tree.parent[i]; p >= 0) {
      Element& above = elements_[p];
      const Vec6 scaled = e.projected / e.effective;
      above.inertia += e.inertia;
      above.inertia.noalias() -= scaled * e.projected.transpose();
      above.force += rest - scaled * e.drive;
    }
  }
  for (int i = 0; i < tree.bodies; ++i) {
    const Element& e = elements_[i];
    const int p = tree.parent[i];
    Vec6 above = Vec6::Zero();
    if (p >= 0) above << m.acceleration[p], m.alpha[p];
    qdd[i] = (e.drive - e.projected.dot(above)) / e.effective;
    m.acceleration[i] = above.head<3>() + m.pose.v[i] * qdd[i] + m.drift_v[i];
    m.alpha[i] = above.tail<3>() + m.pose.w[i] * qdd[i] + m.drift_w[i];
  }
}

}  // namespace sinew::multibody
