// Strands, cloth and soft tissue in a world: rest shapes, both ways, energy, bits.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "fixtures/counting_new.h"
#include "sinew/character/world.h"
#include "sinew/effects/cloth.h"
#include "sinew/effects/soft_tissue.h"
#include "sinew/effects/strand.h"
#include "study/linkage.h"

namespace sinew {
namespace {

using V = Vec3<double>;
using study::Linkage;

constexpr double kH = 1.0 / 60;
constexpr double kGravity = 9.81;

WorldSettings airborne() {
  WorldSettings settings;
  settings.ground = false;
  return settings;
}

StrandSettings strand_along_x(int particles) {
  StrandSettings s;
  s.direction = {1, 0, 0};
  s.particles = particles;
  return s;
}

ParticleBody small_cloth() {
  ClothSettings cloth;
  make_grid(0.4, 0.4, 5, 5, cloth);
  for (V& x : cloth.positions) std::swap(x.y(), x.z());  // lying, to fall
  cloth.fixed = {0, 5};
  return make_cloth(cloth);
}

ParticleBody small_tissue() {
  SoftTissueSettings tissue;
  make_block({0.3, 0.1, 0.1}, {3, 1, 1}, tissue);
  for (int n = 0; n < 4; ++n) tissue.fixed.push_back(4 * n);
  return make_soft_tissue(tissue);
}

template <class T>
struct Scene {
  World<T> world;

