// `sinew batch` without a scheduler: processes that share a directory, and die.
#include <fcntl.h>
#include <signal.h>
#include <spawn.h>

#include <chrono>
#include <map>
#include <nlohmann/json.hpp>
#include <random>
#include <thread>

#include "cli/command.h"
#include "fixtures/paths.h"

extern char** environ;

namespace sinew::test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

std::string bvh(int angle) {
  return "HIERARCHY\nROOT hip\n{\nOFFSET 0 0 0\nCHANNELS 3 Xrotation Yrotation Zrotation\nJOINT "
         "knee\n{\nOFFSET 0 -50 0\n"
         "CHANNELS 3 Xrotation Yrotation Zrotation\nEnd Site\n{\nOFFSET 0 -50 0\n}\n}\n}\nMOTION\nFrames: 3\n"
         "Frame Time: 0.1\n0 0 0 0 0 0\n0 0 0 " +
         std::to_string(angle) + " 0 0\n0 0 0 0 0 0\n";
}

/// A folder with a manifest of conversions (one of them of a file that is no source), pictures and a study.
class Batch : public testing::Test {
 protected:
  void SetUp() override {
    fs::remove_all(root_);
    fs::create_directories(root_ + "/art/sub");
    for (int k = 0; k < 6; ++k) write("art/walk" + std::to_string(k) + ".bvh", bvh(10 + k));
    write("art/sub/bad.bvh", "no motion");
    write("manifest.json", R"({"shard_seconds": 1, "jobs": [
      {"convert": "art", "arguments": ["--up", "y"]},
      {"render": "art/walk0.bvh", "ending": ".png", "seconds": 1,
       "arguments": ["--size", "64x64", "--quality", "fast"]},
      {"study": "talk --quick --scene torque_limit", "seconds": 1}]})");
  }
  void TearDown() override { fs::remove_all(root_); }

  void write(const std::string& name, const std::string& content) const {
    std::ofstream(root_ + "/" + name, std::ios::binary) << content;
  }
  std::string run_directory(const std::string& name) const { return root_ + "/" + name; }
  /// Plans the manifest.
  std::string planned(const std::string& name) const {
    const Outcome run = sinew("batch plan " + root_ + "/manifest.json -o " + run_directory(name));
    EXPECT_EQ(run.code, 0) << run.out;
    return run_directory(name);
  }
  static json status(const std::string& directory) {
    const std::string out = sinew("batch status --json " + directory).out;
    return json::parse(out.substr(0, out.find('\n')));
  }
  /// Every file of a merged result.
  static std::map<std::string, std::string> files(const std::string& directory) {
    std::map<std::string, std::string> all;
    for (const auto& entry : fs::recursive_directory_iterator(directory))
      if (entry.is_regular_file())
        all[entry.path().lexically_relative(directory).string()] = bytes_of(entry.path().string());
    return all;
  }
  /// `sinew batch run DIRECTORY WORDS…` beside this process.
  static pid_t started(std::vector<std::string> words) {
    words.insert(words.begin(), {SINEW_COMMAND, "batch", "run", "-q"});
    std::vector<char*> raw;
    for (std::string& word : words) raw.push_back(word.data());
    raw.push_back(nullptr);
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, "/dev/null", O_WRONLY, 0);
    pid_t process = -1;
    EXPECT_EQ(posix_spawn(&process, SINEW_COMMAND, &actions, nullptr, raw.data(), environ), 0);
    posix_spawn_file_actions_destroy(&actions);
    return process;
  }

  const std::string root_ = own_directory() + "batch";
};

TEST_F(Batch, SeveralProcessesThatAreKilledMakeWhatOneMakes) {
  const std::string alone = planned("alone"), many = planned("many");
  const Outcome one = sinew("batch run " + alone);
  EXPECT_EQ(one.code, 1) << one.out;  // one file is no source
  EXPECT_NE(one.out.find("8 done, 1 failed"), std::string::npos) << one.out;
  EXPECT_EQ(sinew("batch merge " + alone).code, 1);

  const unsigned seed = std::random_device{}();
  SCOPED_TRACE("seed " + std::to_string(seed));
  std::mt19937 random(seed);
  const Outcome early = sinew("batch merge " + many);
  EXPECT_EQ(early.code, 4);
  EXPECT_NE(early.out.find("not finished"), std::string::npos);
  EXPECT_FALSE(fs::exists(many + "/merged"));
  for (int round = 0; round < 3; ++round) {  // two shards each, and two copies of one of them
    std::vector<pid_t> running;
    for (const char* part : {"1/2", "2/2", "2/2"})
      running.push_back(started({many, "--tries", "50", "--shard", part}));
    std::this_thread::sleep_for(std::chrono::milliseconds(100 + random() % 400));
    for (const pid_t process : running) kill(process, SIGKILL);
    for (const pid_t process : running) waitpid(process, nullptr, 0);
  }
  for (const char* part : {"1/2", "2/2"})
    sinew("batch run --tries 50 -j 2 --shard " + std::string(part) + " " + many);
  EXPECT_EQ(status(many)["left"], 0);
  EXPECT_EQ(sinew("batch merge " + many).code, 1);
  const auto expected = files(alone + "/merged"), found = files(many + "/merged");
  EXPECT_EQ(expected, found);
  EXPECT_EQ(expected.size(), 6u + 1 + 1 + 1);  // assets, a picture, the study's figures, the report
  EXPECT_TRUE(expected.count("convert/walk3.sinew") && expected.count("render/walk0.png"));
  const json report = json::parse(expected.at("report.json"));
  EXPECT_EQ(report["rows"].size(), 9u);
  EXPECT_EQ(report["rows"][0]["name"], "convert/sub/bad.sinew");
  EXPECT_NE(report["rows"][0]["error"].get<std::string>().find("bad.bvh"), std::string::npos);
}

