// A crowd through the C interface is that of C++, to the bit, and refuses what cannot be meant.
#include <cmath>
#include <cstring>
#include <limits>

#include "c/scene.h"
#include "sinew/crowd/population.h"
#include "sinew/io/asset.h"

namespace sinew {
namespace {

using fixtures::CScene;
using fixtures::initialised;

constexpr int kPeople = 20, kFrames = 90, kPushed = 7, kAt = 10;
constexpr double kImpulse[] = {90, 20, 0};

Transform<double> place_of(int n) {
  const int row = n / 5, column = n % 5;
  return {rotation_exp<double>(Vec3<double>(0, 0, 0.7 * n)), {1.5 * column, 1.5 * row, 0}};
}

/// Of all joints of all people in every frame.
using Models = std::vector<Transform<float>>;

Models run_in_cpp(int& longest) {
  Asset asset;
  EXPECT_TRUE(load_asset(fixtures::sample_asset().c_str(), asset));
  PopulationSettings settings;
  settings.crowd.capacity = kPeople;
  settings.places = 4;
  Status status;
  const auto people = Population::create(asset.skeleton, settings, status);
  EXPECT_TRUE(status) << status.reason;
  for (int n = 0; n < kPeople; ++n)
    EXPECT_TRUE(people->play(n, {&asset.clips[0], {0.05 * n, 1}, place_of(n).cast<float>()}));
  Models models;
  longest = 0;
  for (int frame = 0; frame < kFrames; ++frame) {
    if (frame == kAt) {
      const Vec3<float> impulse = Eigen::Map<const Vec3<double>>(kImpulse).cast<float>();
      EXPECT_TRUE(people->push(kPushed, asset.skeleton.find(Role::kChest), impulse));
    }
    EXPECT_TRUE(people->step(1 / 60.f));
    longest = std::max(longest, people->solved_count());
    for (int n = 0; n < kPeople; ++n)
      models.insert(models.end(), people->model(n).begin(), people->model(n).end());
  }
  return models;
}

struct Street : CScene {
  sinew_world street = 0;

  explicit Street(sinew_crowd_settings settings = initialised(sinew_crowd_settings_init)) {
    settings.capacity = kPeople;
    settings.places = 4;
    EXPECT_EQ(sinew_crowd_create(asset, &settings, nullptr, nullptr, &street), SINEW_OK)
        << sinew_last_reason();
  }
  ~Street() { sinew_world_destroy(street); }

