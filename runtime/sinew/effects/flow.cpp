#include "sinew/effects/flow.h"

#include <algorithm>
#include <cmath>

#include "sinew/skeleton/convex_hull.h"
#include "sinew/skeleton/portable_math.h"

namespace sinew {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr double kBall = 0.47, kAcross = 1.2, kAlong = 0.8, kFace = 1.05;  ///< drag coefficients

/// A shape's two Gauss points along each of the sides that are straight, sharing areas and volume.
template <class T>
void append_shared(const Collider& c, const Vec3<double>& straight, const Vec3<double>& drag_areas,
                   double volume, double round, std::vector<FlowSpot<T>>& out) {
  const int count = (straight.x() > 0 ? 2 : 1) * (straight.y() > 0 ? 2 : 1) * (straight.z() > 0 ? 2 : 1);
  const Mat3<double> axes = c.local.rotation.toRotationMatrix();
  const Vec3<double> roots = (drag_areas / count).unaryExpr([](double area) { return portable::cbrt(area); });
  FlowSpot<T> spot;
  spot.body = c.joint;
  spot.spread = (axes * roots.asDiagonal() * axes.transpose()).cast<T>();
  spot.volume = T(volume / count);
  spot.round = T(round);
  spot.extent = (axes * (straight / 2).asDiagonal()).cast<T>();
  const auto ends = [](double side) { return side > 0 ? 2 : 1; };
  const auto place = [](double side, int end) { return (end == 0 ? -1 : 1) * side / std::sqrt(3.0); };
  for (int i = 0; i < ends(straight.x()); ++i)
    for (int j = 0; j < ends(straight.y()); ++j)
      for (int k = 0; k < ends(straight.z()); ++k) {
        const Vec3<double> at(place(straight.x(), i), place(straight.y(), j), place(straight.z(), k));
        spot.local = (c.local * at).cast<T>();
        out.push_back(spot);
      }
}

template <class T>
void append_spots(const Collider& c, std::vector<FlowSpot<T>>& out) {
  const Vec3<double>& size = c.size;
  const double r = size.x(), disc = kPi * r * r, ball = 4.0 / 3 * r * disc;
  switch (c.shape) {
    case Shape::kSphere:
      append_shared<T>(c, Vec3<double>::Zero(), Vec3<double>::Constant(kBall * disc), ball, r, out);
      break;
    case Shape::kCapsule: {
      const double side = kAcross * 4 * r * size.z() + kBall * disc;
      append_shared<T>(c, {0, 0, size.z()}, {side, side, kAlong * disc}, 2 * size.z() * disc + ball, r, out);
      break;
    }
    case Shape::kBox: {
      const Vec3<double> faces(size.y() * size.z(), size.x() * size.z(), size.x() * size.y());
      append_shared<T>(c, size, 4 * kFace * faces, 8 * size.prod(), 0, out);
      break;
    }
    case Shape::kConvex: {
      Collider middle = c;
      middle.local.translation = c.local * c.hull->center_of_mass();
      append_shared<T>(middle, size, kFace * c.hull->shadow(), c.hull->volume(), 0, out);
      break;
    }
  }
}

}  // namespace

template <class T>
Status flow_spots(const Skeleton& skeleton, std::span<const std::string> joints,
                  std::vector<FlowSpot<T>>& out) {
  std::vector<int> bodies;
  if (Status status = bodies_named(skeleton, joints, bodies); !status) return status;
  out.clear();
  for (Collider collider : skeleton.colliders) {
    while (collider.joint >= skeleton.body_count) {  // rides along on a simulated joint
      collider.local = skeleton.joints[collider.joint].rest * collider.local;
      collider.joint = skeleton.joints[collider.joint].parent;
    }
    if (std::count(bodies.begin(), bodies.end(), collider.joint) > 0) append_spots<T>(collider, out);
  }
  return {};
}

template Status flow_spots<float>(const Skeleton&, std::span<const std::string>,
                                  std::vector<FlowSpot<float>>&);
template Status flow_spots<double>(const Skeleton&, std::span<const std::string>,
                                   std::vector<FlowSpot<double>>&);

}  // namespace sinew
