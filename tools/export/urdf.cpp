#include "export/urdf.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "export/body_parts.h"
#include "export/xml_text.h"

namespace sinew::exporting {
namespace {

using Kind = JointPart::Kind;

constexpr double kVelocity = 100;  ///< rad/s, m/s: URDF wants a limit, a skeleton has none
constexpr double kLocked = 1e-7;   ///< cosine of the pitch below which roll and yaw are one turn

/// Roll, pitch and yaw: turns about the fixed x, y and z axes, rad.
Vec3<double> roll_pitch_yaw(const Quat<double>& rotation) {
  const Mat3<double> r = rotation.normalized().toRotationMatrix();
  const double cosine = std::hypot(r(0, 0), r(1, 0));
  const double pitch = std::atan2(-r(2, 0), cosine);
  if (cosine < kLocked) return {std::atan2(-r(1, 2), r(1, 1)), pitch, 0};
  return {std::atan2(r(2, 1), r(2, 2)), pitch, std::atan2(r(1, 0), r(0, 0))};
}

/// URDF knows neither balls nor several axes in one joint.
std::vector<JointPart> single_axes(const Joint& joint) {
  std::vector<JointPart> parts;
  for (const JointPart& part : parts_of(joint)) {
    if (part.kind != Kind::kBall) {
      parts.push_back(part);
      continue;
    }
    for (const auto& [k, suffix] : {std::pair(0, "_x"), std::pair(1, "_y"), std::pair(2, "_z")})
      parts.push_back({Kind::kHinge, Vec3<double>::Unit(k), part.dof + k, suffix});
  }
  return parts;
}

/// "world" is what a bolted root is called or hangs on, and nothing else.
std::set<std::string> taken_names(const Skeleton& skeleton) {
  for (const Joint& joint : skeleton.joints)
    if (joint.parent < 0 && joint.type == JointType::kFixed && joint.name == "world") return {};
  return {"world"};
}

class Writer : XmlText {
 public:
  explicit Writer(const Skeleton& skeleton)
      : s_(skeleton),
        names_(unique_names(skeleton, taken_names(skeleton))),
        joint_names_(unique_joint_names(skeleton)) {}

  std::string write(std::vector<std::string>& notes) {
    open("robot", {{"name", s_.name.empty() ? "robot" : s_.name}});
    for (int i = 0; i < static_cast<int>(s_.joints.size()); ++i) {
      attach(i);
      link(i);
    }
    close();
    notes_.append_to(notes);
    return text();
  }

 private:
  const Joint& joint(int i) const { return s_.joints[static_cast<std::size_t>(i)]; }
  const std::string& name(int i) const { return names_[static_cast<std::size_t>(i)]; }
  void origin(const Transform<double>& x) {
    Attributes attributes = {{"xyz", in_digits(x.translation)}};
    if (!x.rotation.isApprox(Quat<double>::Identity(), 0))
      attributes.emplace_back("rpy", in_digits(roll_pitch_yaw(x.rotation)));
    element("origin", attributes);
  }

  /// What joins a link to its parent.
  void attach(int i) {
    const Joint& j = joint(i);
    if (j.parent < 0) {
      if (j.type == JointType::kFixed && name(i) != "world") {
        element("link", {{"name", "world"}});
        begin_joint(joint_names_[static_cast<std::size_t>(i)], "fixed", "world", name(i), j.rest);
        close();
      } else if (j.type == JointType::kFree && !(j.rest == Transform<double>{})) {
        notes_.add(name(i), "where a free root is at rest is not in a URDF");
      }
      return;
    }
    if (j.type == JointType::kFixed || i >= s_.body_count || j.type == JointType::kFree ||
        j.type == JointType::kPlanar) {
      const char* type = j.type == JointType::kFree     ? "floating"
                         : j.type == JointType::kPlanar ? "planar"
                                                        : "fixed";
      begin_joint(joint_names_[static_cast<std::size_t>(i)], type, name(j.parent), name(i), j.rest);
      if (j.type == JointType::kPlanar) element("axis", {{"xyz", in_digits(j.axis)}});
      close();
      return;
    }
    chain(i);
  }

