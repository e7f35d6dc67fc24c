// JSON that remembers in which line of its text everything stands.
#pragma once

#include <map>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <vector>

namespace sinew::graph_tools {

using Json = nlohmann::ordered_json;  ///< states and points keep their order

struct LocatedJson {
  Json value;
  std::map<std::string, int> lines;  ///< of JSON pointers ("/graph/states/walk")

  /// Of a value, or of the nearest around it.
  int line(std::string pointer) const;
};

/// A fault in a text: its line, and what is wrong there.
struct Fault : std::runtime_error {
  Fault(int at, const std::string& what) : std::runtime_error(what), line(at) {}
  int line;
};

/// Comments (// and /* */) are allowed. Throws Fault; also where a key stands twice.
LocatedJson parse_located(const std::string& text);

}  // namespace sinew::graph_tools
