// What passes and transparent pictures hold, against a sphere whose numbers are known.
#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "render/figure.h"
#include "render/image.h"

namespace sinew::render {
namespace {

using fixtures::picture;
using fixtures::small_options;

constexpr int kSize = 64;
constexpr float kRadius = 0.5f;

/// A sphere of half a metre at the origin, from 5 m along x, over a floor far below.
Image sphere(Pass pass, bool transparent = false, const Vec3<float>& color = {0.5f, 0.5f, 0.5f}) {
  Geometry geometry;
  append_shape(Shape::kSphere, Vec3<float>::Constant(kRadius), {}, color, geometry);
  for (Vertex& v : geometry.vertices) v.glow = pass == Pass::kId ? 1 : 0;
  StageOptions options{kSize, kSize};
  options.transparent = transparent;
  options.pass = pass;
  std::string why;
  const auto stage = Stage::create(options, why);
  EXPECT_TRUE(stage) << why;
  Image image;
  View view{{5, 0, 0}, {0, 0, 0}};
  view.vertical_fov = 0.4f;
  if (stage) stage->draw(geometry, view, -10, image);
  return image;
}

/// Blue, green, red, alpha.
const std::uint8_t* pixel(const Image& image, int x, int y) {
  return &image.pixels[4 * (std::size_t(y) * std::size_t(image.width) + std::size_t(x))];
}

TEST(Pass, DepthIsMillimetresAlongTheView) {
  const Image image = sphere(Pass::kDepth);
  ASSERT_EQ(image.channels, Channels::kNumber);
  const auto depth = [&](int x, int y) { return 256 * pixel(image, x, y)[2] + pixel(image, x, y)[1]; };
  EXPECT_NEAR(depth(kSize / 2, kSize / 2), 4500, 10)
      << "tessellated: a sphere of triangles lies a little within";
  EXPECT_EQ(depth(0, 0), 65535);
  EXPECT_EQ(depth(kSize / 2, 0), 65535) << "the floor is no figure";
}

TEST(Pass, NormalsAreInTheWorldsAxes) {
  const Image image = sphere(Pass::kNormal);
  ASSERT_EQ(image.channels, Channels::kColorAlpha);
  const auto normal = [&](int x, int y, int k) { return 2 * pixel(image, x, y)[2 - k] / 255.0 - 1; };
  const int middle = kSize / 2, up = kSize / 2 - 12;  // 12 pixels up are 0.38 m of 0.5
  EXPECT_NEAR(normal(middle, middle, 0), 1, 0.02) << "towards the eye";
  EXPECT_NEAR(normal(middle, middle, 2), 0, 0.1);
  const double height = 12 * 2 * 5 * std::tan(0.2) / kSize / double(kRadius);
  EXPECT_NEAR(normal(middle, up, 2), height, 0.12);
  EXPECT_EQ(pixel(image, middle, middle)[3], 255);
  EXPECT_EQ(pixel(image, 0, 0)[3], 0);
}

TEST(Pass, IdsAreTheColoursThatWereGivenAndNoOthers) {
  const Vec3<float> byte = Vec3<float>(10, 120, 250) / 255;
  const Image image = sphere(Pass::kId, false, byte.cwiseProduct(byte));
  std::set<std::array<int, 4>> seen;
  for (int y = 0; y < kSize; ++y)
    for (int x = 0; x < kSize; ++x) {
      const std::uint8_t* p = pixel(image, x, y);
      seen.insert({p[2], p[1], p[0], p[3]});
    }
  EXPECT_EQ(seen, (std::set<std::array<int, 4>>{{0, 0, 0, 0}, {10, 120, 250, 255}}));
}

TEST(Pass, TransparentPicturesCoverTheFigureAndNothingElse) {
  const Image image = sphere(Pass::kPicture, true);
  ASSERT_EQ(image.channels, Channels::kColorAlpha);
  double covered = 0;
  for (int y = 0; y < kSize; ++y)
    for (int x = 0; x < kSize; ++x) {
      const std::uint8_t* p = pixel(image, x, y);
      covered += p[3] / 255.0;
      for (int k = 0; k < 3; ++k) EXPECT_LE(p[k], p[3]) << "colours are multiplied by alpha";
    }
  // The cone of a sphere of 0.5 m from 5 m, in pixels.
  const double radius = std::tan(std::asin(0.1)) / std::tan(0.2) * kSize / 2;
  EXPECT_NEAR(covered, 3.14159 * radius * radius, 0.03 * covered);
}

TEST(Pass, ColoursOfThingsDiffer) {
  scene::Recording rec = fixtures::swinging(fixtures::bare_humanoid(), 0);
  for (int k = 0; k < 40; ++k) rec.props.push_back({"ball " + std::to_string(k)});
  std::set<std::string> colors;
  for (const auto& [name, color] : id_colors(rec)) colors.insert(color);
  EXPECT_EQ(colors.size(), 41u);
}

TEST(Pass, PicturesInFilesKeepTheirAlpha) {
  Options options = small_options();
  options.transparent = true;
  const scene::Recording rec = fixtures::swinging(fixtures::skinned_humanoid(), 0);
  const Image clear = picture(rec, options);
  EXPECT_EQ(clear.pixels[3], 0) << "a corner of the sky";
  options.transparent = false;
  EXPECT_EQ(picture(rec, options).pixels[3], 255);
}

}  // namespace
}  // namespace sinew::render
