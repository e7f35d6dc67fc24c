// A folder of sources, as an artist or a build machine converts it.
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <random>
#include <thread>

#include "cli/command.h"
#include "fixtures/paths.h"

namespace sinew::test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

std::string bvh(int angle) {
  const std::string turned = std::to_string(angle);
  return "HIERARCHY\nROOT hip\n{\nOFFSET 0 0 0\nCHANNELS 3 Xrotation Yrotation Zrotation\n"
         "JOINT knee\n{\nOFFSET 0 -50 0\nCHANNELS 3 Xrotation Yrotation Zrotation\nEnd Site\n{\nOFFSET 0 -50 "
         "0\n}\n}\n}\n"
         "MOTION\nFrames: 3\nFrame Time: 0.1\n0 0 0 0 0 0\n0 0 0 " +
         turned + " 0 0\n0 0 0 0 0 0\n";
}

/// Three characters, one file that is none, and files that are no sources.
class Folder : public testing::Test {
 protected:
  void SetUp() override {
    fs::remove_all(root_);
    write("a.bvh", bvh(10));
    write("sub/b.bvh", bvh(20));
    write("sub/deep/c.bvh", bvh(30));
    write("sub/bad.bvh", "no motion");
    write("sub/notes.txt", "what is left to do");
  }
  void TearDown() override { fs::remove_all(root_); }

  void write(const std::string& name, const std::string& content) const {
    const fs::path path = fs::path(in_) / name;
    fs::create_directories(path.parent_path());
    std::ofstream(path, std::ios::binary) << content;
  }
  json converted(const std::string& options = "", int code = 1) const {
    const Outcome run = sinew("convert " + in_ + " -o " + out_ + " --json " + options);
    EXPECT_EQ(run.code, code) << run.out;
    return json::parse(run.out.substr(run.out.find('{'), run.out.rfind('}') + 1 - run.out.find('{')), nullptr,
                       false);
  }
  std::map<std::string, std::string> outputs() const {
    std::map<std::string, std::string> all;
    for (const auto& entry : fs::recursive_directory_iterator(out_))
      if (entry.is_regular_file() && entry.path().extension() == ".sinew")
        all[entry.path().lexically_relative(out_).string()] = bytes_of(entry.path().string());
    return all;
  }

  const std::string root_ = own_directory() + "folder", in_ = root_ + "/in", out_ = root_ + "/out";
};

TEST_F(Folder, AllThatCanBeIsConvertedAndWhatCannotIsNamed) {
  const json report = converted("-j 2");
  EXPECT_EQ(report["converted"], 3) << report;
  EXPECT_EQ(report["failed"], 1);
  ASSERT_EQ(report["files"].size(), 4u);
  EXPECT_NE(report["files"][2]["error"].get<std::string>().find("sub/bad.bvh: "), std::string::npos)
      << report;
  const auto made = outputs();
  ASSERT_EQ(made.size(), 3u);
  EXPECT_EQ(made.count("sub/deep/c.sinew"), 1u);
  const std::string alone = root_ + "/alone.sinew";
  ASSERT_EQ(sinew("convert " + in_ + "/sub/b.bvh -o " + alone).code, 0);
  EXPECT_EQ(made.at("sub/b.sinew"), bytes_of(alone));
}

TEST_F(Folder, WhatHasNotChangedIsLeftAsItIs) {
  converted();
  const auto first = outputs();
  EXPECT_EQ(converted()["up_to_date"], 3);
  write("a.bvh", bvh(11));
  write("sub/b.clips.json", R"({"clips": {"Motion": {"loops": true}}})");
  json again = converted();
  EXPECT_EQ(again["converted"], 2) << again;
  EXPECT_EQ(again["up_to_date"], 1);
  EXPECT_NE(outputs().at("sub/b.sinew"), first.at("sub/b.sinew"));
  fs::remove(fs::path(in_) / "sub/b.clips.json");
  EXPECT_EQ(converted()["converted"], 1);
  EXPECT_EQ(outputs().at("sub/b.sinew"), first.at("sub/b.sinew"));
  fs::remove(fs::path(out_) / "a.sinew");
  EXPECT_EQ(converted()["converted"], 1);
  EXPECT_EQ(converted("--unit 0.02")["converted"], 3);
  EXPECT_EQ(converted("--unit 0.02 --again")["converted"], 3);
}

TEST_F(Folder, OptionsReachEverySourceWithAllTheirDigits) {
  converted("--unit 0.0123456789");
  const std::string alone = root_ + "/alone.sinew";
  ASSERT_EQ(sinew("convert " + in_ + "/a.bvh --unit 0.0123456789 -o " + alone).code, 0);
  EXPECT_EQ(outputs().at("a.sinew"), bytes_of(alone));
}

TEST_F(Folder, SourcesThatNameDevicesDoNotHangIt) {
  write("device.gltf", R"({"asset": {"version": "2.0"}, "buffers": [{"uri": "/dev/zero", "byteLength": 12}],
    "nodes": [{"name": "hip"}], "scenes": [{"nodes": [0]}], "scene": 0})");
  converted();
  converted();
}

TEST_F(Folder, DryRunsSayWhatTheyWouldDoAndDoNothing) {
  EXPECT_EQ(converted("--dry-run", 0)["to_convert"], 4);
  EXPECT_FALSE(fs::exists(out_));
}

