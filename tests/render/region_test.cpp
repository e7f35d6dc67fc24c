// Which parts of a picture a figure can change, and which meshes have an outside only.
#include "render/region.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "render/shapes.h"

namespace sinew::render {
namespace {

/// A camera 10 m south of the origin at 2 m, looking north; the light stands in the west.
Projection straight_ahead() {
  Projection p;
  p.width = 640;
  p.height = 360;
  p.focal = 360;
  p.light_direction = Vec3<float>(-1, 0, 1).normalized();
  p.view_projection << 1.125f, 0, 0, 0,  //
      0, 0, 2, -4,                       //
      0, 1, 0, 9.8f,                     //
      0, 1, 0, 10;
  return p;
}

int pixels(const std::vector<Area>& areas) {
  int sum = 0;
  for (const Area& a : areas) sum += a.width() * a.height();
  return sum;
}

bool covered(const std::vector<Area>& areas, float x, float y) {
  return std::any_of(areas.begin(), areas.end(), [&](const Area& a) {
    return x >= float(a.left) && x < float(a.right) && y >= float(a.bottom) && y < float(a.top);
  });
}

Eigen::Vector2f shown(const Projection& p, const Vec3<float>& at) {
  const Eigen::Vector4f clip = p.view_projection * at.homogeneous();
  return {(clip.x() / clip.w() + 1) * 0.5f * float(p.width),
          (clip.y() / clip.w() + 1) * 0.5f * float(p.height)};
}

Geometry ball(const Vec3<float>& at) {
  Geometry made;
  append_shape(Shape::kSphere, Vec3<float>::Constant(0.2f), {Quat<float>::Identity(), at}, kClay, made);
  return made;
}

TEST(Region, CoversTheFigureAndItsShadowAndLittleElse) {
  const Projection p = straight_ahead();
  const Geometry geometry = ball({0, 0, 1});
  const Regions found = find_regions(geometry, p);
  for (const Vertex& v : geometry.vertices) {
    const Vec3<float> at(v.position[0], v.position[1], v.position[2]);
    const Vec3<float> below = at - at.z() * p.light_direction / p.light_direction.z();
    const Eigen::Vector2f seen = shown(p, at), dark = shown(p, below);
    EXPECT_TRUE(covered(found.figure, seen.x(), seen.y()) && covered(found.near, seen.x(), seen.y()));
    EXPECT_TRUE(covered(found.shadow, dark.x(), dark.y()) && covered(found.near, dark.x(), dark.y()));
  }
  EXPECT_LT(pixels(found.figure), 640 * 360 / 20);
  EXPECT_LT(pixels(found.near), 640 * 360 / 4);
}

TEST(Region, ListsFillThePictureWithoutOverlap) {
  const Regions found = find_regions(ball({1, 2, 1.5f}), straight_ahead());
  EXPECT_EQ(pixels(found.near) + pixels(found.rest), 640 * 360);
  EXPECT_EQ(pixels(found.shadow) + pixels(found.only_near), pixels(found.near));
}

TEST(Region, WithoutAFigureAllIsRest) {
  const Regions found = find_regions({}, straight_ahead());
  EXPECT_TRUE(found.figure.empty() && found.near.empty() && found.shadow.empty());
  EXPECT_EQ(pixels(found.rest), 640 * 360);
}

TEST(Region, WhatReachesBehindTheCameraMayBeAnywhere) {
  const Regions found = find_regions(ball({0, -10, 2}), straight_ahead());
  EXPECT_EQ(pixels(found.figure), 640 * 360);
  EXPECT_EQ(pixels(found.shadow), 640 * 360);
}

TEST(Region, WhatIsBehindTheCameraIsNotInThePicture) {
  const Projection p = straight_ahead();
  Geometry geometry = ball({0, 0, 1});
  const int alone = pixels(find_regions(geometry, p).near);
  append_shape(Shape::kSphere, Vec3<float>::Constant(0.2f), {Quat<float>::Identity(), {0, -14, 2}}, kClay,
               geometry);
  const Regions found = find_regions(geometry, p);
  EXPECT_EQ(pixels(found.near), alone);
  EXPECT_TRUE(covered(found.figure, shown(p, {0, 0, 1}).x(), shown(p, {0, 0, 1}).y()));
}

TEST(Region, WhatIsCloseButBesideThePictureMakesNothingElseNearer) {
  Geometry geometry = ball({0, 0, 1});
  const int alone = pixels(find_regions(geometry, straight_ahead()).near);
  append_shape(Shape::kSphere, Vec3<float>::Constant(0.2f), {Quat<float>::Identity(), {5, -9, 2}}, kClay,
               geometry);
  EXPECT_LE(pixels(find_regions(geometry, straight_ahead()).near), alone);
}

/// A tetrahedron, seen from outside counter-clockwise.
Mesh tetrahedron() {
  Mesh mesh;
  mesh.positions = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
  mesh.indices = {0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3};
  return mesh;
}

TEST(ClosedMesh, HasTwoTrianglesAtEveryEdgeAndItsOutsideOutside) {
  EXPECT_TRUE(is_closed(tetrahedron()));
  Mesh open = tetrahedron();
  open.indices.resize(9);
  EXPECT_FALSE(is_closed(open));
  Mesh inside_out = tetrahedron();
  for (std::size_t i = 0; i < inside_out.indices.size(); i += 3)
    std::swap(inside_out.indices[i], inside_out.indices[i + 1]);
  EXPECT_FALSE(is_closed(inside_out));
}

TEST(ClosedMesh, JoinsVerticesAtOnePlaceAndLooksAtEveryPart) {
  // Every triangle with vertices of its own, as texture seams make them; and a second part, moved away.
  const Mesh whole = tetrahedron();
  Mesh split;
  for (const float shift : {0.f, 5.f})
    for (const std::uint32_t i : whole.indices) {
      split.indices.push_back(static_cast<std::uint32_t>(split.indices.size()));
      for (std::size_t k = 0; k < 3; ++k) split.positions.push_back(whole.positions[3 * i + k] + shift);
    }
  EXPECT_TRUE(is_closed(split));
  for (std::size_t i = 12; i < 24; i += 3) std::swap(split.indices[i], split.indices[i + 1]);
  EXPECT_FALSE(is_closed(split));  // its volumes add up to nothing, but one part is inside out
}

}  // namespace
}  // namespace sinew::render
