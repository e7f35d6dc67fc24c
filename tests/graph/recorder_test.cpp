// The last frames of a graph come again, to the bit, also out of a world's snapshot and recording.
#include <gtest/gtest.h>

#include <cstdio>
#include <cstring>

#include "fixtures/counting_new.h"
#include "fixtures/paths.h"
#include "graph/dump.h"
#include "graph_fixture.h"
#include "sinew/character/recording.h"
#include "sinew/graph/graph_recorder.h"

namespace sinew {
namespace {

using fixtures::GraphPlayer;

constexpr const char* kHero = R"({
  "parameters": {"speed": {"value": 0, "filter": 0.2}, "go": "trigger", "limp": false},
  "graph": {"feet": {"states": {
     "move": {"blend": "speed", "sync": "feet", "points": [[0, {"clip": "stand", "sync": null}], [1.275, "walk"], [3.215, "run"]]},
     "rise": "get_up_supine", "limp": {"physical": true}},
    "transitions": [{"from": "*", "to": "limp", "if": "limp"}, {"from": "limp", "to": "move", "if": "!limp", "kind": "dead"},
      {"from": "move", "to": "rise", "if": "go", "budget": 0.5}, {"from": "rise", "to": "move", "if": "go", "kind": "crossfade"}]}}
})";

template <class T>
bool slope(const void*, const Vec3<T>& point, GroundHit<T>& hit) {
  hit.point = {point.x(), point.y(), T(0.1) * point.x()};
  hit.normal = Vec3<T>(T(-0.1), T(0), T(1)).normalized();
  return point.x() < T(4);
}

class GraphRecorders : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    ASSERT_TRUE(load_asset((binary_dir() + "/sample.sinew").c_str(), asset).ok());
    fixtures::bind_graph(kHero, asset, graph);
  }
  inline static Asset asset;
  inline static Graph graph;
};

/// Plays with everything that a game gives.
template <class T>
struct Hero : GraphPlayer<T> {
  std::vector<T> budgets = std::vector<T>(std::size_t(this->graph.joint_count()), T(150));
  using GraphPlayer<T>::GraphPlayer;

  GraphStepJob<T> job(int k) {
    if (k % 50 == 10) this->set("speed", k % 3);
    if (k % 70 == 30) this->trigger("go");
    if (k % 200 == 120 || k % 200 == 150) this->set("limp", k % 200 == 120);
    for (std::size_t j = 0; j < this->jets.size(); ++j) this->physical[j] = this->jets[j];
    GraphStepJob<T> job{&this->graph, this->state, T(k ? 1 / 60.0 : 0), &this->scratch, this->jets};
    job.physical = this->physical;
    job.muscles.host = &budgets;
    job.muscles.duration = [](void* host, const FadeQuestion<T>& question) {
      return inertial_duration<T>(*question.offset, *static_cast<std::vector<T>*>(host), question.least,
                                  question.most);
    };
    job.ground.below = slope<T>;
    return job;
  }
};

template <class T>
void expect_same_frames(const Graph& graph, std::span<const std::byte> ring, int wanted) {
  GraphReplay<T> replay(graph, ring);
  ASSERT_TRUE(replay.Validate().ok()) << replay.Validate().reason;
  ASSERT_GE(replay.count(), wanted);
  GraphPlayer<T> other(graph);
  std::uint64_t number = replay.info(0).number;
  for (int k = 0; k < replay.count(); ++k) {
    EXPECT_EQ(replay.info(k).number, number++);
    bool same = false;
    const Status status = replay.frame(k, other.scratch, other.state, other.jets, same);
    EXPECT_TRUE(status.ok()) << status.reason;
    EXPECT_TRUE(same) << k;
  }
}

template <class T>
void record_and_repeat(const Graph& graph) {
  std::vector<std::byte> ring(GraphRecorder<T>::bytes_for(graph, 60));
  GraphRecorder<T> recorder(graph, ring);
  Hero<T> hero(graph);
  const long start = fixtures::allocations;
  for (int k = 0; k < 40; ++k) ASSERT_TRUE(recorder.step(hero.job(k)).ok());
  EXPECT_EQ(fixtures::allocations - start, 0);
  expect_same_frames<T>(graph, ring, 40);
  for (int k = 40; k < 420; ++k) {
    const Status status = recorder.step(hero.job(k));
    ASSERT_TRUE(status.ok()) << status.reason;
    if (k % 60 == 59) expect_same_frames<T>(graph, ring, 10);  // limp frames are large ones
  }
}
TEST_F(GraphRecorders, FramesComeAgainToTheBit) {
  record_and_repeat<float>(graph);
  record_and_repeat<double>(graph);
}

