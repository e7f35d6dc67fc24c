// The command as a user runs it: exit codes, one-line errors, whole files or none.
#include <cmath>
#include <nlohmann/json.hpp>
#include <regex>

#include "cli/command.h"
#include "fixtures/paths.h"
#include "import/morphing_leg.h"
#include "sinew/io/asset.h"

namespace sinew::test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

const std::string kCharacter = source_dir() + "/assets/character/mannequin.glb";
const std::string kAsset = binary_dir() + "/sample.sinew";

TEST(Command, UsageErrorsExitWithTwoAndHelpWithZero) {
  EXPECT_EQ(sinew("").code, 2);
  EXPECT_EQ(sinew("convert").code, 2);
  EXPECT_EQ(sinew("render a.sinew -o x.mp4 --theme pink").code, 2);
  for (const char* command : {"convert", "info", "evaluate", "simulate", "render", "export"}) {
    const Outcome help = sinew(std::string(command) + " --help");
    EXPECT_EQ(help.code, 0);
    EXPECT_NE(help.out.find("Example"), std::string::npos) << command;
  }
}

TEST(Command, BadFilesAreNamedInOneLineAndNothingIsLeftBehind) {
  const std::string out = own_directory() + "never.sinew";
  expect_refused("convert /no/such.glb -o " + out, "/no/such.glb");
  expect_refused("convert " + written("text.glb", "hello") + " -o " + out, "text.glb");
  expect_refused("convert " + kCharacter + " --unit nan -o " + out, "option 'unit'");
  expect_refused(
      "convert " + kCharacter + " --options " + written("o.json", "{\"total_mass\": 1e999}") + " -o " + out,
      "o.json");
  expect_refused(
      "convert " + kCharacter + " --options " + written("o.json", R"({"strict": "yes"})") + " -o " + out,
      "o.json: option 'strict' has the wrong type");
  expect_refused("info " + written("cut.sinew", std::string("\x10\0\0\0SNEW____________", 20)), "cut.sinew");
  expect_refused("render " + kAsset + " -o /no/such/directory/x.png", "/no/such/directory");
  expect_refused("render " + kAsset + " -o " + own_directory() + "x.avi", "x.avi");
  expect_refused("render " + kAsset + " --size 641x480 -o " + own_directory() + "x.png", "even");
  expect_refused("render " + kAsset + " --clip nothing -o " + own_directory() + "x.png", "nothing");
  expect_refused("convert " + kCharacter + " --report /no/such/report.json -o " + out,
                 "/no/such/report.json");
  for (const auto& entry : fs::directory_iterator(own_directory())) {
    EXPECT_EQ(entry.path().filename().string().find("never.sinew"), std::string::npos);
    EXPECT_EQ(entry.path().string().find(".tmp"), std::string::npos) << entry.path();
  }
}

TEST(Command, OutputsThatAreInputsAreRefusedAndLeftAlone) {
  const std::string scene =
      written("one.json", R"({"duration": 0.1, "characters": [{"asset": ")" + kAsset + R"("}]})");
  const std::string own = own_directory() + "own.glb", before = bytes_of(scene);
  fs::copy_file(kCharacter, own, fs::copy_options::overwrite_existing);
  const std::string character = bytes_of(own);
  expect_refused("convert " + own + " -o " + own, "own.glb: is the input");
  expect_refused("convert " + own + " -o " + own_directory() + "x.sinew --report " + own,
                 "own.glb: is the input");
  expect_refused(
      "convert " + own + " -o " + own_directory() + "x.sinew --report " + own_directory() + "x.sinew",
      "two outputs cannot be one file");
  expect_refused("retarget " + kAsset + " --to " + own + " -o " + own, "own.glb: is the input");
  expect_refused("simulate " + scene + " -o " + scene, "one.json: is the input");
  expect_refused("graph compile " + scene + " -o " + scene, "one.json: is the input");
  EXPECT_EQ(bytes_of(own), character);
  EXPECT_EQ(bytes_of(scene), before);
}

TEST(Command, ConvertGivesTheSameBytesInEveryProcessAndPlace) {
  const std::string elsewhere = own_directory() + "elsewhere";
  fs::create_directories(elsewhere);
  for (const char* name : {"mannequin.glb", "mannequin.clips.json"})
    fs::copy_file(fs::path(kCharacter).replace_filename(name), elsewhere + "/" + name,
                  fs::copy_options::overwrite_existing);
  const std::string first = own_directory() + "first.sinew", second = own_directory() + "second.sinew";
  ASSERT_EQ(sinew("convert " + kCharacter + " -o " + first).code, 0);
  ASSERT_EQ(sinew("convert " + elsewhere + "/mannequin.glb -o " + second).code, 0);
  EXPECT_GT(fs::file_size(first), 10000u);
  EXPECT_EQ(bytes_of(first), bytes_of(second));
}

