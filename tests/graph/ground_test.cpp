// Feet, looks and travel as nodes of a graph: on stairs and slopes, whatever the game asks for.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <cstring>

#include "fixtures/counting_new.h"
#include "fixtures/paths.h"
#include "graph/attribution.h"
#include "graph/certificate.h"
#include "graph_fixture.h"
#include "sinew/graph/graph_file.h"

namespace sinew {
namespace {

using fixtures::GraphPlayer;

/// The demo character walks and turns, with its feet on the ground, and looks at something.
constexpr const char* kWalker = R"({
  "parameters": {"speed": {"value": 0, "filter": 0.2}, "turn": {"value": 0, "filter": 0.2}, "steer": {"value": 0, "filter": 0.2},
    "x": {"value": 5, "filter": 0.2}, "y": {"value": 0, "filter": 0.2}, "z": {"value": 1.5, "filter": 0.2},
    "look": {"value": 1, "filter": 0.2}, "feet": {"value": 1, "filter": 0.2}, "lie": "trigger"},
  "graph": {"feet": {"look": {"travel": {
      "states": {"move": {"blend": "speed", "sync": "feet", "points": [[0, {"clip": "stand", "sync": null}], [1.275, "walk"], [3.215, "run"]]},
                 "lie": "get_up_supine"},
      "transitions": [{"from": "move", "to": "lie", "if": "lie", "duration": 0.5},
                      {"from": "lie", "to": "move", "if": "lie", "kind": "dead", "duration": 0.5}]},
    "turn": "turn", "forward": "speed", "weight": "steer"},
    "at": ["x", "y", "z"], "in": "character", "weight": "look"}, "weight": "feet"}
})";

/// A flat, stairs of 15 cm up over three metres, a platform, and a slope of 1 in 5 down. Every number a
/// host's.
double height_at(double x) {
  if (x < 2) return 0;
  if (x < 5) return 0.15 * (1 + std::floor((x - 2) / 0.45));
  if (x < 7) return 1.05;
  return 1.05 - (x - 7) / 5;
}
template <class T>
bool below(const void*, const Vec3<T>& point, GroundHit<T>& hit) {
  hit.point = {point.x(), point.y(), T(height_at(double(point.x())))};
  hit.normal =
      point.x() < T(7) ? Vec3<T>(Vec3<T>::UnitZ()) : Vec3<T>(Vec3<T>(T(0.2), T(0), T(1)).normalized());
  return true;
}

class GraphGrounds : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    ASSERT_TRUE(load_asset((binary_dir() + "/sample.sinew").c_str(), asset).ok());
    fixtures::bind_graph(kWalker, asset, graph);
  }
  inline static Asset asset;
  inline static Graph graph;
};

struct Jump {
  double pose = 0, velocity = 0, acceleration = 0;
  void add(const std::vector<JointJet<double>>& a, const std::vector<JointJet<double>>& b) {
    for (std::size_t j = 0; j < a.size(); ++j) {
      pose = std::max({pose, 2 * (a[j].rotation.conjugate() * b[j].rotation).vec().norm(),
                       (a[j].translation - b[j].translation).norm()});
      velocity =
          std::max({velocity, (a[j].omega - b[j].omega).norm(), (a[j].velocity - b[j].velocity).norm()});
      acceleration = std::max(
          {acceleration, (a[j].alpha - b[j].alpha).norm(), (a[j].acceleration - b[j].acceleration).norm()});
    }
  }
};

void ask_at_random(auto& player, std::mt19937& random) {
  std::uniform_real_distribution<double> uniform(0, 1);
  switch (random() % 8) {
    case 0:
      return player.set("speed", 3 * uniform(random));
    case 1:
      return player.set("turn", 4 * uniform(random) - 2);
    case 2:
      return player.set("x", 6 * uniform(random) - 2);
    case 3:
      return player.set("y", 6 * uniform(random) - 3);
    case 4:
      return player.set("look", double(random() % 2));
    case 5:
      return player.set("feet", double(random() % 4 > 0));
    case 6:
      return player.set("steer", double(random() % 2));
    default:
      return player.trigger("lie");
  }
}

