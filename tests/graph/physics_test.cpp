// Physical values as parameters of graphs.
#include <limits>

#include "graph_fixture.h"
#include "sinew/graph/graph_physics.h"

namespace sinew {
namespace {

constexpr const char* kAll = R"({
  "parameters": {
    "physics.tilt": 0, "physics.face_up": 0, "physics.height": 1, "physics.load": {"filter": 0.1},
    "physics.load.upper": 0, "physics.off_animation": 0, "physics.contacts": 0, "physics.contact_force": 0,
    "speed": 3
  },
  "graph": {"states": {"stand": "idle", "down": "hit"}, "transitions": [
    {"from": "stand", "to": "down", "if": "physics.tilt > 1 && physics.contacts > 0"}
  ]}
})";

TEST(GraphPhysics, EachValueGoesToTheParameterOfItsName) {
  const Asset asset = fixtures::graph_asset();
  Graph graph;
  fixtures::bind_graph(kAll, asset, graph);
  fixtures::GraphPlayer<float> player(graph);
  player.step(0);
  std::vector<float> loads(fixtures::kGraphJoints, 0.1f);
  loads[2] = 0.9f;  // not of the mask
  loads[4] = 0.5f;  // by half
  loads[7] = 0.3f;
  PhysicsValues<float> values;
  values.tilt = 1.5f;
  values.face_up = -0.5f;
  values.height = 0.2f;
  values.load = 0.9f;
  values.off_animation = 0.4f;
  values.contacts = 3;
  values.contact_force = 0.7f;
  values.joint_load = loads;
  ASSERT_TRUE(set_physics<float>(graph, player.state, values).ok());
  GraphParameters<float> parameters(graph, player.state);
  const auto goal = [&](const char* name) { return parameters.goal(player.parameter(name)); };
  EXPECT_EQ(goal("physics.tilt"), 1.5f);
  EXPECT_EQ(goal("physics.face_up"), -0.5f);
  EXPECT_EQ(goal("physics.height"), 0.2f);
  EXPECT_EQ(goal("physics.load"), 0.9f);
  EXPECT_EQ(goal("physics.load.upper"), 0.5f);
  EXPECT_EQ(goal("physics.off_animation"), 0.4f);
  EXPECT_EQ(goal("physics.contacts"), 3);
  EXPECT_EQ(goal("physics.contact_force"), 0.7f);
  EXPECT_EQ(goal("speed"), 3) << "the game's own";
  EXPECT_EQ(parameters.filtered(player.parameter("physics.load")).value, 0) << "filtered, as it says";
  player.step(1 / 60.0);
  EXPECT_EQ(player.in("graph"), "down");
}

TEST(GraphPhysics, NumbersThatAreNoneAreKeptOut) {
  const Asset asset = fixtures::graph_asset();
  Graph graph;
  fixtures::bind_graph(kAll, asset, graph);
  fixtures::GraphPlayer<double> player(graph);
  PhysicsValues<double> values;
  values.tilt = std::numeric_limits<double>::quiet_NaN();
  values.load = std::numeric_limits<double>::infinity();
  EXPECT_TRUE(set_physics<double>(graph, player.state, values).ok());
  GraphParameters<double> parameters(graph, player.state);
  EXPECT_EQ(parameters.goal(player.parameter("physics.tilt")), 0);
  EXPECT_EQ(parameters.goal(player.parameter("physics.load")), 1e6);
  EXPECT_EQ(parameters.goal(player.parameter("physics.load.upper")), 0) << "loads of joints are not known";
  EXPECT_FALSE(set_physics<double>(graph, std::span(player.state).first(32), values).ok());
}

TEST(GraphPhysics, AMaskThatTheAssetHasNotIsRefusedByName) {
  const graph_tools::Compiled compiled =
      graph_tools::compile_graph(R"({"parameters": {"physics.load.tail": 0}, "graph": "idle"})", "test");
  ASSERT_EQ(compiled.error, "");
  const std::string fault = graph_tools::bind_fault(compiled, "test", fixtures::graph_asset());
  EXPECT_NE(fault.find("no mask"), std::string::npos) << fault;
  EXPECT_NE(fault.find("'physics.load.tail'"), std::string::npos) << fault;
}

}  // namespace
}  // namespace sinew
