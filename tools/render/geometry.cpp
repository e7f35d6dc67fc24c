#include "render/geometry.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "render/muscles.h"
#include "render/shapes.h"

namespace sinew::render {
namespace {

/// Share of the stress colour in a surface at that load: none while the muscles are at ease.
float glow_of(float load) {
  return std::clamp((load - 0.3f) / 0.7f, 0.f, 1.f);
}

/// Bare joints: sticks from parent to child.
void append_sticks(const Skeleton& s, const scene::CharacterFrame& frame, Geometry& out) {
  const std::size_t first = out.indices.size();
  for (std::size_t i = 1; i < s.joints.size(); ++i) {
    if (s.joints[i].parent < 0) continue;
    const Vec3<float> a = frame.model[static_cast<std::size_t>(s.joints[i].parent)].translation,
                      b = frame.model[i].translation;
    const float length = (b - a).norm();
    if (length > 1e-3f) append_capsule(between(a, b), 0.08f * length, 0.42f * length, kBone, 0, out);
  }
  out.close_draw(first, {.closed = true});
}

void append_shapes(const Skeleton& s, const scene::CharacterFrame& frame, Geometry& out) {
  for (const Collider& c : s.colliders) {
    const auto joint = static_cast<std::size_t>(c.joint);
    const float load = frame.effort_of(joint), glow = glow_of(load);
    append_shape(c.shape, c.size.cast<float>(), frame.model[joint] * c.local.cast<float>(),
                 (1 - glow) * kClay + glow * stress_color(load), out, c.hull);
  }
}

/// Joint → world of every joint, from the bind pose: what a vertex moves by.
struct Palette {
  std::vector<Mat3<float>> turn;
  std::vector<Vec3<float>> shift;

  Palette(const Asset& asset, const scene::CharacterFrame& frame) {
    for (std::size_t j = 0; j < asset.skeleton.joints.size(); ++j) {
      const Transform<float> x = frame.model[j] * asset.inverse_bind[j];
      turn.push_back(x.rotation.toRotationMatrix());
      shift.push_back(x.translation);
    }
  }
};

/// Vertices and normals of a mesh as its morph targets have them; those of the mesh where it has none.
struct Morphed {
  std::vector<float> moved, tilted;
  std::span<const float> positions, normals;

