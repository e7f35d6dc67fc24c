#include <console_bridge/console.h>
#include <urdf_model/model.h>
#include <urdf_parser/urdf_parser.h>

#include <cmath>
#include <set>
#include <stdexcept>

#include "import/readers.h"
#include "import/text.h"

namespace sinew::import {
namespace {

/// urdfdom complains on the console and still returns a model with parts left out: its words are collected.
class Collector : public console_bridge::OutputHandler {
 public:
  void log(const std::string& text, console_bridge::LogLevel level, const char*, int) override {
    if (level >= console_bridge::CONSOLE_BRIDGE_LOG_WARN) messages.push_back(text);
    const bool says_something = text.find("is not initialized correctly") == std::string::npos;
    if (level >= console_bridge::CONSOLE_BRIDGE_LOG_ERROR && says_something)
      errors += (errors.empty() ? "" : "; ") + text;
  }
  std::vector<std::string> messages;
  std::string errors;  ///< the cause first, then where it stands
};

Transform<double> transform_of(const urdf::Pose& pose) {
  Transform<double> x;
  x.translation = {pose.position.x, pose.position.y, pose.position.z};
  x.rotation = Quat<double>(pose.rotation.w, pose.rotation.x, pose.rotation.y, pose.rotation.z);
  x.rotation.normalize();
  return x;
}

JointType type_of(const urdf::Joint& joint) {
  switch (joint.type) {
    case urdf::Joint::REVOLUTE:
    case urdf::Joint::CONTINUOUS:
      return JointType::kRevolute;
    case urdf::Joint::PRISMATIC:
      return JointType::kPrismatic;
    case urdf::Joint::FLOATING:
      return JointType::kFree;
    case urdf::Joint::PLANAR:
      return JointType::kPlanar;
    case urdf::Joint::FIXED:
      return JointType::kFixed;
    default:
      throw std::runtime_error("joint '" + joint.name + "' has an unknown type");
  }
}

void add_shape(const urdf::GeometrySharedPtr& geometry, const urdf::Pose& origin, bool collision,
               SourceUrdfLink& link) {
  if (!geometry) return;
  SourceUrdfLink::Geometry shape;
  shape.origin = transform_of(origin);
  shape.collision = collision;
  switch (geometry->type) {
    case urdf::Geometry::SPHERE: {
      shape.shape = Shape::kSphere;
      shape.size.setConstant(std::dynamic_pointer_cast<urdf::Sphere>(geometry)->radius);
      break;
    }
    case urdf::Geometry::BOX: {
      const auto box = std::dynamic_pointer_cast<urdf::Box>(geometry);
      shape.size = {box->dim.x / 2, box->dim.y / 2, box->dim.z / 2};
      break;
    }
    case urdf::Geometry::CYLINDER: {
      const auto cylinder = std::dynamic_pointer_cast<urdf::Cylinder>(geometry);
      shape.shape = Shape::kCapsule;
      shape.size = {cylinder->radius, cylinder->radius,
                    std::max(0.0, cylinder->length / 2 - cylinder->radius)};
      break;
    }
    case urdf::Geometry::MESH: {
      const auto mesh = std::dynamic_pointer_cast<urdf::Mesh>(geometry);
      link.meshes.push_back(
          {clean_text(mesh->filename), shape.origin, {mesh->scale.x, mesh->scale.y, mesh->scale.z}});
      link.meshes.back().collision = collision;
      return;
    }
  }
  link.shapes.push_back(shape);
}

/// Colours of robots are those of a screen (sRGB, IEC 61966-2-1).
std::array<float, 4> linear(const urdf::Color& c) {
  const auto channel = [](float v) {
    return v <= 0.04045f ? v / 12.92f : std::pow((v + 0.055f) / 1.055f, 2.4f);
  };
  return {channel(c.r), channel(c.g), channel(c.b), c.a};
}

void add_visual(const urdf::Visual& visual, SourceUrdfLink& link) {
  const std::size_t meshes = link.meshes.size();
  add_shape(visual.geometry, visual.origin, false, link);
  if (visual.material && link.meshes.size() > meshes)
    link.meshes.back().color = linear(visual.material->color);
}

/// A joint that has one position only stands there at rest.
void place_locked(SourceUrdfLink& link) {
  if (link.type == JointType::kRevolute)
    link.origin.rotation *= Quat<double>(Eigen::AngleAxisd(link.lower, link.axis.normalized()));
  else if (link.type == JointType::kPrismatic)
    link.origin.translation += link.origin.rotation * (link.lower * link.axis.normalized());
}

void read_joint(const urdf::Joint& joint, SourceUrdfLink& link) {
  link.joint_name = joint.name;
  link.type = type_of(joint);
  link.origin = transform_of(joint.parent_to_joint_origin_transform);
  link.axis = {joint.axis.x, joint.axis.y, joint.axis.z};
  if (joint.limits) {
    link.has_limits = joint.type != urdf::Joint::CONTINUOUS;
    link.lower = joint.limits->lower;
    link.upper = joint.limits->upper;
    link.effort = joint.limits->effort;
    link.velocity = joint.limits->velocity;
    if (link.has_limits && link.lower > link.upper)
      throw std::runtime_error("joint '" + joint.name + "' has its lower limit above its upper");
  }
  if (joint.dynamics) {
    link.damping = joint.dynamics->damping;
    link.friction = joint.dynamics->friction;
  }
  if (joint.mimic) {
    link.mimic_joint = joint.mimic->joint_name;
    link.mimic_multiplier = joint.mimic->multiplier;
    link.mimic_offset = joint.mimic->offset;
    if (link.mimic_joint == joint.name) throw std::runtime_error("joint '" + joint.name + "' mimics itself");
  }
  if (link.type != JointType::kFixed && link.type != JointType::kFree && link.axis.norm() < 1e-9)
    throw std::runtime_error("joint '" + joint.name + "' has an axis of length zero");
  if (link.has_limits && link.lower == link.upper) place_locked(link);
}

void read_inertial(const urdf::Inertial& inertial, SourceUrdfLink& link) {
  link.has_inertial = true;
  link.mass = inertial.mass;
  if (!(link.mass >= 0)) throw std::runtime_error("link '" + link.name + "' has a negative mass");
  link.inertial_origin = transform_of(inertial.origin);
  link.inertia << inertial.ixx, inertial.ixy, inertial.ixz, inertial.ixy, inertial.iyy, inertial.iyz,
      inertial.ixz, inertial.iyz, inertial.izz;
}

}  // namespace

SourceScene read_urdf(const std::string& content, const ReadLimits& limits) {
  if (content.find("<xacro:") != std::string::npos || content.find("=\"${") != std::string::npos)
    throw std::runtime_error("it still holds xacro macros; expand them first");
  Collector collector;
  console_bridge::useOutputHandler(&collector);
  // Its names cannot be cleaned one by one: links and joints refer to each other by them.
  const urdf::ModelInterfaceSharedPtr model =
      urdf::parseURDF(is_utf8(content) ? content : clean_text(content));
  console_bridge::restorePreviousOutputHandler();
  if (!model)
    throw std::runtime_error(collector.errors.empty() ? "urdfdom cannot read it" : collector.errors);
  if (collector.errors.find("Could not parse inertial") != std::string::npos)
    throw std::runtime_error(collector.errors);  // shapes may be left out, masses not
  SourceScene scene;
  scene.format = "urdf";
  scene.name = model->getName();
  scene.meters_per_unit = 1;
  scene.up_axis = 2;
  std::set<std::string> noted;
  for (const std::string& message : collector.messages)
    if (noted.insert(message).second) scene.notes.push_back(clean_text("urdfdom: " + message));

  struct Open {
    urdf::LinkConstSharedPtr link;
    int parent, depth;
  };
  if (!model->getRoot()) throw std::runtime_error("it has no root link");
  std::vector<Open> stack{{model->getRoot(), -1, 0}};
  std::set<std::string> seen;
  while (!stack.empty()) {
    const Open open = stack.back();
    stack.pop_back();
    if (!seen.insert(open.link->name).second)
      throw std::runtime_error("link '" + open.link->name + "' is its own ancestor, or has two parents");
    if (open.depth > limits.max_depth || static_cast<int>(scene.links.size()) > limits.max_nodes)
      throw std::runtime_error("too many links");
    SourceUrdfLink link;
    link.name = open.link->name;
    link.parent = open.parent;
    if (open.link->parent_joint) read_joint(*open.link->parent_joint, link);
    if (open.link->inertial) read_inertial(*open.link->inertial, link);
    for (const auto& c : open.link->collision_array) add_shape(c->geometry, c->origin, true, link);
    for (const auto& v : open.link->visual_array) add_visual(*v, link);
    const int index = static_cast<int>(scene.links.size());
    scene.links.push_back(link);
    for (auto child = open.link->child_links.rbegin(); child != open.link->child_links.rend(); ++child)
      stack.push_back({*child, index, open.depth + 1});
  }
  for (const auto& [name, link] : model->links_)
    if (!seen.count(name))
      throw std::runtime_error("link '" + name + "' hangs in a loop and not on the root");
  for (const SourceUrdfLink& l : scene.links)
    if (!l.mimic_joint.empty() && !model->getJoint(l.mimic_joint))
      throw std::runtime_error("joint '" + l.joint_name + "' mimics '" + l.mimic_joint +
                               "', which does not exist");
  return scene;
}

}  // namespace sinew::import
