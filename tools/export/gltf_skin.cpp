#include "export/gltf_skin.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "render/shapes.h"

namespace sinew::exporting {
namespace {

using nlohmann::json;
using Use = GltfFile::Use;

json array_of(const Vec3<double>& v) {
  return {v.x(), v.y(), v.z()};
}

json array_of(const Quat<double>& q) {
  return {q.x(), q.y(), q.z(), q.w()};
}

Transform<double> turned() {
  return {to_y_up(), Vec3<double>::Zero()};
}

void add_joint_nodes(const Skeleton& skeleton, GltfFile& file) {
  const std::size_t first = file.document["nodes"].size();
  for (const Joint& joint : skeleton.joints) {
    const Transform<double> rest = joint.parent < 0 ? turned() * joint.rest : joint.rest;
    const int node = file.add("nodes", {{"name", joint.name},
                                        {"translation", array_of(rest.translation)},
                                        {"rotation", array_of(rest.rotation.normalized())}});
    if (joint.parent < 0)
      file.document["scenes"][0]["nodes"].push_back(node);
    else
      file.document["nodes"][first + static_cast<std::size_t>(joint.parent)]["children"].push_back(node);
  }
}

int add_skin(const GltfFigure& figure, int first_node, const std::vector<Transform<double>>& inverse_bind,
             GltfFile& file) {
  json joints = json::array();
  std::vector<float> matrices;
  for (std::size_t j = 0; j < inverse_bind.size(); ++j) {
    joints.push_back(first_node + static_cast<int>(j));
    const Transform<double> x = inverse_bind[j] * turned().inverse();
    const Mat3<double> r = x.rotation.normalized().toRotationMatrix();
    for (int column = 0; column < 3; ++column) {
      for (int row = 0; row < 3; ++row) matrices.push_back(static_cast<float>(r(row, column)));
      matrices.push_back(0);
    }
    for (int row = 0; row < 3; ++row) matrices.push_back(static_cast<float>(x.translation[row]));
    matrices.push_back(1);
  }
  const int accessor = file.add_numbers(matrices, "MAT4", Use::kOther);
  return file.add("skins", {{"name", figure.name}, {"joints", joints}, {"inverseBindMatrices", accessor}});
}

int add_material(const Material& m, GltfFile& file) {
  json surface = {{"baseColorFactor", m.base_color}, {"metallicFactor", 0}, {"roughnessFactor", 0.8}};
  for (json& c : surface["baseColorFactor"]) c = std::clamp(c.get<double>(), 0.0, 1.0);
  if (m.texture.size() > 4) {
    const bool png = m.texture[0] == 0x89;
    const int image = file.add("images", {{"bufferView", file.add_bytes(m.texture)},
                                          {"mimeType", png ? "image/png" : "image/jpeg"}});
    surface["baseColorTexture"]["index"] = file.add("textures", {{"source", image}});
  }
  json material = {{"name", m.name}, {"pbrMetallicRoughness", surface}};
  if (m.base_color[3] < 1) material["alphaMode"] = "BLEND";
  return file.add("materials", material);
}

/// (x, y, z) → (y, z, x), vertex by vertex.
std::vector<float> in_y_up(const std::vector<float>& of) {
  std::vector<float> out(of.size());
  for (std::size_t v = 0; v + 2 < of.size(); v += 3) {
    out[v] = of[v + 1];
    out[v + 1] = of[v + 2];
    out[v + 2] = of[v];
  }
  return out;
}

/// Influences as glTF wants them: each joint of a vertex once, joint 0 where there is no weight, sum 1.
void tidy_influences(std::vector<std::uint16_t>& joints, std::vector<float>& weights) {
  for (std::size_t v = 0; v + 3 < joints.size(); v += 4) {
    float sum = 0;
    for (std::size_t k = v; k < v + 4; ++k) {
      for (std::size_t before = v; before < k; ++before)
        if (joints[before] == joints[k] && weights[k] > 0) {
          weights[before] += weights[k];
          weights[k] = 0;
          break;
        }
      if (!(weights[k] > 0)) weights[k] = 0;
    }
    for (std::size_t k = v; k < v + 4; ++k) sum += weights[k];
    for (std::size_t k = v; k < v + 4; ++k) {
      weights[k] = sum > 0 ? weights[k] / sum : float(k == v);
      if (weights[k] == 0) joints[k] = 0;
    }
  }
}

/// A vertex normal of length 1, also where the source had none.
void tidy_normals(std::vector<float>& normals) {
  for (std::size_t v = 0; v + 2 < normals.size(); v += 3) {
    Vec3<float> n(normals[v], normals[v + 1], normals[v + 2]);
    n = n.norm() > 1e-6f ? Vec3<float>(n.normalized()) : Vec3<float>(Vec3<float>::UnitY());
    std::copy(n.data(), n.data() + 3, normals.data() + v);
  }
}

/// A morph target's attributes: sparse, with the vertices alone that it touches.
json add_target(const MorphTarget& target, std::size_t vertices, bool normals, GltfFile& file) {
  std::vector<std::uint32_t> touched;
  for (const MorphRun& run : target.runs)
    for (std::uint32_t k = 0; k < run.count; ++k) touched.push_back(run.first + k);
  const auto add = [&](const std::vector<std::int16_t>& units, float scale) {
    std::vector<float> deltas;
    for (const std::int16_t unit : units) deltas.push_back(scale * static_cast<float>(unit));
    return file.add_sparse(touched, in_y_up(deltas), vertices);
  };
  json attributes = {{"POSITION", add(target.moves, target.scale)}};
  if (normals && !target.tilts.empty()) attributes["NORMAL"] = add(target.tilts, target.tilt_scale);
  return attributes;
}

/// Its targets, their names as Blender and others write them, and their weights at rest.
void add_morphs(const Asset& asset, const Mesh& mesh, int in_file, GltfFile& file) {
  json targets = json::array(), names = json::array(), weights = json::array();
  for (std::size_t k = 0; k < mesh.morphs.size(); ++k) {
    const CurveSlot& curve = asset.curve_slots[static_cast<std::size_t>(mesh.morph_curves[k])];
    targets.push_back(add_target(mesh.morphs[k], mesh.positions.size() / 3, !mesh.normals.empty(), file));
    names.push_back(curve.name);
    weights.push_back(curve.rest);
  }
  json& out = file.document["meshes"][static_cast<std::size_t>(in_file)];
  out["primitives"][0]["targets"] = targets;
  out["weights"] = weights;
  out["extras"] = {{"targetNames", names}};
}

/// `material`: of the file, or -1.
int add_mesh(const Mesh& mesh, int material, bool textured, GltfFile& file) {
  json attributes = {{"POSITION", file.add_numbers(in_y_up(mesh.positions), "VEC3", Use::kVertices, true)}};
  if (!mesh.normals.empty()) {
    std::vector<float> normals = in_y_up(mesh.normals);
    tidy_normals(normals);
    attributes["NORMAL"] = file.add_numbers(normals, "VEC3", Use::kVertices);
  }
  if (!mesh.uvs.empty() && textured)
    attributes["TEXCOORD_0"] = file.add_numbers(mesh.uvs, "VEC2", Use::kVertices);
  if (!mesh.joints.empty()) {
    std::vector<std::uint16_t> joints = mesh.joints;
    std::vector<float> weights = mesh.weights;
    tidy_influences(joints, weights);
    attributes["JOINTS_0"] = file.add_joints(joints);
    attributes["WEIGHTS_0"] = file.add_numbers(weights, "VEC4", Use::kVertices);
  }
  json primitive = {{"attributes", attributes}, {"indices", file.add_triangles(mesh.indices)}};
  if (material >= 0) primitive["material"] = material;
  return file.add("meshes", {{"name", mesh.name}, {"primitives", {primitive}}});
}

/// Triangles of a shape, all of them on one joint.
void append_triangles(const render::Geometry& geometry, int joint, Mesh& mesh) {
  const auto first = static_cast<std::uint32_t>(mesh.positions.size() / 3);
  for (const render::Vertex& v : geometry.vertices) {
    mesh.positions.insert(mesh.positions.end(), v.position, v.position + 3);
    mesh.normals.insert(mesh.normals.end(), v.normal, v.normal + 3);
    mesh.joints.insert(mesh.joints.end(), {static_cast<std::uint16_t>(joint), 0, 0, 0});
    mesh.weights.insert(mesh.weights.end(), {1, 0, 0, 0});
  }
  const std::vector<std::uint32_t>& at = geometry.indices;
  const auto same_place = [&](std::uint32_t a, std::uint32_t b) {
    return std::equal(geometry.vertices[a].position, geometry.vertices[a].position + 3,
                      geometry.vertices[b].position);
  };
  for (std::size_t i = 0; i + 2 < at.size(); i += 3) {  // without the slivers at the poles of spheres
    if (same_place(at[i], at[i + 1]) || same_place(at[i + 1], at[i + 2]) || same_place(at[i], at[i + 2]))
      continue;
    mesh.indices.insert(mesh.indices.end(), {first + at[i], first + at[i + 1], first + at[i + 2]});
  }
}

int clay(GltfFile& file) {
  const Vec3<float> c = render::kClay;
  return file.add(
      "materials",
      {{"name", "shapes"},
       {"pbrMetallicRoughness",
        {{"baseColorFactor", {c.x(), c.y(), c.z(), 1}}, {"metallicFactor", 0}, {"roughnessFactor", 0.8}}}});
}

/// The physical body's shapes where they are at rest, or sticks from joint to joint.
Mesh shapes_of(const Skeleton& skeleton) {
  const std::vector<Transform<double>> rest = rest_pose(skeleton);
  Mesh mesh;
  mesh.name = "shapes";
  for (const Collider& c : skeleton.colliders) {
    render::Geometry geometry;
    const Transform<double> at = rest[static_cast<std::size_t>(c.joint)] * c.local;
    render::append_shape(c.shape, c.size.cast<float>(), at.cast<float>(), render::kClay, geometry, c.hull);
    append_triangles(geometry, c.joint, mesh);
  }
  for (std::size_t j = 0; j < rest.size() && skeleton.colliders.empty(); ++j) {
    const int parent = skeleton.joints[j].parent;
    if (parent < 0) continue;
    const Vec3<float> a = rest[static_cast<std::size_t>(parent)].translation.cast<float>(),
                      b = rest[j].translation.cast<float>();
    const float length = (b - a).norm();
    if (length < 1e-3f) continue;
    render::Geometry geometry;
    render::append_capsule(render::between(a, b), 0.08f * length, 0.42f * length, render::kBone, 0, geometry);
    append_triangles(geometry, parent, mesh);
  }
  return mesh;
}

int add_mesh_node(const std::string& name, int mesh, int skin, GltfFile& file) {
  json node = {{"name", name}, {"mesh", mesh}};
  if (skin >= 0) node["skin"] = skin;
  const int index = file.add("nodes", node);
  file.document["scenes"][0]["nodes"].push_back(index);
  return index;
}

}  // namespace

FigureNodes add_figure(const GltfFigure& figure, Surface surface, GltfFile& file) {
  const Asset& asset = *figure.asset;
  const int first_node = static_cast<int>(file.document["nodes"].size());
  FigureNodes out{first_node, {}};
  add_joint_nodes(asset.skeleton, file);
  const bool shapes = surface == Surface::kShapes || (surface == Surface::kSkin && asset.meshes.empty());
  std::vector<Transform<double>> inverse_bind;
  if (shapes || asset.inverse_bind.empty())
    for (const Transform<double>& x : rest_pose(asset.skeleton)) inverse_bind.push_back(x.inverse());
  else
    for (const Transform<float>& x : asset.inverse_bind) inverse_bind.push_back(x.cast<double>());
  const int skin = add_skin(figure, first_node, inverse_bind, file);
  if (shapes) {
    const Mesh mesh = shapes_of(asset.skeleton);
    if (!mesh.indices.empty())
      add_mesh_node(figure.name + "_shapes", add_mesh(mesh, clay(file), false, file), skin, file);
  } else if (surface == Surface::kSkin) {
    std::map<int, int> materials;  // of the file, by those of the asset that meshes use
    for (const Mesh& mesh : asset.meshes) {
      if (mesh.indices.empty()) continue;
      const Material* own =
          mesh.material >= 0 ? &asset.materials[static_cast<std::size_t>(mesh.material)] : nullptr;
      if (own && !materials.count(mesh.material)) materials[mesh.material] = add_material(*own, file);
      const int material = own ? materials[mesh.material] : -1;
      const int added = add_mesh(mesh, material, own && !own->texture.empty(), file);
      const int node = add_mesh_node(mesh.name, added, mesh.joints.empty() ? -1 : skin, file);
      if (mesh.morphs.empty()) continue;
      add_morphs(asset, mesh, added, file);
      out.morphing.push_back({node, &mesh});
    }
  }
  return out;
}

int add_solid(const scene::Prop& prop, GltfFile& file) {
  Mesh mesh;
  mesh.name = prop.name;
  render::Geometry geometry;
  render::append_shape(prop.shape, prop.size, Transform<float>{}, render::kClay, geometry, prop.hull);
  append_triangles(geometry, 0, mesh);
  mesh.joints.clear();
  mesh.weights.clear();
  add_mesh_node(prop.name, add_mesh(mesh, clay(file), false, file), -1, file);
  return static_cast<int>(file.document["nodes"].size()) - 1;
}

}  // namespace sinew::exporting