// As in smooth_test: what changes at an instant does so within a frame of no length.
TEST_F(GraphGrounds, NothingThatAGameSetsMakesFeetOrLooksJump) {
  ASSERT_TRUE(graph_tools::smoothness_losses(graph.definition()).empty());
  GraphPlayer<double> player(graph);
  player.ground.below = below<double>;
  std::mt19937 random(11);
  player.step(0);
  Jump worst;
  for (int k = 0; k < 1500; ++k) {
    player.step(std::uniform_real_distribution<double>(1e-3, 0.016)(random));
    const auto before = player.jets;
    if (k % 5 == 0) ask_at_random(player, random);
    player.step(0);
    worst.add(before, player.jets);
  }
  // Rounding, as in smooth_test.
  EXPECT_LT(worst.pose, 1e-6);
  EXPECT_LT(worst.velocity, 1e-6);
  EXPECT_LT(worst.acceleration, 1e-6);
}

TEST_F(GraphGrounds, FeetStayWhereTheyBearOverStairsAndASlope) {
  for (const double rate : {30.0, 60.0, 144.0}) {
    SCOPED_TRACE(rate);
    GraphPlayer<double> player(graph);
    player.ground.below = below<double>;
    player.set("speed", 1.275);
    player.set("look", 0);
    double slide = 0, depth = 0, deviation = 0, lowest = 1e9;
    int settled = 0;
    Vec3<double> rest[2];
    bool rested[2] = {};
    const std::span<const FootLeg<double>> legs = graph.feet().legs<double>();
    for (int k = 0; k < int(9 * rate); ++k) {
      GraphBlock<double> block(graph, player.state);
      const FootHold held[2] = {block.feet().legs[0].hold, block.feet().legs[1].hold};
      player.step(k ? 1 / rate : 0);
      const double place = GraphParameters<double>(graph, player.state).place().x();
      deviation = std::max(deviation, std::abs(block.feet().level.x.value - height_at(place)));
      lowest = std::min(lowest, player.jets[0].translation.z() - height_at(place));
      for (std::size_t i = 0; i < 2; ++i) {
        const FootState<double>& state = block.feet().legs[i];
        const MovingTransform<double> foot = model_motion<double>(player.jets, graph.parents(), legs[i].foot);
        const Vec3<double> toe = value_of<double>(MovingVector<double>(foot * still<double>(legs[i].toe))),
                           heel = value_of<double>(MovingVector<double>(foot * still<double>(legs[i].heel)));
        const bool at_rest = state.hold == held[i] && state.at_rest();
        const Vec3<double> pivot = state.hold == FootHold::kHeel ? heel : toe;
        if (at_rest && !rested[i]) rest[i] = pivot;
        if (at_rest) {
          slide = std::max(slide, (pivot - rest[i]).norm());
          depth = std::max(depth, height_at(pivot.x()) - pivot.z());
          ++settled;
        }
        rested[i] = at_rest;
      }
    }
    std::printf(
        "%3.0f Hz: bearing feet slide %.3f mm, are %.2f mm deep; the root is within %.0f cm of its height, "
        "hips never below %.2f m\n",
        rate, 1e3 * slide, 1e3 * depth, 100 * deviation, lowest);
    EXPECT_GT(GraphParameters<double>(graph, player.state).place().x(), 9);
    EXPECT_GT(settled, int(2 * rate));
    EXPECT_LT(slide, 1e-4) << "m, as of FootPlacementJob";
    EXPECT_LT(depth, 2e-3) << "m, in the ground";
    EXPECT_LT(deviation, 0.2) << "m: a stair and a little, of what rises under the character";
    EXPECT_GT(lowest, 0.6) << "m, of the hips over the ground: no crouching";
  }
}

