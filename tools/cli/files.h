// Small file helpers of the command: whole files in, atomic files out.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "convert/convert.h"

namespace sinew::cli {

/// Why a file cannot be made there: asked before any work is done for it.
convert::Error check_writable(const std::string& path);

/// Whether every output can be written, none of them is an input, and no two are one file; empty names are
/// none.
convert::Error check_outputs(const std::vector<std::string>& outputs, const std::vector<std::string>& inputs);

/// Writes to a temporary file in the same directory and renames: readers see the old file or the new one,
/// never half.
convert::Error write_atomically(const std::string& path, const void* data, std::size_t size);
convert::Error write_atomically(const std::string& path, const std::string& text);

/// What a run's telemetry is written as: a summary in .json, else a table. Files that hold pictures are
/// refused.
convert::Error telemetry_format(const std::string& path, bool& as_json);

convert::Error read_json(const std::string& path, nlohmann::json& out);

/// "WHAT 210 of 900, 34 s left" on standard error: on a terminal one line that changes, from the
/// second second on; elsewhere a line every ten seconds; with --quiet none.
std::function<void(int, int)> progress_line(const std::string& what);

/// JSON in one line, or indented; bytes of file names that are not UTF-8 become U+FFFD.
template <class Json = nlohmann::json>
std::string json_text(const Json& json, int indent = -1) {
  return json.dump(indent, ' ', false, Json::error_handler_t::replace);
}

}  // namespace sinew::cli
