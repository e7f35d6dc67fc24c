// Bars on hinges, described in world axes at their reference pose, as mechanism files do.
#pragma once

#include <vector>

#include "scene/bodies.h"
#include "sinew/character/world.h"

namespace sinew::study {

struct Linkage {
  Skeleton skeleton;
  std::vector<Vec3<double>> origin;  ///< [body] of its joint, world, at the reference pose

  /// A body that turns with the world's axes at the reference pose. Returns its index.
  int add(int parent, JointType type, const Vec3<double>& anchor, const Vec3<double>& axis, double mass,
          const Vec3<double>& center, const Mat3<double>& inertia) {
    Joint joint;
    joint.name = "bar" + std::to_string(skeleton.joints.size());
    joint.parent = parent;
    joint.type = type;
    joint.rest.translation = parent < 0 ? anchor : Vec3<double>(anchor - origin[parent]);
    joint.axis = axis;
    joint.mass = mass;
    joint.center_of_mass = center - anchor;
    joint.inertia = inertia;
    for (DofLimits& dof : joint.dofs) dof.dry_friction = 0;
    skeleton.joints.push_back(joint);
    origin.push_back(anchor);
    return skeleton.body_count++;
  }
  /// A uniform round rod from the joint to `end`, m; slender ones do not resist turning about themselves.
  int add_rod(int parent, JointType type, const Vec3<double>& anchor, const Vec3<double>& end,
              const Vec3<double>& axis, double mass, double radius = 0) {
    const Vec3<double> along = end - anchor;
    return add(parent, type, anchor, axis, mass, anchor + along / 2, scene::rod_inertia(mass, along, radius));
  }
  /// The frame with world axes at a point of the reference pose, on a body of the first character.
  Anchor anchor(int body, const Vec3<double>& point, int character = 0) const {
    Anchor made;
    made.kind = AnchorKind::kCharacter;
    made.index = character;
    made.joint = body;
    made.frame.translation = point - origin[body];
    return made;
  }
};

}  // namespace sinew::study
