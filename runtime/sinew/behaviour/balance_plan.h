// How a body that was pushed keeps its balance: as a linear inverted pendulum, by moving what it presses on
// and, where that does not reach, by steps. Internal to behaviours.
//
// The centre of mass x over feet that press at p moves by x'' = ω²(x − p), ω² = g/height (Kajita). Its
// capture point ξ = x + x'/ω leaves p by ξ' = ω(ξ − p): pressed beyond it, ξ comes back; where ξ has left the
// soles only a step helps, to where ξ will be when the foot is down (Pratt et al., "Capture point: a step
// toward humanoid push recovery", 2006; Koolen et al., "Capturability-based analysis", 2012).
#pragma once

#include "sinew/behaviour/sole.h"

namespace sinew {

/// Of a human; a figure's by its size.
struct BalanceLaw {
  double gain = 2;       ///< 1/s, with which ξ is brought back
  double margin = 0.01;  ///< m, that pressing stays inside the soles
  /// Of the way from where ξ rests to the edge of the soles: who reacts to a push while it is further out
  /// steps, though he could press it back. People lean over 0.6 of their feet (King, Judge and Wolfson,
  /// "Functional base of support decreases with age", 1994); what soles press back before a body reacts is
  /// the rest.
  double functional = 0.35;
  double step_time = 0.30;     ///< s from lifting a foot to putting it down
  double join_time = 0.20;     ///< s, likewise of one that comes beside the other
  double longest_step = 1.05;  ///< m, between the ankles
  double apart = 0.12;         ///< m, least to its own side of the other foot
  double sideways = 0.65;      ///< rad off straight ahead or back, from which a push is one to the side
  double lift = 0.08;          ///< m
};

/// Seen from above, m and m/s.
struct Pendulum {
  Vec2 place = Vec2::Zero();         ///< m, x: of the centre of mass
  Vec2 velocity = Vec2::Zero();      ///< m/s
  Vec2 acceleration = Vec2::Zero();  ///< m/s², at the end of the last advance()

  /// ξ, m; ω in 1/s.
  Vec2 capture_point(double frequency) const { return place + velocity / frequency; }
  /// Moves on by h s while the feet press at `pressed`: exact.
  void advance(const Vec2& pressed, double frequency, double h);
};

/// Where the feet press, within `sole`, so that the capture point goes to `goal`.
Vec2 press(const Pendulum& body, double frequency, const Vec2& goal, const Sole& sole, const BalanceLaw& law);

/// Where the capture point will be in `seconds` while one foot presses as near to it as its sole allows.
Vec2 capture_point_after(const Vec2& now, double frequency, double seconds, const Sole& stance);

/// Where a body stands, seen from above.
struct Feet {
  std::array<Vec2, 2> place;  ///< m, ankles: left, right
  double yaw = 0;             ///< rad, where the body faces
};

/// Which foot has to step (0 left, 1 right) for a capture point outside the soles: the one on the side that
/// the body falls to, else the hind one.
int stepping_foot(const Feet& feet, const Vec2& capture_point, const Vec2& middle, const BalanceLaw& law);

/// A landing place, brought into reach of the standing foot and to its own side.
Vec2 within_reach(const Feet& feet, int swing, const Vec2& wanted, const BalanceLaw& law);

/// Whether so many steps can't catch a capture point that is `beyond` (m) outside the standing sole.
bool out_of_reach(double beyond, double frequency, int steps_left, const BalanceLaw& law);

}  // namespace sinew
