#include "sinew/residual/residual_pass.h"
#include "sinew/residual/tree_pass.h"

namespace sinew {

template <class T>
void inertial_wrenches(const Tree<T>& tree, std::span<const JointJet<T>> jets, const Vec3<T>& gravity,
                       const Vec3<T>& common_origin, Kinematics<T>& k, Motion<T>& m, std::span<Vec3<T>> force,
                       std::span<Vec3<T>> moment) {
  for (int i = 0; i < tree.bodies; ++i) {
    const int p = tree.parent[i];
    const JointJet<T>& jet = jets[i];
    BodyMotion<T>& body = m.body[i];
    move_body<T>(tree, i, jet, gravity, p < 0 ? nullptr : &m.body[p], body);
    if (p < 0) {
      k.rotation[i] = body.turn;
      k.origin[i] = jet.translation - common_origin;
      m.origin_velocity[i] = jet.velocity;
    } else {
      const Mat3<T>& rp = k.rotation[p];
      k.rotation[i].noalias() = rp.lazyProduct(body.turn);
      const Vec3<T> arm = rp * jet.translation;
      k.origin[i] = k.origin[p] + arm;
      m.origin_velocity[i] = m.origin_velocity[p] + m.omega[p].cross(arm) + rp * jet.velocity;
    }
    // Products straight into memory: by way of a value they take ten instructions more.
    const Mat3<T>& r = k.rotation[i];
    const Vec3<T> arm = r * tree.center_of_mass[i];
    k.center[i] = k.origin[i] + arm;
    m.omega[i].noalias() = r.lazyProduct(body.omega);
    m.velocity[i] = m.origin_velocity[i] + m.omega[i].cross(arm);
    motion_axes<T>(tree, i, Transform<T>{jet.rotation, jet.translation}, k);
    force[i].noalias() = r.lazyProduct(body.force);
    moment[i] = r * body.moment + k.origin[i].cross(force[i]);
  }
}

SINEW_WRENCH_INSTANCES(template, float)
SINEW_WRENCH_INSTANCES(template, double)

}  // namespace sinew
