// Scenes on the project's own character: what a scene file says is what happens.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>

#include "fixtures/paths.h"
#include "scene/run.h"
#include "sinew/animation/curve_job.h"
#include "sinew/animation/sampling_job.h"

namespace sinew::scene {
namespace {

const std::string kAsset = binary_dir() + "/sample.sinew";

struct Result {
  Scene scene;
  Recording recording;
  Telemetry telemetry;

  const CharacterFrame& at(double t, std::size_t character = 0) const {
    return recording.frames[static_cast<std::size_t>(std::lround(t * scene.frame_rate))]
        .characters[character];
  }
  int joint(const char* name) const { return scene.characters[0].asset->skeleton.find(name); }
};

/// A directory of this process: ctest runs the cases side by side.
std::string own_file(const std::string& name) {
  const std::filesystem::path directory = testing::TempDir() + "sinew_scene_" + std::to_string(getpid());
  std::filesystem::create_directories(directory);
  return (directory / name).string();
}

std::string written(const std::string& name, const std::string& content) {
  std::string path = own_file(name);
  std::ofstream(path) << content;
  return path;
}

/// `character` and `extra` are JSON members that are added to the only character and to the scene.
Result run(const std::string& character, const std::string& extra = "", double duration = 1) {
  Result r;
  std::ostringstream text;
  text << R"({"duration": )" << duration << R"(, "characters": [{"asset": ")" << kAsset << "\"" << character
       << "}]" << extra << "}";
  const convert::Error loaded = load_scene(written("run.json", text.str()), r.scene);
  EXPECT_FALSE(loaded) << loaded.message;
  if (loaded) return r;
  const convert::Error ran = run_scene(r.scene, r.recording, r.telemetry, {});
  EXPECT_FALSE(ran) << ran.message;
  return r;
}

Vec3<double> forward(const Result& r, const CharacterFrame& frame) {
  const Quat<double> rest = r.scene.characters[0].asset->skeleton.joints[0].rest.rotation;
  return frame.model[0].rotation.cast<double>() * rest.conjugate() * Vec3<double>::UnitX();
}

Vec3<double> center_of_mass(const Result& r, const CharacterFrame& frame) {
  const Skeleton& s = r.scene.characters[0].asset->skeleton;
  Vec3<double> sum = Vec3<double>::Zero();
  for (int i = 0; i < s.body_count; ++i)
    sum += s.joints[i].mass * (frame.model[i].cast<double>() * s.joints[i].center_of_mass);
  return sum / s.total_mass();
}

TEST(Scene, AGridCopiesWhatItIsPartOf) {
  const auto load = [](const std::string& grid, Scene& out) {
    return load_scene(written("grid.json", R"({"characters": [{"figure": {"kind": "humanoid"}, "name": "one",
        "position": [1, 0, 0], "random_spin": {"rms": 1, "seed": 5}, "grid": )" +
                                               grid + R"(}],
        "props": [{"position": [0, 0, 1], "rotation": [0, 1.5, 0], "grid": )" +
                                               grid + "}]}"),
                      out);
  };
  Scene scene;
  ASSERT_FALSE(load(R"({"count": [2, 1, 3], "spacing": [0.5, 1, 2]})", scene));
  ASSERT_EQ(scene.characters.size(), 6u);
  ASSERT_EQ(scene.props.size(), 6u);
  EXPECT_EQ(scene.characters[0].name, "one");
  EXPECT_EQ(scene.characters[5].name, "one 6");
  EXPECT_EQ(scene.characters[5].position, Vec3<double>(1.5, 0, 4));
  EXPECT_EQ(scene.characters[5].speeds.seed, 10u);
  EXPECT_EQ(scene.props[5].settings.pose.translation, Vec3<double>(0.5, 0, 5));
  EXPECT_NEAR(scene.props[5].settings.pose.rotation.angularDistance(Quat<double>::Identity()), 1.5, 1e-12);
  for (const char* bad :
       {R"({"count": [0, 1, 1]})", R"({"count": [1.5, 1, 1]})", R"({"count": [100, 100, 2]})"}) {
    Scene unused;
    const convert::Error error = load(bad, unused);
    EXPECT_NE(error.message.find("characters[0].grid.count"), std::string::npos)
        << bad << ": " << error.message;
  }
}

TEST(Scene, TonesAreReadAndWhatIsNoneIsRefused) {
  const auto load = [](const std::string& keys, Scene& out) {
    return load_scene(
        written("tone.json", R"({"characters": [{"figure": {"kind": "humanoid"}, )" + keys + "}]}"), out);
  };
  Scene scene;
  ASSERT_FALSE(load(R"("tone": [[0, "alert"], [2, "braced"]], "group_tone": [{"joint": "upperarm_l",
                       "tone": "relaxed"}])",
                    scene));
  ASSERT_EQ(scene.characters[0].tone.size(), 2u);
  EXPECT_EQ(scene.characters[0].tone[1].second, Tone::kBraced);
  ASSERT_EQ(scene.characters[0].part_tones.size(), 1u);
  EXPECT_EQ(scene.characters[0].part_tones[0].tone[0].second, Tone::kRelaxed);
  const std::pair<const char*, const char*> bad[] = {
      {R"("tone": "floppy")", "characters[0].tone"},
      {R"("tone": 3)", "characters[0].tone"},
      {R"("group_tone": [{"tone": "alert"}])", "characters[0].group_tone[0]"},
      {R"("group_tone": [{"joint": "tail", "tone": "alert"}])", "characters[0].group_tone[0].joint"},
      {R"("group_tone": [{"group": "tail", "tone": "alert"}])", "characters[0].group_tone[0].group"}};
  for (const auto& [keys, where] : bad) {
    Scene unused;
    const convert::Error error = load(keys, unused);
    EXPECT_NE(error.message.find(where), std::string::npos) << keys << ": " << error.message;
  }
}

