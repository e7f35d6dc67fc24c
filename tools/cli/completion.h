// Completion of the command line in shells, made from its definitions.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace sinew::cli {

/// The script for "bash", "zsh" or "fish". `description`: of the program, see describe().
std::string completion(const std::string& shell, const nlohmann::json& description);

}  // namespace sinew::cli
