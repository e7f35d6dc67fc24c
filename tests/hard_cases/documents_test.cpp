// Figures that documents quote from settings are those of the code. Whoever changes a setting finds here
// which page to change with it.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <regex>
#include <sstream>

#include "fixtures/paths.h"
#include "sinew/optimizer/presets.h"
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

TEST(Documents, TheStudysPageCountsItsCasesAsTheyAre) {
  const std::string text = text_of("tools/study/README.md");
  const std::regex words(R"((\d+) of the (\d+) cases of the stability catalogue pass)");
  std::smatch found;
  ASSERT_TRUE(std::regex_search(text, found, words));
  int known = 0, all = 0;
  for (const study::HardCase& c : study::hard_cases())
    ++all, known += study::known_failure(c.name) != nullptr;
  EXPECT_EQ(std::stoi(found[2]), all);
  EXPECT_EQ(std::stoi(found[1]), all - known) << "known_failures.cpp lists " << known;
}

}  // namespace
}  // namespace sinew