TEST(Scene, ItsRecordingHoldsTheCurvesOfItsClips) {
  const Result r = run(R"(, "clips": [{"clip": "get_up_supine"}])", "", 4);
  const Asset& asset = *r.scene.characters[0].asset;
  const int control = asset.find_curve("control");
  ASSERT_GE(control, 0);
  std::vector<TimeJet<float>> curves(asset.curve_slots.size());
  float least = 1, most = 0;
  for (const double t : {0.0, 1.0, 2.9, 3.0, 3.5}) {
    const Clip& clip = asset.clips[static_cast<std::size_t>(asset.find_clip("get_up_supine"))];
    ASSERT_TRUE((CurveJob<float>{&clip, t, asset.curve_slots, curves}.Run().ok()));
    const float value = r.at(t).curve(asset, static_cast<std::size_t>(control));
    EXPECT_NEAR(value, curves[static_cast<std::size_t>(control)].value, 1e-5f) << t;
    least = std::min(least, value);
    most = std::max(most, value);
  }
  EXPECT_LT(least, 0.1f);
  EXPECT_GT(most, 0.9f);
  EXPECT_EQ(CharacterFrame{}.curve(asset, static_cast<std::size_t>(control)), 1);  // its rest
}

TEST(Scene, UndisturbedPlaybackIsTheClip) {
  const Result r = run(R"(, "clips": [{"clip": "walk"}])");
  const Asset& asset = *r.scene.characters[0].asset;
  std::vector<JointJet<float>> jets(asset.skeleton.joints.size());
  std::vector<Transform<float>> model(jets.size());
  for (const Frame& frame : r.recording.frames) {
    EXPECT_EQ(frame.characters[0].unknown_dofs, 0);
    (void)SamplingJob<float>{&asset.clips[r.scene.characters[0].clips[0].clip], frame.time, jets}.Run();
    for (std::size_t i = 0; i < jets.size(); ++i) {
      const int parent = asset.skeleton.joints[i].parent;
      model[i] = {jets[i].rotation, jets[i].translation};
      if (parent >= 0) model[i] = model[static_cast<std::size_t>(parent)] * model[i];
      EXPECT_LT((frame.characters[0].model[i].translation - model[i].translation).norm(), 1e-5f);
      EXPECT_LT(frame.characters[0].model[i].rotation.angularDistance(model[i].rotation),
                1e-3f);  // acos near 1
    }
  }
}

