// Triangles of a frame, before anything is drawn.
#include "render/geometry.h"

#include <gtest/gtest.h>

#include "render/figure.h"

namespace sinew::render {
namespace {

constexpr float kLift = 0.125f;  ///< m, that the target lifts the first vertex by

/// In a skin whose first vertex a target lifts along the model's axes; a curve "grin" moves it, 0.5 at rest.
std::shared_ptr<Asset> grinning() {
  auto asset = fixtures::skinned_humanoid();
  Mesh& mesh = asset->meshes[0];
  std::vector<float> moves(mesh.positions.size(), 0);
  moves[2] = kLift;
  mesh.morphs.resize(1);
  EXPECT_TRUE(build_morph_target(moves, {}, 1e-5f, mesh.morphs[0]).ok());
  asset->curve_slots = {{"strength", 1}, {"grin", 0.5f}};
  mesh.morph_curves = {1};
  return asset;
}

/// Vertices of a figure that stands at rest, with its curves at `curves`.
std::vector<Vertex> drawn(const std::shared_ptr<const Asset>& asset, const std::vector<float>& curves) {
  scene::CharacterFrame frame = fixtures::swinging(asset, 0).frames[0].characters[0];
  frame.curves = curves;
  Geometry geometry;
  append_character(*asset, frame, Look::kSkin, geometry);
  return geometry.vertices;
}

TEST(Geometry, AVertexMovesByWeightTimesTarget) {
  const auto asset = grinning();
  const std::vector<Vertex> base = drawn(fixtures::skinned_humanoid(), {});
  const auto lift = [&](const std::vector<float>& curves) {
    const std::vector<Vertex> vertices = drawn(asset, curves);
    EXPECT_EQ(vertices.size(), base.size());
    EXPECT_EQ(vertices[1].position[2], base[1].position[2]);
    const Vec3<float> by(vertices[0].position[0] - base[0].position[0],
                         vertices[0].position[1] - base[0].position[1],
                         vertices[0].position[2] - base[0].position[2]);
    EXPECT_NEAR(by.norm(), std::abs(by.z()), 1e-6f);  // the figure stands as it was bound
    return by.z();
  };
  EXPECT_NEAR(lift({1, 0}), 0, 1e-6f);
  EXPECT_NEAR(lift({1, 1}), kLift, 1e-5f);
  EXPECT_NEAR(lift({1, 2}), 2 * kLift, 1e-5f);
  EXPECT_NEAR(lift({}), 0.5f * kLift, 1e-5f);  // at rest
}

TEST(Geometry, TargetsWithoutACurveDoNothing) {
  const auto asset = grinning();
  const float base = drawn(fixtures::skinned_humanoid(), {})[0].position[2];
  for (const std::vector<int>& curves : {std::vector<int>{}, std::vector<int>{-1}, std::vector<int>{7}}) {
    asset->meshes[0].morph_curves = curves;
    EXPECT_NEAR(drawn(asset, {1, 1})[0].position[2], base, 1e-6f);
  }
}

}  // namespace
}  // namespace sinew::render
