// Figures that documents quote from settings are those of the code. Whoever changes a setting finds here
// which page to change with it.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <initializer_list>
#include <nlohmann/json.hpp>
#include <regex>
#include <sstream>

#include "fixtures/paths.h"
#include "scene/scene.h"
#include "sinew/effects/coupling.h"
#include "sinew/optimizer/newton_constants.h"
#include "sinew/optimizer/presets.h"
#include "sinew/residual/composite_pass.h"
#include "study/study.h"

namespace sinew {
namespace {

std::string text_of(const std::string& file) {
  std::ifstream in(source_dir() + "/" + file);
  std::stringstream text;
  text << in.rdbuf();
  return text.str();
}

struct Quoted {
  const char* file;
  const char* words;  ///< with the figure in brackets; every place where they stand
  double value;       ///< of the code, in the words' unit
};

const Accuracy kDefault;
const scene::Scene kScene;

const Quoted kQuotes[] = {
    {"runtime/sinew/optimizer/README.md", R"(by the sink depth \(([\d.]+) mm\))", 1e3 * kDefault.sink_depth},
    {"runtime/sinew/optimizer/README.md", R"(below stick speed × h \(([\d.]+) cm/s\))",
     1e2 * kDefault.stick_speed},
    {"runtime/sinew/optimizer/README.md", R"(more than the tolerance \(([\de.-]+) m;)", kDefault.tolerance},
    {"runtime/sinew/optimizer/README.md", R"(takes? ([\d]+) passes in all its parts and repetitions)",
     double(kDefault.max_passes)},
    {"runtime/sinew/optimizer/README.md", R"(`Accuracy::max_rotation` \(([\d.]+) rad\))",
     kDefault.max_rotation},
    {"runtime/sinew/optimizer/README.md", R"(is divided from ([\d.]+) rad on)", kDefault.max_rotation},
    {"runtime/sinew/optimizer/README.md", R"(down to 1/([\d]+) s\.)", 1 / kDefault.shortest_part},
    {"runtime/sinew/optimizer/README.md", R"(does not converge in ([\d]+) passes)",
     double(kDefault.max_iterations)},
    {"runtime/sinew/optimizer/README.md", R"(`Accuracy::shortest_part` \(1/([\d]+) s)",
     1 / kDefault.shortest_part},
    {"runtime/sinew/optimizer/README.md", R"(A loop that begins open closes at ([\d.]+) m/s)", kClosingSpeed},
    {"runtime/sinew/optimizer/README.md", R"(A floor of ([\de.-]+) of the subtree's inertia)", kInertiaFloor},
    {"runtime/sinew/optimizer/README.md", R"(centre plus ([\d.]+) m per radian)", kRotationArm},
    {"runtime/sinew/optimizer/README.md", R"(curvature of a row has changed by more than ([\d.]+) of itself)",
     kSameCurvature},
    {"runtime/sinew/optimizer/README.md", R"(is taken while each is at most ([\d.]+)\s)", kSimplifiedRate},
    {"runtime/sinew/optimizer/README.md", R"(in contact with a ratio of ([\d.]+) at least)",
     kLeastRateInContact},
    {"runtime/sinew/optimizer/README.md", R"(contacts bear more than ([\d.]+) times what they did)",
     kMisleading},
    {"runtime/sinew/optimizer/README.md", R"(`kLeft`: ([\d]+) per metre)", kLeft},
    {"tools/scene/README.md", R"(title of the video; s \(([\d.]+)\))", kScene.duration},
    {"tools/scene/README.md", R"(steps per second \(([\d.]+)\))", kScene.frame_rate},
    {"tools/scene/README.md", R"(`start` s, `blend` s \(([\d.]+)\))", scene::ClipUse().blend},
    {"tools/scene/README.md", R"(`contact_damping` \(([\d.]+); 1 is critical\))", kDefault.contact_damping},
};

TEST(Documents, QuoteSettingsAsTheyAre) {
  for (const Quoted& quoted : kQuotes) {
    const std::string text = text_of(quoted.file);
    const std::regex words(quoted.words);
    int found = 0;
    for (std::sregex_iterator at(text.begin(), text.end(), words), end; at != end; ++at, ++found)
      EXPECT_NEAR(std::stod((*at)[1]), quoted.value, 1e-9 * quoted.value) << quoted.file << ": " << at->str();
    EXPECT_GT(found, 0) << quoted.file << " does not say any more: " << quoted.words;
  }
}

TEST(Documents, QuoteWhatPresetsAreChosenBy) {
  const nlohmann::json presets = nlohmann::json::parse(text_of("assets/accuracy_presets.json"))["presets"];
  const std::string text = text_of("tools/study/README.md");
  std::smatch found;
  ASSERT_TRUE(std::regex_search(
      text, found, std::regex(R"(within (\d+) cm \(crowd\), (\d+) cm \(game\), (\d+) mm \(cinematic\))")));
  EXPECT_NEAR(std::stod(found[1]), 1e2 * presets["crowd"]["wanted_m"].get<double>(), 1e-9);
  EXPECT_NEAR(std::stod(found[2]), 1e2 * presets["game"]["wanted_m"].get<double>(), 1e-9);
  EXPECT_NEAR(std::stod(found[3]), 1e3 * presets["cinematic"]["wanted_m"].get<double>(), 1e-9);
}

TEST(Documents, PresetsOfTheHeaderAreThoseOfTheDataFile) {
  const nlohmann::json data = nlohmann::json::parse(text_of("assets/accuracy_presets.json"));
  const AccuracyPreset presets[] = {kCrowdPreset, kGamePreset, kCinematicPreset, kReferencePreset};
  EXPECT_EQ(data["presets"].size(), std::size(presets));
  for (const AccuracyPreset& p : presets) {
    ASSERT_TRUE(data["presets"].contains(p.name)) << p.name;
    const nlohmann::json& row = data["presets"][p.name];
    EXPECT_EQ(row["substeps"].get<int>(), p.accuracy.substeps) << p.name;
    EXPECT_NEAR(row["tolerance"].get<double>(), p.accuracy.tolerance, 1e-12) << p.name;
    EXPECT_LE(p.error, row["wanted_m"].get<double>()) << p.name;
  }
}

TEST(Documents, NameTheCheapestSettingThatWasMeasured) {
  const nlohmann::json front = nlohmann::json::parse(text_of("assets/accuracy_presets.json"))["front"];
  double cheapest = 1e9;
  for (const nlohmann::json& setting : front) cheapest = std::min(cheapest, setting["us"].get<double>());
  const std::string text = text_of("tools/study/README.md");
  std::smatch found;
  ASSERT_TRUE(std::regex_search(text, found, std::regex(R"(below the cheapest \((\d+) µs)")));
  EXPECT_EQ(std::stoi(found[1]), std::lround(cheapest));
}

/// Cases in all, and those that fail or exceed what steps may cost.
struct Cases {
  int all = 0, fail = 0, fail_at_length = 0, exceed = 0, exceed_at_length = 0;

