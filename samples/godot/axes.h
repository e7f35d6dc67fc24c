// Places in Godot's axes and in Sinew's.
//
// Sinew has X forward, Y left, Z up; Godot has Y up, and a model that came as glTF looks along Z. So Godot's
// x, y, z are Sinew's y, z, x: the same numbers in another order, nothing is rounded.
#pragma once

#include <sinew/c/sinew.h>

#include <array>
#include <cmath>

namespace axes {

/// What a Vector3 of Godot's holds.
using Vector = std::array<float, 3>;
/// What a Transform of Godot's holds: three rows of a matrix, then the origin.
using Transform = std::array<float, 12>;

template <class T>
Vector to_godot(const T* v) {
  return {float(v[1]), float(v[2]), float(v[0])};
}
inline std::array<double, 3> to_sinew(const Vector& v) {
  return {v[2], v[0], v[1]};
}

/// The rotation as a matrix, in single precision: what Godot gets and keeps, to the bit.
inline Transform to_godot(const sinew_transform& joint) {
  const float x = joint.rotation[1], y = joint.rotation[2], z = joint.rotation[0], w = joint.rotation[3];
  const Vector at = to_godot(joint.translation);
  return {1 - 2 * (y * y + z * z),
          2 * (x * y - w * z),
          2 * (x * z + w * y),  //
          2 * (x * y + w * z),
          1 - 2 * (x * x + z * z),
          2 * (y * z - w * x),  //
          2 * (x * z - w * y),
          2 * (y * z + w * x),
          1 - 2 * (x * x + y * y),  //
          at[0],
          at[1],
          at[2]};
}

/// A rotation and a place, in Godot's axes: x_outer = rows * x + origin.
struct Rigid {
  std::array<double, 9> rows{1, 0, 0, 0, 1, 0, 0, 0, 1};
  std::array<double, 3> origin{};

  Rigid() = default;
  explicit Rigid(const Transform& t) : origin{t[9], t[10], t[11]} {
    for (std::size_t k = 0; k < 9; ++k) rows[k] = t[k];
  }
  explicit operator Transform() const {
    Transform t;
    for (std::size_t k = 0; k < 9; ++k) t[k] = float(rows[k]);
    for (std::size_t k = 0; k < 3; ++k) t[9 + k] = float(origin[k]);
    return t;
  }
  Rigid inverse() const {
    Rigid r;
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t k = 0; k < 3; ++k) {
        r.rows[3 * i + k] = rows[3 * k + i];
        r.origin[i] -= rows[3 * k + i] * origin[k];
      }
    return r;
  }
};

inline Rigid operator*(const Rigid& a, const Rigid& b) {
  Rigid r;
  r.rows = {};
  r.origin = a.origin;
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t k = 0; k < 3; ++k) {
      for (std::size_t j = 0; j < 3; ++j) r.rows[3 * i + j] += a.rows[3 * i + k] * b.rows[3 * k + j];
      r.origin[i] += a.rows[3 * i + k] * b.origin[k];
    }
  return r;
}

/// Where a character begins: turned by yaw (rad) about the vertical, and moved.
struct Place {
  double yaw = 0;
  std::array<double, 3> origin{};  ///< Godot's axes
  bool is_none() const { return yaw == 0 && origin == std::array<double, 3>{}; }

  Place() = default;
  /// Of a node; tilt and scale do not count.
  explicit Place(const Rigid& node) : yaw(std::atan2(node.rows[2], node.rows[8])), origin(node.origin) {}
  Rigid rigid() const {
    Rigid r;
    r.rows = {std::cos(yaw), 0, std::sin(yaw), 0, 1, 0, -std::sin(yaw), 0, std::cos(yaw)};
    r.origin = origin;
    return r;
  }
  /// A clip's motion of the root, as it is there. Angular derivatives are in the root's own axes.
  void put(sinew_jet& root) const {
    const auto turn = [&](float* v) {
      const double x = v[0], y = v[1];
      v[0] = float(std::cos(yaw) * x - std::sin(yaw) * y);
      v[1] = float(std::sin(yaw) * x + std::cos(yaw) * y);
    };
    turn(root.translation);
    turn(root.velocity);
    turn(root.acceleration);
    const std::array<double, 3> by{origin[2], origin[0], origin[1]};
    for (std::size_t k = 0; k < 3; ++k) root.translation[k] = float(root.translation[k] + by[k]);
    const double c = std::cos(yaw / 2), s = std::sin(yaw / 2);
    const double x = root.rotation[0], y = root.rotation[1], z = root.rotation[2], w = root.rotation[3];
    const std::array<double, 4> turned{c * x - s * y, c * y + s * x, c * z + s * w, c * w - s * z};
    for (std::size_t k = 0; k < 4; ++k) root.rotation[k] = float(turned[k]);
  }
};

}  // namespace axes
