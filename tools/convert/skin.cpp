#include "convert/skin.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

namespace sinew::convert {
namespace {

using Matrix = Eigen::Matrix4d;

constexpr double kNoNormal = 1e-12;  ///< as long or shorter: none

/// Normals turn with the cofactor matrix, which also exists where the matrix cannot be inverted; a mirror
/// turns it round.
Eigen::Matrix3d normal_matrix(const Eigen::Matrix3d& a) {
  Eigen::Matrix3d cofactor;
  cofactor << a.col(1).cross(a.col(2)), a.col(2).cross(a.col(0)), a.col(0).cross(a.col(1));
  return a.determinant() < 0 ? Eigen::Matrix3d(-cofactor) : cofactor;
}

Eigen::Vector3d turned_normal(const Eigen::Matrix3d& a, const Eigen::Vector3d& normal) {
  const Eigen::Vector3d n = normal_matrix(a) * normal;
  return n.norm() > kNoNormal ? Eigen::Vector3d(n.normalized()) : Eigen::Vector3d(Eigen::Vector3d::UnitZ());
}

Eigen::Vector3d vector_of(const std::array<float, 3>& v) {
  return {double(v[0]), double(v[1]), double(v[2])};
}

/// A target in model space at rest. `blend` [vertex]: source → model.
MorphTarget bake_morph(const import::SourceMesh& in, const import::SourceMesh::Morph& morph,
                       const std::vector<Eigen::Matrix3d>& blend) {
  constexpr float kLeast = 1e-5f;  // m
  std::vector<float> moves, tilts;
  for (std::size_t v = 0; v < in.positions.size(); ++v) {
    const Eigen::Vector3d move = blend[v] * vector_of(morph.moves[v]);
    for (int k = 0; k < 3; ++k) moves.push_back(static_cast<float>(move[k]));
    if (morph.tilts.empty() || in.normals.empty()) continue;
    // Beside a normal of length 1, so that their sum has the right direction at any weight.
    const Eigen::Matrix3d turn = normal_matrix(blend[v]);
    const double length = (turn * vector_of(in.normals[v])).norm();
    const Eigen::Vector3d tilt = turn * vector_of(morph.tilts[v]) / std::max(length, kNoNormal);
    for (int k = 0; k < 3; ++k) tilts.push_back(length > kNoNormal ? static_cast<float>(tilt[k]) : 0);
  }
  MorphTarget target;
  if (!build_morph_target(moves, tilts, kLeast, target)) return {};  // not finite: it cannot be shown
  return target;
}

}  // namespace

std::string morph_curve(const import::SourceMesh& mesh, std::size_t morph) {
  const std::string& name = mesh.morphs[morph].name;
  return name.empty() ? mesh.name + " " + std::to_string(morph) : name;
}

bool bake_mesh(const import::SourceMesh& in, const import::SourceScene& scene,
               const std::vector<Matrix>& world, const Matrix& to_model,
               const std::map<int, int>& joint_of_node, nlohmann::json& report, BakedMesh& out) {
  // What carries vertices without weights: the nearest joint above the mesh's node.
  int carrier = in.node;
  while (carrier >= 0 && !joint_of_node.count(carrier)) carrier = scene.nodes[carrier].parent;
  if (carrier < 0 && in.bones.empty()) {
    report["notes"].push_back("mesh '" + in.name + "' hangs on no joint; left out");
    return false;
  }
  const int carrier_joint = carrier >= 0 ? joint_of_node.at(carrier) : 0;
  Mesh mesh;
  mesh.name = in.name;
  mesh.material = in.material;
  mesh.indices = in.indices;
  for (const auto& uv : in.uvs) mesh.uvs.insert(mesh.uvs.end(), {uv[0], uv[1]});
  const std::size_t vertices = in.positions.size();
  std::vector<std::vector<std::pair<float, int>>> influences(vertices);  // weight, index into in.bones
  for (std::size_t b = 0; b < in.bones.size(); ++b)
    for (const auto& [v, w] : in.bones[b].weights)
      if (w > 0 && joint_of_node.count(in.bones[b].node)) influences[v].push_back({w, static_cast<int>(b)});
  int repaired = 0, unweighted = 0, reduced = 0;
  std::vector<Eigen::Matrix3d> to_rest;  // [vertex]
  const Matrix mesh_world = in.node >= 0 ? world[in.node] : Matrix(Matrix::Identity());
  for (std::size_t v = 0; v < vertices; ++v) {
    auto& list = influences[v];
    std::sort(list.begin(), list.end(), [](const auto& a, const auto& b) {
      return a.first > b.first || (a.first == b.first && a.second < b.second);
    });
    if (list.size() > 4) {
      list.resize(4);
      ++reduced;
    }
    float sum = 0;
    for (const auto& [w, b] : list) sum += w;
    if (list.empty() && !in.bones.empty()) ++unweighted;
    if (!list.empty() && std::abs(sum - 1) > 0.01f) ++repaired;
    Matrix blend = Matrix::Zero();
    for (auto& [w, b] : list) {
      w /= sum;
      blend += double(w) * world[in.bones[b].node] * in.bones[b].inverse_bind;
    }
    if (list.empty()) blend = mesh_world;
    blend = to_model * blend;
    to_rest.emplace_back(blend.block<3, 3>(0, 0));
    const Eigen::Vector3d p(in.positions[v][0], in.positions[v][1], in.positions[v][2]);
    const Eigen::Vector3d at = blend.block<3, 3>(0, 0) * p + blend.block<3, 1>(0, 3);
    Eigen::Vector3d n = Eigen::Vector3d::UnitZ();
    if (!in.normals.empty())
      n = turned_normal(blend.block<3, 3>(0, 0), {in.normals[v][0], in.normals[v][1], in.normals[v][2]});
    for (int k = 0; k < 3; ++k) mesh.positions.push_back(static_cast<float>(at[k]));
    for (int k = 0; k < 3; ++k)
      mesh.normals.push_back(n.allFinite() ? static_cast<float>(n[k]) : float(k == 2));
    for (std::size_t k = 0; k < 4; ++k) {
      const bool used = k < list.size();
      const int joint = used ? joint_of_node.at(in.bones[list[k].second].node) : carrier_joint;
      const float w = used ? list[k].first : (k == 0 && list.empty() ? 1.f : 0.f);
      mesh.joints.push_back(static_cast<std::uint16_t>(joint));
      mesh.weights.push_back(w);
    }
  }
  const auto note = [&](int count, const char* what) {
    if (count > 0)
      report["notes"].push_back("mesh '" + in.name + "': " + std::to_string(count) + " vertices " + what);
  };
  note(repaired, "had weights that do not sum to 1; renormalised");
  note(unweighted, "had no weights; they follow the mesh's node");
  note(reduced, "had more than four influences; the four largest stay");
  if (mesh_world.block<3, 3>(0, 0).determinant() < 0 && in.bones.empty())
    for (std::size_t t = 0; t + 2 < mesh.indices.size(); t += 3)
      std::swap(mesh.indices[t + 1], mesh.indices[t + 2]);
  std::vector<std::string> names;
  for (std::size_t k = 0; k < in.morphs.size(); ++k) {
    MorphTarget target = bake_morph(in, in.morphs[k], to_rest);
    if (target.runs.empty()) continue;
    mesh.morphs.push_back(std::move(target));
    names.push_back(morph_curve(in, k));
  }
  out = {std::move(mesh), std::move(names)};
  return true;
}

std::vector<Material> materials_of(const import::SourceScene& scene) {
  std::vector<Material> all;
  for (const import::SourceMaterial& m : scene.materials) {
    Material material;
    material.name = m.name;
    std::copy(m.base_color.begin(), m.base_color.end(), material.base_color);
    material.texture = m.texture;
    all.push_back(std::move(material));
  }
  return all;
}

}  // namespace sinew::convert
