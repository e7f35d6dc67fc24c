// The recursions of tree.h and where a joint's motion axes are, on any scalar: float, double or a pack of
// characters of one rig (pack.h). Constants are the tree's, of T's Number.
//
// `kinematics` is a Kinematics<T> or what has its members.
#pragma once

#include <span>

#include "sinew/residual/tree.h"
#include "sinew/skeleton/rotation.h"

namespace sinew {

/// The two directions that a planar joint slides along.
template <class T>
void planar_axes(const Vec3<Number<T>>& normal, Vec3<T>& a, Vec3<T>& b) {
  const Vec3<Number<T>> first = normal.unitOrthogonal(), second = normal.cross(first);
  a = first.template cast<T>();
  b = second.template cast<T>();
}

/// Whether a degree of freedom slides: its axis never turns anything.
template <class T>
bool slides(const Tree<T>& tree, int dof) {
  const int body = tree.dof_body[dof];
  const int k = dof - tree.first_dof[body];
  switch (tree.type[body]) {
    case JointType::kPrismatic:
    case JointType::kTranslation:
      return true;
    case JointType::kPlanar:
      return k < 2;
    case JointType::kFree:
      return k < 3;
    default:
      return false;
  }
}

/// Motion axes of one joint at its present local transform.
template <class T, class K>
void motion_axes(const Tree<Number<T>>& tree, int i, const Transform<T>& local, K& k) {
  const int first = tree.first_dof[i];
  const Vec3<T>& o = k.origin[i];
  const int p = tree.parent[i];
  const Vec3<T> axis = tree.axis[i].template cast<T>(), axis2 = tree.axis2[i].template cast<T>();
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
      turn(first, k.rotation[i] * axis);
      break;
    case JointType::kPrismatic:
      slide(first, k.rotation[i] * axis);
      break;
    case JointType::kUniversal: {
      // local = rest·exp(axis·q0)·exp(axis2·q1): the first axis turns with the parent side.
      const Vec3<T> second = k.rotation[i] * axis2;
      const T q1 =
          twist_angle<T>(tree.rest[i].rotation.conjugate().template cast<T>() * local.rotation, axis2);
      turn(first, k.rotation[i] * (rotation_exp<T>(-q1 * axis2) * axis));
      turn(first + 1, second);
      break;
    }
    case JointType::kBall:
      for (int a = 0; a < 3; ++a) turn(first + a, k.rotation[i].col(a));
      break;
    case JointType::kPlanar: {
      const Mat3<T> frame = (p < 0 ? Mat3<T>(Mat3<T>::Identity()) : k.rotation[p]) *
                            tree.rest[i].rotation.toRotationMatrix().template cast<T>();
      Vec3<T> a, b;
      planar_axes<T>(tree.axis[i], a, b);
      slide(first, frame * a);
      slide(first + 1, frame * b);
      turn(first + 2, frame * axis);
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

/// One body at its joint's local transform, its parent being in its place.
template <class T, class K>
void place_body(const Tree<Number<T>>& tree, int i, const Transform<T>& local, const Vec3<T>& common_origin,
                K& out) {
  const int p = tree.parent[i];
  const Mat3<T> relative = local.rotation.toRotationMatrix();
  if (p < 0) {
    out.rotation[i] = relative;
    out.origin[i] = local.translation - common_origin;
  } else {
    out.rotation[i].noalias() = out.rotation[p].lazyProduct(relative);
    out.origin[i] = out.origin[p] + out.rotation[p] * local.translation;
  }
  out.center[i] = out.origin[i] + out.rotation[i] * tree.center_of_mass[i].template cast<T>();
  motion_axes<T>(tree, i, local, out);
}

/// See forward_kinematics.
template <class T, class K>
void place_bodies(const Tree<Number<T>>& tree, std::span<const Transform<T>> local,
                  const Vec3<T>& common_origin, K& out) {
  for (int i = 0; i < tree.bodies; ++i) place_body<T>(tree, i, local[i], common_origin, out);
}

/// See displaced.
template <class T>
Transform<T> moved_by(const Tree<Number<T>>& tree, int i, const Transform<T>& local, const T* d) {
  Transform<T> moved = local;
  const Vec3<T> axis = tree.axis[i].template cast<T>(), axis2 = tree.axis2[i].template cast<T>();
  switch (tree.type[i]) {
    case JointType::kFixed:
      break;
    case JointType::kRevolute:
      moved.rotation = local.rotation * rotation_exp<T>(axis * d[0]);
      break;
    case JointType::kPrismatic:
      moved.translation += local.rotation * (axis * d[0]);
      break;
    case JointType::kUniversal: {
      const Quat<T> relative = tree.rest[i].rotation.conjugate().template cast<T>() * local.rotation;
      const Quat<T> last = rotation_exp<T>(axis2 * twist_angle<T>(relative, axis2));
      moved.rotation = local.rotation * last.conjugate() * rotation_exp<T>(axis * d[0]) * last *
                       rotation_exp<T>(axis2 * d[1]);
      break;
    }
    case JointType::kBall:
      moved.rotation = local.rotation * rotation_exp<T>({d[0], d[1], d[2]});
      break;
    case JointType::kPlanar: {
      Vec3<T> a, b;
      planar_axes<T>(tree.axis[i], a, b);
      moved.translation += tree.rest[i].rotation.template cast<T>() * (a * d[0] + b * d[1]);
      moved.rotation = local.rotation * rotation_exp<T>(axis * d[2]);
      break;
    }
    case JointType::kFree:
      moved.translation += Vec3<T>(d[0], d[1], d[2]);
      moved.rotation = rotation_exp<T>({d[3], d[4], d[5]}) * local.rotation;
      break;
    case JointType::kTranslation:
      moved.translation += Vec3<T>(d[0], d[1], d[2]);
      return moved;
  }
  normalize(moved.rotation);
  return moved;
}

/// See project_wrenches.
template <class T, class K>
void sum_and_project(const Tree<Number<T>>& tree, const K& k, std::span<Vec3<T>> force,
                     std::span<Vec3<T>> moment, std::span<T> projection) {
  for (int i = tree.bodies - 1; i >= 0; --i) {
    for (int d = tree.first_dof[i]; d < tree.first_dof[i + 1]; ++d)
      projection[d] = k.w[d].dot(moment[i]) + k.v[d].dot(force[i]);
    if (const int p = tree.parent[i]; p >= 0) {
      force[p] += force[i];
      moment[p] += moment[i];
    }
  }
}

}  // namespace sinew
