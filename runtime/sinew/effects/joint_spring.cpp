#include "sinew/effects/joint_spring.h"

#include <algorithm>

#include "sinew/muscle/joint_coordinates.h"

namespace sinew {
namespace {

/// One row per degree of freedom of a joint: ½k·(offset − rest)².
template <class T>
void append_springs(const Tree<T>& tree, int body, const JointOffset<T>& offset, const Vec3<T>& rest,
                    T stiffness, RowScalar scalar, std::vector<JointRow<T>>& out) {
  const bool ball = tree.type[body] == JointType::kBall;
  for (int k = 0; k < tree.dof_count(body); ++k) {
    JointRow<T> row;
    row.kind = RowKind::kSpring;
    row.scalar = scalar;
    row.component = k;
    row.dof = tree.first_dof[body] + (ball ? 0 : k);
    row.count = ball ? 3 : 1;
    row.gradient = {T(1), T(0), T(0)};
    for (int a = 0; a < 3 && ball; ++a) row.gradient[a] = offset.rotational(k, a);
    row.value = offset.value[k] - rest[k];
    row.stiffness = stiffness;
    out.push_back(row);
  }
}

}  // namespace

template <class T>
Status JointSpring<T>::attach(const Skeleton& skeleton, const Tree<T>& tree) {
  if (!(settings.stiffness >= 0) || !(settings.damping >= 0) || !settings.rest.allFinite())
    return Status::error(Code::kInvalidArgument, "joint spring needs a stiffness and a damping ≥ 0");
  std::vector<int> named;
  if (Status status = bodies_named(skeleton, settings.joints, named); !status) return status;
  bodies_.clear();
  rows_ = 0;
  for (const int body : named) {
    if (tree.dof_count(body) == 0 || tree.type[body] == JointType::kFree) continue;
    bodies_.push_back(body);
    rows_ += 2 * tree.dof_count(body);
  }
  return {};
}

template <class T>
void JointSpring<T>::add_rows(const EffectPose<T>& pose, std::vector<JointRow<T>>& out) const {
  const Vec3<T> rest = settings.rest.template cast<T>();
  for (const int body : bodies_) {
    if (settings.stiffness > 0)
      append_springs<T>(pose.tree, body,
                        joint_offset<T>(pose.tree, body, pose.tree.rest[body], pose.local[body]), rest,
                        T(settings.stiffness), RowScalar::kFromRest, out);
    if (settings.damping > 0)
      append_springs<T>(pose.tree, body, joint_offset<T>(pose.tree, body, pose.start[body], pose.local[body]),
                        Vec3<T>::Zero(), T(settings.damping) / pose.h, RowScalar::kFromStart, out);
  }
}

template class JointSpring<float>;
template class JointSpring<double>;

}  // namespace sinew
