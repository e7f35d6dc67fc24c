#include "sinew/character/sweep.h"

#include <algorithm>

namespace sinew {
namespace {

constexpr double kClose = 1e-3;  ///< m; nearer counts as touching
constexpr int kMostAdvances = 48;

/// Motion below which a feature cannot get to the far side of the shape, m.
template <class T>
T safe_motion(const Contact<T>& c) {
  return T(0.5) * (c.half_thickness() + c.radius);
}

/// Whether the speeds at the beginning of the step can carry a contact's feature through the shape.
template <class T>
bool may_pass(std::span<CharacterState<T>* const> states, const Contact<T>& c, T h) {
  if (c.plane) return false;
  Vec3<T> closing = states[c.tree_a]->point_velocity(c.body_a, c.point);
  if (c.tree_b >= 0) closing -= states[c.tree_b]->point_velocity(c.body_b, c.point);
  const T motion = h * closing.norm();
  return motion > safe_motion(c) && motion > c.gap;
}

/// Displacement of a body's material point by the guess.
template <class T>
Vec3<T> guessed_motion(const CharacterState<T>& s, int body, const Vec3<T>& point) {
  const Kinematics<T>&now = s.problem.kinematics, &then = s.guessed;
  const Vec3<T> local = now.rotation[body].transpose() * (point - now.origin[body]);
  return then.origin[body] + then.rotation[body] * local - point;
}

/// Part of the relative motion until the feature touches, 1 if it does not.
template <class T>
T time_of_impact(std::span<CharacterState<T>* const> states, const Contact<T>& c) {
  const CharacterState<T>& a = *states[c.tree_a];
  const Kinematics<T>* b = c.tree_b < 0 ? nullptr : &states[c.tree_b]->problem.kinematics;
  Vec3<T> motion = guessed_motion(a, c.body_a, c.point);
  if (b) motion -= guessed_motion(*states[c.tree_b], c.body_b, c.point);
  const T length = motion.norm();
  if (length <= safe_motion(c)) return T(1);
  // What touches already is held by its row, unless it is pushed right through.
  if (c.gap < T(kClose)) return -motion.dot(c.normal) > safe_motion(c) ? T(0) : T(1);
  const Vec3<T> in_shape = b ? Vec3<T>(b->rotation[c.body_b].transpose() * motion) : motion;
  Contact<T> probe = c;
  T t = T(0);
  for (int n = 0; n < kMostAdvances && t < T(1); ++n) {
    probe.shape_pose.translation = c.shape_pose.translation - t * in_shape;
    measure<T>(a.problem.kinematics, b, probe);
    if (probe.gap < T(kClose)) return t;
    t += probe.gap / length;
  }
  return std::min(t, T(1));
}

}  // namespace

template <class T>
void sweep(std::span<CharacterState<T>* const> states, std::span<const Contact<T>> contacts, T h,
           std::span<T> share) {
  std::fill(share.begin(), share.end(), T(1));
  bool guessed = false;
  for (const Contact<T>& c : contacts) {
    if (!may_pass(states, c, h)) continue;
    if (!guessed)
      for (CharacterState<T>* s : states)
        forward_kinematics<T>(s->tree, s->problem.local, s->problem.common_origin, s->guessed);
    guessed = true;
    const T t = time_of_impact(states, c);
    share[c.tree_a] = std::min(share[c.tree_a], t);
    if (c.tree_b >= 0) share[c.tree_b] = std::min(share[c.tree_b], t);
  }
}

template void sweep<float>(std::span<CharacterState<float>* const>, std::span<const Contact<float>>, float,
                           std::span<float>);
template void sweep<double>(std::span<CharacterState<double>* const>, std::span<const Contact<double>>,
                            double, std::span<double>);

}  // namespace sinew
