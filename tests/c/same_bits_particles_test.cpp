// Strands, cloth, soft tissue and tones through the C interface are those of C++, to the bit.
#include <cmath>
#include <cstring>
#include <limits>

#include "c/scene.h"
#include "sinew/animation/sampling_job.h"
#include "sinew/character/world.h"
#include "sinew/effects/cloth.h"
#include "sinew/effects/soft_tissue.h"
#include "sinew/effects/strand.h"
#include "sinew/io/asset.h"

namespace sinew {
namespace {

using fixtures::CScene;
using fixtures::initialised;

constexpr float kStep = 1 / 60.f;
constexpr int kFrames = 30;

/// Where all nodes of all bodies are in every frame.
using Places = std::vector<float>;

ClothSettings flag() {
  ClothSettings cloth;
  make_grid(0.3, 0.3, 3, 3, cloth);
  for (Vec3<double>& p : cloth.positions) p += Vec3<double>(2, 0, 1.5);
  cloth.fixed = {0, 3};
  return cloth;
}

SoftTissueSettings cushion() {
  SoftTissueSettings tissue;
  make_block({0.2, 0.2, 0.2}, {1, 1, 1}, tissue);
  for (Vec3<double>& p : tissue.positions) p += Vec3<double>(3, 0, 0.5);
  tissue.fixed = {0, 1};
  return tissue;
}

Places run_in_cpp() {
  Asset asset;
  EXPECT_TRUE(load_asset(fixtures::sample_asset().c_str(), asset));
  World<float> world({});
  Status status;
  Character<float> hero = world.character(world.add_character(asset.skeleton, {}, status));
  std::vector<JointJet<float>> jets(asset.skeleton.joints.size());
  EXPECT_TRUE((SamplingJob<float>{&asset.clips[0], 0.0, jets}.Run()));
  EXPECT_TRUE(hero.set_target(jets));
  EXPECT_TRUE(hero.reset());
  StrandSettings tail;
  tail.frame.kind = AnchorKind::kCharacter;
  tail.frame.index = 0;
  tail.frame.joint = asset.skeleton.find(Role::kHead);
  tail.root = {-0.1, 0, 0.1};
  tail.direction = {-1, 0, 0};
  tail.particles = 5;
  EXPECT_EQ(world.add_particles(make_strand(tail), status), 0) << status.reason;
  EXPECT_EQ(world.add_particles(make_cloth(flag()), status), 1) << status.reason;
  EXPECT_EQ(world.add_particles(make_soft_tissue(cushion()), status), 2) << status.reason;
  Places places;
  for (int frame = 0; frame < kFrames; ++frame) {
    EXPECT_TRUE((SamplingJob<float>{&asset.clips[0], frame / 60.0, jets}.Run()));
    EXPECT_TRUE(hero.set_target(jets));
    EXPECT_TRUE(world.step(kStep));
    for (const auto& [body, nodes] : {std::pair(0, 7), std::pair(1, 16), std::pair(2, 8)})
      for (int n = 0; n < nodes; ++n) {
        const Vec3<float> at = world.particle(body, n);
        places.insert(places.end(), at.data(), at.data() + 3);
      }
  }
  return places;
}

struct Hung : CScene {
  sinew_particles tail = 0, flag_ = 0, cushion_ = 0;

