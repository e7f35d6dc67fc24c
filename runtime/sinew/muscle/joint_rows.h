// Scalar energies of joints: muscles, dry friction, damping, limits.
//
// Each row is a function ψ(s) of one scalar s of one joint (an offset from the muscle's target, from the
// step's start, or beyond a limit). Within the inner convex problem s is linear in the joint's unknowns.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>

#include "sinew/skeleton/scalar.h"

namespace sinew {

enum class RowKind : std::uint8_t {
  kKink,  ///< |s| times the limit of its side, rounded over `width`: a muscle at its target, or dry friction
  kSpring,    ///< ½ k s²: damping over the step
  kOneSided,  ///< ½ k max(s, 0)²: joint limit, damped as a contact is (see JointRow::damp)
  kTone,  ///< ½ k s² until its force is the limit of its side, straight from there: a muscle that gives way
};

/// Which scalar of its joint a row is a function of.
enum class RowScalar : std::uint8_t {
  kFromTarget,  ///< offset from the muscle's target (see joint_offset)
  kFromStart,   ///< offset from the pose at the beginning of the step
  kFromRest,    ///< offset from the rest pose
  kSwing,       ///< angle of a ball joint's bone from its rest direction
  kTwist,       ///< rotation of a ball joint about its bone
};

template <class T>
struct JointRow {
  RowKind kind = RowKind::kKink;
  RowScalar scalar = RowScalar::kFromTarget;
  int component = 0;   ///< of the offset: which of a ball's or free joint's three rotations, if any
  Number<T> sign = 1;  ///< −1: the row's scalar is a lower bound minus the joint's
  bool muscle = false;
  int dof = 0;                  ///< first degree of freedom that `gradient` refers to, within its tree
  int count = 1;                ///< how many
  std::array<T, 3> gradient{};  ///< ds/dd
  T value = T(0);               ///< s at the chart centre
  T minus = T(0),
    plus = T(0);       ///< kink, tone: force for s < 0 pushes up with `plus`, for s > 0 down with `minus`
  T width = T(1e-5);   ///< kink: rounding
  T stiffness = T(0);  ///< of the others
  T stretch = T(1), lag = T(0);  ///< one-sided: what bears is stretch·s − lag

  /// One-sided: the force is that of where s will be a damping time (s) later, and never a pull. `start` is s
  /// when the step of h seconds began.
  void damp(T damping_time, T h, T start) {
    stretch = T(1) + damping_time / h;
    lag = damping_time / h * largest(start, T(0));
  }
  /// What a one-sided row stores at s; its energy(s) is the potential of the step, damping included.
  T stored_energy(T s) const { return s > T(0) ? T(0.5) * stiffness * s * s : T(0); }

  T energy(const T& s) const {
    using std::abs;
    const T zero = T(0);
    switch (kind) {
      case RowKind::kSpring:
        return T(0.5) * stiffness * s * s;
      case RowKind::kOneSided:
        return select(beyond(s) > zero, T(T(0.5) * stiffness * beyond(s) * beyond(s) / stretch), zero);
      case RowKind::kTone:
        return choose(
            abs(s) * stiffness < side(s), [&] { return T(T(0.5) * stiffness * s * s); },
            [&] { return T(side(s) * (abs(s) - side(s) / (2 * stiffness))); });
      case RowKind::kKink:
        break;
    }
    const T limit = select(s > zero, minus, plus);
    const T a = abs(s);
    return choose(
        a < width, [&] { return T(limit * a * a / (2 * width)); },
        [&] { return T(limit * (a - width / 2)); });
  }
  T slope(const T& s) const {
    const T zero = T(0);
    switch (kind) {
      case RowKind::kSpring:
        return stiffness * s;
      case RowKind::kOneSided:
        return select(beyond(s) > zero, T(stiffness * beyond(s)), zero);
      case RowKind::kTone:
        return smallest(largest(T(stiffness * s), T(-plus)), minus);
      case RowKind::kKink:
        break;
    }
    const T limit = select(s > zero, minus, plus);
    const auto saturated = [&] { return select(s >= width, limit, T(-limit)); };
    return choose(either(s >= width, s <= -width), saturated, [&] { return T(limit * s / width); });
  }
  T curvature(const T& s) const {
    using std::abs;
    const T zero = T(0);
    switch (kind) {
      case RowKind::kSpring:
        return stiffness;
      case RowKind::kOneSided:
        return select(beyond(s) > zero, T(stiffness * stretch), zero);
      case RowKind::kTone:
        return choose(
            abs(s) * stiffness < side(s), [&] { return stiffness; }, [&] { return zero; });
      case RowKind::kKink:
        break;
    }
    return choose(
        abs(s) < width, [&] { return T(select(s > zero, minus, plus) / width); }, [&] { return zero; });
  }

 private:
  T side(const T& s) const { return select(s > T(0), minus, plus); }
  T beyond(T s) const { return stretch * s - lag; }
};

/// Over what a muscle's kink is rounded in a step of h seconds of a human's time (rad): 1e-3 rad/s. The way
/// back starts from a joint's own rate, so a muscle that gives way gains up to this much per step beyond what
/// its limit allows: below 1/60 s the width falls with the square of the step, which makes it an acceleration
/// of 0.06 rad/s². Not below what the scalar and the solver's tolerance (m, at a metre) resolve; a
/// correction's square is what it leaves.
template <class T>
T kink_width(T h, T tolerance) {
  const T resolved = std::max(8 * std::numeric_limits<T>::epsilon(), tolerance / 16);
  return std::min(T(1e-3) * h, std::max(T(0.06) * h * h, resolved));
}

}  // namespace sinew
