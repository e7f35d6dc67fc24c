// Vertices that weights move.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <random>

#include "fixtures/counting_new.h"
#include "sinew/animation/morph_job.h"
#include "sinew/animation/skinning_job.h"

namespace sinew {
namespace {

constexpr int kVertices = 500;
constexpr unsigned kSeed = 20261126;

/// A mesh within a metre, and targets of up to 5 cm that touch a part of it each.
class Morph : public testing::Test {
 protected:
  Morph() {
    std::mt19937 random(kSeed);
    std::normal_distribution<float> normal;
    for (int i = 0; i < 3 * kVertices; ++i) positions.push_back(normal(random));
    for (int v = 0; v < kVertices; ++v) {
      const Vec3<float> n = Vec3<float>(normal(random), normal(random), normal(random)).normalized();
      normals.insert(normals.end(), n.data(), n.data() + 3);
    }
    for (int k = 0; k < kTargets; ++k) {
      moves[k].assign(3 * kVertices, 0);
      tilts[k].assign(3 * kVertices, 0);
      for (int v = 40 * k; v < 40 * k + 90; v += k % 2 ? 1 : 7)
        for (int i = 3 * v; i < 3 * v + 3; ++i) {
          moves[k][i] = 0.02f * normal(random);
          tilts[k][i] = 0.3f * normal(random);
        }
      EXPECT_TRUE(build_morph_target(moves[k], tilts[k], 1e-5f, targets[k]).ok());
    }
    out = positions;
    out_normals = normals;
  }
  Status run(std::span<const float> weights) {
    return MorphJob{positions, normals, targets, weights, out, out_normals}.Run();
  }
  static constexpr int kTargets = 10;
  std::vector<float> positions, normals, moves[kTargets], tilts[kTargets], out, out_normals;
  std::array<MorphTarget, kTargets> targets;
};

TEST_F(Morph, IsTheSumOfItsTargetsAlsoBelowZeroAndAboveOne) {
  const float weights[kTargets] = {0, 1, 0.5f, -0.7f, 1.8f, 1, 1, 0.00001f, 0.3f, 0.2f};
  ASSERT_TRUE(run(weights).ok());
  for (int v = 0; v < kVertices; ++v) {
    Eigen::Vector3d normal = Eigen::Vector3d::Zero();
    for (int c = 0; c < 3; ++c) {
      double wanted = positions[3 * v + c], n = normals[3 * v + c];
      for (int k = 0; k < kTargets; ++k) {
        wanted += double(weights[k]) * double(moves[k][3 * v + c]);
        n += double(weights[k]) * double(tilts[k][3 * v + c]);
      }
      EXPECT_NEAR(out[3 * v + c], wanted, 1e-5) << "m";
      normal[c] = n;
    }
    normal.normalize();
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(out_normals[3 * v + c], normal[c], 2e-4) << v;
  }
}

TEST_F(Morph, TouchesOnlyItsVertices) {
  std::vector<float> weights(kTargets, 0);
  weights[3] = 1;
  ASSERT_TRUE(run(weights).ok());
  for (int i = 0; i < 3 * kVertices; ++i)
    if (i < 3 * 120 || i >= 3 * 210) {
      EXPECT_EQ(out[i], positions[i]);
      EXPECT_EQ(out_normals[i], normals[i]);
    }
}

TEST_F(Morph, RunsBridgeSmallGapsAlone) {
  std::vector<float> deltas(3 * 20, 0);
  for (const int v : {2, 3, 7, 12, 13}) deltas[3 * v] = 0.01f;
  MorphTarget target;
  ASSERT_TRUE(build_morph_target(deltas, {}, 1e-5f, target).ok());
  ASSERT_EQ(target.runs.size(), 2u);  // 2 … 7 across a gap of three, 12 … 13 beyond one of four
  EXPECT_EQ(target.runs[0].first, 2u);
  EXPECT_EQ(target.runs[0].count, 6u);
  EXPECT_EQ(target.runs[1].first, 12u);
  EXPECT_EQ(target.runs[1].count, 2u);
  EXPECT_EQ(target.moves.size(), 24u);
  EXPECT_TRUE(target.tilts.empty());
  ASSERT_TRUE(build_morph_target(std::vector<float>(60, 0), {}, 1e-5f, target).ok());
  EXPECT_TRUE(target.runs.empty()) << "a target that does nothing";
}

TEST_F(Morph, FewerVerticesInPlaceAndBeforeSkinning) {
  const std::vector<float> weights(kTargets, 0.5f);
  ASSERT_TRUE(run(weights).ok());
  std::vector<float> in_place = positions, part(3 * 60);
  ASSERT_TRUE((MorphJob{in_place, {}, targets, weights, in_place}.Run().ok()));
  EXPECT_EQ(in_place, out);
  ASSERT_TRUE((MorphJob{positions, {}, targets, weights, part}.Run().ok()));
  EXPECT_TRUE(std::equal(part.begin(), part.end(), out.begin()));
  const std::vector<std::uint16_t> joints(kVertices, 0);
  const std::vector<float> bone(kVertices, 1);
  std::vector<SkinMatrix> palette(1);
  const Transform<float> moved{Quat<float>::Identity(), {1, 0, 0}}, bind;
  skinning_palette(std::span(&moved, 1), std::span(&bind, 1), palette);
  std::vector<float> skinned(out.size());
  ASSERT_TRUE((SkinningJob{palette, 1, joints, bone, out, {}, skinned}.Run().ok()));
  for (int v = 0; v < kVertices; ++v) EXPECT_FLOAT_EQ(skinned[3 * v], out[3 * v] + 1);
}

TEST_F(Morph, TakesNothingFromTheHeap) {
  const std::vector<float> weights(kTargets, 0.5f);
  const long before = fixtures::allocations;
  const bool ok = run(weights).ok();
  EXPECT_EQ(fixtures::allocations, before);
  EXPECT_TRUE(ok);
}

TEST_F(Morph, RefusesWhatCannotBeMeant) {
  std::vector<float> weights(kTargets, 1);
  EXPECT_FALSE(run(std::span(weights).first(3)).ok());
  weights[4] = NAN;
  EXPECT_EQ(run(weights).index, 4);
  weights[4] = 1;
  const MorphTarget good = targets[2];
  const auto index_of = [&](auto change) {
    change(targets[2]);
    const int index = run(weights).index;
    targets[2] = good;
    return index;
  };
  EXPECT_EQ(index_of([](MorphTarget&) {}), -1);
  EXPECT_EQ(index_of([](MorphTarget& t) { t.moves.pop_back(); }), 2);
  EXPECT_EQ(index_of([](MorphTarget& t) { t.tilts.pop_back(); }), 2);
  EXPECT_EQ(index_of([](MorphTarget& t) { t.runs.back().first = kVertices; }), 2);
  EXPECT_EQ(index_of([](MorphTarget& t) { t.runs.back().count = ~0u; }), 2);
  EXPECT_EQ(index_of([](MorphTarget& t) { t.runs.insert(t.runs.begin(), t.runs.back()); }), 2);
  EXPECT_EQ(index_of([](MorphTarget& t) { t.scale = INFINITY; }), 2);
  out.resize(4);
  EXPECT_FALSE(run(weights).ok());
  MorphTarget target;
  std::vector<float> deltas(30, 0);
  EXPECT_FALSE(build_morph_target(std::span(deltas).first(29), {}, 0, target).ok());
  EXPECT_FALSE(build_morph_target(deltas, std::span(deltas).first(27), 0, target).ok());
  deltas[14] = NAN;
  EXPECT_EQ(build_morph_target(deltas, {}, 0, target).index, 4);
}

}  // namespace
}  // namespace sinew
