// How far one step goes astray because it is finite: an embedded estimate, from what the step leaves behind.
//
// Where nothing jumps, the trapezoidal rule h/2·(v₀ + v₁) differs from the way that a body has gone by h³/12
// of the change of its acceleration, and a step of Bossak's scheme by κ − 1/6 of that: their ratio, some 4/3,
// times the difference. Where something has been stopped within the step it is the way that this took, h/2 of
// the change of speed: as much as is not known. v of a body's centre; of its turning what differs from the
// free turn, which is exact. No second solve: about 80 flops per body. Step doubling was not taken, since it
// costs two more solves. What it cannot see: a solve that stopped short of its tolerance
// (CharacterReport::converged says so), and which of two ways an impact goes.
#pragma once

#include "sinew/optimizer/bossak.h"
#include "sinew/optimizer/problem.h"

namespace sinew {

/// First half, before `history` moves on from the start of the step of `h` seconds that `problem` holds the
/// solution of: what of their way bodies have not gone at half the speeds of the start, into `moved` (m,
/// world) and `turned` (rad, the body's axes, beside the free turn) [body]. What impulses just before the
/// step keep them from is not missing.
template <class T>
void begin_error(const TreeProblem<T>& problem, const History<T>& history, T h,
                 const Vec3<double>& common_origin, const Strike<T>& strike, std::span<Vec3<T>> moved,
                 std::span<Vec3<T>> turned);

/// Root mean square over all mass (m) of the local error of that step, with `history` at its end. `load`
/// [dof]: |torque| / limit of the muscles. Bodies that hang on played or unsaturated joints alone are where
/// the animation wants them: they count with 0.
template <class T>
double integration_error(const TreeProblem<T>& problem, const History<T>& history, std::span<const T> load,
                         T h, std::span<const Vec3<T>> moved, std::span<const Vec3<T>> turned);

#define SINEW_ERROR_INSTANCES(prefix, T)                                                              \
  prefix void begin_error<T>(const TreeProblem<T>&, const History<T>&, T, const Vec3<double>&,        \
                             const Strike<T>&, std::span<Vec3<T>>, std::span<Vec3<T>>);               \
  prefix double integration_error<T>(const TreeProblem<T>&, const History<T>&, std::span<const T>, T, \
                                     std::span<const Vec3<T>>, std::span<const Vec3<T>>);
SINEW_ERROR_INSTANCES(extern template, float)
SINEW_ERROR_INSTANCES(extern template, double)

}  // namespace sinew
