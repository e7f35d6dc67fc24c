#include "mechanism/mechanism_file.h"

#include <cmath>
#include <cstdio>
#include <fstream>
#include <map>
#include <stdexcept>

#include "import/plain_words.h"

namespace sinew::mechanism {
namespace {

using multibody::Force;
using multibody::ForceType;
using multibody::kGround;
using multibody::Loop;
using multibody::LoopType;
using multibody::Mechanism;
using multibody::Pulse;
using multibody::SpringMode;
using nlohmann::json;

[[noreturn]] void fail(const std::string& what) {
  throw std::runtime_error(what);
}

/// One element of the file with its name for messages.
class Reader {
 public:
  Reader(const json& element, std::string who) : json_(element), who_(std::move(who)) {
    if (!json_.is_object()) fail(who_ + " is not an object");
  }

  const std::string& who() const { return who_; }
  bool has(const char* key) const { return json_.contains(key); }

  double number(const char* key) const {
    const json& v = at(key);
    if (!v.is_number() || !std::isfinite(v.get<double>()))
      fail(who_ + ": '" + key + "' is not a finite number");
    return v.get<double>();
  }
  double number(const char* key, double fallback) const { return has(key) ? number(key) : fallback; }

  std::string text(const char* key) const {
    const json& v = at(key);
    if (!v.is_string()) fail(who_ + ": '" + key + "' is not a string");
    return v.get<std::string>();
  }

  template <int N>
  Eigen::Matrix<double, N, 1> numbers(const char* key) const {
    const json& v = at(key);
    if (!v.is_array() || v.size() != N)
      fail(who_ + ": '" + key + "' is not a list of " + std::to_string(N) + " numbers");
    Eigen::Matrix<double, N, 1> out;
    for (int i = 0; i < N; ++i) {
      if (!v[i].is_number() || !std::isfinite(v[i].get<double>()))
        fail(who_ + ": '" + key + "' has an entry that is not a finite number");
      out[i] = v[i].get<double>();
    }
    return out;
  }

  std::vector<Pulse> pulses(const char* key) const {
    std::vector<Pulse> out;
    if (!has(key)) return out;
    if (!at(key).is_array()) fail(who_ + ": '" + key + "' is not a list");
    for (const json& p : at(key)) {
      const Reader term(p, who_ + ": " + key);
      out.push_back({term.number("A"), term.number("t0"), term.number("w")});
    }
    return out;
  }

  const json& at(const char* key) const {
    if (!has(key)) fail(who_ + ": '" + key + "' is missing");
    return json_.at(key);
  }

 private:
  const json& json_;
  std::string who_;
};

const json& list(const json& file, const char* key, bool required) {
  static const json empty = json::array();
  if (!file.contains(key)) {
    if (required) fail(std::string("'") + key + "' is missing");
    return empty;
  }
  if (!file.at(key).is_array()) fail(std::string("'") + key + "' is not a list");
  return file.at(key);
}

/// Calls read(element, reader) for each element of a list, whose names must differ.
template <class Read>
void each(const json& file, const char* key, const char* kind, bool required, Read read) {
  std::map<std::string, int> seen;
  int index = 0;
  for (const json& element : list(file, key, required)) {
    const Reader anonymous(element, std::string(kind) + " number " + std::to_string(index + 1));
    const std::string name = anonymous.text("name");
    const std::string who = std::string(kind) + " '" + name + "'";
    if (!seen.emplace(name, index).second) fail(who + " occurs twice");
    read(name, Reader(element, who));
    ++index;
  }
}

class BodyNames {
 public:
  void add(const std::string& name) { index_.emplace(name, static_cast<int>(index_.size())); }
  int find(const Reader& r, const char* key) const {
    const std::string name = r.text(key);
    if (name == "ground") return kGround;
    const auto found = index_.find(name);
    if (found == index_.end())
      fail(r.who() + " refers to body '" + name + "' (" + key + "), which does not exist");
    return found->second;
  }

