// Files of a kind below folders.
#pragma once

#include <filesystem>
#include <map>
#include <set>
#include <string>

#include "convert/convert.h"

namespace sinew::batch {

/// Endings of what `sinew convert` reads, in small letters.
const std::set<std::string>& source_endings();

std::string lower(std::string text);

/// Adds the files of these endings below a folder, with their places in it, in the order of their names. A
/// file is added as it is.
convert::Error find_sources(const std::filesystem::path& input, const std::set<std::string>& endings,
                            std::map<std::filesystem::path, std::filesystem::path>& found);

/// Names of what is made of them: their places with another ending. Sources that differ by their endings
/// alone keep these (hero.fbx.sinew). The error: two would become the same.
convert::Error name_outputs(const std::map<std::filesystem::path, std::filesystem::path>& found,
                            const std::string& ending,
                            std::map<std::filesystem::path, std::filesystem::path>& names);

}  // namespace sinew::batch
