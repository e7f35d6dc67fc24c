// JSON that is damaged, or of another shape than it should be: refused in words for people, wherever the tool
// reads JSON.
#include <functional>
#include <nlohmann/json.hpp>

#include "batch/manifest.h"
#include "cli/command.h"
#include "convert/convert.h"
#include "fixtures/paths.h"
#include "graph/compile.h"
#include "mechanism/mechanism_file.h"
#include "retarget/retarget.h"
#include "scene/scene.h"

namespace sinew::test {
namespace {

using nlohmann::json;

const std::string kAsset = binary_dir() + "/sample.sinew";
const std::string kBvh =
    "HIERARCHY\nROOT hip\n{\nOFFSET 0 0 0\nCHANNELS 3 Xrotation Yrotation Zrotation\nJOINT knee\n{\nOFFSET 0 "
    "-50 0\n"
    "CHANNELS 3 Xrotation Yrotation Zrotation\nEnd Site\n{\nOFFSET 0 -50 0\n}\n}\n}\n"
    "MOTION\nFrames: 3\nFrame Time: 0.1\n0 0 0 0 0 0\n0 0 0 9 0 0\n0 0 0 0 0 0\n";

/// Texts that are no JSON, or not an object.
const std::vector<std::string>& damaged() {
  static const std::vector<std::string> kAll = {"",
                                                "{",
                                                "[",
                                                "{\"a\": }",
                                                "not json",
                                                "\xFF\xFE",
                                                "[1,2]",
                                                "3",
                                                "null",
                                                "\"text\"",
                                                "{\"a\": \"\xC3\x28\"}",
                                                "{\"a\": 1e999}",
                                                std::string(100000, '['),
                                                std::string(100000, '{')};
  return kAll;
}

/// Those, half of a good text, and the good text with each of its values replaced by wrong ones.
std::vector<std::string> broken(const std::string& good) {
  std::vector<std::string> all = damaged();
  all.push_back(good.substr(0, good.size() / 2));
  const json whole = json::parse(good).flatten();
  for (const auto& [pointer, value] : whole.items())
    for (const json& wrong :
         {json("word"), json(-1), json(json::array({1, "x"})), json({{"surprise", 1}}), json()}) {
      json copy = whole.unflatten();
      copy[json::json_pointer(pointer)] = wrong;
      all.push_back(copy.dump());
    }
  return all;
}

void expect_plain(const std::string& words, const std::string& text) {
  for (const char* raw : {"json.exception", "std::", "basic_string", "terminate", "unordered_map"})
    EXPECT_EQ(words.find(raw), std::string::npos) << words << "\n" << text.substr(0, 300);
  EXPECT_EQ(words.find('\n'), std::string::npos) << words << "\n" << text.substr(0, 300);
}

struct Kind {
  std::string good;
  std::function<std::string(const std::string& path, const std::string& text)> read;  ///< "" or what is wrong
};

const std::string kScene =
    R"({"duration": 0.02, "characters": [{"asset": ")" + kAsset + R"(", "clips": [{"clip": "walk"}]}]})";
const std::string kMechanism =
    R"({"format": "sinew-mechanism", "version": 1, "t_end": 0.001, "name": "m",
        "bodies": [{"name": "b", "mass": 1, "com": [0, 0, -1], "inertia": [1, 1, 1, 0, 0, 0]}],
        "joints": [{"name": "j", "type": "revolute", "parent": "ground", "child": "b", "anchor": [0, 0, 0], "axis": [0, 0, 1]}]})";
const std::string kGraph = R"({"nodes": {"walk": {"clip": "walk"}}, "graph": "walk"})";
const std::string kManifest =
    R"({"jobs": [{"convert": "small.bvh", "arguments": ["--up", "y"], "name": "n", "seconds": 1}], "shard_seconds": 60})";

TEST(BrokenJson, OfEveryKindIsRefusedInPlainWords) {
  const std::string bvh = written("small.bvh", kBvh);
  const auto with_options = [&](const json& options) {
    Asset asset;
    json report;
    return convert::open_any(bvh, options, asset, report).message;
  };
  const Kind kinds[] = {
      {kScene,
       [](const std::string& path, const std::string&) {
         scene::Scene scene;
         return scene::load_scene(path, scene).message;
       }},
      {kMechanism,
       [](const std::string& path, const std::string&) {
         multibody::Mechanism mechanism;
         return mechanism::load_mechanism(path, mechanism);
       }},
      {kGraph, [](const std::string& path,
                  const std::string& text) { return graph_tools::compile_graph(text, path).error; }},
      {R"({"total_mass": 70, "fit_error_mm": 1, "clips": ["Motion"]})",
       [&](const std::string&, const std::string& text) {
         const json options = json::parse(text, nullptr, false);
         return options.is_discarded() ? "not JSON" : with_options(options);
       }},
      {R"({"clips": {"Motion": {"events": [{"name": "go", "time": 0.05}]}}})",
       [&](const std::string&, const std::string& text) {  // beside a source
         written("small.clips.json", text);
         return with_options(json::object());
       }},
      {R"({"to": {"left_hand": "wrist_l"}})",
       [](const std::string&, const std::string& text) {
         retarget::Options options;
         const json map = json::parse(text, nullptr, false);
         return map.is_discarded() ? "not JSON" : options.read_map(map).message;
       }},
      {kManifest, [](const std::string& path, const std::string&) {
         batch::Manifest manifest;
         return batch::read_manifest(path, "program", manifest).message;
       }}};
  for (const Kind& kind : kinds) {
    std::filesystem::remove(own_directory() + "small.clips.json");
    EXPECT_EQ(kind.read(written("good.json", kind.good), kind.good), "");
    int refused = 0;
    for (const std::string& text : broken(kind.good)) {
      const std::string words = kind.read(written("broken.json", text), text);
      refused += words.empty() ? 0 : 1;
      expect_plain(words, text);
    }
    EXPECT_GE(refused, int(damaged().size()) - 2) << kind.good;  // options may be null, and nothing
  }
}

TEST(BrokenJson, ReachesTheUserAsOneLineOfTheCommand) {
  const std::string bvh = written("one.bvh", kBvh), out = own_directory() + "never";
  const std::vector<std::string> commands = {"simulate @ -o " + out,
                                             "graph check @",
                                             "info " + bvh + " --options @",
                                             "info " + bvh + " --clip-data @",
                                             "evaluate " + kAsset + " --state @",
                                             "retarget " + kAsset + " --to " + kAsset + " --map @ -o " + out,
                                             "info @",
                                             "batch plan @ -o " + out};
  for (const std::string& command : commands) {
    for (const char* text : {"{\"a\": }", "{\"asset\": 3, \"joints\": 3}"}) {
      std::string words = command;
      words.replace(words.find('@'), 1, written("broken.json", text));
      const Outcome run = sinew(words);
      EXPECT_EQ(run.code, 1) << words << "\n" << run.out;
      EXPECT_EQ(std::count(run.out.begin(), run.out.end(), '\n'), 1) << run.out;
      expect_plain(run.out.substr(0, run.out.find('\n')), text);
    }
  }
}

}  // namespace
}  // namespace sinew::test
