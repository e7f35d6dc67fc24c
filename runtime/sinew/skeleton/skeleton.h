// What a character is: a tree of joints, the rigid body that each carries, its limits, muscles and colliders.
//
// World and model space are right-handed, Z up, X forward, Y left; metres, kilograms, seconds, radians.
// A joint frame has its origin at the joint and its axes fixed in the child body. Parents come before
// children. Joints [0, body_count) are simulated: they have degrees of freedom, mass or simulated
// descendants. Joints [body_count, joints.size()) ride along: they have no mass and no freedom, their local
// transform is always the clip's (fingers, control bones, slots). A simulated joint never has a ride-along
// parent.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "sinew/skeleton/joint_type.h"
#include "sinew/skeleton/status.h"
#include "sinew/skeleton/transform.h"

namespace sinew {

/// Limits and passive properties of one degree of freedom. Angles in rad, lengths in m, torques in N·m
/// (forces in N for translations). Ball joints: `lower`/`upper` bound the components of the rotation vector
/// from rest, unless the joint has a swing cone.
struct DofLimits {
  double lower = -1e9;         ///< range of motion; |bound| ≥ 1e9 means unlimited
  double upper = 1e9;          ///< the same
  double torque_minus = 0;     ///< largest muscle torque in the negative direction, ≥ 0
  double torque_plus = 0;      ///< largest muscle torque in the positive direction, ≥ 0
  double damping = 0;          ///< N·m·s/rad
  double dry_friction = 0.02;  ///< N·m; 0.02 stopped a hand that rolled for ever (solver-prototype, claim b)

  /// Every member is the same.
  bool operator==(const DofLimits&) const = default;
};

/// What a collider is; Collider::size says how large.
enum class Shape : std::uint8_t { kSphere, kCapsule, kBox, kConvex };

class ConvexHull;

/// Collision and display shape in the axes of its joint. A capsule and a box lie along their local z.
struct Collider {
  int joint = 0;                                     ///< that carries it
  Shape shape = Shape::kSphere;                      ///< see size
  Transform<double> local;                           ///< shape → joint frame
  Vec3<double> size = Vec3<double>::Constant(0.05);  ///< sphere: x = radius; capsule: x = radius, z = half
                                                     ///< length of the segment; box: half extents;
                                                     ///< convex: three times the hull's inner radius
  double friction = 0.8;                             ///< ≥ 0, Coulomb's coefficient
  double restitution = 0;  ///< 0 … 1; a contact takes the larger of its two sides'. See Restitution
  const ConvexHull* hull = nullptr;  ///< convex: not copied, see convex_collider()

  /// Every member is the same.
  bool operator==(const Collider&) const = default;
};

/// Whether it has flat faces, edges and corners.
constexpr bool is_polyhedron(Shape shape) {
  return shape == Shape::kBox || shape == Shape::kConvex;
}

/// m, of the sphere about its middle that holds it.
double bounding_radius(const Collider& collider);

/// Whether its size, place and friction can be meant, and whether who is convex has a hull.
Status validate(const Collider& collider);

/// What a joint means on a body; found by name at conversion. Effects and scenes may refer to it instead of a
/// name.
enum class Role : std::uint8_t {
  kNone,
  kPelvis,
  kSpine,
  kChest,
  kNeck,
  kHead,
  kClavicleL,
  kClavicleR,
  kUpperArmL,
  kUpperArmR,
  kForearmL,
  kForearmR,
  kHandL,
  kHandR,
  kThighL,
  kThighR,
  kShinL,
  kShinR,
  kFootL,
  kFootR,
  kToesL,
  kToesR,
};

/// One joint, and the rigid body that it carries.
struct Joint {
  std::string name;                                    ///< unique in its skeleton
  int parent = -1;                                     ///< index, less than its own; -1: the root
  JointType type = JointType::kFixed;                  ///< how it may move
  Role role = Role::kNone;                             ///< which part of a body it is
  Transform<double> rest;                              ///< joint → parent joint, at q = 0
  Vec3<double> axis = Vec3<double>::UnitZ();           ///< unit; child axes at rest
  Vec3<double> axis2 = Vec3<double>::UnitX();          ///< universal only
  double mass = 0;                                     ///< kg
  Vec3<double> center_of_mass = Vec3<double>::Zero();  ///< in joint axes
  Mat3<double> inertia = Mat3<double>::Zero();         ///< about the centre of mass, in joint axes, kg·m²
  DofLimits dofs[6];                                   ///< first dof_count(type) are used
  double swing_limit = -1;  ///< ball: half angle of the cone about rest, rad; < 0 none
  Vec3<double> swing_axis = Vec3<double>::UnitZ();  ///< bone direction whose swing is limited, child axes
  double twist_lower = -1e9;                        ///< ball with swing cone: rotation about swing_axis, rad
  double twist_upper = 1e9;                         ///< the same
  bool ellipsoidal_limit =
      false;                 ///< ball: torques obey Σ (torque/limit)² ≤ 1 over the three axes, as strong
                             ///< in a slanting direction as along an axis; else each axis has its own
  std::string source_joint;  ///< URDF: name of the joint that moves this link

  /// Every member is the same.
  bool operator==(const Joint&) const = default;
};

/// A muscle that works on one degree of freedom besides the one that DofLimits describes. The rule: limits
/// add up, each scaled by its own strength; all muscles of a degree of freedom pull together, each by the
/// same share of its limit. So none exceeds its own, and the sum never exceeds the sum of the limits.
struct Muscle {
  std::string name;         ///< unique in its skeleton
  std::string group;        ///< strengthened and weakened together; "": none
  int joint = 0;            ///< simulated, not free
  int dof = 0;              ///< of the joint
  double torque_minus = 0;  ///< as DofLimits
  double torque_plus = 0;   ///< as DofLimits

  /// Every member is the same.
  bool operator==(const Muscle&) const = default;
};

/// Editable description; `validate` says what is wrong with it. Everything else in the runtime takes it as
/// valid.
struct Skeleton {
  std::string name;                 ///< of the character; may be empty
  std::vector<Joint> joints;        ///< parents first; simulated joints first
  int body_count = 0;               ///< number of simulated joints
  std::vector<Collider> colliders;  ///< of any joints, in any order
  std::vector<Muscle> muscles;      ///< besides the one of every degree of freedom

  int dof_total() const;                           ///< degrees of freedom of all simulated joints
  int find(const char* joint_name) const;          ///< index, or -1
  int find(Role role) const;                       ///< first with the role, or -1
  int find_muscle(const char* muscle_name) const;  ///< index, or -1
  double total_mass() const;                       ///< kg
  /// Largest torques (minus, plus; N·m) of a degree of freedom with all its muscles at strength 1.
  std::array<double, 2> torque_limits(int joint, int dof) const;
  /// Every member is the same.
  bool operator==(const Skeleton&) const = default;
};

/// Checks order, indices, finiteness, unit axes, positive masses and positive-semidefinite second moments
/// (the triangle inequality of inertias), ranges (lower ≤ upper), non-negative strengths, and that every
/// degree of freedom moves some mass. Cost O(joints). `Status::index` is the joint at fault.
Status validate(const Skeleton& skeleton);

}  // namespace sinew
