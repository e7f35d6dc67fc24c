#include "convert/body.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "convert/human.h"
#include "convert/muscles.h"
#include "convert/roles.h"
#include "convert/shapes.h"
#include "convert/volume.h"
#include "sinew/skeleton/principal_axes.h"
#include "sinew/skeleton/rotation.h"

namespace sinew::convert {
namespace {

constexpr double kPi = 3.14159265358979323846;

/// Swing range from rest and twist range in degrees (Soucie 2011; Namdari 2011), wide because rest poses
/// differ.
struct Anatomy {
  Role role;
  double swing_deg, twist_deg;
  bool hinge;
};
constexpr Anatomy kAnatomy[] = {
    {Role::kPelvis, 45, 35, false},    {Role::kSpine, 40, 35, false},      {Role::kChest, 35, 35, false},
    {Role::kNeck, 50, 60, false},      {Role::kHead, 50, 60, false},       {Role::kClavicleL, 35, 25, false},
    {Role::kClavicleR, 35, 25, false}, {Role::kUpperArmL, 120, 90, false}, {Role::kUpperArmR, 120, 90, false},
    {Role::kForearmL, 0, 0, true},     {Role::kForearmR, 0, 0, true},      {Role::kHandL, 70, 85, false},
    {Role::kHandR, 70, 85, false},     {Role::kThighL, 110, 50, false},    {Role::kThighR, 110, 50, false},
    {Role::kShinL, 0, 0, true},        {Role::kShinR, 0, 0, true},         {Role::kFootL, 55, 35, false},
    {Role::kFootR, 55, 35, false},     {Role::kToesL, 60, 10, false},      {Role::kToesR, 60, 10, false}};

const Anatomy* anatomy(Role role) {
  const auto* found = std::find_if(std::begin(kAnatomy), std::end(kAnatomy),
                                   [&](const Anatomy& a) { return a.role == role; });
  return found == std::end(kAnatomy) ? nullptr : found;
}

/// The published rows, and what the options say of them.
std::map<std::string, double> all_muscle_rows(const Options& options) {
  std::map<std::string, double> rows = muscle_rows(options.human);
  for (const auto& [name, value] : options.muscles) rows[name] = value;
  return rows;
}

bool is_hand(Role r) {
  return r == Role::kHandL || r == Role::kHandR;
}
bool is_foot(Role r) {
  return r == Role::kFootL || r == Role::kFootR;
}

bool is_toes(Role r) {
  return r == Role::kToesL || r == Role::kToesR;
}

/// Radius of a limb of unknown girth, as a share of its length (de Leva's segment volumes read as cylinders:
/// 0.10–0.17).
constexpr double kSlenderness = 0.14;

struct Part {
  std::vector<Vec3<double>> vertices;  ///< mainly this joint's, joint axes
  Vec3<double> direction = Vec3<double>::UnitZ();
  double length = 0;
  Collider shape;
  double volume = 0;  ///< of the shape
  Solid solid;        ///< of the skin; no cells where there is none
  double mass = 0;    ///< kg
  bool simulated = false;
};

/// Fewer cells than this (a fingertip's) say less than the fitted shape.
constexpr int kEnoughCells = 24;

class BodyBuilder {
 public:
  BodyBuilder(const Rig& rig, const Options& options, nlohmann::json& report)
      : rig_(rig), options_(options), report_(report) {}

  Skeleton build(std::vector<int>& joint_of_rig) {
    const std::size_t count = rig_.joints.size();
    children_.resize(count);
    for (std::size_t j = 0; j < count; ++j)
      if (rig_.joints[j].parent >= 0) children_[rig_.joints[j].parent].push_back(static_cast<int>(j));
    parts_.resize(count);
    find_roles();
    choose_simulated();
    gather_vertices();
    for (std::size_t j = 0; j < count; ++j)
      if (parts_[j].simulated) fit_shape(static_cast<int>(j));
    weigh();
    return assemble(joint_of_rig);
  }

 private:
  void find_roles() {
    roles_.assign(rig_.joints.size(), Role::kNone);
    for (std::size_t j = 0; j < rig_.joints.size(); ++j) {
      const Role role = role_of_name(rig_.joints[j].name);
      // The first joint of a chain of equals keeps a limb's role; spines and necks may repeat.
      bool repeated = false;
      const bool trunk = role == Role::kSpine || role == Role::kNeck || role == Role::kChest;
      for (std::size_t k = 0; k < j && !trunk; ++k) repeated = repeated || roles_[k] == role;
      roles_[j] = repeated ? Role::kNone : role;
    }
    report_["roles"] = nlohmann::json::object();
    for (std::size_t j = 0; j < roles_.size(); ++j)
      if (roles_[j] != Role::kNone) report_["roles"][rig_.joints[j].name] = role_name(roles_[j]);
  }

