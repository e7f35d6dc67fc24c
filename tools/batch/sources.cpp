#include "batch/sources.h"

#include <cctype>

namespace sinew::batch {

namespace fs = std::filesystem;
using convert::Error;

const std::set<std::string>& source_endings() {
  static const std::set<std::string> kEndings = {".glb", ".gltf", ".fbx", ".bvh", ".dae", ".urdf"};
  return kEndings;
}

std::string lower(std::string text) {
  for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return text;
}

Error find_sources(const fs::path& input, const std::set<std::string>& endings,
                   std::map<fs::path, fs::path>& found) {
  std::error_code code;
  if (!fs::is_directory(input, code)) {
    found[input] = input.filename();
    return {};
  }
  fs::recursive_directory_iterator at(input, fs::directory_options::skip_permission_denied, code);
  if (code) return {input.string() + ": cannot be searched: " + code.message()};
  for (; at != fs::recursive_directory_iterator(); at.increment(code)) {
    if (code) return {input.string() + ": cannot be searched: " + code.message()};
    if (at->is_regular_file(code) && endings.count(lower(at->path().extension().string())) > 0)
      found[at->path()] = at->path().lexically_relative(input);
  }
  return {};
}

Error name_outputs(const std::map<fs::path, fs::path>& found, const std::string& ending,
                   std::map<fs::path, fs::path>& names) {
  std::map<fs::path, int> wanted;
  for (const auto& [source, place] : found) ++wanted[fs::path(place).replace_extension()];
  std::map<fs::path, fs::path> taken;
  for (const auto& [source, place] : found) {
    fs::path name = fs::path(place).replace_extension();
    if (wanted[name] > 1) name = place;
    name += ending;
    if (const auto [other, fresh] = taken.emplace(name, source); !fresh)
      return {source.string() + ": would become the same file as " + other->second.string()};
    names[source] = name;
  }
  return {};
}

}  // namespace sinew::batch
