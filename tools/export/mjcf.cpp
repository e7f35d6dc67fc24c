#include "export/mjcf.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "export/body_parts.h"
#include "export/xml_text.h"
#include "sinew/residual/dynamics.h"
#include "sinew/skeleton/principal_axes.h"

namespace sinew::exporting {
namespace {

using Kind = JointPart::Kind;

constexpr double kLeastInertia = 2e-15;  ///< kg, kg·m²: MuJoCo refuses bodies that move with less than 1e-15

/// Principal moments, none above the sum of the others, and the right-handed axes that they are about.
struct Moments {
  Vec3<double> values;
  Quat<double> axes;

  explicit Moments(const Mat3<double>& inertia) {
    PrincipalAxes found = principal_axes(inertia);
    if (found.axes.determinant() < 0) found.axes.col(2) = -found.axes.col(2);
    values = found.values.cwiseMax(0);
    if (values[2] > values[0] + values[1]) {  // by rounding
      values[0] = values[2] - values[1];
      while (values[2] > values[0] + values[1])
        values[0] = std::nextafter(values[0], std::numeric_limits<double>::max());
    }
    axes = Quat<double>(found.axes).normalized();
  }
};

/// Joints that can move at rest without moving any mass against the others, as a root without mass before a
/// ball joint can: pivots that vanish when the mass matrix is factorised from the tips to the root.
std::vector<int> joints_without_inertia(const Skeleton& s) {
  constexpr double kNone = 1e-11;  // of the inertia that the joint moves when all others stand still
  const std::vector<JointState> rest(static_cast<std::size_t>(s.body_count));
  Eigen::MatrixXd m = evaluate_dynamics(s, rest, Vec3<double>::Zero()).mass_matrix;
  const Eigen::VectorXd alone = m.diagonal();
  std::vector<int> found;
  Eigen::Index dof = m.rows() - 1;
  for (int i = s.body_count - 1; i >= 0; --i)
    for (int k = dof_count(s.joints[static_cast<std::size_t>(i)].type); k > 0; --k, --dof) {
      if (m(dof, dof) > kNone * alone[dof]) {
        for (Eigen::Index row = 0; row < dof; ++row) {
          const double factor = m(row, dof) / m(dof, dof);
          for (Eigen::Index column = 0; column <= row; ++column)
            m(row, column) = m(column, row) -= factor * m(column, dof);
        }
      } else if (found.empty() || found.back() != i) {
        found.push_back(i);
      }
    }
  return found;
}

class Writer : XmlText {
 public:
  explicit Writer(const Skeleton& skeleton)
      : s_(skeleton),
        names_(unique_names(skeleton, {"world"})),  // which is MuJoCo's own
        joint_names_(unique_joint_names(skeleton)),
        children_(simulated_children(skeleton)) {}

  std::string write(std::vector<std::string>& notes) {
    open("mujoco", {{"model", s_.name}});
    compiler();
    element("option", {{"gravity", "0 0 -9.81"}});
    open("default");
    // Bodies touch the floor, which is all that they touch; a contact's friction is the larger of both.
    element("geom", {{"contype", "1"}, {"conaffinity", "0"}, {"rgba", "0.5 0.47 0.44 1"}});
    close();
    open("worldbody");
    element("geom", {{"name", "floor"},
                     {"type", "plane"},
                     {"size", "0 0 0.5"},
                     {"contype", "0"},
                     {"conaffinity", "1"},
                     {"friction", "0 0.005 0.0001"},
                     {"rgba", "0.3 0.32 0.35 1"}});
    for (int i = 0; i < s_.body_count; ++i)
      if (joint(i).parent < 0) body(i);
    close();
    open("actuator");
    for (int i = 0; i < s_.body_count; ++i) motors(i);
    close();
    close();
    for (const int i : joints_without_inertia(s_))
      note(i, "moves no mass against the others at rest, which MuJoCo refuses once something touches");
    notes_.append_to(notes);
    return text();
  }

 private:
  const Joint& joint(int i) const { return s_.joints[static_cast<std::size_t>(i)]; }
  void note(int i, const std::string& what) { notes_.add(names_[static_cast<std::size_t>(i)], what); }

  void compiler() {
    Attributes attributes = {{"angle", "radian"}, {"inertiafromgeom", "false"}};
    const auto is_light = [](const Joint& j) {
      return j.mass < kLeastInertia || Moments(j.inertia).values[0] < kLeastInertia;
    };
    if (std::any_of(s_.joints.begin(), s_.joints.begin() + s_.body_count, is_light)) {
      attributes.emplace_back("boundmass", in_digits(kLeastInertia));
      attributes.emplace_back("boundinertia", in_digits(kLeastInertia));
    }
    element("compiler", attributes);
  }

  void body(int i) {
    const Joint& j = joint(i);
    open("body", {{"name", names_[static_cast<std::size_t>(i)]},
                  {"pos", in_digits(j.rest.translation)},
                  {"quat", in_digits(j.rest.rotation.normalized())}});
    if (j.mass > 0) {
      const Moments moments(j.inertia);
      element("inertial", {{"pos", in_digits(j.center_of_mass)},
                           {"quat", in_digits(moments.axes)},
                           {"mass", in_digits(j.mass)},
                           {"diaginertia", in_digits(moments.values)}});
    }
    joints(i);
    for (const Collider& c : s_.colliders)
      if (c.joint == i) geom(c);
    sites(i);
    for (const int child : children_[static_cast<std::size_t>(i)]) body(child);
    close();
  }