  bool below(int joint, bool (*test)(Role)) const {
    for (int p = rig_.joints[joint].parent; p >= 0; p = rig_.joints[p].parent)
      if (test(roles_[p])) return true;
    return false;
  }

  double bone_length(int j) const {
    double longest = 0;
    for (const int c : children_[j])
      if (!rig_.joints[c].control)
        longest =
            std::max(longest, (rig_.joints[c].rest.translation - rig_.joints[j].rest.translation).norm());
    return longest;
  }

  void choose_simulated() {
    const bool skinned = !rig_.skin().empty();
    const double small = 0.012 * std::max(rig_.height, 0.1);
    const auto under_head = [](Role r) { return r == Role::kHead; };
    std::vector<std::string> controls, passengers;
    for (std::size_t j = 0; j < rig_.joints.size(); ++j) {
      const Rig::Joint& joint = rig_.joints[j];
      const int index = static_cast<int>(j);
      const bool end_part = roles_[j] == Role::kHead || is_hand(roles_[j]) || is_foot(roles_[j]);
      const bool matters = bone_length(index) > small || (skinned ? joint.skin_weight > 0 : end_part);
      const bool finger = !options_.simulate_fingers && below(index, is_hand);
      parts_[j].simulated = matters && !joint.control && !finger && !below(index, under_head);
    }
    // A simulated joint needs simulated ancestors.
    for (std::size_t j = rig_.joints.size(); j-- > 0;)
      if (parts_[j].simulated && rig_.joints[j].parent >= 0) parts_[rig_.joints[j].parent].simulated = true;
    parts_[0].simulated = true;
    for (std::size_t j = 0; j < rig_.joints.size(); ++j) {
      if (rig_.joints[j].control)
        controls.push_back(rig_.joints[j].name);
      else if (!parts_[j].simulated)
        passengers.push_back(rig_.joints[j].name);
    }
    report_["control_joints"] = controls;
    report_["ride_along_joints"] = passengers;
  }

  int owner(int j) const {
    while (!parts_[j].simulated) j = rig_.joints[j].parent;
    return j;
  }

  void gather_vertices() {
    for (const Mesh& mesh : rig_.skin()) {
      part_of_vertex_.emplace_back();
      for (std::size_t v = 0; v < mesh.positions.size() / 3; ++v) {
        std::size_t main = 0;
        for (std::size_t k = 1; k < 4; ++k)
          if (mesh.weights[4 * v + k] > mesh.weights[4 * v + main]) main = k;
        const int j = owner(mesh.joints[4 * v + main]);
        const Vec3<double> p(mesh.positions[3 * v], mesh.positions[3 * v + 1], mesh.positions[3 * v + 2]);
        parts_[j].vertices.push_back(rig_.joints[j].rest.inverse() * p);
        part_of_vertex_.back().push_back(j);
      }
    }
    const std::vector<Solid> solids =
        part_solids(rig_.skin(), part_of_vertex_, static_cast<int>(parts_.size()));
    for (std::size_t j = 0; j < parts_.size(); ++j) parts_[j].solid = solids[j];
  }

  /// Towards the simulated children's mean, or along the vertices, or on from the parent.
  void bone(int j) {
    Part& part = parts_[j];
    Vec3<double> end = Vec3<double>::Zero();
    int ends = 0;
    const Transform<double> to_joint = rig_.joints[j].rest.inverse();
    for (const int c : children_[j]) {
      if (rig_.joints[c].control || (!parts_[c].simulated && parts_[j].vertices.size() > 20)) continue;
      const Vec3<double> at = to_joint * rig_.joints[c].rest.translation;
      if (at.norm() < 1e-4) continue;
      end += at;
      ++ends;
    }
    if (ends > 0) end /= ends;
    if (end.norm() < 1e-3 && !part.vertices.empty()) {
      end.setZero();
      for (const Vec3<double>& v : part.vertices) end += v;
      end *= 2.0 / double(part.vertices.size());
    }
    if (end.norm() < 1e-3 && rig_.joints[j].parent >= 0)
      end = 0.5 * (to_joint.rotation *
                   (rig_.joints[j].rest.translation - rig_.joints[rig_.joints[j].parent].rest.translation));
    if (end.norm() < 1e-3) end = to_joint.rotation * Vec3<double>(0, 0, 0.03 * std::max(rig_.height, 0.1));
    part.length = end.norm();
    part.direction = end / part.length;
  }

