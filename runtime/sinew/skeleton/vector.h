// Vectors, matrices and rotations, templated on the scalar. C++17 suffices for this header and joint_type.h:
// tools that must be compiled so can include them.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace sinew {

template <class T>
using Vec3 = Eigen::Matrix<T, 3, 1>;
template <class T>
using Mat3 = Eigen::Matrix<T, 3, 3>;
template <class T>
using Quat = Eigen::Quaternion<T>;

}  // namespace sinew
