#include "render/shapes.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "sinew/skeleton/rotation.h"

namespace sinew::render {
namespace {

constexpr float kPi = 3.14159265f;
constexpr int kAround = 20, kAlong = 13;  ///< odd: a capsule's two rims are rings

/// A ring of a surface of revolution.
struct Ring {
  float radius, z;
  Vec3<float> color;
  float glow;
};

/// A surface of revolution about local z; `ring(v)` for v in [0, 1], from the lower end to the upper.
template <class Profile>
void append_lathe(const Transform<float>& world, Profile ring, Geometry& out) {
  static const auto circle = [] {
    std::array<Eigen::Vector2f, kAround + 1> made;
    for (int k = 0; k <= kAround; ++k) {
      const float u = 2 * kPi * float(k % kAround) / kAround;
      made[static_cast<std::size_t>(k)] = {std::cos(u), std::sin(u)};
    }
    return made;
  }();
  const auto first = static_cast<std::uint32_t>(out.vertices.size());
  const Mat3<float> r = world.rotation.toRotationMatrix();
  for (int a = 0; a <= kAlong; ++a) {
    const float v = float(a) / kAlong, e = 1e-3f;
    const Ring here = ring(v), below = ring(std::max(0.f, v - e)), above = ring(std::min(1.f, v + e));
    const Eigen::Vector2f slope =
        Eigen::Vector2f(above.z - below.z, below.radius - above.radius).normalized();
    for (const Eigen::Vector2f& c : circle) {
      const Vec3<float> p = world * Vec3<float>(here.radius * c.x(), here.radius * c.y(), here.z);
      const Vec3<float> n = r * Vec3<float>(slope.x() * c.x(), slope.x() * c.y(), slope.y());
      out.vertices.push_back({{p.x(), p.y(), p.z()},
                              {n.x(), n.y(), n.z()},
                              {0, 0},
                              {here.color.x(), here.color.y(), here.color.z()},
                              here.glow});
    }
  }
  const std::uint32_t across = kAround + 1;
  for (std::uint32_t a = 0; a < kAlong; ++a)
    for (std::uint32_t k = 0; k < kAround; ++k) {
      const std::uint32_t i = first + a * across + k;
      for (const std::uint32_t index : {i, i + 1, i + across + 1, i, i + across + 1, i + across})
        out.indices.push_back(index);
    }
}

}  // namespace

void append_capsule(const Transform<float>& world, float radius, float half, const Vec3<float>& color,
                    float glow, Geometry& out) {
  append_lathe(
      world,
      [&](float v) {
        constexpr float kStretch = float(kAlong) / (kAlong - 1);  // the ring between is the cylinder
        const float turn = (v < 0.5f ? v * kStretch - 0.5f : (v - 1) * kStretch + 0.5f) * kPi;
        return Ring{radius * std::cos(turn) + 1e-5f, radius * std::sin(turn) + (v < 0.5f ? -half : half),
                    color, glow};
      },
      out);
}

void append_box(const Transform<float>& world, const Vec3<float>& half, const Vec3<float>& color,
                Geometry& out) {
  const Mat3<float> r = world.rotation.toRotationMatrix();
  for (int axis = 0; axis < 3; ++axis)
    for (const float side : {-1.f, 1.f}) {
      const auto first = static_cast<std::uint32_t>(out.vertices.size());
      const int b = (axis + 1) % 3, c = (axis + 2) % 3;
      const Vec3<float> n = r.col(axis) * side;
      for (const auto& [s, t] : {std::pair{-1.f, -1.f}, {1.f, -1.f}, {1.f, 1.f}, {-1.f, 1.f}}) {
        Vec3<float> local;
        local[axis] = side * half[axis];
        local[b] = s * half[b] * side;
        local[c] = t * half[c];
        const Vec3<float> p = world * local;
        out.vertices.push_back(
            {{p.x(), p.y(), p.z()}, {n.x(), n.y(), n.z()}, {0, 0}, {color.x(), color.y(), color.z()}, 0});
      }
      for (const std::uint32_t k : {0u, 1u, 2u, 0u, 2u, 3u}) out.indices.push_back(first + k);
    }
}

void append_hull(const Transform<float>& world, const ConvexHull& hull, const Vec3<float>& color,
                 Geometry& out) {
  for (const ConvexHull::Face& face : hull.faces()) {
    const auto first = static_cast<std::uint32_t>(out.vertices.size());
    const Vec3<float> n = world.rotation * face.normal.cast<float>();
    for (const int corner : hull.boundary(face)) {
      const Vec3<float> p = world * hull.corners()[static_cast<std::size_t>(corner)].cast<float>();
      out.vertices.push_back(
          {{p.x(), p.y(), p.z()}, {n.x(), n.y(), n.z()}, {0, 0}, {color.x(), color.y(), color.z()}, 0});
    }
    for (std::uint32_t k = 2; k < static_cast<std::uint32_t>(face.count); ++k)
      for (const std::uint32_t at : {0u, k - 1, k}) out.indices.push_back(first + at);
  }
}

Transform<float> between(const Vec3<float>& a, const Vec3<float>& b) {
  return {rotation_between<float>(Vec3<float>::UnitZ(), b - a), (a + b) / 2};
}

void append_spindle(const Vec3<float>& a, const Vec3<float>& b, float radius, float load, Geometry& out) {
  const float half = (b - a).norm() / 2;
  if (half < 1e-4f) return;
  const Vec3<float> muscle = stress_color(load), tendon(0.66f, 0.60f, 0.52f);
  append_lathe(
      between(a, b),
      [&](float v) {
        const float belly = std::pow(std::max(0.f, std::sin(kPi * v)), 1.35f);
        const float red = std::clamp((belly - 0.12f) / 0.22f, 0.f, 1.f);
        const float end = v <= 0 || v >= 1 ? 0.01f : 1.f;
        return Ring{radius * (0.10f + 0.90f * belly) * end, half * (2 * v - 1),
                    (1 - red) * tendon + red * muscle, red * load};
      },
      out);
}

}  // namespace sinew::render