  void fit_shape(int j) {
    bone(j);
    Part& part = parts_[j];
    Collider& c = part.shape;
    if (part.vertices.size() >= 12) {
      if (is_foot(roles_[j]) || is_toes(roles_[j]))
        c = fit_sole(part.vertices, part.direction, rig_.joints[j].rest.rotation, rig_.height);
      else
        c = fit_capsule(part.vertices, part.direction, rig_.height);
    } else {
      // Heads, hands and feet of bare skeletons: lengths as shares of stature (Drillis & Contini).
      const bool head = roles_[j] == Role::kHead;
      if (head)
        part.length = 0.13 * rig_.height;
      else if (is_hand(roles_[j]))
        part.length = std::max(part.length, 0.10 * rig_.height);
      const double radius = head ? 0.055 * rig_.height
                                 : std::max(kSlenderness * part.length, 0.01 * std::max(rig_.height, 0.1));
      c.shape = Shape::kCapsule;
      c.size = {radius, radius, std::max(0.0, part.length / 2 - radius)};
      c.local.translation = part.direction * (part.length / 2);
      c.local.rotation = rotation_between<double>(Vec3<double>::UnitZ(), part.direction);
    }
    const Vec3<double>& s = c.size;
    part.volume = c.shape == Shape::kBox ? 8 * s.x() * s.y() * s.z()
                                         : kPi * s.x() * s.x() * (2 * s.z() + 4.0 / 3.0 * s.x());
    // A chain link without skin of its own and without length carries nothing.
    if (part.length < 0.005 * rig_.height && part.vertices.empty()) part.volume = 0;
  }

  /// Axis of flexion: across the bone, about which the clips bend this joint; anatomy's where they hardly do.
  Vec3<double> hinge_axis(int j) const {
    const Quat<double>& rest = rig_.joints[j].rest.rotation;
    const Vec3<double>& bone = parts_[j].direction;
    AnatomicalAxes anatomy;
    anatomical_axes(roles_[j], rest * bone, rest, anatomy);
    const bool knee = roles_[j] == Role::kShinL || roles_[j] == Role::kShinR;
    Vec3<double> axis = knee ? anatomy.axes.col(1) : Vec3<double>(-anatomy.axes.col(1));
    Mat3<double> scatter = Mat3<double>::Zero();
    double widest = 0;
    const Quat<double> local_rest = rig_.joints[rig_.joints[j].parent].rest.rotation.conjugate() * rest;
    each_pose(j, local_rest, [&](const Quat<double>& q) {
      Vec3<double> r = rotation_log<double>(q);
      r -= bone * bone.dot(r);  // rolling about the bone is no bending
      scatter += r * r.transpose();
      widest = std::max(widest, r.norm());
    });
    if (widest > 0.35) {
      const Vec3<double> main = principal_axes(scatter).axes.col(2);
      axis = main.dot(axis) < 0 ? Vec3<double>(-main) : main;
    }
    axis -= bone * bone.dot(axis);
    return (axis.norm() > 0.1 ? axis : Vec3<double>(bone.unitOrthogonal())).normalized();
  }

