#include "scene/figure.h"

#include <algorithm>
#include <cmath>
#include <deque>
#include <map>
#include <mutex>
#include <numbers>
#include <span>
#include <utility>

#include "scene/bodies.h"
#include "scene/effect_registry.h"
#include "scene/humanoid.h"
#include "sinew/skeleton/convex_hull.h"
#include "sinew/skeleton/rotation.h"

namespace sinew::scene {
namespace {

Shape shape_of(const Reader& in) {
  const std::string shape = in.text("shape", "sphere");
  if (shape == "sphere") return Shape::kSphere;
  if (shape == "capsule") return Shape::kCapsule;
  if (shape == "box") return Shape::kBox;
  if (shape == "convex") return Shape::kConvex;
  fail(in.inside("shape"), "unknown shape '" + shape + "'");
}

/// Corners of an upright prism or cone about the origin.
std::vector<Vec3<double>> prism_of(const Reader& in) {
  const int sides = in.count("sides", 8, 3, ConvexHull::kMostCorners / 2);
  const double radius = in.positive("radius", 0.3), half = in.positive("height", 1) / 2,
               top = in.time("top_radius", radius);
  std::vector<Vec3<double>> points;
  for (int n = 0; n < sides; ++n) {
    const double angle = 2 * std::numbers::pi * n / sides;
    const Vec3<double> out(std::cos(angle), std::sin(angle), 0);
    points.emplace_back(radius * out - half * Vec3<double>::UnitZ());
    if (top > 0 || n == 0) points.emplace_back(top * out + half * Vec3<double>::UnitZ());
  }
  return points;
}

std::vector<Vec3<double>> points_of(const Reader& in) {
  if (in.has("points") == in.has("prism"))
    fail(in.inside("shape"), "a convex shape has points, or is a prism");
  if (in.has("prism"))
    return prism_of(Reader(in.at("prism"), in.inside("prism"), {"sides", "radius", "height", "top_radius"}));
  std::vector<Vec3<double>> points;
  const json& list = in.list("points");
  for (std::size_t n = 0; n < list.size(); ++n)
    points.push_back(Reader::vector_of(list[n], in.item("points", n)));
  return points;
}

const ConvexHull* keep(ConvexHull hull) {
  static std::mutex mutex;
  static std::deque<ConvexHull> kept;
  const std::scoped_lock lock(mutex);
  return &kept.emplace_back(std::move(hull));
}

}  // namespace

void read_shape(const Reader& in, Collider& out) {
  out.shape = shape_of(in);
  if (out.shape != Shape::kConvex) {
    for (const char* key : {"points", "prism"})
      if (in.has(key)) fail(in.inside(key), "only a convex shape has that");
    out.size = in.has("size") && in.at("size").is_number() ? Vec3<double>::Constant(in.positive("size", 1))
                                                           : in.vector("size", out.size);
    return;
  }
  if (in.has("size")) fail(in.inside("size"), "a convex shape has its size from its points");
  ConvexHull hull;
  if (const Status status = ConvexHull::make(points_of(in), hull); !status)
    fail(status.index >= 0 ? in.item("points", static_cast<std::size_t>(status.index)) : in.inside("points"),
         status.reason);
  out.hull = keep(std::move(hull));
  out.size.setConstant(out.hull->inner_radius());
}

namespace {

JointType type_of(const Reader& in, const char* key, JointType otherwise) {
  static const std::map<std::string, JointType> types{
      {"fixed", JointType::kFixed},        {"hinge", JointType::kRevolute}, {"slide", JointType::kPrismatic},
      {"ball", JointType::kBall},          {"planar", JointType::kPlanar},  {"free", JointType::kFree},
      {"universal", JointType::kUniversal}};
  if (!in.has(key)) return otherwise;
  const auto type = types.find(in.text(key, ""));
  if (type == types.end())
    fail(in.inside(key), "a joint is fixed, hinge, slide, universal, ball, planar or free");
  return type->second;
}

/// Largest torques: a number, or [minus, plus].
void read_torque(const json& value, const std::string& where, DofLimits& dof) {
  const bool two = value.is_array() && value.size() == 2;
  dof.torque_minus = Reader::number_of(two ? value[0] : value, where);
  dof.torque_plus = Reader::number_of(two ? value[1] : value, where);
}

/// Of one degree of freedom after the other; a lone value is for all of them.
template <class Read>
void read_dofs(const Reader& in, const char* key, std::span<DofLimits> dofs, Read read) {
  if (!in.has(key)) return;
  const json& value = in.at(key);
  for (std::size_t k = 0; k < dofs.size(); ++k) {
    if (value.is_array() && k >= value.size()) fail(in.inside(key), "an entry for each degree of freedom");
    read(value.is_array() ? value[k] : value, in.inside(key), dofs[k]);
  }
}

Collider read_collider(const json& value, const std::string& where, int joint) {
  const Reader in(value, where, {"shape", "size", "points", "prism", "position", "friction", "restitution"});
  Collider c;
  c.joint = joint;
  read_shape(in, c);
  c.local.translation = in.vector("position", Vec3<double>::Zero());
  c.friction = in.time("friction", c.friction);
  c.restitution = in.time("restitution", c.restitution);
  return c;
}

/// What a joint's entry says, beside its name, parent and type.
const std::vector<const char*> kJointKeys{"at",           "axis",   "mass",        "center",
                                          "inertia",      "rod",    "torque",      "damping",
                                          "dry_friction", "limits", "ellipsoidal", "colliders"};

void read_joint(const Reader& in, int index, Skeleton& s) {
  Joint& joint = s.joints[index];
  joint.rest.translation = in.vector("at", joint.rest.translation);
  joint.axis = in.vector("axis", joint.axis);
  if (in.has("mass")) {
    const double mass = in.time("mass", 0);
    if (joint.mass > 0) joint.inertia *= mass / joint.mass;  // the same body, denser
    joint.mass = mass;
  }
  joint.center_of_mass = in.vector("center", joint.center_of_mass);
  if (in.has("inertia")) joint.inertia = in.vector("inertia", Vec3<double>::Zero()).asDiagonal();
  if (in.has("rod")) {
    const Reader rod(in.at("rod"), in.inside("rod"), {"to", "radius"});
    const Vec3<double> to = rod.vector("to", Vec3<double>::Zero());
    if (!(to.norm() > 0)) fail(rod.inside("to"), "must not be zero");
    joint.center_of_mass = to / 2;
    joint.inertia = rod_inertia(joint.mass, to, rod.time("radius", 0));
  }
  const std::span<DofLimits> dofs(joint.dofs, static_cast<std::size_t>(dof_count(joint.type)));
  read_dofs(in, "torque", dofs, read_torque);
  read_dofs(in, "damping", dofs,
            [](const json& v, const std::string& w, DofLimits& d) { d.damping = Reader::number_of(v, w); });
  read_dofs(in, "dry_friction", dofs, [](const json& v, const std::string& w, DofLimits& d) {
    d.dry_friction = Reader::number_of(v, w);
  });
  read_dofs(in, "limits", dofs, [](const json& v, const std::string& w, DofLimits& d) {
    if (!v.is_array() || v.size() != 2) fail(w, "expected [[lower, upper], …]");
    d.lower = Reader::number_of(v[0], w);
    d.upper = Reader::number_of(v[1], w);
  });
  joint.ellipsoidal_limit = in.flag("ellipsoidal", joint.ellipsoidal_limit);
  const json& colliders = in.list("colliders");
  for (std::size_t i = 0; i < colliders.size(); ++i)
    s.colliders.push_back(read_collider(colliders[i], in.item("colliders", i), index));
}

Skeleton joints_of(const Reader& in) {
  Skeleton s;
  s.name = "figure";
  std::vector<const char*> keys = kJointKeys;
  keys.insert(keys.end(), {"name", "parent", "type"});
  const json& joints = in.list("joints");
  for (std::size_t i = 0; i < joints.size(); ++i) {
    const Reader entry(joints[i], in.item("joints", i), keys);
    Joint& joint = s.joints.emplace_back();
    joint.name = entry.text("name", "joint" + std::to_string(i));
    joint.parent = entry.has("parent") ? joint_of(s, entry.text("parent", ""), entry.inside("parent")) : -1;
    joint.type = type_of(entry, "type", JointType::kFree);
    for (DofLimits& dof : joint.dofs) dof.dry_friction = 0;
    read_joint(entry, static_cast<int>(i), s);
  }
  s.body_count = static_cast<int>(s.joints.size());
  return s;
}

Skeleton chain_of(const Reader& in) {
  ChainShape shape;
  shape.links = in.count("links", shape.links, 1, 1000);
  shape.joint = type_of(in, "joint", shape.joint);
  shape.root = type_of(in, "root", shape.root);
  shape.length = in.positive("length", shape.length);
  shape.first_mass = in.positive("first_mass", shape.first_mass);
  shape.last_mass = in.positive("last_mass", shape.last_mass);
  shape.radius = in.positive("radius", shape.radius);
  shape.colliders = in.flag("colliders", shape.colliders);
  return chain(shape);
}

Skeleton kind_of(const json& value, const std::string& where) {
  const std::string kind = value.is_object() && value.contains("kind") && value["kind"].is_string()
                               ? value["kind"].get<std::string>()
                               : "joints";
  const auto reader = [&](std::vector<const char*> keys) {
    keys.insert(keys.end(), {"kind", "change", "frictionless", "muscles"});
    return Reader(value, where, keys);
  };
  if (kind == "joints") return joints_of(reader({"joints"}));
  if (kind == "chain")
    return chain_of(
        reader({"links", "joint", "root", "length", "first_mass", "last_mass", "radius", "colliders"}));
  if (kind == "humanoid") return reader({}), humanoid();
  if (kind == "box") {
    const Reader in = reader({"mass", "size", "friction"});
    return box_body(in.positive("mass", 1), in.vector("size", Vec3<double>::Constant(0.1)),
                    in.time("friction", 0.8));
  }
  if (kind == "ball") {
    const Reader in = reader({"mass", "radius", "friction"});
    return ball_body(in.positive("mass", 1), in.positive("radius", 0.1), in.time("friction", 0.8));
  }
  fail(where + ".kind", "a figure is a box, a ball, a chain, a humanoid or joints");
}

}  // namespace

Skeleton read_figure(const json& value, const std::string& where) {
  Skeleton s = kind_of(value, where);
  std::vector<const char*> known;  // kind_of has looked
  for (const auto& [key, v] : value.items()) known.push_back(key.c_str());
  const Reader in(value, where, known);
  if (in.flag("frictionless", false)) make_frictionless(s);
  const json& changes = in.list("change");
  std::vector<const char*> keys = kJointKeys;
  keys.push_back("joint");
  for (std::size_t i = 0; i < changes.size(); ++i) {
    const Reader change(changes[i], in.item("change", i), keys);
    read_joint(change, joint_of(s, change.text("joint", ""), change.inside("joint")), s);
  }
  const json& muscles = in.list("muscles");
  for (std::size_t i = 0; i < muscles.size(); ++i) {
    const Reader muscle(muscles[i], in.item("muscles", i), {"name", "group", "joint", "dof", "torque"});
    DofLimits both;
    if (muscle.has("torque")) read_torque(muscle.at("torque"), muscle.inside("torque"), both);
    s.muscles.push_back({muscle.text("name", ""), muscle.text("group", ""),
                         joint_of(s, muscle.text("joint", ""), muscle.inside("joint")),
                         muscle.count("dof", 0, 0, 5), both.torque_minus, both.torque_plus});
  }
  if (const Status status = validate(s); !status) fail(where, status.reason);
  return s;
}

}  // namespace sinew::scene
