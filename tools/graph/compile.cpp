#include "graph/compile.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "graph/condition.h"
#include "sinew/graph/graph.h"

namespace sinew::graph_tools {
namespace {

std::string joined(const std::vector<std::string>& names) {
  std::string out;
  for (const std::string& name : names) out += (out.empty() ? "" : ", ") + name;
  return out.empty() ? "none" : out;
}

/// Where a value stands, and checked access to it.
class Place {
 public:
  Place(const LocatedJson& text, const Json& value, std::string pointer)
      : text_(text), value_(&value), pointer_(std::move(pointer)) {}

  [[noreturn]] void fail(const std::string& what) const { throw Fault(line(), what); }
  int line() const { return text_.line(pointer_); }
  const Json& json() const { return *value_; }
  bool has(const char* key) const { return value_->contains(key); }
  Place at(const std::string& key) const {
    if (!value_->contains(key)) fail("'" + key + "' is missing");
    std::string escaped;
    for (const char c : key) escaped += c == '~' ? "~0" : c == '/' ? "~1" : std::string(1, c);
    return {text_, (*value_)[key], pointer_ + "/" + escaped};
  }
  Place at(std::size_t k) const { return {text_, (*value_)[k], pointer_ + "/" + std::to_string(k)}; }
  std::size_t size() const { return value_->size(); }
  const Place& object(const std::vector<std::string>& keys) const {
    if (!value_->is_object()) fail("expected an object");
    for (const auto& [key, v] : value_->items())
      if (std::find(keys.begin(), keys.end(), key) == keys.end())
        at(key).fail("unknown key '" + key + "', known are: " + joined(keys));
    return *this;
  }
  const Place& array() const {
    if (!value_->is_array()) fail("expected a list");
    return *this;
  }
  std::string text() const {
    if (!value_->is_string()) fail("expected a text");
    return value_->get<std::string>();
  }
  float number(double least, double most) const {
    if (!value_->is_number()) fail("expected a number");
    const double v = value_->get<double>();
    if (!std::isfinite(v) || v < least || v > most)
      fail("must be from " + Json(least).dump() + " to " + Json(most).dump());
    return static_cast<float>(v);
  }
  bool flag() const {
    if (!value_->is_boolean()) fail("expected true or false");
    return value_->get<bool>();
  }
  template <class Enum>
  Enum choice(const std::vector<std::pair<std::string, Enum>>& choices) const {
    const std::string name = text();
    std::vector<std::string> names;
    for (const auto& [known, e] : choices) {
      if (known == name) return e;
      names.push_back(known);
    }
    fail("unknown '" + name + "', known are: " + joined(names));
  }

 private:
  const LocatedJson& text_;
  const Json* value_;
  std::string pointer_;
};

constexpr double kMost = 1e6;
constexpr double kLongest = 3600;  ///< s

class Compiler {
 public:
  Compiler(const LocatedJson& text, const std::string& path, Compiled& out)
      : text_(text), path_(path), out_(out), graph_(out.graph) {}

  void run() {
    const Place all(text_, text_.value, "");
    all.object({"parameters", "nodes", "graph"});
    if (all.has("parameters")) parameters(all.at("parameters"));
    if (all.has("nodes")) {
      const Place nodes = all.at("nodes");
      if (!nodes.json().is_object()) nodes.fail("expected an object");
      for (const auto& [name, v] : nodes.json().items()) named_.emplace_back(name, nodes.at(name));
    }
    graph_.name = "graph";
    const int root = node(all.at("graph"), "graph", "");
    if (graph_.nodes[std::size_t(root)].type == NodeType::kEmpty)
      all.at("graph").fail("the graph has no pose");
    unused();
  }

 private:
  void warn(int line, const std::string& what) {
    out_.warnings.push_back(path_ + ":" + std::to_string(line) + ": " + what);
  }