TEST(Scene, PositionAndYawPlaceTheClip) {
  const Result r = run(R"(, "position": [3, -2, 0], "yaw_deg": 90, "clips": [{"clip": "walk"}])");
  const Vec3<float> start = r.at(0).model[0].translation, end = r.at(1).model[0].translation;
  EXPECT_NEAR(start.x(), 3, 0.1);
  EXPECT_NEAR(start.y(), -2, 0.1);
  EXPECT_GT(end.y() - start.y(), 0.8f);  // it walks along its own X, now the world's Y
  EXPECT_LT(std::abs(end.x() - start.x()), 0.1f);
}

TEST(Scene, AlignedClipBeginsWhereTheCharacterStandsAndFaces) {
  const Result r = run(R"(, "yaw_deg": 70, "clips": [{"clip": "walk"},
                          {"clip": "stand", "start": 1.5, "blend": 0, "align": true}])",
                       "", 2);
  const Vec3<float> before = r.at(1.5 - 1 / 60.0).model[0].translation,
                    after = r.at(1.5).model[0].translation;
  // One frame of walking at about 1.3 m/s is 22 mm.
  EXPECT_LT((before - after).head<2>().norm(), 0.03f);
  EXPECT_GT(forward(r, r.at(1.4)).dot(forward(r, r.at(1.6))), 0.98);
}

TEST(Scene, GetUpIsChosenByTheSideThatTheCharacterLiesOn) {
  for (const std::string side : {"supine", "prone"}) {
    const Result r = run(R"(, "yaw_deg": 130, "position": [1, 2, 0], "clips": [{"clip": "get_up_)" + side +
                             R"(", "rate": 0}, {"clip": "get_up", "start": 0.5, "blend": 0, "align": true}])",
                         "", 0.6);
    EXPECT_EQ(forward(r, r.at(0.4)).z() < 0, side == "prone");
    // The chosen clip begins with the very pose in which the body lies: nothing may jump.
    for (std::size_t i = 0; i < r.at(0.4).model.size(); ++i)
      EXPECT_LT((r.at(0.4).model[i].translation - r.at(0.5).model[i].translation).norm(), 1e-3f) << side << i;
  }
}

/// A walker whose strength goes when it starts, so that it falls, and comes back at 3 s.
Result fallen_and_getting_up(double height) {
  return run(R"(, "clips": [{"clip": "walk"},
                  {"clip": "get_up", "start": 3, "blend": 1, "rate": 0, "align": true, "from_pose": true}],
                  "strength": [[0, 0], [3, 0], [3.3, 1]], "root": [[0, "free"], [3, "assisted"]],
                  "root_force": 450, "root_torque": 170, "position": [0, 0, )" +
                 std::to_string(height) + "]",
             "", 4.5);
}

/// How far its joints are from the clip's first pose, rad in all.
float away_from_clip(const Result& r, double t) {
  const SceneCharacter& c = r.scene.characters[0];
  const bool prone = forward(r, r.at(2.9)).z() < 0;
  std::vector<JointJet<float>> jets(c.asset->skeleton.joints.size());
  (void)SamplingJob<float>{&c.asset->clips[prone ? c.clips[1].clip_when_prone : c.clips[1].clip], 0, jets}
      .Run();
  float sum = 0;
  for (int i = 1; i < c.asset->skeleton.body_count; ++i) {
    const int parent = c.asset->skeleton.joints[i].parent;
    const auto& model = r.at(t).model;
    sum += (model[parent].rotation.conjugate() * model[i].rotation).angularDistance(jets[i].rotation);
  }
  return sum;
}

TEST(Scene, FromPoseBeginsWhereTheFallenBodyLiesAndMovesGently) {
  const Result r = fallen_and_getting_up(0.014);
  const auto fastest = [&](double from, double to) {
    float speed = 0;
    for (double t = from; t < to; t += 1 / 60.0)
      for (std::size_t i = 0; i < r.at(t).model.size(); ++i)
        speed = std::max(
            speed, 60 * (r.at(t + 1 / 60.0).model[i].translation - r.at(t).model[i].translation).norm());
    return speed;
  };
  ASSERT_LT(r.at(2.9).model[0].translation.z(), 0.3f) << "it lies";
  // The ease has 0.17 of its peak speed 0.1 s after its start; the floor that bodies press on adds to it.
  EXPECT_LT(fastest(3, 3.1), 0.5f * fastest(3.1, 4));
}

