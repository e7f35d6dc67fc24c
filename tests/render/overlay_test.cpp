// The overlay's layout and text.
#include "render/overlay.h"

#include <gtest/gtest.h>

#include "render/figure.h"
#include "render/pen.h"

namespace sinew::render {
namespace {

using fixtures::skinned_humanoid;
using fixtures::swinging;

constexpr std::pair<int, int> kSizes[] = {{640, 360}, {1280, 720},  {1920, 1080}, {640, 480},
                                          {480, 640}, {3840, 2160}, {2560, 1080}, {320, 180}};

TEST(Overlay, PartsStandInsideThePictureAndNeverOverlap) {
  for (const auto& [width, height] : kSizes) {
    const Layout layout(width, height);
    const auto parts = layout.parts();
    for (std::size_t a = 0; a < parts.size(); ++a) {
      EXPECT_GE(parts[a].x, 0) << width << "x" << height;
      EXPECT_GE(parts[a].y, 0) << width << "x" << height;
      EXPECT_LE(parts[a].x + parts[a].width, layout.width) << width << "x" << height;
      EXPECT_LE(parts[a].y + parts[a].height, layout.height) << width << "x" << height;
      EXPECT_GT(parts[a].width, 0) << width << "x" << height;
      for (std::size_t b = a + 1; b < parts.size(); ++b)
        EXPECT_TRUE(parts[a].x + parts[a].width <= parts[b].x || parts[b].x + parts[b].width <= parts[a].x ||
                    parts[a].y + parts[a].height <= parts[b].y || parts[b].y + parts[b].height <= parts[a].y)
            << "parts " << a << " and " << b << " at " << width << "x" << height;
    }
  }
}

TEST(Overlay, LongNamesAreCutToTheRoomThatTheyHave) {
  Image image{640, 360, std::vector<std::uint8_t>(640 * 360 * 4)};
  const Pen pen(image, 0.5, true);
  const std::string name = "a_joint_whose_näme_is_longer_than_any_pänel_of_the_overlay";
  EXPECT_LE(pen.width(15, pen.fitted(15, name, 150)), 150);
  EXPECT_EQ(pen.fitted(15, "hip", 150), "hip");
}

TEST(Overlay, DrawsOnlyInsideItsParts) {
  const scene::Recording rec = swinging(skinned_humanoid(), 1);
  for (const auto& [width, height] : kSizes) {
    Image image{width, height, std::vector<std::uint8_t>(std::size_t(width) * std::size_t(height) * 4, 100)};
    draw_overlay(rec, rec.frames.size() - 1, true, image);
    const Layout layout(width, height);
    std::size_t inside = 0, outside = 0;
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x) {
        const std::uint8_t* p = &image.pixels[(std::size_t(y) * std::size_t(width) + std::size_t(x)) * 4];
        if (p[0] == 100 && p[1] == 100 && p[2] == 100) continue;
        bool in_part = false;  // with a pixel of smoothing around it
        for (const Rect& r : layout.parts())
          in_part |= x >= r.x * layout.unit - 2 && x <= (r.x + r.width) * layout.unit + 1 &&
                     y >= r.y * layout.unit - 2 && y <= (r.y + r.height) * layout.unit + 1;
        ++(in_part ? inside : outside);
      }
    EXPECT_GT(inside, std::size_t(width) * std::size_t(height) / 20) << width << "x" << height;
    EXPECT_EQ(outside, 0u) << width << "x" << height;
  }
}

}  // namespace
}  // namespace sinew::render
