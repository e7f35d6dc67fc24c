// Folding pivots must leave every node where assimp's own chain of helper nodes puts it, at rest and at keys.
#include "import/fbx_pivots.h"

#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <assimp/Importer.hpp>
#include <map>

#include "fixtures/paths.h"
#include "import/keys.h"
#include "reading.h"

namespace sinew::import::test {
namespace {

Eigen::Matrix4d global(const SourceScene& s, int node, const SourceClip* clip, double t) {
  Eigen::Matrix4d m = Eigen::Matrix4d::Identity();
  for (; node >= 0; node = s.nodes[node].parent) {
    const SourceChannel* channel = nullptr;
    if (clip)
      for (const SourceChannel& c : clip->channels)
        if (c.node == node) channel = &c;
    m = local_at(s.nodes[node], channel, t) * m;
  }
  return m;
}

SourceNode made_node(const char* name, int parent, const Eigen::Affine3d& local) {
  SourceNode node;
  node.name = node.original_name = name;
  node.parent = parent;
  node.local = local.matrix();
  return node;
}

/// hip → (fixed pre-rotation) → (turning pivot) → knee → foot, as assimp lays FBX pivots out.
SourceScene pivoted_leg() {
  using Eigen::AngleAxisd, Eigen::Translation3d, Eigen::Vector3d;
  SourceScene s;
  s.nodes.push_back(made_node("hip", -1, Eigen::Affine3d(Translation3d(0, 1, 0))));
  s.nodes.push_back(
      made_node("knee_$AssimpFbx$_PreRotation", 0, Eigen::Affine3d(AngleAxisd(0.7, Vector3d::UnitZ()))));
  s.nodes.push_back(made_node("knee_$AssimpFbx$_Rotation", 1, Eigen::Affine3d(Translation3d(0.1, 0, 0))));
  s.nodes.push_back(made_node("knee", 2, Eigen::Affine3d(Translation3d(0, -0.5, 0))));
  s.nodes.push_back(made_node("foot", 3, Eigen::Affine3d(Translation3d(0, -0.4, 0))));
  SourceClip clip;
  clip.name = "kick";
  clip.duration = 1;
  SourceChannel turn;
  turn.node = 2;
  turn.rotation_times = {0, 0.5, 1};
  for (const double angle : {0.0, 0.6, -0.9})
    turn.rotations.emplace_back(AngleAxisd(angle, Vector3d(1, 2, 2).normalized()));
  SourceChannel shift;
  shift.node = 1;
  shift.position_times = {0, 0.25, 1};
  shift.positions = {Vector3d(0, -0.5, 0), Vector3d(0, -0.6, 0.1), Vector3d(0, -0.5, 0)};
  clip.channels = {turn, shift};
  s.clips.push_back(clip);
  return s;
}

TEST(FbxPivots, FoldedJointMovesAsItsChainDid) {  // trap 7
  const SourceScene before = pivoted_leg();
  SourceScene after = before;
  fold_fbx_pivots(after);
  ASSERT_EQ(after.nodes.size(), 3u);
  EXPECT_EQ(after.nodes[1].name, "knee");
  EXPECT_EQ(after.nodes[2].parent, 1);
  for (const char* name : {"hip", "knee", "foot"}) {
    const int was = index_of(before, name), is = index_of(after, name);
    EXPECT_LT((global(before, was, nullptr, 0) - global(after, is, nullptr, 0)).norm(), 1e-12) << name;
    for (const double t : {0.0, 0.25, 0.5, 1.0})  // where keys are: between them the curves differ in kind
      EXPECT_LT((global(before, was, &before.clips[0], t) - global(after, is, &after.clips[0], t)).norm(),
                1e-12)
          << name << " at " << t << " s";
  }
}

TEST(FbxPivots, KeysOfTheJointItselfHoldItsWholeChain) {
  SourceScene scene = pivoted_leg();
  SourceChannel whole = scene.clips[0].channels[0];
  whole.node = 3;
  scene.clips[0].channels = {whole};
  fold_fbx_pivots(scene);
  ASSERT_EQ(scene.clips[0].channels.size(), 1u);
  EXPECT_EQ(scene.clips[0].channels[0].node, index_of(scene, "knee"));
  for (std::size_t k = 0; k < whole.rotations.size(); ++k)
    EXPECT_EQ(scene.clips[0].channels[0].rotations[k].coeffs(), whole.rotations[k].coeffs());
}

TEST(FbxPivots, SceneWithoutThemStaysAsItIs) {
  SourceScene scene = pivoted_leg();
  for (SourceNode& n : scene.nodes) n.original_name = n.name = "n" + std::to_string(&n - scene.nodes.data());
  fold_fbx_pivots(scene);
  EXPECT_EQ(scene.nodes.size(), 5u);
  EXPECT_TRUE(scene.notes.empty());
}

Eigen::Matrix4d global(const aiNode* node) {
  Eigen::Matrix4d m = Eigen::Matrix4d::Identity();
  for (; node; node = node->mParent) {
    Eigen::Matrix4d local;
    for (unsigned r = 0; r < 4; ++r)
      for (unsigned c = 0; c < 4; ++c) local(r, c) = double(node->mTransformation[r][c]);
    m = local * m;
  }
  return m;
}

TEST(FbxPivots, RealRigsRestWhereAssimpPutsThem) {
  int compared = 0;
  for (const char* name : {"fbx/geno.fbx", "fbx/pab_arnaud.fbx", "fbx/sausage_3clips.fbx"}) {
    const auto file = std::filesystem::path(shared_dir()) / "assets" / name;
    if (!std::filesystem::exists(file)) continue;
    const Outcome outcome = read(file);
    ASSERT_TRUE(outcome.ok) << outcome.error;
    Assimp::Importer importer;
    const aiScene* scene = importer.ReadFile(file.string(), aiProcess_ValidateDataStructure);
    ASSERT_NE(scene, nullptr) << importer.GetErrorString();
    for (std::size_t i = 0; i < outcome.scene.nodes.size(); ++i) {
      const SourceNode& node = outcome.scene.nodes[i];
      EXPECT_EQ(node.original_name.find("$AssimpFbx$"), std::string::npos);
      const aiNode* theirs = scene->mRootNode->FindNode(node.original_name.c_str());
      ASSERT_NE(theirs, nullptr) << node.original_name;
      // Both multiply the same floats in double, in another order of brackets.
      const Eigen::Matrix4d expected = global(theirs);
      EXPECT_LT((global(outcome.scene, static_cast<int>(i), nullptr, 0) - expected).norm(),
                1e-9 * expected.norm())
          << name << ": " << node.name;
      ++compared;
    }
  }
  if (compared == 0) GTEST_SKIP() << shared_dir() << "/assets is not there";
}

// A walker's head is above its hips and one foot well below them, whatever the rig's pivots are.
TEST(FbxPivots, RealClipsStandUpright) {
  const auto file = std::filesystem::path(shared_dir()) / "assets/fbx/pab_locomotions.fbx";
  if (!std::filesystem::exists(file)) GTEST_SKIP() << file << " is not there";
  const Outcome outcome = read(file);
  ASSERT_TRUE(outcome.ok) << outcome.error;
  ASSERT_EQ(outcome.scene.clips.size(), 3u);
  const auto height = [&](const char* node, const SourceClip& clip, double t) {
    return global(outcome.scene, index_of(outcome.scene, node), &clip, t)(1, 3);
  };
  for (const SourceClip& clip : outcome.scene.clips)
    for (const double t : {0.0, clip.duration / 2, clip.duration}) {
      const double hips = height("Hips", clip, t);
      EXPECT_GT(height("Head", clip, t), hips + 40) << clip.name << " at " << t << " s";  // in cm
      EXPECT_LT(std::min(height("LeftFoot", clip, t), height("RightFoot", clip, t)), hips - 60)
          << clip.name << " at " << t << " s";
    }
}

}  // namespace
}  // namespace sinew::import::test