  explicit Scene(const ParticleBody& body, const WorldSettings& settings = airborne()) : world(settings) {
    add(body);
  }
  explicit Scene(const WorldSettings& settings) : world(settings) {}
  void add(const ParticleBody& body) {
    Status status;
    EXPECT_GE(world.add_particles(body, status), 0) << status.reason;
  }
  void run(double seconds, double h = kH) {
    const int steps = static_cast<int>(std::lround(seconds / h));
    for (int n = 0; n < steps; ++n) ASSERT_TRUE(world.step(T(h)).ok());
  }
  double energy() const {
    const CharacterReport& r = world.particle_report(0);
    return r.kinetic_energy + r.potential_energy + r.elastic_energy;
  }
  std::vector<std::byte> snapshot() {
    std::vector<std::byte> bytes(world.snapshot_capacity());
    bytes.resize(world.save(bytes));
    return bytes;
  }
};

/// Both ends held 1 m apart by a rope of length 1.5 m without bending stiffness.
TEST(Strand, HangsAsACatenary) {
  constexpr int kParticles = 60;
  StrandSettings s = strand_along_x(kParticles);
  s.clamped = false;
  s.length = 1.5;
  s.bending = 0;
  s.stretch = 1e-4;
  s.damping = 2e-3;  // comes to rest in a second
  ParticleBody rope = make_strand(s);
  // Laid out along a half circle of that length, its last node held where it ends.
  const double turn = 3.14159265358979 / kParticles, radius = 0.5;
  for (std::size_t n = 0; n < rope.nodes.size(); ++n)
    rope.nodes[n].position = {radius - radius * std::cos(turn * double(n)), 0,
                              -radius * std::sin(turn * double(n))};
  rope.nodes.back().fixed = true;
  Scene<double> scene(rope);
  scene.run(8);
  // Length L over a span d: 2 a sinh(d/2a) = L, sag a (cosh(d/2a) − 1).
  double low = 0.01, high = 10;
  for (int n = 0; n < 200; ++n) {
    const double a = 0.5 * (low + high);
    (2 * a * std::sinh(0.5 / a) > 1.5 ? low : high) = a;
  }
  const double sag = low * (std::cosh(0.5 / low) - 1);
  double lowest = 0;
  for (int n = 0; n <= kParticles; ++n) lowest = std::min(lowest, scene.world.particle(0, n).z());
  EXPECT_LT(scene.world.particle_report(0).kinetic_energy, 1e-6);
  EXPECT_NEAR(-lowest, sag, 0.005) << "sixty segments, and stretching by its weight";
}

TEST(Strand, BeamSagsAsBernoulliSays) {
  // Clamped, under its own weight: w L⁴/(8 E I) at the tip.
  StrandSettings s = strand_along_x(80);
  s.stretch = 1e-5;
  s.mass = 0.01;
  s.bending = s.mass * kGravity * std::pow(s.length, 3) / 8 / 0.01;  // 1 cm at the tip
  s.damping = 5e-3;
  Scene<double> scene(make_strand(s));
  scene.run(4);
  const V tip = scene.world.particle(0, 81);
  EXPECT_NEAR(tip.z(), -0.01, 0.05 * 0.01)
      << "held half a segment before the root: (1 + 1/160)^4, and as much at the tip";
}

TEST(Strand, WhatHangsOnABodyPullsIt) {
  // Both ways: a rod on a hinge that is balanced tips to the side of the strand.
  Linkage l;
  l.add_rod(-1, JointType::kRevolute, {0, 0, 0}, {1, 0, 0}, V::UnitY(), 1, 0.05);
  l.skeleton.joints[0].center_of_mass.setZero();
  CharacterSettings limp;
  limp.root = RootDrive::kFree;
  limp.strength = 0;
  for (const bool with_strand : {false, true}) {
    Scene<float> scene(airborne());
    Status status;
    ASSERT_EQ(scene.world.add_character(l.skeleton, limp, status), 0) << status.reason;
    (void)scene.world.character(0).reset();
    StrandSettings s;
    s.frame = l.anchor(0, {1, 0, 0});
    s.mass = 0.1;
    if (with_strand) scene.add(make_strand(s));
    scene.run(0.5);
    const double tip = double((scene.world.character(0).model()[0] * Vec3<float>(1, 0, 0)).z());
    if (with_strand)
      EXPECT_LT(tip, -0.05);
    else
      EXPECT_EQ(tip, 0) << "balanced";
  }
}

TEST(Strand, FreePairOfParticlesKeepsItsMomentum) {
  WorldSettings settings = airborne();
  settings.gravity.setZero();
  ParticleBody body = make_strand(strand_along_x(8));
  for (ParticleNode& node : body.nodes)
    if (node.fixed) node = {node.position, 0.002, false};
  Scene<double> scene(body, settings);
  (void)scene.world.reset_particles(0, {1, 2, 3});
  scene.run(1);
  double mass = 0;
  for (const ParticleNode& node : body.nodes) mass += node.mass;
  const V momentum = scene.world.particle_report(0).momentum;
  EXPECT_LT((momentum - mass * V(1, 2, 3)).norm(), 1e-7 * mass);
}

TEST(Particles, EnergyNeverRises) {
  for (const double h : {1.0 / 30, 1.0 / 60, 1.0 / 240})
    for (const ParticleBody& body : {make_strand(strand_along_x(12)), small_cloth(), small_tissue()}) {
      Scene<float> scene(body);
      double start = 0, most = 0, kinetic = 0;
      for (int n = 0; n < 2 / h; ++n) {
        ASSERT_TRUE(scene.world.step(float(h)).ok());
        const CharacterReport& r = scene.world.particle_report(0);
        if (n == 0) start = scene.energy();
        most = std::max(most, scene.energy() - start);
        kinetic = std::max(kinetic, r.kinetic_energy);
        EXPECT_TRUE(r.converged) << body.name << " at " << n * h << " s, h " << h;
      }
      EXPECT_LT(most, 1e-3 * kinetic) << body.name << ", h " << h;
      EXPECT_GT(kinetic, 1e-3) << body.name;
    }
}

TEST(Particles, LieOnTheFloor) {
  for (ParticleBody body : {make_strand(strand_along_x(8)), small_cloth(), small_tissue()}) {
    for (ParticleNode& node : body.nodes)
      if (node.fixed) node = {node.position, 0.005, false};
    body.frame.frame.translation = {0, 0, 0.1};
    Scene<float> scene(body, WorldSettings());
    scene.run(3);
    const int count = static_cast<int>(body.nodes.size());
    double lowest = 1, highest = -1;
    for (int n = 0; n < count; ++n) {
      lowest = std::min(lowest, double(scene.world.particle(0, n).z()));
      highest = std::max(highest, double(scene.world.particle(0, n).z()));
    }
    // 0.5 mm is what the character's weight on one point may sink; a body of particles is lighter.
    EXPECT_GT(lowest, body.radius - 5e-4) << body.name;
    EXPECT_LT(lowest, body.radius + 1e-3) << body.name;
    EXPECT_LT(highest, 0.15) << body.name;
    EXPECT_GT(scene.world.particle_report(0).contacts, 0) << body.name;
  }
}

TEST(Cloth, CatchesABall) {
  ClothSettings cloth;
  make_grid(1, 1, 10, 10, cloth);
  for (V& x : cloth.positions) x = {x.x() - 0.5, x.z() + 0.5, 1};
  cloth.fixed = {0, 10, 110, 120};
  cloth.radius = 0.04;  // no gap between neighbours 0.1 m apart for the ball
  Scene<float> scene(make_cloth(cloth));
  PropSettings ball;
  ball.mass = 0.2;
  ball.pose.translation = {0.02, 0.01, 1.3};
  Status status;
  ASSERT_EQ(scene.world.add_prop(ball, status), 0) << status.reason;
  scene.run(2);
  const Vec3<float> at = scene.world.prop_pose(0).translation;
  EXPECT_GT(at.z(), 0.3f) << "held, not fallen through: 20 m below by now";
  EXPECT_LT(at.z(), 1.1f);
}

TEST(SoftTissue, CubeStretchesAsTheMaterialSays) {
  // A long bar hung by its end face: ε = ρ g L/(2 E) on average, sides free.
  SoftTissueSettings tissue;
  make_block({0.1, 0.1, 0.4}, {1, 1, 4}, tissue);
  tissue.fixed = {16, 17, 18, 19};
  tissue.young = 1e5;
  tissue.poisson = 0.3;
  tissue.damping = 1;
  Scene<double> scene(make_soft_tissue(tissue));
  scene.run(3);
  double tip = 0;
  for (int n = 0; n < 4; ++n) tip += 0.25 * scene.world.particle(0, n).z();
  const double wanted = 1000 * kGravity * 0.4 * 0.4 / (2 * 1e5);  // 7.8 mm
  // Coarse linear tetrahedra whose upper face cannot shrink are stiffer; their lumped weights hang lower.
  EXPECT_NEAR(-tip, wanted, 0.15 * wanted);
}

TEST(SoftTissue, ComesBackFromBeingTurnedInsideOut) {
  SoftTissueSettings tissue;
  make_block({0.1, 0.1, 0.1}, {1, 1, 1}, tissue);
  const std::vector<V> rest = tissue.positions;
  tissue.damping = 0.5;
  WorldSettings settings = airborne();
  settings.gravity.setZero();
  ParticleBody body = make_soft_tissue(tissue);
  for (ParticleNode& node : body.nodes) node.position.z() *= -0.5;  // where it starts, not its rest shape
  Scene<float> scene(body, settings);
  scene.run(3);
  EXPECT_LT(scene.world.particle_report(0).elastic_energy, 1e-4) << "unstrained again";
}

TEST(Particles, SnapshotsGoOnToTheBitAndRunsRepeat) {
  const ParticleBody bodies[] = {make_strand(strand_along_x(12)), small_cloth(), small_tissue()};
  for (const ParticleBody& body : bodies) {
    Scene<float> one(body), other(body);
    one.run(0.3);
    ASSERT_TRUE(other.world.restore(one.snapshot()).ok());
    one.run(0.3);
    other.run(0.3);
    EXPECT_EQ(one.snapshot(), other.snapshot()) << body.name;
  }
}

TEST(Particles, StepsAllocateNothing) {
  Scene<float> scene(make_strand(strand_along_x(12)), WorldSettings());
  scene.add(small_cloth());
  scene.add(small_tissue());
  const long before = fixtures::allocations;
  for (int n = 0; n < 60; ++n) (void)scene.world.step(float(kH));
  EXPECT_EQ(fixtures::allocations - before, 0);
}

TEST(Particles, FixedNodesRideOnTheirFrame) {
  Linkage l;
  l.add_rod(-1, JointType::kFree, {0, 0, 0}, {1, 0, 0}, V::UnitY(), 1, 0.05);
  Scene<float> scene(airborne());
  Status status;
  ASSERT_EQ(scene.world.add_character(l.skeleton, {}, status), 0) << status.reason;
  (void)scene.world.character(0).reset();
  StrandSettings s;
  s.frame = l.anchor(0, {1, 0, 0});
  scene.add(make_strand(s));
  JointJet<float> jet;
  for (int n = 1; n <= 60; ++n) {
    jet.translation = {0.01f * float(n), 0, 0};
    jet.velocity = {0.6f, 0, 0};
    ASSERT_TRUE(scene.world.character(0).set_target({&jet, 1}).ok());
    ASSERT_TRUE(scene.world.step(float(kH)).ok());
    EXPECT_LT((scene.world.particle(0, 1) - Vec3<float>(1 + jet.translation.x(), 0, 0)).norm(), 1e-5f);
  }
  EXPECT_GT(scene.world.particle(0, 13).x(), 1.3f) << "the rest is drawn along";
}

}  // namespace
}  // namespace sinew
