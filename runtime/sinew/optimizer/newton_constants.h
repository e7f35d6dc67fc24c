// Where Newton's method stops and turns: one solve and packs of them decide alike. Lengths are those of a
// figure of human size; others' are in proportion (residual/scale.h). Internal to the optimizer.
#pragma once

namespace sinew {

// Of an outer pass (newton.h)
/// m; after a shorter full step the pass's own matrix leads on. With contacts a simplified step may cost a
/// factorisation, or conjugate gradients over all who touch: at 0.03 a pile of a crowd took four times as
/// long.
constexpr double kStillValid = 0.03, kStillValidInContact = 0.01;
constexpr double kSimplifiedRate = 0.7;  ///< of the step before: steps that shrink less do not pay
/// Of simplified Newton steps to come, however fast the last one shrank: contacts may have changed since the
/// factor.
constexpr double kLeastRate = 0.25, kLeastRateInContact = 0.5;
/// Change of a contact's curvature, by its largest, that a factor may have missed: more would leave errors
/// above the tolerance.
constexpr double kSameCurvature = 0.7;
constexpr double kCautious = 0.1;  ///< of the tolerance, may be left after the last simplified step
/// Of the forces that contacts bore in the last step, or of the weight: where those at the guess are so much
/// larger, they are those of bodies that went through the floor, and their geometric terms mislead.
constexpr double kMisleading = 1.5;
/// Of the slope, what a full step leaves where the matrix is too stiff, and how much further to go at once.
constexpr double kUndershot = 0.25, kMostFurther = 8;
/// 1/m: what a whole Newton step through nothing but smooth terms leaves, by the square of its length. In
/// limp flights at 1 to 10 rad/s rms half leave less than 6, 99 in 100 less than 30 to 130 (1/240 to 1/30 s).
constexpr double kLeft = 30;
constexpr double kExactWithin = 10;  ///< tolerances: rounding too leaves a share of a step
/// Of the energies of pushes, by which the places where they act are rounded: two that make a couple cancel,
/// their roundings do not (a light link turned by 26 N m at an arm of 5 cm had good steps refused in float).
constexpr double kRoundings = 4;
/// Steps below so many tolerances that no longer shrink to this share of the shortest, so often in a row, are
/// as near as rounding lets them.
constexpr double kRoundingFloor = 10, kStalls = 0.5;
constexpr int kMostStalled = 2;
constexpr double kNegligible = 1e-3;  ///< of the tolerance: not worth an evaluation

// Of its convex model (inner_problem.h)
/// Of the first step, or of the way made so far where that is shorter: tighter costs factorisations, looser
/// outer passes.
constexpr double kShrink = 0.1;
/// What friction resists along a slip, at least, by what it resists across it. Exactly it is nothing, and the
/// step runs on to where the slip has turned round: a line search then stops at one kink after the other.
constexpr double kLeastDrag = 0.3;
/// A step that should have been longer by so much was held back by that: from then on by this share of it.
constexpr double kTooShort = 1.1, kRelease = 0.3;
/// Where kinks end a step at less than this share of it, among trees that touch, muscles beyond theirs count
/// with their whole secant.
constexpr double kCutShort = 0.03;
constexpr double kSameSlope =
    1e-5;  ///< of its own size: a row whose slope is so near to what a factor says has no kink there
constexpr int kMostInnerSteps = 8;
constexpr double kRotationArm = 0.15;  ///< m; turns a rotation into a displacement for the tolerance

}  // namespace sinew
