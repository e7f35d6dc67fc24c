#include "convert/rig.h"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <iterator>
#include <map>
#include <numbers>
#include <numeric>
#include <optional>
#include <set>

#include "convert/fit/chain_error.h"
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

template <class V>
V interpolate(const std::vector<double>& times, const std::vector<V>& keys, double t, const V& otherwise) {
  if (keys.empty()) return otherwise;
  const auto after = std::upper_bound(times.begin(), times.end(), t);
  if (after == times.begin()) return keys.front();
  if (after == times.end()) return keys.back();
  const std::size_t i = static_cast<std::size_t>(after - times.begin());
  const double span = times[i] - times[i - 1], u = span > 0 ? (t - times[i - 1]) / span : 0;
  if constexpr (std::is_same_v<V, Eigen::Quaterniond>) {
    return keys[i - 1].slerp(u, keys[i]);
  } else {
    return keys[i - 1] + u * (keys[i] - keys[i - 1]);
  }
}

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

/// Nearest rigid transform: columns normalised, shear and mirror taken out.
Transform<double> rigid(const Matrix& m) {
  Eigen::Matrix3d a = m.block<3, 3>(0, 0);
  if (a.determinant() < 0) a.col(0) = -a.col(0);
  for (int k = 0; k < 3; ++k)
    if (const double length = a.col(k).norm(); length > 1e-12)
      a.col(k) /= length;
    else
      a = Eigen::Matrix3d::Identity(), k = 3;
  a.col(1) = (a.col(1) - a.col(0).dot(a.col(1)) * a.col(0)).normalized();
  a.col(2) = a.col(0).cross(a.col(1));
  return {Eigen::Quaterniond(a).normalized(), m.block<3, 1>(0, 3)};
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

/// Joints other than the root whose distance to their parent changes by more than 1 mm over the motion, and
/// the largest change, m.
std::pair<int, double> stretch(const Rig::Motion& motion) {
  int count = 0;
  double largest = 0;
  for (std::size_t j = 1; j < motion.samples.front().size(); ++j) {
    double low = 1e300, high = 0;
    for (const auto& frame : motion.samples) {
      const double length = frame[j].translation.norm();
      low = std::min(low, length);
      high = std::max(high, length);
    }
    count += high - low > 1e-3;
    largest = std::max(largest, high - low);
  }
  return {count, largest};
}

/// Largest turn of a joint between two samples, rad.
double largest_turn(const std::vector<Transform<double>>& a, const std::vector<Transform<double>>& b) {
  double turn = 0;
  for (std::size_t j = 0; j < a.size(); ++j)
    turn = std::max(turn, a[j].rotation.angularDistance(b[j].rotation));
  return turn;
}

/// Whether a motion begins with a reference pose that is no part of it, as the CMU captures converted to BVH
/// do (a T-pose): it leaves faster than joints turn in any throw but a pitcher's, 40 rad/s, and ten times
/// as fast as it then goes on.
bool begins_with_reference_pose(const Rig::Motion& motion) {
  if (motion.samples.size() < 9) return false;
  const auto speed = [&](int f) {  // rad/s
    return largest_turn(motion.samples[f], motion.samples[f + 1]) / (motion.time(f + 1) - motion.time(f));
  };
  return speed(0) > 40 && speed(0) > 10 * speed(1);
}

constexpr double kMostSamples = 3e7;  ///< joints × frames of a clip: an hour of motion capture, 2 GB

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

constexpr double kClosest = 1.0 / 120;  ///< s between samples: no body moves so fast that it takes more
constexpr double kSameTime = 0.01;      ///< of a sample's time: 1 mm where 30 keys/s change speed by 3 m/s

double sampling_rate(const SourceClip& clip) {
  return std::clamp(clip.key_rate > 0 ? clip.key_rate : 30.0, 10.0, 1 / kClosest);
}

/// A key that moves nodes.
struct Key {
  double time = 0;  ///< s
  int tracks = 0;   ///< that have it
};

/// Keys in time; those at less than `merged` s count as one.
std::vector<Key> keys_of(const SourceClip& clip, double merged) {
  std::vector<double> all;
  for (const SourceChannel& c : clip.channels)
    for (const auto* times : {&c.position_times, &c.rotation_times, &c.scale_times})
      if (times->size() > 1) all.insert(all.end(), times->begin(), times->end());
  std::sort(all.begin(), all.end());
  std::vector<Key> keys;
  for (const double t : all)
    if (keys.empty() || t - keys.back().time > merged)
      keys.push_back({t, 1});
    else
      ++keys.back().tracks;
  return keys;
}

/// The keys of a clip that has some between even samples at `rate`, else none: those of most tracks first,
/// then the earlier.
std::vector<Key> uneven_keys(const SourceClip& clip, double rate) {
  constexpr double kMerged = 0.001;  // of a sample's time: numbers in files are no more exact
  if (!(clip.duration > 0)) return {};
  std::vector<Key> keys = keys_of(clip, kMerged / rate);
  const double even = std::round(clip.duration * rate) / clip.duration;  // ends with the clip
  if (std::all_of(keys.begin(), keys.end(), [&](const Key& k) {
        return std::abs(k.time * even - std::round(k.time * even)) <= kSameTime;
      }))
    return {};
  std::stable_sort(keys.begin(), keys.end(), [](const Key& x, const Key& y) { return x.tracks > y.tracks; });
  return keys;
}

/// Adds a time unless it is too close to another.
void add_time(double time, std::set<double>& times) {
  constexpr double kGap = (1 - kSameTime) * kClosest;
  const auto after = times.lower_bound(time);
  if ((after == times.end() || *after - time >= kGap) &&
      (after == times.begin() || time - *std::prev(after) >= kGap))
    times.insert(time);
}

/// The times, and between them instants about 1/rate apart.
std::vector<double> filled(const std::set<double>& times, double rate) {
  std::vector<double> out;
  for (const double time : times) {
    const double from = out.empty() ? 0 : out.back();
    const int parts = std::max(1, static_cast<int>(std::lround((time - from) * rate)));
    for (int k = 1; k < parts; ++k) out.push_back(from + k * (time - from) / parts);
    out.push_back(time);
  }
  return out;
}

/// The weights of morph targets, over the frames that are left. Those of one name move together: the first
/// mesh says how.
void add_morph_keys(const SourceScene& scene, const SourceClip& clip, Rig::Motion& motion,
                    nlohmann::json& report) {
  const double left_out = motion.begin - clip.begin;
  const double duration = motion.time(static_cast<int>(motion.samples.size()) - 1);
  for (const import::SourceMorphChannel& channel : clip.morphs) {
    const import::SourceMesh& mesh = scene.meshes[std::size_t(channel.mesh)];
    for (std::size_t m = 0; m < mesh.morphs.size(); ++m) {
      std::vector<std::pair<double, double>> keys;
      for (std::size_t k = 0; k < channel.times.size(); ++k) {
        const double time = std::clamp(channel.times[k] - left_out, 0.0, duration);
        if (!keys.empty() && time <= keys.back().first) keys.pop_back();
        keys.emplace_back(time, double(channel.weights[k * mesh.morphs.size() + m]));
      }
      const auto [known, is_new] = motion.morph_keys.emplace(morph_curve(mesh, m), keys);
      if (!is_new && known->second != keys)
        report["notes"].push_back("clip '" + clip.name + "': morph targets '" + known->first +
                                  "' of several meshes move apart; all move as the first does");
    }
  }
}

/// All joints at t, local; every joint's node is looked up in `nodes` (-1: not in this file, stays at rest).
std::vector<Transform<double>> pose_at(const SourceScene& scene, const SourceClip& clip, double t,
                                       const std::vector<int>& nodes, const Matrix& to_model,
                                       const Rig& rig) {
  const std::vector<Matrix> world = node_transforms(scene, &clip, t);
  std::vector<Transform<double>> model(rig.joints.size()), local(rig.joints.size());
  for (std::size_t j = 0; j < rig.joints.size(); ++j) {
    const int parent = rig.joints[j].parent;
    const Transform<double> rest_local =
        parent < 0 ? rig.joints[j].rest : rig.joints[parent].rest.inverse() * rig.joints[j].rest;
    model[j] = nodes[j] >= 0 ? rigid(to_model * world[nodes[j]])
                             : (parent < 0 ? rest_local : model[parent] * rest_local);
    local[j] = parent < 0 ? model[j] : model[parent].inverse() * model[j];
    local[j].rotation.normalize();
  }
  return local;
}

using Poses = std::vector<std::vector<Transform<double>>>;  ///< [time][joint]

/// How far lines between the samples of a motion pass by keys; `truth`: the poses at them.
ChainError passed_by(const Rig& rig, const Rig::Motion& motion, const std::vector<Key>& keys,
                     const Poses& truth, double skin_distance) {
  std::vector<int> parents;
  for (const Rig::Joint& joint : rig.joints) parents.push_back(joint.parent);
  ChainError chain(truth, parents, skin_distance);
  std::vector<double> times;
  for (std::size_t f = 0; f < motion.samples.size(); ++f) times.push_back(motion.time(static_cast<int>(f)));
  std::vector<JointMotion> lines(rig.joints.size());
  for (const Key& key : keys) {
    const auto later = std::lower_bound(times.begin() + 1, times.end() - 1, key.time);
    const std::size_t next = static_cast<std::size_t>(later - times.begin());
    const double u = (key.time - times[next - 1]) / (times[next] - times[next - 1]);
    for (std::size_t j = 0; j < lines.size(); ++j) {
      const Transform<double>&a = motion.samples[next - 1][j], &b = motion.samples[next][j];
      lines[j].push_back(
          {a.rotation.slerp(u, b.rotation), a.translation + u * (b.translation - a.translation)});
    }
  }
  for (std::size_t j = 0; j < lines.size(); ++j) chain.set(static_cast<int>(j), std::move(lines[j]));
  chain.update();
  return chain;
}

/// Joint of the largest error at a key.
int worst_joint(const ChainError& chain, int key) {
  int worst = 0;
  for (int j = 1; j < chain.joints(); ++j)
    if (chain.error(j, key) > chain.error(worst, key)) worst = j;
  return worst;
}

/// Samples a motion evenly and, where that passes by `keys` farther than half of the error that is allowed,
/// at the keys that most tracks have and at those that are still passed by. Notes keys that are all the same.
template <class Pose>
void take_samples(const Rig& rig, const SourceClip& clip, const std::vector<Key>& keys, const Pose& pose,
                  const Options& options, Rig::Motion& motion, nlohmann::json& report) {
  constexpr double kShare = 0.5;  // the fit comes on top
  constexpr double kFill = 60;    // 1/s, between keys that are far apart: the curve is to go straight there
  constexpr int kRounds = 8;      // each takes a large part of what is left
  const double stated = motion.sample_rate;
  const int frames = std::max(1, static_cast<int>(std::lround(clip.duration * stated)) + 1);
  if (frames > 1) motion.sample_rate = (frames - 1) / clip.duration;
  for (int f = 0; f < frames; ++f) motion.samples.push_back(pose(motion.time(f)));
  if (keys.empty()) return;
  Poses truth;
  for (const Key& key : keys) truth.push_back(pose(key.time));
  const auto errors = [&] { return passed_by(rig, motion, keys, truth, options.fit_distance_cm / 100); };
  ChainError chain = errors();
  std::set<double> times{0, clip.duration};
  const double even_error = chain.largest();
  const double bound = kShare * options.fit_error_mm / 1000;
  if (even_error > bound) {
    const Rig::Motion even = motion;
    for (const Key& key : keys)
      if (2 * key.tracks >= keys.front().tracks) add_time(key.time, times);
    std::size_t before = 0;
    for (int round = 0; round < kRounds && before != times.size(); ++round) {
      before = times.size();
      motion.sample_rate = stated;
      motion.times = filled(times, std::min(stated, kFill));
      motion.samples.clear();
      for (const double t : motion.times) motion.samples.push_back(pose(t));
      chain = errors();
      for (std::size_t k = 0; k < keys.size(); ++k)
        if (chain.error(worst_joint(chain, int(k)), int(k)) > bound) add_time(keys[k].time, times);
    }
    if (chain.largest() > 0.9 * even_error) {  // what is missed is too close to other keys
      motion = even;
      chain = errors();
    }
  }
  int key = 0;
  for (int k = 1; k < chain.frames(); ++k)
    if (chain.error(worst_joint(chain, k), k) > chain.error(worst_joint(chain, key), key)) key = k;
  const int joint = worst_joint(chain, key);
  const double mm = 1000 * chain.error(joint, key);
  if (mm <= options.fit_error_mm) return;
  char line[160];
  std::snprintf(line, sizeof line, "' passes one by %.3g mm at %.4g s", mm, keys[std::size_t(key)].time);
  report["notes"].push_back("clip '" + motion.name +
                            "': keys less than 1/120 s from others are left out; joint '" +
                            rig.joints[std::size_t(joint)].name + line);
}

/// One clip; `keys`: see uneven_keys(); `nodes`: see pose_at().
Rig::Motion sample(const SourceScene& scene, const SourceClip& clip, const std::vector<Key>& keys,
                   const std::vector<int>& nodes, const Matrix& to_model, const Rig& rig,
                   const Options& options, nlohmann::json& report) {
  Rig::Motion motion;
  motion.name = clip.name;
  motion.begin = clip.begin;
  motion.extras = clip.extras;
  motion.sample_rate = sampling_rate(clip);
  bool scaled = false;
  for (const SourceChannel& c : clip.channels)
    for (const Eigen::Vector3d& s : c.scales) scaled = scaled || (s - c.scales.front()).norm() > 1e-3;
  if (scaled)
    report["notes"].push_back("clip '" + clip.name + "': scale keys; positions follow them, sizes do not");
  const auto pose = [&](double t) { return pose_at(scene, clip, t, nodes, to_model, rig); };
  take_samples(rig, clip, keys, pose, options, motion, report);
  const std::size_t frames = motion.samples.size();
  if (const auto [count, largest] = stretch(motion); count > 0)
    report["notes"].push_back(
        "clip '" + clip.name + "': " + std::to_string(count) +
        (count == 1 ? " joint changes its" : " joints change their") + " distance to the parent, by up to " +
        std::to_string(std::lround(1e3 * largest)) + " mm; physics follows the clip there");
  if (begins_with_reference_pose(motion)) {
    const double left_out = motion.time(1);
    motion.samples.erase(motion.samples.begin());
    motion.begin += left_out;
    if (!motion.times.empty()) motion.times.erase(motion.times.begin());
    for (double& t : motion.times) t -= left_out;
    report["notes"].push_back("clip '" + clip.name +
                              "': its first frame is a reference pose, apart from the motion; left out");
  }
  add_morph_keys(scene, clip, motion, report);
  // A loop comes back to its first pose, the root's place aside, and to its first face.
  motion.loops = frames > 8 && largest_turn(motion.samples.back(), motion.samples.front()) < 0.01 &&
                 std::all_of(motion.morph_keys.begin(), motion.morph_keys.end(), [](const auto& curve) {
                   return std::abs(curve.second.back().second - curve.second.front().second) < 0.01;
                 });
  return motion;
}

}  // namespace