  Hung() {
    sinew_strand strand = initialised(sinew_strand_init);
    int head = -1;
    EXPECT_EQ(sinew_asset_find_role(asset, SINEW_ROLE_HEAD, &head), SINEW_OK);
    strand.frame.kind = SINEW_ANCHOR_CHARACTER;
    strand.frame.handle = hero;
    strand.frame.joint = head;
    strand.root[0] = -0.1;
    strand.root[2] = 0.1;
    strand.direction[0] = -1;
    strand.direction[2] = 0;
    strand.particles = 5;
    EXPECT_EQ(sinew_world_add_strand(world, &strand, &tail), SINEW_OK) << sinew_last_reason();
    const ClothSettings cloth = flag();
    sinew_cloth of_cloth = cloth_of(cloth);
    EXPECT_EQ(sinew_world_add_cloth(world, &of_cloth, &flag_), SINEW_OK) << sinew_last_reason();
    const SoftTissueSettings tissue = cushion();
    sinew_soft_tissue of_tissue = initialised(sinew_soft_tissue_init);
    of_tissue.node_count = static_cast<int>(tissue.positions.size());
    of_tissue.positions = tissue.positions[0].data();
    of_tissue.tetrahedron_count = static_cast<int>(tissue.tetrahedra.size());
    of_tissue.tetrahedra = tissue.tetrahedra[0].data();
    of_tissue.fixed_count = 2;
    of_tissue.fixed = tissue.fixed.data();
    EXPECT_EQ(sinew_world_add_soft_tissue(world, &of_tissue, &cushion_), SINEW_OK) << sinew_last_reason();
  }
  static sinew_cloth cloth_of(const ClothSettings& cloth) {
    sinew_cloth c = initialised(sinew_cloth_init);
    static_assert(sizeof(Vec3<double>) == 3 * sizeof(double));
    c.node_count = static_cast<int>(cloth.positions.size());
    c.positions = cloth.positions[0].data();
    c.triangle_count = static_cast<int>(cloth.triangles.size());
    c.triangles = cloth.triangles[0].data();
    c.fixed_count = static_cast<int>(cloth.fixed.size());
    c.fixed = cloth.fixed.data();
    return c;
  }
  std::vector<sinew_particle> nodes(sinew_particles of) const {
    std::vector<sinew_particle> out(32);
    std::int32_t count = 0;
    EXPECT_EQ(sinew_particles_get_nodes(of, out.data(), 32, &count), SINEW_OK) << sinew_last_reason();
    out.resize(std::size_t(count));
    return out;
  }
};

TEST(CInterfaceParticles, GoTheWayOfTheSameRunInCpp) {
  const Places wanted = run_in_cpp();
  const Hung scene;
  Places places;
  for (int frame = 0; frame < kFrames; ++frame) {
    scene.play(frame / 60.0);
    scene.step();
    for (const sinew_particles of : {scene.tail, scene.flag_, scene.cushion_})
      for (const sinew_particle& node : scene.nodes(of))
        places.insert(places.end(), node.position, node.position + 3);
  }
  ASSERT_EQ(places.size(), wanted.size());
  EXPECT_EQ(std::memcmp(places.data(), wanted.data(), places.size() * sizeof(float)), 0);
  const float begin = places[3 * 6 + 2], end = places[places.size() - 3 * 31 + 3 * 6 + 2];
  EXPECT_LT(end, begin - 0.05f) << "m: the end of the strand has fallen";

  const float none[3] = {0, 0, 0};
  ASSERT_EQ(sinew_particles_reset(scene.tail, none), SINEW_OK) << sinew_last_reason();
  scene.step();
  EXPECT_GT(scene.nodes(scene.tail)[6].position[2], end + 0.04f) << "m: it is straight again";
  sinew_character_report report{};
  report.size = sizeof report;
  ASSERT_EQ(sinew_particles_get_report(scene.flag_, &report), SINEW_OK);
  EXPECT_EQ(report.dofs, 14 * 3);
  sinew_particles again = 0;
  ASSERT_EQ(sinew_world_get_particles(scene.world, 1, &again), SINEW_OK);
  EXPECT_EQ(again, scene.flag_);
}

TEST(CInterfaceParticles, WhatCannotBeMeantIsRefused) {
  const Hung scene;
  const auto expect = [](sinew_status status, sinew_status wanted, const char* reason) {
    EXPECT_EQ(status, wanted) << reason;
    EXPECT_NE(std::string(sinew_last_reason()).find(reason), std::string::npos) << sinew_last_reason();
  };
  sinew_particles out = 0;
  ClothSettings cloth = flag();
  sinew_cloth c = Hung::cloth_of(cloth);
  c.stretch = -1;
  expect(sinew_world_add_cloth(scene.world, &c, &out), SINEW_INVALID_ARGUMENT, "stretch");
  c = Hung::cloth_of(cloth);
  c.triangles = nullptr;
  expect(sinew_world_add_cloth(scene.world, &c, &out), SINEW_INVALID_ARGUMENT, "null");
  cloth.triangles[4][1] = 16;
  c = Hung::cloth_of(cloth);
  expect(sinew_world_add_cloth(scene.world, &c, &out), SINEW_INVALID_ARGUMENT, "element");
  EXPECT_EQ(sinew_last_index(), 4);
  cloth = flag();
  cloth.fixed[1] = -1;
  c = Hung::cloth_of(cloth);
  expect(sinew_world_add_cloth(scene.world, &c, &out), SINEW_INVALID_ARGUMENT, "fixed");
  cloth = flag();
  cloth.positions[2].x() = NAN;
  c = Hung::cloth_of(cloth);
  expect(sinew_world_add_cloth(scene.world, &c, &out), SINEW_NOT_FINITE, "position");
  expect(sinew_world_add_cloth(scene.world, nullptr, &out), SINEW_INVALID_ARGUMENT, "null");
  sinew_strand strand = initialised(sinew_strand_init);
  EXPECT_EQ(strand.particles, StrandSettings().particles);
  EXPECT_EQ(strand.direction[2], -1);
  strand.direction[2] = 0;
  expect(sinew_world_add_strand(scene.world, &strand, &out), SINEW_INVALID_ARGUMENT, "direction");
  strand = initialised(sinew_strand_init);
  strand.frame.kind = SINEW_ANCHOR_PROP;
  strand.frame.handle = scene.hero;
  expect(sinew_world_add_strand(scene.world, &strand, &out), SINEW_BAD_HANDLE, "another kind");
  expect(sinew_world_add_strand(scene.world, nullptr, nullptr), SINEW_INVALID_ARGUMENT, "null");
  const float wild[3] = {0, NAN, 0};
  expect(sinew_particles_reset(scene.tail, wild), SINEW_NOT_FINITE, "velocity");
  std::int32_t count = 0;
  expect(sinew_particles_get_nodes(scene.flag_, nullptr, 0, &count), SINEW_TOO_SMALL, "nodes");
  EXPECT_EQ(count, 16);
  expect(sinew_world_get_particles(scene.world, 3, &out), SINEW_INVALID_ARGUMENT, "particles");
}

TEST(CInterfaceTones, GiveWayAsInCpp) {
  Asset asset;
  ASSERT_TRUE(load_asset(fixtures::sample_asset().c_str(), asset));
  World<float> world({});
  Status status;
  CharacterSettings settings;
  settings.tone = Tone::kAlert;
  Character<float> hero = world.character(world.add_character(asset.skeleton, settings, status));
  const int arm = asset.skeleton.find(Role::kForearmL), chest = asset.skeleton.find(Role::kChest);
  ASSERT_TRUE(hero.set_tone(arm, Tone::kRelaxed));
  ASSERT_TRUE(hero.set_tone(chest, Stiffness{50, 0.5}));

  const CScene scene;
  sinew_character_settings of_c = initialised(sinew_character_settings_init);
  EXPECT_EQ(of_c.tone, SINEW_TONE_RIGID);
  of_c.tone = SINEW_TONE_ALERT;
  sinew_character other = 0;
  sinew_world alone = 0;
  ASSERT_EQ(sinew_world_create(nullptr, &alone), SINEW_OK);
  ASSERT_EQ(sinew_world_add_character(alone, scene.asset, &of_c, &other), SINEW_OK) << sinew_last_reason();
  ASSERT_EQ(sinew_character_set_joint_tone(other, arm, SINEW_TONE_RELAXED), SINEW_OK) << sinew_last_reason();
  ASSERT_EQ(sinew_character_set_joint_stiffness(other, chest, 50, 0.5), SINEW_OK) << sinew_last_reason();
  for (int dof = 0; dof < asset.skeleton.dof_total(); ++dof) {
    double stiffness = 0, ratio = 0;
    ASSERT_EQ(sinew_character_get_stiffness(other, dof, &stiffness, &ratio), SINEW_OK);
    EXPECT_EQ(stiffness, hero.tone(dof).stiffness) << dof;
    EXPECT_EQ(ratio, hero.tone(dof).damping_ratio) << dof;
  }
  EXPECT_EQ(sinew_character_set_tone(other, 4), SINEW_INVALID_ARGUMENT);
  EXPECT_EQ(sinew_character_set_group_tone(other, "no such group", SINEW_TONE_ALERT), SINEW_NOT_FOUND);
  EXPECT_EQ(sinew_character_set_group_strength(other, "", 1), SINEW_NOT_FOUND);
  EXPECT_EQ(sinew_character_set_joint_stiffness(other, chest, -1, 0.5), SINEW_INVALID_ARGUMENT);
  const sinew_play play{other, scene.asset, 0, 0, 0, 1, 0};
  std::vector<JointJet<float>> jets(asset.skeleton.joints.size());
  ASSERT_TRUE((SamplingJob<float>{&asset.clips[0], 0.0, jets}.Run()));
  ASSERT_TRUE(hero.set_target(jets));
  ASSERT_TRUE(hero.reset());
  ASSERT_EQ(sinew_play_clips(&play, 1), SINEW_OK);
  ASSERT_EQ(sinew_character_reset(other), SINEW_OK);
  const double at[3] = {0, 0, 1.2}, push[3] = {0, 20, 0};
  ASSERT_TRUE(hero.apply_impulse(chest, {0, 0, 1.2f}, {0, 20, 0}));
  ASSERT_EQ(sinew_character_apply_impulse(other, chest, at, push), SINEW_OK);
  for (int frame = 0; frame < 20; ++frame) {
    ASSERT_TRUE(world.step(kStep));
    ASSERT_EQ(sinew_world_step(alone, kStep), SINEW_OK);
  }
  sinew_view view{};
  ASSERT_EQ(sinew_character_get_view(other, SINEW_VIEW_LOCAL, &view), SINEW_OK);
  const auto* const local = static_cast<const sinew_transform*>(view.data);
  for (std::size_t j = 0; j < hero.local().size(); ++j)
    for (int k = 0; k < 4; ++k) EXPECT_EQ(local[j].rotation[k], hero.local()[j].rotation.coeffs()[k]) << j;
  EXPECT_FALSE(hero.on_animation());
  EXPECT_EQ(sinew_world_destroy(alone), SINEW_OK);
}

}  // namespace
}  // namespace sinew