// However it fell: heights a hair apart make other falls.
TEST(Scene, FromPoseComesToTheClipsFirstPose) {
  float worst = 0;
  for (int n = 0; n < 16; ++n) {
    const Result r = fallen_and_getting_up(0.0135 + 1e-4 * n);
    worst = std::max(worst, away_from_clip(r, 4.5) / away_from_clip(r, 3));
  }
  EXPECT_LT(worst, 0.1f);
}

TEST(Scene, OffsetStartsInTheMiddleOfAClip) {
  const Result whole = run(R"(, "clips": [{"clip": "get_up_supine"}])"),
               later = run(R"(, "clips": [{"clip": "get_up_supine", "offset": 0.5}])", "", 0.5);
  for (std::size_t i = 0; i < whole.at(0).model.size(); ++i)
    EXPECT_LT((whole.at(0.75).model[i].translation - later.at(0.25).model[i].translation).norm(), 1e-5f);
}

TEST(Scene, GroupStrengthSlackensOnlyItsSubtree) {
  const Result r = run(R"(, "clips": [{"clip": "stand"}],
                          "group_strength": [{"joint": "upperarm_l", "strength": [[0, 0]]}])");
  const CharacterFrame& frame = r.at(1);
  for (const char* slack : {"upperarm_l", "forearm_l"}) EXPECT_EQ(frame.limit[r.joint(slack)], 0) << slack;
  for (const char* strong : {"upperarm_r", "chest", "clavicle_l"})
    EXPECT_GT(frame.limit[r.joint(strong)], 1) << strong;
  EXPECT_GT(frame.unknown_dofs, 0);
}

TEST(Scene, SelfCollisionIsSwitchedPerCharacter) {
  const auto contacts = [](const std::string& flag) {
    const Result r = run(R"(, "clips": [{"clip": "stand"}], "strength": [[0, 0]], "root": [[0, "free"]],
                            "self_collision": )" +
                             flag,
                         "", 3);
    int sum = 0;
    for (const TelemetryRow& row : r.telemetry.rows) sum += row.report.contacts;
    return sum;
  };
  EXPECT_NE(contacts("true"), contacts("false")) << "a limp body folds";
}

TEST(Scene, PushIsSpreadOverItsDurationAndGivesItsImpulse) {
  const std::string floating = R"(, "ground": false, "gravity": [0, 0, 0], "pushes": [{"time": 0.2, )"
                               R"("duration": 0.25, "joint": "pelvis", "impulse": [0, 75, 0]}])";
  const Result r = run(R"(, "clips": [{"clip": "stand"}], "root": [[0, "free"]])", floating);
  const auto velocity = [&](double from, double to) {
    return Vec3<double>((center_of_mass(r, r.at(to)) - center_of_mass(r, r.at(from))) / (to - from));
  };
  const double expected = 75 / r.scene.characters[0].asset->skeleton.total_mass();
  const double before = velocity(0, 0.2).y();  // the clip's own sway, some mm/s
  // Linear momentum is exact in the scheme; 1 % covers the solver's 0.03 mm per step.
  EXPECT_NEAR(velocity(0.5, 1.0).y() - before, expected, 0.01 * expected);
  EXPECT_NEAR(velocity(0.2 + 7 / 60.0, 0.2 + 8 / 60.0).y() - before, expected / 2, 0.05 * expected);
}

TEST(Scene, ThrownBallMeetsTheJointOfAWalkingCharacter) {
  const Result r = run(R"(, "clips": [{"clip": "walk"}])",
                       R"(, "props": [{"size": 0.1, "mass": 0.5, "throw_at": {"joint": "chest", "time": 0.3,
                           "speed": 8, "from": [2, 2, 1]}}])",
                       1.2);
  float closest = 1e9f;
  const int chest = r.joint("chest");
  for (const Frame& frame : r.recording.frames)
    closest = std::min(
        closest, (frame.props[0].world.translation - frame.characters[0].model[chest].translation).norm());
  EXPECT_LT(closest, 0.1f + 0.25f);  // radius, and the chest around its joint
  EXPECT_LT(r.recording.frames.front().props[0].world.translation.z(), -100) << "hidden until its launch";
}