  Morphed(const Asset& asset, const Mesh& mesh, const scene::CharacterFrame& frame)
      : positions(mesh.positions), normals(mesh.normals) {
    if (mesh.morphs.empty()) return;
    std::vector<float> weights(mesh.morphs.size(), 0);  // 0 where an asset made by hand names no curve
    for (std::size_t k = 0; k < std::min(weights.size(), mesh.morph_curves.size()); ++k)
      weights[k] = frame.curve(asset, static_cast<std::size_t>(mesh.morph_curves[k]));
    moved.resize(mesh.positions.size());
    tilted.resize(mesh.normals.size());
    if (!MorphJob{mesh.positions, mesh.normals, mesh.morphs, weights, moved, tilted}.Run()) return;
    positions = moved;
    normals = tilted;
  }
  Morphed(const Morphed&) = delete;
  Morphed& operator=(const Morphed&) = delete;
};

void append_mesh(const Asset& asset, const Mesh& mesh, const Palette& palette,
                 const scene::CharacterFrame& frame, bool shell, Geometry& out) {
  const Material* material =
      mesh.material >= 0 ? &asset.materials[static_cast<std::size_t>(mesh.material)] : nullptr;
  const Vec3<float> base =
      material ? Vec3<float>(material->base_color[0], material->base_color[1], material->base_color[2])
               : kClay;
  const auto first_vertex = static_cast<std::uint32_t>(out.vertices.size());
  const std::size_t first_index = out.indices.size();
  const Morphed at(asset, mesh, frame);
  for (std::size_t v = 0; v < mesh.positions.size() / 3; ++v) {
    Mat3<float> r = Mat3<float>::Zero();
    Vec3<float> t = Vec3<float>::Zero();
    float load = 0;
    if (mesh.joints.empty()) {  // rigid: moves with the root
      r = palette.turn[0];
      t = palette.shift[0];
    }
    for (std::size_t k = 0; k < 4 && !mesh.joints.empty(); ++k) {
      const float w = mesh.weights[4 * v + k];
      if (w <= 0) continue;
      const std::uint16_t j = mesh.joints[4 * v + k];
      r += w * palette.turn[j];
      t += w * palette.shift[j];
      load += w * frame.effort_of(j);
    }
    const Vec3<float> p =
        r * Vec3<float>(at.positions[3 * v], at.positions[3 * v + 1], at.positions[3 * v + 2]) + t;
    const Vec3<float> n =
        (r * Vec3<float>(at.normals[3 * v], at.normals[3 * v + 1], at.normals[3 * v + 2])).normalized();
    const float glow = glow_of(load);
    const Vec3<float> color = (1 - glow) * base + glow * stress_color(load);
    Vertex made{
        {p.x(), p.y(), p.z()}, {n.x(), n.y(), n.z()}, {0, 0}, {color.x(), color.y(), color.z()}, glow};
    if (!mesh.uvs.empty()) {
      made.uv[0] = mesh.uvs[2 * v];
      made.uv[1] = mesh.uvs[2 * v + 1];
    }
    out.vertices.push_back(made);
  }
  for (const std::uint32_t i : mesh.indices) out.indices.push_back(first_vertex + i);
  const auto known = out.closed.find(&mesh);
  const bool closed =
      known != out.closed.end() ? known->second : (out.closed[&mesh] = is_closed(mesh));  // of the bind pose
  out.close_draw(first_index, {.material = material, .skin_shell = shell, .closed = closed});
}

}  // namespace

void Geometry::clear() {
  vertices.clear();
  indices.clear();
  draws.clear();
}

void Geometry::close_draw(std::size_t first, const Draw& like) {
  if (indices.size() == first) return;
  draws.push_back(like);
  draws.back().first = static_cast<int>(first);
  draws.back().count = static_cast<int>(indices.size() - first);
}

bool is_closed(const Mesh& mesh) {
  using Edge = std::pair<std::uint32_t, std::uint32_t>;
  const std::size_t count = mesh.positions.size() / 3;
  const auto position = [&](std::uint32_t v) {
    return Vec3<float>(mesh.positions[3 * v], mesh.positions[3 * v + 1], mesh.positions[3 * v + 2]);
  };
  // Vertices at one place are one, whatever their normals and texture coordinates.
  std::map<std::array<float, 3>, std::uint32_t> places;
  std::vector<std::uint32_t> vertex(count), part(count);
  for (std::uint32_t v = 0; v < count; ++v) {
    const Vec3<float> p = position(v);
    vertex[v] = part[v] = places.emplace(std::array{p.x(), p.y(), p.z()}, v).first->second;
  }
  const auto root = [&](std::uint32_t v) {
    while (part[v] != v) v = part[v] = part[part[v]];
    return v;
  };
  std::vector<Edge> there, back;
  for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3)
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = vertex[mesh.indices[i + k]], b = vertex[mesh.indices[i + (k + 1) % 3]];
      there.emplace_back(a, b);
      back.emplace_back(b, a);
      part[root(a)] = root(b);
    }
  std::sort(there.begin(), there.end());
  std::sort(back.begin(), back.end());
  if (there != back || std::adjacent_find(there.begin(), there.end()) != there.end()) return false;
  std::map<std::uint32_t, double> volumes;  // times six
  for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
    const Vec3<float> a = position(mesh.indices[i]), b = position(mesh.indices[i + 1]),
                      c = position(mesh.indices[i + 2]);
    volumes[root(vertex[mesh.indices[i]])] += double(a.dot(b.cross(c)));
  }
  return std::all_of(volumes.begin(), volumes.end(), [](const auto& v) { return v.second > 0; });
}

Vec3<float> stress_color(float load) {
  static const std::array<Vec3<float>, 5> ramp{
      Vec3<float>(0.07f, 0.14f, 0.24f), Vec3<float>(0.03f, 0.26f, 0.31f), Vec3<float>(0.14f, 0.46f, 0.32f),
      Vec3<float>(0.95f, 0.52f, 0.06f), Vec3<float>(1.00f, 0.07f, 0.03f)};
  const float at = std::clamp(load, 0.f, 1.f) * 4;
  const int i = std::min(3, static_cast<int>(at));
  return ramp[static_cast<std::size_t>(i)] +
         (at - float(i)) * (ramp[static_cast<std::size_t>(i) + 1] - ramp[static_cast<std::size_t>(i)]);
}

void append_shape(Shape shape, const Vec3<float>& size, const Transform<float>& world,
                  const Vec3<float>& color, Geometry& out, const ConvexHull* hull) {
  const std::size_t first = out.indices.size();
  if (hull)
    append_hull(world, *hull, color, out);
  else if (shape == Shape::kBox)
    append_box(world, size, color, out);
  else
    append_capsule(world, size.x(), shape == Shape::kCapsule ? size.z() : 0, color, 0, out);
  out.close_draw(first, {.closed = true});
}

void append_character(const Asset& asset, const scene::CharacterFrame& frame, Look look, Geometry& out) {
  const bool mesh = !asset.meshes.empty() && look != Look::kShapes;
  if (asset.skeleton.colliders.empty()) {
    if (!mesh) append_sticks(asset.skeleton, frame, out);
  } else if (look == Look::kXray) {
    append_muscles(asset, frame, out);
  } else if (!mesh) {
    append_shapes(asset.skeleton, frame, out);
  }
  if (!mesh) return;
  const Palette palette(asset, frame);
  const bool shell = look == Look::kXray && !asset.skeleton.colliders.empty();
  for (const Mesh& m : asset.meshes) append_mesh(asset, m, palette, frame, shell, out);
}

}  // namespace sinew::render