  void joints(int i) {
    const Joint& j = joint(i);
    for (const JointPart& part : parts_of(j)) {
      const std::string name = joint_names_[static_cast<std::size_t>(i)] + part.suffix;
      if (part.kind == Kind::kFree) {
        element("freejoint", {{"name", name}});
        continue;
      }
      const bool ball = part.kind == Kind::kBall;
      const DofLimits* dofs = j.dofs + part.dof;
      Attributes attributes = {{"name", name},
                               {"type", ball                        ? "ball"
                                        : part.kind == Kind::kHinge ? "hinge"
                                                                    : "slide"}};
      if (!ball) attributes.emplace_back("axis", in_digits(part.axis));
      add_range(i, part, attributes);
      if (ball && (dofs[0].damping != dofs[1].damping || dofs[0].damping != dofs[2].damping))
        note(i, "one damping for all axes of a ball joint: their mean");
      const double damping =
          ball ? (dofs[0].damping + dofs[1].damping + dofs[2].damping) / 3 : dofs[0].damping;
      if (damping > 0) attributes.emplace_back("damping", in_digits(damping));
      if (dofs[0].dry_friction > 0 && j.type != JointType::kFree)
        attributes.emplace_back("frictionloss", in_digits(dofs[0].dry_friction));
      element("joint", attributes);
    }
  }

  void add_range(int i, const JointPart& part, Attributes& attributes) {
    const Joint& j = joint(i);
    double lower = j.dofs[part.dof].lower, upper = j.dofs[part.dof].upper;
    if (part.kind == Kind::kBall) {
      lower = 0;
      upper = j.type == JointType::kBall ? largest_angle(j) : std::numbers::pi;
      if (upper >= std::numbers::pi) return;
      note(i, "the largest angle that a ball joint's limits allow bounds it in all directions");
    } else if (lower <= -kUnlimited && upper >= kUnlimited) {
      return;
    }
    attributes.emplace_back("limited", "true");
    attributes.emplace_back("range", in_digits(lower) + " " + in_digits(upper));
  }

  void geom(const Collider& c) {
    Attributes attributes = {{"pos", in_digits(c.local.translation)},
                             {"quat", in_digits(c.local.rotation.normalized())}};
    if (c.shape == Shape::kBox) {
      attributes.emplace_back("type", "box");
      attributes.emplace_back("size", in_digits(c.size));
    } else if (c.shape == Shape::kCapsule && c.size.z() > 0) {
      attributes.emplace_back("type", "capsule");
      attributes.emplace_back("size", in_digits(c.size.x()) + " " + in_digits(c.size.z()));
    } else {
      attributes.emplace_back("type", "sphere");
      attributes.emplace_back("size", in_digits(c.size.x()));
    }
    attributes.emplace_back("friction", in_digits(c.friction) + " 0.005 0.0001");
    element("geom", attributes);
  }

  /// Joints that ride along with a body, where they are at rest.
  void sites(int i) {
    std::vector<Transform<double>> local(s_.joints.size());
    std::vector<bool> rides(s_.joints.size(), false);
    for (std::size_t k = static_cast<std::size_t>(s_.body_count); k < s_.joints.size(); ++k) {
      const int parent = s_.joints[k].parent;
      if (parent < 0) continue;
      const auto above = static_cast<std::size_t>(parent);
      if (parent != i && !rides[above]) continue;
      rides[k] = true;
      local[k] = parent == i ? s_.joints[k].rest : local[above] * s_.joints[k].rest;
      element("site", {{"name", names_[k]},
                       {"pos", in_digits(local[k].translation)},
                       {"quat", in_digits(local[k].rotation.normalized())}});
    }
  }

  void motors(int i) {
    const Joint& j = joint(i);
    if (j.type == JointType::kFree) return;
    if (j.ellipsoidal_limit) note(i, "each axis has its torque limit alone, not an ellipsoid's");
    for (const JointPart& part : parts_of(j)) {
      const bool ball = part.kind == Kind::kBall;
      for (int k = 0; k < (ball ? 3 : 1); ++k) {
        const auto [minus, plus] = s_.torque_limits(i, part.dof + k);
        if (!(minus + plus > 0)) continue;
        const std::string moved = joint_names_[static_cast<std::size_t>(i)] + part.suffix;
        const std::string range = in_digits(-minus) + " " + in_digits(plus);
        Attributes attributes = {{"name", ball ? moved + "_" + std::string(1, "xyz"[k]) : moved},
                                 {"joint", moved}};
        if (ball) attributes.emplace_back("gear", in_digits(Vec3<double>(Vec3<double>::Unit(k))) + " 0 0 0");
        for (const char* what : {"ctrllimited", "forcelimited"}) attributes.emplace_back(what, "true");
        for (const char* what : {"ctrlrange", "forcerange"}) attributes.emplace_back(what, range);
        element("motor", attributes);
      }
    }
  }

  const Skeleton& s_;
  BodyNotes notes_;
  std::vector<std::string> names_, joint_names_;
  std::vector<std::vector<int>> children_;
};

}  // namespace

std::string write_mjcf(const Skeleton& skeleton, std::vector<std::string>& notes) {
  return Writer(skeleton).write(notes);
}

}  // namespace sinew::exporting
