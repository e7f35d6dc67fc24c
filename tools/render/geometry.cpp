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

/// Joint places in model space at rest.
std::vector<Transform<float>> rest_model(const Skeleton& s) {
  std::vector<Transform<float>> rest;
  for (const Joint& joint : s.joints) {
    const Transform<float> local = joint.rest.cast<float>();
    rest.push_back(joint.parent < 0 ? local : rest[static_cast<std::size_t>(joint.parent)] * local);
  }
  return rest;
}

/// A muscle of the trunk or a limb's root: both ends fixed to a joint at an offset from it (shares of
/// stature; forward, outward, up at rest), coloured by the joint that it moves. Limbs get theirs from the
/// bones' own shapes.
struct Strand {
  Role from;
  float from_offset[3];
  Role to;
  float to_offset[3];
  float radius;
  Role moves;
};
constexpr Strand kStrands[] = {
    {Role::kPelvis,
     {0.062f, 0.018f, -0.012f},
     Role::kChest,
     {0.068f, 0.024f, 0.012f},
     0.017f,
     Role::kSpine},  // abdominals
    {Role::kPelvis,
     {0.030f, 0.062f, 0.010f},
     Role::kChest,
     {0.040f, 0.070f, -0.010f},
     0.018f,
     Role::kSpine},  // obliques
    {Role::kPelvis,
     {-0.050f, 0.020f, 0.020f},
     Role::kChest,
     {-0.052f, 0.024f, 0.060f},
     0.017f,
     Role::kSpine},  // erectors
    {Role::kChest,
     {0.062f, 0.012f, 0.040f},
     Role::kUpperArmL,
     {0.020f, 0.004f, -0.035f},
     0.026f,
     Role::kUpperArmL},  // pectorals
    {Role::kChest,
     {0.030f, 0.020f, 0.078f},
     Role::kUpperArmL,
     {0.005f, 0.028f, -0.060f},
     0.024f,
     Role::kUpperArmL},  // deltoids
    {Role::kChest,
     {-0.048f, 0.020f, -0.010f},
     Role::kUpperArmL,
     {-0.018f, 0.000f, -0.040f},
     0.026f,
     Role::kUpperArmL},  // latissimus
    {Role::kChest,
     {-0.030f, 0.022f, 0.085f},
     Role::kNeck,
     {-0.022f, 0.016f, 0.030f},
     0.014f,
     Role::kNeck},  // trapezius
    {Role::kChest,
     {0.026f, 0.012f, 0.092f},
     Role::kHead,
     {0.002f, 0.030f, 0.010f},
     0.009f,
     Role::kHead},  // sternomastoid
    {Role::kPelvis,
     {-0.050f, 0.030f, 0.010f},
     Role::kThighL,
     {-0.022f, 0.018f, -0.070f},
     0.032f,
     Role::kThighL},  // gluteus
    {Role::kPelvis,
     {0.028f, 0.045f, 0.020f},
     Role::kThighL,
     {0.032f, 0.008f, -0.060f},
     0.018f,
     Role::kThighL},  // hip flexors
};

Role mirrored(Role role) {
  const int r = static_cast<int>(role), first = static_cast<int>(Role::kClavicleL);
  return r >= first && (r - first) % 2 == 0 ? static_cast<Role>(r + 1) : role;
}

bool is_trunk(Role role) {
  return role == Role::kPelvis || role == Role::kSpine || role == Role::kChest || role == Role::kNeck ||
         role == Role::kClavicleL || role == Role::kClavicleR;
}

/// Trunk muscles by role, on both sides. False where the skeleton has no chest and pelvis to carry them.
bool append_strands(const Asset& asset, const scene::CharacterFrame& frame, Geometry& out) {
  const Skeleton& s = asset.skeleton;
  int chest = s.find(Role::kChest);
  for (std::size_t i = 0; chest < 0 && i < s.joints.size(); ++i)  // no chest by name: the highest spine
    if (s.joints[i].role == Role::kSpine && s.find(Role::kUpperArmL) >= 0) chest = static_cast<int>(i);
  const int head = s.find(Role::kHead), foot = s.find(Role::kFootL), pelvis = s.find(Role::kPelvis);
  if (chest < 0 || head < 0 || foot < 0) return false;
  const std::vector<Transform<float>> rest = rest_model(s);
  const auto joint = [&](Role role) {
    return role == Role::kChest ? chest : (role == Role::kPelvis && pelvis < 0 ? 0 : s.find(role));
  };
  const float height = (rest[static_cast<std::size_t>(head)].translation.z() -
                        rest[static_cast<std::size_t>(foot)].translation.z()) /
                       0.86f;
  if (!(height > 0.1f)) return false;
  for (const Strand& strand : kStrands)
    for (const bool left : {true, false}) {
      const int from = joint(left ? strand.from : mirrored(strand.from)),
                to = joint(left ? strand.to : mirrored(strand.to));
      const int moves = joint(left ? strand.moves : mirrored(strand.moves));
      if (from < 0 || to < 0) continue;
      const auto at = [&](int j, const float* offset) {
        const auto k = static_cast<std::size_t>(j);
        const Vec3<float> place =
            rest[k].translation + height * Vec3<float>(offset[0], left ? offset[1] : -offset[1], offset[2]);
        return Vec3<float>(frame.model[k] * (rest[k].inverse() * place));
      };
      append_spindle(at(from, strand.from_offset), at(to, strand.to_offset), strand.radius * height,
                     moves >= 0 ? frame.load[static_cast<std::size_t>(moves)] : 0, out);
    }
  return true;
}

/// Bones with three muscles around each, from the body's shapes; the trunk's own muscles where its parts are
/// known.
void append_muscles(const Asset& asset, const scene::CharacterFrame& frame, Geometry& out) {
  const Skeleton& s = asset.skeleton;
  const bool trunk_done = append_strands(asset, frame, out);
  for (const Collider& c : s.colliders) {
    if (c.joint >= s.body_count) continue;
    const auto joint = static_cast<std::size_t>(c.joint);
    const Transform<float> world = frame.model[joint] * c.local.cast<float>();
    const Role role = s.joints[joint].role;
    if (c.shape == Shape::kBox || role == Role::kToesL || role == Role::kToesR) {
      if (c.shape == Shape::kBox)
        append_capsule(
            {world.rotation * Quat<float>::FromTwoVectors(Vec3<float>::UnitZ(), Vec3<float>::UnitX()),
             world.translation},
            0.6f * float(c.size.z()), 0.75f * float(c.size.x()), kBone, 0, out);
      continue;
    }
    const float radius = float(c.size.x()), half = float(c.size.z()) + 0.5f * radius;
    if (role == Role::kHead) {
      append_capsule(world, 0.82f * radius, float(c.size.z()), kBone, 0, out);
      continue;
    }
    append_capsule(world, (is_trunk(role) ? 0.32f : 0.28f) * radius, half, kBone, 0, out);
    if (trunk_done && is_trunk(role)) continue;
    const Vec3<float> along = world.rotation * Vec3<float>::UnitZ();
    for (int k = 0; k < 3; ++k) {
      const float angle = 2 * kPi * (float(k) + 0.25f) / 3;
      const Vec3<float> side = world.rotation * Vec3<float>(std::cos(angle), std::sin(angle), 0);
      const Vec3<float> middle = world.translation + side * (0.5f * radius);
      append_spindle(middle - along * (half * 1.02f), middle + along * (half * 1.02f), 0.5f * radius,
                     frame.load[joint], out);
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