  void set_limits(int j, Joint& joint, double mass, double stature) const {
    const Anatomy* a = anatomy(roles_[j]);
    const int count = dof_count(joint.type);
    AnatomicalAxes axes;
    if (const Quat<double>& rest = rig_.joints[j].rest.rotation;
        anatomical_axes(roles_[j], rest * parts_[j].direction, rest, axes)) {
      set_muscles(axes, rows_, options_.strength * mass * stature / reference_stature(options_.human), joint);
    } else {
      // Joints of no known role hold a tenth of the body at a tenth of its height, and half as much again.
      const double torque = options_.strength * 1.5 * mass * 9.81 * 0.12 * stature;
      for (int k = 0; k < count; ++k) joint.dofs[k].torque_minus = joint.dofs[k].torque_plus = torque;
    }
    for (int k = 0; k < count; ++k)
      joint.dofs[k].damping = 0.002 * std::max(joint.dofs[k].torque_minus, joint.dofs[k].torque_plus);
    if (joint.type == JointType::kBall) {
      joint.swing_axis = parts_[j].direction;
      double swing = (a ? a->swing_deg : 75) * kPi / 180, twist = (a ? a->twist_deg : 45) * kPi / 180;
      double twist_low = -twist, twist_high = twist;
      each_pose(j, joint.rest.rotation, [&](const Quat<double>& q) {
        const Vec3<double> b = q * joint.swing_axis;
        swing = std::max(swing, std::acos(std::clamp(b.dot(joint.swing_axis), -1.0, 1.0)) + 0.15);
        const double t = twist_angle<double>(q, joint.swing_axis);
        twist_low = std::min(twist_low, t - 0.15);
        twist_high = std::max(twist_high, t + 0.15);
      });
      joint.swing_limit = std::min(swing, kPi);
      joint.twist_lower = twist_low;
      joint.twist_upper = twist_high;
    } else if (joint.type == JointType::kRevolute) {
      double low = 0, high = 0;
      each_pose(j, joint.rest.rotation, [&](const Quat<double>& q) {
        const double t = twist_angle<double>(q, joint.axis);
        low = std::min(low, t);
        high = std::max(high, t);
      });
      // The side that the clips bend to is flexion, 150° at most; 5° beyond the other.
      const bool positive = high >= -low;
      joint.dofs[0].lower = positive ? std::min(low - 0.05, -0.09) : std::min(low - 0.1, -150 * kPi / 180);
      joint.dofs[0].upper = positive ? std::max(high + 0.1, 150 * kPi / 180) : std::max(high + 0.05, 0.09);
    }
  }

  double total_mass() const {
    return options_.total_mass > 0 ? options_.total_mass
                                   : mass_from_height(std::max(rig_.height, 0.05), options_.human);
  }

  bool has_solid(const Part& part) const { return part.solid.cells >= kEnoughCells; }

  /// Masses: volume times density, or for a human without a skin the published shares, shared within a role
  /// by volume; then scaled to the total.
  void weigh() {
    std::map<Role, double> volume_of_role;
    std::vector<Role> group(parts_.size(), Role::kNone);  // own role, else the nearest ancestor's
    for (std::size_t j = 0; j < parts_.size(); ++j) {
      const int parent = rig_.joints[j].parent;
      group[j] = roles_[j] == Role::kNone && parent >= 0 ? group[parent] : roles_[j];
      if (parts_[j].simulated) volume_of_role[group[j]] += parts_[j].volume;
    }
    const bool human = volume_of_role.count(Role::kThighL) && volume_of_role.count(Role::kUpperArmL) &&
                       volume_of_role.count(Role::kHead);
    const bool by_shares = rig_.skin().empty() && human;
    double sum = 0;
    for (std::size_t j = 0; j < parts_.size(); ++j) {
      Part& part = parts_[j];
      if (!part.simulated || part.volume <= 0) continue;
      if (by_shares)
        part.mass = mass_share(group[j], options_.human) * part.volume / volume_of_role[group[j]];
      else
        part.mass = density(group[j]) * (has_solid(part) ? part.solid.volume : part.volume);
      sum += part.mass;
    }
    for (std::size_t j = 0; j < parts_.size() && human; ++j) {
      const double most = kLargestHeadShare / (1 - kLargestHeadShare) * (sum - parts_[j].mass);
      if (roles_[j] != Role::kHead || parts_[j].mass <= most) continue;
      sum += most - parts_[j].mass;
      parts_[j].mass = most;
      report_["notes"].push_back("the head would weigh more than 18 % of the body; it weighs that");
    }
    for (Part& part : parts_) part.mass *= sum > 0 ? total_mass() / sum : 0;
    report_["masses_from"] = by_shares             ? "published segment masses"
                             : rig_.skin().empty() ? "fitted shapes"
                                                   : "volume of the skin";
  }

