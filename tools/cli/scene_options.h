// Scene files as the commands take them.
#pragma once

#include <CLI/CLI.hpp>
#include <string>

#include "convert/convert.h"
#include "scene/scene.h"

namespace sinew::cli {

/// Option --scheme.
void add_scheme(CLI::App& app, std::string& scheme);

/// A scene file, stepped by another scheme than it asks for where one is named.
convert::Error load_scene(const std::string& file, const std::string& scheme, scene::Scene& scene);

}  // namespace sinew::cli
