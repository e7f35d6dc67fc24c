// What feet of a graph see of a scene, and the scene that is compared with.
#include "scene/ground.h"

#include <gtest/gtest.h>

#include <cmath>

#include "fixtures/paths.h"
#include "graph/certificate.h"
#include "scene/graph_plot.h"
#include "sinew/skeleton/rotation.h"

namespace sinew::scene {
namespace {

Collider box(const Vec3<double>& size, const Vec3<double>& at,
             const Vec3<double>& turn = Vec3<double>::Zero()) {
  Collider c;
  c.shape = Shape::kBox;
  c.size = size;
  c.local.translation = at;
  c.local.rotation = rotation_exp<double>(turn);
  return c;
}

TEST(SceneGround, IsTheHighestThingBelow) {
  Ground ground;
  GroundHit<double> hit;
  EXPECT_FALSE(ground.below<double>({0, 0, 1}, hit));
  ground.floor = 0;
  ground.obstacles = {box({0.5, 0.5, 0.1}, {2, 0, 0.1}), box({1, 1, 0.1}, {2, 0, 3}),
                      box({2, 1, 0.1}, {6, 0, 0}, {0, std::atan(0.2), 0})};
  Collider sphere;
  sphere.shape = Shape::kSphere;
  sphere.size = {0.5, 0, 0};
  sphere.local.translation = {0, 5, 0};
  ground.obstacles.push_back(sphere);
  ASSERT_TRUE(ground.below<double>({0, 0, 1}, hit));
  EXPECT_EQ(hit.point, Vec3<double>(0, 0, 0));
  ASSERT_TRUE(ground.below<double>({2.4, 0, 1}, hit));
  EXPECT_NEAR(hit.point.z(), 0.2, 1e-12) << "the step, not the ceiling above";
  EXPECT_NEAR(hit.normal.z(), 1, 1e-12);
  ASSERT_TRUE(ground.below<double>({2.6, 0, 1}, hit));
  EXPECT_NEAR(hit.point.z(), 0, 1e-12) << "beside it";
  ASSERT_TRUE(ground.below<double>({6, 0.3, 1}, hit));
  EXPECT_NEAR(hit.point.z(), 0.1 * std::sqrt(1.04), 1e-12) << "thickness of the slope, measured upright";
  EXPECT_LT((hit.normal - Vec3<double>(0.2, 0, 1).normalized()).norm(), 1e-12);
  ASSERT_TRUE(ground.below<double>({0.3, 5, 1}, hit));
  EXPECT_NEAR(hit.point.z(), 0.4, 1e-12);
  EXPECT_LT((hit.normal - Vec3<double>(0.6, 0, 0.8)).norm(), 1e-12);
}

// Known by what the certificate says of it: every transition but none of the rest.
TEST(SceneGround, TheSceneUnderAStickIsSmoothAndWhatItIsComparedWithIsNot) {
  Scene own, usual;
  const convert::Error error = load_scene(source_dir() + "/assets/scenes/stick.json", own);
  ASSERT_FALSE(error) << error.message;
  ASSERT_FALSE(with_smoothsteps(own, usual));
  const GraphDefinition& graph = own.characters[0].graph.graph->definition();
  EXPECT_TRUE(graph_tools::smoothness_losses(graph).empty());
  std::size_t transitions = 0;
  for (const GraphNode& node : graph.nodes) transitions += node.transitions.size();
  EXPECT_EQ(graph_tools::smoothness_losses(usual.characters[0].graph.graph->definition()).size(),
            transitions);
  ASSERT_TRUE(own.characters[0].graph.ground);
  GroundHit<float> hit;
  ASSERT_TRUE(own.characters[0].graph.ground->below<float>({5, 0, 2}, hit));
  EXPECT_NEAR(hit.point.z(), 0.75f, 1e-6f);
  own.duration = 0.2;
  AskedOf asked;
  ASSERT_FALSE(run_asked(own, asked));
  EXPECT_EQ(asked.time.size(), 13u);
}

}  // namespace
}  // namespace sinew::scene
