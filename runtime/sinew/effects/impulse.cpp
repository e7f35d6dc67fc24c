#include "sinew/effects/impulse.h"

namespace sinew {

template <class T>
double add_gradient(const ExternalForce<T>& push, const Kinematics<T>& kinematics, const Wrenches<T>& out) {
  const Vec3<T> x = point_of(push, kinematics);
  out.force[push.body] -= push.force;
  out.moment[push.body] -= x.cross(push.force);
  return -double(push.force.dot(x));
}

template <class T>
void add_curvature(const ExternalForce<T>& push, const Kinematics<T>& kinematics,
                   std::span<Composite<T>> out) {
  out[push.body].add_force(point_of(push, kinematics), -push.force);
}

SINEW_IMPULSE_INSTANCES(template, float)
SINEW_IMPULSE_INSTANCES(template, double)

}  // namespace sinew
