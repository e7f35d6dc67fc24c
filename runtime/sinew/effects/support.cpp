#include "sinew/effects/support.h"

#include <Eigen/LU>
#include <algorithm>

namespace sinew {
namespace {

/// How much of its share a point may bear: 1 on the floor, smoothly 0 at `reach` above it. `where` it is, if
/// it bears anything: of most points the height alone tells that they do not.
template <class T>
T bearing(const Kinematics<T>& k, const ContactPoint<T>& p, T ground, T reach, Vec3<T>& where) {
  if (!p.meets_plane()) return T(0);
  const T height = k.origin[p.body].z() + k.rotation[p.body].row(2).dot(p.local) - p.radius - ground;
  if (height > T(1.01) * reach) return T(0);
  where = k.origin[p.body] + k.rotation[p.body] * p.local - Vec3<T>(0, 0, p.radius);
  const T up = std::clamp((where.z() - ground) / reach, T(0), T(1));
  return (1 - up) * (1 - up);
}

}  // namespace

template <class T>
void share_support(const Tree<T>& tree, const Kinematics<T>& k, std::span<const ContactPoint<T>> points,
                   T ground, const SupportSettings& settings, std::span<Vec3<T>> force,
                   std::span<Vec3<T>> moment) {
  Vec3<T> total = Vec3<T>::Zero(), tilt = Vec3<T>::Zero();
  for (int i = 0; i < tree.bodies; ++i) {
    total += force[i];
    tilt += moment[i];
  }
  if (total.z() <= T(0)) return;
  // Vertical forces f_p = w_p·(1, y, −x)·λ balance (F_z, M_x, M_y): weighted least squares with three
  // multipliers.
  const T reach = T(settings.reach);
  Mat3<T> gram = Mat3<T>::Zero();
  T sum = T(0);
  Vec3<T> x;
  std::size_t first = points.size(), last = 0;
  for (std::size_t n = 0; n < points.size(); ++n) {
    const T w = bearing(k, points[n], ground, reach, x);
    if (w <= T(0)) continue;
    first = std::min(first, n);
    last = n;
    const Vec3<T> arm(T(1), x.y(), -x.x());
    gram += w * arm * arm.transpose();
    sum += w;
  }
  if (sum <= T(1e-3)) return;
  points = points.subspan(first, last - first + 1);
  gram += T(1e-6) * (T(1) + gram.trace()) * Mat3<T>::Identity();  // one point alone can't hold a tilt
  // A point can't pull: dropping negative forces and scaling the rest keeps the total.
  const Vec3<T> multiplier = gram.inverse() * Vec3<T>(total.z(), tilt.x(), tilt.y());
  T carried = T(0);
  for (const ContactPoint<T>& p : points) {
    const T w = bearing(k, p, ground, reach, x);
    if (w <= T(0)) continue;
    carried += std::max(T(0), w * multiplier.dot(Vec3<T>(T(1), x.y(), -x.x())));
  }
  if (carried <= T(0)) return;
  // Hardly standing (about to land, or just off): hardly borne, so that forces fade in.
  const T scale = total.z() / carried * std::min(T(1), sum / T(0.2));
  // Forces lean towards where their limb leaves the root by as much as all points can follow, so that a
  // stride's feet brake and push against each other and the hips carry little. `mean` is their average, which
  // the motion does not ask for.
  using Vec2 = Eigen::Matrix<T, 2, 1>;
  const auto lean = [&](int body, const Vec3<T>& at) -> Vec2 {
    while (body > 0 && tree.parent[body] > 0) body = tree.parent[body];
    const T height = k.origin[body].z() - ground;
    return height > reach ? Vec2((k.origin[body] - at).template head<2>() / height) : Vec2(Vec2::Zero());
  };
  Vec2 mean = Vec2::Zero();
  T steepest = T(0);
  for (const ContactPoint<T>& p : points) {
    const T w = bearing(k, p, ground, reach, x);
    if (w <= T(0)) continue;
    const T up = std::max(T(0), w * multiplier.dot(Vec3<T>(T(1), x.y(), -x.x())));
    if (up <= T(0)) continue;
    mean += up / carried * lean(p.body, x);
    steepest = std::max(steepest, lean(p.body, x).norm());
  }
  const T follow = std::min(T(1), T(settings.lean) / std::max(steepest, T(1e-6)));
  // No more friction than the floor could give.
  const Vec2 level = total.template head<2>() / std::max(total.z(), total.template head<2>().norm());
  for (const ContactPoint<T>& p : points) {
    const T w = bearing(k, p, ground, reach, x);
    if (w <= T(0)) continue;
    const T up = scale * std::max(T(0), w * multiplier.dot(Vec3<T>(T(1), x.y(), -x.x())));
    if (up <= T(0)) continue;
    Vec3<T> f(T(0), T(0), up);
    f.template head<2>() = up * (level + follow * (lean(p.body, x) - mean));
    force[p.body] -= f;
    moment[p.body] -= x.cross(f);
  }
}

template void share_support<float>(const Tree<float>&, const Kinematics<float>&,
                                   std::span<const ContactPoint<float>>, float, const SupportSettings&,
                                   std::span<Vec3<float>>, std::span<Vec3<float>>);
template void share_support<double>(const Tree<double>&, const Kinematics<double>&,
                                    std::span<const ContactPoint<double>>, double, const SupportSettings&,
                                    std::span<Vec3<double>>, std::span<Vec3<double>>);

}  // namespace sinew
