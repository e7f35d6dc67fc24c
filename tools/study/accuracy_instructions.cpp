#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>

#include "sinew/io/asset.h"
#include "study/accuracy.h"
#include "study/mannequin.h"

namespace sinew::study {
namespace {

/// The mannequin as a runtime asset: source files are read in a child process that valgrind may not enter.
class ReadyMannequin {
 public:
  ReadyMannequin()
      : path_(std::filesystem::temp_directory_path() / ("mannequin_" + std::to_string(getpid()) + ".sinew")) {
    if (!mannequin()) return;
    const std::vector<std::uint8_t> bytes = write_asset(*mannequin());
    std::ofstream(path_, std::ios::binary)
        .write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  }
  ~ReadyMannequin() {
    std::error_code ignored;
    std::filesystem::remove(path_, ignored);
  }
  std::string path() const { return path_.string(); }

 private:
  std::filesystem::path path_;
};

}  // namespace

bool can_count_instructions() {
#ifdef __SANITIZE_ADDRESS__
  return false;  // valgrind does not run programs that watch their own memory
#else
  return std::system("command -v valgrind >/dev/null 2>&1") == 0 && std::filesystem::exists(SINEW_TWIN);
#endif
}

double instructions_of(const AccuracyScene& scene, const EngineOption& with, double h,
                       const Accuracy& accuracy) {
  char step[96];
  std::snprintf(step, sizeof step, "%.17g %.17g %d", h, accuracy.tolerance, accuracy.substeps);
  static const ReadyMannequin ready;
  const std::string command =
      "SINEW_MANNEQUIN='" + ready.path() +
      "' valgrind --tool=callgrind --callgrind-out-file=/dev/null --collect-atstart=no "
      "--toggle-collect=sinew_twin_step '" SINEW_TWIN "' '" +
      scene.name + "' '" + with.engine + "' '" + with.option + "' " + step + " 2>&1";
  FILE* run = popen(command.c_str(), "r");
  if (!run) return -1;
  double counted = -1;
  char line[512];
  while (std::fgets(line, sizeof line, run))
    if (const char* at = std::strstr(line, "Collected : ")) counted = std::atof(at + 12);
  return pclose(run) == 0 && counted > 0 ? counted / (60 * scene.seconds) : -1;
}

}  // namespace sinew::study
