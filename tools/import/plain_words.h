// Exceptions of libraries in words that a person can use.
#pragma once

#include <exception>
#include <new>
#include <string>

namespace sinew::import {

/// What an exception says, without the name that nlohmann::json puts before it
/// ("[json.exception.parse_error.101] parse error at line 1, …"): "line 1, column 2: …".
inline std::string plain_words(const std::exception& fault) {
  if (dynamic_cast<const std::bad_alloc*>(&fault) != nullptr) return "memory ran out";
  std::string what = fault.what();
  for (const std::string name : {"[json.exception.", "parse error at ", "parse error: "}) {
    if (what.rfind(name, 0) != 0) continue;
    const std::size_t end = name[0] == '[' ? what.find("] ") : name.size() - 2;
    what.erase(0, end == std::string::npos ? name.size() : end + 2);
  }
  return what;
}

}  // namespace sinew::import
