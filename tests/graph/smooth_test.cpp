// Poses, velocities and accelerations of a graph: they belong together, and nothing that a game does makes
// them jump.
#include <cmath>

#include "graph/certificate.h"
#include "graph_fixture.h"

namespace sinew {
namespace {

using fixtures::GraphPlayer;

double angle_between(const Quat<double>& a, const Quat<double>& b) {
  return 2 * (a.conjugate() * b).vec().norm();
}

struct Jump {
  double pose = 0, velocity = 0, acceleration = 0;  ///< rad and m, and their rates
};

Jump between(const std::vector<JointJet<double>>& a, const std::vector<JointJet<double>>& b) {
  Jump jump;
  for (std::size_t j = 0; j < a.size(); ++j) {
    jump.pose = std::max({jump.pose, angle_between(a[j].rotation, b[j].rotation),
                          (a[j].translation - b[j].translation).norm()});
    jump.velocity =
        std::max({jump.velocity, (a[j].omega - b[j].omega).norm(), (a[j].velocity - b[j].velocity).norm()});
    jump.acceleration = std::max({jump.acceleration, (a[j].alpha - b[j].alpha).norm(),
                                  (a[j].acceleration - b[j].acceleration).norm()});
  }
  return jump;
}

/// Sets random inputs as a game would.
template <class Player>
void play_at_random(Player& player, std::mt19937& random) {
  std::uniform_real_distribution<double> uniform(0, 1);
  switch (std::uniform_int_distribution<int>(0, 7)(random)) {
    case 0:
      return player.set("speed", 4 * uniform(random));
    case 1:
      return player.set("pace", 0.3 + 1.5 * uniform(random));
    case 2:
      return player.set("side", 4 * uniform(random));
    case 3:
      return player.set("lean", uniform(random) < 0.5 ? 0 : 1);
    case 4:
      return player.set("wave", uniform(random) < 0.5 ? 0 : 1);
    case 5:
      return player.trigger("hit");
    case 6:
      return player.trigger("rise");
    default:
      return player.trigger("dead");
  }
}

// What changes at an instant does so within a frame of no length: the pose before it and after it.
TEST(Graph, NothingThatAGameSetsMakesAPoseVelocityOrAccelerationJump) {
  const Asset asset = fixtures::graph_asset();
  Graph graph;
  fixtures::bind_graph(fixtures::kSmoothGraph, asset, graph);
  ASSERT_TRUE(graph_tools::smoothness_losses(graph.definition()).empty());
  GraphPlayer<double> player(graph);
  std::mt19937 random(7);
  player.step(0);
  Jump worst;
  int changes = 0;
  for (int k = 0; k < 4000; ++k) {
    player.step(std::uniform_real_distribution<double>(1e-3, 0.04)(random));
    const auto before = player.jets;
    const std::string was = player.in("graph/0") + player.in("graph/1");
    if (k % 3 == 0) play_at_random(player, random);
    player.step(0);
    changes += was != player.in("graph/0") + player.in("graph/1");
    const Jump jump = between(before, player.jets);
    worst.pose = std::max(worst.pose, jump.pose);
    worst.velocity = std::max(worst.velocity, jump.velocity);
    worst.acceleration = std::max(worst.acceleration, jump.acceleration);
  }
  EXPECT_GT(changes, 300);
  // Rounding, of accelerations of up to some hundred rad/s².
  EXPECT_LT(worst.pose, 1e-6);
  EXPECT_LT(worst.velocity, 1e-6);
  EXPECT_LT(worst.acceleration, 1e-6);
}

// In single precision transitions begin with 16-bit shares of the greatest offset (graph_keep.h). What that
// makes jump: at most 1/65534 of each kind of offset, a turn four times its parameter, and what turning axes
// by it changes; offsets reach half a turn, some 30 rad/s and 1000 rad/s² here.
TEST(Graph, InSinglePrecisionWhatTransitionsKeepIsOffByRoundingAlone) {
  const Asset asset = fixtures::graph_asset();
  Graph graph;
  fixtures::bind_graph(fixtures::kSmoothGraph, asset, graph);
  GraphPlayer<float> player(graph);
  std::mt19937 random(7);
  player.step(0);
  Jump worst;
  const auto doubles = [](const std::vector<JointJet<float>>& jets) {
    std::vector<JointJet<double>> out(jets.size());
    for (std::size_t j = 0; j < jets.size(); ++j)
      out[j] = {jets[j].rotation.cast<double>(), jets[j].omega.cast<double>(),
                jets[j].alpha.cast<double>(),    jets[j].translation.cast<double>(),
                jets[j].velocity.cast<double>(), jets[j].acceleration.cast<double>()};
    return out;
  };
  for (int k = 0; k < 4000; ++k) {
    player.step(std::uniform_real_distribution<double>(1e-3, 0.04)(random));
    const auto before = doubles(player.jets);
    if (k % 3 == 0) play_at_random(player, random);
    player.step(0);
    const Jump jump = between(before, doubles(player.jets));
    worst.pose = std::max(worst.pose, jump.pose);
    worst.velocity = std::max(worst.velocity, jump.velocity);
    worst.acceleration = std::max(worst.acceleration, jump.acceleration);
  }
  EXPECT_LT(worst.pose, 1e-4) << "rad, m";
  EXPECT_LT(worst.velocity, 5e-3) << "rad/s, m/s";
  EXPECT_LT(worst.acceleration, 0.1) << "rad/s²: a ten-thousandth of what motions have";
  RecordProperty("acceleration", std::to_string(worst.acceleration));
  std::printf("jumps: %.1e rad, %.1e rad/s, %.1e rad/s2\n", worst.pose, worst.velocity, worst.acceleration);
}

/// Derivatives of five poses that are h apart, at the middle one.
struct Differences {
  Vec3<double> omega, alpha, velocity, acceleration;
};
Differences differences(const JointJet<double>* const at[5], double h) {
  const Quat<double> mid = at[2]->rotation;
  Vec3<double> turn[5];
  for (int k = 0; k < 5; ++k) {
    Quat<double> q = mid.conjugate() * at[k]->rotation;
    if (q.w() < 0) q.coeffs() *= -1;
    turn[k] = q.vec().norm() < 1e-12
                  ? Vec3<double>(2 * q.vec())
                  : Vec3<double>(2 * std::atan2(q.vec().norm(), q.w()) * q.vec().normalized());
  }
  const auto first = [&](const Vec3<double>& a, const Vec3<double>& b, const Vec3<double>& d,
                         const Vec3<double>& e) { return Vec3<double>((a - 8 * b + 8 * d - e) / (12 * h)); };
  const auto second = [&](const Vec3<double>& a, const Vec3<double>& b, const Vec3<double>& c,
                          const Vec3<double>& d, const Vec3<double>& e) {
    return Vec3<double>((-a + 16 * b - 30 * c + 16 * d - e) / (12 * h * h));
  };
  const auto& x = at;
  return {
      first(turn[0], turn[1], turn[3], turn[4]), second(turn[0], turn[1], turn[2], turn[3], turn[4]),
      first(x[0]->translation, x[1]->translation, x[3]->translation, x[4]->translation),
      second(x[0]->translation, x[1]->translation, x[2]->translation, x[3]->translation, x[4]->translation)};
}

TEST(Graph, JetsAreTheDerivativesOfThePoses) {
  const Asset asset = fixtures::graph_asset();
  Graph graph;
  fixtures::bind_graph(fixtures::kSmoothGraph, asset, graph);
  GraphPlayer<double> player(graph);
  std::mt19937 random(3);
  player.step(0);
  constexpr double h = 2e-4;  // a blend's weights bend within some milliseconds where its parameter is fast
  double velocity = 0, acceleration = 0, scale = 0;
  int compared = 0;
  for (int round = 0; round < 300; ++round) {
    play_at_random(player, random);
    // The change itself is behind.
    player.step(std::uniform_real_distribution<double>(0, 0.15)(random));
    for (int k = 0; k < 5; ++k) player.step(h);
    std::vector<JointJet<double>> poses[5];
    bool same = true;
    std::string was;
    for (auto& pose : poses) {
      player.step(h);
      pose = player.jets;
      // Between two frames at which something begins or ends there is no derivative of fifth order.
      std::string now = player.in("graph/0") + player.in("graph/1");
      for (const Graph::BoundMachine& m : graph.machines())
        now += std::to_string(GraphParameters<double>(graph, player.state).fading(m.node));
      same &= was.empty() || was == now;
      was = now;
    }
    if (!same) continue;
    ++compared;
    for (std::size_t j = 0; j < player.jets.size(); ++j) {
      const JointJet<double>* at[5];
      for (int k = 0; k < 5; ++k) at[k] = &poses[k][j];
      const Differences d = differences(at, h);
      const JointJet<double>& jet = poses[2][j];
      velocity = std::max({velocity, (d.omega - jet.omega).norm(), (d.velocity - jet.velocity).norm()});
      acceleration =
          std::max({acceleration, (d.alpha - jet.alpha).norm(), (d.acceleration - jet.acceleration).norm()});
      scale = std::max(scale, jet.alpha.norm());
    }
  }
  EXPECT_GT(compared, 200);
  EXPECT_GT(scale, 50);
  // Splines of blends and clips have knots, across which a difference of fourth order sees the jump of the
  // third derivative: h times that.
  EXPECT_LT(velocity, 1e-3);
  EXPECT_LT(acceleration, 0.01 * scale);
}

// What the certificate says is lost, is: the pose or the velocity does jump there.
TEST(Graph, WhatTheCertificateNamesDoesJump) {
  struct Case {
    const char* json;
    const char* named;
    bool pose;  ///< or the velocity
  };
  const Case cases[] = {
      {R"({"parameters": {"go": false}, "graph": {"states": {"a": "idle", "b": "hit"},
           "transitions": [{"from": "a", "to": "b", "if": "go", "kind": "cut"}]}})",
       "cuts", true},
      {R"({"parameters": {"go": false}, "graph": {"states": {"a": "idle", "b": "hit"},
           "transitions": [{"from": "a", "to": "b", "if": "go", "duration": 0}]}})",
       "takes no time", true},
      {R"({"parameters": {"go": {"filter": 0}}, "graph": {"blend": "go", "points": [[0, "idle"], [1, "hit"]]}})",
       "not filtered and moves a blend", true},
      {R"({"parameters": {"go": {"filter": 0}}, "graph": {"layers": ["idle", {"node": "hit", "weight": "go"}]}})",
       "is the weight of a layer", true},
      {R"({"parameters": {"go": {"filter": 0}}, "graph": {"clip": "idle", "speed": "go"}})",
       "is the speed of clip", false},
      {R"({"parameters": {"go": false}, "graph": {"layers": [
           {"states": {"a": {"clip": "walk", "sync": "feet"}, "b": {"clip": "run", "sync": "feet"}},
            "transitions": [{"from": "a", "to": "b", "if": "go"}]},
           {"node": {"clip": "walk", "sync": "feet"}, "mask": "upper", "weight": 0.5}]}})",
       "whose pace jumps", false}};
  const Asset asset = fixtures::graph_asset();
  for (const Case& c : cases) {
    SCOPED_TRACE(c.named);
    Graph graph;
    fixtures::bind_graph(c.json, asset, graph);
    const auto losses = graph_tools::smoothness_losses(graph.definition());
    ASSERT_EQ(losses.size(), 1u);
    EXPECT_NE(losses[0].reason.find(c.named), std::string::npos) << losses[0].reason;
    EXPECT_EQ(losses[0].order, c.pose ? -1 : 0);
    GraphPlayer<double> player(graph);
    player.step(0);
    for (int k = 0; k < 20; ++k) player.step(1 / 60.0);
    const auto before = player.jets;
    player.set("go", 1);
    player.step(0);
    const Jump jump = between(before, player.jets);
    EXPECT_EQ(jump.pose > 1e-3, c.pose);
    EXPECT_GT(jump.velocity, 1e-3);
  }
}

