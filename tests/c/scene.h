// A world behind the C interface, for its tests: the sample asset's figure on the floor.
#pragma once

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "fixtures/paths.h"
#include "sinew/c/sinew.h"

namespace sinew::fixtures {

inline std::string sample_asset() {
  return binary_dir() + "/sample.sinew";
}

/// A graph for it.
inline std::string sample_graph() {
  return binary_dir() + "/sample.sgraph";
}

/// A struct that says its size, filled by `init`.
template <class S>
S initialised(sinew_status (*init)(S*)) {
  S s{};
  s.size = sizeof s;
  EXPECT_EQ(init(&s), SINEW_OK) << sinew_last_reason();
  return s;
}

struct CScene {
  sinew_asset asset = 0;
  sinew_world world = 0;
  sinew_character hero = 0;
  int joints = 0;

  CScene() {
    EXPECT_EQ(sinew_asset_load(sample_asset().c_str(), &asset), SINEW_OK) << sinew_last_reason();
    sinew_asset_info info{};
    info.size = sizeof info;
    EXPECT_EQ(sinew_asset_get_info(asset, &info), SINEW_OK) << sinew_last_reason();
    joints = info.joints;
    EXPECT_EQ(sinew_world_create(nullptr, &world), SINEW_OK) << sinew_last_reason();
    EXPECT_EQ(sinew_world_add_character(world, asset, nullptr, &hero), SINEW_OK) << sinew_last_reason();
    play(0);
    EXPECT_EQ(sinew_character_reset(hero), SINEW_OK) << sinew_last_reason();
  }
  ~CScene() {
    sinew_world_destroy(world);
    sinew_asset_destroy(asset);
  }
  CScene(const CScene&) = delete;
  CScene& operator=(const CScene&) = delete;

  void play(double time) const {
    const sinew_play play{hero, asset, 0, 0, time, 1, 0};
    EXPECT_EQ(sinew_play_clips(&play, 1), SINEW_OK) << sinew_last_reason();
  }
  void step() const { EXPECT_EQ(sinew_world_step(world, 1 / 60.f), SINEW_OK) << sinew_last_reason(); }
  sinew_character_report report() const {
    sinew_character_report r{};
    r.size = sizeof r;
    EXPECT_EQ(sinew_character_get_report(hero, &r), SINEW_OK) << sinew_last_reason();
    return r;
  }
  std::vector<sinew_jet> jets(double time = 0) const {
    std::vector<sinew_jet> jets(static_cast<std::size_t>(joints));
    EXPECT_EQ(sinew_clip_sample(asset, 0, time, 1, 0, jets.data(), joints), SINEW_OK) << sinew_last_reason();
    return jets;
  }
};

}  // namespace sinew::fixtures