  void parameters(const Place& all) {
    if (!all.json().is_object()) all.fail("expected an object");
    if (all.size() > std::size_t(GraphDefinition::kMostParameters)) all.fail("more than 256 parameters");
    for (const auto& [name, v] : all.json().items()) {
      const Place place = all.at(name);
      static const std::set<std::string> kTaken = {"time",  "remaining", "fading", "phase",
                                                   "event", "true",      "false"};
      if (kTaken.count(name)) place.fail("'" + name + "' means something in conditions already");
      if (name.empty() ||
          name.find_first_not_of("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_.-") !=
              std::string::npos ||
          std::isdigit(static_cast<unsigned char>(name[0])) || name[0] == '-' || name[0] == '.')
        place.fail(
            "name of a parameter has other than letters, digits and _ . -, or begins with one of the latter");
      GraphParameter p;
      p.name = name;
      parameter(place, p);
      physics(place, p);
      graph_.parameters.push_back(p);
      parameter_lines_.push_back(place.line());
    }
    used_.assign(graph_.parameters.size(), false);
  }
  static const std::vector<std::pair<std::string, ParameterType>>& types() {
    static const std::vector<std::pair<std::string, ParameterType>> all = {
        {"float", ParameterType::kFloat},
        {"bool", ParameterType::kBool},
        {"trigger", ParameterType::kTrigger}};
    return all;
  }
  void parameter(const Place& place, GraphParameter& p) {
    const Json& v = place.json();
    if (v.is_boolean()) {
      p.type = ParameterType::kBool;
      p.value = v.get<bool>() ? 1.f : 0.f;
    } else if (v.is_number()) {
      p.value = place.number(-kMost, kMost);
    } else if (v.is_string()) {
      p.type = place.choice(types());
    } else {
      place.object({"type", "value", "filter", "buffer"});
      p.type = place.has("type") ? place.at("type").choice(types()) : ParameterType::kFloat;
      if (place.has("value"))
        p.value = p.type == ParameterType::kBool ? (place.at("value").flag() ? 1.f : 0.f)
                                                 : place.at("value").number(-kMost, kMost);
      if (place.has("filter")) {
        if (p.type != ParameterType::kFloat) place.at("filter").fail("only floats are filtered");
        p.half_life = place.at("filter").number(0, kLongest);
        if (p.half_life > 0 && p.half_life < 1e-3f)
          place.at("filter").fail("a filter's half-life is 0, or a millisecond or more");
      }
      if (place.has("buffer")) {
        if (p.type != ParameterType::kTrigger) place.at("buffer").fail("only triggers wait");
        p.buffer = place.at("buffer").number(0, kLongest);
      }
    }
  }

  /// Names that begin like those of physical values have to be such.
  static void physics(const Place& place, const GraphParameter& p) {
    if (p.name.compare(0, 8, "physics.") != 0) return;
    std::size_t mask = 0;
    if (physics_value(p.name, mask) < 0)
      place.fail("no physical value is called '" + p.name + "', known are: " +
                 joined({std::begin(kPhysicsNames), std::end(kPhysicsNames)}) + ", physics.load.MASK");
    if (p.type != ParameterType::kFloat) place.fail("'" + p.name + "' is a number, so a float parameter");
  }

  GraphValue value(const Place& place, double least, double most) {
    GraphValue v;
    if (place.json().is_number())
      v.constant = place.number(least, most);
    else
      v.parameter = float_parameter(place);
    return v;
  }
  int float_parameter(const Place& place) {
    const std::string name = place.text();
    const int k = graph_.find_parameter(name);
    if (k < 0) place.fail("no parameter '" + name + "', known are: " + parameter_names());
    if (graph_.parameters[std::size_t(k)].type != ParameterType::kFloat)
      place.fail("parameter '" + name + "' is no float");
    used_[std::size_t(k)] = true;
    return k;
  }
  std::string parameter_names() const {
    std::vector<std::string> names;
    for (const GraphParameter& p : graph_.parameters) names.push_back(p.name);
    return joined(names);
  }
  static int add_name(std::vector<std::string>& names, const std::string& name) {
    const auto found = std::find(names.begin(), names.end(), name);
    if (found != names.end()) return static_cast<int>(found - names.begin());
    names.push_back(name);
    return static_cast<int>(names.size()) - 1;
  }