TEST_F(GraphGrounds, AGameMayLiftTheCharacterItself) {
  Graph lifted;
  fixtures::bind_graph(R"({"parameters": {"ground": {"value": 2, "filter": 0.1}},
    "graph": {"feet": "walk", "level": "ground", "lock": false}})",
                       asset, lifted);
  Graph plain;
  fixtures::bind_graph(R"({"graph": "walk"})", asset, plain);
  GraphPlayer<double> a(lifted), b(plain);
  for (int k = 0; k < 60; ++k) {
    a.step(k ? 1 / 60.0 : 0);
    b.step(k ? 1 / 60.0 : 0);
    // 1.1 cm is what the pelvis comes down by on the flat.
    EXPECT_NEAR(a.jets[0].translation.z() - b.jets[0].translation.z(), 2, 0.015);
    EXPECT_LT((a.jets[0].translation - b.jets[0].translation).head<2>().norm(), 1e-9) << "not locked";
  }
}

TEST_F(GraphGrounds, ASnapshotGoesOnToTheBit) {
  GraphPlayer<float> player(graph), other(graph);
  player.ground.below = other.ground.below = below<float>;
  std::mt19937 random(3);
  for (int k = 0; k < 300; ++k) {
    if (k % 20 == 7) ask_at_random(player, random);
    player.step(k ? 1 / 60.0 : 0);
  }
  other.state = player.state;
  const std::mt19937 same = random;
  for (GraphPlayer<float>* p : {&player, &other}) {
    random = same;
    for (int k = 0; k < 300; ++k) {
      if (k % 20 == 7) ask_at_random(*p, random);
      p->step(1 / 60.0);
    }
  }
  EXPECT_EQ(std::memcmp(player.state.data(), other.state.data(), player.state.size()), 0);
  for (std::size_t j = 0; j < player.jets.size(); ++j) {
    EXPECT_EQ(player.jets[j].rotation.coeffs(), other.jets[j].rotation.coeffs());
    EXPECT_EQ(player.jets[j].alpha, other.jets[j].alpha);
  }
}

TEST_F(GraphGrounds, AllocatesNothing) {
  GraphPlayer<float> player(graph);
  player.ground.below = below<float>;
  player.step(0);
  player.set("speed", 1.275);
  const long start = fixtures::allocations;
  for (int k = 0; k < 300; ++k) player.step(1 / 60.0);
  EXPECT_EQ(fixtures::allocations - start, 0);
}

TEST_F(GraphGrounds, SharesAddUpToTheAcceleration) {
  GraphPlayer<float> player(graph);
  player.ground.below = below<float>;
  player.step(0);
  player.set("speed", 1.275);
  player.set("y", 2);
  bool feet = false, look = false;
  for (int k = 0; k < 300; ++k) {
    const int joint = 1 + k % (graph.joint_count() - 1);
    graph_tools::Attribution attribution(graph, player.scratch, joint);
    GraphStepJob<float> job{&graph, player.state, 1 / 60.f, &player.scratch, player.jets};
    job.watch = attribution.watch();
    job.ground = player.ground;
    ASSERT_TRUE(job.Run().ok());
    Vec3<float> sum = Vec3<float>::Zero();
    for (const graph_tools::AccelerationShare& share : attribution.shares()) {
      sum += share.alpha;
      const NodeType type = graph.node(share.node).type;
      feet |= type == NodeType::kFeet && share.alpha.norm() > 1;
      look |= type == NodeType::kLook && share.alpha.norm() > 1;
    }
    EXPECT_LT((sum - player.jets[std::size_t(joint)].alpha).norm(), 1e-3 * (1 + sum.norm())) << k;
  }
  EXPECT_TRUE(feet);
  EXPECT_TRUE(look);
}