TEST_F(Folder, SourcesOfOneNameKeepTheirEndings) {
  write("a.dae", "no character");
  converted();
  EXPECT_EQ(outputs().count("a.bvh.sinew"), 1u);
  EXPECT_EQ(outputs().count("a.sinew"), 0u);
}

TEST_F(Folder, SeveralFilesMayBeCharactersOfTheirOwn) {
  const Outcome run = sinew("convert --each " + in_ + "/a.bvh " + in_ + "/sub/b.bvh -o " + out_);
  EXPECT_EQ(run.code, 0) << run.out;
  EXPECT_EQ(outputs().size(), 2u);
}

TEST_F(Folder, BadCallsAreOneLine) {
  fs::create_directories(root_ + "/empty");
  const Outcome nothing = sinew("convert " + root_ + "/empty -o " + out_);
  EXPECT_EQ(nothing.code, 1);
  EXPECT_NE(nothing.out.find("empty: no glTF, FBX, BVH, COLLADA or URDF file in it"), std::string::npos)
      << nothing.out;
  std::ofstream(root_ + "/file") << "x";
  const Outcome no_directory = sinew("convert " + in_ + " -o " + root_ + "/file");
  EXPECT_EQ(no_directory.code, 1);
  EXPECT_NE(no_directory.out.find("file"), std::string::npos) << no_directory.out;
  EXPECT_EQ(sinew("convert " + in_ + "/a.bvh -o " + root_ + "/x.sinew --dry-run").code, 1);
}

TEST_F(Folder, ThePageShowsEveryCharacterAndEveryRefusal) {
  write("sub/<odd>.bvh", "no motion");
  sinew("convert " + in_ + " -o " + out_ + " --report " + root_ + "/page.html");
  const std::string page = bytes_of(root_ + "/page.html");
  for (const char* still : {"out/.sinew/a.png", "out/.sinew/sub/b.png", "out/.sinew/sub/deep/c.png"}) {
    EXPECT_NE(page.find("src=\"" + std::string(still) + "\""), std::string::npos) << still;
    EXPECT_EQ(bytes_of(root_ + "/" + still).substr(1, 3), "PNG") << still;
  }
  EXPECT_NE(page.find("3 converted, 0 up to date, 2 refused"), std::string::npos);
  EXPECT_NE(page.find("sub/bad.bvh: "), std::string::npos);
  EXPECT_NE(page.find("sub/&lt;odd&gt;.bvh: "), std::string::npos);
  EXPECT_EQ(page.find("<odd>"), std::string::npos);
}

/// A conversion in a group of its own, which kill() ends with all that it has started.
pid_t started(const std::vector<const char*>& arguments) {
  const pid_t process = fork();
  if (process != 0) return process;
  setpgid(0, 0);
  const bool silent = std::freopen("/dev/null", "w", stdout) && std::freopen("/dev/null", "w", stderr);
  std::vector<char*> all = {const_cast<char*>("sinew"), const_cast<char*>("convert")};
  for (const char* argument : arguments) all.push_back(const_cast<char*>(argument));
  all.push_back(nullptr);
  if (silent) execv(SINEW_COMMAND, all.data());
  _exit(127);
}

void end(pid_t process) {
  kill(-process, SIGKILL);
  kill(process, SIGKILL);
  waitpid(process, nullptr, 0);
}

TEST_F(Folder, WatchingConvertsWhatComesAndWhatChanges) {
  const auto comes = [&](const std::string& name, const std::string& other_than) {
    for (int wait = 0; wait < 300; ++wait) {
      const std::string bytes = bytes_of(out_ + "/" + name);
      if (!bytes.empty() && bytes != other_than) return bytes;
      std::this_thread::sleep_for(std::chrono::milliseconds(100));
    }
    return std::string();
  };
  const pid_t process = started({in_.c_str(), "-o", out_.c_str(), "--watch"});
  const std::string first = comes("a.sinew", "");
  EXPECT_NE(first, "");
  write("new.bvh", bvh(40));
  EXPECT_NE(comes("new.sinew", ""), "");
  write("a.bvh", bvh(12));
  EXPECT_NE(comes("a.sinew", first), "");
  end(process);
}

TEST_F(Folder, MayBeKilledAtAnyMomentAndRunTwiceAtOnce) {
  converted();
  const auto wanted = outputs();
  fs::remove_all(out_);
  std::mt19937 random(20261126);
  const char* wished = std::getenv("SINEW_KILLS");
  const int rounds = wished ? std::atoi(wished) : 12;
  for (int round = 0; round < rounds; ++round) {
    if (round % 8 == 7) fs::remove_all(out_);  // or soon all is done
    const pid_t process = started({in_.c_str(), "-o", out_.c_str(), "-j", "2"});
    std::this_thread::sleep_for(std::chrono::milliseconds(random() % 150));
    end(process);
    if (!fs::exists(out_)) continue;
    for (const auto& [name, bytes] : outputs()) EXPECT_EQ(bytes, wanted.at(name)) << name;
  }
  std::thread other([&] { sinew("convert " + in_ + " -o " + out_ + " -j 2"); });
  sinew("convert " + in_ + " -o " + out_ + " -j 2");
  other.join();
  EXPECT_EQ(outputs(), wanted);
  for (const auto& entry : fs::recursive_directory_iterator(out_)) {
    const std::string ending = entry.path().extension().string();
    EXPECT_TRUE(entry.is_directory() || ending == ".sinew" || ending == ".json") << entry.path();
  }
}

}  // namespace
}  // namespace sinew::test
