#include "cli/render_folder.h"

#include <unistd.h>

#include <cstdio>
#include <filesystem>
#include <map>
#include <numeric>
#include <set>

#include "batch/processes.h"
#include "batch/sources.h"
#include "cli/files.h"
#include "cli/terminal.h"
#include "render/contact_sheet.h"

namespace sinew::cli {
namespace {

namespace fs = std::filesystem;
using batch::Finished;
using convert::Error;
using nlohmann::json;

struct Entry {
  fs::path source, output, still;  ///< the same, where stills are asked for
  std::string error;
};

Error plan(const FolderRender& what, std::vector<Entry>& entries) {
  std::map<fs::path, fs::path> found, names;
  std::set<std::string> endings = batch::source_endings();
  endings.insert(".sinew");
  if (Error error = batch::find_sources(what.input, endings, found)) return error;
  if (found.empty()) return {what.input + ": no asset and no glTF, FBX, BVH, COLLADA or URDF file in it"};
  if (Error error = batch::name_outputs(found, what.still ? ".png" : ".mp4", names)) return error;
  const fs::path root = what.output, stills = what.still ? root : root / ".sinew";
  for (const auto& [source, name] : names)
    entries.push_back({source, root / name, stills / fs::path(name).replace_extension(".png"), ""});
  return {};
}

Error make_directories(const std::vector<Entry>& entries, const fs::path& root) {
  std::set<fs::path> wanted = {root / ".sinew"};
  for (const Entry& entry : entries) wanted.insert({entry.output.parent_path(), entry.still.parent_path()});
  for (const fs::path& path : wanted) {
    std::error_code code;
    fs::create_directories(path, code);
    if (code) return {path.string() + ": cannot be made: " + code.message()};
    batch::clear_leftovers(path);
  }
  return {};
}

/// Items below the number of entries are what is asked for, the others small pictures for the sheet.
std::vector<std::string> command(const std::vector<Entry>& entries, const FolderRender& what,
                                 std::size_t item) {
  const bool small = item >= entries.size();
  const Entry& entry = entries[item % entries.size()];
  std::vector<std::string> words = {"render", entry.source.string(), "-q", "-o",
                                    (small ? entry.still : entry.output).string()};
  static const std::set<std::string> kOfLarge = {"--size", "--no-overlay", "--turntable", "--frames"};
  for (const std::vector<std::string>& option : what.options)
    if (!small || kOfLarge.count(option[0]) == 0) words.insert(words.end(), option.begin(), option.end());
  if (small) words.insert(words.end(), {"--size", "240x240", "--no-overlay"});
  return words;
}

json report_of(const std::vector<Entry>& entries, const std::vector<std::string>& sheets) {
  json rows = json::array();
  for (const Entry& entry : entries) {
    json row = {{"source", entry.source.string()}};
    if (entry.error.empty())
      row["output"] = entry.output.string();
    else
      row["error"] = entry.error;
    rows.push_back(std::move(row));
  }
  return {{"files", rows}, {"contact_sheets", sheets}};
}

}  // namespace

Error render_folder(const FolderRender& what, int& failed) {
  std::vector<Entry> entries;
  if (Error error = plan(what, entries)) return error;
  if (Error error = make_directories(entries, what.output)) return error;
  std::vector<std::size_t> items(what.still ? entries.size() : 2 * entries.size());
  std::iota(items.begin(), items.end(), std::size_t{0});
  batch::run_processes(
      {what.jobs, fs::path(what.output) / ".sinew", 0, "rendering"}, items,
      [&](std::size_t item) { return command(entries, what, item); },
      [&](const Finished& process) {
        if (!process.succeeded())
          entries[process.item % entries.size()].error = batch::reason(process, "sinew render");
      });
  std::vector<render::SheetEntry> sheet;
  for (const Entry& entry : entries)
    sheet.push_back({entry.output.lexically_relative(what.output).string(),
                     entry.error.empty() ? entry.still.string() : "", entry.error});
  std::vector<std::string> sheets;
  if (Error error =
          render::write_contact_sheets(sheet, (fs::path(what.output) / "contact_sheet.png").string(), sheets))
    return error;
  for (const Entry& entry : entries) {
    failed += entry.error.empty() ? 0 : 1;
    if (what.json) continue;
    if (entry.error.empty())
      say("%s\n", entry.output.c_str());
    else
      say("%s      %s\n", styled("FAILED", Style::kRed, STDOUT_FILENO).c_str(), entry.error.c_str());
  }
  if (what.json)
    std::puts(json_text(report_of(entries, sheets)).c_str());
  else
    say("%zu rendered, %d failed; %s\n", entries.size() - std::size_t(failed), failed, sheets[0].c_str());
  return {};
}

}  // namespace sinew::cli
