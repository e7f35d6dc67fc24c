// Files that nobody here wrote: what is in them was counted independently (real-data.md, section 7; joints of
// BVH files as JOINT and ROOT in their text, without end sites; the knight's clip lengths from the `max` of
// its time accessors).
#include <algorithm>
#include <set>

#include "fixtures/paths.h"
#include "reading.h"

namespace sinew::import::test {
namespace {

namespace fs = std::filesystem;

const fs::path kAssets = fs::path(shared_dir()) / "assets";
const fs::path kModels = "/usr/share/assimp/models";

int bones_in(const SourceScene& s) {
  return static_cast<int>(
      std::count_if(s.nodes.begin(), s.nodes.end(), [](const SourceNode& n) { return n.is_bone; }));
}

double length_of_clips(const SourceScene& s) {
  double sum = 0;
  for (const SourceClip& c : s.clips) sum += c.duration;
  return sum;
}

void print(const fs::path& file, const Outcome& o) {
  std::printf("%-36s %6.0f ms  %4zu nodes %3d bones %3zu links %3zu meshes %3zu clips %7.2f s\n",
              file.filename().c_str(), 1e3 * o.seconds, o.scene.nodes.size(), bones_in(o.scene),
              o.scene.links.size(), o.scene.meshes.size(), o.scene.clips.size(), length_of_clips(o.scene));
}

TEST(RealFiles, AllSharedAssetsAreRead) {
  if (!fs::exists(kAssets)) GTEST_SKIP() << kAssets << " is not there";
  const std::set<std::string> models{".glb", ".gltf", ".fbx", ".bvh", ".dae", ".urdf"};
  int read_well = 0;
  for (const auto& entry : fs::recursive_directory_iterator(kAssets)) {
    if (!models.count(entry.path().extension().string())) continue;
    if (entry.path().parent_path().filename() == "expected_error") continue;
    const Outcome outcome = read(entry.path());
    EXPECT_TRUE(outcome.ok) << entry.path() << ": " << outcome.error;
    print(entry.path(), outcome);
    read_well += outcome.ok;
  }
  EXPECT_GT(read_well, 0);
}

TEST(RealFiles, ExpectedErrorNamesJointAndCause) {
  const fs::path file = kAssets / "urdf/expected_error/spherical_joint_limit.urdf";
  if (!fs::exists(file)) GTEST_SKIP() << file << " is not there";
  const Outcome outcome = read(file);
  EXPECT_FALSE(outcome.ok);
  EXPECT_NE(outcome.error.find("neck"), std::string::npos) << outcome.error;
  EXPECT_NE(outcome.error.find("spherical"), std::string::npos) << outcome.error;
}

struct Known {
  const char* file;
  int bones, links;  ///< bones: counted where the file has a skin or is a BVH; -1 not compared
  int clips;
  double length;  ///< of all clips together, s
};

void PrintTo(const Known& known, std::ostream* out) {
  *out << known.file;
}

class KnownFile : public testing::TestWithParam<Known> {};

TEST_P(KnownFile, HoldsWhatWasCountedInIt) {
  const Known& known = GetParam();
  const fs::path file = kAssets / known.file;
  if (!fs::exists(file)) GTEST_SKIP() << file << " is not there";
  const Outcome outcome = read(file);
  ASSERT_TRUE(outcome.ok) << outcome.error;
  if (known.bones >= 0) {
    EXPECT_EQ(bones_in(outcome.scene), known.bones);
  }
  EXPECT_EQ(outcome.scene.links.size(), static_cast<std::size_t>(known.links));
  EXPECT_EQ(outcome.scene.clips.size(), static_cast<std::size_t>(known.clips));
  // The lengths were noted with two digits and count the gap before a late first key, of up to 42 ms each.
  EXPECT_LE(length_of_clips(outcome.scene), known.length + 0.006);
  EXPECT_GE(length_of_clips(outcome.scene), known.length - 0.006 - 0.0425 * known.clips);
}

INSTANTIATE_TEST_SUITE_P(
    Table, KnownFile,
    testing::Values(
        Known{"gltf/kaykit_knight.glb", 41, 0, 76, 91.4}, Known{"gltf/cesium_man.gltf", 19, 0, 1, 2},
        Known{"gltf/fox.glb", 24, 0, 3, 5.28}, Known{"gltf/quaternius_robot.glb", 43, 0, 14, 19.5},
        Known{"gltf/kenney_character.glb", -1, 0, 4, 1.7},
        Known{"gltf/kaykit_manny/manny_med_mod.gltf", 21, 0, 0, 0},
        Known{"gltf/kaykit_manny/Med_MovementBasic.glb", -1, 0, 11, 11.57},
        Known{"bvh/boxing_toes.bvh", 21, 0, 1, 30.68}, Known{"bvh/fair_zombie.bvh", 27, 0, 1, 25.93},
        Known{"bvh/jesse_dance.bvh", 60, 0, 1, 10.06}, Known{"fbx/geno.fbx", 75, 0, 0, 0},
        Known{"fbx/pab_arnaud.fbx", 53, 0, 0, 0}, Known{"fbx/sausage_3clips.fbx", 3, 0, 3, 2.46},
        Known{"dae/walk.dae", 22, 0, 1, 5.79}, Known{"dae/box_with_double_skeleton.dae", 4, 0, 1, 0.83},
        Known{"urdf/romeo.urdf", 0, 82, 0, 0}, Known{"urdf/panda.urdf", 0, 13, 0, 0}),
    [](const auto& one) {
      std::string name = fs::path(one.param.file).stem().string();
      std::replace_if(
          name.begin(), name.end(), [](unsigned char c) { return !std::isalnum(c); }, '_');
      return name;
    });

TEST(RealFiles, FbxSaysItsUnitAndUpAxis) {  // trap 5
  if (!fs::exists(kModels)) GTEST_SKIP() << "assimp-testmodels are not installed";
  const Outcome outcome = read(kModels / "FBX/huesitos.fbx");
  ASSERT_TRUE(outcome.ok) << outcome.error;
  EXPECT_EQ(outcome.scene.meters_per_unit, 0.01);
  EXPECT_EQ(outcome.scene.up_axis, 1);
}

TEST(RealFiles, MassOfRomeoIsTheSumOfItsLinks) {
  const fs::path file = kAssets / "urdf/romeo.urdf";
  if (!fs::exists(file)) GTEST_SKIP() << file << " is not there";
  const Outcome outcome = read(file);
  ASSERT_TRUE(outcome.ok) << outcome.error;
  double mass = 0;
  for (const SourceUrdfLink& link : outcome.scene.links) mass += link.mass;
  EXPECT_NEAR(mass, 40.53, 0.005);  // noted with two digits
}

TEST(RealFiles, ReadingTwiceGivesTheSame) {
  const fs::path file = kAssets / "gltf/kaykit_knight.glb";
  if (!fs::exists(file)) GTEST_SKIP() << file << " is not there";
  const Outcome one = read(file), other = read(file);
  ASSERT_TRUE(one.ok && other.ok);
  ASSERT_EQ(one.scene.nodes.size(), other.scene.nodes.size());
  for (std::size_t i = 0; i < one.scene.nodes.size(); ++i) {
    EXPECT_EQ(one.scene.nodes[i].name, other.scene.nodes[i].name);
    EXPECT_EQ(one.scene.nodes[i].local, other.scene.nodes[i].local);
  }
  EXPECT_EQ(one.scene.notes, other.scene.notes);
}

TEST(RealFiles, DebiansTestModelsAreRead) {
  if (!fs::exists(kModels)) GTEST_SKIP() << "assimp-testmodels are not installed";
  for (const char* name :
       {"BVH/01_01.bvh", "BVH/01_03.bvh", "BVH/Boxing_Toes.bvh", "FBX/huesitos.fbx",
        "FBX/animation_with_skeleton.fbx", "FBX/cubes_with_mirroring_and_pivot.fbx",
        "glTF2/simple_skin/simple_skin.gltf", "Collada/box_nested_animation.dae",
        "Collada/anims_with_full_rotations_between_keys.DAE", "Collada/duck_triangulate.dae"}) {
    const Outcome outcome = read(kModels / name);
    EXPECT_TRUE(outcome.ok) << name << ": " << outcome.error;
    print(name, outcome);
  }
}

}  // namespace
}  // namespace sinew::import::test
