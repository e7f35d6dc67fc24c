// `sinew graph` as an animator runs it.
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "cli/command.h"
#include "fixtures/paths.h"

namespace sinew::test {
namespace {

const std::string kGraph = source_dir() + "/assets/character/mannequin.graph.json";
const std::string kAsset = binary_dir() + "/sample.sinew";

std::vector<std::vector<std::string>> rows_of(const std::string& csv) {
  std::vector<std::vector<std::string>> rows;
  std::istringstream lines(csv);
  for (std::string line; std::getline(lines, line);) {
    std::vector<std::string>& row = rows.emplace_back();
    std::istringstream cells(line);
    for (std::string cell; std::getline(cells, cell, ',');) row.push_back(cell);
  }
  return rows;
}

TEST(GraphCommand, ChecksTheDemoCharactersGraph) {
  const Outcome check = sinew("graph check " + kGraph + " --asset " + kAsset);
  EXPECT_EQ(check.code, 0);
  // What follows a body that is thrown about is the one thing that is not smooth.
  const Outcome json = sinew("graph check --json " + kGraph);
  const nlohmann::json said = nlohmann::json::parse(json.out);
  EXPECT_EQ(said["warnings"].size(), 0u);
  ASSERT_EQ(said["jumps"].size(), 1u);
  EXPECT_EQ(said["jumps"][0]["node"], "graph/limp");
  EXPECT_GT(said["jumps"][0]["line"], 10);
  EXPECT_EQ(sinew("graph check --strict " + kGraph).code, 1);
}

TEST(GraphCommand, FaultsAreOneLineWithTheirPlace) {
  const std::string path =
      written("wrong.graph.json", "{\n  \"graph\": { \"clip\": \"walk\",\n    \"sped\": 1 }\n}\n");
  expect_refused("graph check " + path, "wrong.graph.json:3: unknown key 'sped'");
  expect_refused("graph compile " + path + " -o " + own_directory() + "never.sgraph", "wrong.graph.json:3");
  expect_refused("graph check /no/such.json", "/no/such.json");
  expect_refused("graph check " + written("none.graph.json", "{\"graph\": \"wolk\"}") + " --asset " + kAsset,
                 "'wolk'");
  expect_refused("graph check " + written("cut.sgraph", std::string("\x10\0\0\0SNGR____________", 20)),
                 "cut.sgraph");
  expect_refused("graph trace " + kGraph + " --asset " + kAsset + " --inputs " +
                     written("inputs.json", "[[0, \"speed\", 1],\n[1, \"sped\", 2]]"),
                 "inputs.json:2: no parameter 'sped'");
  expect_refused("graph trace " + kGraph + " --asset " + kAsset + " --joint nose", "no joint 'nose'");
  EXPECT_EQ(sinew("graph").code, 2);
}

TEST(GraphCommand, CompiledGraphsPlayAsTheirTexts) {
  const std::string compiled = own_directory() + "hero.sgraph";
  ASSERT_EQ(sinew("graph compile " + kGraph + " -o " + compiled).code, 0);
  const std::string inputs = written("walk.json", "[[0.5, \"speed\", 1.275], [2, \"speed\", 3.2]]");
  const std::string rest = " --asset " + kAsset + " --inputs " + inputs + " --seconds 4 --joint shin_r";
  const Outcome text = sinew("graph trace " + kGraph + rest),
                binary = sinew("graph trace " + compiled + rest);
  ASSERT_EQ(text.code, 0);
  EXPECT_EQ(text.out, binary.out);
  const auto rows = rows_of(text.out);
  ASSERT_EQ(rows.size(), 242u);
  EXPECT_EQ(rows[0][1], "graph");
  EXPECT_EQ(rows[241][1], "move");
  EXPECT_GT(std::stod(rows[241][2]), 6) << "walked and ran, forwards";
  EXPECT_NEAR(std::stod(rows[241][3]), 0, 1e-3);
  EXPECT_NE(rows[241][7].find("graph/move/2"), std::string::npos)
      << "the run moves the shin: " << rows[241][7];
  const Outcome end = sinew("graph trace --json " + compiled + rest);
  EXPECT_EQ(nlohmann::json::parse(end.out)["plays"]["state"], "move");
}

TEST(GraphCommand, DrawsForGraphviz) {
  const Outcome drawn = sinew("graph dot " + kGraph);
  EXPECT_EQ(drawn.code, 0);
  EXPECT_EQ(drawn.out.rfind("digraph", 0), 0u);
  EXPECT_NE(drawn.out.find("physics.face_up"), std::string::npos);
}

}  // namespace
}  // namespace sinew::test
