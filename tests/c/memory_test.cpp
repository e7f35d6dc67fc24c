// Set-up calls of the C interface that find no memory: each answers with a status, nothing crosses the
// border, nothing leaks that destroying does not give back.
#include <atomic>
#include <cstddef>
#include <cstdlib>
#include <new>

#include "c/scene.h"

namespace {

/// Allocations until one fails; negative: none does.
thread_local long left = -1;
std::atomic<long> live{0};

/// Null where none is to be had.
void* take(void* /*context*/, std::size_t bytes, std::size_t alignment) {
  if (left == 0) return nullptr;
  if (left > 0) --left;
  void* const memory = std::aligned_alloc(alignment, (bytes + alignment - 1) / alignment * alignment);
  if (memory) ++live;
  return memory;
}

void give_back(void* /*context*/, void* memory) {
  --live;
  std::free(memory);
}

void* take_or_throw(std::size_t bytes, std::size_t alignment) {
  void* const memory = take(nullptr, bytes, alignment);
  if (!memory) throw std::bad_alloc();
  return memory;
}

void give_back_any(void* memory) {
  if (memory) give_back(nullptr, memory);
}

}  // namespace

// The library takes its memory here where it has no operator new of its own.
void* operator new(std::size_t bytes) {
  return take_or_throw(bytes, alignof(std::max_align_t));
}
void* operator new(std::size_t bytes, std::align_val_t alignment) {
  return take_or_throw(bytes, std::size_t(alignment));
}
void operator delete(void* memory) noexcept {
  give_back_any(memory);
}
void operator delete(void* memory, std::size_t) noexcept {
  give_back_any(memory);
}
void operator delete(void* memory, std::align_val_t) noexcept {
  give_back_any(memory);
}
void operator delete(void* memory, std::size_t, std::align_val_t) noexcept {
  give_back_any(memory);
}

