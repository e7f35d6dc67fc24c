#include "sinew/effects/loop.h"

#include <algorithm>
#include <cmath>

namespace sinew {
namespace {

constexpr double kSink = 1e-4;   ///< m of a human
constexpr double kTight = 5e-4;  ///< m of a human
constexpr double kArm =
    0.2;  ///< m of a human, of the points that hold an axis: a weight at 1 m turns it by 1 mrad

bool is_rotation(const Quat<double>& q) {
  return q.coeffs().allFinite() && std::abs(q.norm() - 1) < 1e-6;
}

}  // namespace

Status check(const LoopSettings& s) {
  if (!(s.length >= 0) || !std::isfinite(s.length))
    return Status::error(Code::kInvalidArgument, "loop's length must be ≥ 0");
  if (s.kind == LoopKind::kDistance && s.length == 0)
    return Status::error(Code::kInvalidArgument, "a rod needs a length");
  if (!(s.stiffness >= 0) || !std::isfinite(s.stiffness))
    return Status::error(Code::kInvalidArgument, "loop's stiffness must be ≥ 0");
  for (const Anchor* anchor : {&s.a, &s.b})
    if (!anchor->frame.translation.allFinite() || !is_rotation(anchor->frame.rotation))
      return Status::error(Code::kNotFinite, "loop's frame is not a finite rotation");
  return {};
}

template <class T>
Coupling<T> make_loop(const LoopSettings& settings, const Place& a, const Place& b, double weight,
                      double unit) {
  using V = Vec3<double>;
  const double arm = kArm * unit, half = 0.5 * arm, root = std::sqrt(0.75) * arm;
  const V hinge[] = {{0, 0, arm}, {0, 0, -arm}};
  const V weld[] = {{arm, 0, 0}, {-half, root, 0}, {-half, -root, 0}};
  const V point[] = {V::Zero()};
  std::span<const V> held = point;
  if (settings.kind == LoopKind::kHinge) held = hinge;
  if (settings.kind == LoopKind::kWeld) held = weld;
  Coupling<T> loop;
  loop.closes_slowly = true;
  loop.weight = weight;
  loop.length_scale = T(unit);
  loop.speed_scale = T(std::sqrt(unit));
  for (const V& x : held) {
    Stencil<T>& e = loop.stencils.emplace_back();
    e.stiffness = T(settings.stiffness > 0 ? settings.stiffness : weight / (kSink * std::min(unit, 1.0)));
    e.sinks = std::max(T(weight) / e.stiffness, T(kSink * unit));
    if (settings.kind == LoopKind::kDistance || settings.kind == LoopKind::kRope)
      e.length = T(settings.length);
    e.only_pulls = settings.kind == LoopKind::kRope;
    if (!(settings.stiffness > 0)) e.tight = T(kTight * unit);
    e.node[0] = static_cast<int>(loop.nodes.size());
    e.node[1] = e.node[0] + 1;
    for (const Place* place : {&a, &b}) {
      CouplingNode<T>& node = loop.nodes.emplace_back();
      node.state = place->state;
      node.body = place->body;
      node.place = place->frame * x;
      node.local = node.place.template cast<T>();
    }
  }
  return loop;
}

template Coupling<float> make_loop(const LoopSettings&, const Place&, const Place&, double, double);
template Coupling<double> make_loop(const LoopSettings&, const Place&, const Place&, double, double);

}  // namespace sinew
