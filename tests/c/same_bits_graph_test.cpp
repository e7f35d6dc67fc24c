// A character that follows a graph through the C interface goes the way of the same one in C++, to the bit.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <fstream>
#include <iterator>

#include "c/scene.h"
#include "sinew/character/physics_values.h"
#include "sinew/graph/graph_file.h"
#include "sinew/graph/graph_physics.h"
#include "sinew/graph/graph_step.h"
#include "sinew/io/asset.h"

namespace sinew {
namespace {

using fixtures::CScene;
using fixtures::initialised;
using fixtures::sample_graph;

constexpr float kStep = 1 / 60.f;
constexpr int kFrames = 240;
constexpr int kSavedAt = 70, kBackAt = 90;    ///< frames: what comes between them is repeated
constexpr double kPush[3] = {0, 60, 0};       ///< N s
constexpr double kPushedAt[3] = {0, 0, 1.3};  ///< m, from where it stands

/// What the game asks for in a frame.
struct Inputs {
  float speed;  ///< m/s
  bool limp;
  explicit Inputs(int frame)
      : speed(frame < 20   ? 0.f
              : frame < 60 ? 1.275f
                           : 3.2f),
        limp(frame >= 140 && frame < 200) {}
};

/// What a run of either side shows.
struct Shown {
  std::vector<float> poses;
  std::vector<std::uint32_t> events;  ///< numbers of their names, and the bits of when they were