// A transition with a budget takes as long as the weakest joint needs, no longer than it may, and adds to no
// joint more than the budget allows.
TEST(Graph, TransitionsAreAsFastAsMusclesAllow) {
  const Asset asset = fixtures::graph_asset();
  Graph graph;
  fixtures::bind_graph(R"({"parameters": {"go": false}, "graph": {"states": {"a": "idle", "b": "lean"},
    "transitions": [{"from": "a", "to": "b", "if": "go", "budget": 0.5, "duration": 0.6}]}})",
                       asset, graph);
  const auto duration = [&](double spare) {
    GraphPlayer<double> player(graph);
    std::vector<double> budgets(fixtures::kGraphJoints, 0.5 * spare);
    const auto muscles = [](void* host, const FadeQuestion<double>& question) {
      const auto& each = *static_cast<std::vector<double>*>(host);
      return inertial_duration<double>(*question.offset, each, question.least, question.most);
    };
    const auto frame = [&](double h) {
      GraphStepJob<double> job{&graph, player.state, h, &player.scratch, player.jets};
      job.muscles = {muscles, &budgets};
      ASSERT_TRUE(job.Run().ok());
    };
    frame(0);
    for (int k = 0; k < 10; ++k) frame(1 / 60.0);
    player.set("go", 1);
    frame(1e-3);
    const GraphMachineState<double> m = GraphBlock<double>(graph, player.state).machine(0);
    EXPECT_GT(m.duration, 0);
    double most = 0;  // what the offset adds, beyond what it began with
    std::vector<JointJet<double>> clip(fixtures::kGraphJoints);
    const auto added = [&](double t, std::size_t j) {
      EXPECT_TRUE((SamplingJob<double>{&asset.clips[5], t, clip}.Run().ok()));
      return (player.jets[j].alpha - clip[j].alpha).norm();
    };
    std::vector<double> begin;
    for (std::size_t j = 1; j < clip.size(); ++j) begin.push_back(added(1e-3, j));
    for (double t = 1e-3; t < m.duration; t += 2e-3) {
      for (std::size_t j = 1; j < clip.size(); ++j) most = std::max(most, added(t, j) - begin[j - 1]);
      frame(2e-3);
    }
    // Where it is not cut off at 0.6 s. ω of the clip turns with the offset: a tenth more.
    if (m.duration < 0.599) {
      EXPECT_LT(most, 1.1 * 0.5 * spare + 30) << spare;
    }
    return m.duration;
  };
  const double strong = duration(5000), usual = duration(800), weak = duration(20);
  EXPECT_LT(strong, 0.8 * usual);
  EXPECT_LT(usual, 0.6);
  EXPECT_NEAR(weak, 0.6, 1e-6) << "as long as it may";
  EXPECT_NEAR(duration(1e6), 0.08, 1e-6) << "the shortest that there is";
}

