// What a conversion costs beside assimp's own loading of the same file, in one process and by turns: medians.
//
//     convert_bench [FILE…]        default: the demo's character
#include <assimp/postprocess.h>

#include <algorithm>
#include <assimp/Importer.hpp>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <string>
#include <vector>

#include "convert/convert.h"
#include "fixtures/paths.h"

namespace sinew {
namespace {

constexpr int kRuns = 9;

double milliseconds(const auto& work) {
  const auto begin = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count();
}

double median(std::vector<double> of) {
  const auto middle = of.begin() + static_cast<std::ptrdiff_t>(of.size() / 2);
  std::nth_element(of.begin(), middle, of.end());
  return *middle;
}

/// Whether both can read it.
bool compare(const std::string& file) {
  std::vector<double> loading, converting;
  bool fine = true;
  for (int run = 0; fine && run < kRuns; ++run) {
    loading.push_back(milliseconds([&] {
      Assimp::Importer importer;
      fine = importer.ReadFile(file, aiProcess_ValidateDataStructure | aiProcess_Triangulate |
                                         aiProcess_GenSmoothNormals) != nullptr;
    }));
    converting.push_back(milliseconds([&] {
      Asset asset;
      nlohmann::json report;
      fine = !convert::convert_files({file}, {}, asset, report) && fine;
    }));
  }
  const std::string name = std::filesystem::path(file).filename();
  if (!fine) {
    std::printf("| %s | not read by both | | |\n", name.c_str());
    return false;
  }
  std::printf("| %s | %.1f | %.1f | %.1f |\n", name.c_str(), median(loading), median(converting),
              median(converting) / median(loading));
  return true;
}

}  // namespace
}  // namespace sinew

int main(int argc, char** argv) {
  std::vector<std::string> files(argv + 1, argv + argc);
  if (files.empty()) files.push_back(sinew::source_dir() + "/assets/character/mannequin.glb");
  std::printf("| file | assimp, ms | conversion, ms | × |\n|---|---|---|---|\n");
  bool fine = true;
  for (const std::string& file : files) fine = sinew::compare(file) && fine;
  return fine ? 0 : 1;
}
