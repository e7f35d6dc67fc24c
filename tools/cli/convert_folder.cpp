#include "cli/convert_folder.h"

#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <regex>
#include <set>
#include <thread>

#include "cli/convert_page.h"
#include "cli/files.h"

extern char** environ;

namespace sinew::cli {
namespace {

namespace fs = std::filesystem;
using convert::Error;
using nlohmann::json;

/// One source and what becomes of it.
struct Job {
  fs::path source, output, record;
  std::string state;  ///< "converted", "up to date", "to convert" or "failed"
  std::string error;  ///< one line
  json report;
};

/// FNV-1a of 64 bits: tells changes, not attacks.
class Digest {
 public:
  void add(const void* data, std::size_t size) {
    const auto* bytes = static_cast<const unsigned char*>(data);
    for (std::size_t k = 0; k < size; ++k) hash_ = (hash_ ^ bytes[k]) * 1099511628211ull;
    hash_ = (hash_ ^ size) * 1099511628211ull;
  }
  void add(const std::string& text) { add(text.data(), text.size()); }
  void add_file(const fs::path& path) {
    std::error_code code;
    if (!fs::is_regular_file(path, code)) return add("missing");  // sources may name devices
    std::ifstream file(path, std::ios::binary);
    char block[1 << 16];
    while (file.read(block, sizeof block) || file.gcount() > 0)
      add(block, static_cast<std::size_t>(file.gcount()));
  }
  std::string text() const {
    char out[17];
    std::snprintf(out, sizeof out, "%016llx", static_cast<unsigned long long>(hash_));
    return out;
  }

