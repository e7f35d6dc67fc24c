#include "sinew/character/prop.h"

#include "sinew/skeleton/convex_hull.h"

namespace sinew {
namespace {

/// Solid inertia of a sphere, capsule or box about its centre, kg·m².
Mat3<double> solid_inertia(Shape shape, const Vec3<double>& size, double mass) {
  Vec3<double> diagonal = Vec3<double>::Zero();
  switch (shape) {
    case Shape::kSphere:
      diagonal.setConstant(0.4 * mass * size.x() * size.x());
      break;
    case Shape::kCapsule: {  // cylinder and two half balls by volume
      const double r = size.x(), l = 2 * size.z();
      const double cylinder = mass * l / (l + 4.0 / 3.0 * r), caps = mass - cylinder;
      const double along = cylinder * r * r / 2 + caps * 0.4 * r * r;
      const double across =
          cylinder * (r * r / 4 + l * l / 12) + caps * (0.4 * r * r + l * l / 4 + 0.375 * l * r);
      diagonal = {across, across, along};
      break;
    }
    case Shape::kConvex:
      break;
    case Shape::kBox: {
      const Vec3<double> square = size.cwiseProduct(size) * (mass / 3);
      diagonal = {square.y() + square.z(), square.x() + square.z(), square.x() + square.y()};
      break;
    }
  }
  return diagonal.asDiagonal();
}

}  // namespace

Skeleton skeleton_of(const PropSettings& prop) {
  Skeleton body;
  body.name = "prop";
  body.body_count = 1;
  Joint& joint = body.joints.emplace_back();
  joint.name = "prop";
  joint.type = JointType::kFree;
  joint.rest = prop.pose;
  joint.mass = prop.mass;
  joint.inertia = solid_inertia(prop.shape, prop.size, prop.mass);
  Collider collider;
  collider.shape = prop.shape;
  collider.size = prop.size;
  if (prop.hull) {
    collider = convex_collider(*prop.hull);
    joint.center_of_mass = prop.hull->center_of_mass();
    joint.inertia = prop.mass * prop.hull->inertia_by_mass();
  }
  collider.friction = prop.friction;
  collider.restitution = prop.restitution;
  body.colliders.push_back(collider);
  return body;
}

}  // namespace sinew
