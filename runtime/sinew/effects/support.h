// What the ground gives a character whose root is driven by the animation.
//
// A kinematic root bears the whole weight, so its legs would seem to hang. The residual wrench at the root is
// therefore shared out to the points that stand on the floor, and the joints between see what a standing
// body's joints see. Statically indeterminate with two feet: the smallest weighted forces that balance weight
// and tilt are taken, and they lean towards the hips as the forces of walking people do (Maus, Lipfert,
// Gross, Rummel & Seyfarth 2010, Nature Communications 1:70: they meet in a point above the centre of mass).
#pragma once

#include <span>

#include "sinew/effects/contact.h"

namespace sinew {

struct SupportSettings {
  double reach = 0.025;  ///< m; a point this high above the floor bears nothing, at the floor it bears fully
  double lean = 0.4;     ///< most that a force leans towards the hip, horizontal by vertical
};

/// Subtracts the support forces from the body wrenches (before project_wrenches). `force` and `moment` [body]
/// hold the wrenches that the motion asks for, about the common origin; `ground` is the floor's height from
/// it. Does nothing in flight. O(points).
template <class T>
void share_support(const Tree<T>& tree, const Kinematics<T>& kinematics,
                   std::span<const ContactPoint<T>> points, T ground, const SupportSettings& settings,
                   std::span<Vec3<T>> force, std::span<Vec3<T>> moment);

extern template void share_support<float>(const Tree<float>&, const Kinematics<float>&,
                                          std::span<const ContactPoint<float>>, float, const SupportSettings&,
                                          std::span<Vec3<float>>, std::span<Vec3<float>>);
extern template void share_support<double>(const Tree<double>&, const Kinematics<double>&,
                                           std::span<const ContactPoint<double>>, double,
                                           const SupportSettings&, std::span<Vec3<double>>,
                                           std::span<Vec3<double>>);

}  // namespace sinew
