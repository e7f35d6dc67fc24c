// What the pictures show.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "render/figure.h"

namespace sinew::render {
namespace {

using fixtures::bare_humanoid;
using fixtures::brightness;
using fixtures::picture;
using fixtures::skinned_humanoid;
using fixtures::small_options;
using fixtures::swinging;

/// Mean absolute difference of two pictures in a box, 0 … 255.
double difference(const Image& a, const Image& b, double left, double top, double right, double bottom) {
  double sum = 0, count = 0;
  for (int y = int(top * a.height); y < int(bottom * a.height); ++y)
    for (int x = int(left * a.width); x < int(right * a.width); ++x)
      for (std::size_t k = 0; k < 3; ++k) {
        const std::size_t at = (std::size_t(y) * std::size_t(a.width) + std::size_t(x)) * 4 + k;
        sum += std::abs(int(a.pixels[at]) - int(b.pixels[at]));
        ++count;
      }
  return sum / count;
}

scene::Recording still(const std::shared_ptr<const Asset>& asset, float load = 0) {
  scene::Recording rec = swinging(asset, 0);
  for (float& value : rec.frames[0].characters[0].effort) value = load;
  return rec;
}

/// The scene without its character: what is behind it. The camera is the same, as the figure is only parked
/// under the floor.
scene::Recording without_figure(scene::Recording rec) {
  rec.camera.frame_automatically = false;
  for (Transform<float>& joint : rec.frames[0].characters[0].model) joint.translation.z() -= 500;
  return rec;
}

TEST(Picture, ShowsTheFigureInItsMiddleInEveryModeAndTheme) {
  for (const char* theme : {"dark", "light"})
    for (const char* mode : {"skin", "xray", "shapes"})
      for (const char* quality : {"full", "fast"}) {
        Options o = small_options();
        o.theme = theme;
        o.mode = mode;
        o.quality = quality;
        scene::Recording rec = still(skinned_humanoid());
        rec.camera.frame_automatically = false;
        const Image with = picture(rec, o), without = picture(without_figure(rec), o);
        // A figure fills some tenths of the middle, and differs there by more than rounding.
        EXPECT_GT(difference(with, without, 0.4, 0.3, 0.6, 0.8), 5) << theme << mode << quality;
        EXPECT_LT(difference(with, without, 0.0, 0.0, 0.2, 0.3), 1) << theme << mode << quality;
        EXPECT_GT(brightness(with, 0, 0, 1, 1), 8) << theme << mode << quality;
        EXPECT_LT(brightness(with, 0, 0, 1, 1), 247) << theme << mode << quality;
      }
}

TEST(Picture, LightThemeIsBrighterThanDark) {
  Options dark = small_options(), light = dark;
  light.theme = "light";
  const scene::Recording rec = still(skinned_humanoid());
  EXPECT_GT(brightness(picture(rec, light), 0, 0, 1, 1), 60 + brightness(picture(rec, dark), 0, 0, 1, 1));
}

TEST(Picture, BackgroundIsExactlyTheColourThatWasAskedFor) {
  Options o = small_options();
  o.background = "3366CC";
  const Image image = picture(still(bare_humanoid()), o);
  for (int y = 0; y < image.height / 10; ++y)  // above the horizon
    for (int x = 0; x < image.width / 4; ++x) {
      const std::uint8_t* p = &image.pixels[(std::size_t(y) * std::size_t(image.width) + std::size_t(x)) * 4];
      ASSERT_EQ((std::array{p[2], p[1], p[0]}), (std::array<std::uint8_t, 3>{0x33, 0x66, 0xCC}))
          << x << "," << y;
    }
}

TEST(Picture, TheFigureThrowsAShadowOnTheFloor) {
  Options o = small_options();
  o.theme = "light";
  scene::Recording rec = still(bare_humanoid());
  rec.camera.frame_automatically = false;
  const Image with = picture(rec, o), without = picture(without_figure(rec), o);
  // Floor right of the feet, away from the light: only the shadow can have changed it.
  double darkest = 0;
  for (int x = with.width * 55 / 100; x < with.width * 85 / 100; ++x)
    for (int y = with.height * 60 / 100; y < with.height * 95 / 100; ++y) {
      const std::size_t at = (std::size_t(y) * std::size_t(with.width) + std::size_t(x)) * 4;
      darkest = std::max(darkest, double(without.pixels[at + 1]) - double(with.pixels[at + 1]));
    }
  EXPECT_GT(darkest, 40);
}

TEST(Picture, OcclusionDarkensTheFloorAroundTheFeetAndLeavesTheSky) {
  Options fast = small_options(320, 180), full = fast;
  fast.theme = full.theme = "light";
  fast.quality = "fast";
  const scene::Recording rec = still(bare_humanoid());
  const Image plain = picture(rec, fast), soft = picture(rec, full);
  int darkest = 0;
  for (std::size_t i = plain.pixels.size() * 6 / 10; i < plain.pixels.size(); i += 4)
    darkest = std::max(darkest, int(plain.pixels[i + 1]) - int(soft.pixels[i + 1]));
  EXPECT_GT(darkest, 20);
  EXPECT_NEAR(brightness(plain, 0, 0, 0.2, 0.3), brightness(soft, 0, 0, 0.2, 0.3), 0.5);
}

TEST(Picture, LoadTurnsSkinAndMusclesRed) {
  for (const char* mode : {"skin", "xray", "shapes"}) {
    Options o = small_options();
    o.mode = mode;
    const Image calm = picture(still(skinned_humanoid(), 0), o),
                loaded = picture(still(skinned_humanoid(), 1), o);
    const auto redness = [](const Image& image) {
      double sum = 0;
      for (std::size_t i = 0; i < image.pixels.size(); i += 4)
        sum += std::max(0, int(image.pixels[i + 2]) - int(image.pixels[i]) - 60);  // red over blue
      return sum;
    };
    EXPECT_GT(redness(loaded), 1000 + 2 * redness(calm)) << mode;
  }
}

TEST(Picture, StressRisesInBrightnessToo) {
  // Linear luminance (Rec. 709) up to amber; red, the end, is told apart by colour and by the glow.
  const auto luminance = [](float load) {
    const Vec3<float> c = stress_color(load);
    return 0.2126f * c.x() + 0.7152f * c.y() + 0.0722f * c.z();
  };
  for (float load = 0; load < 0.75f; load += 0.05f)
    EXPECT_LT(luminance(load), luminance(load + 0.05f)) << load;
  EXPECT_EQ(stress_color(2), stress_color(1));
  EXPECT_EQ(stress_color(-1), stress_color(0));
}

TEST(Picture, TheSameSceneGivesTheSameBytes) {
  for (const char* quality : {"full", "fast"}) {
    Options o = small_options();
    o.quality = quality;
    o.overlay = true;
    const scene::Recording rec = swinging(skinned_humanoid(), 0.2);
    EXPECT_EQ(picture(rec, o).pixels, picture(rec, o).pixels);
  }
}

TEST(Picture, HasTheSizeThatWasAskedFor) {
  for (const auto& [width, height] : {std::pair{16, 16}, {34, 18}, {130, 258}, {1922, 18}}) {
    const Image image = picture(still(bare_humanoid()), small_options(width, height));
    EXPECT_EQ(image.width, width);
    EXPECT_EQ(image.height, height);
  }
}

TEST(Picture, ShowsSkinOnTheLeftAndMusclesOnTheRight) {
  Options o = small_options(320, 90), skin = o, xray = o;
  o.mode = "both";
  xray.mode = "xray";
  skin.width = xray.width = o.width / 2;
  scene::Recording rec = still(skinned_humanoid());
  rec.camera.frame_automatically = false;
  const Image both = picture(rec, o), empty = picture(without_figure(rec), o);
  EXPECT_GT(difference(both, empty, 0.20, 0.3, 0.30, 0.8), 5);
  EXPECT_GT(difference(both, empty, 0.70, 0.3, 0.80, 0.8), 5);
  EXPECT_LT(difference(both, empty, 0.00, 0.0, 0.10, 0.8), 1);
  EXPECT_LT(difference(both, empty, 0.45, 0.0, 0.60, 0.4), 1);
  // The chests, in the middle of each half.
  const double left = brightness(both, 0.24, 0.35, 0.26, 0.45),
               right = brightness(both, 0.74, 0.35, 0.76, 0.45),
               clay = brightness(picture(rec, skin), 0.48, 0.35, 0.52, 0.45),
               bones = brightness(picture(rec, xray), 0.48, 0.35, 0.52, 0.45);
  EXPECT_LT(std::abs(left - clay), std::abs(left - bones));
  EXPECT_LT(std::abs(right - bones), std::abs(right - clay));
}

TEST(Picture, ASkeletonWithoutMeshAndShapesIsDrawnAsBones) {
  auto asset = bare_humanoid();
  asset->skeleton.colliders.clear();
  scene::Recording rec = still(asset);
  rec.camera.frame_automatically = false;
  for (const char* mode : {"skin", "xray", "shapes"}) {
    Options o = small_options();
    o.mode = mode;
    EXPECT_GT(difference(picture(rec, o), picture(without_figure(rec), o), 0.4, 0.3, 0.6, 0.8), 3) << mode;
  }
}

TEST(Picture, ADamagedTextureIsDrawnAsPlainColour) {
  auto plain = skinned_humanoid(), broken = skinned_humanoid();
  for (const auto& asset : {plain, broken}) {
    asset->materials.emplace_back();
    asset->meshes[0].material = 0;
    asset->meshes[0].uvs.assign(asset->meshes[0].positions.size() / 3 * 2, 0.5f);
  }
  const Image without = picture(still(plain), small_options());
  for (const std::vector<std::uint8_t>& bytes : {std::vector<std::uint8_t>{1, 2, 3},
                                                 {0xFF, 0xD8, 0xFF, 0xE0, 0, 16},
                                                 {0x89, 'P', 'N', 'G', 13, 10, 26, 10}}) {
    broken->materials[0].texture = bytes;
    EXPECT_EQ(picture(still(broken), small_options()).pixels, without.pixels);
  }
}

}  // namespace
}  // namespace sinew::render
