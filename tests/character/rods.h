// Rods of 2 kg and 1 m on hinges with 30 N·m, whose torques can be worked out by hand.
#pragma once

#include <gtest/gtest.h>

#include <string>

#include "sinew/skeleton/skeleton.h"

namespace sinew::fixtures {

/// A root of 1 kg, and on it so many rods, one on the other, along X when their hinges about Y are at 0.
inline Skeleton rods(int count) {
  Skeleton skeleton;
  skeleton.joints.resize(std::size_t(count) + 1);
  Joint& root = skeleton.joints[0];
  root.name = "root";
  root.type = JointType::kFree;
  root.mass = 1;
  root.inertia = Mat3<double>::Identity();
  for (int k = 1; k <= count; ++k) {
    Joint& rod = skeleton.joints[std::size_t(k)];
    rod.name = "rod" + std::to_string(k);
    rod.parent = k - 1;
    rod.type = JointType::kRevolute;
    rod.axis = Vec3<double>::UnitY();
    rod.mass = 2;
    rod.center_of_mass = {0.5, 0, 0};
    rod.inertia = Vec3<double>(1e-6, 2.0 / 12, 2.0 / 12).asDiagonal();
    if (k > 1) rod.rest.translation = {1, 0, 0};
    for (DofLimits& dof : rod.dofs) dof = {-7, 7, 30, 30, 0, 0};
  }
  skeleton.body_count = count + 1;
  EXPECT_TRUE(validate(skeleton).ok()) << validate(skeleton).reason;
  return skeleton;
}

}  // namespace sinew::fixtures