  static sinew_crowd_track track(int n) {
    sinew_crowd_track track{n, 0, 0.05 * n, 1, {}};
    const Transform<double> place = place_of(n);
    std::copy_n(place.rotation.coeffs().data(), 4, track.place.rotation);
    std::copy_n(place.translation.data(), 3, track.place.translation);
    return track;
  }
  void everybody_plays() const {
    std::vector<sinew_crowd_track> tracks;
    for (int n = 0; n < kPeople; ++n) tracks.push_back(track(n));
    EXPECT_EQ(sinew_crowd_play(street, tracks.data(), kPeople), SINEW_OK) << sinew_last_reason();
  }
  sinew_crowd_member member(int n) const {
    sinew_crowd_member m{};
    m.size = sizeof m;
    EXPECT_EQ(sinew_crowd_get_member(street, n, &m), SINEW_OK) << sinew_last_reason();
    return m;
  }
  sinew_crowd_report crowd() const {
    sinew_crowd_report r{};
    r.size = sizeof r;
    EXPECT_EQ(sinew_crowd_get_report(street, &r), SINEW_OK) << sinew_last_reason();
    return r;
  }
};

TEST(CInterfaceCrowd, GoesTheWayOfTheSameRunInCpp) {
  int most_in_cpp = 0, most = 0;
  const Models wanted = run_in_cpp(most_in_cpp);
  const Street scene;
  scene.everybody_plays();
  std::int32_t chest = -1;
  EXPECT_EQ(sinew_asset_find_role(scene.asset, SINEW_ROLE_CHEST, &chest), SINEW_OK);
  Models models;
  std::vector<sinew_transform> all(std::size_t(kPeople * scene.joints));
  for (int frame = 0; frame < kFrames; ++frame) {
    if (frame == kAt) {
      EXPECT_EQ(sinew_crowd_push(scene.street, kPushed, chest, kImpulse), SINEW_OK) << sinew_last_reason();
    }
    EXPECT_EQ(sinew_world_step(scene.street, 1 / 60.f), SINEW_OK) << sinew_last_reason();
    most = std::max(most, scene.crowd().in_world);
    std::int32_t count = 0;
    EXPECT_EQ(sinew_crowd_copy_models(scene.street, all.data(), int(all.size()), &count), SINEW_OK);
    EXPECT_EQ(count, int(all.size()));
    for (const sinew_transform& t : all) {
      Transform<float>& to = models.emplace_back();
      std::copy_n(t.rotation, 4, to.rotation.coeffs().data());
      std::copy_n(t.translation, 3, to.translation.data());
    }
    sinew_view one{};
    EXPECT_EQ(sinew_crowd_get_model(scene.street, kPushed, &one), SINEW_OK);
    EXPECT_EQ(one.count, scene.joints);
    EXPECT_EQ(std::memcmp(one.data, &all[std::size_t(kPushed * scene.joints)], sizeof(float) * 7), 0);
    if (frame == kAt + 2) {
      const sinew_crowd_member pushed = scene.member(kPushed);
      EXPECT_GT(pushed.level, SINEW_LEVEL_CHECKED);
      sinew_view torque{};
      EXPECT_EQ(sinew_character_get_view(pushed.character, SINEW_VIEW_TORQUE, &torque), SINEW_OK);
      EXPECT_GT(torque.count, 0);
      EXPECT_EQ(scene.member(0).character, 0u);
      EXPECT_GT(scene.member(0).peak_load, 0);
    }
  }
  EXPECT_GE(most, 1);
  EXPECT_EQ(most, most_in_cpp);
  ASSERT_EQ(models.size(), wanted.size());
  for (std::size_t n = 0; n < wanted.size(); ++n)
    ASSERT_TRUE(models[n].rotation.coeffs() == wanted[n].rotation.coeffs() &&
                models[n].translation == wanted[n].translation)
        << n;
}

TEST(CInterfaceCrowd, TellsWhatIsPlayedAndHowFast) {
  const Street scene;
  sinew_crowd_track track{};
  EXPECT_EQ(sinew_crowd_get_track(scene.street, 3, &track), SINEW_INVALID_ARGUMENT) << "it plays nothing yet";
  scene.everybody_plays();
  for (int frame = 0; frame < 10; ++frame) ASSERT_EQ(sinew_world_step(scene.street, 1 / 60.f), SINEW_OK);
  ASSERT_EQ(sinew_crowd_get_track(scene.street, 3, &track), SINEW_OK) << sinew_last_reason();
  const sinew_crowd_track begun = Street::track(3);
  EXPECT_EQ(track.character, 3);
  EXPECT_EQ(track.clip, begun.clip);
  EXPECT_NEAR(track.time, begun.time + 10 / 60.0, 1e-6) << "ten steps of a float's 1/60 s";
  EXPECT_EQ(track.rate, 1);
  for (int k = 0; k < 3; ++k) EXPECT_NEAR(track.place.translation[k], begun.place.translation[k], 1e-6);
  float velocity[3];
  ASSERT_EQ(sinew_crowd_get_root_velocity(scene.street, 3, velocity), SINEW_OK) << sinew_last_reason();
  EXPECT_GT(std::hypot(velocity[0], velocity[1]), 0.5f) << "it walks";
  EXPECT_EQ(sinew_crowd_get_root_velocity(scene.street, kPeople, velocity), SINEW_INVALID_ARGUMENT);
}

TEST(CInterfaceCrowd, WhoIsWeakEntersTheWorldAsWeak) {
  const Street scene;
  scene.everybody_plays();
  ASSERT_EQ(sinew_crowd_set_strength(scene.street, 5, 0.005f), SINEW_OK) << sinew_last_reason();
  ASSERT_EQ(sinew_world_step(scene.street, 1 / 60.f), SINEW_OK);
  const sinew_character weak = scene.member(5).character;
  ASSERT_NE(weak, 0u) << "what is left does not carry its arms";
  float strength = 0;
  ASSERT_EQ(sinew_character_get_strength(weak, &strength), SINEW_OK);
  EXPECT_EQ(strength, 0.005f);
  ASSERT_EQ(sinew_crowd_set_strength(scene.street, 5, 0.5f), SINEW_OK);
  ASSERT_EQ(sinew_character_get_strength(weak, &strength), SINEW_OK);
  EXPECT_EQ(strength, 0.5f);
  EXPECT_EQ(sinew_crowd_set_strength(scene.street, 5, -1), SINEW_INVALID_ARGUMENT);
  EXPECT_EQ(sinew_crowd_set_strength(scene.world, 5, 1), SINEW_INVALID_ARGUMENT) << "no crowd";
}

TEST(CInterfaceCrowd, OutlivesTheAssetsHandleAndTakesObstaclesAndCharacters) {
  Street scene;
  scene.everybody_plays();
  sinew_character guest = 0;
  ASSERT_EQ(sinew_world_add_character(scene.street, scene.asset, nullptr, &guest), SINEW_OK)
      << sinew_last_reason();
  EXPECT_EQ(sinew_asset_destroy(scene.asset), SINEW_OK);
  sinew_prop_settings ball = initialised(sinew_prop_settings_init);
  ball.pose.translation[0] = 40;
  sinew_prop prop = 0;
  ASSERT_EQ(sinew_world_add_prop(scene.street, &ball, &prop), SINEW_OK) << sinew_last_reason();
  for (int frame = 0; frame < 30; ++frame)
    ASSERT_EQ(sinew_world_step(scene.street, 1 / 60.f), SINEW_OK) << sinew_last_reason();
  sinew_view model{};
  EXPECT_EQ(sinew_character_get_view(guest, SINEW_VIEW_MODEL, &model), SINEW_OK);
  EXPECT_EQ(model.count, scene.joints);
  EXPECT_EQ(scene.crowd().in_world, 0);
  const sinew_transform before_one = {{0, 0, 0, 1}, {-1, 0, 1.3f}};
  const float thrown[] = {14, 0, 0}, spin[] = {0, 0, 0};
  EXPECT_EQ(sinew_prop_set_state(prop, &before_one, thrown, spin), SINEW_OK) << sinew_last_reason();
  int most = 0;
  for (int frame = 0; frame < 20; ++frame) {
    ASSERT_EQ(sinew_world_step(scene.street, 1 / 60.f), SINEW_OK) << sinew_last_reason();
    most = std::max(most, scene.crowd().in_world);
  }
  EXPECT_GE(most, 1) << "whom it hits";
}

TEST(CInterfaceCrowd, GoesOnFromASnapshotAndItsInputs) {
  const Street scene, other;
  scene.everybody_plays();
  std::int32_t chest = -1;
  EXPECT_EQ(sinew_asset_find_role(scene.asset, SINEW_ROLE_CHEST, &chest), SINEW_OK);
  const auto all_of = [&](const Street& s) {
    std::vector<sinew_transform> all(std::size_t(kPeople * s.joints));
    std::int32_t count = 0;
    EXPECT_EQ(sinew_crowd_copy_models(s.street, all.data(), int(all.size()), &count), SINEW_OK);
    return all;
  };
  const auto saved = [&](sinew_snapshot_part part) {
    std::size_t size = 0;
    EXPECT_EQ(sinew_world_save(scene.street, part, nullptr, 0, &size), SINEW_TOO_SMALL);
    std::vector<std::byte> bytes(size);
    EXPECT_EQ(sinew_world_save(scene.street, part, bytes.data(), size, &size), SINEW_OK)
        << sinew_last_reason();
    bytes.resize(size);
    return bytes;
  };
  for (int frame = 0; frame < kAt; ++frame) EXPECT_EQ(sinew_world_step(scene.street, 1 / 60.f), SINEW_OK);
  EXPECT_EQ(sinew_crowd_stop(scene.street, 3), SINEW_OK);
  EXPECT_EQ(sinew_crowd_push(scene.street, kPushed, chest, kImpulse), SINEW_OK) << sinew_last_reason();
  const std::vector<std::byte> state = saved(SINEW_SNAPSHOT_STATE), inputs = saved(SINEW_SNAPSHOT_INPUTS);
  EXPECT_EQ(sinew_world_restore(other.street, SINEW_SNAPSHOT_STATE, state.data(), state.size()), SINEW_OK)
      << sinew_last_reason();
  EXPECT_EQ(sinew_world_restore(other.street, SINEW_SNAPSHOT_INPUTS, inputs.data(), inputs.size()), SINEW_OK)
      << sinew_last_reason();
  EXPECT_EQ(other.crowd().in_world, 1);
  for (int frame = 0; frame < 30; ++frame) {
    EXPECT_EQ(sinew_world_step(scene.street, 1 / 60.f), SINEW_OK);
    EXPECT_EQ(sinew_world_step(other.street, 1 / 60.f), SINEW_OK);
    const std::vector<sinew_transform> one = all_of(scene), two = all_of(other);
    ASSERT_EQ(std::memcmp(one.data(), two.data(), one.size() * sizeof one[0]), 0) << frame;
  }
  EXPECT_GT(scene.member(kPushed).level, SINEW_LEVEL_CHECKED);
}

TEST(CInterfaceCrowd, RefusesWhatCannotBeMeant) {
  Street scene;
  sinew_crowd_track wrong[] = {Street::track(0), Street::track(1), Street::track(2)};
  wrong[1].clip = 9999;
  EXPECT_EQ(sinew_crowd_play(scene.street, wrong, 3), SINEW_INVALID_ARGUMENT);
  EXPECT_EQ(sinew_last_index(), 1);
  wrong[1] = Street::track(kPeople);
  EXPECT_EQ(sinew_crowd_play(scene.street, wrong, 3), SINEW_INVALID_ARGUMENT);
  wrong[1] = Street::track(1);
  wrong[1].place.rotation[3] = 2;
  EXPECT_EQ(sinew_crowd_play(scene.street, wrong, 3), SINEW_INVALID_ARGUMENT);
  wrong[1] = Street::track(1);
  wrong[1].time = std::numeric_limits<double>::quiet_NaN();
  EXPECT_NE(sinew_crowd_play(scene.street, wrong, 3), SINEW_OK);
  EXPECT_EQ(sinew_crowd_play(scene.street, nullptr, 1), SINEW_INVALID_ARGUMENT);
  EXPECT_EQ(sinew_crowd_play(scene.street, wrong, -1), SINEW_INVALID_ARGUMENT);
  EXPECT_EQ(sinew_crowd_play(scene.world, wrong, 1), SINEW_INVALID_ARGUMENT) << "a world without a crowd";
  EXPECT_EQ(sinew_crowd_push(scene.street, 5, 0, kImpulse), SINEW_INVALID_ARGUMENT) << "it plays nothing";
  const double infinite[] = {std::numeric_limits<double>::infinity(), 0, 0};
  EXPECT_EQ(sinew_crowd_push(scene.street, 0, 0, infinite), SINEW_NOT_FINITE);
  EXPECT_EQ(sinew_crowd_push(scene.street, 0, 1000, kImpulse), SINEW_INVALID_ARGUMENT);
  EXPECT_EQ(sinew_crowd_push(scene.street, -1, 0, kImpulse), SINEW_INVALID_ARGUMENT);
  EXPECT_EQ(sinew_crowd_push(scene.street, 0, 0, nullptr), SINEW_INVALID_ARGUMENT);
  std::int32_t count = 0;
  sinew_transform few[3];
  EXPECT_EQ(sinew_crowd_copy_models(scene.street, few, 3, &count), SINEW_TOO_SMALL);
  EXPECT_EQ(count, kPeople * scene.joints);
  std::size_t size = 0;
  EXPECT_EQ(sinew_world_save(scene.street, SINEW_SNAPSHOT_STATE, nullptr, 0, &size), SINEW_TOO_SMALL);
  EXPECT_GT(size, 64u * kPeople);
  EXPECT_EQ(sinew_world_record(scene.street, 1), SINEW_UNSUPPORTED);
  EXPECT_EQ(sinew_world_restore(scene.street, SINEW_SNAPSHOT_STATE, few, 3), SINEW_BAD_FILE);
  EXPECT_EQ(sinew_crowd_stop(scene.street, kPeople), SINEW_INVALID_ARGUMENT);
  EXPECT_EQ(sinew_crowd_stop(scene.world, 0), SINEW_INVALID_ARGUMENT) << "a world without a crowd";
  sinew_crowd_settings settings = initialised(sinew_crowd_settings_init);
  sinew_world out = 0;
  settings.lanes = 7;
  EXPECT_EQ(sinew_crowd_create(scene.asset, &settings, nullptr, nullptr, &out), SINEW_INVALID_ARGUMENT);
  settings.lanes = 0;
  settings.places = settings.capacity + 1;
  EXPECT_EQ(sinew_crowd_create(scene.asset, &settings, nullptr, nullptr, &out), SINEW_INVALID_ARGUMENT);
  EXPECT_EQ(sinew_crowd_create(scene.world, nullptr, nullptr, nullptr, &out), SINEW_BAD_HANDLE);
  EXPECT_EQ(sinew_crowd_create(scene.asset, nullptr, nullptr, nullptr, nullptr), SINEW_INVALID_ARGUMENT);
  EXPECT_EQ(out, 0u);
}

}  // namespace
}  // namespace sinew