// Any frame comes alone, in any order, from the whole block before it.
TEST_F(GraphRecorders, FramesComeInAnyOrder) {
  std::vector<std::byte> ring(GraphRecorder<float>::bytes_for(graph, 300));
  GraphRecorder<float> recorder(graph, ring);
  Hero<float> hero(graph);
  std::vector<std::vector<std::byte>> blocks, ends;
  for (int k = 0; k < 300; ++k) {
    const GraphStepJob<float> job = hero.job(k);
    blocks.push_back(hero.state);
    ASSERT_TRUE(recorder.step(job).ok());
    ends.push_back(hero.state);
  }
  GraphReplay<float> replay(graph, ring);
  ASSERT_GE(replay.count(), 150) << "limp frames are large ones";
  GraphPlayer<float> other(graph);
  std::mt19937 random(4);
  for (int n = 0; n < 60; ++n) {
    const int k = static_cast<int>(random() % static_cast<unsigned>(replay.count()));
    const std::size_t number = replay.info(k).number;
    if (n % 2) {
      ASSERT_TRUE(replay.before(k, other.scratch, other.state, other.jets).ok());
      ASSERT_EQ(other.state, blocks[number]);
    }
    bool same = false;
    ASSERT_TRUE(replay.frame(k, other.scratch, other.state, other.jets, same).ok());
    ASSERT_TRUE(same) << number;
    ASSERT_EQ(other.state, ends[number]);
    ASSERT_EQ(replay.rays().size(), replay.info(k).rays);
  }
}

TEST_F(GraphRecorders, AChangedFrameIsFound) {
  std::vector<std::byte> ring(GraphRecorder<float>::bytes_for(graph, 8));
  GraphRecorder<float> recorder(graph, ring);
  Hero<float> hero(graph);
  const float asked = 1.2345678f, changed = 1.2345679f;
  for (int k = 0; k < 8; ++k) {
    if (k == 5) hero.set("speed", double(asked));
    const GraphStepJob<float> job = hero.job(k);
    ASSERT_TRUE(recorder.step(job).ok());
  }
  // In the frame in which the game set it.
  const int at = GraphReplay<float>(graph, ring).count() - 3;
  std::vector<std::byte> needle(sizeof asked);
  std::memcpy(needle.data(), &asked, sizeof asked);
  const auto pages =
      ring.begin() + static_cast<std::ptrdiff_t>(hero.state.size() + 64);  // behind the last block
  const auto found = std::search(pages, ring.end(), needle.begin(), needle.end());
  ASSERT_NE(found, ring.end());
  std::memcpy(&*found, &changed, sizeof changed);
  GraphReplay<float> replay(graph, ring);
  GraphPlayer<float> other(graph);
  for (int k = 0; k < replay.count(); ++k) {
    bool same = true;
    EXPECT_TRUE(replay.frame(k, other.scratch, other.state, other.jets, same).ok());
    if (k <= at) {
      EXPECT_EQ(same, k != at) << k;
    }
  }
}

// Ten minutes at 60 Hz: what they take, and that they come again.
TEST_F(GraphRecorders, TenMinutesComeAgainToTheBitAtSomeHundredBytesAFrame) {
  const Asset small = fixtures::graph_asset();
  Graph played;
  fixtures::bind_graph(fixtures::kSmoothGraph, small, played);
  constexpr int kFrames = 36000;
  GraphMemory ring(GraphRecorder<float>::bytes_for(played, kFrames));
  GraphRecorder<float> recorder(played, ring);
  GraphPlayer<float> player(played);
  std::mt19937 random(6);
  const char* floats[] = {"speed", "pace", "side", "lean"};
  const char* triggers[] = {"hit", "rise", "dead"};
  for (int k = 0; k < kFrames; ++k) {
    player.set("speed", double(random() % 300) / 100);  // as a stick, in every frame
    if (random() % 10 == 0) player.set(floats[1 + random() % 3], double(random() % 200) / 100);
    if (random() % 60 == 0) player.trigger(triggers[random() % 3]);
    const GraphStepJob<float> job{&played, player.state, 1 / 60.f, &player.scratch, player.jets};
    ASSERT_TRUE(recorder.step(job).ok());
  }
  GraphReplay<float> replay(played, ring);
  ASSERT_GE(replay.count(), kFrames);
  GraphPlayer<float> other(played);
  std::size_t bytes = 0;
  for (int k = 0; k < replay.count(); ++k) {
    bytes += replay.info(k).bytes;
    bool same = false;
    ASSERT_TRUE(replay.frame(k, other.scratch, other.state, other.jets, same).ok());
    ASSERT_TRUE(same) << k;
  }
  const double each = double(bytes) / kFrames;
  std::printf("%.1f bytes a frame with its share of whole blocks; the block has %zu\n", each,
              player.state.size());
  EXPECT_LT(each, 64);
  EXPECT_EQ(other.state, player.state);
}

// The duration that muscles were asked for is what went in, not how they answered it.
TEST_F(GraphRecorders, DurationsThatMusclesGaveComeAgain) {
  std::vector<std::byte> ring(GraphRecorder<float>::bytes_for(graph, 120));
  GraphRecorder<float> recorder(graph, ring);
  Hero<float> hero(graph);
  int asked = 0;
  for (int k = 0; k < 110; ++k) {
    GraphStepJob<float> job = hero.job(k);
    job.muscles.host = &asked;
    job.muscles.duration = [](void* host, const FadeQuestion<float>& question) {
      EXPECT_EQ(question.destination.size(), asset.skeleton.joints.size());
      EXPECT_GT(question.destination[0].translation.z(), 0.1f) << "the root in the world";
      return question.least + 0.05f * float(++*static_cast<int*>(host));
    };
    ASSERT_TRUE(recorder.step(job).ok());
  }
  EXPECT_EQ(asked, 1);
  expect_same_frames<float>(graph, ring, 110);
}

