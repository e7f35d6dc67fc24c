// Whatever is wrong with a file comes back as one line that says so, and changes nothing.
#include <sys/stat.h>

#include <regex>

#include "malformed_inputs.h"
#include "reading.h"

namespace sinew::import::test {
namespace {

class MalformedInput : public testing::TestWithParam<Malformed> {};

TEST_P(MalformedInput, IsRefusedInOneLineThatNamesTheCause) {
  const Scratch scratch;
  const auto file = scratch.write(GetParam().file, GetParam().content);
  SourceScene scene;
  scene.name = "as it was";
  std::string error;
  EXPECT_FALSE(read_source(file.string(), {}, scene, error));
  EXPECT_TRUE(std::regex_search(error, std::regex(GetParam().cause))) << "error: " << error;
  EXPECT_EQ(error.find('\n'), std::string::npos) << error;
  EXPECT_EQ(scene.name, "as it was");
}

INSTANTIATE_TEST_SUITE_P(All, MalformedInput, testing::ValuesIn(malformed_inputs()),
                         [](const auto& one) { return one.param.name; });

TEST(Unreadable, MissingFileIsRefused) {
  EXPECT_EQ(read("/nowhere/at/all.glb").error, "file cannot be opened");
}

TEST(Unreadable, DirectoryIsRefused) {
  const Scratch scratch;
  EXPECT_EQ(read(scratch.path("")).error, "not a regular file");
}

TEST(Unreadable, PipeIsRefusedWithoutWaitingForAWriter) {
  const Scratch scratch;
  const auto fifo = scratch.path("a.glb");
  ASSERT_EQ(mkfifo(fifo.c_str(), 0600), 0);
  EXPECT_EQ(read(fifo).error, "not a regular file");
}

TEST(Unreadable, FileOverTheLimitIsRefused) {
  ReadLimits limits;
  limits.max_file_bytes = 100;
  EXPECT_EQ(read_content("a.gltf", kicking_leg().dump(), limits).error, "larger than 0 MiB");
}

TEST(Unreadable, ErrorLeftFromAnotherFileDoesNotMatter) {
  const Scratch scratch;
  const auto file = scratch.write("a.bvh", walking_bvh());
  SourceScene scene;
  std::string error = "of another file";
  EXPECT_TRUE(read_source(file.string(), {}, scene, error));
}

}  // namespace
}  // namespace sinew::import::test
