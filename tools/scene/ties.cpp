#include "scene/ties.h"

#include <algorithm>
#include <map>
#include <set>

#include "scene/effect_registry.h"
#include "sinew/effects/cloth.h"
#include "sinew/effects/soft_tissue.h"
#include "sinew/effects/strand.h"
#include "sinew/skeleton/rotation.h"

namespace sinew::scene {
namespace {

/// Turns the model's axes at rest (X forward, Z up) into a joint's.
Quat<double> into_joint(const Skeleton& skeleton, int joint) {
  Quat<double> model = Quat<double>::Identity();
  for (int j = joint; j >= 0; j = skeleton.joints[j].parent) model = skeleton.joints[j].rest.rotation * model;
  return model.conjugate();
}

int prop_named(const Scene& scene, const json& v, const std::string& where) {
  for (std::size_t p = 0; p < scene.props.size(); ++p)
    if (v.is_string() ? scene.props[p].name == v.get<std::string>() : v == json(p))
      return static_cast<int>(p);
  fail(where, "unknown prop " + v.dump());
}

/// Where something is fixed: `character` and `joint`, or `prop`, or the world; `at`, m, from there along the
/// model's axes at rest; `axis`: what the frame's z axis is.
Anchor read_anchor(const json& entry, const std::string& where, const Scene& scene) {
  const Reader in(entry, where, {"character", "joint", "prop", "at", "axis"});
  Anchor anchor;
  Quat<double> turn = Quat<double>::Identity();
  if (in.has("prop")) {
    anchor.kind = AnchorKind::kProp;
    anchor.index = prop_named(scene, in.at("prop"), in.inside("prop"));
  } else if (in.has("character") && !in.has("joint")) {
    fail(where, "names a character but no joint of it");
  } else if (in.has("joint")) {
    anchor.kind = AnchorKind::kCharacter;
    anchor.index =
        in.has("character") ? character_named(scene, in.at("character"), in.inside("character")) : 0;
    const Skeleton& skeleton = scene.characters[anchor.index].asset->skeleton;
    anchor.joint = joint_of(skeleton, in.text("joint", ""), in.inside("joint"));
    turn = into_joint(skeleton, anchor.joint);
  }
  const Vec3<double> axis = in.vector("axis", Vec3<double>::UnitZ());
  if (!(axis.norm() > 0)) fail(in.inside("axis"), "must not be zero");
  anchor.frame.translation = turn * in.vector("at", Vec3<double>::Zero());
  anchor.frame.rotation = turn * rotation_between<double>(Vec3<double>::UnitZ(), axis);
  return anchor;
}

ParticleBody read_strand(const Reader& in, const Anchor& on) {
  StrandSettings s;
  s.frame = on;
  s.direction = in.vector("direction", s.direction);
  s.length = in.positive("length", s.length);
  s.particles = in.count("particles", s.particles, 1, 500);
  s.mass = in.positive("mass", s.mass);
  s.stretch = in.positive("stretch", s.stretch);
  s.bending = in.time("bending", s.bending);
  s.clamped = in.flag("clamped", s.clamped);
  return make_strand(s);
}

ParticleBody read_cloth(const Reader& in, const Anchor& on) {
  ClothSettings s;
  s.frame = on;
  const double width = in.positive("width", 0.5), height = in.positive("height", 0.5);
  const int columns = in.count("columns", 8, 1, 100), rows = in.count("rows", 8, 1, 100);
  make_grid(width, height, columns, rows, s);
  const std::string fixed = in.text("fixed", "top");
  if (fixed != "top" && fixed != "corners") fail(in.inside("fixed"), "is top or corners");
  for (int c = 0; c <= columns; ++c)
    if (fixed == "top" || c == 0 || c == columns) s.fixed.push_back(c);
  // `on` is the middle of the upper edge, `across` the direction of the edge.
  const Vec3<double> across = in.vector("across", Vec3<double>::UnitY()).normalized();
  for (Vec3<double>& x : s.positions) x = (x.x() - width / 2) * across + Vec3<double>(0, 0, x.z());
  s.density = in.positive("density", s.density);
  s.stretch = in.positive("stretch", s.stretch);
  s.bending = in.time("bending", s.bending);
  return make_cloth(s);
}

ParticleBody read_soft_tissue(const Reader& in, const Anchor& on) {
  SoftTissueSettings s;
  s.frame = on;
  const Vec3<double> size = in.vector("size", {0.3, 0.1, 0.1});
  const Vec3<double> cells = in.vector("cells", {4, 2, 2});
  if (size.minCoeff() <= 0) fail(in.inside("size"), "must be positive");
  if (cells.minCoeff() < 1 || cells.maxCoeff() > 30 || cells != cells.array().round().matrix())
    fail(in.inside("cells"), "must be whole numbers from 1 to 30");
  make_block(size, {int(cells.x()), int(cells.y()), int(cells.z())}, s);
  // Held by the face at its back, whose middle is at `on`.
  for (std::size_t n = 0; n < s.positions.size(); ++n) {
    if (s.positions[n].x() == 0) s.fixed.push_back(static_cast<int>(n));
    s.positions[n] -= Vec3<double>(0, size.y() / 2, size.z() / 2);
  }
  s.density = in.positive("density", s.density);
  s.young = in.positive("young", s.young);
  s.poisson = in.time("poisson", s.poisson);
  return make_soft_tissue(s);
}

}  // namespace

LoopSettings read_loop(const json& entry, const std::string& where, const Scene& scene) {
  const Reader in(entry, where, {"kind", "a", "b", "length", "stiffness", "collide"});
  LoopSettings loop;
  const std::string kind = in.text("kind", "point");
  const char* kinds[] = {"point", "hinge", "weld", "rod", "rope"};
  const auto found = std::find(std::begin(kinds), std::end(kinds), kind);
  if (found == std::end(kinds)) fail(in.inside("kind"), "is point, hinge, weld, rod or rope");
  loop.kind = static_cast<LoopKind>(found - std::begin(kinds));
  loop.a = read_anchor(in.at("a"), in.inside("a"), scene);
  loop.b = read_anchor(in.at("b"), in.inside("b"), scene);
  loop.length = in.time("length", 0);
  loop.stiffness = in.time("stiffness", 0);
  loop.collide = in.flag("collide", false);
  if (const Status status = check(loop); !status) fail(where, status.reason);
  return loop;
}

ParticleBody read_particles(const json& entry, const std::string& where, const Scene& scene) {
  if (!entry.is_object() || !entry.contains("kind") || !entry["kind"].is_string())
    fail(where, "expected an object with 'kind'");
  const std::string kind = entry["kind"];
  std::vector<const char*> keys{"kind", "name", "on", "radius", "friction", "damping"};
  const auto with = [&](std::initializer_list<const char*> more) { keys.insert(keys.end(), more); };
  if (kind == "strand") with({"direction", "length", "particles", "mass", "stretch", "bending", "clamped"});
  if (kind == "cloth")
    with({"width", "height", "columns", "rows", "fixed", "across", "density", "stretch", "bending"});
  if (kind == "soft_tissue") with({"size", "cells", "density", "young", "poisson"});
  const Reader in(entry, where, keys);
  const Anchor on = in.has("on") ? read_anchor(in.at("on"), in.inside("on"), scene) : Anchor();
  ParticleBody body;
  if (kind == "strand")
    body = read_strand(in, on);
  else if (kind == "cloth")
    body = read_cloth(in, on);
  else if (kind == "soft_tissue")
    body = read_soft_tissue(in, on);
  else
    fail(in.inside("kind"), "is strand, cloth or soft_tissue");
  body.name = in.text("name", kind);
  body.radius = in.time("radius", body.radius);
  body.friction = in.time("friction", body.friction);
  body.damping = in.time("damping", body.damping);
  if (const Status status = check(body); !status) fail(where, status.reason);
  return body;
}

std::vector<std::array<int, 2>> drawn_edges(const ParticleBody& body) {
  std::set<std::array<int, 2>> edges;
  for (const Stencil<double>& e : body.stencils)
    if (e.count == 2) edges.insert({e.node[0], e.node[1]});
  std::map<std::array<int, 3>, int> faces;  // those on the surface belong to one tetrahedron
  for (const Tetrahedron<double>& e : body.tetrahedra)
    for (int apart = 0; apart < 4; ++apart) {
      std::array<int, 3> face{};
      for (int i = 0, n = 0; i < 4; ++i)
        if (i != apart) face[n++] = e.node[i];
      std::sort(face.begin(), face.end());
      ++faces[face];
    }
  for (const auto& [face, count] : faces)
    if (count == 1) edges.insert({{face[0], face[1]}, {face[1], face[2]}, {face[0], face[2]}});
  return {edges.begin(), edges.end()};
}

}  // namespace sinew::scene
