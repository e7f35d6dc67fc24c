#include "sinew/multibody/recursive_residual.h"

namespace sinew::multibody {

RecursiveResidual::RecursiveResidual(const Model& model)
    : model_(&model), force_(model.size()), moment_(model.size()) {}

void RecursiveResidual::evaluate(const BodyMotion& m, const AppliedForces& applied,
                                 Eigen::Ref<Vector> residual) {
  for (int i = 0; i < model_->size(); ++i) {
    inertial_wrench(*model_, m, i, force_[i], moment_[i]);
    force_[i] -= applied.force[i];
    moment_[i] -= applied.moment[i];
  }
  project_wrenches<double>(model_->tree, m.pose, force_, moment_,
                           {residual.data(), static_cast<std::size_t>(residual.size())});
  residual -= applied.joint;
}

}  // namespace sinew::multibody
