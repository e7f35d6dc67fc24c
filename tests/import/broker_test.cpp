// The parent opens what lies beside the source, and nothing else.
#include "import/broker.h"

#include <fcntl.h>
#include <sys/stat.h>

#include "reading.h"

namespace sinew::import::test {
namespace {

class OpenBeside : public testing::Test {
 protected:
  OpenBeside() : source_(scratch_.write("assets/a.gltf", "{}")) {
    scratch_.write("assets/a.bin", "1234");
    scratch_.write("assets/textures/skin.png", "5678");
    scratch_.write("secret.bin", "secret");
    scratch_.write("assets_too/other.bin", "secret");
  }
  bool opens(const std::string& name, std::uint64_t most = 100) const {
    const int descriptor = open_beside(source_, name, most);
    if (descriptor < 0) return false;
    close(descriptor);
    return true;
  }
  void link(const std::string& target, const std::string& name) const {
    std::filesystem::create_symlink(target, scratch_.path(name));
  }

  Scratch scratch_;
  std::filesystem::path source_;
};

TEST_F(OpenBeside, OpensNeighboursAndWhatLiesBelow) {
  EXPECT_TRUE(opens("a.bin"));
  EXPECT_TRUE(opens("./a.bin"));
  EXPECT_TRUE(opens("textures/skin.png"));
}

TEST_F(OpenBeside, RefusesTheWayUp) {
  EXPECT_FALSE(opens("../secret.bin"));
  EXPECT_FALSE(opens("textures/../../secret.bin"));
  EXPECT_FALSE(opens("../assets_too/other.bin"));
}

TEST_F(OpenBeside, RefusesAbsoluteNames) {
  EXPECT_FALSE(opens("/etc/passwd"));
  EXPECT_FALSE(opens(scratch_.path("assets/a.bin").string()));
}

TEST_F(OpenBeside, RefusesLinksThatLeadOut) {
  link("/etc/passwd", "assets/passwd.bin");
  link(scratch_.path("assets_too").string(), "assets/more");
  EXPECT_FALSE(opens("passwd.bin"));
  EXPECT_FALSE(opens("more/other.bin"));
}

TEST_F(OpenBeside, FollowsLinksThatStayInside) {
  link("a.bin", "assets/same.bin");
  EXPECT_TRUE(opens("same.bin"));
}

TEST_F(OpenBeside, RefusesWhatIsNoRegularFile) {
  ASSERT_EQ(mkfifo(scratch_.path("assets/pipe.bin").c_str(), 0600), 0);
  EXPECT_FALSE(opens("pipe.bin"));
  EXPECT_FALSE(opens("textures"));
}

TEST_F(OpenBeside, RefusesWhatIsTooLarge) {
  EXPECT_TRUE(opens("a.bin", 4));
  EXPECT_FALSE(opens("a.bin", 3));
}

TEST_F(OpenBeside, RefusesEmptyNamesAndNamesWithANull) {
  EXPECT_FALSE(opens(""));
  EXPECT_FALSE(opens(std::string("a.bin\0.png", 10)));
}

/// Reads kicking_leg() with its buffer in a file called `uri` inside the document.
Outcome read_with_bin(const Scratch& scratch, const std::string& uri, const std::string& bin_file) {
  nlohmann::json gltf = kicking_leg();
  const std::vector<float> values = kick_keys();
  gltf["buffers"][0]["uri"] = uri;
  scratch.write(bin_file, {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(float)});
  return read(scratch.write("models/a.gltf", gltf.dump()));
}

TEST(SideFile, IsReadThroughTheSandbox) {
  for (const char* uri : {"a.bin", "./a.bin", "data%20of%20a.bin", "buffers/a.bin"}) {
    const Scratch scratch;
    std::string file = std::string("models/") + uri;
    if (const auto coded = file.find("%20"); coded != std::string::npos) file = "models/data of a.bin";
    const Outcome outcome = read_with_bin(scratch, uri, file);
    ASSERT_TRUE(outcome.ok) << uri << ": " << outcome.error;
    ASSERT_EQ(outcome.scene.clips.size(), 1u);
    EXPECT_EQ(outcome.scene.clips[0].channels[0].rotations.size(), 3u);
  }
}

TEST(SideFile, OutsideTheDirectoryIsNotRead) {
  const Scratch scratch;
  const Outcome outcome = read_with_bin(scratch, "../a.bin", "a.bin");
  EXPECT_FALSE(outcome.ok);
  EXPECT_NE(outcome.error.find("assimp: "), std::string::npos) << outcome.error;
}

}  // namespace
}  // namespace sinew::import::test
