// The overlay's layout and text.
#include "render/overlay.h"

#include <gtest/gtest.h>

#include <algorithm>

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

TEST(Overlay, ShowsEveryCharacterOfASceneAndSumsUpThoseThatFindNoRow) {
  const auto cast_of = [](std::size_t characters, std::size_t solved) {
    scene::Recording rec = swinging(skinned_humanoid(), 1);
    for (scene::Frame& frame : rec.frames) {
      frame.characters.resize(1);
      while (frame.characters.size() < characters) frame.characters.push_back(frame.characters[0]);
      for (scene::CharacterFrame& c : frame.characters) c.unknown_dofs = 0;
      if (solved < characters) frame.characters[solved].unknown_dofs = 3;
    }
    while (rec.characters.size() < characters) rec.characters.push_back(rec.characters[0]);
    Image image{1280, 720, std::vector<std::uint8_t>(1280 * 720 * 4, 100)};
    draw_overlay(rec, 1, true, image);
    const Rect room = Layout(1280, 720).cast;
    std::vector<std::uint8_t> part;
    for (int y = static_cast<int>(room.y); y < static_cast<int>(room.y + room.height); ++y)
      for (int x = static_cast<int>(room.x); x < static_cast<int>(room.x + room.width); ++x)
        part.push_back(image.pixels[(static_cast<std::size_t>(y) * 1280 + static_cast<std::size_t>(x)) * 4]);
    return part;
  };
  const auto empty = cast_of(1, 9);
  EXPECT_EQ(std::count(empty.begin(), empty.end(), 100), static_cast<long>(empty.size()))
      << "one has no list";
  for (const std::size_t characters : {2, 40}) {
    const auto calm = cast_of(characters, characters);
    EXPECT_NE(calm, empty);
    EXPECT_NE(cast_of(characters, characters - 1), calm) << "the last of " << characters << " is solved for";
  }
}

}  // namespace
}  // namespace sinew::render
