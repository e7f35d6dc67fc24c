#include "batch/results.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>

#include "batch/digest.h"
#include "batch/processes.h"
#include "cli/files.h"

namespace sinew::batch {
namespace {

namespace fs = std::filesystem;
using convert::Error;
using nlohmann::json;

fs::path below(const Plan& plan, const char* what, const Unit& unit) {
  return plan.directory / what / unit.key.substr(0, 2) / unit.key;
}

std::string machine() {
  char name[256] = {};
  gethostname(name, sizeof name - 1);
  std::string text = name;
  std::replace(text.begin(), text.end(), '.', '_');  // parts of a work directory's name are parted by dots
  return text;
}

void flush(const fs::path& path) {
  const int file = open(path.c_str(), O_RDONLY);
  if (file < 0) return;
  fsync(file);
  close(file);
}

/// [name, bytes, digest] of every file, by name.
json list_files(const fs::path& directory) {
  std::vector<fs::path> paths;
  std::error_code code;
  for (fs::recursive_directory_iterator at(directory, code);
       !code && at != fs::recursive_directory_iterator(); at.increment(code))
    if (at->is_regular_file()) paths.push_back(at->path());
  std::sort(paths.begin(), paths.end());
  json all = json::array();
  for (const fs::path& path : paths) {
    flush(path);
    all.push_back({path.lexically_relative(directory).generic_string(), fs::file_size(path, code),
                   digest_of_file(path)});
  }
  return all;
}

bool are_there(const fs::path& directory, const json& files, bool whole) {
  for (const json& file : files) {
    const fs::path path = directory / file.at(0).get<std::string>();
    std::error_code code;
    if (fs::file_size(path, code) != file.at(1).get<std::uintmax_t>() || code) return false;
    if (whole && digest_of_file(path) != file.at(2).get<std::string>()) return false;
  }
  return true;
}

}  // namespace

fs::path result_directory(const Plan& plan, const Unit& unit) {
  return below(plan, "results", unit);
}

Result find_result(const Plan& plan, const Unit& unit, bool whole) {
  const fs::path directory = result_directory(plan, unit);
  std::ifstream file(directory / "record.json");
  if (!file) return {};
  try {
    const json record = json::parse(file);
    Result out{record.at("state"), record.at("error"), record.at("files"), 0};
    if (!are_there(directory / "files", out.files, whole)) return {};
    const json time = json::parse(whole_file(directory / "time.json"), nullptr, false);
    if (time.is_object()) out.seconds = time.value("seconds", 0.0);
    return out;
  } catch (const json::exception&) {
    return {};  // damaged: made anew
  }
}

Error keep_result(const Plan& plan, const Unit& unit, const fs::path& work, const std::string& state,
                  const std::string& error, double seconds) {
  std::error_code code;
  if (state != "done") fs::remove_all(work / "files", code);
  const json record = {{"state", state}, {"error", error}, {"files", list_files(work / "files")}};
  for (const auto& [name, content] :
       {std::pair("record.json", record), std::pair("time.json", json{{"seconds", seconds}})}) {
    if (Error fault = cli::write_atomically((work / name).string(), cli::json_text(content) + "\n"))
      return fault;
    flush(work / name);
  }
  const fs::path to = result_directory(plan, unit);
  fs::create_directories(to.parent_path(), code);
  if (fs::exists(to, code) && find_result(plan, unit, true).state.empty())
    drop_result(plan, unit);  // damaged
  fs::rename(work, to, code);
  if (code) {
    if (find_result(plan, unit, true).state.empty())
      return {to.string() + ": cannot be made: " + code.message()};
    fs::remove_all(work, code);  // someone else was quicker
  }
  flush(to.parent_path());
  fs::remove(below(plan, "tries", unit), code);
  return {};
}

void drop_result(const Plan& plan, const Unit& unit) {
  // Out of the way first: what is removed file by file may be read meanwhile.
  fs::path aside;
  std::error_code code;
  if (make_work(plan, unit, aside)) return;
  fs::rename(result_directory(plan, unit), aside / "old", code);
  fs::remove_all(aside, code);
  fs::remove(below(plan, "tries", unit), code);
}

int tries(const Plan& plan, const Unit& unit) {
  const std::string lines = whole_file(below(plan, "tries", unit));
  return static_cast<int>(std::count(lines.begin(), lines.end(), '\n'));
}

Error note_try(const Plan& plan, const Unit& unit) {
  const fs::path path = below(plan, "tries", unit);
  std::error_code code;
  fs::create_directories(path.parent_path(), code);
  std::ofstream file(path, std::ios::app);
  file << machine() + " " + std::to_string(getpid()) + "\n" << std::flush;
  return file ? Error{} : Error{path.string() + ": cannot be written"};
}

Error make_work(const Plan& plan, const Unit& unit, fs::path& out) {
  static int made = 0;
  out = plan.directory / "work" /
        (unit.key + "." + machine() + "." + std::to_string(getpid()) + "." + std::to_string(++made));
  std::error_code code;
  fs::remove_all(out, code);
  fs::create_directories(out / "files", code);
  return code ? Error{out.string() + ": cannot be made: " + code.message()} : Error{};
}

void clear_work(const Plan& plan) {
  std::vector<fs::path> dead;
  std::error_code code;
  for (const fs::directory_entry& entry : fs::directory_iterator(plan.directory / "work", code)) {
    const std::string name = entry.path().filename().string();
    const std::size_t last = name.rfind('.'),
                      before = last == std::string::npos ? last : name.rfind('.', last - 1);
    if (before == std::string::npos || before <= 17 || name.substr(17, before - 17) != machine()) continue;
    const long process = std::strtol(name.c_str() + before + 1, nullptr, 10);
    if (process > 0 && has_ended(static_cast<pid_t>(process))) dead.push_back(entry.path());
  }
  for (const fs::path& path : dead) fs::remove_all(path, code);
  clear_leftovers(plan.directory / "work");
}

}  // namespace sinew::batch
