#include "sinew/io/asset.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <fstream>
#include <limits>
#include <random>

#include "fixtures/humanoid.h"
#include "fixtures/paths.h"
#include "sinew/animation/clip_packing.h"
#include "sinew/animation/sampling_job.h"

namespace sinew {
namespace {

/// Turns and shifts of a few joints as whole numbers, which files hold packed.
Clip packed_clip(const Skeleton& skeleton) {
  Clip clip;
  clip.name = "sway";
  clip.duration = 2;
  clip.joint_count = static_cast<int>(skeleton.joints.size());
  for (const Joint& j : skeleton.joints) clip.constants.push_back(j.rest.cast<float>());
  clip.constants[2].rotation = Quat<float>(0.6f, 0.8f, 0, 0);
  clip.constants[5].translation.x() += 0.25f;
  std::mt19937 random(7);
  for (const bool rotation : {true, false}) {
    Clip::Group& group = clip.groups.emplace_back();
    group.rotation = rotation;
    group.degree = 5;
    group.knot_interval = 0.125f;
    group.control_count = 21;
    group.tracks = {{1}, {6}, {0}};
    group.packings = {{40, 3, {3, -100, 20, 77}}, {36, 3, {0, 0, 0, 127}}, {44, 4, {}}};
    if (!rotation) group.packings[2].components = 3;
    std::int32_t numbers[3][4] = {{0, 300, -50, 0}, {1, 2, 3, 0}, {0, 0, 0, 1 << 11}};
    for (int knot = 0; knot < group.control_count; ++knot)
      for (std::size_t k = 0; k < 3; ++k) {
        float control[4];
        for (int c = 0; c < 3; ++c) numbers[k][c] += static_cast<int>(random() % 15) - 7;
        unpack_control(group.packings[k], rotation, numbers[k], control);
        group.controls.insert(group.controls.end(), control, control + (rotation ? 4 : 3));
      }
  }
  return clip;
}

/// The fixture humanoid with two moving clips, a skinned triangle and a material.
Asset sample_asset() {
  Asset asset;
  asset.skeleton = fixtures::humanoid();
  const int joints = static_cast<int>(asset.skeleton.joints.size());
  const int arm = asset.skeleton.find("upperarm_l");
  asset.skeleton.joints[std::size_t(arm)].ellipsoidal_limit = true;
  asset.skeleton.muscles.push_back({"deltoid", "arms", arm, 1, 15, 25});
  Clip clip;
  clip.name = "nod";
  clip.duration = 1;
  clip.joint_count = joints;
  for (const Joint& j : asset.skeleton.joints) clip.constants.push_back(j.rest.cast<float>());
  Clip::Group group;
  group.degree = 3;
  group.knot_interval = 0.25f;
  group.control_count = 7;
  group.tracks = {{1}, {3}};
  for (int k = 0; k < 7 * 2; ++k) group.controls.insert(group.controls.end(), {0.1f * float(k % 3), 0, 0, 1});
  clip.groups.push_back(group);
  clip.contacts.push_back({4, 0.1f, 0.5f});
  asset.curve_slots = {{"strength", 1}, {"smile", 0}};
  asset.event_names = {"blow", "step"};
  asset.masks = {{"arms", std::vector<std::uint8_t>(std::size_t(joints), 128)}};
  clip.curves = {{1, 0.5f, {0, 0.25f, 0.5f, 0.75f, 1}}};
  clip.events = {{0.25f, 0.25f, event_name("step")}, {0.5f, 0.75f, event_name("blow"), true}};
  clip.events[1].payload[15] = std::byte(200);
  clip.markers = {{0, 0.125}, {0.5, 0.625}};
  asset.clips.push_back(clip);
  asset.clips.push_back(packed_clip(asset.skeleton));
  Mesh mesh;
  mesh.name = "triangle";
  mesh.positions = {0, 0, 0, 1, 0, 0, 0, 1, 0};
  mesh.normals = {0, 0, 1, 0, 0, 1, 0, 0, 1};
  mesh.indices = {0, 1, 2};
  mesh.joints.assign(12, 2);
  mesh.weights = {1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0};
  mesh.material = 0;
  mesh.morphs.resize(2);
  mesh.morphs[0] = {{{0, 1}, {2, 1}}, {1, 2, 3, 4, 5, -32767}, 0.001f, {0, 0, 7, 0, 0, 9}, 0.5f};
  mesh.morphs[1] = {{{1, 2}}, {1, 0, 0, 0, 1, 0}, 0.25f, {}, 0};
  mesh.morph_curves = {1, 0};  // "smile", "strength"
  asset.meshes.push_back(mesh);
  asset.materials.push_back({"clay", {0.5f, 0.4f, 0.3f, 1}, {1, 2, 3}});
  asset.inverse_bind.resize(std::size_t(joints));
  asset.report_json = "{}";
  return asset;
}

TEST(Asset, ComesBackAsItWasWritten) {
  const std::vector<std::uint8_t> bytes = write_asset(sample_asset());
  Asset back;
  const Status status = read_asset(bytes, back);
  ASSERT_TRUE(status.ok()) << status.reason;
  EXPECT_EQ(write_asset(back), bytes);
  EXPECT_EQ(back.find_clip("nod"), 0);
  EXPECT_EQ(back.skeleton.joints[3].mass, fixtures::humanoid().joints[3].mass);
  const int deltoid = back.skeleton.find_muscle("deltoid");
  ASSERT_EQ(deltoid, 0);
  EXPECT_EQ(back.skeleton.muscles[0].group, "arms");
  EXPECT_EQ(back.skeleton.muscles[0].torque_plus, 25);
  EXPECT_TRUE(back.skeleton.joints[std::size_t(back.skeleton.muscles[0].joint)].ellipsoidal_limit);
}

TEST(Asset, HoldsWhatClipsSayBesideTheirMotion) {
  Asset back;
  ASSERT_TRUE(read_asset(write_asset(sample_asset()), back).ok());
  EXPECT_EQ(back.find_curve("smile"), 1);
  EXPECT_EQ(back.find_curve("frown"), -1);
  EXPECT_EQ(back.curve_slots[0].rest, 1);
  EXPECT_EQ(back.find_mask("arms"), 0);
  EXPECT_EQ(back.masks[0].weights[3], 128);
  const Clip& clip = back.clips[0];
  ASSERT_EQ(clip.curves.size(), 1u);
  EXPECT_EQ(clip.curves[0].slot, 1);
  EXPECT_EQ(clip.curves[0].controls, (std::vector<float>{0, 0.25f, 0.5f, 0.75f, 1}));
  ASSERT_EQ(clip.events.size(), 2u);
  EXPECT_EQ(clip.events[0].name, event_name("step"));
  EXPECT_FALSE(clip.events[0].always);
  EXPECT_EQ(clip.events[1].end, 0.75f);
  EXPECT_TRUE(clip.events[1].always);
  EXPECT_EQ(clip.events[1].payload[15], std::byte(200));
  ASSERT_EQ(clip.markers.size(), 2u);
  EXPECT_EQ(clip.markers[1].time, 0.625);
  EXPECT_TRUE(back.clips[1].events.empty());
}

TEST(Asset, HoldsMorphTargets) {
  Asset back;
  ASSERT_TRUE(read_asset(write_asset(sample_asset()), back).ok());
  const Mesh wanted = sample_asset().meshes[0], mesh = back.meshes[0];
  EXPECT_EQ(mesh.morph_curves, wanted.morph_curves);
  ASSERT_EQ(mesh.morphs.size(), 2u);
  for (std::size_t k = 0; k < 2; ++k) {
    EXPECT_EQ(mesh.morphs[k].moves, wanted.morphs[k].moves);
    EXPECT_EQ(mesh.morphs[k].tilts, wanted.morphs[k].tilts);
    EXPECT_EQ(mesh.morphs[k].scale, wanted.morphs[k].scale);
    EXPECT_EQ(mesh.morphs[k].tilt_scale, wanted.morphs[k].tilt_scale);
  }
  EXPECT_EQ(mesh.morphs[0].runs[1].first, 2u);
  EXPECT_EQ(mesh.morphs[1].runs[0].count, 2u);
}

TEST(Asset, MorphTargetsThatDoNotFitTheirMeshAreRefused) {
  const auto refused = [](const auto& spoil, const std::string& reason) {
    Asset bad = sample_asset(), out;
    spoil(bad.meshes[0]);
    const Status status = read_asset(write_asset(bad), out);
    EXPECT_FALSE(status.ok());
    EXPECT_EQ(status.reason, reason);
    EXPECT_EQ(status.index, 0);
  };
  const char* const kOther = "mesh has a morph target of other vertices";
  const char* const kNoCurve = "mesh has a morph target without a curve";
  refused([](Mesh& m) { m.morphs[0].runs[1].first = 3; }, kOther);
  refused([](Mesh& m) { m.morphs[0].runs[1].first = 0; }, kOther);
  refused([](Mesh& m) { m.morphs[0].runs[0].count = 0; }, kOther);
  refused([](Mesh& m) { m.morphs[1].runs[0].count = 0xFFFFFFFFu; }, kOther);
  refused([](Mesh& m) { std::swap(m.morphs[0].runs[0], m.morphs[0].runs[1]); }, kOther);
  refused([](Mesh& m) { m.morphs[0].moves.pop_back(); }, kOther);
  refused([](Mesh& m) { m.morphs[0].tilts.push_back(0); }, kOther);
  refused([](Mesh& m) { m.morphs[1].scale = std::numeric_limits<float>::quiet_NaN(); }, kOther);
  refused([](Mesh& m) { m.morphs[0].tilt_scale = std::numeric_limits<float>::infinity(); }, kOther);
  refused([](Mesh& m) { m.morph_curves[1] = 2; }, kNoCurve);
  refused([](Mesh& m) { m.morph_curves[1] = -1; }, kNoCurve);
  refused([](Mesh& m) { m.morph_curves.pop_back(); }, kNoCurve);
}

TEST(Asset, NamesOfEventsCurvesAndMasksAreChecked) {
  const auto refused = [](const auto& spoil, int index) {
    Asset bad = sample_asset();
    spoil(bad);
    const Status status = validate_names(bad);
    EXPECT_FALSE(status.ok());
    EXPECT_EQ(status.index, index) << status.reason;
    Asset out;
    EXPECT_FALSE(read_asset(write_asset(bad), out).ok());
  };
  EXPECT_TRUE(validate_names(sample_asset()).ok());
  refused([](Asset& a) { a.curve_slots.push_back({"smile", 0}); }, 2);
  refused([](Asset& a) { a.curve_slots.pop_back(); }, 0);
  refused([](Asset& a) { a.event_names.emplace_back("blow"); }, 2);
  refused([](Asset& a) { a.masks.push_back(a.masks[0]); }, 1);
  refused([](Asset& a) { a.masks[0].weights.pop_back(); }, 0);
  // Numbers of these two are equal (FNV-1a).
  ASSERT_EQ(event_name("costarring"), event_name("liquid"));
  refused([](Asset& a) { a.event_names = {"step", "blow", "costarring", "liquid"}; }, 3);
}

void expect_same_motion(const Clip& a, const Clip& b) {
  EXPECT_EQ(a.constants, b.constants);
  ASSERT_EQ(a.groups.size(), b.groups.size());
  for (std::size_t g = 0; g < a.groups.size(); ++g) {
    EXPECT_EQ(a.groups[g].controls, b.groups[g].controls);
    EXPECT_EQ(a.groups[g].knot_interval, b.groups[g].knot_interval);
    ASSERT_EQ(a.groups[g].tracks.size(), b.groups[g].tracks.size());
    for (std::size_t k = 0; k < a.groups[g].tracks.size(); ++k)
      EXPECT_EQ(a.groups[g].tracks[k].joint, b.groups[g].tracks[k].joint);
  }
}

TEST(Asset, ClipsArePlayedAsTheyWereWritten) {
  const Asset asset = sample_asset();
  Asset back;
  ASSERT_TRUE(read_asset(write_asset(asset), back).ok());
  ASSERT_EQ(back.clips.size(), 2u);
  for (std::size_t c = 0; c < 2; ++c) expect_same_motion(asset.clips[c], back.clips[c]);
  EXPECT_TRUE(back.clips[0].groups[0].packings.empty());
  EXPECT_EQ(back.clips[1].groups[1].packings.size(), 3u);
}

TEST(Asset, PackedClipsTakeAFractionOfTheirControls) {
  const Asset asset = sample_asset();
  Clip plain = asset.clips[1];
  for (Clip::Group& group : plain.groups) group.packings.clear();
  EXPECT_LT(2 * file_bytes(asset.clips[1], asset.skeleton), file_bytes(plain, asset.skeleton));
  // A control that is no whole number any more: the file holds it as it is.
  Asset changed = asset;
  float& control = changed.clips[1].groups[0].controls[5];
  control = std::nextafter(control, 2.f);
  Asset back;
  ASSERT_TRUE(read_asset(write_asset(changed), back).ok());
  expect_same_motion(changed.clips[1], back.clips[1]);
}

/// version_1.sinew: sample_asset() with its first clip only, by the writer before clips were packed.
TEST(Asset, FilesOfTheFirstVersionAreStillRead) {
  Asset back;
  const Status status = load_asset((source_dir() + "/tests/io/version_1.sinew").c_str(), back);
  ASSERT_TRUE(status.ok()) << status.reason;
  ASSERT_EQ(back.clips.size(), 1u);
  const Asset asset = sample_asset();
  expect_same_motion(asset.clips[0], back.clips[0]);
  EXPECT_EQ(back.clips[0].contacts.size(), 1u);
  EXPECT_EQ(back.skeleton.joints.size(), asset.skeleton.joints.size());
}

/// version_2_1.sinew: sample_asset() by the writer before meshes had morph targets.
TEST(Asset, FilesFromBeforeMorphTargetsAreStillRead) {
  Asset back;
  const Status status = load_asset((source_dir() + "/tests/io/version_2_1.sinew").c_str(), back);
  ASSERT_TRUE(status.ok()) << status.reason;
  const Asset asset = sample_asset();
  ASSERT_EQ(back.clips.size(), 2u);
  for (std::size_t c = 0; c < 2; ++c) expect_same_motion(asset.clips[c], back.clips[c]);
  EXPECT_EQ(back.find_curve("smile"), 1);
  ASSERT_EQ(back.meshes.size(), 1u);
  EXPECT_EQ(back.meshes[0].positions, asset.meshes[0].positions);
  EXPECT_TRUE(back.meshes[0].morphs.empty());
  EXPECT_TRUE(back.meshes[0].morph_curves.empty());
}

TEST(Asset, DamagedImagesGiveAnErrorOrAValidAssetButNeverACrash) {
  const std::vector<std::uint8_t> good = write_asset(sample_asset());
  constexpr unsigned kSeed = 20261121;
  std::printf("seed %u\n", kSeed);
  std::mt19937 random(kSeed);
  int refused = 0;
  for (int n = 0; n < 2000; ++n) {
    std::vector<std::uint8_t> bad = good;
    switch (n % 3) {
      case 0:
        bad.resize(random() % good.size());
        break;
      case 1:
        for (unsigned k = 0, flips = 1 + random() % 16; k < flips; ++k)
          bad[random() % bad.size()] ^= std::uint8_t(1u << (random() % 8));
        break;
      default:
        for (unsigned k = 0, words = 1 + random() % 4; k < words; ++k) {
          const std::size_t at = 4 * (random() % (bad.size() / 4));
          const std::uint32_t value = random() % 2 ? 0xFFFFFFFFu : std::uint32_t(random());
          for (int b = 0; b < 4; ++b) bad[at + std::size_t(b)] = std::uint8_t(value >> (8 * b));
        }
        bad.insert(bad.end(), random() % 64, 0xAB);
    }
    Asset out;
    out.report_json = "untouched";
    const Status status = read_asset(bad, out);
    if (!status) {
      ++refused;
      ASSERT_NE(std::string(status.reason), "");
      ASSERT_EQ(out.report_json, "untouched") << "mutation " << n;
      continue;
    }
    ASSERT_TRUE(validate(out.skeleton).ok()) << "mutation " << n;
    for (const Mesh& mesh : out.meshes) {
      ASSERT_EQ(mesh.morph_curves.size(), mesh.morphs.size());
      for (const int slot : mesh.morph_curves) ASSERT_LT(std::size_t(slot), out.curve_slots.size());
      const std::vector<float> weights(mesh.morphs.size(), 0.5f);
      std::vector<float> moved(mesh.positions.size());
      ASSERT_TRUE((MorphJob{mesh.positions, {}, mesh.morphs, weights, moved}.Run().ok()));
    }
    for (const Clip& clip : out.clips) {
      std::vector<JointJet<float>> jets(out.skeleton.joints.size());
      ASSERT_TRUE((SamplingJob<float>{&clip, 0.3, jets}.Run().ok()));
    }
  }
  EXPECT_GT(refused, 600);  // every truncation at least
}

TEST(Asset, PathsThatAreNoAssetAreRefused) {
  Asset out;
  EXPECT_EQ(load_asset("/no/such/file.sinew", out).code, Code::kIo);
  EXPECT_EQ(load_asset("/tmp", out).code, Code::kIo);
  const std::string empty = testing::TempDir() + "empty.sinew";
  std::ofstream(empty).close();
  EXPECT_EQ(load_asset(empty.c_str(), out).code, Code::kBadFile);
  std::ofstream(empty) << "just some text, longer than a header would be";
  EXPECT_EQ(load_asset(empty.c_str(), out).code, Code::kBadFile);
}

}  // namespace
}  // namespace sinew
