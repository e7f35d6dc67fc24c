#include "sinew/crowd/rig.h"

#include <cmath>

namespace sinew {
namespace {

/// Colliders of joints that ride along are their body's.
std::vector<ContactPoint<float>> contact_points(const Skeleton& skeleton) {
  std::vector<ContactPoint<float>> points;
  for (Collider collider : skeleton.colliders) {
    while (collider.joint >= skeleton.body_count) {
      collider.local = skeleton.joints[collider.joint].rest * collider.local;
      collider.joint = skeleton.joints[collider.joint].parent;
    }
    append_contact_points<float>(collider, points);
  }
  return points;
}

}  // namespace

CrowdRig::CrowdRig(const Skeleton& skeleton, const CrowdSettings& settings)
    : tree(skeleton), support(tree, contact_points(skeleton)) {
  for (int i = 0; i < tree.bodies; ++i) {
    // The box that fits into an ellipsoid: what leaves it may still be played, by the world.
    const double share = skeleton.joints[i].ellipsoidal_limit ? std::sqrt(1.0 / 3) : 1;
    for (int k = 0; k < tree.dof_count(i); ++k) {
      const auto [minus, plus] = skeleton.torque_limits(i, k);
      torque_plus.push_back(float(share * plus));
      torque_minus.push_back(float(share * minus));
    }
  }
  for (const Joint& joint : skeleton.joints) parent.push_back(joint.parent);
  view.tree = &tree;
  view.parent = parent.data();
  view.joints = int(parent.size());
  if (settings.ground) view.support = &support;
  view.first_checked_dof = tree.type[0] == JointType::kFree ? tree.dof_count(0) : 0;
  for (int a = 0; a < 3; ++a) view.gravity[a] = float(settings.gravity[a]);
  view.ground_height = float(settings.ground_height);
}

}  // namespace sinew
