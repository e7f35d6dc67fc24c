// The page about a folder that was converted: every character with its picture, every refusal with its
// reason.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace sinew::cli {

/// HTML of what convert_folder() reports, without scripts. Pictures are `still` of each row, a path as the
/// page is to name it; rows without one have none.
std::string convert_page(const nlohmann::json& report);

}  // namespace sinew::cli
