#include "study/tables/count.h"

#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <future>
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

std::vector<double> count(const std::string& directory, const std::vector<CountJob>& jobs) {
  // Every second job in a process of its own: neighbours in the list cost about the same.
  std::vector<CountJob> half[2];
  for (std::size_t i = 0; i < jobs.size(); ++i) half[i % 2].push_back(jobs[i]);
  auto odd = std::async(std::launch::async, [&] { return count_in_turn(directory, half[1]); });
  const std::vector<double> parts[2] = {count_in_turn(directory, half[0]), odd.get()};
  std::vector<double> counted;
  for (std::size_t i = 0; i < jobs.size(); ++i) counted.push_back(parts[i % 2][i / 2]);
  return counted;
}

}  // namespace sinew::study
