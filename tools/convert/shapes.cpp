#include "convert/shapes.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "sinew/skeleton/principal_axes.h"
#include "sinew/skeleton/rotation.h"

namespace sinew::convert {
namespace {

double percentile(std::vector<double>& values, double p) {
  const auto at = static_cast<std::ptrdiff_t>(p * double(values.size() - 1));
  std::nth_element(values.begin(), values.begin() + at, values.end());
  return values[static_cast<std::size_t>(at)];
}

/// Capsule along the unit vector d that holds `share` of the vertices within its radius. Returns how badly it
/// fits, m: distance of the vertices from its surface on average, plus how far it stands out of the skin.
double capsule_along(const std::vector<Vec3<double>>& vertices, const Vec3<double>& middle,
                     const Vec3<double>& d, double share, double height, Collider& c) {
  std::vector<double> along, away;
  const Vec3<double> offset = middle - d * d.dot(middle);
  for (const Vec3<double>& v : vertices) {
    along.push_back(d.dot(v));
    away.push_back((v - offset - d * d.dot(v)).norm());
  }
  const double low = percentile(along, 0.04), high = percentile(along, 0.96);
  const double radius = std::clamp(percentile(away, share), 0.005 * height, 0.2 * height);
  const double half = std::max(0.0, (high - low) / 2 - radius), centre = (low + high) / 2;
  c.shape = Shape::kCapsule;
  c.size = {radius, radius, half};
  c.local.translation = offset + d * centre;
  c.local.rotation = rotation_between<double>(Vec3<double>::UnitZ(), d);
  double sum = 0;
  std::vector<double> out;
  for (const Vec3<double>& v : vertices) {
    const Vec3<double> nearest = offset + d * std::clamp(d.dot(v), centre - half, centre + half);
    out.push_back(radius - (v - nearest).norm());
    sum += std::abs(out.back());
  }
  return sum / double(vertices.size()) + std::max(0.0, percentile(out, 0.97));
}

}  // namespace

Collider fit_capsule(const std::vector<Vec3<double>>& vertices, const Vec3<double>& bone, double height) {
  Vec3<double> middle = Vec3<double>::Zero();
  for (const Vec3<double>& v : vertices) middle += v;
  middle /= double(vertices.size());
  Mat3<double> scatter = Mat3<double>::Zero();
  for (const Vec3<double>& v : vertices) scatter += (v - middle) * (v - middle).transpose();
  const Mat3<double> axes = principal_axes(scatter).axes;
  Collider best;
  double off = capsule_along(vertices, middle, bone, 0.55, height, best);
  for (const double share : {0.55, 0.25})  // flat parts: more within the skin
    for (int k = -1; k < 3; ++k) {
      Collider other;
      const double of_other =
          capsule_along(vertices, middle, k < 0 ? bone : axes.col(k), share, height, other);
      if (of_other > 0.9 * off) continue;  // the bone's direction unless another is better
      off = of_other;
      best = other;
    }
  return best;
}

Collider fit_sole(const std::vector<Vec3<double>>& vertices, const Vec3<double>& bone,
                  const Quat<double>& rest, double height) {
  const Vec3<double> forward = rest * bone;
  const double heading = std::atan2(forward.y(), forward.x());
  const Quat<double> box(Eigen::AngleAxisd(heading, Vec3<double>::UnitZ()));
  Vec3<double> low = Vec3<double>::Constant(1e9), high = -low;
  for (const Vec3<double>& v : vertices) {
    const Vec3<double> p = box.conjugate() * (rest * v);
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  high.z() = std::min(high.z(), 0.02 * height);  // not up the shin: the ankle is the joint's origin
  Collider c;
  c.shape = Shape::kBox;
  c.size = ((high - low) / 2).cwiseMax(0.004 * height);
  c.local.rotation = rest.conjugate() * box;
  c.local.translation = c.local.rotation * ((low + high) / 2);
  return c;
}

Collider fit_part(const std::vector<Vec3<double>>& vertices, const Vec3<double>& bone) {
  constexpr double kThinnest = 0.002;  // m, of a plate
  Vec3<double> low = vertices.front(), high = low;
  for (const Vec3<double>& v : vertices) {
    low = low.cwiseMin(v);
    high = high.cwiseMax(v);
  }
  Collider box;
  box.shape = Shape::kBox;
  box.size = ((high - low) / 2).cwiseMax(kThinnest);
  box.local.translation = (low + high) / 2;

  Collider capsule = fit_capsule(vertices, bone, (high - low).norm());
  const double half = capsule.size.z();
  double radius = 0;
  for (const Vec3<double>& v : vertices) {
    const Vec3<double> at = capsule.local.inverse() * v;
    radius = std::max(radius, (at - Vec3<double>::UnitZ() * std::clamp(at.z(), -half, half)).norm());
  }
  const double in_capsule = std::numbers::pi * radius * radius * (2 * half + 4 * radius / 3);
  return in_capsule < 8 * box.size.prod() ? capsule : box;
}

}  // namespace sinew::convert
