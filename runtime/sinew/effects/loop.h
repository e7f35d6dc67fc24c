// Loop closure: two frames that stay together though no joint of a tree connects them.
//
// Hands on a bar, handcuffs, feet on pedals, the fourth bar of a four-bar. A closed point is one stencil of
// length 0, a hinge two points on its axis, a weld three: redundant or thrice declared loops only share the
// load (everything is an energy, so no rank matters). Forces act at both sides, on whatever is free to move.
#pragma once

#include "sinew/effects/coupling.h"
#include "sinew/skeleton/status.h"

namespace sinew {

/// What of two frames stays together.
enum class LoopKind : std::uint8_t {
  kPoint,     ///< the origins of the frames coincide: a ball joint
  kHinge,     ///< and their z axes
  kWeld,      ///< and all their axes
  kDistance,  ///< the origins stay `length` apart: a rod
  kRope,      ///< … or nearer
};

/// A loop between two frames, one of which may be the world's.
struct LoopSettings {
  LoopKind kind = LoopKind::kPoint;  ///< what it holds
  Anchor a;                          ///< one frame
  Anchor b;                          ///< the other
  double length = 0;                 ///< m; rod and rope
  double stiffness = 0;  ///< N/m of each point; 0: the weight of the heaviest tied to it moves it by 0.1 mm
  bool collide = false;  ///< the two bodies that it holds may touch each other
};

/// Numbers that can be meant: lengths and stiffness; the anchors are the world's business.
Status check(const LoopSettings& settings);

/// The elements between two places. `weight` (N): of the heavier side, for the stiffness that settings leave
/// open, until Coupling::bear(); `unit`: its length by a human's (Scale::length), by which hinges and welds
/// hold their axes further out.
template <class T>
Coupling<T> make_loop(const LoopSettings& settings, const Place& a, const Place& b, double weight,
                      double unit);

/// @cond
extern template Coupling<float> make_loop(const LoopSettings&, const Place&, const Place&, double, double);
extern template Coupling<double> make_loop(const LoopSettings&, const Place&, const Place&, double, double);
/// @endcond

}  // namespace sinew
