#include "cli/scene_options.h"

namespace sinew::cli {

void add_scheme(CLI::App& app, std::string& scheme) {
  app.add_option("--scheme", scheme,
                 "scenes: bossak (the runtime's), or for comparison bdf1, bdf2, momentum, semi_implicit, "
                 "forward_euler")
      ->type_name("NAME")
      ->default_str("the scene's");
}

convert::Error load_scene(const std::string& file, const std::string& scheme, scene::Scene& scene) {
  if (convert::Error error = scene::load_scene(file, scene)) return error;
  if (scheme.empty()) return {};
  const auto named = study::scheme_named(scheme);
  if (!named) return {"there is no scheme '" + scheme + "'"};
  scene.scheme = *named;
  return {};
}

}  // namespace sinew::cli
