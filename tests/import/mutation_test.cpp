// Files damaged at random: each must come back as a sound scene, which converts to a valid asset, or as one
// line.
#include <random>

#include "convert/convert.h"
#include "import/scene_check.h"
#include "morphing_leg.h"
#include "sinew/io/asset.h"

namespace sinew::import::test {
namespace {

constexpr int kMutations = 200;
constexpr int kConversions = 10;  ///< of those that can be read; they take their time under the sanitizer
constexpr unsigned kSeed = 5489;

struct Seed {
  const char* name;
  const char* file;  ///< name to write it under
  std::string (*content)();
};

/// Cut off, a piece repeated, bytes replaced, a bit turned, or a digit replaced by another: the last two
/// reach deepest.
std::string mutated(std::string content, std::mt19937& random) {
  const auto place = [&] { return random() % content.size(); };
  switch (random() % 8) {
    case 0:
      return content.substr(0, place());
    case 1: {
      const std::string piece = content.substr(place(), random() % 200);
      return content.insert(place(), piece);
    }
    case 2:
      for (unsigned n = 1 + random() % 16; n-- > 0;) content[place()] = static_cast<char>(random());
      return content;
    case 3:
    case 4:
      content[place()] ^= static_cast<char>(1u << random() % 8);
      return content;
    default: {
      const std::size_t digit = content.find_first_of("0123456789", place());
      if (digit != std::string::npos) content[digit] = static_cast<char>('0' + random() % 10);
      return content;
    }
  }
}

void PrintTo(const Seed& seed, std::ostream* out) {
  *out << seed.name;
}

class Mutation : public testing::TestWithParam<Seed> {};

TEST_P(Mutation, GivesASoundSceneOrOneLine) {
  const std::string content = GetParam().content();
  if (content.empty()) GTEST_SKIP() << "assimp-testmodels are not installed";
  ASSERT_TRUE(read_content(GetParam().file, content).ok);
  std::mt19937 random(kSeed);
  ReadLimits limits;  // processor time for a reader that turns in place: others take a hundredth of it
  limits.cpu_seconds = 10;
  limits.wall_seconds = 3600;
  int read_well = 0;
  const Scratch scratch;
  for (int k = 0; k < kMutations; ++k) {
    const auto file = scratch.write(GetParam().file, mutated(content, random));
    const Outcome outcome = read(file, limits);
    SCOPED_TRACE("seed " + std::to_string(kSeed) + ", mutation " + std::to_string(k) + ": " + outcome.error);
    read_well += outcome.ok;
    if (outcome.ok) {
      ASSERT_EQ(fault_in(outcome.scene), "");
      if (read_well > kConversions) continue;
      Asset asset;
      nlohmann::json report;
      if (const auto refused = convert::convert_files({file.string()}, {}, asset, report)) {
        ASSERT_EQ(refused.message.find('\n'), std::string::npos) << refused.message;
        ASSERT_EQ(refused.message.rfind(file.string() + ": ", 0), 0u) << refused.message;
      } else {
        ASSERT_TRUE(validate(asset.skeleton).ok());
        Asset back;
        ASSERT_TRUE(read_asset(write_asset(asset), back).ok());
      }
    } else {
      ASSERT_FALSE(outcome.error.empty());
      ASSERT_EQ(outcome.error.find('\n'), std::string::npos);
      ASSERT_NE(outcome.error, "the reader ran out of time");
      ASSERT_NE(outcome.error, "the reader tried something that it may not");
    }
  }
  EXPECT_LT(read_well, kMutations);  // else nothing was damaged
  std::printf("%s: %d read, %d refused\n", GetParam().name, read_well, kMutations - read_well);
}

std::string model(const char* path) {
  return content_of(std::string("/usr/share/assimp/models/") + path);
}

INSTANTIATE_TEST_SUITE_P(
    Formats, Mutation,
    testing::Values(Seed{"Gltf", "a.gltf", [] { return with_triangle(kicking_leg(), 0).dump(); }},
                    Seed{"Glb", "a.glb",
                         [] { return as_glb(with_triangle(kicking_leg(), 0), kick_keys_and_corners()); }},
                    Seed{"MorphingGltf", "a.gltf", [] { return morphing_leg().dump(); }},
                    Seed{"MorphingGlb", "a.glb",
                         [] {
                           std::vector<float> values;
                           const nlohmann::json gltf = morphing_leg({}, values);
                           return as_glb(gltf, values);
                         }},
                    Seed{"Bvh", "a.bvh", [] { return walking_bvh(); }},
                    Seed{"Fbx", "a.fbx", [] { return model("FBX/huesitos.fbx"); }},
                    Seed{"Collada", "a.dae", [] { return model("Collada/box_nested_animation.dae"); }},
                    Seed{"Urdf", "a.urdf",
                         [] {
                           return short_urdf(
                               knee(kGoodLimit),
                               "<inertial><mass value=\"1\"/><inertia ixx=\"1\" ixy=\"0\" ixz=\"0\" "
                               "iyy=\"1\" iyz=\"0\" izz=\"1\"/></inertial><visual><geometry><box size=\"1 2 "
                               "3\"/></geometry></visual>");
                         }}),
    [](const auto& one) { return one.param.name; });

}  // namespace
}  // namespace sinew::import::test
