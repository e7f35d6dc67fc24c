#include "convert/urdf_body.h"

#include <algorithm>
#include <cmath>

#include "convert/body.h"
#include "convert/shapes.h"
#include "convert/urdf_skin.h"
#include "sinew/skeleton/principal_axes.h"
#include "sinew/skeleton/rotation.h"

namespace sinew::convert {
namespace {

using import::SourceUrdfLink;

/// Nearest inertia that a body can have: principal moments raised until none exceeds the sum of the others.
bool repair_inertia(Mat3<double>& inertia) {
  const auto [moments, axes] = principal_axes(inertia);
  Vec3<double> m = moments;
  const Vec3<double> before = m;
  const double floor = 1e-9 * std::max(1e-9, m.cwiseAbs().maxCoeff());
  m = m.cwiseMax(floor);
  if (m[2] > m[0] + m[1]) m[0] = m[2] - m[1];
  if (before[0] >= -1e-12 * m[2] && before[0] + before[1] >= before[2] * (1 - 1e-9)) return false;
  inertia = axes * m.asDiagonal() * axes.transpose();
  inertia = 0.5 * (inertia + inertia.transpose()).eval();
  return true;
}

/// Unit vector to the link that hangs farthest from it; up where none does.
Vec3<double> along(int index, const std::vector<SourceUrdfLink>& links) {
  Vec3<double> farthest = Vec3<double>::Zero();
  for (const SourceUrdfLink& child : links)
    if (child.parent == index && child.origin.translation.norm() > farthest.norm())
      farthest = child.origin.translation;
  return farthest.norm() > 1e-9 ? Vec3<double>(farthest.normalized()) : Vec3<double>(Vec3<double>::UnitZ());
}

/// What a link collides with: its primitives; else a shape around its mesh; else capsules to the child
/// joints, which show where the link is.
void add_shapes(const SourceUrdfLink& link, int index, const std::vector<SourceUrdfLink>& links,
                const std::vector<Vec3<double>>& vertices, Skeleton& out) {
  bool collision = false;
  for (const auto& g : link.shapes) collision = collision || g.collision;
  for (const auto& g : link.shapes)
    if (g.collision == collision) out.colliders.push_back({index, g.shape, g.origin, g.size, 0.8});
  if (!link.shapes.empty()) return;
  if (vertices.size() > 1) {
    out.colliders.push_back(fit_part(vertices, along(index, links)));
    out.colliders.back().joint = index;
    return;
  }
  for (const SourceUrdfLink& child : links) {
    if (child.parent != index || child.origin.translation.norm() < 0.02) continue;
    Collider c;
    c.joint = index;
    c.shape = Shape::kCapsule;
    const double length = child.origin.translation.norm(), radius = std::min(0.04, 0.2 * length);
    c.size = {radius, radius, std::max(0.0, length / 2 - radius)};
    c.local.translation = child.origin.translation / 2;
    c.local.rotation = rotation_between<double>(Vec3<double>::UnitZ(), child.origin.translation);
    out.colliders.push_back(c);
  }
}

}  // namespace

Error build_urdf(const import::SourceScene& scene, const Options& options, Asset& out,
                 nlohmann::json& report) {
  Skeleton s;
  s.name = scene.name;
  report["notes"] = scene.notes;
  const auto note = [&](const std::string& text) { report["notes"].push_back(text); };
  const int count = static_cast<int>(scene.links.size());
  std::vector<double> subtree(count, 0);
  for (int i = count - 1; i >= 0; --i) {
    subtree[i] += scene.links[i].mass;
    if (scene.links[i].parent >= 0) subtree[scene.links[i].parent] += subtree[i];
  }
  if (subtree[0] <= 0) return {"no link has a mass"};
  const std::vector<std::vector<Vec3<double>>> vertices = link_vertices(scene);
  const bool bolted = !options.free_base || scene.links[0].name == "world";
  for (int i = 0; i < count; ++i) {
    const SourceUrdfLink& link = scene.links[i];
    Joint joint;
    joint.name = link.name;
    joint.source_joint = link.joint_name;
    joint.parent = link.parent;
    joint.rest = link.origin;
    joint.type = i == 0 ? (bolted ? JointType::kFixed : JointType::kFree) : link.type;
    if (link.axis.norm() > 1e-9) joint.axis = link.axis.normalized();
    if (link.type != JointType::kFixed && i > 0 && std::abs(link.axis.norm() - 1) > 1e-6)
      note("joint '" + link.joint_name + "': axis of length " + std::to_string(link.axis.norm()) +
           " normalised");
    joint.mass = link.mass;
    joint.center_of_mass = link.inertial_origin.translation;
    const Mat3<double> r = link.inertial_origin.rotation.toRotationMatrix();
    joint.inertia = link.inertial_origin.rotation.isApprox(Quat<double>::Identity(), 0)
                        ? link.inertia
                        : Mat3<double>(r * link.inertia * r.transpose());
    joint.inertia = 0.5 * (joint.inertia + joint.inertia.transpose()).eval();
    if (link.mass > 0 && repair_inertia(joint.inertia)) {
      if (options.strict) return {"link '" + link.name + "' has an inertia that no body can have"};
      note("link '" + link.name + "': inertia that no body can have; smallest principal moment raised");
    }
    if (link.mass <= 0) joint.inertia.setZero();
    if (dof_count(joint.type) > 0 && subtree[i] <= 0) {
      if (options.strict) return {"joint '" + link.joint_name + "' moves no mass"};
      note("joint '" + link.joint_name + "' moves no mass; fixed");
      joint.type = JointType::kFixed;
    }
    if (link.has_limits && joint.type != JointType::kFixed && link.lower == link.upper) {
      note("joint '" + link.joint_name + "' is locked (lower limit equals upper); fixed there");
      joint.type = JointType::kFixed;
    }
    if (link.has_limits && joint.type != JointType::kFixed && (link.lower > 0 || link.upper < 0))
      note("joint '" + link.joint_name + "': zero is outside its limits");
    if (!link.mimic_joint.empty())
      note("joint '" + link.joint_name + "' mimics '" + link.mimic_joint +
           "'; simulated as a joint of its own");
    for (int k = 0; k < dof_count(joint.type); ++k) {
      DofLimits& dof = joint.dofs[k];
      dof.dry_friction = link.friction;
      dof.damping = link.damping;
      if (link.has_limits) {
        dof.lower = link.lower;
        dof.upper = link.upper;
      }
      dof.torque_minus = dof.torque_plus = link.effort > 0 ? link.effort : 20 * subtree[i] * 9.81 * 0.05;
    }
    if (i > 0 && dof_count(joint.type) > 0 && link.effort <= 0)
      note("joint '" + link.joint_name + "': no effort limit; taken from the mass it moves");
    add_shapes(link, i, scene.links, vertices[static_cast<std::size_t>(i)], s);
    s.joints.push_back(joint);
  }
  int bare = 0;
  for (int i = 0; i < count; ++i) {
    const SourceUrdfLink& link = scene.links[i];
    bare += !link.meshes.empty() && link.shapes.empty() && vertices[static_cast<std::size_t>(i)].empty();
  }
  if (bare > 0)
    note(std::to_string(bare) +
         " links have meshes only, which are not there; capsules along the links instead");
  s.body_count = count;
  report["total_mass_kg"] = s.total_mass();
  out.skeleton = std::move(s);
  add_urdf_skin(scene, report, out);
  return {};
}

}  // namespace sinew::convert