// A look at a point of the world: the head's axis goes through it.
TEST_F(GraphGrounds, ALookMeetsItsTarget) {
  Graph looks;
  fixtures::bind_graph(R"({"parameters": {"x": {"value": 2, "filter": 0.1}, "y": 1, "z": 1.4}, "graph":
    {"look": "stand", "at": ["x", "y", "z"], "joints": [["chest", 1], ["neck", 1], ["head", 2]]}})",
                       asset, looks);
  GraphPlayer<double> player(looks);
  player.step(0);
  for (int k = 0; k < 120; ++k) {
    if (k == 60) player.set("y", -1.2);
    player.step(1 / 60.0);
    GraphParameters<double> parameters(looks, player.state);
    const LookChain<double>& chain = looks.looks()[0].chain<double>();
    const MovingTransform<double> head =
        model_motion<double>(player.jets, looks.parents(), chain.joints[chain.count - 1]);
    Vec3<double> target;
    int axis = 0;
    for (const char* name : {"x", "y", "z"})
      target[axis++] = parameters.filtered(looks.definition().find_parameter(name)).value;
    const Vec3<double> way = (target - value_of<double>(head.translation)).normalized();
    const Vec3<double> sight =
        value_of<double>(MovingVector<double>(head.rotation * still<double>(chain.axis)));
    EXPECT_LT((sight - way).norm(), 1e-6) << k;
  }
}

// A target in the eyes is one status, and the pose is there without the look.
TEST_F(GraphGrounds, ALookThatFailsLeavesThePose) {
  Graph looks, plain;
  fixtures::bind_graph(R"({"parameters": {"x": {"filter": 0}, "y": {"filter": 0}, "z": {"filter": 0}},
    "graph": {"look": "stand", "at": ["x", "y", "z"], "half_life": 0.1}})",
                       asset, looks);
  fixtures::bind_graph(R"({"graph": "stand"})", asset, plain);
  GraphPlayer<double> a(looks), b(plain);
  b.step(0);
  const LookChain<double>& chain = looks.looks()[0].chain<double>();
  const Vec3<double> eyes = value_of<double>(
      model_motion<double>(b.jets, plain.parents(), chain.joints[chain.count - 1]).translation);
  a.set("x", eyes.x());
  a.set("y", eyes.y());
  a.set("z", eyes.z());
  const Status status = GraphStepJob<double>{&looks, a.state, 0, &a.scratch, a.jets}.Run();
  ASSERT_FALSE(status.ok());
  EXPECT_STREQ(looks.node(status.index).name.c_str(), "graph");
  for (std::size_t j = 0; j < a.jets.size(); ++j)
    EXPECT_LT((a.jets[j].rotation.coeffs() - b.jets[j].rotation.coeffs()).norm(), 1e-9);
}

// Controller and mixed modes: velocity and acceleration belong to the path that comes out.
TEST_F(GraphGrounds, TravelGoesAsParametersSay) {
  Graph steered;
  fixtures::bind_graph(
      R"({"parameters": {"forward": {"filter": 0.2}, "turn": {"filter": 0.2}, "share": {"value": 1, "filter": 0.2}},
    "graph": {"travel": "walk", "forward": "forward", "turn": "turn", "weight": "share"}})",
      asset, steered);
  GraphPlayer<double> player(steered);
  player.step(0);
  player.set("forward", 2);
  player.set("turn", 1);
  constexpr double h = 1e-3;
  std::vector<JointJet<double>> poses[3];
  double velocity = 0, acceleration = 0;
  for (int k = 0; k < 3000; ++k) {
    if (k == 2000) player.set("share", 0);
    player.step(h);
    poses[k % 3] = player.jets;
    if (k < 2) continue;
    const JointJet<double>&a = poses[(k - 2) % 3][0], &b = poses[(k - 1) % 3][0], &c = poses[k % 3][0];
    velocity = std::max(velocity, ((c.translation - a.translation) / (2 * h) - b.velocity).norm());
    acceleration =
        std::max(acceleration,
                 ((c.translation - 2 * b.translation + a.translation) / (h * h) - b.acceleration).norm());
    if (k == 1999) {
      EXPECT_NEAR(GraphParameters<double>(steered, player.state).travel().velocity[0], 2, 1e-6);
      EXPECT_NEAR(GraphParameters<double>(steered, player.state).travel().velocity[2], 1, 1e-6);
    }
  }
  EXPECT_LT(velocity, 1e-3) << "m/s: h²/6 of the third derivative";
  EXPECT_LT(acceleration, 0.05) << "m/s²: the clip's spline has knots";
  const Clip& walk = asset.clips[std::size_t(asset.find_clip("walk"))];
  EXPECT_NEAR(GraphParameters<double>(steered, player.state).travel().velocity[0],
              double(walk.root_step.x() / walk.duration), 0.02)
      << "the clip's own again, half a second after that was asked for";
}

