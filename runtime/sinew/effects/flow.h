// What a fluid that streams past does to a body: quadratic drag at a few spots of each collider.
//
// A spot feels −(ρ/2)·|Qv|·Q²v with v its velocity against the fluid and Q³ the drag areas along the shape's
// axes: right along each axis, the same in all directions for a ball, and the gradient of the dissipation
// potential (ρ/6)·|Qv|³. That is convex, so the implicit step is stable for any density and speed.
// Two spots along every straight side of a shape, at Gauss's points ±1/√3: exact for translation and for the
// righting moment of buoyancy, 77 % of the drag of a slender body's spin.
// Drag coefficients: Hoerner, "Fluid-dynamic drag", 1965, chapter 3: ball 0.47 (subcritical), cylinder across
// 1.2, along its rounded axis 0.8, faces of a cube 1.05.
#pragma once

#include <vector>

#include "sinew/effects/effect.h"

namespace sinew {

template <class T>
struct FlowSpot {
  int body = 0;
  Vec3<T> local = Vec3<T>::Zero();   ///< m, body axes
  Mat3<T> spread = Mat3<T>::Zero();  ///< Q, body axes, m^(2/3)
  T volume = T(0);                   ///< m³ of the fluid that it displaces
  T round = T(0);                    ///< m, radius of what it stands for
  Mat3<T> extent = Mat3<T>::Zero();  ///< columns: half sides of what it stands for beyond that, body axes, m
};

/// The spots of all colliders on the named joints (see bodies_named).
template <class T>
Status flow_spots(const Skeleton& skeleton, std::span<const std::string> joints,
                  std::vector<FlowSpot<T>>& out);

/// A spot in a fluid during one step.
template <class T>
struct Drag {
  Vec3<T> start = Vec3<T>::Zero();   ///< where it was when the step began, from the common origin
  Vec3<T> flow = Vec3<T>::Zero();    ///< velocity of the fluid there, m/s
  Mat3<T> spread = Mat3<T>::Zero();  ///< Q, world axes
  T half_density = T(0);             ///< ρ/2, kg/m³

  Vec3<T> slip(const Vec3<T>& x, T h) const { return (x - start) / h - flow; }
  /// Power that drag takes over the step, J (a third of it: see the potential above).
  T potential(const Vec3<T>& slip, T h) const {
    const T speed = (spread * slip).norm();
    return h * half_density * speed * speed * speed / 3;
  }
  Vec3<T> gradient(const Vec3<T>& slip) const {
    const Vec3<T> across = spread * slip;
    return (half_density * across.norm()) * (spread * across);
  }
  /// Of the gradient by the place, N/m.
  Mat3<T> change(const Vec3<T>& slip, T h) const {
    const Vec3<T> across = spread * slip;
    const T speed = across.norm();
    if (speed <= T(0)) return Mat3<T>::Zero();
    const Vec3<T> along = spread * across;
    return (half_density / h) * (speed * (spread * spread) + along * along.transpose() / speed);
  }
};

extern template Status flow_spots<float>(const Skeleton&, std::span<const std::string>,
                                         std::vector<FlowSpot<float>>&);
extern template Status flow_spots<double>(const Skeleton&, std::span<const std::string>,
                                          std::vector<FlowSpot<double>>&);

/// Velocity of a body's material point x, of a tree on its animation.
template <class T>
Vec3<T> velocity_at(const EffectPose<T>& pose, const Motion<T>& motion, int body, const Vec3<T>& x) {
  return motion.origin_velocity[body] + motion.omega[body].cross(x - pose.kinematics.origin[body]);
}

}  // namespace sinew
