// What a motion asks of the muscles, the ground's share taken off: the residual pass (residual_pass.h) with
// share_support (support.h) between its two sweeps. The check of a character on its animation, alone and in
// batches: T is float, double or a pack of characters (kernels/check.inl), with the same bits.
#pragma once

#include "sinew/effects/ground_balance.h"
#include "sinew/effects/support.h"
#include "sinew/residual/residual_pass.h"
#include "sinew/skeleton/transform.h"

namespace sinew {

/// What a check works in.
template <class T>
struct CheckScratch {
  std::span<BodyMotion<T>> body;
  std::span<Mat3<T>> rotation;           ///< body → world
  std::span<Vec3<T>> force, moment;      ///< about the root's origin, world axes
  std::span<Vec3<T>> origin;             ///< [joint] from the root's, world axes
  std::span<StandingPoint<T>> standing;  ///< [point]
  std::span<BearingPoint<T>> bearing;    ///< [point]

  static constexpr std::size_t bytes(int bodies, int joints, int points) {
    return std::size_t(bodies) * (sizeof(BodyMotion<T>) + sizeof(Mat3<T>) + 2 * sizeof(Vec3<T>)) +
           std::size_t(joints) * sizeof(Vec3<T>) +
           std::size_t(points) * (sizeof(StandingPoint<T>) + sizeof(BearingPoint<T>));
  }
  /// In `memory` of that many bytes, aligned as T is.
  CheckScratch(void* memory, int bodies, int joints, int points) {
    const auto take = [&]<class U>(std::span<U>& out, int count) {
      out = {static_cast<U*>(memory), std::size_t(count)};
      memory = out.data() + count;
    };
    take(body, bodies);
    take(rotation, bodies);
    take(force, bodies);
    take(moment, bodies);
    take(origin, joints);
    take(standing, points);
    take(bearing, points);
  }
};

/// Where a body is, from its parent.
template <class T>
[[gnu::always_inline]] inline void place_body(const Tree<Number<T>>& tree, int i, const CheckScratch<T>& r) {
  const int p = tree.parent[i];
  if (p < 0) {
    r.rotation[i] = r.body[i].turn;
    r.origin[i] = Vec3<T>::Zero();
  } else {
    r.rotation[i].noalias() = r.rotation[p].lazyProduct(r.body[i].turn);
    r.origin[i] = r.origin[p] + r.rotation[p] * r.body[i].arm;
  }
}

/// What the motion asks of the bodies, in world axes about the common origin.
template <class T>
[[gnu::always_inline]] inline void wrenches_in_world(const CheckScratch<T>& r) {
  for (std::size_t i = 0; i < r.body.size(); ++i) {
    r.force[i] = r.rotation[i] * r.body[i].force;
    r.moment[i] = r.rotation[i] * r.body[i].moment + r.origin[i].cross(r.force[i]);
  }
}

/// And back to the axes of those that may stand.
template <class T, class Ground>
[[gnu::always_inline]] inline void wrenches_to_bodies(const SupportPoints<Number<T>>& points,
                                                      const Ground& ground, const CheckScratch<T>& r) {
  for (std::size_t i = 0; i < r.body.size(); ++i) {
    const Number<T> reach = Number<T>(SupportSettings{}.reach);
    if (!ground.may_stand(points, int(i), r.origin[i], reach)) continue;
    // To the world and back rounds: who has no point within reach keeps what it had.
    const auto near = ground.near(points, int(i), r.origin[i], reach);
    const Vec3<T> force = r.rotation[i].transpose() * r.force[i],
                  moment = r.rotation[i].transpose() * (r.moment[i] - r.origin[i].cross(r.force[i]));
    r.body[i].force = select(near, force, r.body[i].force);
    r.body[i].moment = select(near, moment, r.body[i].moment);
  }
}

/// The ground's share goes from the wrenches of the bodies that may stand on it.
template <class T, class Ground>
void stand(const SupportPoints<Number<T>>& points, const Ground& ground, const CheckScratch<T>& r) {
  wrenches_in_world(r);
  share_support<T>(points, r.rotation, r.origin.first(r.body.size()), ground, {}, r.standing, r.force,
                   r.moment);
  wrenches_to_bodies(points, ground, r);
}

/// The second sweep: put(dof, torque) for every degree of freedom.
template <class T, class Put>
[[gnu::always_inline]] inline void project_bodies(const Tree<Number<T>>& tree, std::span<BodyMotion<T>> body,
                                                  Put put) {
  for (int n = tree.bodies - 1; n >= 0; --n) {
    const int i = tree.by_depth[n];
    project_wrench<T>(tree, i, body[i], [&](int k, const T& torque) { put(tree.first_dof[i] + k, torque); });
    if (const int p = tree.parent[i]; p >= 0) pass_wrench(body[i], body[p]);
  }
}

/// On a free root, by its degrees of freedom.
template <class T>
struct RootWrench {
  Vec3<T> force = Vec3<T>::Zero();   ///< N, world axes
  Vec3<T> moment = Vec3<T>::Zero();  ///< N·m, about its joint, likewise

