#include "convert/urdf_skin.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <vector>

#include "convert/clip_sampling.h"
#include "convert/skin.h"

namespace sinew::convert {
namespace {

using import::SourceMesh;
using import::SourceUrdfLink;

std::array<float, 3> in_floats(const Vec3<double>& v) {
  return {static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z())};
}

void add_vertex(const Transform<double>& place, const Vec3<double>& p, const Vec3<double>& normal,
                SourceMesh& out) {
  out.positions.push_back(in_floats(place * p));
  out.normals.push_back(in_floats(place.rotation * normal));
}

void add_box(const SourceUrdfLink::Geometry& box, SourceMesh& out) {
  for (int axis = 0; axis < 3; ++axis)
    for (const double side : {-1.0, 1.0}) {
      const auto first = static_cast<std::uint32_t>(out.positions.size());
      const Vec3<double> normal = side * Vec3<double>::Unit(axis), u = Vec3<double>::Unit((axis + 1) % 3),
                         v = normal.cross(u);
      for (const auto& [a, b] : {std::pair(-1.0, -1.0), {1.0, -1.0}, {1.0, 1.0}, {-1.0, 1.0}})
        add_vertex(box.origin, (normal + a * u + b * v).cwiseProduct(box.size), normal, out);
      for (const std::uint32_t k : {0u, 1u, 2u, 0u, 2u, 3u}) out.indices.push_back(first + k);
    }
}

void add_capsule(const SourceUrdfLink::Geometry& capsule, SourceMesh& out) {
  constexpr std::uint32_t kAround = 24, kRings = 16;  // half of them in each cap
  const double radius = capsule.size.x(), half = capsule.shape == Shape::kSphere ? 0 : capsule.size.z();
  const auto first = static_cast<std::uint32_t>(out.positions.size());
  for (std::uint32_t ring = 0; ring < kRings; ++ring) {
    const bool upper = ring >= kRings / 2;
    const double angle = std::numbers::pi * (double(ring - (upper ? 1 : 0)) / (kRings - 2) - 0.5);
    for (std::uint32_t k = 0; k <= kAround; ++k) {
      const double turn = 2 * std::numbers::pi * k / kAround;
      const Vec3<double> normal(std::cos(angle) * std::cos(turn), std::cos(angle) * std::sin(turn),
                                std::sin(angle));
      add_vertex(capsule.origin, radius * normal + Vec3<double>(0, 0, upper ? half : -half), normal, out);
    }
  }
  for (std::uint32_t ring = 0; ring + 1 < kRings; ++ring)
    for (std::uint32_t k = 0; k < kAround; ++k) {
      const std::uint32_t a = first + ring * (kAround + 1) + k, b = a + kAround + 1;
      for (const std::uint32_t i : {a, a + 1, b + 1, a, b + 1, b}) out.indices.push_back(i);
    }
}

/// The visual primitives of a link, or where it has none what it collides with.
SourceMesh solids_of(const SourceUrdfLink& link, int node) {
  SourceMesh mesh;
  mesh.name = link.name;
  mesh.node = node;
  const auto is_visual = [](const SourceUrdfLink::Geometry& g) { return !g.collision; };
  const bool visual = std::any_of(link.shapes.begin(), link.shapes.end(), is_visual);
  for (const SourceUrdfLink::Geometry& g : link.shapes)
    if (is_visual(g) == visual) (g.shape == Shape::kBox ? add_box : add_capsule)(g, mesh);
  return mesh;
}

/// The link that a node belongs to: links come first.
int link_of(const import::SourceScene& scene, int node) {
  const int links = static_cast<int>(scene.links.size());
  while (node >= links) node = scene.nodes[static_cast<std::size_t>(node)].parent;
  return node;
}

}  // namespace

std::vector<std::vector<Vec3<double>>> link_vertices(const import::SourceScene& scene) {
  std::vector<std::vector<Vec3<double>>> vertices(scene.links.size());
  const std::vector<Eigen::Matrix4d> world = node_transforms(scene, nullptr, 0);
  for (const SourceMesh& mesh : scene.meshes) {
    const auto link = static_cast<std::size_t>(link_of(scene, mesh.node));
    const Eigen::Matrix4d to_link = world[link].inverse() * world[static_cast<std::size_t>(mesh.node)];
    for (const auto& p : mesh.positions)
      vertices[link].push_back(
          (to_link * Eigen::Vector4d(double(p[0]), double(p[1]), double(p[2]), 1)).head<3>());
  }
  return vertices;
}

void add_urdf_skin(const import::SourceScene& scene, nlohmann::json& report, Asset& asset) {
  if (scene.meshes.empty()) return;
  std::map<int, int> joint_of_node;
  for (int i = 0; i < static_cast<int>(scene.links.size()); ++i) joint_of_node[i] = i;
  const std::vector<Eigen::Matrix4d> world = node_transforms(scene, nullptr, 0);
  std::vector<SourceMesh> sources = scene.meshes;
  std::vector<bool> has_mesh(scene.links.size(), false);
  for (const SourceMesh& mesh : scene.meshes)
    has_mesh[static_cast<std::size_t>(link_of(scene, mesh.node))] = true;
  for (std::size_t i = 0; i < scene.links.size(); ++i)
    if (!has_mesh[i]) sources.push_back(solids_of(scene.links[i], static_cast<int>(i)));
  for (const SourceMesh& source : sources) {
    BakedMesh baked;
    if (source.indices.empty() ||
        !bake_mesh(source, scene, world, Eigen::Matrix4d::Identity(), joint_of_node, report, baked))
      continue;
    baked.mesh.morphs.clear();  // no clip of a URDF moves them
    asset.meshes.push_back(std::move(baked.mesh));
  }
  asset.materials = materials_of(scene);
  for (std::size_t i = 0; i < scene.links.size(); ++i) {
    const Transform<double> rest{Quat<double>(world[i].block<3, 3>(0, 0)).normalized(),
                                 world[i].block<3, 1>(0, 3)};
    asset.inverse_bind.push_back(rest.inverse().cast<float>());
  }
}

}  // namespace sinew::convert