TEST(Scene, SameSceneGivesTheSameBits) {
  const std::string character = R"(, "clips": [{"clip": "walk"}], "strength": [[0, 1], [0.4, 0.01]],
                                   "root": [[0, "kinematic"], [0.4, "free"]])";
  const Result a = run(character), b = run(character);
  for (std::size_t f = 0; f < a.recording.frames.size(); ++f)
    for (std::size_t i = 0; i < a.recording.frames[f].characters[0].model.size(); ++i) {
      const auto &x = a.recording.frames[f].characters[0].model[i],
                 &y = b.recording.frames[f].characters[0].model[i];
      ASSERT_EQ(x.translation, y.translation) << f << " " << i;
      ASSERT_EQ(x.rotation.coeffs(), y.rotation.coeffs()) << f << " " << i;
    }
}

TEST(Scene, SubstepsAreSolvedAndReported) {
  const std::string limp = R"(, "clips": [{"clip": "stand"}], "strength": [[0, 0]], "root": [[0, "free"]])";
  for (const int parts : {1, 3}) {
    const Result r = run(
        limp,
        R"(, "accuracy": {"max_splits": 0, "max_rotation": 0, "substeps": )" + std::to_string(parts) + "}",
        0.5);
    EXPECT_EQ(r.telemetry.rows.back().report.substeps, parts);
    EXPECT_NE(telemetry_csv(r.scene, r.telemetry).find(",elastic_J,substeps,"), std::string::npos);
  }
}

/// Keys in `code` marks of the README's table: those of its row `name`, or all first columns for the top
/// level.
std::set<std::string> documented(const std::string& name) {
  std::ifstream readme(source_dir() + "/tools/scene/README.md");
  std::set<std::string> keys;
  for (std::string line; std::getline(readme, line);) {
    if (line.rfind("| `", 0) != 0) continue;
    const std::size_t middle = line.find(" | ");
    const std::string head = line.substr(0, middle);
    if (!name.empty() && head != "| `" + name + "`") continue;
    const std::string cell = name.empty() ? head : line.substr(middle);
    for (std::size_t at = cell.find('`'); at != std::string::npos; at = cell.find('`', at)) {
      const std::size_t end = cell.find('`', at + 1);
      if (const std::string key = cell.substr(at + 1, end - at - 1); key.find('.') == std::string::npos)
        keys.insert(key);
      at = end + 1;
    }
  }
  return keys;
}

TEST(SceneFile, EveryKnownKeyIsDocumentedAndEveryDocumentedKeyIsKnown) {
  const auto known = [](const std::string& scene) {
    Scene unused;
    const std::string message = load_scene(written("keys.json", scene), unused).message;
    const std::string lead = "unknown key 'x', known are: ";
    const std::size_t begin = message.find(lead);
    std::set<std::string> keys;
    EXPECT_NE(begin, std::string::npos) << message;
    if (begin == std::string::npos) return keys;
    std::istringstream list(message.substr(begin + lead.size(), message.rfind(" (") - begin - lead.size()));
    for (std::string key; std::getline(list >> std::ws, key, ',');) keys.insert(key);
    return keys;
  };
  const std::string hero = R"("characters": [{"asset": ")" + kAsset + "\"";
  EXPECT_EQ(known(R"({"x": 0})"), documented(""));
  EXPECT_EQ(known(R"({"accuracy": {"x": 0}})"), documented("accuracy"));
  EXPECT_EQ(known(R"({"baking": {"x": 0}})"), documented("baking"));
  EXPECT_EQ(known("{" + hero + R"(, "behaviour": {"x": 0}}]})"), documented("characters[].behaviour"));
  EXPECT_EQ(known(R"({"characters": [{"x": 0}]})"), documented("characters"));
  auto clips = documented("characters[].clips");
  for (const char* name : {"get_up", "get_up_supine", "get_up_prone"})
    EXPECT_EQ(clips.erase(name), 1u);  // names of clips, not keys
  EXPECT_EQ(known("{" + hero + R"(, "clips": [{"x": 0}]}]})"), clips);
  EXPECT_EQ(known("{" + hero + R"(, "group_strength": [{"x": 0}]}]})"),
            documented("characters[].group_strength"));
  const std::string world = "{" + hero + "}], ";
  EXPECT_EQ(known(world + R"("props": [{"x": 0}]})"), documented("props"));
  EXPECT_EQ(known(world + R"("props": [{"throw_at": {"x": 0}}]})"), documented("props[].throw_at"));
  EXPECT_EQ(known(world + R"("obstacles": [{"x": 0}]})"), documented("obstacles"));
  EXPECT_EQ(known(world + R"("pushes": [{"x": 0}]})"), documented("pushes"));
  EXPECT_EQ(known(world + R"("camera": {"x": 0}})"), documented("camera"));
}