  T& operator[](int dof) { return dof < 3 ? force[dof] : moment[dof - 3]; }              ///< of six
  const T& operator[](int dof) const { return dof < 3 ? force[dof] : moment[dof - 3]; }  ///< the same
};

/// What bears on the ground in a check, if anything does.
template <class T>
struct Standing {
  const SupportTerm<T>* support = nullptr;  ///< null: in flight
  const SupportPoints<T>& points;
  T ground = T(0);    ///< m, its height
  T friction = T(1);  ///< the floor's
  T weight = T(0);    ///< N, of a character that has nothing but the ground; 0: its root bears the rest
  const GroundProbe<T>* probe = nullptr;  ///< instead, where there is more than a floor
  const RootWrench<T>* hand = nullptr;    ///< that bears the root besides, if any does

  /// Takes off what the ground bears; `height`: of the root above it, m.
  void bear(T height, const CheckScratch<T>& scratch) const {
    if (hand) {
      scratch.body[0].force -= scratch.body[0].turn.transpose() * hand->force;
      scratch.body[0].moment -= scratch.body[0].turn.transpose() * hand->moment;
    }
    if (!support) return;
    if (probe)
      support->on_surroundings(points, *probe, weight, scratch);
    else if (weight > T(0))
      support->balance(points, -height, friction, weight, scratch);
    else
      support->stand(points, -height, scratch);
  }
};

/// Wrenches [body] in world axes about the root's origin, to those in the bodies' axes.
template <class T>
void add_wrenches(const Kinematics<T>& kinematics, std::span<const Vec3<T>> force,
                  std::span<const Vec3<T>> moment, std::span<BodyMotion<T>> body) {
  for (std::size_t i = 0; i < body.size(); ++i) {
    body[i].force += kinematics.rotation[i].transpose() * force[i];
    body[i].moment += kinematics.rotation[i].transpose() * (moment[i] - kinematics.origin[i].cross(force[i]));
  }
}

/// Torques [dof] (N·m; N for translations) that the motion `jets` [body] asks for. `scratch` must have this
/// tree's size. O(bodies).
template <class T>
void check_motion(const Tree<T>& tree, std::span<const JointJet<T>> jets, const Vec3<T>& gravity,
                  const Standing<T>& standing, const CheckScratch<T>& scratch, std::span<T> torque) {
  for (const int i : tree.by_depth) {
    const int p = tree.parent[i];
    move_body<T>(tree, i, jets[i], gravity, p < 0 ? nullptr : &scratch.body[p], scratch.body[i]);
    if (standing.support) place_body<T>(tree, i, scratch);
  }
  standing.bear(jets[0].translation.z() - standing.ground, scratch);
  project_bodies<T>(tree, scratch.body, [&](int dof, const T& t) { torque[dof] = t; });
}

}  // namespace sinew
