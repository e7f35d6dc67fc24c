#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <random>

#include "import/sandbox.h"
#include "import/source_scene.h"

namespace sinew::import {
namespace {

namespace fs = std::filesystem;

std::string written(const std::string& name, const std::string& content) {
  std::string path = testing::TempDir() + name;
  std::ofstream(path, std::ios::binary) << content;
  return path;
}

std::string repeated(const std::string& text, int count) {
  std::string all;
  for (int i = 0; i < count; ++i) all += text;
  return all;
}

/// Reads; a refusal must be one line that says something.
bool reads(const std::string& path, std::string& error) {
  SourceScene scene;
  error.clear();
  ReadLimits limits;
  limits.cpu_seconds = 10;
  limits.wall_seconds = 20;
  const bool ok = read_source(path, limits, scene, error);
  EXPECT_EQ(ok, error.empty()) << path;
  EXPECT_EQ(error.find('\n'), std::string::npos) << path << ": " << error;
  return ok;
}

std::string bvh(const std::string& frames, const std::string& time, const std::string& data, int depth = 1) {
  std::string text =
      "HIERARCHY\nROOT hips\n{\nOFFSET 0 0 0\nCHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation "
      "Yrotation\n";
  for (int i = 0; i < depth; ++i)
    text += "JOINT j" + std::to_string(i) + "\n{\nOFFSET 0 1 0\nCHANNELS 3 Zrotation Xrotation Yrotation\n";
  text += "End Site\n{\nOFFSET 0 1 0\n}\n" + repeated("}\n", depth + 1);
  return text + "MOTION\nFrames: " + frames + "\nFrame Time: " + time + "\n" + data;
}

const std::string kRow = "0 1 0 0 0 0 0 0 0\n";

std::string urdf(const std::string& body) {
  return "<?xml version=\"1.0\"?><robot name=\"r\">" + body + "</robot>";
}

const std::string kLink =
    "<link name=\"NAME\"><inertial><mass value=\"1\"/><inertia ixx=\"1\" ixy=\"0\" ixz=\"0\" iyy=\"1\" "
    "iyz=\"0\" izz=\"1\"/></inertial></link>";

std::string link(const std::string& name) {
  std::string text = kLink;
  return text.replace(text.find("NAME"), 4, name);
}

TEST(ReadSource, ReadsASmallBvhAndAUrdf) {
  std::string error;
  EXPECT_TRUE(reads(written("good.bvh", bvh("2", "0.033", kRow + kRow)), error)) << error;
  EXPECT_TRUE(reads(written("good.urdf", urdf(link("a"))), error)) << error;
}

TEST(ReadSource, MalformedInputsAreRefusedWithALine) {
  const std::string joint =
      "<joint name=\"j\" type=\"TYPE\"><parent link=\"a\"/><child link=\"b\"/>MORE</joint>";
  const auto jointed = [&](const std::string& type, const std::string& more) {
    std::string text = joint;
    text.replace(text.find("TYPE"), 4, type).replace(text.find("MORE"), 4, more);
    return urdf(link("a") + link("b") + text);
  };
  const std::pair<const char*, std::string> cases[] = {
      {"empty.glb", ""},
      {"junk.glb", "glTF" + repeated("x", 74)},
      {"text.txt", "once upon a time"},
      {"brackets.gltf", "{\"asset\":" + repeated("[", 200000)},
      {"noscene.gltf", "{\"asset\":{\"version\":\"2.0\"}}"},
      {"cycle.gltf",
       "{\"asset\":{\"version\":\"2.0\"},\"scene\":0,\"scenes\":[{\"nodes\":[0]}],\"nodes\":[{\"children\":["
       "1]},{\"children\":[0]}]}"},
      {"frames.bvh", bvh("2000000000", "0.03", kRow)},
      {"negative.bvh", bvh("-5", "0.03", kRow)},
      {"still.bvh", bvh("1", "0", kRow)},
      {"backwards.bvh", bvh("1", "-0.1", kRow)},
      {"nan.bvh", bvh("1", "0.03", "0 nan 0 0 0 0 0 0 0\n")},
      {"deep.bvh", bvh("1", "0.03", kRow, 20000)},
      {"short.bvh", bvh("3", "0.03", "0 1\n")},
      {"nomotion.bvh", "HIERARCHY\nROOT a\n{\nOFFSET 0 0 0\nCHANNELS 0\n}\n"},
      {"junk.fbx", "Kaydara FBX Binary  " + repeated("\x01", 500)},
      {"junk.dae", "<?xml version=\"1.0\"?><COLLADA version=\"1.4\"><asset>"},
      {"self.urdf",
       urdf(link("a") + "<joint name=\"j\" type=\"fixed\"><parent link=\"a\"/><child link=\"a\"/></joint>")},
      {"noparent.urdf",
       urdf(link("a") + "<joint name=\"j\" type=\"fixed\"><parent link=\"x\"/><child link=\"a\"/></joint>")},
      {"roots.urdf", urdf(link("a") + link("b"))},
      {"twice.urdf", urdf(link("a") + link("a"))},
      {"spherical.urdf", jointed("spherical", "")},
      {"axis.urdf", jointed("continuous", "<axis xyz=\"0 0 0\"/>")},
      {"limits.urdf", jointed("revolute", "<limit lower=\"1\" upper=\"-1\" effort=\"1\" velocity=\"1\"/>")},
      {"mimic.urdf", jointed("continuous", "<mimic joint=\"j\"/>")},
      {"mimics.urdf", jointed("continuous", "<mimic joint=\"k\"/>")},
      {"xacro.urdf", urdf("<xacro:include filename=\"x\"/>" + link("a"))},
      {"nested.urdf", urdf(repeated("<a>", 200000))},
      {"negative.urdf", urdf("<link name=\"a\"><inertial><mass value=\"-1\"/><inertia ixx=\"1\" ixy=\"0\" "
                             "ixz=\"0\" iyy=\"1\" iyz=\"0\" izz=\"1\"/></inertial></link>")},
  };
  for (const auto& [name, content] : cases) {
    std::string error;
    const auto begin = std::chrono::steady_clock::now();
    EXPECT_FALSE(reads(written(name, content), error)) << name;
    EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(21)) << name;
    std::printf("%-16s %s\n", name, error.c_str());
  }
}

TEST(ReadSource, PathsThatAreNoFileAreRefused) {
  std::string error;
  EXPECT_FALSE(reads("/no/such/file.glb", error));
  EXPECT_FALSE(reads("/tmp", error));
}

TEST(ReadSource, MutatedFilesNeverCrashOrHang) {
  constexpr unsigned kSeed = 7;
  std::printf("seed %u\n", kSeed);
  std::mt19937 random(kSeed);
  const std::pair<const char*, std::string> sources[] = {
      {"m.bvh", bvh("2", "0.033", kRow + kRow)},
      {"m.urdf",
       urdf(link("a") + link("b") +
            "<joint name=\"j\" type=\"continuous\"><parent link=\"a\"/><child link=\"b\"/></joint>")},
      {"m.gltf",
       "{\"asset\":{\"version\":\"2.0\"},\"scene\":0,\"scenes\":[{\"nodes\":[0]}],\"nodes\":[{\"name\":\"a\","
       "\"children\":[1]},{\"name\":\"b\"}]}"}};
  for (const auto& [name, good] : sources)
    for (int n = 0; n < 60; ++n) {
      std::string bad = good;
      for (unsigned k = 0, changes = 1 + random() % 8; k < changes; ++k)
        bad[random() % bad.size()] = char(random() % 256);
      if (n % 4 == 0) bad.resize(random() % bad.size());
      std::string error;
      reads(written(name, bad), error);
    }
}

TEST(Sandbox, StopsWhatAReaderMayNotDo) {
#if defined(__SANITIZE_ADDRESS__)
  GTEST_SKIP() << "the system-call filter is off under AddressSanitizer";
#else
  ReadLimits limits;
  limits.wall_seconds = 5;
  std::string answer, error;
  EXPECT_FALSE(run_sandboxed(
      limits, [] { return std::to_string(socket(AF_INET, SOCK_STREAM, 0)); }, answer, error));
  EXPECT_NE(error.find("may not"), std::string::npos) << error;
  EXPECT_FALSE(run_sandboxed(
      limits, [] { return std::to_string(execl("/bin/true", "true", nullptr)); }, answer, error));
  ASSERT_TRUE(run_sandboxed(
      limits, [] { return std::to_string(open("/etc/hostname", O_RDONLY)); }, answer, error))
      << error;
  EXPECT_EQ(answer, "-1");
  limits.memory_bytes = 256u << 20;
  EXPECT_FALSE(run_sandboxed(
      limits, [] { return std::string(std::size_t(1) << 30, 'x'); }, answer, error));
  EXPECT_NE(error.find("memory"), std::string::npos) << error;
  limits.wall_seconds = 1;
  EXPECT_FALSE(run_sandboxed(
      limits,
      [] {
        volatile bool forever = true;
        while (forever) {
        }
        return std::string();
      },
      answer, error));
  EXPECT_NE(error.find("time"), std::string::npos) << error;
#endif
}

TEST(ReadSource, DebiansMotionCaptureReads) {
  int read = 0;
  for (const char* name : {"BVH/01_01.bvh", "BVH/01_03.bvh", "BVH/Boxing_Toes.bvh", "FBX/huesitos.fbx"}) {
    const std::string path = std::string("/usr/share/assimp/models/") + name;
    if (!fs::exists(path)) continue;
    std::string error;
    EXPECT_TRUE(reads(path, error)) << path << ": " << error;
    ++read;
  }
  if (read == 0) GTEST_SKIP() << "Debian's assimp-testmodels are not installed";
}

}  // namespace
}  // namespace sinew::import
