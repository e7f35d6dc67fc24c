#include "sinew/effects/strand.h"

namespace sinew {
namespace {

constexpr double kGravity = 9.81;  ///< m/s², of the weight that `stretch` speaks of

}  // namespace

ParticleBody make_strand(const StrandSettings& s) {
  if (!(s.direction.norm() > 0)) return {};  // no nodes: refused
  ParticleBody body;
  body.name = "strand";
  body.frame = s.frame;
  body.radius = s.radius;
  body.friction = s.friction;
  body.damping = s.damping;
  const double segment = s.length / s.particles;
  const Vec3<double> along = segment * s.direction.normalized();
  const int first = s.clamped ? -1 : 0;  // of the fixed nodes
  for (int n = first; n <= s.particles; ++n)
    body.nodes.push_back({s.root + n * along, s.mass / s.particles, n <= 0});
  const int count = static_cast<int>(body.nodes.size());
  // The weight below each of n segments, summed over all: m g (n + 1)/2 over the spring.
  const double spring = s.mass * kGravity * (s.particles + 1) / (2 * s.stretch * s.length);
  for (int n = s.clamped ? 2 : 1; n < count; ++n) {
    Stencil<double>& e = body.stencils.emplace_back();
    e.node[0] = n - 1;
    e.node[1] = n;
    e.stiffness = spring;
    e.length = segment;
  }
  // A beam's ½ EI ∫ x''² by second differences.
  for (int n = 2; n < count && s.bending > 0; ++n) {
    Stencil<double>& e = body.stencils.emplace_back();
    e.count = 3;
    for (int i = 0; i < 3; ++i) {
      e.node[i] = n - 2 + i;
      e.weight[i] = i == 1 ? -2 : 1;
    }
    e.stiffness = s.bending / (segment * segment * segment);
  }
  return body;
}

}  // namespace sinew
