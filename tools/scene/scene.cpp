#include "scene/scene.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <optional>
#include <set>
#include <stdexcept>

#include "convert/roles.h"
#include "graph/compile.h"
#include "import/plain_words.h"
#include "scene/effect_registry.h"
#include "scene/figure.h"
#include "scene/presets.h"
#include "scene/reader.h"
#include "scene/ties.h"
#include "sinew/skeleton/rotation.h"

namespace sinew::scene {
namespace {

using nlohmann::json;

constexpr double kRadians = 3.14159265358979323846 / 180;  ///< of a degree

RootDrive drive_of(const json& v, const std::string& where) {
  const std::string text = v.is_string() ? v.get<std::string>() : "";
  if (text == "kinematic") return RootDrive::kKinematic;
  if (text == "assisted") return RootDrive::kAssisted;
  if (text == "free") return RootDrive::kFree;
  if (text == "grounded") return RootDrive::kGrounded;
  fail(where, "root drive is kinematic, assisted, grounded or free");
}

Tone tone_of(const json& v, const std::string& where) {
  Tone tone = Tone::kRigid;
  const Status status = tone_named(v.is_string() ? v.get<std::string>().c_str() : "", tone);
  if (!status) fail(where, status.reason);
  return tone;
}

double strength_of(const json& v, const std::string& where) {
  const double s = Reader::number_of(v, where);
  if (s < 0) fail(where, "strength must not be negative");
  return s;
}

/// [[time, value], …], or one value for good.
template <class Value, class Convert>
Timeline<Value> timeline(const Reader& in, const char* key, Timeline<Value> otherwise, Convert convert) {
  if (!in.has(key)) return otherwise;
  const json& lone = in.at(key);
  if (!lone.is_array() || (!lone.empty() && !lone[0].is_array())) return {{0, convert(lone, in.inside(key))}};
  Timeline<Value> out;
  const json& list = in.list(key);
  for (std::size_t i = 0; i < list.size(); ++i) {
    const std::string where = in.item(key, i);
    if (!list[i].is_array() || list[i].size() != 2) fail(where, "expected [time, value]");
    const double t = Reader::number_of(list[i][0], where);
    if (t < 0 || (!out.empty() && t < out.back().first)) fail(where, "times must rise from 0");
    out.emplace_back(t, convert(list[i][1], where));
  }
  if (out.empty()) fail(in.inside(key), "is empty");
  return out;
}

/// A file, or a skeleton that the scene describes itself.
std::shared_ptr<const Asset> read_asset(const Reader& in, const std::filesystem::path& base) {
  auto asset = std::make_shared<Asset>();
  if (in.has("figure")) {
    if (in.has("asset")) fail(in.inside("figure"), "there is an asset too");
    asset->skeleton = read_figure(in.at("figure"), in.inside("figure"));
    return asset;
  }
  const auto path_of = [&](const json& name) {
    if (!name.is_string()) fail(in.inside("asset"), "expected a file name, or several");
    const std::filesystem::path path = name.get<std::string>();
    return (path.is_relative() ? base / path : path).string();
  };
  const json& files = in.at("asset");
  const json options = in.has("options") ? in.at("options") : json();
  json report;
  convert::Error error;
  if (files.is_array()) {
    std::vector<std::string> paths;
    for (const json& name : files) paths.push_back(path_of(name));
    error = convert::convert_files(paths, options, *asset, report);
  } else {
    error = convert::open_any(path_of(files), options, *asset, report);
  }
  if (error) fail(in.inside("asset"), error.message);
  return asset;
}

/// How a character without clips moves, and how fast it is at first.
void read_motion(const Reader& in, const Skeleton& skeleton, SceneCharacter& c) {
  c.path = timeline<Vec3<double>>(in, "path", {}, Reader::vector_of);
  c.turn_rate = timeline<double>(in, "turn_rate", {}, Reader::number_of);
  const auto named = [&](const char* key, const auto& take) {
    if (!in.has(key)) return;
    if (!in.at(key).is_object()) fail(in.inside(key), "expected joints and what they do");
    std::vector<const char*> joints;
    for (const auto& [name, v] : in.at(key).items()) joints.push_back(name.c_str());
    const Reader entry(in.at(key), in.inside(key), joints);
    for (const char* name : joints) take(entry, name, joint_of(skeleton, name, entry.inside(name)));
  };
  named("pose", [&](const Reader& entry, const char* name, int joint) {
    c.pose.emplace_back(joint, timeline<Vec3<double>>(entry, name, {}, Reader::vector_of));
  });
  if ((!c.clips.empty() || c.graph.graph) && !(c.path.empty() && c.turn_rate.empty() && c.pose.empty()))
    fail(in.inside("clips"), "a character that plays clips or a graph has no path, turn_rate or pose");
  named("spin", [&](const Reader& entry, const char* name, int joint) {
    c.speeds.spin.emplace_back(joint, entry.vector(name, Vec3<double>::Zero()));
  });
  c.speeds.velocity = in.vector("velocity", c.speeds.velocity);
  if (in.has("random_spin")) {
    const Reader random(in.at("random_spin"), in.inside("random_spin"), {"rms", "seed"});
    c.speeds.random = random.time("rms", 1);
    c.speeds.seed = static_cast<unsigned>(random.count("seed", 1, 0, 1000000));
  }
}

/// `graph`: the name of a file, or the graph itself; `inputs`: what is done with it, as `sinew graph trace`
/// takes it.
void read_graph(const Reader& in, const Asset& asset, const std::filesystem::path& base, SceneCharacter& c) {
  if (!in.has("graph")) {
    if (in.has("inputs")) fail(in.inside("inputs"), "there is no graph");
    return;
  }
  if (in.has("clips")) fail(in.inside("graph"), "there are clips too");
  std::string name = in.inside("graph"), text;
  if (in.at("graph").is_string()) {
    std::filesystem::path path = in.at("graph").get<std::string>();
    if (path.is_relative()) path = base / path;
    name = path.string();
    std::ifstream file(path);
    if (!file) fail(in.inside("graph"), "cannot read " + name);
    text.assign(std::istreambuf_iterator<char>(file), {});
  } else {
    text = in.at("graph").dump();
  }
  const graph_tools::Compiled compiled = graph_tools::compile_graph(text, name);
  if (!compiled.error.empty()) fail(in.inside("graph"), compiled.error);
  if (const std::string fault = graph_tools::bind_fault(compiled, name, asset); !fault.empty())
    fail(in.inside("graph"), fault);
  auto graph = std::make_shared<Graph>();
  if (const Status status = Graph::bind(compiled.graph, asset, *graph); !status)
    fail(in.inside("graph"), status.reason);
  if (in.has("inputs"))
    if (const std::string fault =
            c.graph.inputs.read(in.at("inputs").dump(), in.inside("inputs"), compiled.graph);
        !fault.empty())
      fail(in.inside("inputs"), fault);
  c.graph.graph = std::move(graph);
}

/// `behaviour`: true, or an object of settings.
void read_behaviour(const Reader& in, SceneCharacter& c) {
  if (!in.has("behaviour")) return;
  if (const json& value = in.at("behaviour"); value.is_boolean()) {
    if (value.get<bool>()) c.behaviour.emplace();
    return;
  }
  const Reader of(
      in.at("behaviour"), in.inside("behaviour"),
      {"reaction", "most_steps", "help_torque", "get_up", "rise_force", "rise_torque", "reach_strength"});
  BehaviourSettings settings;
  settings.reaction = of.time("reaction", settings.reaction);
  settings.most_steps = static_cast<int>(of.time("most_steps", settings.most_steps));
  settings.help_torque = of.time("help_torque", settings.help_torque);
  settings.rise_force = of.time("rise_force", settings.rise_force);
  settings.rise_torque = of.time("rise_torque", settings.rise_torque);
  settings.reach_strength = of.time("reach_strength", settings.reach_strength);
  settings.get_up = of.flag("get_up", true) ? GetUpPolicy::kAuto : GetUpPolicy::kNever;
  c.behaviour = settings;
}

/// `tone`, and over it those of the parts in `group_tone`.
void read_tone(const Reader& in, const Skeleton& skeleton, SceneCharacter& c) {
  c.tone = timeline<Tone>(in, "tone", c.tone, tone_of);
  const json& parts = in.list("group_tone");
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const Reader part(parts[i], in.item("group_tone", i), {"joint", "group", "tone"});
    PartTone made;
    made.group = part.text("group", "");
    if (part.has("joint") == part.has("group")) fail(in.item("group_tone", i), "needs a joint or a group");
    if (part.has("joint")) made.joint = joint_of(skeleton, part.text("joint", ""), part.inside("joint"));
    if (made.joint >= skeleton.body_count) fail(part.inside("joint"), "the joint is not simulated");
    const auto works = [&](const Muscle& muscle) { return muscle.group == made.group; };
    if (part.has("group") && std::none_of(skeleton.muscles.begin(), skeleton.muscles.end(), works))
      fail(part.inside("group"), "no muscle of the group '" + made.group + "'");
    made.tone = timeline<Tone>(part, "tone", {{0, Tone::kRigid}}, tone_of);
    c.part_tones.push_back(made);
  }
}

SceneCharacter read_character(const json& value, const std::string& where,
                              const std::filesystem::path& base) {
  const Reader in(value, where, {"asset",      "figure",      "name",           "position",       "yaw_deg",
                                 "clips",      "path",        "turn_rate",      "pose",           "velocity",
                                 "spin",       "random_spin", "strength",       "group_strength", "root",
                                 "root_force", "root_torque", "ground_contact", "self_collision", "options",
                                 "grid",       "bake",        "graph",          "inputs",         "behaviour",
                                 "help_force", "help_torque", "tone",           "group_tone"});
  SceneCharacter c;
  const std::shared_ptr<const Asset> asset = read_asset(in, base);
  c.name = in.text("name", asset->skeleton.name);
  c.position = in.vector("position", c.position);
  c.yaw = in.number("yaw_deg", 0) * kRadians;
  const json& clips = in.list("clips");
  for (std::size_t i = 0; i < clips.size(); ++i) {
    const Reader use(clips[i], in.item("clips", i),
                     {"clip", "start", "blend", "rate", "align", "from_pose", "offset"});
    ClipUse made;
    if (!use.at("clip").is_string()) fail(use.inside("clip"), "expected a clip name");
    const std::string name = use.at("clip").get<std::string>();
    made.clip = asset->find_clip(name);
    if (made.clip < 0 && name == "get_up") {
      made.clip = asset->find_clip("get_up_supine");
      made.clip_when_prone = asset->find_clip("get_up_prone");
    }
    if (made.clip < 0) fail(use.inside("clip"), "unknown clip '" + name + "'");
    made.start = use.time("start", 0);
    made.blend = use.time("blend", 0.3);
    made.rate = use.number("rate", 1);
    made.offset = use.time("offset", 0);
    made.align = use.flag("align", false);
    made.from_pose = use.flag("from_pose", false);
    if (!c.clips.empty() && made.start < c.clips.back().start)
      fail(use.inside("start"), "clips must be in order of time");
    c.clips.push_back(made);
  }
  read_graph(in, *asset, base, c);
  read_motion(in, asset->skeleton, c);
  c.strength = timeline<double>(in, "strength", c.strength, strength_of);
  const json& groups = in.list("group_strength");
  for (std::size_t i = 0; i < groups.size(); ++i) {
    const Reader group(groups[i], in.item("group_strength", i), {"joint", "strength"});
    const int joint = joint_of(asset->skeleton, group.text("joint", ""), group.inside("joint"));
    if (joint >= asset->skeleton.body_count) fail(group.inside("joint"), "the joint is not simulated");
    c.group_strength.emplace_back(joint, timeline<double>(group, "strength", {{0, 1}}, strength_of));
  }
  std::stable_sort(c.group_strength.begin(), c.group_strength.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  read_tone(in, asset->skeleton, c);
  c.root = timeline<RootDrive>(in, "root", c.root, drive_of);
  c.settings.root_force = in.time("root_force", c.settings.root_force);
  c.settings.root_torque = in.time("root_torque", c.settings.root_torque);
  c.settings.ground_contact = in.flag("ground_contact", true);
  c.settings.self_collision = in.flag("self_collision", false);
  c.settings.help_force = in.time("help_force", c.settings.help_force);
  c.settings.help_torque = in.time("help_torque", c.settings.help_torque);
  c.bake = in.flag("bake", false);
  read_behaviour(in, c);
  c.asset = asset;
  return c;
}

/// To the feet of graphs.
void give_ground(Scene& s) {
  auto ground = std::make_shared<Ground>();
  if (s.world.ground) ground->floor = s.world.ground_height;
  ground->obstacles = s.obstacles;
  for (SceneCharacter& c : s.characters)
    if (c.graph.graph) c.graph.ground = ground;
}

/// Where the copies of an entry stand from it, m: the first at 0.
std::vector<Vec3<double>> grid_of(const json& entry, const std::string& where) {
  if (!entry.contains("grid")) return {Vec3<double>::Zero()};
  const Reader in(entry["grid"], where + ".grid", {"count", "spacing"});
  const Vec3<double> count = in.vector("count", Vec3<double>::Ones()),
                     spacing = in.vector("spacing", {1, 1, 1});
  if ((count.array() != count.array().floor()).any() || count.minCoeff() < 1 || count.prod() > 10000)
    fail(in.inside("count"), "must be three whole numbers, at least 1, that make 10000 at most");
  std::vector<Vec3<double>> places;
  for (int z = 0; z < count.z(); ++z)
    for (int y = 0; y < count.y(); ++y)
      for (int x = 0; x < count.x(); ++x) places.emplace_back(spacing.cwiseProduct(Vec3<double>(x, y, z)));
  return places;
}

int character_of(const Scene& scene, const Reader& in, const char* key) {
  if (scene.characters.empty()) fail(in.inside(key), "the scene has no character");
  return in.has(key) ? character_named(scene, in.at(key), in.inside(key)) : 0;
}

SceneProp read_prop(const json& value, const std::string& where, const Scene& scene) {
  const Reader in(value, where,
                  {"name", "shape", "size", "points", "prism", "mass", "friction", "restitution", "position",
                   "rotation", "velocity", "angular_velocity", "launch_time", "throw_at", "grid"});
  SceneProp p;
  p.name = in.text("name", "ball");
  Collider shape;
  shape.size = p.settings.size;
  read_shape(in, shape);
  p.settings.shape = shape.shape;
  p.settings.size = shape.size;
  p.settings.hull = shape.hull;
  p.settings.mass = in.positive("mass", 1);
  p.settings.friction = in.time("friction", p.settings.friction);
  p.settings.restitution = in.time("restitution", p.settings.restitution);
  p.settings.pose.translation = in.vector("position", {0, 0, 1});
  p.settings.pose.rotation = rotation_exp<double>(in.vector("rotation", Vec3<double>::Zero()));
  p.settings.velocity = in.vector("velocity", p.settings.velocity);
  p.settings.angular_velocity = in.vector("angular_velocity", p.settings.angular_velocity);
  p.launch_time = in.time("launch_time", 0);
  if (in.has("throw_at")) {
    const Reader at(in.at("throw_at"), in.inside("throw_at"),
                    {"character", "joint", "time", "speed", "from"});
    p.target_character = character_of(scene, at, "character");
    p.target_joint = joint_of(scene.characters[p.target_character].asset->skeleton, at.text("joint", "chest"),
                              at.inside("joint"));
    p.speed = at.positive("speed", 8);
    p.from = at.vector("from", p.from);
    p.launch_time = at.time("time", 0);
  }
  return p;
}

Push read_push(const json& value, const std::string& where, const Scene& scene) {
  const Reader p(value, where,
                 {"time", "duration", "every", "character", "joint", "point", "impulse", "force"});
  Push push;
  push.time = p.time("time", 0);
  push.duration = p.time("duration", 0);
  push.every = p.time("every", 0);
  push.point = p.vector("point", push.point);
  push.character = character_of(scene, p, "character");
  push.joint =
      joint_of(scene.characters[push.character].asset->skeleton, p.text("joint", "chest"), p.inside("joint"));
  push.impulse = p.vector("impulse", push.impulse);
  push.force = timeline<Vec3<double>>(p, "force", {}, Reader::vector_of);
  return push;
}

/// "game", or an object whose "preset" the other keys change.
void read_accuracy(const json& value, Scene& s) {
  MeasuredAccuracy preset;
  const json named = value.is_string() ? json{{"preset", value}} : value;
  const Reader a(named, "accuracy",
                 {"preset", "tolerance", "max_iterations", "substeps", "max_rotation", "shortest_part",
                  "max_splits", "max_passes", "sink_depth", "contact_damping", "stick_speed",
                  "limit_stiffness", "limit_damping", "return_time", "precision", "estimate_error"});
  if (a.has("preset")) {
    if (convert::Error error = find_preset(a.text("preset", ""), preset)) fail("accuracy", error.message);
    set_accuracy(preset, s.frame_rate, s.world.accuracy, s.double_precision);
  }
  s.world.accuracy.substeps = a.count("substeps", s.world.accuracy.substeps, 1, 1000);
  s.world.accuracy.max_rotation = a.time("max_rotation", s.world.accuracy.max_rotation);
  s.world.accuracy.shortest_part = a.positive("shortest_part", s.world.accuracy.shortest_part);
  s.world.accuracy.max_splits = a.count("max_splits", s.world.accuracy.max_splits, 0, 10);
  s.world.accuracy.max_passes = a.count("max_passes", s.world.accuracy.max_passes, 1, 1000000);
  s.world.accuracy.limit_stiffness = a.positive("limit_stiffness", s.world.accuracy.limit_stiffness);
  s.world.accuracy.limit_damping = a.time("limit_damping", s.world.accuracy.limit_damping);
  s.world.accuracy.tolerance = a.positive("tolerance", s.world.accuracy.tolerance);
  s.world.accuracy.max_iterations = a.count("max_iterations", s.world.accuracy.max_iterations, 1, 1000);
  s.world.accuracy.sink_depth = a.positive("sink_depth", s.world.accuracy.sink_depth);
  s.world.accuracy.contact_damping = a.time("contact_damping", s.world.accuracy.contact_damping);
  s.world.accuracy.stick_speed = a.positive("stick_speed", s.world.accuracy.stick_speed);
  s.world.accuracy.return_time = a.positive("return_time", s.world.accuracy.return_time);
  s.world.accuracy.estimate_error = a.flag("estimate_error", false);
  const std::string precision = a.text("precision", s.double_precision ? "double" : "float");
  if (precision != "float" && precision != "double") fail("accuracy.precision", "is float or double");
  s.double_precision = precision == "double";
}

Scene parse(const json& root, const std::filesystem::path& base, std::span<const EffectRow> registry) {
  const Reader in(
      root, "",
      {"title", "duration", "frame_rate", "accuracy", "scheme", "baking", "gravity", "ground", "characters",
       "props", "obstacles", "loops", "particles", "pushes", "effects", "camera", "captions", "plot"});
  Scene s;
  s.title = in.text("title", "");
  s.duration = in.positive("duration", s.duration);
  s.frame_rate = in.positive("frame_rate", s.frame_rate);
  if (s.frame_rate < 4 || s.frame_rate > 10000) fail("frame_rate", "must be between 4 and 10000");
  if (s.duration > 3600) fail("duration", "is longer than an hour");
  if (in.has("accuracy")) read_accuracy(in.at("accuracy"), s);
  const std::optional<study::Compared> scheme = study::scheme_named(in.text("scheme", "bossak"));
  if (!scheme) fail("scheme", "is bossak, bdf2, bdf1, momentum, semi_implicit or forward_euler");
  s.scheme = *scheme;
  if (in.has("baking")) {
    const Reader baking(in.at("baking"), "baking", {"every", "decay"});
    s.world.detail.bake_every = baking.count("every", s.world.detail.bake_every, 1, 1000);
    s.world.detail.baked_decay = baking.time("decay", 0);
  }
  s.world.gravity = in.vector("gravity", s.world.gravity);
  s.world.ground = in.flag("ground", true);
  const json& characters = in.list("characters");
  for (std::size_t i = 0; i < characters.size(); ++i) {
    const SceneCharacter first = read_character(characters[i], in.item("characters", i), base);
    unsigned copy = 0;
    for (const Vec3<double>& place : grid_of(characters[i], in.item("characters", i))) {
      SceneCharacter c = first;
      c.position += place;
      for (auto& [time, at] : c.path) at += place;
      c.speeds.seed += copy;
      if (++copy > 1) c.name += " " + std::to_string(copy);
      s.characters.push_back(std::move(c));
    }
  }
  const json& props = in.list("props");
  for (std::size_t i = 0; i < props.size(); ++i)
    for (const Vec3<double>& place : grid_of(props[i], in.item("props", i))) {
      s.props.push_back(read_prop(props[i], in.item("props", i), s));
      s.props.back().settings.pose.translation += place;
    }
  if (s.characters.empty() && s.props.empty())
    fail("characters", "the scene has neither characters nor props");
  const json& loops = in.list("loops");
  for (std::size_t i = 0; i < loops.size(); ++i)
    s.loops.push_back(read_loop(loops[i], in.item("loops", i), s));
  const json& particles = in.list("particles");
  for (std::size_t i = 0; i < particles.size(); ++i)
    s.particles.push_back(read_particles(particles[i], in.item("particles", i), s));
  const json& obstacles = in.list("obstacles");
  for (std::size_t i = 0; i < obstacles.size(); ++i) {
    const Reader o(obstacles[i], in.item("obstacles", i),
                   {"shape", "size", "points", "prism", "position", "yaw_deg", "rotation", "friction"});
    Collider c;
    read_shape(o, c);
    c.local.translation = o.vector("position", Vec3<double>::Zero());
    if (o.has("rotation") && o.has("yaw_deg")) fail(o.inside("rotation"), "there is yaw_deg too");
    c.local.rotation = Eigen::AngleAxisd(o.number("yaw_deg", 0) * kRadians, Vec3<double>::UnitZ());
    if (o.has("rotation"))
      c.local.rotation = rotation_exp<double>(o.vector("rotation", Vec3<double>::Zero()));
    c.friction = o.time("friction", 0.8);
    s.obstacles.push_back(c);
  }
  give_ground(s);
  const json& pushes = in.list("pushes");
  for (std::size_t i = 0; i < pushes.size(); ++i)
    s.pushes.push_back(read_push(pushes[i], in.item("pushes", i), s));
  s.captions = timeline<std::string>(in, "captions", {}, [](const json& v, const std::string& w) {
    if (!v.is_string()) fail(w, "expected a text");
    return v.get<std::string>();
  });
  if (in.has("camera")) {
    const Reader c(in.at("camera"), "camera", {"eye", "target", "fov_deg", "follow", "frame_automatically"});
    s.camera.eye = c.vector("eye", s.camera.eye.cast<double>()).cast<float>();
    s.camera.target = c.vector("target", s.camera.target.cast<double>()).cast<float>();
    s.camera.vertical_fov_deg = static_cast<float>(c.positive("fov_deg", 32));
    s.camera.frame_automatically = c.flag("frame_automatically", !c.has("eye"));
    s.camera.follow_character = c.flag("follow", false) && !s.characters.empty() ? 0 : -1;
  }
  declare_effects(in, registry, s);
  if (in.has("plot") && s.characters.empty()) fail("plot", "the scene has no character");
  if (in.has("plot"))
    s.plotted_joint = joint_of(s.characters[0].asset->skeleton, in.text("plot", ""), "plot");
  return s;
}

}  // namespace

int joint_of(const Skeleton& skeleton, const std::string& name, const std::string& where) {
  int joint = skeleton.find(name.c_str());
  if (joint < 0)
    if (const Role role = convert::role_from_name(name); role != Role::kNone) joint = skeleton.find(role);
  if (joint < 0) fail(where, "unknown joint '" + name + "'");
  return joint;
}

int character_named(const Scene& scene, const json& v, const std::string& where) {
  if (v.is_number_integer() && v.get<int>() >= 0 && v.get<int>() < static_cast<int>(scene.characters.size()))
    return v.get<int>();
  if (v.is_string())
    for (std::size_t i = 0; i < scene.characters.size(); ++i)
      if (scene.characters[i].name == v.get<std::string>()) return static_cast<int>(i);
  fail(where, "unknown character " + v.dump());
}

convert::Error load_scene(const std::string& path, Scene& out) {
  return load_scene(path, effect_registry(), out);
}

convert::Error load_scene(const std::string& path, std::span<const EffectRow> registry, Scene& out) {
  std::ifstream file(path);
  if (!file) return {path + ": file cannot be opened"};
  try {
    out = parse(json::parse(file, nullptr, true, true), std::filesystem::path(path).parent_path(), registry);
  } catch (const json::parse_error& e) {
    return {path + ": not JSON: " + import::plain_words(e)};
  } catch (const std::exception& e) {
    return {path + ": " + import::plain_words(e)};
  }
  return {};
}

}  // namespace sinew::scene
