#include "convert/rig.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <map>
#include <numbers>
#include <numeric>
#include <optional>
#include <set>

#include "convert/clip_sampling.h"
#include "convert/roles.h"
#include "convert/skin.h"

namespace sinew::convert {
namespace {

using import::SourceChannel;
using import::SourceClip;
using import::SourceScene;
using Matrix = Eigen::Matrix4d;

constexpr double kForeign = std::numbers::pi / 6;  ///< rad, between the directions of one bone in two files
constexpr double kShortBone = 0.02;                ///< of the height: shorter ones say nothing
constexpr double kCmu = 0.056444;                  ///< m, unit of the CMU motion library, by its own notes

/// Source axes and unit → Sinew: metres, Z up, X forward for Y-up sources that face +Z, and those that face
/// elsewhere `turned` about the vertical, rad.
Matrix basis(int up, double unit, double turned = 0) {
  Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();
  if (up == 1) turn << 0, 0, 1, 1, 0, 0, 0, 1, 0;
  if (up == 0) turn << 0, 1, 0, 0, 0, 1, 1, 0, 0;
  Matrix m = Matrix::Identity();
  m.block<3, 3>(0, 0) = unit * Eigen::AngleAxisd(turned, Eigen::Vector3d::UnitZ()).toRotationMatrix() * turn;
  return m;
}

/// Where the model faces by its joints at rest, as far as their names tell: from ankles to toes, else where
/// right and left are; level, zero where neither is known. `to_model`: as basis() has it. `how` says which.
Eigen::Vector3d facing_of(const SourceScene& scene, const std::vector<int>& nodes,
                          const std::vector<Matrix>& world, const Matrix& to_model, const char*& how) {
  constexpr std::array<std::pair<Role, Role>, 5> kSides{{{Role::kThighL, Role::kThighR},
                                                         {Role::kShinL, Role::kShinR},
                                                         {Role::kFootL, Role::kFootR},
                                                         {Role::kUpperArmL, Role::kUpperArmR},
                                                         {Role::kHandL, Role::kHandR}}};
  std::map<Role, Eigen::Vector3d> place;
  for (const int n : nodes)
    if (const Role role = role_of_name(scene.nodes[n].name); role != Role::kNone)
      place.emplace(role, (to_model * world[n]).block<3, 1>(0, 3));
  const auto between = [&](Role from, Role to) {
    const bool known = place.count(from) && place.count(to);
    Eigen::Vector3d way = known ? Eigen::Vector3d(place.at(to) - place.at(from)) : Eigen::Vector3d::Zero();
    way.z() = 0;
    return way;
  };
  const Eigen::Vector3d toes = between(Role::kFootL, Role::kToesL) + between(Role::kFootR, Role::kToesR);
  how = "its toes";
  if (toes.norm() > 0) return toes.normalized();
  Eigen::Vector3d left = Eigen::Vector3d::Zero();
  for (const auto& [l, r] : kSides) left += between(r, l);
  how = "its left and right";
  return left.norm() > 0 ? Eigen::Vector3d(left.cross(Eigen::Vector3d::UnitZ()).normalized()) : left;
}

/// Turn about the vertical, rad, that makes a model face x: by the option, else whole quarters by what its
/// skin's joints tell, since what is less is how it was posed.
double turn_to_x(const SourceScene& scene, const std::vector<int>& nodes, const std::vector<Matrix>& world,
                 const Matrix& to_model, const Options& options, nlohmann::json& report) {
  constexpr double kQuarter = std::numbers::pi / 2;
  const char* how = "option";
  Eigen::Vector3d facing = Eigen::Vector3d::Zero();
  if (!options.facing.empty()) {
    const int axis = options.facing.back() - 'x';
    facing = to_model.block<3, 1>(0, axis) * (options.facing.front() == '-' ? -1 : 1);
  } else if (!scene.meshes.empty()) {
    facing = facing_of(scene, nodes, world, to_model, how);
  }
  facing.z() = 0;
  if (!(facing.norm() > 0)) return 0;
  const double turn = -kQuarter * std::round(std::atan2(facing.y(), facing.x()) / kQuarter);
  report["facing"] = {{"turned_degrees", turn * 180 / std::numbers::pi}, {"from", how}};
  if (turn != 0)
    report["notes"].push_back("turned by " + std::to_string(std::lround(turn * 180 / std::numbers::pi)) +
                              " degrees about the vertical to face x, by " + how + " (--facing)");
  return turn;
}

std::string plain_name(const std::string& name) {
  const auto cut = name.find_last_of(":|");
  return cut == std::string::npos ? name : name.substr(cut + 1);
}

/// Bones, what lies between them, and their lowest common ancestor as the root.
std::vector<int> joint_nodes(const SourceScene& scene) {
  const int count = static_cast<int>(scene.nodes.size());
  std::vector<int> below(count, 0);  // bones in the subtree
  int bones = 0;
  for (int i = count - 1; i >= 0; --i) {
    if (scene.nodes[i].is_bone) {
      ++below[i];
      ++bones;
    }
    if (scene.nodes[i].parent >= 0) below[scene.nodes[i].parent] += below[i];
  }
  if (bones == 0) return {};
  int root = 0;
  for (int i = 0; i < count; ++i)
    if (below[i] == bones)
      root = i;  // nodes come parents first: the last one that holds all bones is the lowest
  for (int i = root; i >= 0; i = scene.nodes[i].parent)
    if (scene.nodes[i].is_bone) root = i;
  std::vector<int> nodes;
  std::vector<std::uint8_t> inside(count, 0);
  for (int i = root; i < count; ++i) {
    inside[i] = i == root || (scene.nodes[i].parent >= 0 && inside[scene.nodes[i].parent]);
    if (inside[i] && below[i] > 0) nodes.push_back(i);
  }
  return nodes;
}

double extent(const std::vector<Matrix>& world, const std::vector<int>& nodes, int axis) {
  double low = 1e300, high = -1e300;
  for (const int n : nodes) {
    low = std::min(low, world[n](axis, 3));
    high = std::max(high, world[n](axis, 3));
  }
  return high - low;
}

/// How far a node travels in its parent over all clips, in units: along the axis on which it travels most.
double travel(const SourceScene& scene, int node) {
  Eigen::Vector3d low = Eigen::Vector3d::Constant(1e300), high = -low;
  for (const SourceClip& clip : scene.clips)
    for (const SourceChannel& channel : clip.channels)
      for (const Eigen::Vector3d& at : channel.positions) {
        if (channel.node != node) continue;
        low = low.cwiseMin(at);
        high = high.cwiseMax(at);
      }
  return std::max(0.0, (high - low).maxCoeff());
}

/// Leaves out roots that only carry the figure about, as motion capture in FBX has them: without a skin, no
/// body part by name, over a single joint that travels farther in them than the figure is large.
void drop_carriers(const SourceScene& scene, std::vector<int>& nodes, nlohmann::json& report) {
  if (!scene.meshes.empty()) return;
  const SourceClip* first = scene.clips.empty() ? nullptr : &scene.clips.front();
  const std::vector<Matrix> world = node_transforms(scene, first, 0);
  while (nodes.size() > 1 && role_of_name(scene.nodes[nodes[0]].name) == Role::kNone) {
    const auto on_root = [&](int n) { return scene.nodes[n].parent == nodes[0]; };
    const std::vector<int> others(nodes.begin() + 1, nodes.end());
    double size = 0;
    for (int axis = 0; axis < 3; ++axis) size = std::max(size, extent(world, others, axis));
    const Eigen::Matrix3d scale = world[nodes[0]].block<3, 3>(0, 0);
    if (std::count_if(others.begin(), others.end(), on_root) != 1 || !on_root(others[0]) ||
        travel(scene, others[0]) * scale.col(0).norm() <= size)
      return;
    report["notes"].push_back("'" + scene.nodes[nodes[0]].name + "' only carries the figure about; left out");
    nodes = others;
  }
}

/// Metres per unit that make sense of a height (and a widest extent) in units; `stated`: what the file says,
/// or 0. `how` says where it comes from.
double choose_scale(double stated, double height, double widest, const char*& how) {
  // A character is larger than a mouse and smaller than a house.
  if (stated > 0 && (height < 1e-9 || (widest * stated > 0.05 && widest * stated < 10))) {
    how = "file";
    return stated;
  }
  how = stated > 0 ? "guessed from the first frame's height: the file's makes no sense"
                   : "guessed from the first frame's height";
  if (height < 1e-9) return 1;
  const auto is_person = [&](double unit) { return height * unit > 1.35 && height * unit < 2.1; };
  if (stated >
      0) {  // wrong by what exporters forget: CMU's unit, centimetres or millimetres for metres, or back
    if (is_person(stated * kCmu)) return stated * kCmu;
    for (const double forgotten : {0.01, 0.001, 100.0, 1000.0})
      if (height * stated * forgotten > 0.2 && height * stated * forgotten < 3) return stated * forgotten;
  } else {
    for (const double unit : {1.0, 0.01, 0.0254, kCmu, 0.1, 0.001})
      if (is_person(unit)) return unit;
  }
  return 1.7 / height;
}

void choose_unit(const SourceScene& scene, const std::vector<int>& joints, const Options& options,
                 bool skinned, Rig& rig, nlohmann::json& report) {
  const SourceClip* first = scene.clips.empty() ? nullptr : &scene.clips.front();
  const std::vector<Matrix> world = node_transforms(scene, skinned ? nullptr : first, 0);
  std::vector<int> nodes = joints;
  if (scene.format == "bvh") {  // whose end sites are the top of the head and the tips of the toes
    nodes.resize(scene.nodes.size());
    std::iota(nodes.begin(), nodes.end(), 0);
  }
  const char* how = "option";
  rig.up = options.up == "x" ? 0 : (options.up == "y" ? 1 : (options.up == "z" ? 2 : scene.up_axis));
  if (options.up.empty()) how = "file";
  if (rig.up < 0) {
    rig.up = extent(world, nodes, 2) > extent(world, nodes, 1) ? 2 : 1;
    how = "guessed from the first frame";
  }
  report["up"] = {{"axis", std::string(1, "xyz"[rig.up])}, {"from", how}};
  const double raw = extent(world, nodes, rig.up);
  const double widest =
      std::max({raw, extent(world, nodes, 0), extent(world, nodes, 1), extent(world, nodes, 2)});
  how = "option";
  rig.unit = options.unit > 0 ? options.unit : choose_scale(scene.meters_per_unit, raw, widest, how);
  rig.height = raw * rig.unit;
  report["unit"] = {{"meters_per_unit", rig.unit}, {"from", how}};
  report["height_m"] = rig.height;
}

/// A character's reach, m: beyond it floats cannot hold millimetres.
constexpr double kFarthest = 1e4;

/// Where a mesh or motion leaves the space that floats can hold, if it does.
std::string fault_in_size(const Rig& rig) {
  const auto beyond = [](double x) { return !(std::abs(x) <= kFarthest); };
  const std::string where = " is more than 10 km from the origin; is the unit right?";
  for (const Rig::Joint& joint : rig.joints)
    if (beyond(joint.rest.translation.norm())) return "joint '" + joint.name + "'" + where;
  for (const std::vector<Mesh>* meshes : {&rig.meshes, &rig.body_meshes})
    for (const Mesh& mesh : *meshes)
      if (std::any_of(mesh.positions.begin(), mesh.positions.end(),
                      [&](float x) { return beyond(double(x)); }))
        return "mesh '" + mesh.name + "'" + where;
  for (const Rig::Motion& motion : rig.motions)
    for (const auto& frame : motion.samples)
      for (std::size_t j = 0; j < frame.size(); ++j)
        if (beyond(frame[j].translation.norm()))
          return "clip '" + motion.name + "': joint '" + rig.joints[j].name + "'" + where;
  return {};
}

/// Where bones of a file leave their joints in another direction than the rig's do, if they do by more than
/// kForeign: joints of the same names then mean other frames, and its clips would twist the character.
std::string foreign_skeleton(const Rig& rig, const SourceScene& from, const std::vector<int>& nodes,
                             const Matrix& to_model) {
  const std::vector<Matrix> world = node_transforms(from, nullptr, 0);
  double furthest = kForeign;
  std::string fault;
  for (std::size_t j = 0; j < rig.joints.size(); ++j) {
    const int parent = rig.joints[j].parent;
    if (parent <= 0 || nodes[j] < 0 || nodes[static_cast<std::size_t>(parent)] < 0) continue;  // roots travel
    const Transform<double> above = rigid(to_model * world[nodes[static_cast<std::size_t>(parent)]]);
    const Vec3<double> theirs = above.inverse() * rigid(to_model * world[nodes[j]]).translation;
    const Vec3<double> ours =
        rig.joints[static_cast<std::size_t>(parent)].rest.inverse() * rig.joints[j].rest.translation;
    if (theirs.norm() < kShortBone * rig.height || ours.norm() < kShortBone * rig.height) continue;
    const double angle = std::acos(std::clamp(theirs.normalized().dot(ours.normalized()), -1.0, 1.0));
    if (angle <= furthest) continue;
    furthest = angle;
    fault = "'" + from.name + "' has clips for another skeleton: from '" +
            rig.joints[static_cast<std::size_t>(parent)].name + "' to '" + rig.joints[j].name +
            "' its bone goes " + std::to_string(std::lround(angle * 180 / std::numbers::pi)) +
            " degrees off this one's";
  }
  return fault;
}

/// [joint] the way from its parent, in units of the file; zero where one of both is not in it.
std::vector<Eigen::Vector3d> bones_of(const Rig& rig, const std::vector<Matrix>& world,
                                      const std::vector<int>& nodes) {
  std::vector<Eigen::Vector3d> bones(rig.joints.size(), Eigen::Vector3d::Zero());
  for (std::size_t j = 0; j < bones.size(); ++j)
    if (const int parent = rig.joints[j].parent; parent >= 0 && nodes[j] >= 0 && nodes[parent] >= 0)
      bones[j] = (world[nodes[j]] - world[nodes[parent]]).block<3, 1>(0, 3);
  return bones;
}

/// Metres per unit of a file whose bones are `theirs`, by the rig's, m, if any are in both: a usual unit
/// where one is near. Notes bones that differ.
std::optional<double> unit_by_bones(const Rig& rig, const SourceScene& from,
                                    const std::vector<Eigen::Vector3d>& ours,
                                    const std::vector<Eigen::Vector3d>& theirs, nlohmann::json& report) {
  constexpr double kNear = 1.25;  // characters of one skeleton differ by as much
  std::vector<double> ratios;
  for (std::size_t j = 0; j < ours.size(); ++j)
    if (theirs[j].norm() > 0 && ours[j].norm() > kShortBone * rig.height)
      ratios.push_back(ours[j].norm() / theirs[j].norm());
  if (ratios.empty()) return {};
  std::sort(ratios.begin(), ratios.end());
  const double low = ratios[ratios.size() / 4], high = ratios[ratios.size() - 1 - ratios.size() / 4];
  double unit = ratios[ratios.size() / 2];
  const double measured = unit;
  if (high > kNear * low) {
    char line[120];
    std::snprintf(line, sizeof line, "its bones do not agree on its unit: half of them say %.3g to %.3g m",
                  low, high);
    report["notes"].push_back("'" + from.name + "': " + line);
  }
  double nearest = std::log(kNear);
  for (const double usual : {rig.unit, from.meters_per_unit, 1.0, 0.01, 0.0254, kCmu, 0.1, 0.001})
    if (usual > 0 && std::abs(std::log(usual / measured)) < nearest) {
      nearest = std::abs(std::log(usual / measured));
      unit = usual;
    }
  return unit;
}

/// Up axis and turn about the vertical, by how alike bones become.
struct Axes {
  int up = 1;
  double turned = 0;  ///< rad
  double alike = -2;  ///< mean cosine between bones, by their lengths
};

/// Those of `ups` that bring bones `theirs` closest to the rig's, in model space. A file whose vertical is
/// the rig's also faces as it does; others may face any quarter.
Axes axes_by_bones(const Rig& rig, const std::vector<int>& ups, const std::vector<Eigen::Vector3d>& ours,
                   const std::vector<Eigen::Vector3d>& theirs) {
  constexpr double kBetter = 1e-3;  // the first of equals counts
  Axes best;
  for (const int up : ups)
    for (int quarter = 0; quarter < (up == rig.up ? 1 : 4); ++quarter) {
      Axes axes{up, rig.turned + quarter * std::numbers::pi / 2, 0};
      const Eigen::Matrix3d turn = basis(axes.up, 1, axes.turned).block<3, 3>(0, 0);
      double weight = 0;
      for (std::size_t j = 0; j < ours.size(); ++j) {
        axes.alike += ours[j].dot(turn * theirs[j]);
        weight += ours[j].norm() * theirs[j].norm();
      }
      axes.alike /= std::max(weight, 1e-300);
      if (axes.alike > best.alike + kBetter) best = axes;
    }
  return best;
}

/// What takes a file that adds clips to model space, by options, by what it says, and by its joints
/// (`nodes`, of each of the rig's) beside those of the rig's own file `scene`. Notes where that comes from.
Matrix place_clips(const Rig& rig, const SourceScene& scene, const SourceScene& from,
                   const std::vector<int>& nodes, const Options& options, nlohmann::json& report) {
  constexpr double kAlike = 0.7;  // 45 degrees: else the file's rest is no pose, as in many BVH
  std::vector<int> own;
  for (const Rig::Joint& joint : rig.joints) own.push_back(joint.node);
  const Matrix to_model = basis(rig.up, rig.unit, rig.turned);
  const auto our_bones = [&](std::vector<Matrix> world) {
    for (Matrix& m : world) m = to_model * m;
    return bones_of(rig, world, own);
  };
  const auto pose = [](const SourceScene& of, bool first) {
    return node_transforms(of, first && !of.clips.empty() ? &of.clips.front() : nullptr, 0);
  };
  const auto ours = our_bones(pose(scene, false)), theirs = bones_of(rig, pose(from, false), nodes);

  Rig other;
  nlohmann::json chosen;
  choose_unit(from, joint_nodes(from), options, !from.meshes.empty(), other, chosen);
  std::string unit_from = chosen["unit"]["from"], up_from = chosen["up"]["from"];
  if (options.unit <= 0)
    if (const std::optional<double> unit = unit_by_bones(rig, from, ours, theirs, report)) {
      other.unit = *unit;
      unit_from = "by its bones' lengths";
    }
  const bool up_known = !options.up.empty() || from.up_axis >= 0;
  const bool comparable =
      std::any_of(theirs.begin(), theirs.end(), [](const auto& b) { return b.norm() > 0; });
  std::vector<int> ups{other.up};
  if (!up_known && comparable) {
    ups = {rig.up, 1, 2};
    up_from = "by its bones at rest";
  }
  Axes axes = axes_by_bones(rig, ups, ours, theirs);
  if (axes.alike < kAlike && comparable && !(up_known && other.up == rig.up)) {
    const bool skinned = !scene.meshes.empty();  // else the first frame is the rig's rest
    axes = axes_by_bones(rig, ups, our_bones(pose(scene, !skinned)), bones_of(rig, pose(from, true), nodes));
    if (!up_known) up_from = "by its bones in the first frame";
  }
  char line[200];
  std::snprintf(line, sizeof line, "unit %.6g m (%s), up %c (%s)", other.unit, unit_from.c_str(),
                "xyz"[axes.up], up_from.c_str());
  report["notes"].push_back("'" + from.name + "': " + line);
  return basis(axes.up, other.unit, axes.turned);
}

/// By Unreal's name for it, of the mesh or of the node that carries it.
bool is_of_body(const import::SourceMesh& mesh, const SourceScene& scene) {
  const auto named = [](const std::string& name) { return name.compare(0, 4, "UCX_") == 0; };
  return named(mesh.name) || (mesh.node >= 0 && named(scene.nodes[std::size_t(mesh.node)].name));
}

}  // namespace

Error build_rig(const std::vector<SourceScene>& scenes, const Options& options, Rig& out,
                nlohmann::json& report) {
  report["notes"] = nlohmann::json::array();
  std::size_t main = scenes.size();
  for (std::size_t s = 0; s < scenes.size() && main == scenes.size(); ++s)
    if (!scenes[s].meshes.empty()) main = s;
  if (main == scenes.size()) main = 0;
  const SourceScene& scene = scenes[main];
  std::vector<int> nodes = joint_nodes(scene);
  if (nodes.empty()) return {"it has no joints: no skin, and no clip that moves a node"};
  drop_carriers(scene, nodes, report);

  Rig rig;
  const bool skinned = !scene.meshes.empty();
  choose_unit(scene, nodes, options, skinned, rig, report);
  const SourceClip* first = scene.clips.empty() ? nullptr : &scene.clips.front();
  const std::vector<Matrix> world = node_transforms(scene, skinned ? nullptr : first, 0);
  rig.turned = turn_to_x(scene, nodes, world, basis(rig.up, rig.unit), options, report);
  const Matrix to_model = basis(rig.up, rig.unit, rig.turned);
  std::map<int, int> joint_of_node;
  for (const int n : nodes) {
    Rig::Joint joint;
    joint.name = scene.nodes[n].name;
    joint.node = n;
    joint.parent = joint_of_node.count(scene.nodes[n].parent) ? joint_of_node.at(scene.nodes[n].parent) : -1;
    joint.rest = rigid(to_model * world[n]);
    joint.control = is_control_name(joint.name);
    joint_of_node[n] = static_cast<int>(rig.joints.size());
    rig.joints.push_back(joint);
  }
  rig.materials = materials_of(scene);
  for (const import::SourceMesh& source : scene.meshes) {
    BakedMesh baked;
    if (!bake_mesh(source, scene, world, to_model, joint_of_node, report, baked)) continue;
    if (is_of_body(source, scene)) {
      rig.body_meshes.push_back(std::move(baked.mesh));
      continue;
    }
    rig.meshes.push_back(std::move(baked.mesh));
    for (std::size_t k = 0; k < source.morphs.size(); ++k)
      if (const std::string name = morph_curve(source, k);
          std::count(baked.morph_names.begin(), baked.morph_names.end(), name) > 0)
        rig.morph_rest.emplace(name, double(source.morphs[k].weight));
    rig.morph_names.push_back(std::move(baked.morph_names));
  }
  for (const Mesh& mesh : rig.skin())
    for (std::size_t k = 0; k < mesh.joints.size(); ++k)
      rig.joints[mesh.joints[k]].skin_weight += double(mesh.weights[k]);
  for (const Mesh& mesh : rig.body_meshes)
    report["notes"].push_back("the body is fitted to mesh '" + mesh.name + "', which is not drawn");
  // From the sole to the crown, where there is a skin.
  float low = 1e9f, high = -1e9f;
  for (const Mesh& mesh : rig.skin())
    for (std::size_t v = 2; v < mesh.positions.size(); v += 3) {
      low = std::min(low, mesh.positions[v]);
      high = std::max(high, mesh.positions[v]);
    }
  rig.height = std::max(rig.height, double(high) - double(low));
  report["height_m"] = rig.height;

  std::set<std::string> taken;
  for (const SourceScene& from : scenes) {
    for (const std::string& note : from.notes) report["notes"].push_back(note);
    Matrix to = to_model;
    std::vector<int> of_joint(rig.joints.size(), -1);
    if (&from == &scene) {
      for (std::size_t j = 0; j < rig.joints.size(); ++j) of_joint[j] = rig.joints[j].node;
    } else {
      const std::vector<int> other_nodes = joint_nodes(from);
      if (other_nodes.empty() || from.format == "urdf")
        return {"'" + from.name + "' cannot be added: " +
                (from.format == "urdf" ? "a URDF takes no part in other characters"
                                       : "it has no joints: no skin, and no clip that moves a node")};
      std::map<std::string, int> by_name;
      for (const int n : other_nodes) by_name.emplace(plain_name(from.nodes[n].original_name), n);
      int matched = 0;
      std::string why;
      nlohmann::json placed;
      placed["notes"] = nlohmann::json::array();
      for (std::size_t j = 0; j < rig.joints.size(); ++j)
        if (const auto found = by_name.find(plain_name(rig.joints[j].name)); found != by_name.end()) {
          of_joint[j] = found->second;
          ++matched;
        }
      if (2 * matched < static_cast<int>(std::min(rig.joints.size(), by_name.size())))
        why = "'" + from.name + "' shares " + (matched == 0 ? "no" : "only " + std::to_string(matched)) +
              " joint name" + (matched > 1 ? "s" : "") + " with '" + scene.name + "'";
      else {
        to = place_clips(rig, scene, from, of_joint, options, placed);
        why = foreign_skeleton(rig, from, of_joint, to);
      }
      if (!why.empty()) {
        rig.foreign.push_back({static_cast<std::size_t>(&from - scenes.data()), why});
        continue;
      }
      report["notes"].push_back("'" + from.name + "': " + std::to_string(matched) + " of " +
                                std::to_string(rig.joints.size()) + " joints matched by name");
      for (const nlohmann::json& note : placed["notes"]) report["notes"].push_back(note);
    }
    for (const SourceClip& clip : from.clips) {
      if (!options.clips.empty() &&
          std::find(options.clips.begin(), options.clips.end(), clip.name) == options.clips.end())
        continue;
      Rig::Motion motion;
      if (Error fault = sample_clip(from, clip, of_joint, to, rig, options, motion, report)) return fault;
      while (!taken.insert(motion.name).second) motion.name += "_2";
      rig.motions.push_back(std::move(motion));
    }
  }
  for (const std::string& wanted : options.clips)
    if (!taken.count(wanted) && rig.foreign.empty()) return {"it has no clip '" + wanted + "'"};
  if (const std::string fault = fault_in_size(rig); !fault.empty()) return {fault};
  out = std::move(rig);
  return {};
}

}  // namespace sinew::convert
