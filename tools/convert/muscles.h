// Muscle torque limits: published strengths along a joint's anatomical directions, and what the clips ask.
#pragma once

#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "sinew/animation/clip.h"
#include "sinew/skeleton/skeleton.h"

namespace sinew::convert {

/// Directions in which anatomy names a joint's muscles. Columns of `axes` are unit vectors in the joint's own
/// axes at rest; `plus[k]` and `minus[k]` name the rows (`muscle_rows`) that turn the child about column k.
struct AnatomicalAxes {
  Mat3<double> axes;
  const char* plus[3];
  const char* minus[3];
};

/// `bone`: towards the child, model axes at rest; arms are read as if they had been raised from hanging
/// straight to it. `rest`: joint → model. False for a joint without a role (and for the root of a tree, which
/// no muscle holds).
bool anatomical_axes(Role role, const Vec3<double>& bone, const Quat<double>& rest, AnatomicalAxes& out);

/// Sets torque_minus and torque_plus of a joint from the rows times `scale` (kg · stature / reference
/// stature). A ball's limit about one of its own axes is where that axis leaves the ellipsoid through the six
/// published directions, so rigs with any bone axes get the same strength; a hinge has the flexion and
/// extension rows.
void set_muscles(const AnatomicalAxes& anatomy, const std::map<std::string, double>& rows, double scale,
                 Joint& joint);

/// Raises every muscle, each direction by itself, to the peak torque that the clips ask for 50 ms or longer
/// (recursive residual pass, feet supported) times the margin. Report "muscles": per joint the peak, what
/// is held so long, and the limits.
void strengthen(const std::vector<Clip>& clips, double margin, Skeleton& skeleton, nlohmann::json& report);

/// What a clip asks of each joint for 50 ms or longer, feet supported, as a share of what its muscles have in
/// that direction: [simulated joint], 0 for those that no muscle moves.
std::vector<double> torque_shares(const Clip& clip, const Skeleton& skeleton);

/// How far the torques that a clip asks for are from those of a reference: over all joints and frames, 60 a
/// second, as shares of a muscle's limit, or of its own root mean square where noise asks for more than that.
/// Without the floor's forces: how they are shared among contact points jumps for reasons of its own.
struct TorqueError {
  double largest = 0, rms = 0;
};
TorqueError torque_error(const Clip& clip, const Clip& reference, const Skeleton& skeleton);

}  // namespace sinew::convert
