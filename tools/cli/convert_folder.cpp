#include "cli/convert_folder.h"

#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <map>
#include <set>
#include <thread>

#include "batch/digest.h"
#include "batch/processes.h"
#include "batch/sources.h"
#include "cli/convert_page.h"
#include "cli/files.h"
#include "cli/terminal.h"

namespace sinew::cli {
namespace {

namespace fs = std::filesystem;
using batch::Digest;
using batch::Finished;
using convert::Error;
using nlohmann::json;

/// One source and what becomes of it.
struct Job {
  fs::path source, output, record;
  std::string state;  ///< "converted", "up to date", "to convert" or "failed"
  std::string error;  ///< one line
  json report;
};

/// The jobs of all inputs.
Error plan(const FolderConversion& what, std::vector<Job>& jobs) {
  std::map<fs::path, fs::path> found, names;
  for (const std::string& input : what.inputs)
    if (Error error = batch::find_sources(input, batch::source_endings(), found)) return error;
  if (found.empty()) return {what.inputs[0] + ": no glTF, FBX, BVH, COLLADA or URDF file in it"};
  if (Error error = batch::name_outputs(found, ".sinew", names)) return error;
  const fs::path root = what.output;
  for (const auto& [source, name] : names)
    jobs.push_back(
        {source, root / name, root / ".sinew" / fs::path(name).replace_extension(".json"), "", "", {}});
  return {};
}

/// What a conversion depends on. `files`: what the source was found to refer to.
std::string key_of(const Job& job, const FolderConversion& what, const std::string& program,
                   const json& files) {
  Digest digest;
  digest.add(program);
  for (const std::string& option : what.options) {
    digest.add(option);
    std::error_code code;
    if (fs::is_regular_file(option, code)) digest.add_file(option);
  }
  digest.add(job.source.filename().string());
  digest.add_file(job.source);
  digest.add_file(convert::clip_data_beside(job.source.string()));
  for (const json& name : files) {
    digest.add(name.get<std::string>());
    digest.add_file(job.source.parent_path() / name.get<std::string>());
  }
  return digest.text();
}

json read_record(const fs::path& path) {
  std::ifstream file(path);
  const json record = file ? json::parse(file, nullptr, false) : json();
  const bool whole = record.is_object() && record.contains("key") && record["key"].is_string() &&
                     record.contains("report") && record["report"].is_object();
  return whole ? record : json();
}

json files_of(const json& report) {
  json names = json::array();
  if (report.contains("files") && report["files"].is_array())
    for (const json& name : report["files"])
      if (name.is_string()) names.push_back(name);
  return names;
}

bool is_up_to_date(Job& job, const FolderConversion& what, const std::string& program) {
  std::error_code code;
  if (what.again || !fs::is_regular_file(job.output, code)) return false;
  const json record = read_record(job.record);
  if (record.is_null() || record["key"] != key_of(job, what, program, files_of(record["report"])))
    return false;
  job.report = record["report"];
  job.state = "up to date";
  return true;
}

std::vector<std::string> conversion_of(const Job& job, const FolderConversion& what) {
  std::vector<std::string> arguments = {"convert", job.source.string(), "--json", "-o", job.output.string()};
  arguments.insert(arguments.end(), what.options.begin(), what.options.end());
  return arguments;
}

void finish(Job& job, const FolderConversion& what, const std::string& program, const Finished& process) {
  job.report = json::parse(batch::whole_file(process.out), nullptr, false);
  if (!process.succeeded() || !job.report.is_object()) {
    job.state = "failed";
    job.error = batch::reason(process, "the converter");
    job.report = json::object();
  } else {
    job.state = "converted";
    const json record = {{"key", key_of(job, what, program, files_of(job.report))}, {"report", job.report}};
    if (Error error = write_atomically(job.record.string(), json_text(record))) job.error = error.message;
  }
}

batch::Processes processes(const FolderConversion& what, const char* doing) {
  return {what.jobs, fs::path(what.output) / ".sinew", 0, doing};
}

fs::path still_of(const Job& job) {
  return fs::path(job.record).replace_extension(".png");
}

/// Pictures of what has none, or an older one.
void make_stills(const std::vector<Job>& jobs, const FolderConversion& what) {
  std::vector<std::size_t> left;
  for (std::size_t n = 0; n < jobs.size(); ++n) {
    std::error_code missing, code;
    const auto made = fs::last_write_time(still_of(jobs[n]), missing);
    if (jobs[n].state != "failed" && (missing || made < fs::last_write_time(jobs[n].output, code)))
      left.push_back(n);
  }
  batch::run_processes(
      processes(what, "drawing"), left,
      [&](std::size_t n) {
        return std::vector<std::string>{"render", jobs[n].output.string(),   "--size", "320x320",
                                        "-o",     still_of(jobs[n]).string()};
      },
      [](const Finished&) {});
}

Error make_directories(const std::vector<Job>& jobs, const fs::path& root) {
  std::set<fs::path> wanted = {root, root / ".sinew"};
  for (const Job& job : jobs) wanted.insert({job.output.parent_path(), job.record.parent_path()});
  for (const fs::path& path : wanted) {
    std::error_code code;
    fs::create_directories(path, code);
    if (code || !fs::is_directory(path)) return {path.string() + ": cannot be made: " + code.message()};
  }
  if (Error error = check_writable((root / "x").string())) return error;
  for (const fs::path& path : wanted) batch::clear_leftovers(path);
  return {};
}

json row_of(const Job& job) {
  json row = {{"source", job.source.string()}, {"state", job.state}};
  if (job.state == "failed")
    row["error"] = job.error;
  else
    row["output"] = job.output.string();
  if (!job.report.empty()) row["report"] = job.report;
  return row;
}

void print(const Job& job) {
  if (job.state == "failed") {
    say("%s      %s\n", styled("FAILED", Style::kRed, STDOUT_FILENO).c_str(), job.error.c_str());
    return;
  }
  say("%-11s %s", job.state.c_str(), job.output.c_str());
  if (!job.report.empty())
    say(": joints %d, simulated %d, %.1f kg, clips %zu", job.report.value("joints", 0),
        job.report.value("simulated_joints", 0), job.report.value("total_mass_kg", 0.0),
        job.report.contains("clips") ? job.report["clips"].size() : 0);
  say("%s%s\n", job.error.empty() ? "" : "; its record: ", job.error.c_str());
}

/// Why sources could not be converted, by their keys: of a program that goes on.
using Refusals = std::map<std::string, std::string>;

bool is_refused(Job& job, const FolderConversion& what, const std::string& program, const Refusals& refused) {
  if (refused.empty()) return false;
  const auto found = refused.find(key_of(job, what, program, json::array()));
  if (found == refused.end()) return false;
  job.state = "failed";
  job.error = found->second;
  return true;
}

/// Converts what has to be; `jobs` say what became of each. `fresh`: how many were looked at anew.
Error convert_once(const FolderConversion& what, const std::string& program, std::vector<Job>& jobs,
                   std::size_t& fresh, Refusals& refused) {
  jobs.clear();
  if (Error error = plan(what, jobs)) return error;
  if (!what.dry_run)
    if (Error error = make_directories(jobs, what.output)) return error;
  std::vector<std::size_t> left;
  for (std::size_t n = 0; n < jobs.size(); ++n)
    if (!is_up_to_date(jobs[n], what, program) && !is_refused(jobs[n], what, program, refused))
      left.push_back(n);
  fresh = left.size();
  if (what.dry_run)
    for (const std::size_t n : left) jobs[n].state = "to convert";
  else
    batch::run_processes(
        processes(what, "converting"), left, [&](std::size_t n) { return conversion_of(jobs[n], what); },
        [&](const Finished& process) { finish(jobs[process.item], what, program, process); });
  for (const std::size_t n : left)
    if (jobs[n].state == "failed") refused[key_of(jobs[n], what, program, json::array())] = jobs[n].error;
  return {};
}

json report_of(const std::vector<Job>& jobs) {
  json rows = json::array();
  for (const Job& job : jobs) rows.push_back(row_of(job));
  const auto count = [&](const char* state) {
    return std::count_if(jobs.begin(), jobs.end(), [&](const Job& job) { return job.state == state; });
  };
  return {{"converted", count("converted")},
          {"up_to_date", count("up to date")},
          {"to_convert", count("to convert")},
          {"failed", count("failed")},
          {"files", rows}};
}

/// As a page with pictures, if that is its name's ending; else as JSON.
Error write_report(const std::vector<Job>& jobs, const FolderConversion& what, json report) {
  if (batch::lower(fs::path(what.report_file).extension().string()) != ".html")
    return write_atomically(what.report_file, json_text(report, 2) + "\n");
  make_stills(jobs, what);
  const fs::path here = fs::absolute(what.report_file).parent_path();
  for (std::size_t n = 0; n < jobs.size(); ++n) {
    const fs::path still = fs::absolute(still_of(jobs[n]));
    std::error_code code;
    if (fs::is_regular_file(still, code))
      report["files"][n]["still"] = still.lexically_relative(here).string();
  }
  return write_atomically(what.report_file, convert_page(report));
}

}  // namespace

Error convert_folder(const FolderConversion& what, int& failed) {
  if (!what.report_file.empty())
    if (Error error = check_writable(what.report_file)) return error;
  const std::string program = batch::digest_of_file("/proc/self/exe");
  Refusals refused;
  for (bool first = true;; first = false) {
    std::vector<Job> jobs;
    std::size_t fresh = 0;
    if (Error error = convert_once(what, program, jobs, fresh, refused)) return error;
    const json report = report_of(jobs);
    failed = report["failed"];
    const bool news = first || fresh > 0;
    if (news && what.json) {
      std::puts(json_text(report).c_str());
    } else if (news) {
      for (const Job& job : jobs)
        if (first || job.state != "up to date") print(job);
      if (what.dry_run)
        say("%zu to convert, %zu up to date\n", fresh, jobs.size() - fresh);
      else
        say("%d converted, %d up to date, %d failed\n", report["converted"].get<int>(),
            report["up_to_date"].get<int>(), failed);
    }
    if (news && !what.report_file.empty())
      if (Error error = write_report(jobs, what, report)) return error;
    if (!what.watch) return {};
    std::fflush(stdout);
    std::this_thread::sleep_for(std::chrono::seconds(1));
  }
}

}  // namespace sinew::cli
