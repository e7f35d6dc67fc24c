#include "convert/options.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "convert/roles.h"
#include "import/plain_words.h"

namespace sinew::convert {
namespace {

constexpr double kDegree = 3.14159265358979323846 / 180;

/// Faults of a value, as opposed to nlohmann's of a type.
struct BadOption : std::runtime_error {
  using std::runtime_error::runtime_error;
};

std::array<double, 2> ordered_pair(const nlohmann::json& value, double unit, const std::string& key) {
  const auto pair = value.get<std::array<double, 2>>();
  if (pair[0] > pair[1]) throw BadOption("option '" + key + "': the first number is above the second");
  return {pair[0] * unit, pair[1] * unit};
}

JointOptions parse_joint(const nlohmann::json& json, const std::string& joint) {
  JointOptions o;
  for (const auto& [key, value] : json.items()) {
    const std::string name = "joints." + joint + "." + key;
    if (key == "mass") {
      o.mass = value.get<double>();
      if (*o.mass <= 0) throw BadOption("option '" + name + "' is not positive");
    } else if (key == "torque") {
      o.torque = value.is_array() ? value.get<std::array<double, 2>>()
                                  : std::array<double, 2>{value.get<double>(), value.get<double>()};
      if ((*o.torque)[0] < 0 || (*o.torque)[1] < 0) throw BadOption("option '" + name + "' is negative");
    } else if (key == "range") {
      o.range = ordered_pair(value, kDegree, name);
    } else if (key == "twist") {
      o.twist = ordered_pair(value, kDegree, name);
    } else if (key == "swing") {
      o.swing = value.get<double>() * kDegree;
      if (*o.swing <= 0) throw BadOption("option '" + name + "' is not positive");
    } else if (key == "ellipsoid") {
      o.ellipsoid = value.get<bool>();
    } else {
      throw BadOption("unknown option '" + name + "'");
    }
  }
  return o;
}

std::map<std::string, double> parse_muscles(const nlohmann::json& json) {
  const std::map<std::string, double> known = muscle_rows({});
  auto rows = json.get<std::map<std::string, double>>();
  for (const auto& [name, value] : rows) {
    if (!known.count(name)) throw BadOption("unknown option 'muscles." + name + "'");
    if (value <= 0) throw BadOption("option 'muscles." + name + "' is not positive");
  }
  return rows;
}

/// Numbers beyond these are slips of the pen, and squares of them leave the range of floats.
void check_numbers(const nlohmann::json& value, const std::string& name) {
  constexpr double kLargest = 1e6;
  if (value.is_structured()) {
    for (const auto& [key, inner] : value.items()) check_numbers(inner, name + "." + key);
  } else if (value.is_number() && !(std::abs(value.get<double>()) <= kLargest)) {
    throw BadOption("option '" + name + "' is beyond a million");
  }
}

template <class Use>
bool each_named(const std::string& name, Skeleton& skeleton, Use use) {
  bool found = false;
  const Role role = role_from_name(name);
  for (int i = 0; i < skeleton.body_count; ++i) {
    Joint& joint = skeleton.joints[static_cast<std::size_t>(i)];
    if (joint.name != name && (role == Role::kNone || joint.role != role)) continue;
    use(joint);
    found = true;
  }
  return found;
}

}  // namespace

std::string reference_options() {
  return R"(// Options of `sinew convert --options FILE.json`. All are optional; these are the defaults.
{
  // Metres per unit of the source. 0: what the file says; where it says nothing or the character would be
  // taller than 5 m or shorter than 5 cm, guessed from the first frame's height and reported. Further files with
  // clips: by the lengths of their bones.
  "unit": 0,
  // Up axis of the source: "x", "y" or "z". "": what the file says, else the taller of y and z in the first frame;
  // of further files with clips, what brings their bones closest to the character's.
  "up": "",
  // Axis of the source that the character faces at rest: "x", "-x", "y", "-y", "z" or "-z". "": found by its toes,
  // else by its left and right, where names tell them.
  "facing": "",
  // Whose published strengths and segment masses: "male" or "female".
  "sex": "male",
  // Years; children are weaker per kg and slighter, the old are weaker. 0: an adult between 18 and 50.
  "age": 0,
  // Mass of the whole character, kg. 0: from the height by the body-mass index of the age, 22.5 kg/m² for adults
  // (WHO: 18.5–25); outside 1.4–2.1 m with the cube of the height.
  "total_mass": 0,
  // Replaces published strengths, N·m per kg of body mass, by name: { "knee_extension": 3.5 }. The names and values
  // are listed in tools/convert/README.md.
  "muscles": {},
  // Scales every muscle limit.
  "strength": 1,
  // What you know better, by joint name or role: { "head": { "mass": 5, "torque": [30, 50], "swing": 50,
  // "twist": [-60, 60] }, "shin_l": { "range": [-5, 150] } }. Masses in kg (the other joints make up the total),
  // torques in N·m (negative and positive direction; one number: both), angles in degrees: range of a hinge, swing
  // and twist of a ball joint. "ellipsoid": true lets a ball joint's torques fill an ellipsoid with those half axes.
  "joints": {},
  // Muscles are made at least this many times as strong as the character's own clips ask.
  "strength_margin": 1.5,
  // Fingers ride along with the hand unless this is true.
  "simulate_fingers": false,
  // URDF: true lets the root link move freely; false bolts it to the world.
  "free_base": true,
  // URDF: where ROS packages are, for meshes named package://NAME/…: { "NAME": "directory" } (sinew convert --package).
  "packages": {},
  // Clips of files for another skeleton are fitted to this one instead of refused (sinew convert --retarget).
  "retarget": false,
  // true refuses what would otherwise be repaired and reported (broken inertias, massless links).
  "strict": false,
  // Largest error of the fitted curves, mm in model space: the errors of all joints along the chain, at a point of
  // the skin of each joint, so many cm from it.
  "fit_error_mm": 1,
  "fit_distance_cm": 10,
  // What coarse curves and their rounding may each change accelerations by, root mean square: rad/s² of joints that
  // turn, m/s² of those that shift. Muscles feel accelerations, not millimetres: 0.1 m/s² are a hundredth of the
  // weight. Or a fiftieth of the curve's own acceleration, where that is more.
  "fit_angular_acceleration": 0.5,
  "fit_linear_acceleration": 0.1,
  // Degree of the curves: 5 for motion capture, 3 for clean authored keys.
  "fit_degree": 5,
  // Names of the clips to keep; empty: all.
  "clips": [],
  // What clips say beside their motion: events, curves, phase markers, masks, whether they loop. The same as in a
  // file SOURCE.clips.json beside the source; tools/convert/README.md shows one.
  "clip_data": {}
}
)";
}