TEST(Telemetry, EveryRowHasOneFieldPerColumnWhateverNamesSay) {
  const Result r = run(R"(, "name": "a,\"b\nc", "clips": [{"clip": "walk"}])", "", 0.2);
  std::istringstream csv(telemetry_csv(r.scene, r.telemetry));
  std::string header, row;
  std::getline(csv, header);
  const auto columns = std::count(header.begin(), header.end(), ',');
  EXPECT_NE(header.find(",load_upperarm_l"), std::string::npos);
  int rows = 0;
  for (; std::getline(csv, row); ++rows) EXPECT_EQ(std::count(row.begin(), row.end(), ','), columns) << row;
  EXPECT_EQ(rows, 13);
}

TEST(Telemetry, PlotIsDrawnAlsoUnderAwkwardNames) {
  if (std::system("command -v gnuplot >/dev/null") != 0) GTEST_SKIP() << "gnuplot is not installed";
  Result r = run(R"(, "clips": [{"clip": "walk"}])", R"(, "plot": "chest")", 0.5);
  r.telemetry.plotted_name = "it's \" a _joint";
  const std::string csv = written("it's.csv", telemetry_csv(r.scene, r.telemetry));
  const std::string png = own_file("it's.png");
  const convert::Error error = plot_telemetry(csv, r.telemetry, png);
  ASSERT_FALSE(error) << error.message;
  EXPECT_GT(std::filesystem::file_size(png), 10000u);
  EXPECT_FALSE(std::filesystem::exists(png + ".gp"));
  EXPECT_TRUE(plot_telemetry("/no/such.csv", r.telemetry, png + "2"));
  EXPECT_FALSE(std::filesystem::exists(png + "2"));
}

TEST(DemoScene, RunsOnAModelWithoutClipsAndRoles) {
  const std::string link =
      "<inertial><mass value=\"2\"/><inertia ixx=\"0.1\" iyy=\"0.1\" izz=\"0.1\" ixy=\"0\" "
      "ixz=\"0\" iyz=\"0\"/></inertial>";
  const std::string urdf = written(
      "chain.urdf", "<robot name=\"chain\"><link name=\"a\">" + link + "</link><link name=\"b\">" + link +
                        "</link><joint name=\"j\" type=\"continuous\"><parent "
                        "link=\"a\"/><child link=\"b\"/><origin xyz=\"0 0 0.5\"/>"
                        "<axis xyz=\"0 1 0\"/></joint></robot>");
  auto asset = std::make_shared<Asset>();
  nlohmann::json report;
  const convert::Error error = convert::open_any(urdf, {}, *asset, report);
  ASSERT_FALSE(error) << error.message;
  Recording recording;
  Telemetry telemetry;
  const convert::Error ran = run_scene(demo_scene(asset), recording, telemetry, {});
  EXPECT_FALSE(ran) << ran.message;
  for (const Frame& frame : recording.frames)
    for (const auto& x : frame.characters[0].model) ASSERT_TRUE(x.translation.allFinite()) << frame.time;
  EXPECT_EQ(recording.frames.back().characters[0].unknown_dofs, 0) << "back in its rest pose";
}

TEST(Inside, IsKeptWhereItIsAskedForAndChangesNoPose) {
  const Result plain = run(R"(, "clips": [{"clip": "stand"}], "strength": [[0, 0]], "root": [[0, "free"]])");
  Recording shown;
  shown.shows_inside = true;
  Telemetry telemetry;
  const convert::Error ran = run_scene(plain.scene, shown, telemetry, {});
  ASSERT_FALSE(ran) << ran.message;
  ASSERT_EQ(shown.frames.size(), plain.recording.frames.size());
  bool touches = false;
  for (std::size_t f = 0; f < shown.frames.size(); ++f) {
    EXPECT_TRUE(plain.recording.frames[f].inside.lines.empty());
    EXPECT_GT(shown.frames[f].inside.lines.size(), 20u) << "a line for each joint at least";
    for (const auto& line : shown.frames[f].inside.lines) touches |= line.color == debug_colors::kForce;
    const auto &a = shown.frames[f].characters[0].model, &b = plain.recording.frames[f].characters[0].model;
    for (std::size_t j = 0; j < a.size(); ++j) ASSERT_EQ(a[j].translation, b[j].translation) << f;
  }
  EXPECT_TRUE(touches) << "who is limp comes to lie on the floor";
}

