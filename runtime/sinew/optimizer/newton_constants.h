// Where Newton's method stops and turns: one solve and packs of them decide alike. Internal to the optimizer.
#pragma once

namespace sinew {

// Of an outer pass (newton.h)
/// m; after a shorter full step the pass's own matrix leads on. With contacts a chord may cost a
/// factorisation, or conjugate gradients over all who touch: at 0.03 a pile of a crowd took four times as
/// long.
constexpr double kStillValid = 0.03, kStillValidInContact = 0.01;
constexpr double kChordRate = 0.5;    ///< of the step before: chords that shrink less do not pay
constexpr double kCautious = 0.1;     ///< of the tolerance, for a chord to be the last
constexpr double kNegligible = 1e-3;  ///< of the tolerance: not worth an evaluation

// Of its convex model (inner_problem.h)
constexpr double kShrink = 0.1;  ///< of the first step: tighter costs factorisations, looser outer passes
constexpr int kMostInnerSteps = 8;
constexpr double kRotationArm = 0.15;  ///< m; turns a rotation into a displacement for the tolerance

}  // namespace sinew
