// Random skeletons with every type of joint, and random motions of them, for tests against differences.
#pragma once

#include <random>
#include <string>
#include <vector>

#include "sinew/residual/tree.h"
#include "sinew/skeleton/rotation.h"
#include "sinew/skeleton/skeleton.h"

namespace sinew::fixtures {

class Random {
 public:
  explicit Random(unsigned seed) : engine_(seed) {}
  double normal(double scale = 1) { return scale * normal_(engine_); }
  int below(int count) { return static_cast<int>(engine_() % static_cast<unsigned>(count)); }
  Vec3<double> vector(double scale = 1) { return {normal(scale), normal(scale), normal(scale)}; }
  Vec3<double> unit() { return vector().normalized(); }
  Quat<double> rotation(double scale = 1) { return rotation_exp<double>(vector(scale)); }
  /// Inertia of a body that can exist: from a positive definite second moment.
  Mat3<double> inertia(double scale) {
    Mat3<double> a;
    a << vector(), vector(), vector();
    const Mat3<double> second = scale * (a * a.transpose() + 0.1 * Mat3<double>::Identity());
    return second.trace() * Mat3<double>::Identity() - second;
  }

 private:
  std::mt19937 engine_;
  std::normal_distribution<double> normal_;
};

/// Two of each type of joint below a free root, hung on random parents; one of the bodies has no mass of its
/// own.
inline Skeleton random_skeleton(unsigned seed) {
  Random random(seed);
  std::vector<JointType> types = {JointType::kFree};
  for (int n = 0; n < 2; ++n)
    for (const JointType type :
         {JointType::kRevolute, JointType::kUniversal, JointType::kBall, JointType::kFixed,
          JointType::kPrismatic, JointType::kPlanar, JointType::kFree})
      types.push_back(type);
  Skeleton s;
  for (const JointType type : types) {
    const int i = static_cast<int>(s.joints.size());
    Joint joint;
    joint.name = "joint" + std::to_string(i);
    joint.type = type;
    joint.parent = i == 0 ? -1 : (i % 3 == 0 ? random.below(i) : i - 1);
    joint.rest = {random.rotation(), random.vector(0.3)};
    joint.axis = random.unit();
    joint.axis2 = joint.axis.unitOrthogonal();
    joint.mass = i == 1 ? 0 : 0.5 + random.below(5);
    joint.center_of_mass = random.vector(0.2);
    joint.inertia = joint.mass > 0 ? random.inertia(0.02 * joint.mass) : Mat3<double>::Zero();
    s.joints.push_back(joint);
  }
  s.body_count = static_cast<int>(s.joints.size());
  return s;
}

/// Transforms that each joint can reach from its rest.
inline std::vector<Transform<double>> random_pose(const Tree<double>& tree, Random& random, double scale) {
  std::vector<Transform<double>> pose(tree.rest.begin(), tree.rest.end());
  for (int i = 0; i < tree.bodies; ++i) {
    double d[6];
    for (double& x : d) x = random.normal(scale);
    pose[i] = displaced<double>(tree, i, pose[i], d);
  }
  return pose;
}

/// All joints moved by the vector d [dof] in their charts.
inline std::vector<Transform<double>> displaced_pose(const Tree<double>& tree,
                                                     const std::vector<Transform<double>>& pose,
                                                     const double* d) {
  std::vector<Transform<double>> moved = pose;
  for (int i = 0; i < tree.bodies; ++i) moved[i] = displaced<double>(tree, i, pose[i], d + tree.first_dof[i]);
  return moved;
}

/// Where the three rotations of joint i begin among its degrees of freedom, or -1.
inline int rotation_vector_dof(const Tree<double>& tree, int i) {
  if (tree.type[i] == JointType::kBall) return tree.first_dof[i];
  if (tree.type[i] == JointType::kFree) return tree.first_dof[i] + 3;
  return -1;
}

/// How joint i's rotation rate at displacement d follows from the rate of d: right Jacobian in child axes for
/// a ball (chart R·exp(d)), left in parent axes for a free joint (chart exp(d)·R).
inline Mat3<double> chart_jacobian(const Tree<double>& tree, int i, const Vec3<double>& d) {
  return right_jacobian<double>(tree.type[i] == JointType::kBall ? d : Vec3<double>(-d));
}

}  // namespace sinew::fixtures