TEST(DemoScene, OwnCharacterGetsUpAlthoughItIsHeldByLessThanItsWeight) {
  auto asset = std::make_shared<Asset>();
  ASSERT_TRUE(load_asset(kAsset.c_str(), *asset));
  const Scene scene = demo_scene(asset);
  const SceneCharacter& c = scene.characters[0];
  ASSERT_LT(c.settings.root_force, 0.7 * 9.81 * asset->skeleton.total_mass());
  Recording recording;
  Telemetry telemetry;
  const convert::Error ran = run_scene(scene, recording, telemetry, {});
  ASSERT_FALSE(ran) << ran.message;
  float least = 1e9f;
  for (const Frame& frame : recording.frames)
    least = std::min(least, frame.characters[0].model[0].translation.z());
  const CharacterFrame &first = recording.frames.front().characters[0],
                       &last = recording.frames.back().characters[0];
  EXPECT_LT(least, 0.25f) << "it lay";
  EXPECT_NEAR(last.model[0].translation.z(), first.model[0].translation.z(), 0.1);
  EXPECT_EQ(last.unknown_dofs, 0) << "and plays again";
}

TEST(DemoScene, MotionCaptureIsOverloadedByTheBallFallsAndReturnsToItsClip) {
  const std::string bvh = "/usr/share/assimp/models/BVH/01_01.bvh";
  if (!std::filesystem::exists(bvh)) GTEST_SKIP() << "assimp-testmodels is not installed";
  auto asset = std::make_shared<Asset>();
  nlohmann::json report;
  const convert::Error error = convert::open_any(bvh, {}, *asset, report);
  ASSERT_FALSE(error) << error.message;
  Recording recording;
  Telemetry telemetry;
  const Scene scene = demo_scene(asset);
  const convert::Error ran = run_scene(scene, recording, telemetry, {});
  ASSERT_FALSE(ran) << ran.message;
  const auto pelvis = [&](double t) {
    return recording.frames[static_cast<std::size_t>(t * scene.frame_rate)]
        .characters[0]
        .model[0]
        .translation.z();
  };
  const auto unknown = [&](double t) {
    return recording.frames[static_cast<std::size_t>(t * scene.frame_rate)].characters[0].unknown_dofs;
  };
  EXPECT_EQ(unknown(1), 0);
  const Skeleton& body = asset->skeleton;
  const double hit = scene.props[0].launch_time + scene.props[0].from.norm() / scene.props[0].speed;
  std::set<int> overloaded;  // joints, from the ball's arrival on
  for (const Frame& frame : recording.frames)
    if (frame.time > hit - 0.1 && frame.time < hit + 0.3)
      for (int j = 0; j < body.body_count; ++j)
        if (frame.characters[0].load[static_cast<std::size_t>(j)] > 0.99f) overloaded.insert(j);
  EXPECT_TRUE(overloaded.count(body.find(Role::kUpperArmL))) << "the arm that it was thrown at";
  EXPECT_GE(overloaded.size(), 2u) << "and what the arm hangs on";
  EXPECT_EQ(unknown(hit + 0.5), 0) << "then the clip goes on";
  EXPECT_LT(pelvis(7.5), 0.5f * pelvis(1)) << "it lies";
  float load = 0, effort = 0;
  for (const Frame& frame : recording.frames)
    if (frame.time > 7 && frame.time < 7.5)
      for (std::size_t j = 0; j < frame.characters[0].load.size(); ++j) {
        load = std::max(load, frame.characters[0].load[j]);
        effort = std::max(effort, frame.characters[0].effort[j]);
      }
  EXPECT_GT(load, 0.99f) << "muscles that have next to no strength are at their limit";
  EXPECT_LT(effort, 0.1f) << "and look limp";
  EXPECT_GT(pelvis(11.5), 0.8f * pelvis(1)) << "it stands again";
  EXPECT_EQ(unknown(11.5), 0);
}

