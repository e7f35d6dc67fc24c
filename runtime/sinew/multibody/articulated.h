// DTR: accelerations by articulated inertias, without any system of equations (equations 11–21). O(N).
#pragma once

#include "sinew/multibody/force_elements.h"

namespace sinew::multibody {

class ArticulatedInertia {
 public:
  explicit ArticulatedInertia(const Model& model);
  /// Poses and rates of `motion` must be set; overwrites its accelerations.
  void evaluate(BodyMotion& motion, const AppliedForces& applied, Eigen::Ref<Vector> qdd);

 private:
  using Vec6 = Eigen::Matrix<double, 6, 1>;
  using Mat6 = Eigen::Matrix<double, 6, 6>;
  /// One joint's share of the elimination: M̂, Q̂ of its body, M̂b, bᵀM̂b and bᵀ(Q̂ − M̂d) + joint force.
  struct Element {
    Mat6 inertia;
    Vec6 force, projected;
    double effective = 0, drive = 0;
  };

  const Model* model_;
  std::vector<Element> elements_;
};

}  // namespace sinew::multibody
