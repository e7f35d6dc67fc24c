#include "study/tables/count.h"

#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <future>
#include <iterator>
#include <map>
#include <sstream>

namespace sinew::study {
namespace {

namespace fs = std::filesystem;

/// A directory of its own that goes when it is no longer needed.
class Scratch {
 public:
  Scratch() {
    std::string name = (fs::temp_directory_path() / "sinew_count_XXXXXX").string();
    if (mkdtemp(name.data())) path_ = name;
  }
  ~Scratch() {
    std::error_code ignored;
    if (!path_.empty()) fs::remove_all(path_, ignored);
  }
  Scratch(const Scratch&) = delete;
  Scratch& operator=(const Scratch&) = delete;

  bool exists() const { return !path_.empty(); }
  std::string file(const std::string& name) const { return path_ + "/" + name; }

 private:
  std::string path_;
};

/// The number behind "totals: " in a dump of callgrind's; 0 when there is none.
double total_of(const std::string& path) {
  std::ifstream in(path);
  for (std::string line; std::getline(in, line);)
    if (line.starts_with("totals: ")) return std::strtod(line.c_str() + 8, nullptr);
  return 0;
}

}  // namespace

std::string line_of(const CountJob& job) {
  char tolerance[32];
  std::snprintf(tolerance, sizeof tolerance, "%.17g", job.tolerance);
  return job.mechanism + "\t" + job.formulation + "\t" + job.integrator + "\t" + tolerance;
}

CountJob job_of(const std::string& line) {
  CountJob job;
  std::stringstream cells(line);
  std::string tolerance;
  std::getline(cells, job.mechanism, '\t');
  std::getline(cells, job.formulation, '\t');
  std::getline(cells, job.integrator, '\t');
  std::getline(cells, tolerance);
  job.tolerance = std::strtod(tolerance.c_str(), nullptr);
  return job;
}

bool can_count() {
#ifdef __SANITIZE_ADDRESS__
  return false;  // valgrind does not run programs that watch their own memory
#else
  return fs::exists(SINEW_TABLES_TWIN) && std::system("command -v valgrind >/dev/null 2>&1") == 0;
#endif
}

namespace {

/// Counts the jobs one after the other, in one process.
std::vector<double> count_in_turn(const std::string& directory, const std::vector<CountJob>& jobs) {
  std::vector<double> counted(jobs.size(), 0);
  const Scratch scratch;
  if (jobs.empty() || !scratch.exists() || !can_count()) return counted;
  const std::string list = scratch.file("jobs");
  {
    std::ofstream out(list);
    for (const CountJob& job : jobs) out << line_of(job) << "\n";
  }
  // A dump at the end of each call of `counted`, numbered as the jobs are; dumping sets the counters to zero.
  const std::string command =
      "valgrind --tool=callgrind --collect-atstart=no --toggle-collect=sinew_counted "
      "--dump-after=sinew_counted "
      "--callgrind-out-file='" +
      scratch.file("out") + "' '" SINEW_TABLES_TWIN "' '" + directory + "' '" + list + "' >/dev/null 2>&1";
  if (std::system(command.c_str()) != 0) return counted;
  for (std::size_t i = 0; i < jobs.size(); ++i)
    counted[i] = total_of(scratch.file("out." + std::to_string(i + 1)));
  return counted;
}

}  // namespace

namespace {

/// Counts of earlier runs, one per line: of which program and file, the job, instructions.
class Kept {
 public:
  explicit Kept(const std::string& directory) : directory_(directory) {
    std::ifstream in(kFile);
    for (std::string line; std::getline(in, line);)
      if (const std::size_t cut = line.rfind('\t'); cut != std::string::npos)
        counts_[line.substr(0, cut)] = std::strtod(line.c_str() + cut, nullptr);
  }
  /// 0: not known.
  double find(const CountJob& job) const {
    const auto found = counts_.find(key(job));
    return found == counts_.end() ? 0 : found->second;
  }
  void keep(const CountJob& job, double instructions) const {
    char number[32];
    std::snprintf(number, sizeof number, "%.0f", instructions);
    std::ofstream(kFile, std::ios::app) << key(job) << '\t' << number << '\n';
  }

 private:
  static constexpr const char* kFile = SINEW_TABLES_TWIN ".counts";

  std::string key(const CountJob& job) const {
    std::error_code none;
    const auto built = fs::last_write_time(SINEW_TABLES_TWIN, none).time_since_epoch().count();
    std::ifstream file(directory_ + "/" + job.mechanism + ".json");
    const std::string content((std::istreambuf_iterator<char>(file)), {});
    return std::to_string(built) + "\t" + std::to_string(std::hash<std::string>()(content)) + "\t" +
           line_of(job);
  }

  std::string directory_;
  std::map<std::string, double> counts_;
};

std::vector<double> count_in_two(const std::string& directory, const std::vector<CountJob>& jobs) {
  // Every second job in a process of its own: neighbours in the list cost about the same.
  std::vector<CountJob> half[2];
  for (std::size_t i = 0; i < jobs.size(); ++i) half[i % 2].push_back(jobs[i]);
  auto odd = std::async(std::launch::async, [&] { return count_in_turn(directory, half[1]); });
  const std::vector<double> parts[2] = {count_in_turn(directory, half[0]), odd.get()};
  std::vector<double> counted;
  for (std::size_t i = 0; i < jobs.size(); ++i) counted.push_back(parts[i % 2][i / 2]);
  return counted;
}

}  // namespace

std::vector<double> count(const std::string& directory, const std::vector<CountJob>& jobs, bool anew) {
  if (!can_count()) return std::vector<double>(jobs.size(), 0);
  const Kept kept(directory);
  std::vector<double> counted;
  std::vector<CountJob> left;
  std::vector<std::size_t> place;
  for (std::size_t i = 0; i < jobs.size(); ++i) {
    counted.push_back(anew ? 0 : kept.find(jobs[i]));
    if (counted.back() > 0) continue;
    left.push_back(jobs[i]);
    place.push_back(i);
  }
  const std::vector<double> fresh = count_in_two(directory, left);
  for (std::size_t i = 0; i < left.size(); ++i) {
    counted[place[i]] = fresh[i];
    if (fresh[i] > 0) kept.keep(left[i], fresh[i]);
  }
  return counted;
}

}  // namespace sinew::study