namespace sinew {
namespace {

/// Whether the library takes its memory from take() by sinew_set_memory.
bool hooked() {
  static const bool set = sinew_set_memory(take, give_back, nullptr) == SINEW_OK;
  return set;
}

class CInterfaceMemory : public ::testing::Test {
 protected:
  static void SetUpTestSuite() { hooked(); }
};

/// Lets the n-th allocation of set_up() fail for n = 0, every, 2 every, … until it passes. Returns which did
/// not fail any more.
template <class SetUp>
int fail_each_allocation(SetUp&& set_up, int every = 1) {
  for (int n = 0; n < 20000; n += every) {
    left = n;
    const sinew_status status = set_up();
    const bool passed = left > 0;
    left = -1;
    if (passed) {
      EXPECT_EQ(status, SINEW_OK) << sinew_last_reason();
      return n;
    }
    EXPECT_TRUE(status == SINEW_NO_MEMORY || status == SINEW_OK) << sinew_status_name(status);
  }
  ADD_FAILURE() << "does not end";
  return 0;
}

TEST_F(CInterfaceMemory, EveryAllocationOfLoadingMayFail) {
  const std::string path = fixtures::sample_asset();
  const long before = live;
  const int failures = fail_each_allocation([&] {
    sinew_asset asset = 0;
    const sinew_status status = sinew_asset_load(path.c_str(), &asset);
    if (status == SINEW_OK) {
      EXPECT_EQ(sinew_asset_destroy(asset), SINEW_OK);
    }
    return status;
  });
  EXPECT_GT(failures, 10);
  EXPECT_EQ(live, before);
}

TEST_F(CInterfaceMemory, EveryAllocationOfSettingUpAWorldMayFail) {
  sinew_asset asset = 0;
  ASSERT_EQ(sinew_asset_load(fixtures::sample_asset().c_str(), &asset), SINEW_OK);
  const long before = live;
  const int failures = fail_each_allocation([&] {
    sinew_world world = 0;
    sinew_status status = sinew_world_create(nullptr, &world);
    if (status != SINEW_OK) return status;
    sinew_character hero = 0;
    status = sinew_world_add_character(world, asset, nullptr, &hero);
    if (status == SINEW_OK) {
      sinew_prop ball = 0;
      status = sinew_world_add_prop(world, nullptr, &ball);
    }
    if (status != SINEW_OK) {
      EXPECT_EQ(sinew_world_step(world, 0.01f), SINEW_BROKEN);
    }
    EXPECT_EQ(sinew_world_destroy(world), SINEW_OK);
    return status;
  });
  EXPECT_GT(failures, 10);
  EXPECT_EQ(live, before);
  EXPECT_EQ(sinew_asset_destroy(asset), SINEW_OK);
}

TEST_F(CInterfaceMemory, ComesFromTheHostToTheLastByte) {
  if (!hooked()) GTEST_SKIP() << "built without the C++ library within: " << sinew_last_reason();
  EXPECT_EQ(sinew_memory_blocks(), 0u);
  {
    const long before = live;
    const fixtures::CScene scene;
    // What the test itself holds meanwhile: the names of a file.
    EXPECT_GE(live - before, static_cast<long>(sinew_memory_blocks()));
    EXPECT_GT(sinew_memory_blocks(), 20u);
    EXPECT_EQ(sinew_set_memory(nullptr, nullptr, nullptr), SINEW_INVALID_ARGUMENT);
    EXPECT_STREQ(sinew_last_reason(), "the library has memory: destroy its assets and worlds first");
  }
  EXPECT_EQ(sinew_memory_blocks(), 0u);
  EXPECT_EQ(sinew_set_memory(take, nullptr, nullptr), SINEW_INVALID_ARGUMENT);
  EXPECT_STREQ(sinew_last_reason(), "memory needs both functions, or none");
}

TEST_F(CInterfaceMemory, AllocationsOfACrowdMayFail) {
  constexpr int kEvery = 7;  // a character in the world takes what the next one does
  sinew_asset asset = 0;
  ASSERT_EQ(sinew_asset_load(fixtures::sample_asset().c_str(), &asset), SINEW_OK);
  sinew_crowd_settings settings = fixtures::initialised(sinew_crowd_settings_init);
  settings.capacity = 20;
  settings.places = 2;
  const long before = live;
  const int failures = fail_each_allocation(
      [&] {
        sinew_world street = 0;
        const sinew_status status = sinew_crowd_create(asset, &settings, nullptr, nullptr, &street);
        if (status == SINEW_OK) {
          EXPECT_EQ(sinew_world_step(street, 0.01f), SINEW_OK) << sinew_last_reason();
          EXPECT_EQ(sinew_world_destroy(street), SINEW_OK);
        }
        return status;
      },
      kEvery);
  EXPECT_GT(failures, 10);
  EXPECT_EQ(live, before);
  EXPECT_EQ(sinew_asset_destroy(asset), SINEW_OK);
}

/// Lets each allocation of add(world, hero, asset) fail, in a world that has been set up before with all
/// memory. `prepare`: likewise. `after`: what a step says to a world in which one has failed.
template <class Prepare, class Add>
void fail_each_addition(sinew_status after, Prepare&& prepare, Add&& add, int every = 1) {
  sinew_asset asset = 0;
  ASSERT_EQ(sinew_asset_load(fixtures::sample_asset().c_str(), &asset), SINEW_OK);
  const long before = live;
  const int failures = fail_each_allocation(
      [&] {
        sinew_world world = 0;
        sinew_character hero = 0;
        const long all = left;
        left = -1;
        EXPECT_EQ(sinew_world_create(nullptr, &world), SINEW_OK);
        EXPECT_EQ(sinew_world_add_character(world, asset, nullptr, &hero), SINEW_OK);
        EXPECT_EQ(prepare(hero), SINEW_OK);
        left = all;
        const sinew_status status = add(world, hero, asset);
        EXPECT_EQ(sinew_world_step(world, 0.01f), status == SINEW_OK ? SINEW_OK : after);
        EXPECT_EQ(sinew_world_destroy(world), SINEW_OK);
        return status;
      },
      every);
  EXPECT_GT(failures, 0);
  EXPECT_EQ(live, before);
  EXPECT_EQ(sinew_asset_destroy(asset), SINEW_OK);
}

constexpr auto kNothing = [](sinew_character) { return sinew_status(SINEW_OK); };

TEST_F(CInterfaceMemory, EveryAllocationOfABehaviourMayFail) {
  // It is made aside and then taken: the world is as it was.
  fail_each_addition(SINEW_OK, kNothing, [](sinew_world, sinew_character hero, sinew_asset) {
    return sinew_character_add_behaviour(hero, nullptr);
  });
}

TEST_F(CInterfaceMemory, AllocationsOfGettingUpMayFail) {
  constexpr int kEvery = 11;  // there are hundreds, most of poses to rise from, one like the next
  const auto behaves = [](sinew_character hero) { return sinew_character_add_behaviour(hero, nullptr); };
  const auto use = [](sinew_world, sinew_character hero, sinew_asset asset) {
    return sinew_character_use_get_ups(hero, asset);
  };
  fail_each_addition(SINEW_BROKEN, behaves, use, kEvery);
}

TEST_F(CInterfaceMemory, EveryAllocationOfAnEffectMayFail) {
  fail_each_addition(SINEW_BROKEN, kNothing, [](sinew_world, sinew_character hero, sinew_asset) {
    sinew_effect wind = 0;
    return sinew_character_add_wind(hero, nullptr, &wind);
  });
}

TEST_F(CInterfaceMemory, EveryAllocationOfAStrandMayFail) {
  fail_each_addition(SINEW_BROKEN, kNothing, [](sinew_world world, sinew_character, sinew_asset) {
    sinew_particles strand = 0;
    return sinew_world_add_strand(world, nullptr, &strand);
  });
}

TEST_F(CInterfaceMemory, EveryAllocationOfAToneMayFail) {
  fail_each_addition(SINEW_BROKEN, kNothing, [](sinew_world, sinew_character hero, sinew_asset) {
    return sinew_character_set_tone(hero, SINEW_TONE_ALERT);
  });
}

TEST_F(CInterfaceMemory, EveryAllocationOfFollowingAGraphMayFail) {
  const std::string path = fixtures::sample_graph();
  sinew_graph graph = 0;
  fail_each_addition(SINEW_BROKEN, kNothing, [&](sinew_world, sinew_character hero, sinew_asset asset) {
    const long all = left;
    left = -1;  // the file has its own test
    EXPECT_EQ(sinew_graph_load(path.c_str(), asset, &graph), SINEW_OK) << sinew_last_reason();
    left = all;
    const sinew_status status = sinew_character_add_graph(hero, graph, nullptr);
    EXPECT_EQ(sinew_graph_destroy(graph), SINEW_OK);
    return status;
  });
}

TEST_F(CInterfaceMemory, EveryAllocationOfLoadingAGraphMayFail) {
  sinew_asset asset = 0;
  ASSERT_EQ(sinew_asset_load(fixtures::sample_asset().c_str(), &asset), SINEW_OK);
  const std::string path = fixtures::sample_graph();
  const long before = live;
  const int failures = fail_each_allocation([&] {
    sinew_graph graph = 0;
    const sinew_status status = sinew_graph_load(path.c_str(), asset, &graph);
    if (status == SINEW_OK) {
      EXPECT_EQ(sinew_graph_destroy(graph), SINEW_OK);
    }
    return status;
  });
  EXPECT_GT(failures, 10);
  EXPECT_EQ(live, before);
  EXPECT_EQ(sinew_asset_destroy(asset), SINEW_OK);
}

TEST_F(CInterfaceMemory, StepsAndWhatIsDoneInAFrameTakeNone) {
  fixtures::CScene scene;
  sinew_graph graph = 0;
  sinew_character other = 0;
  ASSERT_EQ(sinew_graph_load(fixtures::sample_graph().c_str(), scene.asset, &graph), SINEW_OK);
  ASSERT_EQ(sinew_world_add_character(scene.world, scene.asset, nullptr, &other), SINEW_OK);
  ASSERT_EQ(sinew_character_add_graph(other, graph, nullptr), SINEW_OK) << sinew_last_reason();
  ASSERT_EQ(sinew_graph_destroy(graph), SINEW_OK);
  sinew_effect wind = 0;
  sinew_wind air = fixtures::initialised(sinew_wind_init);
  ASSERT_EQ(sinew_character_add_wind(other, &air, &wind), SINEW_OK) << sinew_last_reason();
  std::vector<sinew_jet> jets = scene.jets(), still = jets;
  sinew_look look = fixtures::initialised(sinew_look_init);
  look.target[0] = 3;
  sinew_look_state seen{};
  std::vector<sinew_jet> turned = jets, scratch(2 * jets.size());
  sinew_feet placing = fixtures::initialised(sinew_feet_init);
  placing.step = 1 / 60.;
  sinew_feet_state stood{};
  const sinew_ground_hit floor{{0, 0, 0.05f}, {0, 0, 1}, 0};
  const sinew_foot feet[2] = {{&floor, &floor, 1, 1, 1, 0}, {&floor, nullptr, 1, 0, 0, 0}};
  sinew_jet ground{};
  ground.rotation[3] = 1;
  for (int frame = 0; frame < 10; ++frame) {
    scene.play(frame / 60.0);
    scene.step();
  }
  left = 0;  // the next allocation fails
  for (int frame = 10; frame < 60; ++frame) {
    scene.play(frame / 60.0);
    const double point[3] = {0, 0, 1}, push[3] = {0, 80, 0};
    if (frame == 20) {
      EXPECT_EQ(sinew_character_apply_impulse(scene.hero, 1, point, push), SINEW_OK);
    }
    scene.step();
    sinew_view view{};
    EXPECT_EQ(sinew_character_get_view(scene.hero, SINEW_VIEW_MODEL, &view), SINEW_OK);
    EXPECT_EQ(scene.report().frozen, 0);
    EXPECT_EQ(sinew_character_set_parameter_by_name(other, "physics.face_up", 1), SINEW_OK);
    EXPECT_EQ(sinew_character_set_parameter_by_name(other, "limp", frame > 30), SINEW_OK);
    EXPECT_EQ(sinew_character_play_graph(other, 1 / 60.f), SINEW_OK);
    EXPECT_EQ(sinew_character_sample_graph(other, 1 / 60.f, jets.data(), scene.joints), SINEW_OK);
    const sinew_blend_layer layers[2] = {{jets.data(), nullptr, SINEW_BLEND_MIX, 0.5f, 0, 0},
                                         {still.data(), nullptr, SINEW_BLEND_MIX, 0.5f, 0, 0}};
    EXPECT_EQ(sinew_asset_blend(scene.asset, layers, 2, jets.data(), scene.joints), SINEW_OK);
    EXPECT_EQ(sinew_asset_mirror(scene.asset, jets.data(), scene.joints), SINEW_OK);
    EXPECT_EQ(sinew_asset_look(scene.asset, &look, &seen, jets.data(), scene.joints), SINEW_OK);
    const int twice = 2 * scene.joints;
    turned = still;
    EXPECT_EQ(sinew_asset_subtract_in_model(scene.asset, jets.data(), scene.joints, turned.data(),
                                            scene.joints, scratch.data(), twice),
              SINEW_OK);
    const sinew_blend_layer added{turned.data(), nullptr, SINEW_BLEND_ADDITIVE, 0.5f, 0, 0};
    EXPECT_EQ(sinew_asset_add_in_model(scene.asset, &added, jets.data(), scene.joints, scratch.data(), twice),
              SINEW_OK);
    std::int32_t rests = 0;
    EXPECT_EQ(sinew_clip_in_contact(scene.asset, 0, frame / 60.0, 0, &rests), SINEW_OK);
    jets = still;
    EXPECT_EQ(
        sinew_asset_place_feet(scene.asset, &placing, feet, &ground, 1, &stood, jets.data(), scene.joints),
        SINEW_OK)
        << sinew_last_reason();
    air.velocity[1] = frame;
    EXPECT_EQ(sinew_effect_set_wind(wind, &air), SINEW_OK);
  }
  left = -1;
}

}  // namespace
}  // namespace sinew
