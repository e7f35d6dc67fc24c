// How a mechanism file is told from others.
#pragma once

#include <nlohmann/json.hpp>

namespace sinew::mechanism {

/// True for JSON that declares itself a mechanism.
inline bool is_mechanism(const nlohmann::json& file) {
  return file.is_object() && file.contains("format") && file.at("format") == "sinew-mechanism";
}

}  // namespace sinew::mechanism