// The ring is part of the world's state: a snapshot brings it back, and a recording's replay has it at its
// end.
TEST_F(GraphRecorders, JoinsTheWorldsSnapshotsAndRecordings) {
  struct Game {
    World<float> world{WorldSettings{}};
    Hero<float> hero;
    std::vector<std::byte> ring;
    int character = -1;
    explicit Game(const Graph& graph) : hero(graph), ring(GraphRecorder<float>::bytes_for(graph, 20)) {
      Status status;
      character = world.add_character(asset.skeleton, {}, status);
      EXPECT_TRUE(status.ok());
      world.keep_with_state(hero.state);
      world.keep_with_state(ring);
    }
    void plan(GraphRecorder<float>& recorder, int k) {
      ASSERT_TRUE(recorder.step(hero.job(k)).ok());
      ASSERT_TRUE(world.character(character).set_target(hero.jets).ok());
      if (k == 0) (void)world.character(character).reset();
    }
  };
  Game game(graph), again(graph);
  GraphRecorder<float> recorder(graph, game.ring);
  game.plan(recorder, 0);
  Recorder<float> run(game.world);
  std::vector<std::byte> snapshot(game.world.snapshot_capacity()), then;
  for (int k = 1; k <= 60; ++k) {
    game.plan(recorder, k);
    ASSERT_TRUE(run.step(1 / 60.f).ok());
    if (k == 45) {
      snapshot.resize(game.world.save(snapshot));
      then = game.ring;
    }
  }
  ReplayReport report;
  const Status status = replay(again.world, run.bytes(), report);
  ASSERT_TRUE(status.ok()) << status.reason;
  EXPECT_TRUE(report.same);
  EXPECT_EQ(report.steps, 60);
  EXPECT_EQ(again.ring, game.ring);
  expect_same_frames<float>(graph, again.ring, 20);
  ASSERT_TRUE(game.world.restore(snapshot).ok());
  EXPECT_EQ(game.ring, then);
  expect_same_frames<float>(graph, game.ring, 20);
}

TEST_F(GraphRecorders, WhatIsNoRecordingIsRefused) {
  std::vector<std::byte> ring(GraphRecorder<float>::bytes_for(graph, 4));
  EXPECT_FALSE(GraphReplay<float>(graph, ring).Validate().ok());
  const GraphRecorder<float> begun(graph, ring);
  EXPECT_TRUE(GraphReplay<float>(graph, ring).Validate().ok());
  EXPECT_EQ(GraphReplay<float>(graph, ring).count(), 0);
  EXPECT_FALSE(GraphReplay<double>(graph, ring).Validate().ok());
  EXPECT_FALSE(GraphReplay<float>(graph, std::span(ring).first(ring.size() - 16)).Validate().ok());
  EXPECT_FALSE(GraphReplay<float>(graph, {}).Validate().ok());
  Graph other;
  fixtures::bind_graph(R"({"graph": "walk"})", asset, other);
  EXPECT_FALSE(GraphReplay<float>(other, ring).Validate().ok());
  // Too small a buffer: the frames are played all the same.
  std::vector<std::byte> small(64);
  GraphRecorder<float> none(graph, small);
  Hero<float> hero(graph);
  EXPECT_TRUE(none.step(hero.job(0)).ok());
  // A recording that was cut off within its first frame.
  std::vector<std::byte> cut(ring.begin(), ring.begin() + 64);
  GraphRecorder<float> again(graph, cut);
  EXPECT_TRUE(again.step(hero.job(1)).ok());
}

TEST_F(GraphRecorders, AFileSaysWhatHappened) {
  std::vector<std::byte> ring(GraphRecorder<float>::bytes_for(graph, 30));
  GraphRecorder<float> recorder(graph, ring);
  Hero<float> hero(graph);
  for (int k = 0; k < 60; ++k) ASSERT_TRUE(recorder.step(hero.job(k)).ok());
  const std::string file = graph_tools::recording_file(ring);
  graph_tools::Json frames;
  ASSERT_EQ(graph_tools::dump_recording(graph, file, frames), "");
  ASSERT_GE(frames.size(), 30u);
  EXPECT_EQ(frames.back()["frame"], 59);
  EXPECT_EQ(frames.back()["same"], true);
  EXPECT_EQ(frames.back()["after"]["plays"]["feet"].size(), 2u);
  EXPECT_FALSE(frames.back()["rays"].empty());
  std::mt19937 random(2);
  for (int k = 0; k < 100; ++k) {
    std::string damaged = file;
    damaged[random() % damaged.size()] ^= static_cast<char>(1 + random() % 255);
    if (k % 10 == 0) damaged.resize(random() % damaged.size());
    EXPECT_NE(graph_tools::dump_recording(graph, damaged, frames), "");
  }
}

}  // namespace
}  // namespace sinew
