// Conversions of files that nobody here wrote, as a table: tests/run.sh puts it into the test log.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <set>

#include "convert/convert.h"
#include "fixtures/paths.h"

namespace sinew::convert {
namespace {

namespace fs = std::filesystem;

void print_heading() {
  std::printf("%-40s %6s %6s %5s %8s %7s %6s %9s\n", "file", "joints", "bodies", "DOF", "mass kg", "height m",
              "clips", "error mm");
}

/// Converts with default options, checks that the asset is whole and prints a row about it.
void expect_conversion(const fs::path& file) {
  Asset asset;
  nlohmann::json report;
  const Error error = convert_files({file.string()}, {}, asset, report);
  ASSERT_FALSE(error) << error.message;
  EXPECT_TRUE(validate(asset.skeleton).ok()) << file;
  double worst = 0;
  if (report.contains("clips"))
    for (const auto& clip : report["clips"]) worst = std::max(worst, clip["max_error_mm"].get<double>());
  EXPECT_LE(worst, 1.0001) << file;  // the default budget
  Asset back;
  const std::vector<std::uint8_t> bytes = write_asset(asset);
  EXPECT_TRUE(read_asset(bytes, back).ok()) << file;
  EXPECT_EQ(write_asset(back), bytes) << file;
  char height[32] = "-";  // a URDF has none
  if (report.contains("height_m"))
    std::snprintf(height, sizeof height, "%.2f", report["height_m"].get<double>());
  std::printf("%-40s %6zu %6d %5d %8.1f %8s %6zu %9.3f\n", file.filename().c_str(),
              asset.skeleton.joints.size(), asset.skeleton.body_count, asset.skeleton.dof_total(),
              asset.skeleton.total_mass(), height, asset.clips.size(), worst);
}

TEST(Table, EverySharedAssetConvertsAndWhatMustBeRefusedIs) {
  const fs::path root = fs::path(shared_dir()) / "assets";
  if (!fs::exists(root)) GTEST_SKIP() << "no ../shared here: its assets were not converted";
  const std::set<std::string> models{".bvh", ".fbx", ".glb", ".gltf", ".dae", ".urdf"};
  std::set<fs::path> good, bad;
  for (const auto& entry : fs::recursive_directory_iterator(root))
    if (models.count(entry.path().extension().string()))
      (entry.path().string().find("expected_error") == std::string::npos ? good : bad).insert(entry.path());
  EXPECT_GE(good.size(), 34u);
  EXPECT_GE(bad.size(), 1u);
  print_heading();
  for (const fs::path& file : good) expect_conversion(file);
  for (const fs::path& file : bad) {
    Asset asset;
    nlohmann::json report;
    const Error error = convert_files({file.string()}, {}, asset, report);
    EXPECT_EQ(error.message.rfind(file.string() + ": ", 0), 0u) << error.message;
    EXPECT_NE(error.message.find("joint"), std::string::npos) << error.message;
    std::printf("%-40s refused: %s\n", file.filename().c_str(),
                error.message.substr(std::min(error.message.size(), file.string().size() + 2)).c_str());
  }
}

TEST(Table, ModelsThatDebianPackagesConvert) {
  const fs::path root = "/usr/share/assimp/models";
  if (!fs::exists(root)) GTEST_SKIP() << "assimp-testmodels are not installed";
  print_heading();
  for (const char* file :
       {"BVH/01_01.bvh", "BVH/01_03.bvh", "BVH/Boxing_Toes.bvh",
        "Collada/anims_with_full_rotations_between_keys.DAE", "Collada/box_nested_animation.dae",
        "FBX/animation_with_skeleton.fbx", "FBX/huesitos.fbx", "glTF2/simple_skin/simple_skin.gltf"})
    expect_conversion(root / file);
}

}  // namespace
}  // namespace sinew::convert
