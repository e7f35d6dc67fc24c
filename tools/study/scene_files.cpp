// Which scene file is the set-up of which hard case.
#include <algorithm>
#include <iterator>

#include "study/hard_case.h"

namespace sinew::study {
namespace {

struct Sceneless {
  const char* name;
  const char* why;
};

constexpr Sceneless kSceneless[] = {
    {"baked_limbs", "two worlds side by side, with and without baking"},
    {"denormal_speeds", "300 equal balls, of speeds that no file would hold"},
    {"soak_hour", "an hour of pushes, teleports and strengths that are drawn as it goes"},
    {"random_trees", "20000 trees, each made from its seed"},
};

}  // namespace

const char* why_without_scene(const std::string& name) {
  const auto found = std::find_if(std::begin(kSceneless), std::end(kSceneless),
                                  [&](const Sceneless& s) { return name == s.name; });
  return found == std::end(kSceneless) ? nullptr : found->why;
}

std::string scene_file(const HardCase& hard_case) {
  if (why_without_scene(hard_case.name)) return "";
  const std::string name = hard_case.scene ? hard_case.scene : hard_case.name;
  return SINEW_ASSETS_DIR "/scenes/hard_cases/" + name + ".json";
}

std::string set_up_of(const HardCase& hard_case) {
  const std::string file = scene_file(hard_case);
  return file.empty() ? std::string("no scene file: ") + why_without_scene(hard_case.name) : "scene: " + file;
}

}  // namespace sinew::study
