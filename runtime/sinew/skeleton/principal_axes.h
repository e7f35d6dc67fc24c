// Eigenvalues and eigenvectors of a symmetric matrix: principal moments of an inertia, axes of a cloud of
// points.
#pragma once

#include "sinew/skeleton/vector.h"

namespace sinew {

/// What principal_axes() finds.
struct PrincipalAxes {
  Vec3<double> values;  ///< ascending; units of the matrix
  Mat3<double>
      axes;  ///< a unit column for each value, perpendicular to the others; left-handed where it so happens
};

/// Of a symmetric matrix, whose lower triangle is read; by Eigen's QR iteration. For set-up, not for a step:
/// about 1 µs.
PrincipalAxes principal_axes(const Mat3<double>& symmetric);

}  // namespace sinew