// Joints of a profile's mask are done sooner, by their weights; the others take the whole duration.
TEST(Graph, JointsOfAProfileAreDoneSooner) {
  const Asset asset = fixtures::graph_asset();
  Graph graph;
  fixtures::bind_graph(R"({"parameters": {"go": false}, "graph": {"states": {"a": "idle", "b": "lean"},
    "transitions": [{"from": "a", "to": "b", "if": "go", "duration": 0.4, "profile": "upper", "share": 0.5}]}})",
                       asset, graph);
  GraphPlayer<double> player(graph);
  player.step(0);
  for (int k = 0; k < 10; ++k) player.step(1 / 60.0);
  player.set("go", 1);
  std::vector<JointJet<double>> clip(fixtures::kGraphJoints);
  std::vector<double> done(fixtures::kGraphJoints, 0);
  for (double t = 0.01; t < 0.45; t += 0.01) {
    player.step(0.01);
    ASSERT_TRUE((SamplingJob<double>{&asset.clips[5], t, clip}.Run().ok()));
    for (std::size_t j = 1; j < clip.size(); ++j)
      if (angle_between(clip[j].rotation, player.jets[j].rotation) > 1e-9) done[j] = t + 0.01;
  }
  for (std::size_t j = 1; j < clip.size(); ++j) {
    const double weight = double(asset.masks[0].weights[j]) / 255;
    EXPECT_NEAR(done[j], 0.4 * (1 - 0.5 * weight), 0.0101) << j;
  }
}

// A one-shot whose end no transition forestalls comes to rest there, and does not stop dead.
TEST(Graph, AClipThatEndsSlowsDownBeforeItHolds) {
  const Asset asset = fixtures::graph_asset();
  Graph graph;
  fixtures::bind_graph(R"({"graph": "hit"})", asset, graph);
  GraphPlayer<double> player(graph);
  player.step(0);
  auto before = player.jets;
  for (double t = 0; t < 1.4; t += 1e-3) {
    player.step(1e-3);
    // A jump of the velocity would be seen whatever the frame; a change at 500 rad/s² is 0.5 here.
    EXPECT_LT(between(before, player.jets).velocity, 0.5) << t;
    before = player.jets;
  }
  std::vector<JointJet<double>> end(fixtures::kGraphJoints);
  ASSERT_TRUE((SamplingJob<double>{&asset.clips[3], 1.0, end}.Run().ok()));
  for (std::size_t j = 1; j < end.size(); ++j) {
    EXPECT_LT(angle_between(end[j].rotation, player.jets[j].rotation), 1e-6);
    EXPECT_EQ(player.jets[j].omega.norm(), 0);
  }
}

}  // namespace
}  // namespace sinew