Error Options::parse(const nlohmann::json& json, Options& out) {
  if (json.is_null()) return {};
  if (!json.is_object()) return {"options are not a JSON object"};
  Options o;
  std::string option;  // the one that is read
  try {
    for (const auto& [key, value] : json.items()) {
      option = key;
      if (key == "unit")
        o.unit = value.get<double>();
      else if (key == "up")
        o.up = value.get<std::string>();
      else if (key == "facing")
        o.facing = value.get<std::string>();
      else if (key == "total_mass")
        o.total_mass = value.get<double>();
      else if (key == "sex") {
        const auto sex = value.get<std::string>();
        if (sex != "male" && sex != "female") return {"option 'sex' is neither male nor female"};
        o.human.female = sex == "female";
      } else if (key == "age")
        o.human.age = value.get<double>();
      else if (key == "muscles")
        o.muscles = parse_muscles(value);
      else if (key == "joints") {
        for (const auto& [name, joint] : value.items()) {
          option = "joints." + name;
          o.joints[name] = parse_joint(joint, name);
        }
      } else if (key == "strength")
        o.strength = value.get<double>();
      else if (key == "strength_margin")
        o.strength_margin = value.get<double>();
      else if (key == "simulate_fingers")
        o.simulate_fingers = value.get<bool>();
      else if (key == "free_base")
        o.free_base = value.get<bool>();
      else if (key == "packages")
        o.packages = value.get<import::Packages>();
      else if (key == "retarget")
        o.retarget = value.get<bool>();
      else if (key == "strict")
        o.strict = value.get<bool>();
      else if (key == "fit_error_mm")
        o.fit_error_mm = value.get<double>();
      else if (key == "fit_distance_cm")
        o.fit_distance_cm = value.get<double>();
      else if (key == "fit_angular_acceleration")
        o.fit_angular = value.get<double>();
      else if (key == "fit_linear_acceleration")
        o.fit_linear = value.get<double>();
      else if (key == "fit_degree")
        o.fit_degree = value.get<int>();
      else if (key == "clips")
        o.clips = value.get<std::vector<std::string>>();
      else if (key == "clip_data") {
        if (Error error = o.clip_data.read(value)) return {"option 'clip_data': " + error.message};
      } else
        return {"unknown option '" + key + "'"};
      check_numbers(value, key);
      const bool negative = value.is_number() && value.get<double>() < 0;
      if (negative) return {"option '" + key + "' is negative"};
    }
  } catch (const nlohmann::json::exception& e) {
    return {"option '" + option + "' has the wrong type: " + import::plain_words(e)};
  } catch (const BadOption& e) {
    return {e.what()};
  }
  if (!o.up.empty() && o.up != "x" && o.up != "y" && o.up != "z") return {"option 'up' is not x, y or z"};
  const bool signed_axis = o.facing.size() == 2 && o.facing[0] == '-';
  if (!o.facing.empty() &&
      ((!signed_axis && o.facing.size() != 1) || o.facing.back() < 'x' || o.facing.back() > 'z'))
    return {"option 'facing' is not an axis: x, -x, y, -y, z or -z"};
  if (o.fit_degree != 3 && o.fit_degree != 5) return {"option 'fit_degree' is neither 3 nor 5"};
  if (o.fit_error_mm <= 0) return {"option 'fit_error_mm' is not positive"};
  out = o;
  return {};
}

