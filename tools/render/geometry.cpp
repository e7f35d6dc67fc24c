#include "render/geometry.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace sinew::render {
namespace {

constexpr float kPi = 3.14159265f;
constexpr int kAround = 20, kAlong = 12;
const Vec3<float> kBone(0.62f, 0.60f, 0.56f);
const Vec3<float> kClay(0.52f, 0.50f, 0.48f);

/// A surface of revolution about local z: radius and height over v in [0, 1].
template <class Profile>
void append_lathe(const Transform<float>& world, const Vec3<float>& color, float glow, Profile profile,
                  Geometry& out) {
  const auto first = static_cast<std::uint32_t>(out.vertices.size());
  const Mat3<float> r = world.rotation.toRotationMatrix();
  for (int a = 0; a <= kAlong; ++a) {
    const float v = float(a) / kAlong, e = 1e-3f;
    const auto [radius, z] = profile(v);
    const auto [r0, z0] = profile(std::max(0.f, v - e));
    const auto [r1, z1] = profile(std::min(1.f, v + e));
    Eigen::Vector2f slope(z1 - z0, -(r1 - r0));
    slope.normalize();
    for (int k = 0; k <= kAround; ++k) {
      const float u = 2 * kPi * float(k) / kAround, c = std::cos(u), s = std::sin(u);
      const Vec3<float> p = world * Vec3<float>(radius * c, radius * s, z);
      const Vec3<float> n = r * Vec3<float>(slope.x() * c, slope.x() * s, slope.y());
      out.vertices.push_back(
          {{p.x(), p.y(), p.z()}, {n.x(), n.y(), n.z()}, {0, 0}, {color.x(), color.y(), color.z()}, glow});
    }
  }
  const std::uint32_t ring = kAround + 1;
  for (std::uint32_t a = 0; a < kAlong; ++a)
    for (std::uint32_t k = 0; k < kAround; ++k) {
      const std::uint32_t i = first + a * ring + k;
      for (const std::uint32_t index : {i, i + 1, i + ring + 1, i, i + ring + 1, i + ring})
        out.indices.push_back(index);
    }
}

void append_capsule(const Transform<float>& world, float radius, float half, const Vec3<float>& color,
                    float glow, Geometry& out) {
  append_lathe(
      world, color, glow,
      [=](float v) {
        const float turn = (v - 0.5f) * kPi;  // half the rings on each cap
        return std::pair{radius * std::cos(turn) + 1e-5f,
                         radius * std::sin(turn) + (v < 0.5f ? -half : half)};
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

/// Frame whose z runs from a to b, in its middle.
Transform<float> between(const Vec3<float>& a, const Vec3<float>& b) {
  return {Quat<float>::FromTwoVectors(Vec3<float>::UnitZ(), b - a), (a + b) / 2};
}

void append_spindle(const Vec3<float>& a, const Vec3<float>& b, float radius, float load, Geometry& out) {
  const float half = (b - a).norm() / 2;
  if (half < 1e-4f) return;
  append_lathe(
      between(a, b), stress_color(load), load,
      [=](float v) {
        const float belly = std::sin(kPi * v);
        return std::pair{radius * (0.12f + 0.88f * belly * belly) * (v <= 0 || v >= 1 ? 0.01f : 1.f),
                         half * (2 * v - 1)};
      },
      out);
}

/// Muscles between a bone and its parent bone: a pair or a ring around the bone that the joint moves.
void append_muscles(const Asset& asset, const scene::CharacterFrame& frame, Geometry& out) {
  const Skeleton& s = asset.skeleton;
  for (const Collider& c : s.colliders) {
    if (c.joint >= s.body_count || c.shape != Shape::kCapsule) continue;
    const Transform<float> world = frame.model[c.joint] * c.local.cast<float>();
    const float radius = float(c.size.x()), half = float(c.size.z()) + 0.5f * radius;
    const Vec3<float> along = world.rotation * Vec3<float>::UnitZ();
    append_capsule(world, 0.28f * radius, half, kBone, 0, out);
    const bool wide = radius > 0.9f * half;
    const int count = wide ? 5 : 3;
    for (int k = 0; k < count; ++k) {
      const float angle = 2 * kPi * (float(k) + 0.25f) / float(count);
      const Vec3<float> side = world.rotation * Vec3<float>(std::cos(angle), std::sin(angle), 0);
      const Vec3<float> middle = world.translation + side * (0.5f * radius);
      append_spindle(middle - along * (half * 1.02f), middle + along * (half * 1.02f),
                     (wide ? 0.34f : 0.5f) * radius, frame.load[c.joint], out);
    }
  }
}

void append_shapes(const Asset& asset, const scene::CharacterFrame& frame, Geometry& out) {
  const Skeleton& s = asset.skeleton;
  for (const Collider& c : s.colliders) {
    const float load = frame.load[c.joint];
    const float glow = std::clamp((load - 0.25f) / 0.75f, 0.f, 1.f);
    const Vec3<float> color = (1 - glow) * kClay + glow * stress_color(load);
    append_shape(c.shape, c.size.cast<float>(), frame.model[c.joint] * c.local.cast<float>(), color, out);
  }
  if (!s.colliders.empty()) return;
  for (std::size_t i = 1; i < s.joints.size(); ++i) {  // bare joints: sticks
    if (s.joints[i].parent < 0) continue;
    const Vec3<float> a = frame.model[s.joints[i].parent].translation, b = frame.model[i].translation;
    const float length = (b - a).norm();
    if (length > 1e-3f) append_capsule(between(a, b), 0.08f * length, 0.42f * length, kBone, 0, out);
  }
}

void append_mesh(const Asset& asset, const Mesh& mesh, const scene::CharacterFrame& frame, float alpha,
                 Geometry& out) {
  const std::size_t joints = asset.skeleton.joints.size();
  std::vector<Mat3<float>> turn(joints);
  std::vector<Vec3<float>> shift(joints);
  for (std::size_t j = 0; j < joints; ++j) {
    const Transform<float> x = frame.model[j] * asset.inverse_bind[j];
    turn[j] = x.rotation.toRotationMatrix();
    shift[j] = x.translation;
  }
  const Material* material =
      mesh.material >= 0 ? &asset.materials[static_cast<std::size_t>(mesh.material)] : nullptr;
  const Vec3<float> base =
      material ? Vec3<float>(material->base_color[0], material->base_color[1], material->base_color[2])
               : kClay;
  const auto first = static_cast<std::uint32_t>(out.vertices.size());
  Draw draw{static_cast<int>(out.indices.size()), 0, material, alpha};
  for (std::size_t v = 0; v < mesh.positions.size() / 3; ++v) {
    Mat3<float> r = Mat3<float>::Zero();
    Vec3<float> t = Vec3<float>::Zero();
    float load = 0;
    for (std::size_t k = 0; k < 4; ++k) {
      const float w = mesh.weights[4 * v + k];
      if (w <= 0) continue;
      const std::uint16_t j = mesh.joints[4 * v + k];
      r += w * turn[j];
      t += w * shift[j];
      load += w * frame.load[j];
    }
    const Vec3<float> p =
        r * Vec3<float>(mesh.positions[3 * v], mesh.positions[3 * v + 1], mesh.positions[3 * v + 2]) + t;
    const Vec3<float> n =
        (r * Vec3<float>(mesh.normals[3 * v], mesh.normals[3 * v + 1], mesh.normals[3 * v + 2])).normalized();
    const float glow = std::clamp((load - 0.35f) / 0.65f, 0.f, 1.f);
    const Vec3<float> stress = stress_color(load);
    const Vec3<float> color = (1 - glow) * base + glow * stress;
    Vertex made{
        {p.x(), p.y(), p.z()}, {n.x(), n.y(), n.z()}, {0, 0}, {color.x(), color.y(), color.z()}, glow};
    if (!mesh.uvs.empty()) {
      made.uv[0] = mesh.uvs[2 * v];
      made.uv[1] = mesh.uvs[2 * v + 1];
    }
    out.vertices.push_back(made);
  }
  for (const std::uint32_t i : mesh.indices) out.indices.push_back(first + i);
  draw.count = static_cast<int>(out.indices.size()) - draw.first;
  out.draws.push_back(draw);
}

}  // namespace

void Geometry::clear() {
  vertices.clear();
  indices.clear();
  draws.clear();
}

Vec3<float> stress_color(float load) {
  static const std::array<Vec3<float>, 5> ramp{
      Vec3<float>(0.10f, 0.17f, 0.26f), Vec3<float>(0.05f, 0.30f, 0.33f), Vec3<float>(0.20f, 0.48f, 0.36f),
      Vec3<float>(0.92f, 0.56f, 0.10f), Vec3<float>(0.95f, 0.10f, 0.05f)};
  const float at = std::clamp(load, 0.f, 1.f) * 4;
  const int i = std::min(3, static_cast<int>(at));
  return ramp[static_cast<std::size_t>(i)] +
         (at - float(i)) * (ramp[static_cast<std::size_t>(i) + 1] - ramp[static_cast<std::size_t>(i)]);
}

void append_shape(Shape shape, const Vec3<float>& size, const Transform<float>& world,
                  const Vec3<float>& color, Geometry& out) {
  const int first = static_cast<int>(out.indices.size());
  if (shape == Shape::kBox)
    append_box(world, size, color, out);
  else
    append_capsule(world, size.x(), shape == Shape::kCapsule ? size.z() : 0, color, 0, out);
  out.draws.push_back({first, static_cast<int>(out.indices.size()) - first, nullptr, 1});
}

void append_character(const Asset& asset, const scene::CharacterFrame& frame, Look look, Geometry& out) {
  if (look == Look::kXray || look == Look::kShapes || asset.meshes.empty()) {
    const int first = static_cast<int>(out.indices.size());
    if (look == Look::kXray)
      append_muscles(asset, frame, out);
    else
      append_shapes(asset, frame, out);
    if (const int count = static_cast<int>(out.indices.size()) - first; count > 0 && look == Look::kXray)
      out.draws.push_back({first, count, nullptr, 1});
    if (look != Look::kXray && asset.skeleton.colliders.empty())
      out.draws.push_back({first, static_cast<int>(out.indices.size()) - first, nullptr, 1});
  }
  if (look == Look::kShapes) return;
  for (const Mesh& mesh : asset.meshes)
    append_mesh(asset, mesh, frame, look == Look::kXray ? 0.22f : 1.f, out);
}

}  // namespace sinew::render
