#include "cli/evaluate.h"

#include <cmath>
#include <stdexcept>

#include "import/plain_words.h"
#include "sinew/residual/dynamics.h"

namespace sinew::cli {
namespace {

using nlohmann::json;

[[noreturn]] void fail(const std::string& what) {
  throw std::runtime_error(what);
}

double number(const json& v, const std::string& where) {
  if (!v.is_number() || !std::isfinite(v.get<double>())) fail("expected a finite number (" + where + ")");
  return v.get<double>();
}

void numbers(const json& v, std::size_t count, double* out, const std::string& where) {
  if (!v.is_array() || v.size() != count)
    fail("expected " + std::to_string(count) + " numbers (" + where + ")");
  for (std::size_t i = 0; i < count; ++i) out[i] = number(v[i], where);
}

Quat<double> quaternion(const json& v, const std::string& where) {
  double q[4];
  numbers(v, 4, q, where);
  Quat<double> r(q[0], q[1], q[2], q[3]);
  if (r.norm() < 1e-6) fail("a quaternion has length zero (" + where + ")");
  return r.normalized();
}

void read_joint(const Joint& joint, const json& v, const std::string& where, JointState& s) {
  if (!v.is_object()) fail("expected an object (" + where + ")");
  const int dofs = dof_count(joint.type);
  for (const auto& [key, value] : v.items()) {
    const std::string at = where + "." + key;
    if (key == "q") {
      if (joint.type == JointType::kBall)
        s.rotation = quaternion(value, at);
      else if (dofs == 1)
        s.q[0] = number(value, at);
      else
        numbers(value, static_cast<std::size_t>(std::min(dofs, 3)), s.q, at);
    } else if (key == "v" || key == "a") {
      double* to = key == "v" ? s.v : s.a;
      if (dofs == 1)
        to[0] = number(value, at);
      else
        numbers(value, static_cast<std::size_t>(dofs), to, at);
    } else {
      fail("unknown key '" + key + "' (" + where + ")");
    }
  }
}

void read_root(const json& v, JointState& s) {
  if (!v.is_object()) fail("expected an object (root)");
  for (const auto& [key, value] : v.items()) {
    const std::string where = "root." + key;
    if (key == "position")
      numbers(value, 3, s.position.data(), where);
    else if (key == "orientation")
      s.rotation = quaternion(value, where);
    else if (key == "linear_velocity")
      numbers(value, 3, s.v, where);
    else if (key == "angular_velocity")
      numbers(value, 3, s.v + 3, where);
    else if (key == "linear_acceleration")
      numbers(value, 3, s.a, where);
    else if (key == "angular_acceleration")
      numbers(value, 3, s.a + 3, where);
    else
      fail("unknown key '" + key + "' (root)");
  }
}

/// A joint by its own name or by the name of the URDF joint that moves it.
int find_joint(const Skeleton& s, const std::string& name) {
  for (int i = 0; i < s.body_count; ++i)
    if (!s.joints[i].source_joint.empty() && s.joints[i].source_joint == name) return i;
  const int i = s.find(name.c_str());
  return i < s.body_count ? i : -1;
}

json list(const Eigen::VectorXd& v) {
  return std::vector<double>(v.data(), v.data() + v.size());
}
json list(const Vec3<double>& v) {
  return json::array({v.x(), v.y(), v.z()});
}

std::vector<std::string> dof_names(const Skeleton& s) {
  static const char* const kFree[] = {"force_x", "force_y", "force_z", "torque_x", "torque_y", "torque_z"};
  static const char* const kAxes[] = {"x", "y", "z"};
  std::vector<std::string> names;
  for (int i = 0; i < s.body_count; ++i) {
    const Joint& joint = s.joints[i];
    const std::string name = joint.source_joint.empty() ? joint.name : joint.source_joint;
    const int dofs = dof_count(joint.type);
    for (int k = 0; k < dofs; ++k) {
      if (joint.type == JointType::kFree)
        names.push_back((joint.parent < 0 ? "root" : name) + "." + kFree[k]);
      else
        names.push_back(dofs == 1 ? name : name + "." + kAxes[k]);
    }
  }
  return names;
}

}  // namespace

convert::Error evaluate(const Skeleton& source, const json& state, bool fixed_base, json& out) {
  Skeleton skeleton = source;
  if (fixed_base && skeleton.joints[0].type == JointType::kFree) skeleton.joints[0].type = JointType::kFixed;
  std::vector<JointState> states(skeleton.body_count);
  Vec3<double> gravity(0, 0, -9.81);
  try {
    if (!state.is_null() && !state.is_object()) fail("the state is not a JSON object");
    if (state.is_object())
      for (const auto& [key, value] : state.items()) {
        if (key == "root") {
          read_root(value, states[0]);
          if (skeleton.joints[0].type == JointType::kFixed) {
            skeleton.joints[0].rest = {states[0].rotation, states[0].position};
            states[0] = {};
          }
        } else if (key == "gravity") {
          numbers(value, 3, gravity.data(), "gravity");
        } else if (key == "joints") {
          if (!value.is_object()) fail("expected an object (joints)");
          for (const auto& [name, joint] : value.items()) {
            const int i = find_joint(skeleton, name);
            if (i < 0) fail("unknown joint '" + name + "' (joints)");
            read_joint(skeleton.joints[i], joint, "joints." + name, states[i]);
          }
        } else {
          fail("unknown key '" + key + "'");
        }
      }
  } catch (const std::exception& e) {
    return {import::plain_words(e)};
  }
  const DynamicsResult r = evaluate_dynamics(skeleton, states, gravity);
  if (!std::isfinite(r.kinetic_energy + r.potential_energy) || !r.inverse_dynamics.allFinite() ||
      !r.forward_dynamics.allFinite())
    return {"the state leads to numbers that are not finite"};
  json matrix = json::array();
  for (Eigen::Index i = 0; i < r.mass_matrix.rows(); ++i)
    matrix.push_back(list(Eigen::VectorXd(r.mass_matrix.row(i))));
  json frames = json::object();
  for (std::size_t i = 0; i < r.frames.size(); ++i) {
    const Quat<double>& q = r.frames[i].rotation;
    frames[skeleton.joints[i].name] = {{"position", list(r.frames[i].translation)},
                                       {"orientation", {q.w(), q.x(), q.y(), q.z()}}};
  }
  out = {{"dof_names", dof_names(skeleton)},
         {"total_mass", r.total_mass},
         {"center_of_mass", list(r.center_of_mass)},
         {"kinetic_energy", r.kinetic_energy},
         {"potential_energy", r.potential_energy},
         {"inverse_dynamics", list(r.inverse_dynamics)},
         {"mass_matrix", matrix},
         {"forward_dynamics", list(r.forward_dynamics)},
         {"frames", frames}};
  return {};
}

}  // namespace sinew::cli
