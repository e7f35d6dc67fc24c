// Videos, read back with libav's decoders.
#include "render/video.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <random>
#include <set>

#include "render/decode.h"
#include "render/figure.h"

namespace sinew::render {
namespace {

using fixtures::bare_humanoid;
using fixtures::decode;
using fixtures::Decoded;
using fixtures::own_file;
using fixtures::own_files;
using fixtures::skinned_humanoid;
using fixtures::small_options;
using fixtures::swinging;

Decoded rendered(const scene::Recording& rec, const Options& o, const std::string& name) {
  const std::string path = own_file(name);
  const convert::Error error = render_recording(rec, o, path, {});
  EXPECT_FALSE(error) << error.message;
  return decode(path);
}

TEST(Video, HasSizeRateFramesAndColoursThatWereAskedFor) {
  Options o = small_options();
  o.fps = 15;
  const scene::Recording rec = swinging(bare_humanoid(), 0.6);
  const Decoded mp4 = rendered(rec, o, "a.mp4");
  EXPECT_EQ(mp4.codec, "h264");
  EXPECT_EQ(mp4.pixel_format, "yuv420p");
  EXPECT_EQ(mp4.color_space, "bt709");
  const Decoded webm = rendered(rec, o, "a.webm");
  EXPECT_EQ(webm.codec, "vp9");
  EXPECT_EQ(webm.color_space, "bt709");
  const Decoded gif = rendered(rec, o, "a.gif");
  EXPECT_EQ(gif.codec, "gif");
  for (const Decoded& video : {mp4, webm, gif}) {
    EXPECT_EQ(video.width, 160);
    EXPECT_EQ(video.height, 90);
    // GIF counts time in hundredths of a second: 0.01 s of 0.6 s.
    EXPECT_NEAR(video.fps, 15, video.codec == "gif" ? 0.3 : 0.01) << video.codec;
    EXPECT_EQ(video.frames.size(), 9u) << video.codec;
  }
  EXPECT_EQ(own_files(), "a.gif\na.mp4\na.webm\n");
}

/// A moving pattern with soft edges and noise: work for every part of an encoder.
Image pattern(int width, int height, int n) {
  Image image{width, height, {}};
  std::mt19937 noise(static_cast<unsigned>(n));
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const int wave = 128 + int(90 * std::sin(0.07 * (x + 3 * n)) * std::cos(0.05 * y)),
                grain = int(noise() % 16);
      for (const int value : {wave + grain, 255 - wave, (x * 2 + y + 5 * n) & 255, 0})
        image.pixels.push_back(static_cast<std::uint8_t>(std::clamp(value, 0, 255)));
    }
  return image;
}

/// Fills freed memory with `byte`, so that code that reads what it never wrote sees something else each time.
void soil_heap(unsigned char byte) {
  std::vector<std::vector<unsigned char>> blocks;
  for (const std::size_t size : {64, 1000, 5000, 20000, 100000, 500000})
    for (int k = 0; k < 40; ++k) blocks.emplace_back(size, byte);
}

TEST(Video, DecodesToTheSamePicturesWhateverTheMemoryHeldBefore) {
  for (const char* extension : {"mp4", "webm", "gif"})
    for (const auto& [width, height] :
         {std::pair{320, 180}, {160, 90}, {130, 74}, {64, 64}, {18, 16}, {46, 34}}) {
      std::vector<Decoded> videos;
      for (const auto byte : {std::uint8_t{0}, std::uint8_t{0xFF}, std::uint8_t{0x5A}}) {
        soil_heap(byte);
        const std::string path = own_file(std::string("d.") + extension);
        convert::Error error;
        const auto writer = create_video(path, width, height, 30, 4, error);
        ASSERT_TRUE(writer) << error.message;
        for (int n = 0; n < 12 && !error; ++n) error = writer->add(pattern(width, height, n));
        if (!error) error = writer->finish();
        ASSERT_FALSE(error) << error.message;
        videos.push_back(decode(path));
      }
      ASSERT_EQ(videos[0].frames.size(), 12u) << extension << " " << width << "x" << height;
      EXPECT_TRUE(videos[0].frames == videos[1].frames && videos[0].frames == videos[2].frames)
          << extension << " " << width << "x" << height;
    }
}

TEST(Video, ARenderedSceneDecodesToTheSamePicturesTwice) {
  Options o = small_options(162, 94);
  o.overlay = true;
  const scene::Recording rec = swinging(skinned_humanoid(), 0.5);
  for (const char* name : {"s.mp4", "s.gif"}) {
    const Decoded first = rendered(rec, o, name), second = rendered(rec, o, name);
    ASSERT_EQ(first.frames.size(), 15u);
    EXPECT_EQ(first.frames, second.frames) << name;
  }
}

TEST(Video, KeepsBrightnessAndColour) {
  // A plane of one colour survives H.264 and VP9 to about one step in each channel.
  Image red{64, 64, {}};
  for (int i = 0; i < 64 * 64; ++i)
    for (const int value : {40, 60, 200, 0}) red.pixels.push_back(static_cast<std::uint8_t>(value));
  for (const char* name : {"c.mp4", "c.webm"}) {
    convert::Error error;
    const auto writer = create_video(own_file(name), 64, 64, 30, 4, error);
    ASSERT_TRUE(writer);
    for (int n = 0; n < 3 && !error; ++n) error = writer->add(red);
    ASSERT_FALSE(error);
    ASSERT_FALSE(writer->finish());
    const Decoded video = decode(own_file(name));
    // ITU-R BT.709, studio range, of R 200, G 60, B 40.
    const double luma = 0.2126 * 200 + 0.7152 * 60 + 0.0722 * 40;
    const std::vector<std::uint8_t>& f = video.frames.at(1);
    EXPECT_NEAR(f[32 * 64 + 32], 16 + 219 * luma / 255, 2) << name;
    EXPECT_NEAR(f[64 * 64 + 16 * 32 + 16], 128 + 224 * (40 - luma) / 1.8556 / 255, 2) << name;
    EXPECT_NEAR(f[64 * 64 * 5 / 4 + 16 * 32 + 16], 128 + 224 * (200 - luma) / 1.5748 / 255, 2) << name;
  }
}

TEST(Video, GifSpendsItsPaletteOnTheScene) {
  const Decoded gif = rendered(swinging(skinned_humanoid(), 0.2), small_options(), "p.gif");
  std::set<std::uint32_t> colors;
  const std::vector<std::uint8_t>& f = gif.frames.at(0);
  for (std::size_t i = 0; i + 3 < f.size(); i += 4)
    colors.insert(std::uint32_t(f[i]) << 16 | std::uint32_t(f[i + 1]) << 8 | f[i + 2]);
  EXPECT_GT(colors.size(), 60u);  // a fixed palette of 3:3:2 bits has about 20 of a grey scene
  EXPECT_LE(colors.size(), 256u);
}

TEST(Video, TurntableHasExactlyTheFramesOfARevolution) {
  Options o = small_options(64, 64);
  o.frames_per_revolution = 7;
  const std::string path = own_file("t.mp4");
  const convert::Error error = render_asset(bare_humanoid(), o, path, {});
  ASSERT_FALSE(error) << error.message;
  EXPECT_EQ(decode(path).frames.size(), 7u);
}

TEST(Video, Mp4PlaysWhileItLoads) {
  rendered(swinging(bare_humanoid(), 0.2), small_options(64, 64), "fast.mp4");
  std::ifstream file(own_file("fast.mp4"), std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(file), {}};
  EXPECT_LT(bytes.find("moov"), bytes.find("mdat"));  // the index comes before the pictures
}

TEST(Video, UnfinishedIsNotLeftBehind) {
  for (const char* extension : {".mp4", ".webm", ".gif"}) {
    convert::Error error;
    const auto writer = create_video(own_file(std::string("u") + extension), 64, 64, 30, 4, error);
    ASSERT_TRUE(writer);
    EXPECT_FALSE(writer->add(pattern(64, 64, 0)));
  }
  EXPECT_EQ(own_files(), "");
}

TEST(Video, AFullDiskIsReportedAndTheOldFileKept) {
  if (!std::filesystem::exists("/dev/full")) GTEST_SKIP() << "no /dev/full here";
  for (const char* extension : {".mp4", ".webm", ".gif"}) {
    const std::string path = own_file(std::string("full") + extension);
    std::ofstream(path) << "old";
    std::filesystem::create_symlink("/dev/full", path + ".tmp");
    convert::Error error;
    const auto writer = create_video(path, 64, 64, 30, 4, error);
    for (int n = 0; n < 30 && writer && !error; ++n) error = writer->add(pattern(64, 64, n));
    if (writer && !error) error = writer->finish();
    EXPECT_NE(error.message.find(path), std::string::npos) << error.message;
    std::ifstream old(path);
    std::string text;
    old >> text;
    EXPECT_EQ(text, "old");
  }
  EXPECT_EQ(own_files().find(".tmp"), std::string::npos) << own_files();
}

}  // namespace
}  // namespace sinew::render
