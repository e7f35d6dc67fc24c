#include "scene/ground.h"

#include <cmath>

namespace sinew::scene {
namespace {

/// Where a ray straight down enters something, and which way that faces.
struct Entry {
  double height;  ///< m
  Vec3<double> normal;
};

std::optional<Entry> entry(const Collider& c, const Vec3<double>& from) {
  if (c.shape == Shape::kSphere) {
    const Vec3<double> centre = c.local.translation;
    const double aside = std::hypot(from.x() - centre.x(), from.y() - centre.y()), radius = c.size.x();
    if (!(aside < radius)) return {};
    const double height = centre.z() + std::sqrt(radius * radius - aside * aside);
    return Entry{height, (Vec3<double>(from.x(), from.y(), height) - centre) / radius};
  }
  if (c.shape != Shape::kBox) return {};
  const Quat<double> back = c.local.rotation.conjugate();
  const Vec3<double> at = back * (from - c.local.translation), down = back * -Vec3<double>::UnitZ();
  double enters = -1e300, leaves = 1e300;
  int face = 0;
  for (int k = 0; k < 3; ++k) {
    if (std::abs(down[k]) < 1e-12) {
      if (std::abs(at[k]) > c.size[k]) return {};
      continue;
    }
    const double side = down[k] > 0 ? -c.size[k] : c.size[k], in = (side - at[k]) / down[k];
    if (in > enters) {
      enters = in;
      face = k;
    }
    leaves = std::min(leaves, (-side - at[k]) / down[k]);
  }
  if (!(enters < leaves)) return {};
  const Vec3<double> normal = c.local.rotation * (Vec3<double>::Unit(face) * (down[face] > 0 ? -1.0 : 1.0));
  return Entry{from.z() - enters, normal};
}

}  // namespace

template <class T>
bool Ground::below(const Vec3<T>& point, GroundHit<T>& hit) const {
  const Vec3<double> from(double(point.x()), double(point.y()), double(point.z()));
  std::optional<Entry> highest;
  if (floor) highest = Entry{*floor, Vec3<double>::UnitZ()};
  for (const Collider& c : obstacles) {
    const std::optional<Entry> met = entry(c, from);
    if (met && met->height <= from.z() && (!highest || met->height > highest->height)) highest = met;
  }
  if (!highest) return false;
  hit.point = Vec3<double>(from.x(), from.y(), highest->height).cast<T>();
  hit.normal = highest->normal.cast<T>().normalized();
  hit.ground = -1;
  return true;
}

template bool Ground::below<float>(const Vec3<float>&, GroundHit<float>&) const;
template bool Ground::below<double>(const Vec3<double>&, GroundHit<double>&) const;

}  // namespace sinew::scene
