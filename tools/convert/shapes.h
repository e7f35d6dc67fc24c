// Colliders fitted to the vertices that follow a part.
#pragma once

#include <vector>

#include "sinew/skeleton/skeleton.h"

namespace sinew::convert {

/// Capsule around `vertices` (joint's frame, m): along the unit vector `bone`, or along one of the part's own
/// axes where that comes nearer to the skin (a pelvis is wider than deep). `height`: of the
/// character, m. Needs at least two vertices.
Collider fit_capsule(const std::vector<Vec3<double>>& vertices, const Vec3<double>& bone, double height);

/// Box of a foot or of toes, its faces level at rest, that reaches the sole. `rest`: joint → model.
Collider fit_sole(const std::vector<Vec3<double>>& vertices, const Vec3<double>& bone,
                  const Quat<double>& rest, double height);

/// A robot's part: the box along the axes of its frame, or a capsule, whichever holds all vertices in less
/// space. `bone`: unit vector along the part. Needs at least two vertices.
Collider fit_part(const std::vector<Vec3<double>>& vertices, const Vec3<double>& bone);

}  // namespace sinew::convert