TEST(Command, SaysItsVersionAndWhatClipsSayBesideTheirMotion) {
  EXPECT_TRUE(std::regex_match(sinew("--version").out, std::regex("sinew \\d+\\.\\d+\\.\\d+\n")));
  const Outcome info = sinew("info " + kCharacter);
  EXPECT_NE(info.out.find("masks: left_arm right_arm upper_body"), std::string::npos) << info.out;
  EXPECT_NE(info.out.find("events of walk: step 0.525 s, step 1.058 s"), std::string::npos) << info.out;
  const std::string data =
      written("more.json", R"({"clips": {"run": {"events": [{"name": "go", "time": 0.5}]}}})");
  const Outcome more = sinew("info " + kCharacter + " --clip-data " + data);
  EXPECT_NE(more.out.find("events of run: go 0.500 s"), std::string::npos) << more.out;
  const Outcome bad = sinew("info " + kCharacter + " --clip-data " + written("bad.json", "{\"clip\": 1}"));
  EXPECT_EQ(bad.code, 1);
  EXPECT_NE(bad.out.find("unknown key 'clip'"), std::string::npos) << bad.out;
}

TEST(Command, ListsMorphTargets) {
  const std::string leg = written("leg.gltf", import::test::morphing_leg().dump());
  const std::string asset = own_directory() + "leg.sinew", lost = own_directory() + "lost.sinew";
  const Outcome convert = sinew("convert " + leg + " -o " + asset);
  EXPECT_NE(convert.out.find("2 morph targets"), std::string::npos) << convert.out;
  Asset without;
  ASSERT_TRUE(load_asset(asset.c_str(), without).ok());
  without.report_json.clear();
  const std::vector<std::uint8_t> bytes = write_asset(without);
  written("lost.sinew", std::string(bytes.begin(), bytes.end()));
  const json wanted = json::parse(R"([{"mesh": "skin0", "name": "smile", "vertices": 1},
                                      {"mesh": "skin0", "name": "frown", "vertices": 1}])");
  for (const std::string& file : {leg, asset, lost}) {
    const Outcome info = sinew("info " + file), as_json = sinew("info " + file + " --json");
    EXPECT_NE(info.out.find("morph targets: frown smile\n"), std::string::npos) << info.out;
    ASSERT_EQ(as_json.code, 0) << as_json.out;
    EXPECT_EQ(json::parse(as_json.out)["morph_targets"], wanted) << file;
  }
}

TEST(Command, NamesInAnyEncodingAreWritten) {
  const std::string bvh =
      written("gr\xFC\xDF.bvh",
              "HIERARCHY\nROOT H\xFC\n{\nOFFSET 0 0 0\nCHANNELS 3 Xrotation Yrotation Zrotation\n"
              "JOINT b\n{\nOFFSET 0 9 0\nCHANNELS 0\n}\n}\n"
              "MOTION\nFrames: 2\nFrame Time: 0.1\n0 0 0\n0 9 0\n");
  const Outcome run = sinew("convert " + bvh + " --json -o " + own_directory() + "gr\xFC\xDF.sinew");
  ASSERT_EQ(run.code, 0) << run.out;
  EXPECT_EQ(json::parse(run.out)["name"], "grüß");
}

TEST(Command, ScenesAreCheckedByNameBeforeAnythingRuns) {
  const auto scene = [](const std::string& extra, const std::string& character) {
    return "{\"duration\": 0.1, \"characters\": [{\"asset\": \"" + kAsset + "\"" + character + "}]" + extra +
           "}";
  };
  const std::pair<std::string, std::string> cases[] = {
      {scene("", ", \"clips\": [{\"clip\": \"moonwalk\"}]"), "moonwalk"},
      {scene(", \"pushes\": [{\"joint\": \"tail\"}]", ""), "tail"},
      {scene(", \"effects\": [\"magic\"]", ""), "magic"},
      {scene(", \"surprise\": 1", ""), "surprise"},
      {scene(", \"frame_rate\": -60", ""), "frame_rate"},
      {scene(", \"gravity\": [0, 0, 1e999]", ""), "scene.json"},
      {scene("", ", \"strength\": [[0, -1]]"), "strength"},
      {"{\"characters\": []}", "characters"},
      {"not json", "JSON"}};
  for (const auto& [text, names] : cases) {
    const std::string path = written("scene.json", text), out = own_directory() + "scene.csv";
    expect_refused("simulate " + path + " -o " + out, names);
    EXPECT_FALSE(fs::exists(out)) << names;
  }
  const std::string video = own_directory() + "scene.mp4";
  expect_refused("simulate " + written("scene.json", scene("", "")) + " -o " + video, "sinew render");
  EXPECT_FALSE(fs::exists(video));
}