  /// Joints of one axis each, with links without mass between them.
  void chain(int i) {
    const Joint& j = joint(i);
    const std::vector<JointPart> parts = single_axes(j);
    std::string above = name(j.parent);
    for (std::size_t p = 0; p < parts.size(); ++p) {
      const bool last = p + 1 == parts.size();
      const std::string below = last ? name(i) : name(i) + parts[p].suffix + "_axis";
      axis(i, parts[p], above, below, p == 0 ? j.rest : Transform<double>{});
      if (!last) element("link", {{"name", below}});
      above = below;
    }
  }

  void axis(int i, const JointPart& part, const std::string& above, const std::string& below,
            const Transform<double>& place) {
    const Joint& j = joint(i);
    const DofLimits& dof = j.dofs[part.dof];
    double lower = dof.lower, upper = dof.upper;
    if (j.type == JointType::kBall) {
      upper = largest_angle(j);
      if (upper >= std::numbers::pi) upper = kUnlimited;
      lower = -upper;
      if (upper < kUnlimited)
        notes_.add(name(i), "the largest angle that a ball joint's limits allow bounds each of its axes");
    }
    const bool unlimited = lower <= -kUnlimited && upper >= kUnlimited;
    const char* type = part.kind == Kind::kSlide ? "prismatic" : unlimited ? "continuous" : "revolute";
    begin_joint(joint_names_[static_cast<std::size_t>(i)] + part.suffix, type, above, below, place);
    element("axis", {{"xyz", in_digits(part.axis)}});
    const auto [minus, plus] = s_.torque_limits(i, part.dof);
    if (minus != plus)
      notes_.add(name(i), "torque limits that differ by direction: the larger is the effort");
    if (minus == 0 && plus == 0)
      notes_.add(name(i), "no muscle: an effort of 0, which readers may take for one that is not said");
    Attributes limit = {{"effort", in_digits(std::max(minus, plus))}, {"velocity", in_digits(kVelocity)}};
    if (!unlimited || part.kind == Kind::kSlide) {
      limit.emplace_back("lower", in_digits(lower));
      limit.emplace_back("upper", in_digits(upper));
    }
    element("limit", limit);
    if (dof.damping > 0 || dof.dry_friction > 0)
      element("dynamics", {{"damping", in_digits(dof.damping)}, {"friction", in_digits(dof.dry_friction)}});
    close();
  }

  /// Leaves the element open.
  void begin_joint(const std::string& own, const char* type, const std::string& above,
                   const std::string& below, const Transform<double>& place) {
    open("joint", {{"name", own}, {"type", type}});
    element("parent", {{"link", above}});
    element("child", {{"link", below}});
    origin(place);
  }

  void link(int i) {
    const Joint& j = joint(i);
    open("link", {{"name", name(i)}});
    if (i < s_.body_count && j.mass > 0) {
      open("inertial");
      origin({Quat<double>::Identity(), j.center_of_mass});
      element("mass", {{"value", in_digits(j.mass)}});
      const Mat3<double>& m = j.inertia;
      element("inertia", {{"ixx", in_digits(m(0, 0))},
                          {"ixy", in_digits(m(0, 1))},
                          {"ixz", in_digits(m(0, 2))},
                          {"iyy", in_digits(m(1, 1))},
                          {"iyz", in_digits(m(1, 2))},
                          {"izz", in_digits(m(2, 2))}});
      close();
    }
    for (const Collider& c : s_.colliders)
      if (c.joint == i)
        for (const char* use : {"visual", "collision"}) shape(use, c);
    close();
  }

  void shape(const char* use, const Collider& c) {
    open(use);
    origin(c.local);
    open("geometry");
    if (c.shape == Shape::kBox)
      element("box", {{"size", in_digits(Vec3<double>(2 * c.size))}});
    else if (c.shape == Shape::kSphere)
      element("sphere", {{"radius", in_digits(c.size.x())}});
    else
      element("cylinder",
              {{"radius", in_digits(c.size.x())}, {"length", in_digits(2 * (c.size.z() + c.size.x()))}});
    close();
    close();
  }

  const Skeleton& s_;
  std::vector<std::string> names_, joint_names_;
  BodyNotes notes_;
};

}  // namespace

convert::Error write_urdf(const Skeleton& skeleton, std::string& out, std::vector<std::string>& notes) {
  const auto roots = std::count_if(skeleton.joints.begin(), skeleton.joints.end(),
                                   [](const Joint& joint) { return joint.parent < 0; });
  if (roots > 1) return {"it has " + std::to_string(roots) + " roots, and URDF holds one"};
  out = Writer(skeleton).write(notes);
  return {};
}

}  // namespace sinew::exporting
