#include "batch/merge.h"

#include <unistd.h>

#include "batch/processes.h"
#include "batch/results.h"
#include "cli/files.h"

namespace sinew::batch {
namespace {

namespace fs = std::filesystem;
using convert::Error;
using nlohmann::json;

/// Where a file of a result goes: out.sinew becomes the unit's name, out_0001.png NAME_0001.png; a study's
/// files stand below it.
std::string place_of(const Unit& unit, const std::string& file) {
  if (unit.kind == "study") return unit.name + "/" + file;
  const std::string stem = unit.name.substr(0, unit.name.size() - unit.ending.size());
  return stem + file.substr(std::string("out").size());
}

Error put(const fs::path& from, const fs::path& to) {
  std::error_code code;
  fs::create_directories(to.parent_path(), code);
  fs::create_hard_link(from, to, code);
  if (code) fs::copy_file(from, to, code);
  return code ? Error{to.string() + ": cannot be written: " + code.message()} : Error{};
}

/// One unit's files, and its row of the report.
Error add_unit(const Plan& plan, const Unit& unit, const Result& result, const fs::path& into, json& rows) {
  json row = {{"name", unit.name}, {"kind", unit.kind}, {"key", unit.key}, {"state", result.state}};
  if (result.state == "failed") {
    row["error"] = result.error;
  } else {
    row["files"] = json::array();
    for (const json& file : result.files) {
      const std::string place = place_of(unit, file.at(0));
      if (Error error =
              put(result_directory(plan, unit) / "files" / file.at(0).get<std::string>(), into / place))
        return error;
      row["files"].push_back({{"file", place}, {"bytes", file.at(1)}, {"digest", file.at(2)}});
    }
  }
  rows.push_back(std::move(row));
  return {};
}

Error fill(const Plan& plan, const fs::path& into, Merged& out) {
  json rows = json::array();
  for (int shard = 1; shard <= plan.shards; ++shard) {
    std::vector<Unit> units;
    if (Error error = read_shard(plan, shard, units)) return error;
    for (const Unit& unit : units) {
      const Result result = find_result(plan, unit, true);
      if (result.state.empty()) {
        if (out.open.empty() || out.open.back() != shard) out.open.push_back(shard);
        continue;
      }
      ++(result.state == "done" ? out.done : out.failed);
      if (out.open.empty())
        if (Error error = add_unit(plan, unit, result, into, rows)) return error;
    }
  }
  const json report = {
      {"units", out.done + out.failed}, {"done", out.done}, {"failed", out.failed}, {"rows", rows}};
  return cli::write_atomically((into / "report.json").string(), cli::json_text(report, 1) + "\n");
}

}  // namespace

Error merge_results(const Plan& plan, const fs::path& directory, Merged& out) {
  out = {};
  const fs::path end = fs::absolute(directory).lexically_normal();
  const fs::path fresh = end.string() + ".tmp" + std::to_string(getpid()),
                 old = end.string() + ".old" + std::to_string(getpid());
  std::error_code code, ignored;
  if (fs::exists(end, code) && !fs::exists(end / "report.json", code))
    return {directory.string() + ": is there, and no result of an earlier merge"};
  fs::create_directories(fresh, code);
  if (code) return {fresh.string() + ": cannot be made: " + code.message()};
  const Error error = fill(plan, fresh, out);
  if (error || !out.open.empty()) {
    fs::remove_all(fresh, ignored);
    return error;
  }
  fs::rename(end, old, ignored);
  fs::rename(fresh, end, code);
  fs::remove_all(old, ignored);
  return code ? Error{directory.string() + ": cannot be made: " + code.message()} : Error{};
}

}  // namespace sinew::batch
