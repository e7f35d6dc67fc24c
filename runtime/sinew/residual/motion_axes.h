// Where a joint's motion axes are. Internal to this layer: files of it that are compiled with other options
// each have their own copy, inlined.
#pragma once

#include "sinew/residual/tree.h"

namespace sinew {

/// The two directions that a planar joint slides along.
template <class T>
[[gnu::always_inline]] inline void planar_axes(const Vec3<T>& normal, Vec3<T>& a, Vec3<T>& b) {
  a = normal.unitOrthogonal();
  b = normal.cross(a);
}

/// Motion axes of one joint at its present local transform.
template <class T>
[[gnu::always_inline]] inline void motion_axes(const Tree<T>& tree, int i, const Transform<T>& local,
                                               Kinematics<T>& k) {
  const int first = tree.first_dof[i];
  const Vec3<T>& o = k.origin[i];
  const int p = tree.parent[i];
  const auto turn = [&](int dof, const Vec3<T>& w) {
    k.w[dof] = w;
    k.v[dof] = o.cross(w);
  };
  const auto slide = [&](int dof, const Vec3<T>& v) {
    k.w[dof].setZero();
    k.v[dof] = v;
  };
  switch (tree.type[i]) {
    case JointType::kFixed:
      break;
    case JointType::kRevolute:
      turn(first, k.rotation[i] * tree.axis[i]);
      break;
    case JointType::kPrismatic:
      slide(first, k.rotation[i] * tree.axis[i]);
      break;
    case JointType::kUniversal: {
      // local = rest·exp(axis·q0)·exp(axis2·q1): the first axis turns with the parent side.
      const Vec3<T> second = k.rotation[i] * tree.axis2[i];
      const T q1 = twist_angle<T>(tree.rest[i].rotation.conjugate() * local.rotation, tree.axis2[i]);
      turn(first, k.rotation[i] * (rotation_exp<T>(-q1 * tree.axis2[i]) * tree.axis[i]));
      turn(first + 1, second);
      break;
    }
    case JointType::kBall:
      for (int a = 0; a < 3; ++a) turn(first + a, k.rotation[i].col(a));
      break;
    case JointType::kPlanar: {
      const Mat3<T> frame =
          (p < 0 ? Mat3<T>(Mat3<T>::Identity()) : k.rotation[p]) * tree.rest[i].rotation.toRotationMatrix();
      Vec3<T> a, b;
      planar_axes(tree.axis[i], a, b);
      slide(first, frame * a);
      slide(first + 1, frame * b);
      turn(first + 2, frame * tree.axis[i]);
      break;
    }
    case JointType::kFree: {
      const Mat3<T> frame = p < 0 ? Mat3<T>(Mat3<T>::Identity()) : k.rotation[p];
      for (int a = 0; a < 3; ++a) {
        slide(first + a, frame.col(a));
        turn(first + 3 + a, frame.col(a));
      }
      break;
    }
    case JointType::kTranslation: {
      const Mat3<T> frame = p < 0 ? Mat3<T>(Mat3<T>::Identity()) : k.rotation[p];
      for (int a = 0; a < 3; ++a) slide(first + a, frame.col(a));
      break;
    }
  }
}

}  // namespace sinew
