#include "sinew/effects/contact.h"

#include <algorithm>

namespace sinew {

template <class T>
SignedDistance<T> signed_distance(Shape shape, const Vec3<T>& size, const Vec3<T>& point) {
  switch (shape) {
    case Shape::kSphere:
    case Shape::kCapsule: {
      const T half = shape == Shape::kCapsule ? size.z() : T(0);
      const Vec3<T> offset = point - Vec3<T>(0, 0, std::clamp(point.z(), -half, half));
      const T length = offset.norm();
      // On the axis any direction is right; take one that is square to it.
      const Vec3<T> normal = length > T(1e-9) ? Vec3<T>(offset / length) : Vec3<T>(Vec3<T>::UnitX());
      return {length - size.x(), normal};
    }
    case Shape::kBox:
      break;
  }
  const Vec3<T> beyond = point.cwiseAbs() - size;
  if (beyond.maxCoeff() > T(0)) {  // outside: the nearest point of the box
    const Vec3<T> offset = point - point.cwiseMax(-size).cwiseMin(size);
    const T length = offset.norm();
    return {length, offset / length};
  }
  Eigen::Index axis = 0;
  const T depth = beyond.maxCoeff(&axis);
  Vec3<T> normal = Vec3<T>::Zero();
  normal[axis] = point[axis] < T(0) ? T(-1) : T(1);
  return {depth, normal};
}

template <class T>
void append_contact_points(const Collider& collider, std::vector<ContactPoint<T>>& out) {
  const auto add = [&](const Vec3<double>& in_shape, double radius) {
    out.push_back(
        {collider.joint, (collider.local * in_shape).template cast<T>(), T(radius), T(collider.friction)});
  };
  const Vec3<double>& s = collider.size;
  switch (collider.shape) {
    case Shape::kSphere:
      add(Vec3<double>::Zero(), s.x());
      break;
    case Shape::kCapsule:
      add({0, 0, s.z()}, s.x());
      if (s.z() > 0) add({0, 0, -s.z()}, s.x());
      break;
    case Shape::kBox:
      for (int corner = 0; corner < 8; ++corner)
        add({corner & 1 ? s.x() : -s.x(), corner & 2 ? s.y() : -s.y(), corner & 4 ? s.z() : -s.z()}, 0);
      break;
  }
}

namespace {

template <class T>
Vec3<T> at(const Kinematics<T>* k, int body, const Vec3<T>& local) {
  return k ? Vec3<T>(k->origin[body] + k->rotation[body] * local) : local;
}

}  // namespace

template <class T>
void measure(const Kinematics<T>& a, const Kinematics<T>* b, Contact<T>& c) {
  c.point = at(&a, c.body_a, c.local_a);
  if (c.plane) {
    c.normal = Vec3<T>::UnitZ();
    c.gap = c.point.z() - c.plane_height - c.radius;
  } else {
    const Mat3<T> rotation =
        (b ? b->rotation[c.body_b] : Mat3<T>(Mat3<T>::Identity())) * c.shape_pose.rotation.toRotationMatrix();
    const Vec3<T> origin = at(b, c.body_b, c.shape_pose.translation);
    const SignedDistance<T> d =
        signed_distance<T>(c.shape, c.size, rotation.transpose() * (c.point - origin));
    c.normal = rotation * d.normal;
    c.gap = d.distance - c.radius;
  }
  c.material_point = at(&a, c.body_a, c.material_a);
  c.material_point_b = at(b, c.body_b, c.material_b);
  const Vec3<T> apart = c.material_point - c.material_point_b;  // zero when the step began
  c.slip[0] = c.frame.col(0).dot(apart);
  c.slip[1] = c.frame.col(1).dot(apart);
}

template <class T>
void begin_step(const Kinematics<T>& a, const Kinematics<T>* b, Contact<T>& c) {
  measure(a, b, c);
  const Vec3<T> touch = c.point - (c.radius + c.gap / 2) * c.normal;
  c.material_a = a.rotation[c.body_a].transpose() * (touch - a.origin[c.body_a]);
  c.material_b = b ? Vec3<T>(b->rotation[c.body_b].transpose() * (touch - b->origin[c.body_b])) : touch;
  const Vec3<T> tangent = c.normal.unitOrthogonal();
  c.frame << tangent, c.normal.cross(tangent), c.normal;
  measure(a, b, c);
}

SINEW_CONTACT_INSTANCES(template, float)
SINEW_CONTACT_INSTANCES(template, double)

}  // namespace sinew
