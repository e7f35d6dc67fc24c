// The runtime's debug drawing over a picture.
#include "render/inside.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "render/figure.h"

namespace sinew::render {
namespace {

using fixtures::bare_humanoid;
using fixtures::picture;
using fixtures::small_options;
using fixtures::swinging;

constexpr DebugColor kRed{255, 0, 0, 255};

Image grey(int width, int height) {
  return {width, height, std::vector<std::uint8_t>(std::size_t(width) * std::size_t(height) * 4, 100)};
}

/// Pixels in which two pictures differ by more than rounding: how many, and their middle.
struct Changed {
  int count = 0;
  double x = 0, y = 0;

  Changed(const Image& a, const Image& b) {
    for (int row = 0; row < a.height; ++row)
      for (int column = 0; column < a.width; ++column) {
        const std::size_t at = (std::size_t(row) * std::size_t(a.width) + std::size_t(column)) * 4;
        int most = 0;
        for (std::size_t k = 0; k < 3; ++k)
          most = std::max(most, std::abs(int(a.pixels[at + k]) - int(b.pixels[at + k])));
        if (most < 10) continue;
        ++count;
        x += column + 0.5;
        y += row + 0.5;
      }
    x /= std::max(count, 1);
    y /= std::max(count, 1);
  }
};

/// From 5 m, over 2 m of height where the target is.
View level() {
  View view;
  view.eye = {5, 0, 1};
  view.target = {0, 0, 1};
  view.vertical_fov = 2 * std::atan(0.2f);
  return view;
}

TEST(Inside, LinesStandWhereTheyAreInTheWorld) {
  scene::Drawing drawing;
  drawing.line({0, 0.5, 1.5}, {0, 0.5, 1.7}, kRed);
  Image image = grey(200, 200);
  draw_inside(drawing, level(), true, image);
  const Changed changed(image, grey(200, 200));
  EXPECT_GT(changed.count, 15) << "0.2 m are 20 pixels";
  EXPECT_NEAR(changed.x, 150, 1) << "Y is to the right of who looks against X";
  EXPECT_NEAR(changed.y, 40, 1) << "0.6 m above the middle";
}

TEST(Inside, WhatIsBehindTheEyeIsLeftOutAndWhatComesFromThereIsCut) {
  scene::Drawing behind;
  behind.line({6, 0, 1}, {7, 1, 1}, kRed);
  behind.triangle({6, 0, 1}, {6, 1, 1}, {4, 0, 2}, kRed);
  behind.text({6, 0, 1}, "unseen", kRed);
  Image image = grey(200, 200);
  draw_inside(behind, level(), true, image);
  EXPECT_EQ(Changed(image, grey(200, 200)).count, 0);
  scene::Drawing through;
  through.line({0, 0, 1}, {10, 0, 1.5}, kRed);
  draw_inside(through, level(), true, image);
  const Changed changed(image, grey(200, 200));
  EXPECT_GT(changed.count, 50) << "from the middle to the upper edge";
  EXPECT_NEAR(changed.x, 100, 1);
}

TEST(Inside, PlacesAreThoseOfThePictureBelow) {
  scene::Recording rec = swinging(bare_humanoid(), 0);
  rec.camera.frame_automatically = false;
  rec.camera.eye = {4, -2, 1.8f};
  rec.camera.target = {0, 0, 0.9f};
  Options o = small_options(320, 180);
  const Vec3<double> place(0.4, 0.9, 1.5);
  scene::Recording with_ball = rec, with_mark = rec;
  rec.props = with_ball.props = {{"ball", Shape::kSphere, Vec3<float>::Constant(0.05f), 1}};
  rec.frames[0].props = with_ball.frames[0].props = {{}};
  rec.frames[0].props[0].world.translation.z() = scene::kHidden;
  with_ball.frames[0].props[0].world.translation = place.cast<float>();
  const Image bare = picture(rec, o);
  o.pass = "id";  // which has no shadows
  const Changed ball(picture(with_ball, o), picture(rec, o));
  o.pass = "color";
  o.inside = true;
  for (const Vec3<double>& way : {Vec3<double>(0, 0, 0.05), Vec3<double>(0.03, 0.04, 0)})
    with_mark.frames[0].inside.line(place - way, place + way, kRed);
  const Changed mark(picture(with_mark, o), bare);
  ASSERT_GT(ball.count, 10);
  ASSERT_GT(mark.count, 5);
  EXPECT_NEAR(mark.x, ball.x, 0.5) << "pixels";
  EXPECT_NEAR(mark.y, ball.y, 0.5);
}

TEST(Inside, IsRefusedOverPassesAndTransparentPictures) {
  for (const bool transparent : {true, false}) {
    Options o = small_options();
    o.inside = true;
    o.transparent = transparent;
    if (!transparent) o.pass = "id";
    const convert::Error error =
        render_recording(swinging(bare_humanoid(), 0), o, fixtures::own_file("never.png"), {});
    EXPECT_NE(error.message.find("inside"), std::string::npos) << error.message;
  }
}

}  // namespace
}  // namespace sinew::render