std::vector<Matrix> node_transforms(const SourceScene& scene, const SourceClip* clip, double t) {
  std::vector<const SourceChannel*> channel(scene.nodes.size(), nullptr);
  if (clip)
    for (const SourceChannel& c : clip->channels) channel[c.node] = &c;
  std::vector<Matrix> world(scene.nodes.size());
  for (std::size_t i = 0; i < scene.nodes.size(); ++i) {
    Matrix local = scene.nodes[i].local;
    if (const SourceChannel* c = channel[i]) {
      Eigen::Vector3d position = local.block<3, 1>(0, 3);
      Eigen::Matrix3d a = local.block<3, 3>(0, 0);
      Eigen::Vector3d scale = a.colwise().norm();
      if (a.determinant() < 0) scale[0] = -scale[0];
      for (int k = 0; k < 3; ++k) a.col(k) /= std::abs(scale[k]) > 1e-12 ? scale[k] : 1;
      Eigen::Quaterniond rotation(a);
      position = interpolate(c->position_times, c->positions, t, position);
      rotation = interpolate(c->rotation_times, c->rotations, t, rotation).normalized();
      scale = interpolate(c->scale_times, c->scales, t, scale);
      local.setIdentity();
      local.block<3, 3>(0, 0) = rotation.toRotationMatrix() * scale.asDiagonal();
      local.block<3, 1>(0, 3) = position;
    }
    world[i] = scene.nodes[i].parent < 0 ? local : Matrix(world[scene.nodes[i].parent] * local);
  }
  return world;
}

namespace {

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
      const double most = kMostSamples / double(rig.joints.size());
      bool too_long = clip.duration * sampling_rate(clip) > most;
      std::vector<Key> keys;
      if (!too_long) keys = uneven_keys(clip, sampling_rate(clip));
      too_long |= double(keys.size()) > most;
      if (too_long)
        return {"clip '" + clip.name + "' is too long to convert: " + std::to_string(clip.duration) + " s"};
      Rig::Motion motion = sample(from, clip, keys, of_joint, to, rig, options, report);
      if (motion.samples.size() < 2) report["notes"].push_back("clip '" + clip.name + "' is a single pose");
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
