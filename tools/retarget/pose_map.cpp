#include "retarget/pose_map.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <numbers>

#include "convert/roles.h"
#include "sinew/skeleton/rotation.h"

namespace sinew::retarget {
namespace {

constexpr double kDegree = std::numbers::pi / 180;
constexpr double kSamePosture = 20 * kDegree;  ///< what artists' joints differ by in trunks,
constexpr double kSameCollar = 45 * kDegree;   ///< in collar bones, which hardly turn in anybody,
constexpr double kSameHand = 30 * kDegree;     ///< and in where a hand's mean bone points
constexpr double kUpright = 45 * kDegree;      ///< of a trunk that stands

Role above(Role role) {
  switch (role) {
    case Role::kSpine:
    case Role::kThighL:
    case Role::kThighR:
      return Role::kPelvis;
    case Role::kNeck:
    case Role::kClavicleL:
    case Role::kClavicleR:
      return Role::kSpine;
    case Role::kHead:
      return Role::kNeck;
    case Role::kUpperArmL:
      return Role::kClavicleL;
    case Role::kUpperArmR:
      return Role::kClavicleR;
    case Role::kForearmL:
      return Role::kUpperArmL;
    case Role::kForearmR:
      return Role::kUpperArmR;
    case Role::kHandL:
      return Role::kForearmL;
    case Role::kHandR:
      return Role::kForearmR;
    case Role::kShinL:
      return Role::kThighL;
    case Role::kShinR:
      return Role::kThighR;
    case Role::kFootL:
      return Role::kShinL;
    case Role::kFootR:
      return Role::kShinR;
    case Role::kToesL:
      return Role::kFootL;
    case Role::kToesR:
      return Role::kFootR;
    default:
      return Role::kNone;
  }
}

bool is_trunk(Role role) {
  return role == Role::kSpine || role == Role::kNeck;
}
bool is_collar(Role role) {
  return role == Role::kClavicleL || role == Role::kClavicleR;
}
bool is_hand(Role role) {
  return role == Role::kHandL || role == Role::kHandR;
}
bool is_foot(Role role) {
  return role == Role::kFootL || role == Role::kFootR;
}
bool is_toes(Role role) {
  return role == Role::kToesL || role == Role::kToesR;
}

/// One of the two skeletons at rest.
struct Body {
  const Skeleton& skeleton;
  const BodyMap& map;
  const std::vector<Transform<double>>& rest;
  bool skinned;

