#include "convert/options.h"

namespace sinew::convert {

std::string reference_options() {
  return R"(// Options of `sinew convert --options FILE.json`. All are optional; these are the defaults.
{
  // Metres per unit of the source. 0: what the file says; where it says nothing or the character would be
  // taller than 5 m or shorter than 5 cm, guessed from the first frame's height and reported.
  "unit": 0,
  // Up axis of the source: "x", "y" or "z". "": what the file says, else the taller of y and z in the first frame.
  "up": "",
  // Mass of the whole character, kg. 0: from the height by the body-mass index of adults, 22.5 kg/m² (WHO: 18.5–25).
  "total_mass": 0,
  // Scales every muscle limit (published strength per kg of body mass, see tools/convert/README.md).
  "strength": 1,
  // Muscles are made at least this many times as strong as the character's own clips ask.
  "strength_margin": 1.5,
  // Fingers ride along with the hand unless this is true.
  "simulate_fingers": false,
  // URDF: true lets the root link move freely; false bolts it to the world.
  "free_base": true,
  // true refuses what would otherwise be repaired and reported (broken inertias, massless links).
  "strict": false,
  // Largest error of the fitted curves, mm at a point 10 cm from the joint.
  "fit_error_mm": 1,
  // Degree of the curves: 5 for motion capture, 3 for clean authored keys.
  "fit_degree": 5,
  // Names of the clips to keep; empty: all.
  "clips": []
}
)";
}

Error Options::parse(const nlohmann::json& json, Options& out) {
  if (json.is_null()) return {};
  if (!json.is_object()) return {"options are not a JSON object"};
  Options o;
  try {
    for (const auto& [key, value] : json.items()) {
      if (key == "unit")
        o.unit = value.get<double>();
      else if (key == "up")
        o.up = value.get<std::string>();
      else if (key == "total_mass")
        o.total_mass = value.get<double>();
      else if (key == "strength")
        o.strength = value.get<double>();
      else if (key == "strength_margin")
        o.strength_margin = value.get<double>();
      else if (key == "simulate_fingers")
        o.simulate_fingers = value.get<bool>();
      else if (key == "free_base")
        o.free_base = value.get<bool>();
      else if (key == "strict")
        o.strict = value.get<bool>();
      else if (key == "fit_error_mm")
        o.fit_error_mm = value.get<double>();
      else if (key == "fit_degree")
        o.fit_degree = value.get<int>();
      else if (key == "clips")
        o.clips = value.get<std::vector<std::string>>();
      else
        return {"unknown option '" + key + "'"};
      const bool negative = value.is_number() && value.get<double>() < 0;
      if (negative) return {"option '" + key + "' is negative"};
    }
  } catch (const nlohmann::json::exception& e) {
    return {std::string("option has the wrong type: ") + e.what()};
  }
  if (!o.up.empty() && o.up != "x" && o.up != "y" && o.up != "z") return {"option 'up' is not x, y or z"};
  if (o.fit_degree != 3 && o.fit_degree != 5) return {"option 'fit_degree' is neither 3 nor 5"};
  if (o.fit_error_mm <= 0) return {"option 'fit_error_mm' is not positive"};
  out = o;
  return {};
}

}  // namespace sinew::convert
