// How far a joint is from a reference, along each of its degrees of freedom.
#pragma once

#include <array>

#include "sinew/residual/tree.h"

namespace sinew {

/// Offsets of one joint from a reference, one per degree of freedom, and how they change with a small motion
/// of the joint in its chart (see `displaced`): d(offset) = jacobian · d.
template <class T>
struct JointOffset {
  std::array<T, 6> value{};
  Mat3<T> rotational = Mat3<T>::Identity();  ///< of the three rotations of a ball (offsets 0–2) or free joint
                                             ///< (3–5); all other degrees of freedom have the identity
};

/// Offset of `local` from `reference`. Angles of ball and free joints are the rotation vector log(R_ref⁻¹ R),
/// child axes; hinges compare their angle about the axis only, so a reference that also turns across the axis
/// does not matter.
template <class T>
JointOffset<T> joint_offset(const Tree<T>& tree, int body, const Transform<T>& reference,
                            const Transform<T>& local);

/// Only the offsets.
template <class T>
std::array<T, 6> joint_offset_value(const Tree<T>& tree, int body, const Transform<T>& reference,
                                    const Transform<T>& local);

/// The transform whose offset from `reference` is `offset`; inverse of joint_offset.
template <class T>
Transform<T> at_offset(const Tree<T>& tree, int body, const Transform<T>& reference,
                       const std::array<T, 6>& offset);

/// Carries the joint's own freedom over to a reference that has moved on: what the animation does across the
/// joint's axes (a knee's small roll, a bone that stretches) comes from `reference`, what the joint itself
/// does from `local`.
template <class T>
Transform<T> rebased(const Tree<T>& tree, int body, const Transform<T>& reference, const Transform<T>& local);

#define SINEW_COORDINATE_INSTANCES(prefix, T)                                                           \
  prefix JointOffset<T> joint_offset<T>(const Tree<T>&, int, const Transform<T>&, const Transform<T>&); \
  prefix std::array<T, 6> joint_offset_value<T>(const Tree<T>&, int, const Transform<T>&,               \
                                                const Transform<T>&);                                   \
  prefix Transform<T> at_offset<T>(const Tree<T>&, int, const Transform<T>&, const std::array<T, 6>&);  \
  prefix Transform<T> rebased<T>(const Tree<T>&, int, const Transform<T>&, const Transform<T>&);
SINEW_COORDINATE_INSTANCES(extern template, float)
SINEW_COORDINATE_INSTANCES(extern template, double)

}  // namespace sinew