  int add(GraphNode node, const Place& place) {
    if (graph_.nodes.size() >= std::size_t(GraphDefinition::kMostNodes)) place.fail("more than 4096 nodes");
    graph_.nodes.push_back(std::move(node));
    out_.lines.push_back(place.line());
    return static_cast<int>(graph_.nodes.size()) - 1;
  }
  /// `sync`: of the clips that are named without more.
  int node(const Place& place, const std::string& name, const std::string& sync) {
    struct Deeper {
      explicit Deeper(int& d) : depth(d) { ++depth; }
      ~Deeper() { --depth; }
      int& depth;
    } deeper(depth_);
    if (depth_ > GraphDefinition::kDeepest) place.fail("nodes are nested deeper than 24 levels");
    GraphNode out;
    out.name = name;
    const Json& v = place.json();
    if (v.is_null()) {
      out.type = NodeType::kEmpty;
      return add(std::move(out), place);
    }
    if (v.is_string()) return named(place, place.text(), name, sync);
    if (!v.is_object()) place.fail("expected a clip's name or an object");
    if (place.has("feet")) return feet(place, std::move(out));
    if (place.has("look")) return look(place, std::move(out));
    top_ = false;
    if (place.has("travel")) return travel(place, std::move(out), sync);
    if (place.has("clip")) return clip(place, std::move(out), sync);
    if (place.has("blend")) return blend(place, std::move(out), sync);
    if (place.has("layers")) return layers(place, std::move(out));
    if (place.has("states")) return machine(place, std::move(out));
    if (place.has("mirror")) {
      out.type = NodeType::kMirror;
      out.children.push_back(node(place.object({"mirror"}).at("mirror"), name, sync));
      if (graph_.nodes.back().type == NodeType::kEmpty) place.fail("a mirror has nothing to show");
      return add(std::move(out), place);
    }
    if (place.has("physical")) {
      if (!place.object({"physical"}).at("physical").flag()) place.fail("'physical' can only be true");
      out.type = NodeType::kPhysical;
      return add(std::move(out), place);
    }
    place.fail("a node has one of: clip, blend, layers, states, mirror, travel, feet, look, physical");
  }
  int named(const Place& place, const std::string& wanted, const std::string& name, const std::string& sync) {
    for (const auto& [known, at] : named_) {
      if (known != wanted) continue;
      if (std::find(open_.begin(), open_.end(), wanted) != open_.end()) {
        open_.push_back(wanted);
        std::string path;
        for (const std::string& step : open_) path += (path.empty() ? "" : " > ") + step;
        place.fail("node '" + wanted + "' contains itself: " + path);
      }
      open_.push_back(wanted);
      used_nodes_.insert(wanted);
      const int index = node(at, name, sync);
      open_.pop_back();
      return index;
    }
    GraphNode out;
    out.name = name;
    out.clip = wanted;
    if (wanted.empty()) place.fail("clip has no name");
    if (!sync.empty()) out.group = add_name(graph_.groups, sync);
    return add(std::move(out), place);
  }
  int clip(const Place& place, GraphNode out, std::string sync) {
    place.object({"clip", "speed", "sync", "root_motion"});
    out.type = NodeType::kClip;
    out.clip = place.at("clip").text();
    if (out.clip.empty()) place.fail("clip has no name");
    if (place.has("sync")) sync = place.at("sync").json().is_null() ? "" : place.at("sync").text();
    if (!sync.empty()) out.group = add_name(graph_.groups, sync);
    if (place.has("speed")) {
      out.speed = value(place.at("speed"), -100, 100);
      if (out.group >= 0 &&
          (out.speed.parameter >= 0 || out.speed.constant < 0.02f || out.speed.constant > 50))
        place.at("speed").fail("speed of a synchronised clip must be a number from 0.02 to 50");
    }
    if (place.has("root_motion")) out.root_motion = place.at("root_motion").flag();
    return add(std::move(out), place);
  }
  int blend(const Place& place, GraphNode out, std::string sync) {
    place.object({"blend", "points", "sync"});
    out.type = NodeType::kBlend;
    const Place by = place.at("blend");
    const std::size_t dimensions = by.json().is_array() ? by.size() : 1;
    if (dimensions < 1 || dimensions > 2) by.fail("a blend has one or two parameters");
    for (std::size_t d = 0; d < dimensions; ++d)
      out.parameters[d] = float_parameter(by.json().is_array() ? by.at(d) : by);
    if (place.has("sync")) sync = place.at("sync").text();
    const Place points = place.at("points");
    points.array();
    if (points.size() < 1 || points.size() > 16) points.fail("a blend has from 1 to 16 points");
    for (std::size_t k = 0; k < points.size(); ++k) {
      const Place point = points.at(k);
      if (point.array().size() != dimensions + 1)
        point.fail("a point is " + std::string(dimensions == 1 ? "[position, node]" : "[x, y, node]"));
      for (std::size_t d = 0; d < dimensions; ++d) out.points.push_back(point.at(d).number(-kMost, kMost));
      const int child = node(point.at(dimensions), out.name + "/" + std::to_string(k), sync);
      if (graph_.nodes[std::size_t(child)].type == NodeType::kEmpty) point.fail("a blend has an empty child");
      out.children.push_back(child);
    }
    return add(std::move(out), place);
  }
  int layers(const Place& place, GraphNode out) {
    place.object({"layers"});
    out.type = NodeType::kLayers;
    const Place all = place.at("layers");
    if (all.array().size() < 1) all.fail("layers need at least the one below");
    for (std::size_t k = 0; k < all.size(); ++k) {
      const Place layer = all.at(k);
      const std::string name = out.name + "/" + std::to_string(k);
      if (k == 0) {
        out.children.push_back(node(layer, name, ""));
        if (graph_.nodes.back().type == NodeType::kEmpty) layer.fail("the lowest layer is empty");
        continue;
      }
      layer.object({"node", "mask", "weight", "mode", "reference", "reference_time"});
      may_be_empty_ = true;
      out.children.push_back(node(layer.at("node"), name, ""));
      if (graph_.nodes.back().type == NodeType::kEmpty) layer.fail("a layer is empty");
      GraphLayer in;
      if (layer.has("mask")) in.mask = layer.at("mask").text();
      if (layer.has("weight")) in.weight = value(layer.at("weight"), 0, 1);
      if (layer.has("mode"))
        in.mode = layer.at("mode").choice<LayerMode>({{"override", LayerMode::kOverride},
                                                      {"additive", LayerMode::kAdditive},
                                                      {"additive_in_model", LayerMode::kMeshAdditive}});
      for (const char* key : {"reference", "reference_time"})
        if (layer.has(key) && in.mode == LayerMode::kOverride)
          layer.at(key).fail("only additive layers have a reference");
      if (layer.has("reference")) in.reference = layer.at("reference").text();
      if (layer.has("reference_time")) in.reference_time = layer.at("reference_time").number(0, kLongest);
      out.layers.push_back(in);
    }
    return add(std::move(out), place);
  }