  void add(const void* model, std::size_t count) {
    const auto* const numbers = static_cast<const float*>(model);
    for (std::size_t joint = 0; joint < count; ++joint)  // without the padding of a transform
      poses.insert(poses.end(), &numbers[8 * joint], &numbers[8 * joint + 7]);
  }
  void add(std::uint32_t name, float seconds_ago) {
    std::uint32_t bits = 0;
    std::memcpy(&bits, &seconds_ago, sizeof bits);
    events.insert(events.end(), {name, bits});
  }
};

std::vector<std::uint8_t> bytes_of(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

Shown run_in_cpp() {
  Asset asset;
  GraphDefinition definition;
  Graph graph;
  EXPECT_TRUE(load_asset(fixtures::sample_asset().c_str(), asset));
  EXPECT_TRUE(read_graph(bytes_of(sample_graph()), definition));
  EXPECT_TRUE(Graph::bind(definition, asset, graph));
  GraphScratch<float> scratch(graph);
  Status status;
  World<float> world({});
  Character<float> hero = world.character(world.add_character(asset.skeleton, {}, status));
  GraphMemory state(graph.state_bytes<float>());
  EXPECT_TRUE(start_graph<float>(graph, state));
  world.keep_with_state(state);
  GraphParameters<float> parameters(graph, state);
  parameters.put({1, -2, 0}, 0.5);
  std::vector<JointJet<float>> jets(asset.skeleton.joints.size()), body(jets.size());
  std::vector<EventHit> hits(32);
  std::vector<std::byte> snapshot(world.snapshot_capacity());
  Shown shown;
  const auto play = [&](float h) {
    physical_motion<float>(hero, body);
    EventSink events{hits};
    GraphStepJob<float> job{&graph, state, h, &scratch, jets, &events};
    job.physical = body;
    EXPECT_TRUE(job.Run());
    for (int e = 0; e < events.count; ++e)
      shown.add(hits[std::size_t(e)].event->name, hits[std::size_t(e)].seconds_ago);
    EXPECT_TRUE(hero.set_target(jets));
  };
  play(0);
  EXPECT_TRUE(hero.reset());
  bool went_back = false;
  for (int frame = 0; frame < kFrames; ++frame) {
    const Inputs in(frame);
    EXPECT_TRUE(parameters.set(definition.find_parameter("speed"), in.speed));
    EXPECT_TRUE(parameters.set(definition.find_parameter("limp"), in.limp ? 1.f : 0.f));
    EXPECT_TRUE(hero.set_strength(in.limp ? 0.f : 1.f));
    if (frame == 80) {
      const Vec3<float> at =
          parameters.place().cast<float>() + Eigen::Map<const Vec3<double>>(kPushedAt).cast<float>();
      EXPECT_TRUE(hero.apply_impulse(asset.skeleton.find(Role::kChest), at,
                                     Eigen::Map<const Vec3<double>>(kPush).cast<float>()));
    }
    play(kStep);
    EXPECT_TRUE(world.step(kStep));
    EXPECT_TRUE(set_physics<float>(graph, state, physics_values<float>(hero)));
    shown.add(hero.model().data(), hero.model().size());
    if (frame == kSavedAt) {
      snapshot.resize(world.save(snapshot));
    }
    if (frame == kBackAt && !went_back) {
      went_back = true;
      EXPECT_TRUE(world.restore(snapshot));
      frame = kSavedAt;
    }
  }
  return shown;
}

struct Follower : CScene {
  sinew_graph graph = 0;
  int speed = -1, limp = -1, chest = -1;

  explicit Follower(const sinew_graph_settings* settings = nullptr) {
    EXPECT_EQ(sinew_graph_load(sample_graph().c_str(), asset, &graph), SINEW_OK) << sinew_last_reason();
    EXPECT_EQ(sinew_graph_find_parameter(graph, "speed", &speed), SINEW_OK);
    EXPECT_EQ(sinew_graph_find_parameter(graph, "limp", &limp), SINEW_OK);
    EXPECT_EQ(sinew_asset_find_role(asset, SINEW_ROLE_CHEST, &chest), SINEW_OK);
    EXPECT_EQ(sinew_character_add_graph(hero, graph, settings), SINEW_OK) << sinew_last_reason();
  }
  ~Follower() { sinew_graph_destroy(graph); }
  void play(float h = kStep) const {
    EXPECT_EQ(sinew_character_play_graph(hero, h), SINEW_OK) << sinew_last_reason();
  }
  void begin() const {
    play(0);
    EXPECT_EQ(sinew_character_reset(hero), SINEW_OK);
  }
  sinew_graph_place where() const {
    sinew_graph_place place{};
    EXPECT_EQ(sinew_character_get_graph_place(hero, &place), SINEW_OK);
    return place;
  }
  sinew_view model() const {
    sinew_view view{};
    EXPECT_EQ(sinew_character_get_view(hero, SINEW_VIEW_MODEL, &view), SINEW_OK);
    return view;
  }
};

/// The same run; `one_call`: graphs are played for a list of characters.
Shown run_in_c(bool one_call) {
  sinew_graph_settings settings = initialised(sinew_graph_settings_init);
  settings.place[0] = 1;
  settings.place[1] = -2;
  settings.heading = 0.5;
  const Follower scene(&settings);
  // Both may go: the character keeps what it needs.
  EXPECT_EQ(sinew_graph_destroy(scene.graph), SINEW_OK);
  EXPECT_EQ(sinew_asset_destroy(scene.asset), SINEW_OK);
  std::vector<char> snapshot(1 << 20);
  std::size_t size = 0;
  Shown shown;
  const auto play = [&](float h) {
    const sinew_graph_play plays[1] = {{scene.hero, h, 0}};
    EXPECT_EQ(one_call ? sinew_play_graphs(plays, 1) : sinew_character_play_graph(scene.hero, h), SINEW_OK)
        << sinew_last_reason();
    sinew_graph_event events[32];
    std::int32_t count = 0, lost = 0;
    EXPECT_EQ(sinew_character_get_graph_events(scene.hero, events, 32, &count, &lost), SINEW_OK);
    EXPECT_EQ(lost, 0);
    for (int e = 0; e < count; ++e) shown.add(events[e].name, events[e].seconds_ago);
  };
  play(0);
  EXPECT_EQ(sinew_character_reset(scene.hero), SINEW_OK);
  bool went_back = false;
  for (int frame = 0; frame < kFrames; ++frame) {
    const Inputs in(frame);
    EXPECT_EQ(sinew_character_set_parameter(scene.hero, scene.speed, in.speed), SINEW_OK);
    EXPECT_EQ(sinew_character_set_parameter_by_name(scene.hero, "limp", in.limp ? 1.f : 0.f), SINEW_OK);
    EXPECT_EQ(sinew_character_set_strength(scene.hero, in.limp ? 0.f : 1.f), SINEW_OK);
    if (frame == 80) {
      const sinew_graph_place place = scene.where();
      const double at[3] = {double(float(place.place[0])) + kPushedAt[0],
                            double(float(place.place[1])) + kPushedAt[1], kPushedAt[2]};
      EXPECT_EQ(sinew_character_apply_impulse(scene.hero, scene.chest, at, kPush), SINEW_OK);
    }
    play(kStep);
    scene.step();
    const sinew_view model = scene.model();
    shown.add(model.data, std::size_t(model.count));
    if (frame == kSavedAt) {
      EXPECT_EQ(sinew_world_save(scene.world, SINEW_SNAPSHOT_STATE, snapshot.data(), snapshot.size(), &size),
                SINEW_OK);
    }
    if (frame == kBackAt && !went_back) {
      went_back = true;
      EXPECT_EQ(sinew_world_restore(scene.world, SINEW_SNAPSHOT_STATE, snapshot.data(), size), SINEW_OK)
          << sinew_last_reason();
      frame = kSavedAt;
    }
  }
  return shown;
}

TEST(CInterfaceGraph, GoesTheWayOfTheSameRunInCpp) {
  const Shown wanted = run_in_cpp();
  EXPECT_GT(wanted.events.size(), 8u) << "hardly a footstep";
  for (const bool one_call : {false, true}) {
    const Shown shown = run_in_c(one_call);
    EXPECT_EQ(shown.events, wanted.events);
    ASSERT_EQ(shown.poses.size(), wanted.poses.size());
    EXPECT_EQ(std::memcmp(shown.poses.data(), wanted.poses.data(), shown.poses.size() * sizeof(float)), 0);
  }
}

TEST(CInterfaceGraph, SampledJetsAreThoseThatArePlayed) {
  const Follower played, sampled;
  std::vector<sinew_jet> jets(std::size_t(sampled.joints));
  for (int frame = 0; frame < 40; ++frame) {
    for (const Follower* scene : {&played, &sampled})
      ASSERT_EQ(sinew_character_set_parameter(scene->hero, scene->speed, 2), SINEW_OK);
    played.play();
    ASSERT_EQ(sinew_character_sample_graph(sampled.hero, kStep, jets.data(), sampled.joints), SINEW_OK);
    ASSERT_EQ(sinew_character_set_target(sampled.hero, jets.data(), sampled.joints), SINEW_OK);
    played.step();
    sampled.step();
  }
  const sinew_view a = played.model(), b = sampled.model();
  EXPECT_EQ(std::memcmp(a.data, b.data, std::size_t(a.count) * std::size_t(a.stride)), 0);
}

TEST(CInterfaceGraph, WhatItRemembersIsRestoredAndWhatIsDamagedRefused) {
  const Follower scene;
  sinew_graph_info info{};
  info.size = sizeof info;
  ASSERT_EQ(sinew_graph_get_info(scene.graph, &info), SINEW_OK);
  std::vector<char> bytes(info.state_bytes);
  std::size_t size = 0;
  EXPECT_EQ(sinew_character_save_graph(scene.hero, nullptr, 0, &size), SINEW_TOO_SMALL);
  EXPECT_EQ(size, info.state_bytes);
  ASSERT_EQ(sinew_character_set_parameter(scene.hero, scene.speed, 3), SINEW_OK);
  for (int frame = 0; frame < 30; ++frame) scene.play();
  ASSERT_EQ(sinew_character_save_graph(scene.hero, bytes.data(), bytes.size(), &size), SINEW_OK);
  for (int frame = 0; frame < 30; ++frame) scene.play();
  const sinew_graph_place once = scene.where();
  EXPECT_GT(once.place[0], 1);  // m: 3 m/s for about a second
  bytes[40] ^= 1;
  EXPECT_EQ(sinew_character_restore_graph(scene.hero, bytes.data(), size), SINEW_BAD_FILE);
  bytes[40] ^= 1;
  EXPECT_EQ(sinew_character_restore_graph(scene.hero, bytes.data(), size - 8), SINEW_INVALID_ARGUMENT);
  EXPECT_EQ(scene.where().place[0], once.place[0]) << "nothing has moved";
  ASSERT_EQ(sinew_character_restore_graph(scene.hero, bytes.data(), size), SINEW_OK) << sinew_last_reason();
  EXPECT_LT(scene.where().place[0], once.place[0]);
  for (int frame = 0; frame < 30; ++frame) scene.play();
  EXPECT_EQ(scene.where().place[0], once.place[0]);
  EXPECT_EQ(scene.where().velocity[0], once.velocity[0]);
}

TEST(CInterfaceGraph, TheBodyTellsHowItStandsAndMoves) {
  for (const bool told : {true, false}) {
    sinew_graph_settings settings = initialised(sinew_graph_settings_init);
    EXPECT_EQ(settings.physics, 1);
    settings.physics = told;
    const Follower scene(&settings);
    int face_up = -1;
    ASSERT_EQ(sinew_graph_find_parameter(scene.graph, "physics.face_up", &face_up), SINEW_OK);
    scene.begin();
    for (int k = 0; k < 30; ++k) {
      scene.play();
      scene.step();
    }
    sinew_physics physics{};
    EXPECT_EQ(sinew_character_get_physics(scene.hero, &physics), SINEW_INVALID_ARGUMENT) << "no size";
    physics.size = sizeof physics;
    ASSERT_EQ(sinew_character_get_physics(scene.hero, &physics), SINEW_OK);
    EXPECT_LT(physics.tilt, 0.3f);
    EXPECT_NE(physics.face_up, 0);
    EXPECT_NEAR(physics.height, 1, 0.1);
    EXPECT_GT(physics.load, 0);
    EXPECT_EQ(physics.off_animation, 0);
    sinew_parameter_value value{};
    ASSERT_EQ(sinew_character_get_parameter(scene.hero, face_up, &value), SINEW_OK);
    EXPECT_EQ(value.goal, told ? physics.face_up : 0);
    std::vector<sinew_jet> body(std::size_t(scene.joints));
    ASSERT_EQ(sinew_character_get_motion(scene.hero, body.data(), scene.joints), SINEW_OK);
    EXPECT_EQ(sinew_character_get_motion(scene.hero, body.data(), 3), SINEW_INVALID_ARGUMENT);
    EXPECT_EQ(sinew_character_get_motion(scene.hero, nullptr, scene.joints), SINEW_INVALID_ARGUMENT);
    std::vector<float> spare(body.size());
    ASSERT_EQ(sinew_character_get_spare_acceleration(scene.hero, spare.data(), scene.joints), SINEW_OK);
    EXPECT_LT(*std::min_element(spare.begin(), spare.end()), 1e6f);
    EXPECT_EQ(sinew_character_get_spare_acceleration(scene.hero, spare.data(), 0), SINEW_INVALID_ARGUMENT);
  }
}

TEST(CInterfaceGraph, NumbersHaveNames) {
  const Follower scene;
  sinew_graph_info info{};
  info.size = sizeof info;
  ASSERT_EQ(sinew_graph_get_info(scene.graph, &info), SINEW_OK);
  EXPECT_EQ(info.joints, scene.joints);
  EXPECT_EQ(info.parameters, 3);
  sinew_parameter_info parameter{};
  parameter.size = sizeof parameter;
  ASSERT_EQ(sinew_graph_get_parameter(scene.graph, scene.limp, &parameter), SINEW_OK);
  EXPECT_STREQ(parameter.name, "limp");
  EXPECT_EQ(parameter.type, SINEW_PARAMETER_BOOL);
  sinew_node_info node{};
  node.size = sizeof node;
  const int root = info.nodes - 1;
  ASSERT_EQ(sinew_graph_get_node(scene.graph, root, &node), SINEW_OK);
  EXPECT_EQ(node.type, SINEW_NODE_MACHINE);
  EXPECT_EQ(node.states, 4);
  int found = -1;
  ASSERT_EQ(sinew_graph_find_node(scene.graph, node.name, &found), SINEW_OK);
  EXPECT_EQ(found, root);
  sinew_state_info state{};
  state.size = sizeof state;
  ASSERT_EQ(sinew_graph_get_state(scene.graph, root, 1, &state), SINEW_OK);
  EXPECT_STREQ(state.name, "limp");

  scene.begin();
  sinew_machine_report machine{};
  machine.size = sizeof machine;
  ASSERT_EQ(sinew_character_get_machine(scene.hero, root, &machine), SINEW_OK);
  EXPECT_STREQ(machine.name, "move");
  ASSERT_EQ(sinew_character_set_parameter_by_name(scene.hero, "limp", 1), SINEW_OK);
  for (int frame = 0; frame < 3; ++frame) scene.play();
  ASSERT_EQ(sinew_character_get_machine(scene.hero, root, &machine), SINEW_OK);
  EXPECT_EQ(machine.state, 1);
  EXPECT_EQ(machine.fading, 1);
  EXPECT_NEAR(machine.time, 3 / 60., 1e-6);
  sinew_parameter_value value{};
  ASSERT_EQ(sinew_character_set_parameter(scene.hero, scene.speed, 2), SINEW_OK);
  for (int frame = 0; frame < 12; ++frame) scene.play();  // the filter's half-life
  ASSERT_EQ(sinew_character_get_parameter(scene.hero, scene.speed, &value), SINEW_OK);
  EXPECT_EQ(value.goal, 2);
  EXPECT_NEAR(value.value, 1, 0.01);
  EXPECT_GT(value.rate, 0);
}

/// Stands, with its feet on the ground that there is.
std::vector<std::uint8_t> standing_graph() {
  GraphDefinition definition;
  definition.parameters.push_back({"jump", ParameterType::kTrigger});
  GraphNode stand, feet;
  stand.name = "stand";
  stand.clip = "stand";
  feet.type = NodeType::kFeet;
  feet.name = "feet";
  feet.children = {0};
  definition.nodes = {stand, feet};
  return write_graph(definition);
}

std::int32_t rising_ground(void* bodies, const float* point, sinew_ground_hit* hit) {
  EXPECT_EQ(hit->point[0], point[0]);
  EXPECT_EQ(hit->body, -1);
  hit->point[2] = 0.12f;
  if (bodies) hit->body = 0;
  return 1;
}

/// m, of the root after two seconds on that ground.
double height_on(sinew_graph_settings settings, bool moves = false) {
  const CScene scene;
  sinew_obstacle step = initialised(sinew_obstacle_init);
  step.shape = SINEW_SHAPE_BOX;
  step.extent[0] = step.extent[1] = 2;
  step.extent[2] = 0.06;
  step.pose.translation[2] = 0.06;
  EXPECT_EQ(sinew_world_add_obstacle(scene.world, &step), SINEW_OK) << sinew_last_reason();
  const std::vector<std::uint8_t> bytes = standing_graph();
  sinew_graph graph = 0;
  EXPECT_EQ(sinew_graph_read(bytes.data(), bytes.size(), scene.asset, &graph), SINEW_OK)
      << sinew_last_reason();
  EXPECT_EQ(sinew_character_add_graph(scene.hero, graph, &settings), SINEW_OK) << sinew_last_reason();
  sinew_jet lift{};
  lift.rotation[3] = 1;
  std::vector<sinew_jet> jets(std::size_t(scene.joints));
  for (int frame = 0; frame < 120; ++frame) {
    if (moves) {
      EXPECT_EQ(sinew_character_set_grounds(scene.hero, &lift, 1), SINEW_OK) << sinew_last_reason();
    }
    EXPECT_EQ(sinew_character_sample_graph(scene.hero, kStep, jets.data(), scene.joints), SINEW_OK)
        << sinew_last_reason();
  }
  EXPECT_EQ(sinew_graph_destroy(graph), SINEW_OK);
  return double(jets[0].translation[2]);
}

TEST(CInterfaceGraph, FeetStandOnWhatTheWorldAndTheHostHave) {
  sinew_graph_settings settings = initialised(sinew_graph_settings_init);
  const double level = height_on(settings);
  settings.ground = SINEW_GROUND_WORLD;
  EXPECT_NEAR(height_on(settings), level + 0.12, 0.002) << "the top of a box";
  settings.layers = 2;
  EXPECT_NEAR(height_on(settings), level, 0.002) << "the floor alone, whose layer that is not";
  settings.ground = SINEW_GROUND_HOST;
  settings.below = rising_ground;
  EXPECT_NEAR(height_on(settings), level + 0.12, 0.002);
  settings.context = &settings;
  EXPECT_NEAR(height_on(settings, true), level + 0.12, 0.002) << "a body that could move";
  EXPECT_NEAR(height_on(settings), level, 0.002) << "one that nobody has told of: no answer";
}

TEST(CInterfaceGraph, WhatCannotBeMeantIsRefused) {
  const Follower scene;
  const auto expect = [](sinew_status status, sinew_status wanted, const char* reason) {
    EXPECT_EQ(status, wanted) << reason;
    EXPECT_NE(std::string(sinew_last_reason()).find(reason), std::string::npos) << sinew_last_reason();
  };
  sinew_graph other = 0;
  const char broken[64] = "no graph";
  expect(sinew_graph_load("/nowhere", scene.asset, &other), SINEW_IO, "opened");
  expect(sinew_graph_read(broken, sizeof broken, scene.asset, &other), SINEW_BAD_FILE, "");
  expect(sinew_graph_load(sample_graph().c_str(), scene.asset, nullptr), SINEW_INVALID_ARGUMENT, "null");
  expect(sinew_character_add_graph(scene.hero, scene.graph, nullptr), SINEW_INVALID_ARGUMENT, "already");
  expect(sinew_character_set_parameter(scene.hero, 99, 1), SINEW_INVALID_ARGUMENT, "number");
  expect(sinew_character_set_parameter(scene.hero, scene.speed, NAN), SINEW_NOT_FINITE, "finite");
  expect(sinew_character_set_parameter(scene.hero, scene.speed, 1e7f), SINEW_OUT_OF_RANGE, "absurd");
  expect(sinew_character_set_parameter_by_name(scene.hero, "sped", 1), SINEW_NOT_FOUND, "name");
  expect(sinew_character_trigger(scene.hero, scene.speed), SINEW_INVALID_ARGUMENT, "trigger");
  expect(sinew_character_play_graph(scene.hero, 1.5f), SINEW_OUT_OF_RANGE, "1 s");
  expect(sinew_character_play_graph(scene.hero, NAN), SINEW_NOT_FINITE, "finite");
  sinew_machine_report machine{};
  machine.size = sizeof machine;
  expect(sinew_character_get_machine(scene.hero, 0, &machine), SINEW_INVALID_ARGUMENT, "machine");
  const double far[2] = {0, 1e9};
  expect(sinew_character_put_graph(scene.hero, far, 0), SINEW_OUT_OF_RANGE, "1e6");
  sinew_jet lift{};
  expect(sinew_character_set_grounds(scene.hero, &lift, 1), SINEW_INVALID_ARGUMENT, "unit quaternion");
  expect(sinew_character_set_grounds(scene.hero, &lift, 9), SINEW_INVALID_ARGUMENT, "8 bodies");
  sinew_graph_settings settings = initialised(sinew_graph_settings_init);
  sinew_character nobody = 0;
  ASSERT_EQ(sinew_world_add_character(scene.world, scene.asset, nullptr, &nobody), SINEW_OK);
  expect(sinew_character_play_graph(nobody, 0), SINEW_INVALID_ARGUMENT, "follows no graph");
  settings.ground = SINEW_GROUND_HOST;
  expect(sinew_character_add_graph(nobody, scene.graph, &settings), SINEW_INVALID_ARGUMENT, "null");
  settings.ground = 3;
  expect(sinew_character_add_graph(nobody, scene.graph, &settings), SINEW_INVALID_ARGUMENT, "ground");
  const sinew_graph_play plays[2] = {{scene.hero, 0, 0}, {nobody, 0, 0}};
  expect(sinew_play_graphs(plays, 2), SINEW_INVALID_ARGUMENT, "follows no graph");
  EXPECT_EQ(sinew_last_index(), 1);
  ASSERT_EQ(sinew_graph_destroy(scene.graph), SINEW_OK);
  expect(sinew_graph_destroy(scene.graph), SINEW_BAD_HANDLE, "destroyed");
}

}  // namespace
}  // namespace sinew