TEST(Command, SimulateWritesTelemetryOfAScene) {
  const std::string path =
      written("good.json", "{\"duration\": 1.5, \"characters\": [{\"asset\": \"" + kAsset +
                               "\", \"clips\": [{\"clip\": \"walk\"}]}], \"pushes\": [{\"time\": 0.5, "
                               "\"joint\": \"chest\", \"impulse\": [0, 60, 0]}]}");
  const std::string out = own_directory() + "good.csv";
  const Outcome run = sinew("simulate " + path + " --json -o " + out);
  ASSERT_EQ(run.code, 0) << run.out;
  const json summary = json::parse(run.out);
  EXPECT_GT(summary["most_unknown_dofs"].get<int>(), 0);
  EXPECT_GT(summary["frames_playback"].get<int>(), 25);
  std::ifstream csv(out);
  std::string header;
  std::getline(csv, header);
  EXPECT_EQ(header.rfind("time_s,character", 0), 0u);
  EXPECT_EQ(std::count(std::istreambuf_iterator<char>(csv), {}, '\n'), 91);
}

TEST(Command, SimulateTakesItsAccuracyFromTheDial) {
  const std::string scene =
      R"({"duration": 0.1, "accuracy": "reference", "characters": [{"asset": ")" + kCharacter + R"("}]})";
  const std::string path = written("dial.json", scene), out = own_directory() + "dial.csv";
  for (const char* dial : {"", "--preset game", "--max-error 2cm", "--max-error 2deg", "--budget 20us"})
    EXPECT_EQ(sinew("simulate " + path + " " + dial + " -o " + out).code, 0) << dial;
  expect_refused("simulate " + path + " --preset perfect -o " + out, "unknown preset 'perfect'");
  expect_refused("simulate " + path + " --max-error 3 -o " + out, "'3' is no error such as");
  expect_refused("simulate " + path + " --max-error 1um -o " + out, "'1um' is no error such as");
  expect_refused("simulate " + path + " --max-error 0.001mm -o " + out, "the most accurate promises");
  expect_refused("simulate " + path + " --budget 0.1us -o " + out, "the cheapest takes");
  EXPECT_EQ(sinew("simulate " + path + " --budget 20us --preset game -o " + out).code, 2);
  const std::string vague = written("vague.json", R"({"accuracy": "good", "characters": []})");
  expect_refused("simulate " + vague + " -o " + out, "unknown preset 'good'");
}

TEST(Command, EvaluatePrintsWhatItPromises) {
  const std::string urdf =
      written("pendulum.urdf",
              "<robot name=\"p\"><link name=\"base\"><inertial><mass value=\"1\"/><inertia ixx=\"1\" "
              "ixy=\"0\" ixz=\"0\" iyy=\"1\" iyz=\"0\" izz=\"1\"/></inertial></link>"
              "<link name=\"bob\"><inertial><origin xyz=\"0 0 -2\"/><mass value=\"3\"/><inertia ixx=\"0.1\" "
              "ixy=\"0\" ixz=\"0\" iyy=\"0.1\" iyz=\"0\" izz=\"0.1\"/></inertial></link>"
              "<joint name=\"swing\" type=\"continuous\"><parent link=\"base\"/><child link=\"bob\"/><axis "
              "xyz=\"0 1 0\"/></joint></robot>");
  const std::string state =
      written("state.json", "{\"joints\": {\"swing\": {\"q\": 0.5, \"v\": 1, \"a\": 2}}}");
  const Outcome run = sinew("evaluate " + urdf + " --fixed-base --state " + state);
  ASSERT_EQ(run.code, 0) << run.out;
  const json r = json::parse(run.out);
  EXPECT_EQ(r["dof_names"], json::array({"swing"}));
  // 3 kg on 2 m: I = 0.1 + 12; gravity torque m g l sin q.
  EXPECT_NEAR(r["mass_matrix"][0][0].get<double>(), 12.1, 1e-12);
  EXPECT_NEAR(r["inverse_dynamics"][0].get<double>(), 12.1 * 2 + 3 * 9.81 * 2 * std::sin(0.5), 1e-12);
  EXPECT_NEAR(r["forward_dynamics"][0].get<double>(), -3 * 9.81 * 2 * std::sin(0.5) / 12.1, 1e-12);
  EXPECT_NEAR(r["kinetic_energy"].get<double>(), 0.5 * 12.1, 1e-12);
  EXPECT_EQ(r["frames"].size(), 2u);
  EXPECT_EQ(json::parse(sinew("evaluate " + urdf).out)["dof_names"].size(), 7u);
  expect_refused(
      "evaluate " + urdf + " --state " + written("huge.json", "{\"joints\": {\"swing\": {\"v\": 1e200}}}"),
      "huge.json: the state leads to numbers that are not finite");
  expect_refused("evaluate " + urdf + " --state " + written("bad.json", "{\"joints\": {\"wing\": {}}}"),
                 "wing");
}

