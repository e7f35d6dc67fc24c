// Strands, cloth and soft tissue in a world: rest shapes, both ways, energy, bits.
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <cstdio>

#include "fixtures/counting_new.h"
#include "sinew/character/world.h"
#include "sinew/effects/cloth.h"
#include "sinew/effects/soft_tissue.h"
#include "sinew/effects/strand.h"

namespace sinew {
namespace {

using V = Vec3<double>;

constexpr double kH = 1.0 / 60;

WorldSettings airborne() {
  WorldSettings settings;
  settings.ground = false;
  return settings;
}

template <class T>
void probe(const char* what, const ParticleBody& body, double seconds, double h) {
  World<T> world(airborne());
  Status status;
  ASSERT_EQ(world.add_particles(body, status), 0) << status.reason;
  long passes = 0, unconverged = 0, steps = 0;
  int most = 0;
  double e0 = 0, gain = 0;
  const auto begin = std::chrono::steady_clock::now();
  for (; double(steps) < seconds / h; ++steps) {
    ASSERT_TRUE(world.step(T(h)).ok());
    const CharacterReport& r = world.particle_report(0);
    passes += r.outer_passes;
    most = std::max(most, r.outer_passes);
    unconverged += !r.converged;
    const double e = r.kinetic_energy + r.potential_energy + r.elastic_energy;
    if (steps == 0) e0 = e;
    gain = std::max(gain, e - e0);
  }
  const double us = std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now() - begin).count();
  const CharacterReport& r = world.particle_report(0);
  const auto last = world.particle(0, int(body.nodes.size()) - 1);
  std::printf("%s %zu: %.1f us/step, passes %.2f/%d, unconverged %ld, gain %g, kinetic %g, last %g %g %g\n",
              what, body.nodes.size(), us / double(steps), double(passes) / double(steps), most, unconverged,
              gain, r.kinetic_energy, double(last.x()), double(last.y()), double(last.z()));
}

TEST(Particles, Probe) {
  for (const int n : {8, 12, 24, 48}) {
    StrandSettings s;
    s.direction = {1, 0, 0};
    s.particles = n;
    for (const bool chain : {true, false}) {
      ParticleBody b = make_strand(s);
      b.chain = chain;
      probe<float>(chain ? "chain f" : "star f", b, 5, kH);
      probe<double>(chain ? "chain d" : "star d", b, 5, kH);
    }
  }
  for (const int n : {8, 16}) {
    ClothSettings c;
    make_grid(0.6, 0.6, n, n, c);
    c.fixed = {0, n};
    for (V& x : c.positions) std::swap(x.y(), x.z());
    probe<float>("cloth f", make_cloth(c), 3, kH);
    probe<double>("cloth d", make_cloth(c), 3, kH);
  }
  SoftTissueSettings t;
  make_block({0.3, 0.1, 0.1}, {6, 2, 2}, t);
  for (int k = 0; k < 9; ++k) t.fixed.push_back(7 * k);
  probe<float>("tissue f", make_soft_tissue(t), 3, kH);
  probe<double>("tissue d", make_soft_tissue(t), 3, kH);
}

}  // namespace
}  // namespace sinew
