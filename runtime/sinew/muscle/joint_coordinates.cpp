#include "sinew/muscle/joint_coordinates.h"

#include "sinew/muscle/joint_coordinates_pass.h"

namespace sinew {

template <class T>
std::array<T, 6> joint_offset_value(const Tree<T>& tree, int i, const Transform<T>& reference,
                                    const Transform<T>& local) {
  return offset_value_of<T>(tree, i, reference, local);
}

template <class T>
JointOffset<T> joint_offset(const Tree<T>& tree, int i, const Transform<T>& reference,
                            const Transform<T>& local) {
  return offset_of<T>(tree, i, reference, local);
}

template <class T>
Transform<T> at_offset(const Tree<T>& tree, int i, const Transform<T>& reference,
                       const std::array<T, 6>& offset) {
  if (tree.type[i] != JointType::kFree) return displaced<T>(tree, i, reference, offset.data());
  Transform<T> moved = reference;
  moved.translation += Vec3<T>(offset[0], offset[1], offset[2]);
  moved.rotation = (reference.rotation * rotation_exp<T>({offset[3], offset[4], offset[5]})).normalized();
  return moved;
}

template <class T>
Transform<T> rebased(const Tree<T>& tree, int i, const Transform<T>& reference, const Transform<T>& local) {
  switch (tree.type[i]) {
    case JointType::kFixed:
      return reference;
    case JointType::kFree:
    case JointType::kTranslation:
      return local;
    case JointType::kBall:
      return {local.rotation, reference.translation};
    default:
      return at_offset<T>(tree, i, reference, joint_offset_value<T>(tree, i, reference, local));
  }
}

SINEW_COORDINATE_INSTANCES(template, float)
SINEW_COORDINATE_INSTANCES(template, double)

}  // namespace sinew
