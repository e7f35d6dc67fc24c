#include "sinew/effects/continuous_detection.h"

#include <algorithm>

#include "sinew/effects/static_shape.h"

namespace sinew {
namespace {

constexpr double kClose = 1e-3;  ///< m; nearer counts as touching
constexpr int kMostAdvances = 48;

/// Motion below which a feature cannot get to the far side of the shape, m.
template <class T>
T safe_motion(const Contact<T>& c) {
  return T(0.5) * (half_thickness(c) + c.radius);
}

/// Whether the speeds at the beginning of the step can carry a contact's feature through the shape.
template <class T>
bool may_pass(std::span<const IslandTree<T>> trees, const Contact<T>& c, T h) {
  if (c.plane) return false;
  Vec3<T> closing = trees[c.tree_a].point_velocity(c.body_a, c.point);
  if (c.tree_b >= 0) closing -= trees[c.tree_b].point_velocity(c.body_b, c.point);
  const T motion = h * closing.norm();
  return motion > safe_motion(c) && motion > c.gap;
}

/// Displacement of a body's material point by the guess.
template <class T>
Vec3<T> guessed_motion(const IslandTree<T>& s, int body, const Vec3<T>& point) {
  const Kinematics<T>&now = s.problem.kinematics, &then = s.guessed;
  const Vec3<T> local = now.rotation[body].transpose() * (point - now.origin[body]);
  return then.origin[body] + then.rotation[body] * local - point;
}

/// Part of the relative motion until the feature touches, 1 if it does not.
template <class T>
T time_of_impact(std::span<const IslandTree<T>> trees, const Contact<T>& c) {
  const IslandTree<T>& a = trees[c.tree_a];
  const Kinematics<T>* b = c.tree_b < 0 ? nullptr : &trees[c.tree_b].problem.kinematics;
  Vec3<T> motion = guessed_motion(a, c.body_a, c.point);
  if (b) motion -= guessed_motion(trees[c.tree_b], c.body_b, c.point);
  const T length = motion.norm();
  if (length <= safe_motion(c)) return T(1);
  // What touches already is held by its row, unless it is pushed right through.
  if (c.gap < T(kClose) * c.length_scale) return -motion.dot(c.normal) > safe_motion(c) ? T(0) : T(1);
  const Vec3<T> in_shape = b ? Vec3<T>(b->rotation[c.body_b].transpose() * motion) : motion;
  Contact<T> probe = c;
  T t = T(0);
  for (int n = 0; n < kMostAdvances && t < T(1); ++n) {
    probe.shape_pose.translation = c.shape_pose.translation;
    probe.local_b = c.local_b;
    probe.shift_b(-t * in_shape);
    measure<T>(a.problem.kinematics, b, probe);
    if (probe.gap < T(kClose) * c.length_scale) return t;
    t += probe.gap / length;
  }
  return std::min(t, T(1));
}

}  // namespace

template <class T>
void ContinuousDetection<T>::limit_guess(Trees trees, std::span<const Contact<T>> contacts, T h,
                                         std::span<T> share) {
  bool guessed = false;
  for (const Contact<T>& c : contacts) {
    if (!may_pass(trees, c, h)) continue;
    if (!guessed)
      for (const IslandTree<T>& t : trees)
        forward_kinematics<T>(*t.problem.tree, t.problem.local, t.problem.common_origin, t.guessed);
    guessed = true;
    const T free = time_of_impact(trees, c);
    share[c.tree_a] = std::min(share[c.tree_a], free);
    if (c.tree_b >= 0) share[c.tree_b] = std::min(share[c.tree_b], free);
  }
}

template <class T>
bool ContinuousDetection<T>::meets_on_the_way(Trees trees, const Contact<T>& contact) const {
  return !contact.plane && time_of_impact<T>(trees, contact) < T(1);
}

template class ContinuousDetection<float>;
template class ContinuousDetection<double>;

}  // namespace sinew
