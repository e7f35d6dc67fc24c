// Manual pages, made from the definitions of the command line.
#pragma once

#include <map>
#include <nlohmann/json.hpp>
#include <string>

namespace sinew::cli {

/// Pages by file name: sinew.1, and one for each command with all that stands below it (sinew-convert.1), in
/// man(7). `description`: of the program, see describe().
std::map<std::string, std::string> man_pages(const nlohmann::json& description);

}  // namespace sinew::cli