  int travel(const Place& place, GraphNode out, const std::string& sync) {
    place.object({"travel", "forward", "left", "turn", "weight", "add"});
    out.type = NodeType::kTravel;
    out.children = {only_child(place.at("travel"), out.name, sync)};
    static constexpr const char* kAxes[] = {"forward", "left", "turn"};
    bool any = false;
    for (int k = 0; k < 3; ++k) {
      if (!place.has(kAxes[k])) continue;
      out.travel.parameters[k] = float_parameter(place.at(kAxes[k]));
      any = true;
    }
    if (!any) place.fail("a travel has one of: forward, left, turn");
    if (place.has("weight")) out.travel.weight = value(place.at("weight"), 0, 1);
    if (place.has("add")) out.travel.adds = place.at("add").flag();
    return add(std::move(out), place);
  }
  int only_child(const Place& place, const std::string& name, const std::string& sync) {
    const int child = node(place, name + "/0", sync);
    if (graph_.nodes[std::size_t(child)].type == NodeType::kEmpty) place.fail("there is nothing here");
    return child;
  }
  /// Feet and looks are of the whole pose.
  void finisher(const Place& place, const GraphNode& out) {
    if (!top_)
      place.fail(std::string(out.type == NodeType::kFeet ? "feet are" : "a look is") +
                 " of the whole pose: nothing but looks and feet may be above");
    if (out.type == NodeType::kFeet && std::exchange(has_feet_, true)) place.fail("feet stand twice");
  }
  int feet(const Place& place, GraphNode out) {
    place.object({"feet", "weight", "level", "lock", "lock_at", "release_at", "lock_time", "release_time",
                  "half_life", "farthest", "steepest", "reach", "follow", "rise", "deepest", "lift"});
    out.type = NodeType::kFeet;
    finisher(place, out);
    out.children = {only_child(place.at("feet"), out.name, "")};
    GraphFeet& in = out.feet;
    if (place.has("weight")) in.weight = value(place.at("weight"), 0, 1);
    if (place.has("level")) in.level = float_parameter(place.at("level"));
    if (place.has("lock")) in.locks = place.at("lock").flag();
    FootSettings<float>& s = in.settings;
    numbers(place, {{"lock_at", &s.lock_at},
                    {"release_at", &s.release_at},
                    {"lock_time", &s.lock_time},
                    {"release_time", &s.release_time},
                    {"half_life", &s.half_life},
                    {"farthest", &s.farthest},
                    {"steepest", &s.steepest},
                    {"reach", &in.reach},
                    {"follow", &in.follow},
                    {"rise", &in.rise},
                    {"deepest", &in.deepest},
                    {"lift", &in.lift}});
    return add(std::move(out), place);
  }
  int look(const Place& place, GraphNode out) {
    place.object({"look", "at", "in", "weight", "joints", "yaw", "pitch_down", "pitch_up", "softness",
                  "behind", "fastest", "least_time", "half_life"});
    out.type = NodeType::kLook;
    finisher(place, out);
    out.children = {only_child(place.at("look"), out.name, "")};
    GraphLook& in = out.look;
    const Place at = place.at("at");
    if (at.array().size() != 3) at.fail("a look is at three parameters: [x, y, z]");
    for (std::size_t k = 0; k < 3; ++k) in.target[k] = float_parameter(at.at(k));
    if (place.has("in")) in.in_world = place.at("in").choice<bool>({{"world", true}, {"character", false}});
    if (place.has("weight")) in.weight = value(place.at("weight"), 0, 1);
    if (place.has("joints")) {
      const Place joints = place.at("joints");
      if (joints.array().size() < 1 || joints.size() > 8) joints.fail("a look has from 1 to 8 joints");
      for (std::size_t k = 0; k < joints.size(); ++k) {
        const Place joint = joints.at(k);
        if (joint.array().size() != 2) joint.fail("a joint of a look is [name, share]");
        in.joints.push_back(joint.at(0).text());
        in.shares.push_back(joint.at(1).number(1e-3, 1e3));
      }
    }
    LookSettings<float>& s = in.settings;
    numbers(place, {{"yaw", &s.yaw},
                    {"pitch_down", &s.pitch_down},
                    {"pitch_up", &s.pitch_up},
                    {"softness", &s.softness},
                    {"behind", &s.behind},
                    {"fastest", &s.fastest},
                    {"least_time", &s.least_time},
                    {"half_life", &s.half_life}});
    return add(std::move(out), place);
  }
  /// Those that are given; what is absurd about them the definition's own check says.
  static void numbers(const Place& place, const std::vector<std::pair<const char*, float*>>& all) {
    for (const auto& [key, number] : all)
      if (place.has(key)) *number = place.at(key).number(0, kLongest);
  }