  /// Centre of mass and inertia in joint axes: of the skin's solid, else of the fitted shape.
  void set_inertia(int j, Joint& joint) const {
    const Part& part = parts_[j];
    Mat3<double> r = part.shape.local.rotation.toRotationMatrix(),
                 own = solid_inertia(part.shape, joint.mass);
    joint.center_of_mass = part.shape.local.translation;
    if (has_solid(part)) {
      r = rig_.joints[j].rest.rotation.conjugate().toRotationMatrix();
      own = inertia_of(part.solid, joint.mass);
      joint.center_of_mass = rig_.joints[j].rest.inverse() * part.solid.center;
    }
    joint.inertia = r * own * r.transpose();
    joint.inertia = 0.5 * (joint.inertia + joint.inertia.transpose()).eval();
  }

  template <class Use>
  void each_pose(int j, const Quat<double>& rest, Use use) const {
    for (const Rig::Motion& m : rig_.motions)
      for (const auto& frame : m.samples) use(Quat<double>(rest.conjugate() * frame[j].rotation));
  }

  Skeleton assemble(std::vector<int>& joint_of_rig) {
    Skeleton s;
    const std::size_t count = rig_.joints.size();
    joint_of_rig.assign(count, -1);
    const double stature = std::max(rig_.height, 0.05);
    const double mass = total_mass();
    for (const bool simulated : {true, false})
      for (std::size_t j = 0; j < count; ++j) {
        if (parts_[j].simulated != simulated) continue;
        const int index = static_cast<int>(j);
        const Rig::Joint& source = rig_.joints[j];
        joint_of_rig[j] = static_cast<int>(s.joints.size());
        Joint joint;
        joint.name = source.name;
        joint.parent = source.parent < 0 ? -1 : joint_of_rig[source.parent];
        joint.rest =
            source.parent < 0 ? source.rest : rig_.joints[source.parent].rest.inverse() * source.rest;
        joint.rest.rotation.normalize();
        joint.role = roles_[j];
        if (simulated) {
          const Part& part = parts_[j];
          joint.mass = part.mass;
          if (joint.mass > 0) set_inertia(index, joint);
          const Anatomy* a = anatomy(roles_[j]);
          joint.type = source.parent < 0  ? JointType::kFree
                       : part.volume <= 0 ? JointType::kFixed
                       : a && a->hinge    ? JointType::kRevolute
                                          : JointType::kBall;
          if (joint.type == JointType::kRevolute) joint.axis = hinge_axis(index);
          set_limits(index, joint, mass, stature);
          if (part.volume > 0) {
            Collider c = part.shape;
            c.joint = joint_of_rig[j];
            s.colliders.push_back(c);
          }
        }
        s.joints.push_back(joint);
        if (simulated) ++s.body_count;
      }
    report_["total_mass_kg"] = s.total_mass();
    report_["bodies"] = nlohmann::json::array();
    static const char* names[] = {"fixed", "revolute", "prismatic", "universal", "ball", "planar", "free"};
    for (int i = 0; i < s.body_count; ++i)
      report_["bodies"].push_back({{"joint", s.joints[i].name},
                                   {"type", names[static_cast<int>(s.joints[i].type)]},
                                   {"mass_kg", s.joints[i].mass}});
    return s;
  }

  const Rig& rig_;
  const Options& options_;
  nlohmann::json& report_;
  std::vector<std::vector<int>> children_;
  std::vector<Role> roles_;
  std::vector<Part> parts_;
  std::vector<std::vector<int>> part_of_vertex_;  ///< [mesh][vertex]
  std::map<std::string, double> rows_ = all_muscle_rows(options_);
};

}  // namespace

Mat3<double> solid_inertia(const Collider& c, double mass) {
  const Vec3<double>& s = c.size;
  if (c.shape == Shape::kBox) {
    const Vec3<double> q = s.cwiseProduct(s) * (mass / 3);
    return Vec3<double>(q.y() + q.z(), q.x() + q.z(), q.x() + q.y()).asDiagonal();
  }
  const double r = s.x(), l = c.shape == Shape::kCapsule ? 2 * s.z() : 0;
  const double cylinder = mass * l / (l + 4.0 / 3.0 * r), caps = mass - cylinder;
  const double along = cylinder * r * r / 2 + caps * 0.4 * r * r;
  const double across =
      cylinder * (r * r / 4 + l * l / 12) + caps * (0.4 * r * r + l * l / 4 + 0.375 * l * r);
  return Vec3<double>(across, across, along).asDiagonal();
}

Skeleton build_body(const Rig& rig, const Options& options, std::vector<int>& joint_of_rig,
                    nlohmann::json& report) {
  return BodyBuilder(rig, options, report).build(joint_of_rig);
}

}  // namespace sinew::convert