  /// Middle of what hangs on a joint, or where it is itself.
  Vec3<double> middle_of_children(int joint) const {
    Vec3<double> sum = Vec3<double>::Zero();
    int count = 0;
    for (std::size_t j = 0; j < rest.size(); ++j)
      if (skeleton.joints[j].parent == joint && !convert::is_control_name(skeleton.joints[j].name)) {
        sum += rest[j].translation;
        ++count;
      }
    return count > 0 ? Vec3<double>(sum / count) : rest[joint].translation;
  }
  /// From a part's first joint to its end; zero where it has no length.
  Vec3<double> direction(Role role) const {
    const Chain& chain = map[role];
    const Vec3<double> end =
        chain.end >= 0 ? rest[chain.end].translation : middle_of_children(chain.joints.back());
    const Vec3<double> way = end - rest[chain.joints.front()].translation;
    return way.norm() > 1e-6 ? Vec3<double>(way.normalized()) : Vec3<double>(Vec3<double>::Zero());
  }
  Vec3<double> left() const {
    return rest[map[Role::kThighL].joints.front()].translation -
           rest[map[Role::kThighR].joints.front()].translation;
  }
  /// From the hips to the neck, or from the feet to the hips.
  Vec3<double> up() const {
    const Vec3<double> hips = hips_of(map, rest);
    const int top = map[Role::kSpine].end;
    if (top >= 0) return rest[top].translation - hips;
    return hips - (rest[map[Role::kFootL].joints.front()].translation +
                   rest[map[Role::kFootR].joints.front()].translation) /
                      2;
  }
  bool upright() const { return std::acos(std::clamp(up().normalized().z(), -1.0, 1.0)) < kUpright; }
  double leg_length() const {
    double sum = 0;
    for (const auto& [thigh, shin] :
         {std::pair(Role::kThighL, Role::kShinL), std::pair(Role::kThighR, Role::kShinR)}) {
      const Vec3<double>& knee = rest[map[shin].joints.front()].translation;
      sum += (knee - rest[map[thigh].joints.front()].translation).norm() +
             (rest[map[shin].end].translation - knee).norm();
    }
    return sum / 2;
  }
  /// Axes forward, left and up of the pelvis, from the line of the hips.
  Mat3<double> pelvis_axes(bool by_gravity) const {
    Mat3<double> axes;
    const Vec3<double> y = left().normalized(),
                       up_axis = by_gravity ? Vec3<double>(Vec3<double>::UnitZ()) : up();
    axes.col(1) = y;
    axes.col(0) = y.cross(up_axis).normalized();
    axes.col(2) = axes.col(0).cross(y);
    return axes;
  }
};

double angle_between(const Vec3<double>& a, const Vec3<double>& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

/// How each part of the target's rest turns into the retarget pose, model axes. Turning back what another
/// skeleton was turned by is exact: every rule is the same from either side.
class Turns {
 public:
  Turns(const Body& from, const Body& to) : from_(from), to_(to), upright_(from.upright() && to.upright()) {
    for (const Role role : kParts) turn_[index(role)] = turn(role);
  }
  const Quat<double>& operator[](Role role) const { return turn_[index(role)]; }
  /// For what stands above the pelvis: about the vertical alone, where both stand.
  Quat<double> root() const {
    const Quat<double>& pelvis = turn_[index(Role::kPelvis)];
    if (!upright_) return pelvis;
    return rotation_exp<double>(twist_angle<double>(pelvis, Vec3<double>::UnitZ()) * Vec3<double>::UnitZ());
  }

 private:
  static std::size_t index(Role role) { return static_cast<std::size_t>(role); }

  Quat<double> turn(Role role) const {
    if (role == Role::kPelvis) {
      const Mat3<double> both = from_.pelvis_axes(upright_) * to_.pelvis_axes(upright_).transpose();
      return Quat<double>(both).normalized();
    }
    const Quat<double>& parent = turn_[index(above(role))];
    if (from_.map[role].joints.empty() || to_.map[role].joints.empty() || role == Role::kHead ||
        is_toes(role))
      return parent;
    const Vec3<double> theirs = from_.direction(role), ours = to_.direction(role);
    if (theirs.isZero() || ours.isZero()) return parent;
    if (is_foot(role) && upright_) return heading(theirs, ours);
    const double apart = angle_between(parent * ours, theirs);
    if (is_trunk(role) && from_.skinned && to_.skinned && apart < kSamePosture) return parent;
    if (is_collar(role) && apart < kSameCollar) return parent;
    if (is_hand(role) && apart < kSameHand) return parent;
    return (rotation_between<double>(parent * ours, theirs) * parent).normalized();
  }

  /// About the vertical alone: soles are level at rest and stay so.
  Quat<double> heading(const Vec3<double>& theirs, const Vec3<double>& ours) const {
    if (std::hypot(theirs.x(), theirs.y()) < 0.1 || std::hypot(ours.x(), ours.y()) < 0.1) return root();
    const double angle = std::atan2(theirs.y(), theirs.x()) - std::atan2(ours.y(), ours.x());
    return rotation_exp<double>(std::remainder(angle, 2 * std::numbers::pi) * Vec3<double>::UnitZ());
  }

  const Body& from_;
  const Body& to_;
  bool upright_;
  std::array<Quat<double>, 22> turn_ = [] {
    std::array<Quat<double>, 22> all;
    all.fill(Quat<double>::Identity());
    return all;
  }();
};

/// Middles of a chain's bones as shares of its length.
std::vector<double> middles(const Chain& chain, const std::vector<Transform<double>>& rest) {
  std::vector<double> at{0};
  for (std::size_t i = 0; i < chain.joints.size(); ++i) {
    const int next = i + 1 < chain.joints.size() ? chain.joints[i + 1] : chain.end;
    const double length = next >= 0 ? (rest[next].translation - rest[chain.joints[i]].translation).norm() : 0;
    at.push_back(at.back() + length);
  }
  std::vector<double> out;
  for (std::size_t i = 0; i + 1 < at.size(); ++i)
    out.push_back(at.back() > 1e-9 ? (at[i] + at[i + 1]) / (2 * at.back())
                                   : (double(i) + 0.5) / double(chain.joints.size()));
  return out;
}

void map_chain(const Chain& from, const Chain& to, const Quat<double>& turn, PoseMap& map) {
  if (from.joints.empty()) return;
  const std::vector<double> theirs = middles(from, map.from_rest), ours = middles(to, map.to_rest);
  for (std::size_t i = 0; i < to.joints.size(); ++i) {
    JointMap& joint = map.joints[to.joints[i]];
    joint.rest = turn * map.to_rest[to.joints[i]].rotation;
    if (from.joints.size() == to.joints.size()) {
      joint.a = joint.b = from.joints[i];
      continue;
    }
    const std::size_t after =
        std::size_t(std::upper_bound(theirs.begin(), theirs.end(), ours[i]) - theirs.begin());
    joint.a = from.joints[after > 0 ? after - 1 : 0];
    joint.b = from.joints[std::min(after, theirs.size() - 1)];
    if (joint.a != joint.b) joint.blend = (ours[i] - theirs[after - 1]) / (theirs[after] - theirs[after - 1]);
  }
}

std::string plain_name(const std::string& name) {
  const auto cut = name.find_last_of(":|");
  std::string plain = cut == std::string::npos ? name : name.substr(cut + 1);
  for (char& c : plain) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return plain;
}

/// "L2index": the side, how far from the hand, which finger; empty for what is no finger.
std::string finger_name(const Skeleton& skeleton, const BodyMap& map, int joint) {
  const std::string name = plain_name(skeleton.joints[joint].name);
  for (const char* finger : {"thumb", "index", "middle", "ring", "pinky", "little"}) {
    if (name.find(finger) == std::string::npos) continue;
    int depth = 0;
    for (int j = joint; j >= 0; j = skeleton.joints[j].parent, ++depth)
      for (const auto& [hand, side] : {std::pair(Role::kHandL, "L"), std::pair(Role::kHandR, "R")})
        if (!map[hand].joints.empty() && map[hand].joints.front() == j)
          return side + std::to_string(depth) + (std::string(finger) == "little" ? "pinky" : finger);
  }
  return {};
}

/// Joints that are no controls and not the pelvis or above it, by the names under which they are looked for.
std::map<std::string, int> by_names(const Skeleton& skeleton, const BodyMap& map) {
  std::map<std::string, int> out;
  for (int j = 0; j < int(skeleton.joints.size()); ++j) {
    if (is_below(skeleton, map.pelvis(), j) || convert::is_control_name(skeleton.joints[j].name)) continue;
    out.emplace(plain_name(skeleton.joints[j].name), j);
    if (const std::string finger = finger_name(skeleton, map, j); !finger.empty()) out.emplace(finger, j);
  }
  return out;
}

Error pair_others(const JointPairs& pairs, PoseMap& map) {
  const std::map<std::string, int> theirs = by_names(*map.source, map.from);
  for (const auto& [name, joint] : by_names(*map.target, map.to))
    if (const auto found = theirs.find(name); found != theirs.end() && map.joints[joint].a < 0)
      map.joints[joint].a = map.joints[joint].b = found->second;
  for (const auto& [ours, their] : pairs) {
    const int joint = map.target->find(ours.c_str()), source = map.source->find(their.c_str());
    if (joint < 0) return {"the target has no joint '" + ours + "'"};
    if (source < 0) return {"the source has no joint '" + their + "'"};
    map.joints[joint].a = map.joints[joint].b = source;
    map.joints[joint].blend = 0;
  }
  return {};
}

}  // namespace

std::vector<Transform<double>> model_of(const Skeleton& skeleton, std::span<const Transform<double>> local) {
  std::vector<Transform<double>> model(local.begin(), local.end());
  for (std::size_t j = 0; j < model.size(); ++j)
    if (const int parent = skeleton.joints[j].parent; parent >= 0) model[j] = model[parent] * local[j];
  return model;
}

Vec3<double> hips_of(const BodyMap& map, std::span<const Transform<double>> model) {
  return (model[map[Role::kThighL].joints.front()].translation +
          model[map[Role::kThighR].joints.front()].translation) /
         2;
}

Error map_poses(const Skeleton& source, bool source_skinned, const Skeleton& target, bool target_skinned,
                const JointPairs& pairs, PoseMap& out) {
  PoseMap map;
  map.source = &source;
  map.target = &target;
  if (Error error = find_chains(source, map.from)) return {"the clips' skeleton: " + error.message};
  if (Error error = find_chains(target, map.to)) return {"the target: " + error.message};
  map.from_rest = model_rest(source);
  map.to_rest = model_rest(target);
  map.joints.resize(target.joints.size());
  const Body from{source, map.from, map.from_rest, source_skinned},
      to{target, map.to, map.to_rest, target_skinned};
  for (const auto& [body, which] : {std::pair(&from, "the clips' skeleton"), std::pair(&to, "the target")})
    if (!(body->leg_length() > 1e-3) || !(body->left().norm() > 1e-6))
      return {std::string(which) + ": its legs have no length, or stand in one place"};
  map.leg = from.leg_length();
  map.scale = to.leg_length() / map.leg;
  const Turns turns(from, to);
  for (const Role role : kParts) map_chain(map.from[role], map.to[role], turns[role], map);
  if (Error error = pair_others(pairs, map)) return error;
  if (map.to.pelvis() != 0 && map.from.pelvis() != 0) map.joints[0].a = map.joints[0].b = 0;
  std::vector<Quat<double>> turn(target.joints.size(), turns.root());
  for (std::size_t j = 0; j < turn.size(); ++j) {  // what is in no chain turns with what it hangs on
    if (target.joints[j].parent >= 0) turn[j] = turn[target.joints[j].parent];
    for (const Role role : kParts)
      for (const int k : map.to[role].joints)
        if (k == int(j)) turn[j] = turns[role];
    map.joints[j].rest = (turn[j] * map.to_rest[j].rotation).normalized();
  }
  out = std::move(map);
  return {};
}

namespace {

/// How far a source joint has turned from its rest, model axes.
Quat<double> turned(const PoseMap& map, int joint, std::span<const Transform<double>> model) {
  return model[joint].rotation * map.from_rest[joint].rotation.conjugate();
}

/// Where the root stands that is not the pelvis itself.
Vec3<double> place_root(const PoseMap& map, std::span<const Transform<double>> model) {
  const Vec3<double>& rest = map.to_rest[0].translation;
  if (map.from.pelvis() != 0) return rest + map.scale * (model[0].translation - map.from_rest[0].translation);
  const Vec3<double> hips = map.scale * hips_of(map.from, model), own = hips_of(map.to, map.to_rest);
  return {rest.x() + hips.x() - own.x(), rest.y() + hips.y() - own.y(), rest.z()};
}

}  // namespace

std::vector<Transform<double>> follow(const PoseMap& map, std::span<const Transform<double>> local,
                                      std::span<const Transform<double>> model) {
  const std::vector<Joint>& joints = map.target->joints;
  std::vector<Quat<double>> rotation(joints.size());
  std::vector<Transform<double>> out(joints.size());
  for (std::size_t j = 0; j < joints.size(); ++j) {
    const JointMap& joint = map.joints[j];
    const int parent = joints[j].parent;
    out[j] = joints[j].rest;
    if (joint.a >= 0) {
      const Quat<double> a = turned(map, joint.a, model);
      rotation[j] = (joint.a == joint.b ? a : a.slerp(joint.blend, turned(map, joint.b, model))) * joint.rest;
    } else {
      rotation[j] = parent < 0 ? joint.rest : rotation[parent] * joints[j].rest.rotation;
    }
    rotation[j].normalize();
    out[j].rotation = parent < 0 ? rotation[j] : (rotation[parent].conjugate() * rotation[j]).normalized();
    if (parent < 0 || joint.a < 0 || joint.a != joint.b || map.source->joints[joint.a].parent < 0) continue;
    // What the source's joint has shifted by, in the axes that the two rests share.
    const Vec3<double> shift = local[joint.a].translation - map.source->joints[joint.a].rest.translation;
    const int above_it = map.source->joints[joint.a].parent;
    out[j].translation +=
        map.scale * (map.joints[parent].rest.conjugate() * (map.from_rest[above_it].rotation * shift));
  }
  if (map.to.pelvis() != 0) out[0].translation = place_root(map, model);
  return out;
}

void place_hips(const PoseMap& map, const Vec3<double>& hips, std::span<Transform<double>> local) {
  const std::vector<Transform<double>> model = model_of(*map.target, local);
  const int pelvis = map.to.pelvis(), parent = map.target->joints[pelvis].parent;
  const Vec3<double> shift = hips - hips_of(map.to, model);
  local[pelvis].translation += parent < 0 ? shift : Vec3<double>(model[parent].rotation.conjugate() * shift);
}

}  // namespace sinew::retarget