  int machine(const Place& place, GraphNode out) {
    place.object({"states", "start", "transitions"});
    const bool may_be_empty = std::exchange(may_be_empty_, false);
    out.type = NodeType::kMachine;
    const Place states = place.at("states");
    if (!states.json().is_object() || states.size() == 0) states.fail("expected states by name");
    if (states.size() > 1000) states.fail("more than a thousand states");
    for (const auto& [name, v] : states.json().items()) {
      const Place state = states.at(name);
      if (v.is_object() && v.contains("conduit")) {
        if (!state.object({"conduit"}).at("conduit").flag()) state.fail("'conduit' can only be true");
        out.states.push_back({name, -1});
        continue;
      }
      if (v.is_null() && !may_be_empty) state.fail("only a machine that is a layer has empty states");
      const int child = node(state, out.name + "/" + name, "");
      out.children.push_back(child);
      out.states.push_back({name, child});
    }
    out.start = place.has("start") ? state_of(place.at("start"), out) : 0;
    if (out.states[std::size_t(out.start)].node < 0) place.fail("a machine cannot start in a conduit");
    if (place.has("transitions")) {
      const Place all = place.at("transitions");
      for (std::size_t k = 0; k < all.array().size(); ++k) transition(all.at(k), out);
    }
    reachable(states, out);
    return add(std::move(out), place);
  }
  static int state_of(const Place& place, const GraphNode& machine) {
    const std::string name = place.text();
    std::vector<std::string> names;
    for (std::size_t k = 0; k < machine.states.size(); ++k) {
      if (machine.states[k].name == name) return static_cast<int>(k);
      names.push_back(machine.states[k].name);
    }
    place.fail("no state '" + name + "', known are: " + joined(names));
  }
  void transition(const Place& place, GraphNode& machine) {
    place.object(
        {"from", "to", "if", "kind", "duration", "budget", "interrupt", "entry", "profile", "share"});
    GraphTransition t;
    t.to = state_of(place.at("to"), machine);
    if (place.has("if")) t.condition = condition(place.at("if"));
    if (place.has("kind"))
      t.kind = place.at("kind").choice<TransitionKind>({{"inertial", TransitionKind::kInertial},
                                                        {"dead", TransitionKind::kDead},
                                                        {"crossfade", TransitionKind::kCrossfade},
                                                        {"cut", TransitionKind::kCut},
                                                        {"smoothstep", TransitionKind::kSmoothstep}});
    if (place.has("budget")) {
      if (t.kind != TransitionKind::kInertial)
        place.at("budget").fail("only inertial transitions have a budget");
      t.budget = place.at("budget").number(0, 1000);
      t.duration = 0.6f;
    }
    if (place.has("duration")) t.duration = place.at("duration").number(0, kLongest);
    if (place.has("entry")) t.entry = place.at("entry").number(0, kLongest);
    if (place.has("profile")) t.profile = place.at("profile").text();
    if (place.has("share")) {
      if (t.profile.empty())
        place.at("share").fail("a share is of the joints of a profile, which is missing");
      t.share = place.at("share").number(0.1, 1);
    }
    if (!t.profile.empty() && (t.budget > 0 || t.kind != TransitionKind::kInertial))
      place.at("profile").fail("only inertial transitions without a budget have a profile");
    if (place.has("interrupt")) interruption(place.at("interrupt"), machine, t);
    const Place from = place.at("from");
    const std::size_t count = from.json().is_array() ? from.size() : 1;
    if (count == 0) from.fail("from no state");
    for (std::size_t k = 0; k < count; ++k) {
      const Place one = from.json().is_array() ? from.at(k) : from;
      t.from = one.text() == "*" ? GraphTransition::kAnyState : state_of(one, machine);
      can_fire(place, machine, t);
      machine.transitions.push_back(t);
    }
    if (machine.transitions.size() > 10000) place.fail("more than 10000 transitions");
  }
  void interruption(const Place& place, const GraphNode& machine, GraphTransition& t) {
    if (place.json().is_array()) {
      t.interrupt = Interruption::kListed;
      for (std::size_t k = 0; k < place.size(); ++k)
        t.interrupted_by.push_back(state_of(place.at(k), machine));
      return;
    }
    t.interrupt = place.choice<Interruption>({{"any", Interruption::kAny}, {"never", Interruption::kNever}});
  }
  std::vector<ConditionStep> condition(const Place& place) {
    const ConditionNames names{&graph_, [&](const std::string& name) {
                                 const int k = add_name(graph_.events, name);
                                 if (k >= GraphDefinition::kMostEvents)
                                   throw std::runtime_error("conditions ask for more than 32 events");
                                 return k;
                               }};
    std::vector<ConditionStep> steps;
    try {
      steps = parse_condition(place.text(), names);
    } catch (const Fault&) {
      throw;
    } catch (const std::runtime_error& e) {
      place.fail(e.what());
    }
    for (const ConditionStep& step : steps)
      if (step.code == ConditionCode::kParameter) used_[step.index] = true;
    return steps;
  }
  /// Refuses what no values let through, and what an earlier transition from the same state always
  /// forestalls.
  void can_fire(const Place& place, const GraphNode& machine, const GraphTransition& t) const {
    const bool conduit = t.from >= 0 && machine.states[std::size_t(t.from)].node < 0;
    if (conduit && t.to == t.from) place.fail("a conduit leads to itself");
    if (t.condition.size() == 1 && t.condition[0].code == ConditionCode::kNumber && t.condition[0].value == 0)
      place.fail("transition can never fire: its condition is false");
    if (!can_be_true(t.condition, graph_))
      place.fail("transition to '" + machine.states[std::size_t(t.to)].name +
                 "' can never fire: no values make \"" + place.at("if").text() + "\" true");
    for (const GraphTransition& earlier : machine.transitions) {
      if (!earlier.condition.empty() || machine.states[std::size_t(earlier.to)].node < 0) continue;
      if (earlier.from == t.from ||
          (earlier.from == GraphTransition::kAnyState && t.from >= 0 && t.from != earlier.to))
        place.fail("transition can never fire: one before it, to '" +
                   machine.states[std::size_t(earlier.to)].name + "', has no condition");
    }
  }
  void reachable(const Place& states, const GraphNode& machine) {
    std::vector<char> reached(machine.states.size(), 0);
    std::vector<int> open = {machine.start};
    reached[std::size_t(machine.start)] = 1;
    while (!open.empty()) {
      const int state = open.back();
      open.pop_back();
      for (const GraphTransition& t : machine.transitions)
        if ((t.from == state || t.from == GraphTransition::kAnyState) &&
            !std::exchange(reached[std::size_t(t.to)], 1))
          open.push_back(t.to);
    }
    for (std::size_t k = 0; k < reached.size(); ++k)
      if (!reached[k])
        warn(states.at(machine.states[k].name).line(),
             machine.name + ": no transition leads to state '" + machine.states[k].name + "'");
  }
  void unused() {
    for (std::size_t k = 0; k < used_.size(); ++k)
      if (!used_[k]) warn(parameter_lines_[k], "parameter '" + graph_.parameters[k].name + "' is not used");
    for (const auto& [name, place] : named_)
      if (!used_nodes_.count(name)) warn(place.line(), "node '" + name + "' is not used");
  }