// What the certificate says of feet and looks is lost, is.
TEST_F(GraphGrounds, WhatTheCertificateNamesDoesJump) {
  struct Case {
    const char* json;
    const char* named;
  };
  const Case cases[] = {
      {R"({"parameters": {"go": {"value": 1, "filter": 0}, "x": 2, "y": 2, "z": 1}, "graph": {"look": "stand", "at": ["x", "y", "z"], "weight": "go"}})",
       "is the weight of a look"},
      {R"({"parameters": {"go": {"value": 1, "filter": 0}, "y": 2, "z": 1}, "graph": {"look": "stand", "at": ["go", "y", "z"]}})",
       "is a target's place"},
      {R"({"parameters": {"go": {"value": 1, "filter": 0}}, "graph": {"feet": "stand", "level": "go"}})",
       "is the height of the ground"},
      {R"({"parameters": {"go": {"value": 1, "filter": 0}}, "graph": {"travel": "stand", "turn": "go"}})",
       "is a velocity over the ground"}};
  for (const Case& c : cases) {
    SCOPED_TRACE(c.named);
    Graph lossy;
    fixtures::bind_graph(c.json, asset, lossy);
    const auto losses = graph_tools::smoothness_losses(lossy.definition());
    ASSERT_EQ(losses.size(), 1u);
    EXPECT_NE(losses[0].reason.find(c.named), std::string::npos) << losses[0].reason;
    GraphPlayer<double> player(lossy);
    player.step(0);
    for (int k = 0; k < 20; ++k) player.step(1 / 60.0);
    const auto before = player.jets;
    player.set("go", 0);
    player.step(0);
    Jump jump;
    jump.add(before, player.jets);
    EXPECT_EQ(jump.pose > 1e-3, losses[0].order < 0);
    EXPECT_TRUE(jump.pose > 1e-3 || jump.velocity > 1e-3);
  }
}

TEST_F(GraphGrounds, TenThousandDamagedFilesAreRefusedOrHarmless) {
  const std::vector<std::uint8_t> bytes = write_graph(graph.definition());
  std::mt19937 random(5);
  int read = 0, played = 0;
  for (int k = 0; k < 10'000; ++k) {
    std::vector<std::uint8_t> damaged = bytes;
    for (int n = 0; n <= k % 3; ++n) damaged[random() % damaged.size()] = static_cast<std::uint8_t>(random());
    GraphDefinition definition;
    if (!read_graph(damaged, definition)) continue;
    Graph bound;
    if (++read % 10 != 0 || !Graph::bind(definition, asset, bound)) continue;
    ++played;
    GraphPlayer<float> player(bound);
    for (int frame = 0; frame < 10; ++frame) {
      GraphStepJob<float> job{&bound, player.state, 0.02f, &player.scratch, player.jets};
      job.physical = player.physical;
      job.ground.below = below<float>;
      (void)job.Run();
    }
  }
  EXPECT_GT(read, 300);
  EXPECT_GT(played, 20);
}

}  // namespace
}  // namespace sinew
