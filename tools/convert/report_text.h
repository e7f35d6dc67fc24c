// A conversion's report as text for a terminal.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace sinew::convert {

enum class Detail {
  kFolded,  ///< ten lines at most: clips summed up where there are many, what does not fit counted
  kWhole,
};

/// Lines of `report`, as convert_files fills it.
std::string report_text(const nlohmann::json& report, Detail detail);

}  // namespace sinew::convert