  Cases() {
    using study::known_failure, study::known_excess;
    for (const study::HardCase& c : study::hard_cases()) {
      ++all;
      fail += known_failure(c.name) != nullptr;
      fail_at_length += known_failure(c.name, false) != nullptr;
      exceed += known_excess(c.name) != nullptr;
      exceed_at_length += known_excess(c.name, false) != nullptr;
    }
  }
};

TEST(Documents, CountHardCasesAsTheyAre) {
  const Cases cases;
  struct Counted {
    const char* file;
    const char* words;
    int value;
  };
  const char* const study = "tools/study/README.md";
  for (const Counted& counted : std::initializer_list<Counted>{
           {study, R"((\d+) of the \d+ cases of the stability catalogue pass)", cases.all - cases.fail},
           {study, R"(\d+ of the (\d+) cases of the stability catalogue pass)", cases.all},
           {study, R"((\d+) at full length)", cases.all - cases.fail_at_length},
           {study, R"(take more in (\d+) cases)", cases.exceed},
           {study, R"(in (\d+) of the long ones)", cases.exceed_at_length},
           {"README.md", R"((\d+) of the \d+ hard cases)", cases.fail},
           {"README.md", R"(\d+ of the (\d+) hard cases)", cases.all},
           {"README.md", R"(`stability` \((\d+) hard cases)", cases.all},
           {"tools/README.md", R"(\| (\d+) hard cases)", cases.all},
           {"runtime/sinew/optimizer/README.md", R"((\d+) of the \d+ hard cases)", cases.fail},
           {"runtime/sinew/optimizer/README.md", R"(\d+ of the (\d+) hard cases)", cases.all}}) {
    const std::string text = text_of(counted.file);
    std::smatch found;
    ASSERT_TRUE(std::regex_search(text, found, std::regex(counted.words)))
        << counted.file << ": " << counted.words;
    EXPECT_EQ(std::stoi(found[1]), counted.value) << counted.file << ": " << found[0];
  }
}

}  // namespace
}  // namespace sinew