TEST_F(Batch, WhatIsMadeIsNotMadeAgainAndWhatIsDamagedIs) {
  write("manifest.json", R"({"jobs": [{"convert": ["art/walk0.bvh", "art/walk1.bvh"]}]})");
  const std::string run = planned("run");
  EXPECT_NE(sinew("batch run -j 2 " + run).out.find("2 of them now"), std::string::npos);
  EXPECT_NE(sinew("batch run " + run).out.find("0 of them now"), std::string::npos);
  for (const auto& entry : fs::recursive_directory_iterator(run + "/results"))
    if (entry.path().filename() == "out.sinew") {
      std::ofstream(entry.path(), std::ios::app) << "x";
      break;
    }
  EXPECT_EQ(sinew("batch merge " + run).code, 4);
  EXPECT_NE(sinew("batch run " + run).out.find("1 of them now"), std::string::npos);
  EXPECT_EQ(sinew("batch merge " + run).code, 0);
  EXPECT_EQ(status(run)["done"], 2);
}

TEST_F(Batch, PoisonIsIsolatedAfterABoundedNumberOfTries) {
  write("manifest.json", R"({"jobs": [{"convert": ["art/walk0.bvh", "art/walk1.bvh"]}]})");
  const std::string run = planned("run");
  // What a machine leaves that died with the unit in it: a start, and no end.
  const json unit =
      json::parse(bytes_of(run + "/shards/1.jsonl").substr(0, bytes_of(run + "/shards/1.jsonl").find('\n')));
  const std::string key = unit["key"], tries = run + "/tries/" + key.substr(0, 2);
  fs::create_directories(tries);
  std::ofstream(tries + "/" + key) << "node7 1\nnode8 2\n";
  EXPECT_EQ(sinew("batch run --tries 2 " + run).code, 1);
  const json now = status(run);
  EXPECT_EQ(now["done"], 1);
  ASSERT_EQ(now["failed"], 1);
  EXPECT_NE(now["failures"][0]["error"].get<std::string>().find("started 2 times without a result"),
            std::string::npos);
  EXPECT_EQ(sinew("batch run --again " + run).code, 0);  // and it was innocent

  // A process that is ended by a signal each time: here, for want of processor time.
  write("manifest.json",
        R"({"jobs": [{"study": "stability", "arguments": ["--quick"]}, {"convert": "art/walk2.bvh"}]})");
  const std::string hungry = planned("hungry");
  EXPECT_EQ(sinew("batch run --cpu-limit 2 --tries 1 " + hungry).code, 1);
  EXPECT_EQ(status(hungry)["done"], 1);
  EXPECT_EQ(status(hungry)["failures"][0]["name"], "study/stability");
}

TEST_F(Batch, PlansDoNotChangeAndBadOnesAreOneLine) {
  const std::string run = planned("run");
  planned("run");  // the same again is nothing
  write("art/more.bvh", bvh(1));
  expect_refused("batch plan " + root_ + "/manifest.json -o " + run, "holds another plan");
  write("art/walk0.bvh", bvh(77));
  sinew("batch run -j 2 " + run);
  const json failures = status(run)["failures"];
  ASSERT_EQ(failures.size(), 3u) << failures;  // bad.bvh; walk0.bvh and its picture
  EXPECT_NE(failures[1]["error"].get<std::string>().find("has changed since it was planned"),
            std::string::npos);
  const auto plan = [&](const std::string& text, const std::string& names) {
    write("bad.json", text);
    expect_refused("batch plan " + root_ + "/bad.json -o " + root_ + "/never", names);
  };
  plan(R"({"jobs": [{"convert": "nothing"}]})", "nothing: no such file");
  plan(R"({"jobs": [{"convert": "art", "render": "art"}]})", "has both");
  plan(R"({"jobs": [{"convert": "art", "arguments": ["-o", "x"]}]})", "-o is not for batches");
  plan(R"({"jobs": [{"convert": "art", "name": "../x"}]})", "below the result");
  plan(R"({"jobs": [{"convert": "art"}, {"convert": "art"}]})", "two jobs make");
  expect_refused("batch status " + root_ + "/art", "plan.json");
  EXPECT_EQ(sinew("batch run --shard 3/2 " + run).code, 1);
}

TEST_F(Batch, ScriptsForSlurmAreShellAndNameWhatIsLeft) {
  const std::string run = planned("run");
  sinew("batch run --shard 2/3 " + run);
  const json made = json::parse(
      sinew("batch submit --json --dry-run --array-limit 3 -j 2 --sbatch=--partition=farm " + run).out);
  EXPECT_EQ(made["tasks"], "1,3");
  const std::string array = bytes_of(run + "/slurm/array.sh");
  for (const char* words : {"#SBATCH --array=1,3\n", "#SBATCH --requeue", "#SBATCH --partition=farm",
                            "--shard \"$SLURM_ARRAY_TASK_ID/3\"", "-j 2"})
    EXPECT_NE(array.find(words), std::string::npos) << words;
  // The scripts are plain sh: run as Slurm would, they make what is left, and merge it.
  for (const char* task : {"1", "3"})
    EXPECT_EQ(
        run_program("env", "SLURM_ARRAY_TASK_ID=" + std::string(task) + " sh " + run + "/slurm/array.sh")
            .code,
        0);
  EXPECT_EQ(status(run)["left"], 0);
  EXPECT_EQ(run_program("sh", run + "/slurm/merge.sh").code, 1);  // bad.bvh
  EXPECT_TRUE(fs::exists(run + "/merged/report.json"));
}

}  // namespace
}  // namespace sinew::test
