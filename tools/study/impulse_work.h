// Work of impulses that act at once: J·v + ½ J·M⁻¹·J, from the pose and the speeds before they do.
//
// A runtime's own book of it would be no check. Here the mass matrix is summed up body by body and solved as
// it is; nothing of the optimizer, its factors or its velocities is asked.
#pragma once

#include <span>

#include "sinew/residual/tree.h"

namespace sinew::study {

struct PointImpulse {
  int body = 0;
  Vec3<double> point, impulse;                ///< world; m, N·s
  Vec3<double> speed = Vec3<double>::Zero();  ///< m/s, of the point before it
};

/// J. Impulses on one tree at the same instant, its joints free but for the root's where that is led. O(n³).
double work_of_impulses(const Tree<double>& tree, std::span<const Transform<double>> local, bool root_is_led,
                        std::span<const PointImpulse> impulses);

}  // namespace sinew::study