TEST(Command, InfoReportsMemoryPerRigAndCharacter) {
  const Outcome run = sinew("info " + kAsset + " --json");
  ASSERT_EQ(run.code, 0) << run.out;
  const json bytes = json::parse(run.out)["memory_bytes"];
  // 22 joints: a pose and a history of about 200 bytes each, and room for contacts. A character holds that
  // and what the solver needs.
  EXPECT_GT(bytes["snapshot"], 22 * 100);
  if (bytes["skeleton"] == 0) GTEST_SKIP() << "the address sanitizer's heap cannot be read";
  EXPECT_GT(bytes["skeleton"], 22 * sizeof(double));
  EXPECT_GT(bytes["clips"], bytes["skeleton"]);
  EXPECT_GT(bytes["character"], 2 * bytes["snapshot"].get<int>());
}

TEST(Command, SaysWhichProgramStudiesNeedWhereItIsMissing) {
  const std::string moved = own_directory() + "sinew";
  fs::copy_file(SINEW_COMMAND, moved, fs::copy_options::overwrite_existing);
  const Outcome run = run_program(moved, "study stability --quick");
  EXPECT_EQ(run.code, 1);
  EXPECT_NE(run.out.find("sinew: " + own_directory() + "sinew-study cannot be run"), std::string::npos)
      << run.out;
}

TEST(Command, RendersAPictureOfAnAsset) {
  const std::string out = own_directory() + "picture.png";
  const Outcome run = sinew("render " + kAsset + " --size 320x180 -o " + out);
  ASSERT_EQ(run.code, 0) << run.out;
  EXPECT_GT(fs::file_size(out), 5000u);  // a blank picture of this size takes well below 2 kB
}

TEST(Command, RendersAFolderWithAContactSheet) {
  const std::string in = own_directory() + "gallery", out = own_directory() + "rendered";
  fs::create_directories(in + "/sub");
  fs::copy_file(kAsset, in + "/hero.sinew", fs::copy_options::overwrite_existing);
  fs::copy_file(source_dir() + "/assets/mechanisms/README.md", in + "/sub/bad.glb",
                fs::copy_options::overwrite_existing);
  const std::string small = " --size 64x64 --quality fast --samples 1";
  const Outcome stills = sinew("render " + in + " --still -j 2 --json -o " + out + small);
  EXPECT_EQ(stills.code, 1) << stills.out;
  EXPECT_NE(stills.out.find("1 file could not be rendered"), std::string::npos) << stills.out;
  const json report = json::parse(stills.out.substr(0, stills.out.find('\n')));
  EXPECT_EQ(report["files"][0]["output"], out + "/hero.png");
  EXPECT_NE(report["files"][1]["error"].get<std::string>().find("bad.glb"), std::string::npos);
  EXPECT_TRUE(fs::exists(out + "/hero.png"));
  EXPECT_FALSE(fs::exists(out + "/sub/bad.png"));
  // Two cells of 240 pixels side by side, a gap of 12 around them, 28 for a title: of the PNG's header,
  // big-endian.
  const std::string sheet = bytes_of(out + "/contact_sheet.png");
  ASSERT_GT(sheet.size(), 1000u);
  const auto at = [&](std::size_t k) {
    return static_cast<unsigned char>(sheet[k]) << 8 | static_cast<unsigned char>(sheet[k + 1]);
  };
  EXPECT_EQ(at(18), 2 * 240 + 3 * 12);
  EXPECT_EQ(at(22), 240 + 28 + 2 * 12);
#ifdef SINEW_VIDEO
  const Outcome videos = sinew("render " + in + " --turntable --frames 4 -o " + out + small);
  EXPECT_EQ(videos.code, 1) << videos.out;
  EXPECT_GT(fs::file_size(out + "/hero.mp4"), 500u);
#endif
  expect_refused("render " + kAsset + " --still -o " + out + "/x.png", "--still is for folders");
}

}  // namespace
}  // namespace sinew::test