 private:
  std::uint64_t hash_ = 14695981039346656037ull;
};

std::string lower(std::string text) {
  for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return text;
}

bool is_source(const fs::path& path) {
  static const std::set<std::string> kEndings = {".glb", ".gltf", ".fbx", ".bvh", ".dae", ".urdf"};
  return kEndings.count(lower(path.extension().string())) > 0;
}

/// Sources below a folder, with their places in it, in the order of their names.
Error search(const fs::path& folder, std::map<fs::path, fs::path>& found) {
  std::error_code code;
  fs::recursive_directory_iterator at(folder, fs::directory_options::skip_permission_denied, code);
  if (code) return {folder.string() + ": cannot be searched: " + code.message()};
  for (; at != fs::recursive_directory_iterator(); at.increment(code)) {
    if (code) return {folder.string() + ": cannot be searched: " + code.message()};
    if (at->is_regular_file(code) && is_source(at->path()))
      found[at->path()] = at->path().lexically_relative(folder);
  }
  return {};
}

/// The jobs of all inputs. Sources that differ by their endings alone keep these in their outputs' names.
Error plan(const FolderConversion& what, std::vector<Job>& jobs) {
  std::map<fs::path, fs::path> found;
  std::error_code code;
  for (const std::string& input : what.inputs) {
    if (fs::is_directory(input, code)) {
      if (Error error = search(input, found)) return error;
    } else {
      found[input] = fs::path(input).filename();
    }
  }
  if (found.empty()) return {what.inputs[0] + ": no glTF, FBX, BVH, COLLADA or URDF file in it"};
  std::map<fs::path, int> wanted;
  for (const auto& [source, place] : found) ++wanted[fs::path(place).replace_extension()];
  std::map<fs::path, fs::path> taken;
  const fs::path root = what.output;
  for (const auto& [source, place] : found) {
    fs::path name = fs::path(place).replace_extension();
    if (wanted[name] > 1) name = place;
    name += ".sinew";
    if (const auto [other, fresh] = taken.emplace(name, source); !fresh)
      return {source.string() + ": would become the same file as " + other->second.string()};
    jobs.push_back(
        {source, root / name, root / ".sinew" / fs::path(name).replace_extension(".json"), "", "", {}});
  }
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

/// A conversion that runs: its process, and where it writes to.
struct Running {
  std::size_t job = 0;
  fs::path out, err;
};

std::string whole(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

/// Starts this program with other arguments; −1 where that is not possible.
pid_t start(std::vector<std::string> arguments, const Running& to) {
  arguments.insert(arguments.begin(), "sinew");
  std::vector<char*> raw;
  for (std::string& argument : arguments) raw.push_back(argument.data());
  raw.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, to.out.c_str(), O_WRONLY | O_CREAT | O_TRUNC,
                                   0600);
  posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, to.err.c_str(), O_WRONLY | O_CREAT | O_TRUNC,
                                   0600);
  pid_t process = -1;
  const int code = posix_spawn(&process, "/proc/self/exe", &actions, nullptr, raw.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  return code == 0 ? process : -1;
}

std::vector<std::string> conversion_of(const Job& job, const FolderConversion& what) {
  std::vector<std::string> arguments = {"convert", job.source.string(), "--json", "-o", job.output.string()};
  arguments.insert(arguments.end(), what.options.begin(), what.options.end());
  return arguments;
}

/// Why a conversion failed, in one line.
std::string reason(int status, const std::string& err) {
  if (status == -1) return "no process could be started for it";
  if (WIFSIGNALED(status)) return "the converter was ended by signal " + std::to_string(WTERMSIG(status));
  std::string line = err.substr(0, err.find('\n'));
  if (line.rfind("sinew: ", 0) == 0) line.erase(0, 7);
  return line.empty() ? "the converter ended with code " + std::to_string(WEXITSTATUS(status)) : line;
}

void finish(Job& job, const FolderConversion& what, const std::string& program, const Running& from,
            int status) {
  job.report = json::parse(whole(from.out), nullptr, false);
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0 || !job.report.is_object()) {
    job.state = "failed";
    job.error = reason(status, whole(from.err));
    job.report = json::object();
  } else {
    job.state = "converted";
    const json record = {{"key", key_of(job, what, program, files_of(job.report))}, {"report", job.report}};
    if (Error error = write_atomically(job.record.string(), json_text(record))) job.error = error.message;
  }
}

/// Runs one process for each of `left`, `at_once` at a time: arguments(n) of it, and ended(n, where it wrote,
/// status); status −1: it could not be started.
template <class Arguments, class Ended>
void run(const std::vector<std::size_t>& left, int at_once, const fs::path& scratch, const char* doing,
         const Arguments& arguments, const Ended& ended) {
  const auto progress = progress_line(doing);
  std::map<pid_t, Running> running;
  std::size_t next = 0;
  int done = 0;
  const auto finished = [&](const Running& of, int status) {
    ended(of, status);
    std::error_code code;
    fs::remove(of.out, code);
    fs::remove(of.err, code);
    progress(++done, static_cast<int>(left.size()));
  };
  while (next < left.size() || !running.empty()) {
    while (next < left.size() && running.size() < static_cast<std::size_t>(at_once)) {
      const std::size_t n = left[next++];
      const std::string name = std::to_string(getpid()) + "." + std::to_string(n);
      const Running to{n, scratch / (name + ".out"), scratch / (name + ".err")};
      const pid_t process = start(arguments(n), to);
      if (process > 0)
        running[process] = to;
      else
        finished(to, -1);
    }
    if (running.empty()) continue;
    int status = 0;
    const auto of = running.find(waitpid(-1, &status, 0));
    if (of == running.end()) continue;  // interrupted
    finished(of->second, status);
    running.erase(of);
  }
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
  run(
      left, what.jobs, fs::path(what.output) / ".sinew", "drawing",
      [&](std::size_t n) {
        return std::vector<std::string>{"render", jobs[n].output.string(),   "--size", "320x320",
                                        "-o",     still_of(jobs[n]).string()};
      },
      [](const Running&, int) {});
}

/// Removes half-written files of processes that were killed: NAME.tmpPID, PID.N.out, PID.N.err.
void clear_leftovers(const fs::path& directory) {
  static const std::regex kHalf(R"((?:.*\.tmp(\d+))|(?:(\d+)\.\d+\.(?:out|err)))");
  std::error_code code;
  std::vector<fs::path> dead;
  for (const fs::directory_entry& entry : fs::directory_iterator(directory, code)) {
    std::smatch found;
    const std::string name = entry.path().filename().string();
    if (name.size() > 255 || !std::regex_match(name, found, kHalf)) continue;
    const long process = std::strtol(found[found[1].matched ? 1 : 2].str().c_str(), nullptr, 10);
    if (process > 0 && kill(static_cast<pid_t>(process), 0) != 0 && errno == ESRCH)
      dead.push_back(entry.path());
  }
  for (const fs::path& path : dead) fs::remove(path, code);
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
  for (const fs::path& path : wanted) clear_leftovers(path);
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
    std::printf("FAILED      %s\n", job.error.c_str());
    return;
  }
  std::printf("%-11s %s", job.state.c_str(), job.output.c_str());
  if (!job.report.empty())
    std::printf(": joints %d, simulated %d, %.1f kg, clips %zu", job.report.value("joints", 0),
                job.report.value("simulated_joints", 0), job.report.value("total_mass_kg", 0.0),
                job.report.contains("clips") ? job.report["clips"].size() : 0);
  std::printf("%s%s\n", job.error.empty() ? "" : "; its record: ", job.error.c_str());
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
    run(
        left, what.jobs, fs::path(what.output) / ".sinew", "converting",
        [&](std::size_t n) { return conversion_of(jobs[n], what); },
        [&](const Running& of, int status) { finish(jobs[of.job], what, program, of, status); });
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
  if (lower(fs::path(what.report_file).extension().string()) != ".html")
    return write_atomically(what.report_file,
                            report.dump(2, ' ', false, json::error_handler_t::replace) + "\n");
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
  Digest program;
  program.add_file("/proc/self/exe");
  Refusals refused;
  for (bool first = true;; first = false) {
    std::vector<Job> jobs;
    std::size_t fresh = 0;
    if (Error error = convert_once(what, program.text(), jobs, fresh, refused)) return error;
    const json report = report_of(jobs);
    failed = report["failed"];
    const bool news = first || fresh > 0;
    if (news && what.json) {
      std::puts(json_text(report).c_str());
    } else if (news) {
      for (const Job& job : jobs)
        if (first || job.state != "up to date") print(job);
      if (what.dry_run)
        std::printf("%zu to convert, %zu up to date\n", fresh, jobs.size() - fresh);
      else
        std::printf("%d converted, %d up to date, %d failed\n", report["converted"].get<int>(),
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
