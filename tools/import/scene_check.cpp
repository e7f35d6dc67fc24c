#include "import/scene_check.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <string_view>

namespace sinew::import {
namespace {

template <class... T>
bool finite(T... values) {
  return (std::isfinite(values) && ...);
}

bool finite(const Transform<double>& x) {
  return x.translation.allFinite() && x.rotation.coeffs().allFinite();
}

template <std::size_t N>
bool all_finite(const std::vector<std::array<float, N>>& list) {
  return std::all_of(list.begin(), list.end(), [](const std::array<float, N>& v) {
    return std::all_of(v.begin(), v.end(), [](float x) { return std::isfinite(x); });
  });
}

bool all_finite(const std::vector<Eigen::Vector3d>& list) {
  return std::all_of(list.begin(), list.end(), [](const Eigen::Vector3d& v) { return v.allFinite(); });
}

bool in_range(int index, std::size_t count) {
  return index >= 0 && static_cast<std::size_t>(index) < count;
}

bool none_or_in_range(int index, std::size_t count) {
  return index == -1 || in_range(index, count);
}

std::string fault_in_nodes(const SourceScene& s) {
  std::set<std::string_view> names;
  for (std::size_t i = 0; i < s.nodes.size(); ++i) {
    const SourceNode& n = s.nodes[i];
    if (!none_or_in_range(n.parent, i)) return "node '" + n.name + "' comes before its parent";
    if (!names.insert(n.name).second) return "two nodes are named '" + n.name + "'";
    if (!n.local.allFinite()) return "node '" + n.name + "' has a transform that is not finite";
  }
  return {};
}

std::string fault_in_mesh(const SourceScene& s, const SourceMesh& m) {
  const std::size_t vertices = m.positions.size();
  if (!in_range(m.node, s.nodes.size())) return "hangs on a node that does not exist";
  if (!none_or_in_range(m.material, s.materials.size())) return "has no such material";
  if ((!m.normals.empty() && m.normals.size() != vertices) || (!m.uvs.empty() && m.uvs.size() != vertices))
    return "has arrays of different length";
  if (!all_finite(m.positions)) return "has a vertex that is not finite";
  if (!all_finite(m.normals)) return "has a normal that is not finite";
  if (!all_finite(m.uvs)) return "has a texture coordinate that is not finite";
  if (m.indices.size() % 3 != 0) return "is not made of triangles";
  if (std::any_of(m.indices.begin(), m.indices.end(), [&](std::uint32_t i) { return i >= vertices; }))
    return "has an index out of range";
  for (const SourceMesh::Morph& morph : m.morphs) {
    if (morph.moves.size() != vertices || (!morph.tilts.empty() && morph.tilts.size() != vertices))
      return "has a morph target of another number of vertices";
    if (!all_finite(morph.moves) || !all_finite(morph.tilts) || !std::isfinite(morph.weight))
      return "has a morph target '" + morph.name + "' that is not finite";
  }
  for (const SourceMesh::Bone& b : m.bones) {
    if (!in_range(b.node, s.nodes.size())) return "has a bone that is no node";
    if (!b.inverse_bind.allFinite()) return "has a bind matrix that is not finite";
    for (const auto& [vertex, weight] : b.weights)
      if (vertex >= vertices || !std::isfinite(weight)) return "has a bad weight";
  }
  return {};
}

std::string fault_in_times(const std::vector<double>& times, std::size_t keys) {
  if (times.size() != keys) return "keys and times differ in number";
  for (std::size_t k = 0; k < keys; ++k) {
    if (!std::isfinite(times[k])) return "a key time is not finite";
    if (k > 0 && times[k] <= times[k - 1]) return "key times do not rise";
  }
  return {};
}

std::string fault_in_channel(const SourceChannel& c) {
  for (const std::string& fault :
       {fault_in_times(c.position_times, c.positions.size()),
        fault_in_times(c.rotation_times, c.rotations.size()), fault_in_times(c.scale_times, c.scales.size())})
    if (!fault.empty()) return fault;
  if (!all_finite(c.positions)) return "a position key is not finite";
  if (!all_finite(c.scales)) return "a scale key is not finite";
  for (const Eigen::Quaterniond& q : c.rotations)
    if (!q.coeffs().allFinite() || q.norm() < 1e-6) return "a rotation key is not a rotation";
  return {};
}

std::string fault_in_morphs(const SourceScene& s, const SourceMorphChannel& c) {
  if (!in_range(c.mesh, s.meshes.size())) return "moves a mesh that does not exist";
  const SourceMesh& mesh = s.meshes[std::size_t(c.mesh)];
  if (c.weights.size() != c.times.size() * mesh.morphs.size())
    return "mesh '" + mesh.name + "': weights and morph targets differ in number";
  if (!std::all_of(c.weights.begin(), c.weights.end(), [](float w) { return std::isfinite(w); }))
    return "mesh '" + mesh.name + "': a weight is not finite";
  const std::string fault = fault_in_times(c.times, c.times.size());
  return fault.empty() ? fault : "mesh '" + mesh.name + "': " + fault;
}

std::string fault_in_clip(const SourceScene& s, const SourceClip& clip) {
  if (!finite(clip.duration, clip.key_rate, clip.begin) || clip.duration < 0 || clip.key_rate < 0)
    return "has no meaningful duration";
  for (const SourceChannel& c : clip.channels) {
    if (!in_range(c.node, s.nodes.size())) return "moves a node that does not exist";
    const std::string fault = fault_in_channel(c);
    if (!fault.empty()) return "node '" + s.nodes[c.node].name + "': " + fault;
  }
  for (const SourceMorphChannel& c : clip.morphs)
    if (const std::string fault = fault_in_morphs(s, c); !fault.empty()) return fault;
  return {};
}

std::string fault_in_link(const SourceUrdfLink& l) {
  const std::string joint = "joint '" + l.joint_name + "' ";
  if (!finite(l.origin) || !l.axis.allFinite()) return joint + "has a place or axis that is not finite";
  if (!finite(l.lower, l.upper, l.effort, l.velocity)) return joint + "has a limit that is not finite";
  if (!finite(l.damping, l.friction, l.mimic_multiplier, l.mimic_offset))
    return joint + "has a damping, friction or mimic factor that is not finite";
  const std::string link = "link '" + l.name + "' ";
  if (!finite(l.mass) || !l.inertia.allFinite() || !finite(l.inertial_origin))
    return link + "has an inertial that is not finite";
  if (l.mass < 0) return link + "has a negative mass";
  for (const SourceUrdfLink::Geometry& g : l.shapes)
    if (!finite(g.origin) || !g.size.allFinite() || g.size.minCoeff() < 0)
      return link + "has a shape without a proper size";
  for (const SourceUrdfLink::MeshReference& m : l.meshes)
    if (!finite(m.origin) || !m.scale.allFinite() || !all_finite<4>({m.color}))
      return link + "has a mesh with a place, scale or colour that is not finite";
  return {};
}

}  // namespace

std::string fault_in(const SourceScene& s) {
  if (!finite(s.meters_per_unit) || s.meters_per_unit < 0) return "its unit of length is not a length";
  if (s.up_axis < -1 || s.up_axis > 2) return "its up axis is no axis";
  std::string fault = fault_in_nodes(s);
  if (!fault.empty()) return fault;
  for (const SourceMaterial& m : s.materials)
    if (!all_finite<4>({m.base_color})) return "material '" + m.name + "' has a colour that is not finite";
  for (const SourceMesh& m : s.meshes)
    if (!(fault = fault_in_mesh(s, m)).empty()) return "mesh '" + m.name + "' " + fault;
  for (const SourceClip& clip : s.clips)
    if (!(fault = fault_in_clip(s, clip)).empty()) return "clip '" + clip.name + "' " + fault;
  for (std::size_t i = 0; i < s.links.size(); ++i) {
    if (!none_or_in_range(s.links[i].parent, i))
      return "link '" + s.links[i].name + "' comes before its parent";
    if (!(fault = fault_in_link(s.links[i])).empty()) return fault;
  }
  return {};
}

}  // namespace sinew::import