Error override_masses(const Options& options, bool keep_total, Skeleton& skeleton) {
  const double total = skeleton.total_mass();
  std::vector<std::uint8_t> given(skeleton.joints.size(), 0);
  double fixed = 0, others = 0;
  for (const auto& [name, o] : options.joints) {
    const bool found = each_named(name, skeleton, [&, &o = o](Joint& joint) {
      if (!o.mass || joint.mass <= 0) return;
      joint.inertia *= *o.mass / joint.mass;
      joint.mass = *o.mass;
      given[static_cast<std::size_t>(&joint - skeleton.joints.data())] = 1;
    });
    if (!found) return {"option 'joints': it has no simulated joint or role '" + name + "'"};
  }
  for (std::size_t i = 0; i < skeleton.joints.size(); ++i)
    (given[i] ? fixed : others) += skeleton.joints[i].mass;
  if (!keep_total || fixed == 0 || others == 0) return {};
  if (fixed >= total) return {"option 'joints': the masses are more than the total"};
  for (std::size_t i = 0; i < skeleton.joints.size(); ++i) {
    if (given[i]) continue;
    skeleton.joints[i].mass *= (total - fixed) / others;
    skeleton.joints[i].inertia *= (total - fixed) / others;
  }
  return {};
}

void override_limits(const Options& options, Skeleton& skeleton) {
  for (const auto& [name, o] : options.joints)
    each_named(name, skeleton, [&o = o](Joint& joint) {
      for (int k = 0; k < dof_count(joint.type); ++k) {
        if (o.torque) {
          joint.dofs[k].torque_minus = (*o.torque)[0];
          joint.dofs[k].torque_plus = (*o.torque)[1];
        }
        if (o.range && joint.type == JointType::kRevolute) {
          joint.dofs[k].lower = (*o.range)[0];
          joint.dofs[k].upper = (*o.range)[1];
        }
      }
      if (joint.type != JointType::kBall) return;
      if (o.swing) joint.swing_limit = *o.swing;
      joint.ellipsoidal_limit = o.ellipsoid;
      if (o.twist) {
        joint.twist_lower = (*o.twist)[0];
        joint.twist_upper = (*o.twist)[1];
      }
    });
}

}  // namespace sinew::convert
