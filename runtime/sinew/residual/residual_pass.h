// The recursive residual pass, one body at a time: what a motion asks of the joints (recursive Newton–Euler).
//
// Every vector is in the axes of its own body, where inertias are constant: a pass in world axes takes twice
// the arithmetic. T is float, double or a pack of characters of one rig (pack.h);
// constants are the tree's, of T's Number. Source: Featherstone, "Rigid Body Dynamics Algorithms", 2008,
// section 5.3.
#pragma once

#include "sinew/residual/tree.h"
#include "sinew/skeleton/scalar.h"

namespace sinew {

/// Its turning from its parent's, null at a root. `body.turn` must be set.
template <class T>
[[gnu::always_inline]] inline void turn_body(const JointJet<T>& jet, const BodyMotion<T>* parent,
                                             BodyMotion<T>& body) {
  if (!parent) {
    body.omega = jet.omega;
    body.alpha = jet.alpha;
  } else {
    const Vec3<T> carried = body.turn.transpose() * parent->omega;
    body.omega = carried + jet.omega;
    body.alpha = body.turn.transpose() * parent->alpha + (jet.alpha + carried.cross(jet.omega));
  }
}

/// The acceleration of its origin. `gravity`: m/s², world.
template <class T>
[[gnu::always_inline]] inline void shift_body(const JointJet<T>& jet, const Vec3<T>& gravity,
                                              const BodyMotion<T>* parent, BodyMotion<T>& body) {
  body.arm = jet.translation;
  Vec3<T> acceleration = jet.acceleration;  // parent axes
  if (!parent) {
    acceleration -= gravity;
  } else {
    const Vec3<T> swept = parent->omega.cross(jet.translation) + (jet.velocity + jet.velocity);
    acceleration +=
        parent->acceleration + (parent->alpha.cross(jet.translation) + parent->omega.cross(swept));
  }
  body.acceleration = body.turn.transpose() * acceleration;
}

/// The wrench that its motion asks for.
template <class T>
[[gnu::always_inline]] inline void load_body(const Tree<Number<T>>& tree, int i, BodyMotion<T>& body) {
  const Vec3<T> first = tree.first_moment[i].template cast<T>();
  const Mat3<T> inertia = tree.inertia_at_joint[i].template cast<T>();
  const Vec3<T> spun = body.alpha.cross(first) + body.omega.cross(body.omega.cross(first));
  body.force = T(tree.mass[i]) * body.acceleration + spun;
  const Vec3<T> momentum = inertia * body.omega;
  body.moment = inertia * body.alpha + (body.omega.cross(momentum) + first.cross(body.acceleration));
}

/// Motion of one body from its parent's, null at a root, and the wrench that it takes: all of the above.
template <class T>
[[gnu::always_inline]] inline void move_body(const Tree<Number<T>>& tree, int i, const JointJet<T>& jet,
                                             const Vec3<T>& gravity, const BodyMotion<T>* parent,
                                             BodyMotion<T>& body) {
  body.turn = jet.rotation.toRotationMatrix();
  turn_body(jet, parent, body);
  shift_body(jet, gravity, parent, body);
  load_body<T>(tree, i, body);
}

/// Adds a body's wrench to its parent's.
template <class T>
[[gnu::always_inline]] inline void pass_wrench(const BodyMotion<T>& body, BodyMotion<T>& parent) {
  const Vec3<T> force = body.turn * body.force;
  parent.force += force;
  parent.moment += body.turn * body.moment + body.arm.cross(force);
}

/// Torques (N·m; N along slides) about the degrees of freedom of a body's joint, as JointType orders them:
/// calls put(k, torque) for each. The wrench must be that of the whole subtree.
template <class T, class Put>
[[gnu::always_inline]] inline void project_wrench(const Tree<Number<T>>& tree, int i,
                                                  const BodyMotion<T>& body, Put put) {
  const auto along = [](const auto& axis, const Vec3<T>& v) -> T {
    return T(axis[0]) * v[0] + T(axis[1]) * v[1] + T(axis[2]) * v[2];
  };
  switch (tree.type[i]) {
    case JointType::kFixed:
      break;
    case JointType::kRevolute:
      put(0, along(tree.axis[i], body.moment));
      break;
    case JointType::kPrismatic:
      put(0, along(tree.axis[i], body.force));
      break;
    case JointType::kUniversal: {
      const Vec3<T> moment = body.turn * body.moment;
      put(0, along(tree.parent_axes[i].col(0), moment));
      put(1, along(tree.axis2[i], body.moment));
      break;
    }
    case JointType::kBall:
      for (int a = 0; a < 3; ++a) put(a, T(body.moment[a]));
      break;
    case JointType::kPlanar: {
      const Vec3<T> force = body.turn * body.force, moment = body.turn * body.moment;
      put(0, along(tree.parent_axes[i].col(0), force));
      put(1, along(tree.parent_axes[i].col(1), force));
      put(2, along(tree.parent_axes[i].col(2), moment));
      break;
    }
    case JointType::kFree: {
      const Vec3<T> moment = body.turn * body.moment;
      for (int a = 0; a < 3; ++a) put(3 + a, T(moment[a]));
      [[fallthrough]];
    }
    case JointType::kTranslation: {
      const Vec3<T> force = body.turn * body.force;
      for (int a = 0; a < 3; ++a) put(a, T(force[a]));
      break;
    }
  }
}

/// The whole pass: torques [dof] that a motion and gravity ask for. `bodies` [body] is room. O(bodies).
template <class T>
void residual_pass(const Tree<Number<T>>& tree, std::span<const JointJet<T>> jets, const Vec3<T>& gravity,
                   std::span<BodyMotion<T>> bodies, std::span<T> torque) {
  for (int i = 0; i < tree.bodies; ++i) {
    const int p = tree.parent[i];
    move_body(tree, i, jets[i], gravity, p < 0 ? nullptr : &bodies[p], bodies[i]);
  }
  for (int i = tree.bodies - 1; i >= 0; --i) {
    project_wrench(tree, i, bodies[i], [&](int k, const T& t) { torque[tree.first_dof[i] + k] = t; });
    if (const int p = tree.parent[i]; p >= 0) pass_wrench(bodies[i], bodies[p]);
  }
}

}  // namespace sinew
