// What is refused, and that nothing is left behind.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "render/figure.h"

namespace sinew::render {
namespace {

using fixtures::bare_humanoid;
using fixtures::own_file;
using fixtures::own_files;
using fixtures::small_options;
using fixtures::swinging;

std::string refusal(const Options& options, const std::string& output) {
  const convert::Error error = render_recording(swinging(bare_humanoid(), 0.1), options, output, {});
  EXPECT_EQ(error.message.find('\n'), std::string::npos) << error.message;
  return error ? error.message : "accepted";
}

TEST(Options, BadOnesAreRefusedInOneLineThatNamesThem) {
  const std::pair<std::function<void(Options&)>, std::string> cases[] = {
      {[](Options& o) { o.width = 161; }, "161x90"},
      {[](Options& o) { o.height = 91; }, "160x91"},
      {[](Options& o) { o.width = 0; }, "size"},
      {[](Options& o) { o.height = 100000; }, "size"},
      {[](Options& o) { o.samples = 3; }, "samples"},
      {[](Options& o) { o.quality = "best"; }, "best"},
      {[](Options& o) { o.theme = "pink"; }, "pink"},
      {[](Options& o) { o.mode = "wire"; }, "wire"},
      {[](Options& o) { o.background = "red"; }, "red"},
      {[](Options& o) { o.background = "12345g"; }, "12345g"},
      {[](Options& o) { o.pass = "beauty"; }, "beauty"},
      {[](Options& o) { o.pass = "depth", o.mode = "xray"; }, "depth"},
      {[](Options& o) { o.fps = 0; }, "fps"},
      {[](Options& o) { o.fps = std::nan(""); }, "fps"},
      {[](Options& o) { o.start = -1; }, "start"},
      {[](Options& o) { o.start = 9; }, "start"},
      {[](Options& o) { o.frames_per_revolution = 0; }, "revolution"},
      {[](Options& o) { o.threads = 0; }, "threads"}};
  for (const auto& [spoil, names] : cases) {
    Options o = small_options();
    spoil(o);
    EXPECT_NE(refusal(o, own_file("never.png")).find(names), std::string::npos) << names;
  }
  EXPECT_EQ(own_files(), "");
}

TEST(Options, OutputsThatCannotBeWrittenAreRefused) {
  const Options o = small_options();
  for (const char* name : {"x.avi", "x", "x.png.bak", "x_%s.png", "x_%04x.png", "x_%d_%d.png"})
    EXPECT_NE(refusal(o, own_file(name)).find(name), std::string::npos) << name;
  EXPECT_NE(refusal(o, "/no/such/directory/x.png").find("/no/such/directory/x.png"), std::string::npos);
  EXPECT_NE(refusal(o, "/proc/x.png").find("/proc/x.png"), std::string::npos);
  EXPECT_EQ(own_files(), "");
}

TEST(Options, PassesAndTransparentPicturesAreNoVideos) {
  Options o = small_options();
  o.transparent = true;
  EXPECT_NE(refusal(o, own_file("x.mp4")).find("passes and transparent pictures are .png"),
            std::string::npos);
  o.transparent = false;
  o.pass = "id";
  EXPECT_NE(refusal(o, own_file("x.gif")).find("passes and transparent pictures are .png"),
            std::string::npos);
  EXPECT_EQ(own_files(), "");
}

TEST(Options, AnUnknownClipIsRefused) {
  Options o = small_options();
  o.clip = "moonwalk";
  const convert::Error error = render_asset(bare_humanoid(), o, own_file("never.png"), {});
  EXPECT_NE(error.message.find("moonwalk"), std::string::npos) << error.message;
  EXPECT_EQ(own_files(), "");
}

TEST(Pictures, AreNumberedAndComplete) {
  const convert::Error error =
      render_recording(swinging(bare_humanoid(), 0.1), small_options(), own_file("f_%03d.png"), {});
  EXPECT_FALSE(error) << error.message;
  EXPECT_EQ(own_files(), "f_000.png\nf_001.png\nf_002.png\n");
}

TEST(Pictures, LeaveNothingBehindWhenOneOfThemCannotTakeItsName) {
  std::filesystem::create_directories(own_file("g_001.png") + "/occupied");
  const convert::Error error =
      render_recording(swinging(bare_humanoid(), 0.1), small_options(), own_file("g_%03d.png"), {});
  EXPECT_NE(error.message.find("g_001.png"), std::string::npos) << error.message;
  EXPECT_EQ(own_files().find(".tmp"), std::string::npos) << own_files();
}

}  // namespace
}  // namespace sinew::render