  const LocatedJson& text_;
  const std::string& path_;
  Compiled& out_;
  GraphDefinition& graph_;
  std::vector<std::pair<std::string, Place>> named_;
  std::vector<std::string> open_;  ///< named nodes that are being read
  std::set<std::string> used_nodes_;
  std::vector<int> parameter_lines_;
  std::vector<bool> used_;
  int depth_ = 0;
  bool top_ = true;  ///< nothing but looks and feet is above what is read
  bool has_feet_ = false;
  bool may_be_empty_ = false;  ///< the node that is read next is a layer
};

}  // namespace

Compiled compile_graph(const std::string& text, const std::string& path) {
  Compiled out;
  try {
    const LocatedJson located = parse_located(text);
    Compiler(located, path, out).run();
    if (const Status status = validate(out.graph); !status)
      throw Fault(status.index >= 0 && std::size_t(status.index) < out.lines.size()
                      ? out.lines[std::size_t(status.index)]
                      : 1,
                  status.reason);
  } catch (const Fault& fault) {
    out.error = path + ":" + std::to_string(fault.line) + ": " + fault.what();
  }
  return out;
}

std::string bind_fault(const Compiled& compiled, const std::string& path, const Asset& asset) {
  Graph graph;
  const Status status = Graph::bind(compiled.graph, asset, graph);
  if (status) return {};
  std::string where = path, what = status.reason;
  if (status.index >= 0 && std::size_t(status.index) < compiled.graph.nodes.size()) {
    const GraphNode& node = compiled.graph.nodes[std::size_t(status.index)];
    const int line = compiled.lines[std::size_t(status.index)];  // 0: of a compiled graph, which has no lines
    where += (line > 0 ? ":" + std::to_string(line) : "") + ": " + node.name;
    if (!node.clip.empty()) what += " ('" + node.clip + "')";
    for (const std::string& joint : node.look.joints)
      if (asset.skeleton.find(joint.c_str()) < 0) what += " ('" + joint + "')";
    for (const GraphTransition& t : node.transitions)
      if (!t.profile.empty() && asset.find_mask(t.profile) < 0) what += " ('" + t.profile + "')";
    for (const GraphLayer& layer : node.layers)
      for (const std::string& name : {layer.mask, layer.reference})
        if (!name.empty() && asset.find_mask(name) < 0 && asset.find_clip(name) < 0)
          what += " ('" + name + "')";
  }
  for (const GraphParameter& p : compiled.graph.parameters) {
    std::size_t mask = 0;
    if (status.index < 0 && physics_value(p.name, mask) >= 0 && mask > 0 &&
        asset.find_mask(p.name.substr(mask)) < 0)
      what += " ('" + p.name + "')";
  }
  return where + ": " + what;
}

}  // namespace sinew::graph_tools