 private:
  std::map<std::string, int> index_;
};

void read_bodies(const json& file, Mechanism& out, BodyNames& names) {
  each(file, "bodies", "body", true, [&](const std::string& name, const Reader& r) {
    if (name == "ground") fail("a body cannot be called 'ground'");
    multibody::Body& b = out.bodies.emplace_back();
    b.name = name;
    names.add(name);
    b.mass = r.number("mass");
    b.center_of_mass = r.numbers<3>("com");
    const Eigen::Matrix<double, 6, 1> i = r.numbers<6>("inertia");  // xx yy zz xy xz yz
    b.inertia << i[0], i[3], i[4], i[3], i[1], i[5], i[4], i[5], i[2];
  });
}

void read_joints(const json& file, Mechanism& out, const BodyNames& names) {
  each(file, "joints", "joint", true, [&](const std::string& name, const Reader& r) {
    multibody::HingeOrSlider& j = out.joints.emplace_back();
    j.name = name;
    const std::string type = r.text("type");
    if (type == "revolute")
      j.type = JointType::kRevolute;
    else if (type == "prismatic")
      j.type = JointType::kPrismatic;
    else
      fail(r.who() + " has the unknown type '" + type + "' (revolute, prismatic)");
    j.parent = names.find(r, "parent");
    j.child = names.find(r, "child");
    if (j.child == kGround) fail(r.who() + " has the ground as its child");
    j.anchor = r.numbers<3>("anchor");
    j.axis = r.numbers<3>("axis");
    j.q0 = r.number("q0", 0);
    j.qd0 = r.number("qd0", 0);
    j.force.stiffness = r.number("stiffness", 0);
    j.force.stiffness_cubic = r.number("stiffness_cubic", 0);
    j.force.damping = r.number("damping", 0);
    j.force.friction_force = r.number("friction_force", 0);
    j.force.friction_speed = r.number("friction_v0", 1);
    j.force.rest = r.number("q_rest", 0);
    j.force.rest_profile = r.pulses("rest_profile");
  });
}

void read_loops(const json& file, Mechanism& out, const BodyNames& names) {
  each(file, "loops", "loop", false, [&](const std::string& name, const Reader& r) {
    Loop& l = out.loops.emplace_back();
    l.name = name;
    l.body_a = names.find(r, "body_a");
    l.body_b = names.find(r, "body_b");
    const std::string type = r.text("type");
    if (type == "distance") {
      l.type = LoopType::kDistance;
      l.point_a = r.numbers<3>("point_a");
      l.point_b = r.numbers<3>("point_b");
      const double apart = (l.point_b - l.point_a).norm();
      if (r.has("length") && std::abs(r.number("length") - apart) > 1e-6 * std::max(1.0, apart))
        fail(r.who() + ": 'length' is not the distance of its points in the reference configuration");
    } else if (type == "point" || type == "revolute") {
      l.type = type == "point" ? LoopType::kPoint : LoopType::kRevolute;
      l.point_a = l.point_b = r.numbers<3>("anchor");
      if (l.type == LoopType::kRevolute) l.axis = r.numbers<3>("axis");
    } else {
      fail(r.who() + " has the unknown type '" + type + "' (point, distance, revolute)");
    }
  });
}

void read_force(const Reader& r, const BodyNames& names, Force& f) {
  const std::string type = r.text("type");
  const auto on_point = [&] {
    f.body_a = names.find(r, "body");
    f.point_a = r.numbers<3>("point");
  };
  const auto spring = [&] {
    f.k = r.number("k");
    f.c = r.number("c", 0);
    f.eps = r.number("eps", f.eps);
  };
  if (type == "spring_damper") {
    f.type = ForceType::kSpringDamper;
    f.body_a = names.find(r, "body_a");
    f.body_b = names.find(r, "body_b");
    f.point_a = r.numbers<3>("point_a");
    f.point_b = r.numbers<3>("point_b");
    f.rest_length = r.number("l0");
    const std::string mode = r.has("mode") ? r.text("mode") : "both";
    if (mode == "tension")
      f.mode = SpringMode::kTension;
    else if (mode == "compression")
      f.mode = SpringMode::kCompression;
    else if (mode != "both")
      fail(r.who() + " has the unknown mode '" + mode + "' (both, tension, compression)");
    spring();
  } else if (type == "anchor_spring") {
    f.type = ForceType::kAnchorSpring;
    on_point();
    f.point_b = r.numbers<3>("anchor");
    spring();
  } else if (type == "contact_plane") {
    f.type = ForceType::kContactPlane;
    on_point();
    f.body_b = names.find(r, "plane_body");
    f.point_b = r.numbers<3>("plane_point");
    f.direction = r.numbers<3>("normal");
    spring();
  } else if (type == "tyre") {
    f.type = ForceType::kTyre;
    on_point();
    spring();
    f.radius = r.number("radius");
    f.c_lateral = r.number("c_lateral", 0);
    if (f.c_lateral != 0) f.direction = r.numbers<3>("lateral_axis");
    f.road = r.pulses("road");
  } else if (type == "torque") {
    f.type = ForceType::kTorque;
    f.body_a = names.find(r, "body");
    f.direction = r.numbers<3>("torque");
  } else {
    fail(r.who() + " has the unknown type '" + type +
         "' (spring_damper, anchor_spring, contact_plane, tyre, torque)");
  }
}

void read(const json& file, Mechanism& out) {
  if (!is_mechanism(file)) fail("not a mechanism: 'format' is not \"sinew-mechanism\"");
  const Reader top(file, "the file");
  if (top.number("version") != 1) fail("'version' is not 1");
  out.name = top.has("name") ? top.text("name") : "mechanism";
  if (top.has("gravity")) out.gravity = top.numbers<3>("gravity");
  out.t_end = top.number("t_end", 1);
  BodyNames names;
  read_bodies(file, out, names);
  read_joints(file, out, names);
  read_loops(file, out, names);
  each(file, "forces", "force", false, [&](const std::string& name, const Reader& r) {
    Force& f = out.forces.emplace_back();
    f.name = name;
    read_force(r, names, f);
  });
  each(file, "points", "point", false, [&](const std::string& name, const Reader& r) {
    out.points.push_back({name, names.find(r, "body"), r.numbers<3>("point")});
  });
}

}  // namespace

std::string from_json(const json& file, Mechanism& out) {
  out = {};
  try {
    read(file, out);
  } catch (const std::exception& e) {
    return import::plain_words(e);
  }
  return multibody::fault_of(out);
}

std::string load_mechanism(const std::string& path, Mechanism& out) {
  std::ifstream stream(path);
  if (!stream) return path + ": file cannot be opened";
  json file;
  try {
    file = json::parse(stream, nullptr, true, true);
  } catch (const json::exception& e) {
    return path + ": not JSON: " + import::plain_words(e);
  }
  const std::string fault = from_json(file, out);
  return fault.empty() ? fault : path + ": " + fault;
}

std::string samples_csv(const multibody::Model& model, const multibody::SimulationResult& result) {
  const Mechanism& m = model.mechanism();
  std::string csv = "t";
  for (const auto& j : m.joints) csv += ",q:" + j.name;
  for (const auto& j : m.joints) csv += ",u:" + j.name;
  for (const auto& p : m.points) csv += ",x:" + p.name + ",y:" + p.name + ",z:" + p.name;
  csv += ",kinetic,potential\n";
  char digits[40];
  const auto add = [&](double x) {
    std::snprintf(digits, sizeof digits, ",%.17g", x);
    csv += digits;
  };
  for (const multibody::Sample& s : result.samples) {
    std::snprintf(digits, sizeof digits, "%.17g", s.t);
    csv += digits;
    for (Eigen::Index i = 0; i < s.y.size(); ++i) add(s.y[i]);
    for (const Vec3<double>& p : s.points)
      for (int a = 0; a < 3; ++a) add(p[a]);
    add(s.kinetic);
    add(s.potential);
    csv += "\n";
  }
  return csv;
}

}  // namespace sinew::mechanism
