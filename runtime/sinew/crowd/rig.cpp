#include "sinew/crowd/rig.h"

#include <algorithm>
#include <cmath>

#include "sinew/effects/contact.h"
#include "sinew/effects/support.h"

namespace sinew {
namespace {

using crowd_kernels::Freedom;
using crowd_kernels::RigBody;

static_assert(int(Freedom::kFree) == int(JointType::kFree) && int(Freedom::kBall) == int(JointType::kBall) &&
              int(Freedom::kRevolute) == int(JointType::kRevolute));

template <int N>
void put(const Vec3<double>& v, float (&out)[N]) {
  for (int a = 0; a < 3; ++a) out[a] = float(v[a]);
}

RigBody body_of(const Joint& joint) {
  RigBody body;
  body.parent = joint.parent;
  body.freedom = static_cast<Freedom>(joint.type);
  body.dof_count = dof_count(joint.type);
  body.mass = float(joint.mass);
  const Vec3<double>& c = joint.center_of_mass;
  put(joint.mass * c, body.first);
  const Mat3<double> about_origin =
      joint.inertia + joint.mass * (c.squaredNorm() * Mat3<double>::Identity() - c * c.transpose());
  constexpr int entries[6][2] = {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {0, 2}, {1, 2}};
  for (int n = 0; n < 6; ++n) body.inertia[n] = float(about_origin(entries[n][0], entries[n][1]));
  put(joint.axis, body.axis[0]);
  put(joint.axis2, body.axis[1]);
  if (joint.type == JointType::kUniversal) put(joint.rest.rotation * joint.axis, body.axis[0]);
  if (joint.type == JointType::kPlanar) {
    const Vec3<double> a = joint.axis.unitOrthogonal();
    put(joint.rest.rotation * a, body.axis[0]);
    put(joint.rest.rotation * joint.axis.cross(a), body.axis[1]);
    put(joint.rest.rotation * joint.axis, body.axis[2]);
  }
  return body;
}

}  // namespace

CrowdRig::CrowdRig(const Skeleton& skeleton, const CrowdSettings& settings) {
  std::vector<ContactPoint<double>> contacts;
  for (Collider collider : skeleton.colliders) {
    while (collider.joint >= skeleton.body_count) {
      collider.local = skeleton.joints[collider.joint].rest * collider.local;
      collider.joint = skeleton.joints[collider.joint].parent;
    }
    append_contact_points<double>(collider, contacts);
  }
  for (int i = 0; i < skeleton.body_count; ++i) {
    RigBody body = body_of(skeleton.joints[i]);
    body.first_dof = int(torque_plus.size());
    // The box that fits into an ellipsoid: what leaves it may still be played, by the world.
    const double share = skeleton.joints[i].ellipsoidal_limit ? std::sqrt(1.0 / 3) : 1;
    for (int k = 0; k < body.dof_count; ++k) {
      const auto [minus, plus] = skeleton.torque_limits(i, k);
      torque_plus.push_back(float(share * plus));
      torque_minus.push_back(float(share * minus));
    }
    body.first_point = int(points.size());
    for (const ContactPoint<double>& contact : contacts) {
      if (contact.body != i || !contact.meets_plane()) continue;
      crowd_kernels::RigPoint point;
      put(contact.local, point.local);
      point.radius = float(contact.radius);
      points.push_back(point);
      body.bound = std::max(body.bound, float(contact.local.norm() + contact.radius));
    }
    body.point_count = int(points.size()) - body.first_point;
    bodies.push_back(body);
  }
  view.bodies = bodies.data();
  view.body_count = int(bodies.size());
  view.points = points.data();
  view.dof_count = int(torque_plus.size());
  view.first_checked_dof = bodies[0].freedom == Freedom::kFree ? bodies[0].dof_count : 0;
  put(settings.gravity, view.gravity);
  view.ground = settings.ground;
  view.ground_height = float(settings.ground_height);
  view.support_reach = float(SupportSettings().reach);
  view.support_lean = float(SupportSettings().lean);
}

}  // namespace sinew