/// Torque that the animation asks of a joint at the end of a scene, as the telemetry shows it.
double last_torque(const Result& r, const char* joint) {
  return double(r.recording.frames.back().characters[0].torque[r.joint(joint)]);
}

TEST(SceneEffects, DeclaringAllThatIsBuiltInChangesNothing) {
  const std::string body = R"(, "clips": [{"clip": "walk"}], "strength": [[0, 1], [0.3, 0.05]])";
  const Result plain = run(body), declared = run(body, R"(, "effects": ["standard"])");
  for (std::size_t f = 0; f < plain.recording.frames.size(); ++f) {
    const auto &one = plain.recording.frames[f].characters[0].model,
               &two = declared.recording.frames[f].characters[0].model;
    for (std::size_t i = 0; i < one.size(); ++i) ASSERT_EQ(one[i].translation, two[i].translation) << f;
  }
}

TEST(SceneEffects, WhatTheListLeavesOutDoesNotAct) {
  // A ragdoll without gravity stays where it was let go; without ground it falls through.
  const std::string limp = R"(, "strength": [[0, 0]], "root": [[0, "free"]])";
  const auto height = [](const Result& r) {
    return r.recording.frames.back().characters[0].model[0].translation.z();
  };
  const Result weightless = run(limp, R"(, "effects": ["muscles", "joint_limits", "ground", "friction"])");
  const Result bottomless = run(limp, R"(, "effects": ["gravity", "joint_limits"])", 2);
  const Result lying = run(limp, R"(, "effects": ["gravity", "joint_limits", "ground"])", 2);
  EXPECT_NEAR(height(weightless), weightless.recording.frames[0].characters[0].model[0].translation.z(),
              0.05);
  EXPECT_LT(height(bottomless), -10);
  EXPECT_GT(height(lying), 0);
}

TEST(SceneEffects, WindIsFeltByTheMusclesAndBlowsALimpBodyAway) {
  const std::string still = R"(, "effects": ["standard"])",
                    breeze = R"(, "effects": ["standard", {"effect": "wind", "velocity": [-12, 0, 0]}])",
                    other = R"(, "effects": ["standard", {"effect": "wind", "velocity": [-12, 0, 0],
                               "joints": ["head"]}])";
  const std::string walk = R"(, "clips": [{"clip": "walk"}])";
  const double calm = last_torque(run(walk, still), "upperarm_l");
  EXPECT_NE(last_torque(run(walk, breeze), "upperarm_l"), calm);
  EXPECT_EQ(last_torque(run(walk, other), "upperarm_l"), calm);
  const std::string limp = R"(, "strength": [[0, 0]], "root": [[0, "free"]])";
  const auto x = [](const Result& r) {
    return r.recording.frames.back().characters[0].model[0].translation.x();
  };
  EXPECT_LT(x(run(limp, R"(, "effects": ["standard", {"effect": "wind", "velocity": [-60, 0, 0]}])")),
            x(run(limp, still)) - 1);
}

TEST(SceneEffects, FaultsAreNamed) {
  const auto fault = [](const std::string& effects) {
    Scene unused;
    return load_scene(written("effects.json", R"({"characters": [{"asset": ")" + kAsset +
                                                  R"("}], "effects": )" + effects + "}"),
                      unused)
        .message;
  };
  EXPECT_THAT(fault(R"(["gravty"])"),
              testing::HasSubstr("unknown effect \"gravty\", known are: standard, grav"));
  EXPECT_THAT(fault(R"([{"effect": "wind", "speed": 3}])"), testing::HasSubstr("unknown key 'speed'"));
  EXPECT_THAT(fault(R"([{"effect": "gravity", "z": 3}])"), testing::HasSubstr("'gravity' has no settings"));
  EXPECT_THAT(fault(R"([{"effect": "wind", "joints": ["wing"]}])"),
              testing::HasSubstr("unknown joint 'wing' (effects[0])"));
  EXPECT_THAT(fault(R"([{"effect": "wind", "characters": ["nobody"]}])"),
              testing::HasSubstr("unknown character \"nobody\" (effects[0].characters[0])"));
  EXPECT_THAT(fault(R"([7])"), testing::HasSubstr("expected an effect's name"));
}

}  // namespace
}  // namespace sinew::scene
